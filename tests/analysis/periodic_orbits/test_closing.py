"""Orbits that Newton's method closes, and motions that go there, of a rotation that is known exactly."""

import numpy as np
import pytest

from whirlmap.analysis.periodic_orbits.closed_orbit import closed_orbits
from whirlmap.analysis.periodic_orbits.newton import close_orbits, newton
from whirlmap.equations import Model, Parameter, State, cos, pi, sin, t
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.kernels.methods import DOP853

W, A, D, CYCLIC = 1.7, 0.3, 1e-3, {0: 2 * np.pi}
V = W + A * W
MODULUS = np.exp(-D * 2 * np.pi / W)
ONE = np.array([0])


@pytest.fixture(scope="module")
def rotor():
    """It rotates with the forcing, q = w t + a sin w t, and is a damped pendulum about that: y'' + 2 d y' + sin y = 0."""
    q, v = State("q", "1", "q", cyclic=2 * pi), State("v", "1", "v")
    w, d = Parameter("w", "1", "w"), Parameter("d", "1", "d")
    c, s = cos(w * t), sin(w * t)
    pull = sin(q - A * s) * c - cos(q - A * s) * s
    return Model("rotor", (q, v), (w, d), {q: v, v: -2 * d * (v - w - A * w * c) - pull - A * w**2 * s}, harmonics=(w,))


def runs(model, *away, damping=D):
    x = np.array([[0.0], [V]]) + np.array(away).T
    return Ensemble(model, np.array([[W], [damping]]).repeat(len(away), axis=1), x, orders=(1,), steps=48, method=DOP853)


def record(model, away, count, damping=D):
    """An ensemble that has run, and its section points up to the present state."""
    e = runs(model, away, damping=damping)
    return e, e.advance(count, save_periods=1).saved[:, :, 0]


def test_a_slow_motion_is_closed_to_the_rotation_that_it_goes_to(rotor):
    """Tried as an orbit of six turns it is found to be one of one."""
    e, path = record(rotor, [0.3, 0.0], 200)
    for m in (1, 6):
        found = close_orbits(e, ONE, np.array([m]), [path], CYCLIC, 1e-6)
        assert found.multiple[0] == 1 and found.distance[0] <= 1e-9
        turned = found.x[0, 0] / (2 * np.pi)
        np.testing.assert_allclose([turned - np.rint(turned), found.x[1, 0] - V], 0, atol=1e-8)
        assert 6 < found.scale[0, 0] <= 2 * np.pi  # the ends of 48 steps


def test_an_orbit_of_two_turns_is_compared_with_its_record_phase_by_phase():
    """z' = (1 - k + i w/2) z - |z|^2 z + k exp(i w t) z* has the orbits +-exp(i w t/2), with the multipliers exp(-4 k T)."""
    x, y = State("x", "1", "x"), State("y", "1", "y")
    w, k = Parameter("w", "1", "w"), Parameter("k", "1", "k")
    c, s, gain = k * cos(w * t), k * sin(w * t), 1 - k - x**2 - y**2
    model = Model(
        "halved", (x, y), (w, k), {x: gain * x - w * y / 2 + c * x + s * y, y: gain * y + w * x / 2 + s * x - c * y},
        harmonics=(w,),
    )  # fmt: skip
    begin = np.array([[np.cos(0.3)], [np.sin(0.3)]])
    e = Ensemble(model, np.array([[W], [1e-4]]), begin, orders=(1,), steps=48, method=DOP853)
    path = e.advance(201, save_periods=1).saved[:, :, 0]
    for m in (2, 4):
        found = close_orbits(e, ONE, np.array([m]), [path], {}, 1e-6)
        assert found.multiple[0] == 2
        np.testing.assert_allclose(found.x[:, 0], [-1, 0], atol=1e-8)
    assert close_orbits(e, ONE, np.array([2]), [path[:-1]], {}, 1e-6).multiple[0] == 0  # a record of the other phase


def test_a_motion_that_does_not_come_nearer_goes_elsewhere(rotor):
    e, path = record(rotor, [0.3, 0.0], 200)
    moves_away = path[::-1] - path[0] + e.x[:, 0]
    on_it = close_orbits(e, ONE, np.array([1]), [path], CYCLIC, 1e-6).x.T.repeat(2, axis=0)
    for wrong, why in ((moves_away, "away"), (on_it, "too short a record")):
        assert close_orbits(e, ONE, np.array([1]), [wrong], CYCLIC, 1e-6).multiple[0] == 0, why


def test_an_orbit_that_repels_is_closed_but_does_not_count(rotor):
    e, path = record(rotor, [1e-4, 0.0], 20, damping=-D)
    x, distance, went = newton(e, ONE, np.array([1]), CYCLIC)
    assert distance[0] <= 1e-9 and abs(x[1, 0] - V) < 1e-8
    np.testing.assert_allclose(np.abs(np.linalg.eigvals(went.matrix[0])), 1 / MODULUS, rtol=1e-7)
    assert close_orbits(e, ONE, np.array([1]), [path], CYCLIC, 1e-6).multiple[0] == 0


def test_orbits_further_off_than_a_run_that_returned_can_be_are_left_alone(rotor):
    """A swing of 0.3 is 0.05 of a turn; closed all the same where the way does not count."""
    e = runs(rotor, [0.05, 0.0], [0.3, 0.0])
    kinds = [
        [orbit.closed for orbit in closed_orbits(e, np.ones(2, dtype=int), every=1, tolerance=1e-6, cyclic=CYCLIC, **how)]
        for how in ({}, {"far": np.inf}, {"far": None})
    ]
    assert kinds == [[True, False], [True, True], [False, False]]


def test_the_numbers_of_a_point_do_not_depend_on_the_others(rotor):
    e = runs(rotor, [0.3, 0.0], [0.05, 0.1], [-0.2, 0.0])
    whole = newton(e, np.arange(3), np.full(3, 2), CYCLIC)
    for k in range(3):
        x, distance, went = newton(e, np.array([k]), np.array([2]), CYCLIC)
        assert (x[:, 0] == whole[0][:, k]).all() and distance[0] == whole[1][k]
        assert (went.matrix[0] == whole[2].matrix[k]).all() and (went.path[:, :, 0] == whole[2].path[:, :, k]).all()
