"""Trajectories against SciPy, the order of the method, and the law that exponents sum to the divergence."""

import numpy as np
import pytest
from scipy.integrate import simpson
from tests.integrate.rotors import at_rest, ensemble, gear_pair, jeffcott, solved

from whirlmap.integrate.system import System
from whirlmap.kernels.methods import METHODS, RK4
from whirlmap.models import family

# --- against DOP853 ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("clock", "s", "psi", "arc", "steps"),
    [
        ("pinion", 1.7, 0.0, "fixed", 200),
        ("mesh", 3.0, 0.0, "fixed", 800),
        pytest.param("pinion", 1.7, 1e-3, "fixed", 200, marks=pytest.mark.slow),
        pytest.param("mesh", 3.0, 0.1, "fixed", 800, marks=pytest.mark.slow),
        pytest.param("pinion", 1.7, 0.0, "positive", 200, marks=pytest.mark.slow),
        pytest.param("mesh", 3.0, 0.1, "positive", 800, marks=pytest.mark.slow),
    ],
)
def test_one_common_period_is_scipys(clock, s, psi, arc, steps):
    """Limit 1e-9: RK4's own error at these steps is 2e-11 and 3e-11, a table's 1e-10 along the way."""
    system = gear_pair(s, psi, clock=clock, arc=arc)
    x = at_rest(system) + 0.05
    expected = solved(system, (0.0, system.common_period), x).y[:, -1]
    e = ensemble(system, x, steps)
    e.advance(system.common_multiple)
    assert e.status[0] == 0
    assert np.max(np.abs(expected - x)) > 0.1  # it went somewhere
    np.testing.assert_allclose(e.x[:, 0], expected, rtol=0, atol=1e-10 if psi == 0 and arc == "fixed" else 1e-9)


def test_a_porous_film_follows_scipy_for_a_turn_of_the_mesh():
    """The fast part of the slow tests above: the table's path, tolerance as there."""
    system = gear_pair(1.7, 0.1)
    x = at_rest(system) + 0.05
    expected = solved(system, (0.0, system.period), x).y[:, -1]
    e = ensemble(system, x, 200)
    e.advance(1)
    np.testing.assert_allclose(e.x[:, 0], expected, rtol=0, atol=1e-10)
    assert np.max(np.abs(expected - x)) > 0.05


# --- order -------------------------------------------------------------------------------------------------


def slopes(errors, steps):
    return np.log(np.divide(errors[:-1], errors[1:])) / np.log(np.divide(steps[1:], steps[:-1]))


def test_rk4_coefficients_meet_the_conditions_of_order_four():
    a = np.zeros((4, 4))
    for i, row in enumerate(RK4.a):
        a[i, : len(row)] = [float(v) for v in row]
    b, c = (np.array([float(v) for v in w]) for w in (RK4.b, RK4.c))
    np.testing.assert_allclose(a.sum(axis=1), c, rtol=0, atol=1e-16)
    conditions = [
        (b.sum(), 1), (b @ c, 1 / 2), (b @ c**2, 1 / 3), (b @ a @ c, 1 / 6), (b @ c**3, 1 / 4),
        ((b * c) @ a @ c, 1 / 8), (b @ a @ c**2, 1 / 12), (b @ a @ a @ c, 1 / 24),
    ]  # fmt: skip
    for got, expected in conditions:
        assert got == pytest.approx(expected, rel=1e-15)
    assert RK4.order == 4
    assert METHODS["rk4"] is RK4


def test_observed_order_is_four_away_from_the_centre():
    """Half a turn of the pinion at eccentricities above 0.05; errors 1e-7 to 1e-9, above rounding by 1e5."""
    system = gear_pair(1.7)
    x = at_rest(system)
    fine = ensemble(system, x, 320)
    orbit = fine.advance(20, save_every=1).saved[..., 0]
    for first in (0, 2):
        assert np.hypot(orbit[:, first], orbit[:, first + 1]).min() > 0.05
    steps, errors = np.array([20, 28, 40, 56, 80]), []
    for n in steps:
        e = ensemble(system, x, int(n))
        e.advance(20)
        errors.append(np.max(np.abs(e.x - fine.x)))
    assert 1e-10 < errors[-1] < errors[0] < 1e-6
    np.testing.assert_allclose(slopes(errors, steps), 4.0, rtol=0, atol=0.05)


