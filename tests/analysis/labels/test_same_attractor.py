"""Which runs are on one attractor, on orbits and sets that are known exactly."""

import numpy as np
import pytest

from whirlmap.analysis.indicators.distribution import compare
from whirlmap.analysis.labels.same_attractor import on_set, same_set
from whirlmap.analysis.periodic_orbits.closed_orbit import ClosedOrbit, closed_orbits, flows_into
from whirlmap.equations import Model, Parameter, State, cos, t
from whirlmap.integrate import scales as sizes
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.kernels.methods import DOP853


def scales(orbit, extent, cyclic=None):
    """Of a position and an angle, or of two positions that are added."""
    x, y = State("x", "1", "x", cyclic=(cyclic or {}).get(0)), State("y", "1", "y")
    w = Parameter("w", "1", "w")
    model = Model("two", (x, y), (w,), {x: y - x, y: cos(w * t) - y}, harmonics=(w,))
    return sizes.scales(model, np.ones(1), np.array(extent)[:, None], np.abs(orbit).max(axis=0)[:, None])[:, 0]


GOLDEN = (np.sqrt(5) - 1) / 2


def circle(n, *, radius=1.0, turn=GOLDEN, begin=0.0):
    angle = 2 * np.pi * (begin + turn * np.arange(n))
    return radius * np.stack([np.cos(angle), 0.5 * np.sin(angle)], axis=1)


def records(*runs):
    return np.stack(runs, axis=2)


def on_orbit(states, orbit, scale, cyclic=None):
    unclosed = np.full((2, 2), np.nan)
    return ClosedOrbit(orbit, scale, unclosed, 1e-4).distance(states, cyclic)[0] <= 1e-4


def test_one_point_in_common_makes_an_orbit_the_same():
    orbit = np.array([[1.0, 0.0], [-0.5, 0.3]])
    states = np.array([[-0.5, 0.3], [-0.5 + 1e-3, 0.3], [1.0, 1e-6], [0.25, 0.15]]).T
    size = scales(orbit, np.array([2.0, 1.0]))
    assert on_orbit(states, orbit, size).tolist() == [True, False, True, False]


def test_angles_are_compared_modulo_their_period():
    orbit = np.array([[0.1, 2.0]])
    states = np.array([[0.1 + 14 * np.pi, 2.0], [0.1 - 2 * np.pi, 2.0], [0.1 + np.pi, 2.0]]).T
    size = scales(orbit, np.array([50.0, 1.0]), {0: 2 * np.pi})
    assert size[0] == pytest.approx(2 * np.pi)  # a rotation has no range of its own
    assert on_orbit(states, orbit, size, {0: 2 * np.pi}).tolist() == [True, True, False]


def test_a_state_that_stands_still_does_not_decide():
    orbit = np.array([[1.0, 0.0]])
    size = scales(orbit, np.array([2.0, 0.0]))
    assert on_orbit(np.array([[1.0], [1e-12]]), orbit, size).all()


@pytest.mark.parametrize("turn", [GOLDEN, 1 / 301 + 1e-7])
def test_smooth_curves_apart_are_told_apart_also_beside_a_resonance(turn):
    """Beside 1/301 the points of a trace lie in 301 clumps, and the curve goes on between them."""
    trace = circle(2048, turn=turn)
    same, other = circle(32, turn=turn, begin=0.5 / 301), circle(32, radius=1.02, turn=turn)
    found = on_set(records(same, other), trace, smooth=True)
    assert found.tolist() == [True, False]
    if turn != GOLDEN:  # what the plain comparison with the spacing would say
        assert not on_set(records(same), trace)[0]


def henon(n, x, y):
    out = np.empty((n, 2))
    for i in range(-1000, n):
        x, y = 1 - 1.4 * x * x + y, 0.3 * x
        if i >= 0:
            out[i] = x, y
    return out


def test_a_strange_set_knows_its_own_runs_and_no_others():
    trace = henon(2048, 0.1, 0.1)
    own = [henon(32, x, 0.0) for x in (0.0, 0.2, -0.3)]
    moved = own[0] + [0.0, 0.05]
    mirrored = -own[1]
    assert on_set(records(*own, moved, mirrored), trace).tolist() == [True, True, True, False, False]
    broken = own[0].copy()
    broken[3] = np.nan
    assert not on_set(records(broken), trace).any()


def test_long_records_of_one_strange_set_have_one_distribution():
    runs = [henon(2048, x, 0.0) for x in np.linspace(-0.3, 0.3, 8)]
    scale = np.array([2.6, 0.77])
    found = [compare(a, b, scale) for k, a in enumerate(runs) for b in runs[:k]]
    assert all(c.known and not c.different for c in found)  # 28 pairs: chance leaves 3e-5 of one
    assert all(same_set(a, runs[0], scale) for a in runs)


@pytest.mark.parametrize("shift", [0.1, 0.05])
def test_strange_sets_apart_are_told_apart(shift):
    """Moved by 2 % of its range a set needs a longer record than by 4 %."""
    one, other = henon(16384, 0.1, 0.1), henon(16384, 0.0, 0.0)
    other += np.array([shift, 0.0])
    scale, short = np.array([2.6, 0.77]), 2048
    assert compare(one, other, scale).different and not same_set(one, other, scale)
    if shift == 0.1:
        assert not same_set(one[:short], other[:short], scale)
    assert not same_set(one[:short], -other[:short], scale)


