"""How a point ends: contact located, divergence, steps that were too long; and that nobody else notices."""

import numpy as np
import pytest
from tests.integrate.rotors import at_rest, ensemble, gear_pair, solved

from whirlmap.equations import Model, Output, Parameter, State, Stop, cos, t
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.step_retry import StepRetry
from whirlmap.integrate.system import System
from whirlmap.results.status import Status


def spy_on_mending(monkeypatch):
    """Collect the points of every failed step."""
    points, mend = [], StepRetry.retry

    def spy(self, members, *rest):
        points.extend(members.tolist())
        return mend(self, members, *rest)

    monkeypatch.setattr(StepRetry, "retry", spy)
    return points


# --- contact -----------------------------------------------------------------------------------------------


def about_to_touch():
    """psi = 0.1, paper's clock, s = 0.8: the gear's journal falls through the last tenth of its film."""
    system = gear_pair(0.8, 0.1, clock="mesh")
    x = np.zeros(20)
    x[[0, 2, 3]] = 0.1, 0.3, -0.8
    x[[5, 7, 9, 11]] = -0.6, -1.5, -0.1, -0.15
    return system, x


@pytest.fixture(scope="module")
def touch():
    system, x = about_to_touch()

    def gap(time, y):
        return 1 - y[2] ** 2 - y[3] ** 2

    gap.terminal = True
    run = solved(system, (0.0, 4 * np.pi), x, rtol=1e-10, atol=1e-11, events=gap)
    assert run.status == 1, "the reference never touched"
    assert run.t[-1] > 0.5
    return system, x, run.t[-1], run.y[:, -1]


def test_contact_is_located(touch):
    """To 1e-8 at 1600 steps per T; what is left is RK4's own error, which falls like its fourth order."""
    system, x, when, where = touch
    errors = []
    for steps in (100, 400, 1600):
        e = ensemble(system, x, steps)
        e.advance(3, save_every=1)
        assert Status(e.status[0]) is Status.contact
        assert list(system.model.stops)[e.end_stop[0]] == "contact_2"
        assert 0 <= 1 - e.x[2, 0] ** 2 - e.x[3, 0] ** 2 < 1e-6
        errors.append(abs(e.end_time[0] - when))
    assert errors[2] < 1e-8
    assert errors[2] < errors[1] < errors[0]
    assert errors[1] / errors[2] == pytest.approx(4**4, rel=0.2)
    np.testing.assert_allclose(e.x[:, 0], where, rtol=0, atol=1e-7)


def test_after_contact_nothing_moves_and_nothing_is_recorded(touch):
    system, x, when, _ = touch
    e = ensemble(system, x, 100)
    part = e.advance(3, save_every=1, extremes=True)
    last = int(when / (system.period / 100))  # whole steps before it
    assert np.isfinite(part.saved[:last]).all()
    assert np.isnan(part.saved[last:]).all()
    assert all(np.isnan(values).all() for values in part.extremes.values())  # of a part of a run they would mislead
    state, time = e.x.copy(), e.end_time.copy()
    again = e.advance(2, save_every=10, extremes=True)
    np.testing.assert_array_equal(e.x, state)
    np.testing.assert_array_equal(e.end_time, time)
    assert np.isnan(again.saved).all()
    assert np.isnan(again.extremes["maximum"]).all()


def test_without_permeability_there_is_no_contact(monkeypatch):
    """psi = 0, pressed to the wall in long steps: they fail, are redone or given up, never called contact."""
    failed = spy_on_mending(monkeypatch)
    system = gear_pair(3.0, clock="mesh")
    angle = np.random.default_rng(3).uniform(-np.pi, np.pi, 32)
    x = np.repeat(at_rest(system)[:, None], 32, axis=1)
    x[6] += 60 * np.cos(angle)  # a bent shaft presses the journal through its whole film
    x[7] += 60 * np.sin(angle)
    fine = ensemble(system, x, 2000)
    part = fine.advance(1, extremes=True)
    assert (fine.status == Status.ok).all()
    closest = 1 - part.extremes["maximum"][len(system.states) + list(system.model.outputs).index("eps_2")]
    assert closest.min() < 0.05
    assert closest.max() > 0
    failed.clear()
    coarse = ensemble(system, x, 10)
    coarse.advance(8)
    assert len(failed) > 5, "no step failed: this test tests nothing"
    assert set(coarse.status) <= {Status.ok, Status.unresolved}
    inside = coarse.status == Status.ok
    assert inside.any()
    assert (np.hypot(coarse.x[2], coarse.x[3])[inside] < 1).all()


