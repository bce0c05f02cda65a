"""Gathering runs into attractors, on orbits and sets that are known exactly."""

import numpy as np
import pytest

from whirlmap.analysis.attractors import on_orbit, on_set
from whirlmap.equations import Model, Parameter, State, cos, t
from whirlmap.integrate import scales as sizes


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
