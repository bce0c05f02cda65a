"""Short cuts to an orbit end where plain settling ends, or are taken back to the bit."""

import numpy as np
import pytest
import sympy as sp

from whirlmap.analysis.motion.ensembles import make_ensemble
from whirlmap.analysis.steady import acceleration, pool
from whirlmap.analysis.steady.extrapolation import DIFFERENCES, room_for_fit, step_to_limit
from whirlmap.analysis.steady.settling import Settling, settle
from whirlmap.analysis.variational.floquet import floquet_multipliers
from whirlmap.analysis.variational.monodromy import largest_multipliers
from whirlmap.equations import Model, Parameter, State, cos, t
from whirlmap.integrate.loading import load
from whirlmap.integrate.system import System


def settled(system, vary, *, steps=24, start=None, **how):
    """How points settle, plainly (first) and accelerated; their ensembles."""
    cyclic = {i: float(s.cyclic) for i, s in enumerate(system.model.states) if s.cyclic is not None}
    out = []
    for accelerate in (False, True):
        e = make_ensemble(system, vary, steps=steps, method="dop853")[0]
        if start is not None:
            e.x[:] = start
        out.append((settle(e, Settling(most=16, accelerate=accelerate, **how), cyclic=cyclic), e))
    return out


def assert_same(plain, fast):
    """Labels are equal, and the point is one of plain settling's section points of the orbit."""
    (p, ep), (a, ea) = plain, fast
    np.testing.assert_array_equal(a.multiple, p.multiple)
    assert not p.accelerated.any() and (a.multiple[a.accelerated] > 0).all()
    for i in np.flatnonzero(p.multiple > 0):
        one, common = ep.subset(np.array([i])), ep.common_multiple
        orbit = one.advance(int(p.multiple[i]) * common, save_periods=common).saved[:, :, 0]
        apart = orbit - ea.x[:, i]
        for k, state in enumerate(ep.model.states):
            if state.cyclic is not None:
                apart[:, k] -= float(state.cyclic) * np.rint(apart[:, k] / float(state.cyclic))
        assert (np.abs(apart) / p.scale[:, i]).max(axis=1).min() < 4e-6


# --- the limit of a sequence ------------------------------------------------------------------------------


def spiral(*multipliers, size=1e-3):
    """Points x_k = 1 + the sum of decays; a complex multiplier turns both states, a real one stretches one direction."""
    k = np.arange(DIFFERENCES + 1)
    x = np.ones((k.size, 2), dtype=float)
    for i, z in enumerate(multipliers):
        power = size * complex(z) ** k
        x += np.stack([power.real, power.imag], axis=1) if np.iscomplexobj(z) else np.outer(power.real, [1.0, 0.5 * i - 1])
    return x


def limit(points, tolerance):
    """Limit of a sequence (DIFFERENCES + 1, state), its error and the leading modulus, by the loops' own parts in Python."""
    d, step = np.diff(points, axis=0), np.zeros(points.shape[1])
    with np.errstate(divide="ignore", invalid="ignore"):
        error, leading = step_to_limit(
            d.ravel(), np.abs(d).max(axis=1), points.shape[1], tolerance, step, room_for_fit(points.shape[1])
        )
    return points[-1] + step, error, leading


@pytest.mark.parametrize("multipliers", [(0.9,), (-0.95,), (0.99, 0.5), (0.97, -0.96), (0.95 * np.exp(1j),)], ids=str)
def test_the_limit_of_a_linear_approach(multipliers):
    x, error, leading = limit(spiral(*multipliers), 1e-7)
    np.testing.assert_allclose(x, 1.0, atol=1e-9)
    assert error < 1e-9
    assert leading == pytest.approx(np.max(np.abs(multipliers)), abs=1e-6)


@pytest.mark.parametrize("multipliers", [(1.02,), (-1.02, 0.5), (-1.0,), (np.exp(0.7j),), (1.01 * np.exp(1j),)], ids=str)
def test_no_limit_is_given_where_the_motion_does_not_contract(multipliers):
    assert np.isinf(limit(spiral(*multipliers), 1e-7)[1])


def test_no_limit_of_noise_and_of_rest():
    rng = np.random.default_rng(0)
    assert all(np.isinf(limit(noise, 1e-4)[1]) for noise in rng.normal(size=(500, DIFFERENCES + 1, 2)))
    assert np.isinf(limit(np.ones((DIFFERENCES + 1, 2)), 1e-4)[1])