# --- divergence --------------------------------------------------------------------------------------------

y, v = State("y", "1", "y"), State("v", "1", "v")
a, b, c, g, k, w = (Parameter(n, "1", n) for n in "abcgkw")
TOY = Model(  # one model, so that it is compiled once: a spring, a blow-up, a repelling wall at y = -1, and forcing
    "toy",
    (y, v),
    (a, b, c, g, k, w),
    {y: v + c * y**2, v: k * y + a / (1 + y) ** 3 + g * cos(w * t)},
    harmonics=(w, w / 3),
    outputs={"reach": Output(y + v / 100, "1", "reach")},
    stops={"contact": Stop(1 + y + 1e9 * b, "wall", reachable=0 * k)},  # b = 1 takes the wall away
    bound=1e6,
)


def toy(x, steps, *, a=0.0, b=0.0, c=0.0, g=0.0, k=0.0, w=2.0, **more):
    x = np.asarray(x, dtype=float)
    values = np.stack([np.broadcast_to(np.asarray(p, dtype=float), x.shape[1]) for p in (a, b, c, g, k, w)])
    return Ensemble(TOY, values, x, orders=System(TOY, dict.fromkeys("abcgkw", 1.0)).orders, steps=steps, **more)


def test_divergence_ends_at_the_step_that_leaves_the_bound():
    """|y| + |y'| of y'' = k y reaches the bound 1e6 where cosh and sinh say; neighbours with k < 0 swing on."""
    k = np.array([2.0, -1.0, 3.0, -4.0])
    e = toy([[0.5, 0.5, -0.5, 0.5], [0.0] * 4], 200, b=1.0, k=k)  # one to plus, one to minus infinity
    e.advance(6)
    assert [Status(s).name for s in e.status] == ["diverged", "ok", "diverged", "ok"]
    for i in (0, 2):
        root = np.sqrt(k[i])
        exact = np.log(4e6 / (1 + root)) / root
        assert 0 <= e.end_time[i] - exact < np.pi / 200 * 1.01  # the end of the first step beyond
        assert np.abs(e.x[:, i]).sum() < 1e6  # the last good state
    assert np.isnan(e.end_time[[1, 3]]).all()
    end = 6 * np.pi
    np.testing.assert_allclose(e.x[0, [1, 3]], [0.5 * np.cos(end), 0.5 * np.cos(2 * end)], rtol=0, atol=1e-6)


def test_blow_up_in_finite_time_is_divergence():
    """y' = y^2 from 1 and 2 is infinite at 1 and 1/2: located to a step."""
    e = toy([[1.0, 2.0], [0.0, 0.0]], 50, c=1.0, w=20 * np.pi)
    e.advance(12)
    assert (e.status == Status.diverged).all()
    np.testing.assert_allclose(e.end_time, [1.0, 0.5], rtol=0, atol=2.1 * 0.1 / 50)


def test_a_start_that_is_not_a_number_is_no_result():
    e = toy([[np.nan, -0.5], [0.0, 0.0]], 50, c=1.0, w=20 * np.pi)
    e.advance(1)
    assert e.status[0] not in (Status.ok, Status.contact)
    assert e.status[1] == Status.ok
    assert e.x[0, 1] == pytest.approx(-0.5 / 1.05, abs=1e-9)


# --- steps that were too long ------------------------------------------------------------------------------


def thrown(speeds, steps, **more):
    """Thrown at a wall that repels like a pole: the faster, the shorter the encounter."""
    return toy([np.zeros(len(speeds)), -speeds], steps, a=1e-4, g=0.2, **more)