def through_the_centre(arc, count):
    """Start states whose orbits hit u = 0 at times that no step hits, and where they are at the end of T.

    Solved backwards and forwards from the centre, so that each half is smooth also with the fixed arc.
    """
    system = jeffcott(arc)
    rng = np.random.default_rng(9)
    starts, ends = [], []
    for _ in range(count):
        centre = np.array([0.0, 0.0, *rng.uniform(-0.6, 0.6, 4)])
        when = rng.uniform(0.15, 0.3)
        starts.append(solved(system, (when, 0.0), centre, rtol=1e-12, atol=1e-13).y[:, -1])
        ends.append(solved(system, (when, 2 * np.pi), centre, rtol=1e-12, atol=1e-13).y[:, -1])
    return system, np.array(starts).T, np.array(ends).T


STEPS = np.array([32, 64, 128, 256])


def errors_through_the_centre(arc, count):
    system, starts, ends = through_the_centre(arc, count)
    out = []
    for n in STEPS:
        e = ensemble(system, starts, int(n))
        orbit = e.advance(1, save_every=1).saved
        out.append(np.sqrt(np.mean((e.x - ends) ** 2)))
    closest = np.hypot(orbit[:, 0], orbit[:, 1]).min(axis=0)
    speed = np.hypot(*np.diff(orbit[: n // 8, :2], axis=0).transpose(1, 0, 2)).max()  # a step's length near it
    assert np.all(closest < speed)  # every orbit passes the centre between two neighbouring steps
    assert np.hypot(starts[0], starts[1]).min() > 0.02
    return out


def test_the_fixed_arc_loses_order_through_the_centre():
    """Its mobility has a kink at u = 0: about second order there, whatever the method."""
    errors = errors_through_the_centre("fixed", 12)
    overall = np.log(errors[0] / errors[-1]) / np.log(STEPS[-1] / STEPS[0])
    assert 1.3 < overall < 2.7, (overall, errors)
    assert errors[-1] > 1e-7


def test_the_positive_arc_keeps_its_order_through_the_centre():
    """Smooth there; 0.15 because the coarsest step is not quite asymptotic, and tables end at 1e-10."""
    errors = errors_through_the_centre("positive", 4)
    overall = np.log(errors[0] / errors[-1]) / np.log(STEPS[-1] / STEPS[0])
    assert overall == pytest.approx(4.0, abs=0.15), errors
    assert errors[-1] < 1e-8


# --- exponents ---------------------------------------------------------------------------------------------


def divergence_along(system, orbit, dt):
    value = np.trace(system.jacobian(0.0, np.ascontiguousarray(orbit.T)))
    return simpson(value, dx=dt) / (dt * (orbit.shape[0] - 1))


CHAOTIC_DUFFING = {"delta": 0.2, "alpha": -1.0, "beta": 1.0, "gamma": 0.3, "omega": 1.0}


@pytest.mark.parametrize(
    ("make", "steps", "count"),
    [
        (lambda: System(family("duffing").model(), CHAOTIC_DUFFING), 200, 50),
        (lambda: System(family("lorenz").model(), {"sigma": 10.0, "rho": 28.0, "beta": 8 / 3}), 500, 50),
        (lambda: (lambda g: System(g.plain_model(), g.values))(gear_pair(1.7)), 40, 40),
    ],
    ids=["duffing", "lorenz", "gear_pair"],
)
def test_all_exponents_sum_to_the_mean_divergence(make, steps, count):
    """Liouville; 1e-6 as in the issue. RK4's share at these steps is 3e-8, 5e-8 and 1.5e-8."""
    system = make()
    model = system.model
    x = at_rest(system) + 0.05 if model.name == "gear_pair" else np.array([s.start for s in model.states])
    e = ensemble(system, x, steps, tangents=model.dimension)
    part = e.advance(count, save_every=1)
    total = part.growth.sum() / (count * system.period)
    orbit = np.concatenate([x[None], part.saved[..., 0]])
    mean = divergence_along(system, orbit, system.period / steps)
    assert total == pytest.approx(mean, rel=0, abs=1e-6)
    known = {"duffing": -0.2, "lorenz": -41 / 3}
    assert mean == pytest.approx(known.get(model.name, mean), abs=1e-12)
    if model.name == "gear_pair":  # film, shafts, mesh and housings all damp; the sum is no accident of one term
        assert -4 < mean < -2


def test_tangent_vectors_stay_orthonormal_and_fall_in_order():
    """Growths are per vector: the first is the largest exponent, the last the smallest."""
    system = System(family("lorenz").model(), {"sigma": 10.0, "rho": 28.0, "beta": 8 / 3})
    e = ensemble(system, [1.0, 1.0, 20.0], 100, tangents=3)
    e.advance(40)
    growth = e.advance(400).growth[..., 0].mean(axis=0) / system.period
    assert growth[0] > 0.7
    assert abs(growth[1]) < 0.05
    assert growth[2] == pytest.approx(-14.57, abs=0.2)