def test_in_many_dimensions_runs_are_told_apart_by_their_averages():
    """Points of a cloud in twelve dimensions are so far apart that a run beside it lies among them."""
    random = np.random.default_rng(4)
    trace, own, beside = random.normal(size=(2048, 12)), random.normal(size=(32, 12, 20)), random.normal(size=(32, 12, 20))
    beside[:, 3] += 2.0
    scale = np.full(12, 6.0)
    assert on_set(own, trace, scale=scale).sum() >= 19 and not on_set(beside, trace, scale=scale).any()


def test_the_distribution_counts_that_points_depend_on_each_other():
    """A slow random motion: with the error of independent points two of its records would differ by 20 errors."""
    random = np.random.default_rng(2)
    noise = random.normal(size=(40, 4096))
    slow = np.empty_like(noise)
    slow[:, 0] = random.normal(size=40) / np.sqrt(1 - 0.98**2)
    for k in range(1, noise.shape[1]):
        slow[:, k] = 0.98 * slow[:, k - 1] + noise[:, k]
    pairs = [compare(a[:, None], b[:, None], np.array([30.0])) for a, b in zip(slow[::2], slow[1::2], strict=True)]
    assert not any(c.different for c in pairs)


def test_tori_are_told_apart_by_a_thousandth_of_their_size():
    scale = np.array([2.0, 1.0])
    trace = circle(2048)
    for begin in (0.1, 0.37, 0.8):
        assert same_set(circle(2048, begin=begin), trace, scale, smooth=True)
    assert not same_set(circle(2048, radius=1.001), trace, scale, smooth=True)
    assert on_set(records(circle(32, begin=0.3)), trace, smooth=True, scale=scale)[0]
    assert not on_set(records(circle(32, radius=1.001)), trace, smooth=True, scale=scale)[0]


def test_a_run_that_still_drifts_to_its_torus_is_on_it():
    """The radius decays by e in 200 points; what is left in the middle is 0.3 %, and counts as the error that it is."""
    drifting = circle(2048, begin=0.2) * (1 + 0.5 * np.exp(-np.arange(2048) / 200))[:, None]
    assert same_set(drifting, circle(2048), np.array([2.0, 1.0]), smooth=True)
    assert not same_set(circle(2048, radius=1.01), circle(2048), np.array([2.0, 1.0]), smooth=True)


# --- closed orbits -------------------------------------------------------------------------------------------------

D = 1e-3


@pytest.fixture(scope="module")
def slow():
    """x'' + 2 D x' + x = cos(w t), whose orbit is known and whose multipliers have the modulus exp(-D T)."""
    x, v, w = State("x", "1", "x"), State("v", "1", "v"), Parameter("w", "1", "w")
    return Model("slow", (x, v), (w,), {x: v, v: cos(w * t) - 2 * D * v - x}, harmonics=(w,))


def exact(w):
    """State of the orbit at phase zero, and its scale."""
    amplitude = 1 / (1 - w * w + 2j * D * w)
    return np.array([amplitude.real, (1j * w * amplitude).real]), 2 * np.abs(amplitude) * np.array([1.0, w])


def runs(model, w, x):
    return Ensemble(model, np.full((1, x.shape[1]), w), x, orders=(1,), steps=48, method=DOP853)


def closed(model, w, x):
    """Orbits that runs over one common period are closed to."""
    return closed_orbits(runs(model, w, x), np.ones(x.shape[1], dtype=np.int64), every=1, tolerance=1e-6)


def test_slow_runs_are_closed_to_the_orbit_that_they_settle_on(slow):
    """A return to 1e-6 leaves 160 times as much of this approach; two such runs are 3e-4 apart, and on one orbit."""
    orbit, scale = exact(0.8)
    x = orbit[:, None] + scale[:, None] * np.array([[1.6e-4, -1.6e-4, 0.0], [0.0, 0.0, 1e-3]])
    for found in closed(slow, 0.8, x):
        np.testing.assert_allclose(found.points[0] / scale, orbit / scale, atol=1e-8)
        np.testing.assert_allclose(found.scale, scale, rtol=5e-3)  # extremes at the ends of 48 steps
        np.testing.assert_allclose(np.abs(np.linalg.eigvals(found.matrix)), np.exp(-D * 2 * np.pi / 0.8), rtol=1e-7)


def test_a_run_far_from_its_orbit_flows_into_it_where_the_map_is_linear(slow):
    orbit, scale = exact(0.8)
    x = orbit[:, None] + scale[:, None] * np.array([[0.3, 0.0], [0.0, 0.0]])
    known = closed(slow, 0.8, orbit[:, None])[0]
    saved = runs(slow, 0.8, x).advance(5, save_periods=1).saved
    assert flows_into(saved, known).tolist() == [True, True]
    elsewhere = saved + 0.1 * scale[:, None] * np.array([1.0, -1.0, 1.0, -1.0, 1.0])[:, None, None]  # jumps to and fro
    assert not flows_into(elsewhere, known).any()
    assert not flows_into(saved[:3], known).any()  # too few returns
    assert not flows_into(saved[[0, 1, 0, 1]], known)[0]  # an approach on every other return


def test_an_orbit_that_repels_is_not_closed():
    """x'' - 0.1 x' + x = cos(w t): its orbit has multipliers outside the circle."""
    x, v, w = State("x", "1", "x"), State("v", "1", "v"), Parameter("w", "1", "w")
    model = Model("growing", (x, v), (w,), {x: v, v: cos(w * t) + v / 10 - x}, harmonics=(w,))
    amplitude = 1 / (1 - 0.64 - 0.08j)
    begin = np.array([[amplitude.real + 1e-4], [(0.8j * amplitude).real]])
    found = closed(model, 0.8, begin)[0]
    assert not found.closed and (found.points[0] == begin[:, 0]).all()