def test_mended_steps_are_recorded_like_all_others(monkeypatch):
    """Saved, in the extremes and in the means; also where the mended step is the last one of a call."""
    speeds = np.linspace(0.5, 3.0, 32)
    mended = spy_on_mending(monkeypatch)
    whole = thrown(speeds, 6)
    part = whole.advance(2, save_every=1, extremes=True)
    assert len(set(mended)) > 3, "no step was mended: this test tests nothing"
    ok = whole.status == Status.ok
    assert ok[sorted(set(mended))].any()
    orbit = part.saved[..., ok]
    assert np.isfinite(orbit).all()
    rows = np.concatenate([orbit, (orbit[:, 0] + orbit[:, 1] / 100)[:, None]], axis=1)
    for name, expected in (
        ("minimum", rows.min(0)), ("maximum", rows.max(0)), ("mean", rows.mean(0)), ("rms", rows.std(0)),
    ):  # fmt: skip
        got = part.extremes[name][:, ok]
        np.testing.assert_allclose(got, expected, rtol=1e-5, atol=1e-9, err_msg=name)  # sums of squares cancel
    single = thrown(speeds, 1)  # every call is one step, so that every mended step is a call's last
    states = np.concatenate([single.advance(1, save_every=1).saved for _ in range(6)])
    assert np.isfinite(states[..., single.status == Status.ok]).all()


def volume_of_map(speeds, h):
    """Determinant of the map from starts to ends after 3 T, by central differences of runs of the same steps."""
    ends = {}
    for way in ((h, 0), (-h, 0), (0, h), (0, -h)):
        near = toy([np.full(speeds.size, way[0]), way[1] - speeds], 20, a=1e-4, g=0.2)
        near.advance(3)
        ends[way] = near.x
    by_y, by_v = ends[h, 0] - ends[-h, 0], ends[0, h] - ends[0, -h]
    return np.abs(by_y[0] * by_v[1] - by_y[1] * by_v[0]) / (2 * h) ** 2


def test_growth_of_tangent_vectors_survives_a_mended_step(monkeypatch):
    """Their volume is the determinant of the map; the lanes beside a mended one keep their bits."""
    speeds = np.linspace(0.1, 1.0, 32)
    mended = spy_on_mending(monkeypatch)
    whole = thrown(speeds, 20, tangents=2)
    growth = whole.advance(3).growth
    lost = sorted(set(mended))
    assert 3 < len(lost) < 29, "steps must be mended in some lanes, not in all"
    assert (whole.status == Status.ok).all()
    exact, rougher = (np.log(volume_of_map(speeds, h)) for h in (1e-6, 2e-6))
    smooth = np.abs(exact - rougher) < 1e-3  # elsewhere the differences straddle a change of the steps
    assert smooth.sum() > 28 and smooth[lost].sum() > 3
    assert np.abs(exact[smooth]).max() > 1
    np.testing.assert_allclose(growth.sum(axis=(0, 1))[smooth], exact[smooth], rtol=0, atol=1e-3)
    kept = np.setdiff1d(np.arange(32), lost)
    alone = thrown(speeds[kept], 20, tangents=2)
    np.testing.assert_array_equal(alone.advance(3).growth, growth[..., kept])
    np.testing.assert_array_equal(alone._y, whole._y[:, kept])


def test_the_forcings_phase_survives_the_end_of_a_neighbour():
    """The first point of a block ends; the others' slow forcing must go on in phase, call after call of one T."""
    rng = np.random.default_rng(2)
    system = gear_pair(2.0)
    x = at_rest(system)[:, None] + rng.uniform(-0.05, 0.05, (20, 4))
    x[12, 0] = 9e5  # point 0 diverges or fails at once
    e = ensemble(system, x, 8)
    alone = ensemble(system, x[:, 1:], 8)
    for _ in range(7):
        e.advance(1)
    alone.advance(7)
    assert e.status[0] != Status.ok
    assert (e.status[1:] == Status.ok).all()
    np.testing.assert_array_equal(e.x[:, 1:], alone.x)