# --- systems ------------------------------------------------------------------------------------------------


def test_weakly_damped_duffing():
    """Slow spirals, one of them towards a fixed point that a single window takes for an orbit of three."""
    plain, fast = settled(load("duffing").replace(delta=0.01), {"gamma": np.linspace(0.05, 0.12, 24)}, transient=2000)
    assert_same(plain, fast)
    assert fast[0].accelerated.sum() > 12
    cut = fast[0].accelerated
    assert (plain[0].waited - fast[0].waited)[cut].mean() > 100
    system = load("duffing").replace(delta=0.01)
    for i in np.flatnonzero(cut)[:3]:  # stable by all multipliers, not only by those that the approach shows
        at = system.replace(gamma=float(np.linspace(0.05, 0.12, 24)[i]))
        assert floquet_multipliers(at, fast[1].x[:, i], fast[0].multiple[i] * at.period).stable


def test_coexisting_orbits_of_duffing():
    """Thirty starts, several attractors: every point ends on the orbit that it was contracting to."""
    rng = np.random.default_rng(2)
    start = rng.uniform(-1.5, 1.5, (2, 30))
    plain, fast = settled(load("duffing").replace(delta=0.05), {"gamma": np.full(30, 0.1)}, start=start, transient=600)
    assert_same(plain, fast)
    ends = plain[1].x[:, plain[0].multiple == 1]
    assert np.unique(np.round(ends, 3), axis=1).shape[1] > 1, "one attractor only: the test is not about coexistence"
    assert fast[0].accelerated.sum() > 10


def test_alternating_transients_near_period_doublings():
    """Next to a doubling plain settling needs more than a thousand periods; given them, it finds the same."""
    plain, fast = settled(load("duffing"), {"gamma": np.linspace(0.265, 0.295, 40)}, transient=3000)
    assert_same(plain, fast)
    assert plain[0].waited[plain[0].multiple == 2].max() > 400
    assert set(plain[0].multiple) >= {1, 2}
    assert fast[0].accelerated.any()


def test_pendulum_and_its_cyclic_angle():
    plain, fast = settled(load("pendulum").replace(q=0.05), {"g": np.linspace(0.1, 0.6, 16)}, steps=30, transient=400)
    assert_same(plain, fast)
    assert fast[0].accelerated.any()


def test_locked_van_der_pol():
    system = load("van_der_pol")
    own = {"omega": np.linspace(0.93, 0.99, 16)}
    plain, fast = settled(system, own, steps=40, transient=400)
    assert (plain[0].multiple == 1).sum() > 4
    assert_same(plain, fast)


def test_gear_pair_where_it_settles_slowly():
    plain, fast = settled(load("gear-psfd/reference").replace(psi=1e-3), {"s": np.linspace(3.0, 4.0, 32)}, transient=200)
    assert_same(plain, fast)
    assert fast[0].waited.mean() <= plain[0].waited.mean()
    assert fast[0].waited.mean() < 200 / 3


# --- trials ---------------------------------------------------------------------------------------------------


def test_a_failed_trial_leaves_no_trace(monkeypatch):
    """Where every short cut leads astray, labels and bits are those of plain settling; the time is not."""
    right = acceleration.ends_of_approaches

    def astray(due, *others):
        multiple, x, leading = right(due, *others)
        return multiple, x + 1e-3 * others[-2][:, due].T, leading

    monkeypatch.setattr(acceleration, "ends_of_approaches", astray)
    plain, fast = settled(load("duffing").replace(delta=0.03), {"gamma": np.linspace(0.1, 0.2, 10)}, transient=600)
    assert (fast[0].waited > plain[0].waited).any() and not fast[0].accelerated.any()
    np.testing.assert_array_equal(fast[0].multiple, plain[0].multiple)
    np.testing.assert_array_equal(fast[1].x, plain[1].x)


def test_multipliers_of_many_orbits():
    """Those of `floquet_multipliers`, for orbits of one, two and four periods; the ensemble stays where it is."""
    system, gamma = load("duffing"), np.array([0.1, 0.2, 0.27, 0.29])
    settled_, e = settled(system, {"gamma": gamma}, transient=3000)[0]
    assert set(settled_.multiple) == {1, 2, 4}
    before = e.x.copy()
    found = largest_multipliers(e, np.arange(4), settled_.multiple)
    np.testing.assert_array_equal(e.x, before)
    for i, m in enumerate(settled_.multiple):
        at = system.replace(gamma=float(gamma[i]))
        exact = floquet_multipliers(at, e.x[:, i], m * at.period)
        assert found[i] == pytest.approx(float(np.exp(exact.log_modulus[0])), rel=1e-4)


x, v, s = (State(n, "1", n) for n in "xvs")
omega, rate = (Parameter(n, "1", n) for n in ("omega", "rate"))
#: A weakly damped oscillator pushed by z = s - v, which grows or decays at a rate of its own and pulls nothing along.
PUSHED = cos(omega * t) - 4 * x - v / 20 + (s - v)
PLANE = Model("plane", (x, v, s), (omega, rate), {x: v, v: PUSHED, s: PUSHED + rate * (s - v)}, harmonics=(omega,))


def plane(z, rate):
    """How one start settles beside the plane z = 0."""
    system = System(PLANE, {"omega": 1.0, "rate": rate})
    return settled(system, {"rate": [rate]}, start=np.array([[0.8], [0.0], [z]]), transient=400)


def test_an_orbit_that_repels_is_no_end_of_a_short_cut():
    """The approach lies in the plane and shows nothing of the way out; the multipliers do."""
    plain, fast = plane(0.0, -0.5)
    assert fast[0].accelerated[0] and fast[0].multiple[0] == 1
    plain, fast = plane(0.0, 0.02)
    assert not fast[0].accelerated[0]
    assert_same(plain, fast)


def test_what_an_approach_hides_is_seen_by_the_multipliers(monkeypatch):
    """A part that decays by 0.6 % a period, 1e-5 of the motion: its differences are far below the tolerance, it is not."""
    cut = plane(1e-5, -1e-3)[1][0].accelerated[0]
    monkeypatch.setattr(acceleration, "largest_multipliers", lambda e, points, multiple: np.full(points.size, 0.86))
    assert plane(1e-5, -1e-3)[1][0].accelerated[0] and not cut


def test_short_cuts_of_models_whose_rates_jump_are_proved_by_saltation():
    """Dry friction takes energy out of a weakly damped motion; multipliers over its jumps prove the extrapolated orbit."""
    friction = {x: v, v: cos(omega * t) - 4 * x - v / 50 - sp.sign(v) / 100, s: rate - s}
    system = System(Model("dry", (x, v, s), (omega, rate), friction, harmonics=(omega,)), {"omega": 1.0, "rate": 0.0})
    plain, fast = settled(system, {"rate": [0.0]}, start=np.array([[0.8], [0.0], [0.0]]), transient=400)
    assert fast[0].accelerated[0] and fast[0].waited[0] < plain[0].waited[0]
    assert_same(plain, fast)


def test_points_that_the_multipliers_refuse_settle_plainly(monkeypatch):
    monkeypatch.setattr(acceleration, "largest_multipliers", lambda e, points, multiple: np.full(points.size, 1.001))
    plain, fast = settled(load("duffing").replace(delta=0.03), {"gamma": np.linspace(0.08, 0.14, 10)}, transient=600)
    assert not fast[0].accelerated.any() and (fast[0].waited > plain[0].waited).any()
    assert_same(plain, fast)


@pytest.mark.parametrize("size", [1, 7])
def test_bits_of_short_cuts_do_not_depend_on_the_pool(monkeypatch, size):
    def run():
        e = make_ensemble(
            load("duffing").replace(delta=0.03), {"gamma": np.linspace(0.1, 0.3, 20)}, steps=24, method="dop853", workers=1
        )[0]
        return settle(e, Settling(transient=100, most=8)), e.x

    wanted, x = run()
    assert wanted.accelerated.any() and not wanted.accelerated.all()
    monkeypatch.setattr(pool, "POOL", 1)
    monkeypatch.setattr(pool, "LANES", size)
    got, y = run()
    np.testing.assert_array_equal(got.waited, wanted.waited)
    np.testing.assert_array_equal(got.accelerated, wanted.accelerated)
    np.testing.assert_array_equal(y, x)
