"""Every contender integrates the same problem: its rates, and its end states, are held against the oracle."""

import numpy as np
import pytest

from contest.c_reference import CRun, compiler
from contest.film_fit import film_fit, mobilities
from contest.problems import Problem, duffing, gear_pair
from contest.scalar_code import evaluate_inputs, numba_rhs, scalar_code
from contest.turns import Contender, scipy_run, take_turns, whirlmap_run
from whirlmap.errors import InputError, ModelError, RangeError
from whirlmap.films.porous_short import film_integrals
from whirlmap.kernels.running.reference import reference_rates


@pytest.fixture(scope="module")
def plain():
    return gear_pair(0.0, 3)


@pytest.fixture(scope="module")
def porous():
    return gear_pair(1e-3, 3)


def states_nearby(problem: Problem):
    return problem.x0 + 0.02 * np.random.default_rng(3).normal(size=problem.x0.shape)


@pytest.mark.parametrize("harmonics_as", ["states", "time"])
@pytest.mark.parametrize("which", ["plain", "porous"])
def test_rates_of_heyoka_equal_the_reference(which, harmonics_as, request):
    """The porous film is a fit there: its own error of 3e-14 counts on top of rounding, times a load of order ten."""
    pytest.importorskip("heyoka")
    from contest.taylor import rates, taylor_system

    problem = request.getfixturevalue(which)
    x = states_nearby(problem)
    exact = reference_rates(problem.model)(0.7, x, problem.values)
    found = rates(problem, taylor_system(problem, harmonics_as=harmonics_as), 0.7, x)
    np.testing.assert_allclose(found, exact, rtol=1e-12, atol=1e-12 * np.abs(exact).max())


def test_a_coarse_film_fit_shows_in_the_rates(porous):
    pytest.importorskip("heyoka")
    from contest.taylor import rates, taylor_system

    x = states_nearby(porous)
    exact = reference_rates(porous.model)(0.7, x, porous.values)
    coarse = np.abs(rates(porous, taylor_system(porous, fit_error=1e-4), 0.7, x) - exact).max()
    assert 1e-8 < coarse < 1e-1


def test_rates_for_scipy_equal_the_reference(plain):
    x = states_nearby(plain)
    exact = reference_rates(plain.model)(0.7, x, plain.values)
    inputs = evaluate_inputs(scalar_code(plain.model).hoisted, plain.values)
    for i in range(plain.points):
        found = numba_rhs(plain.model)(0.7, x[:, i], np.ascontiguousarray(inputs[:, i]))
        np.testing.assert_allclose(found, exact[:, i], rtol=1e-12, atol=1e-12 * np.abs(exact).max())


def test_code_for_one_point_refuses_tables(porous):
    with pytest.raises(ModelError, match="closed forms only"):
        scalar_code(porous.model)


@pytest.mark.parametrize("lanes", [1, 2])
def test_c_takes_the_same_steps_as_the_lanes(plain, lanes):
    """RK4 with equal steps: only rounding differs; three points in batches of two leave one lane over."""
    try:
        compiler()
    except InputError as error:
        pytest.skip(str(error))
    ours = whirlmap_run(plain, "rk4", 120)()[1]
    np.testing.assert_allclose(CRun(plain, steps=120, lanes=lanes)()[1], ours, rtol=0, atol=1e-9)


def test_duffing_ends_where_scipy_ends():
    problem = duffing(2)
    exact = scipy_run(problem, "DOP853", 1e-12)()[1]
    ours = Contender("whirlmap rk4", problem, 400, 32, whirlmap_run(problem, "rk4", 400))
    take_turns([ours], 1, lambda _: None)
    row = ours.row(exact)
    assert row["median_error"] <= row["worst_error"] < 1e-7
    assert row["us_per_lane_and_T"] > 0


def test_orbits_through_the_centre_are_left_out_of_the_errors(plain):
    """A point that is said to pass the centre must not decide the worst error."""
    problem = gear_pair(0.0, 3)
    problem.__dict__["eccentricity"] = (np.array([0.5, 0.001, 0.5]), np.array([0.8, 0.8, 0.8]))
    ends = problem.x0.copy()
    ends[0, 1] += 1.0
    c = Contender("x", problem, 1, 1, lambda: (1.0, ends))
    c.turn()
    assert c.row(problem.x0)["worst_error"] == 0.0
    c.problem = plain
    assert c.row(plain.x0)["worst_error"] == 1.0


def test_mobilities_are_those_of_the_film_integrals():
    e = np.array([0.2, 0.6, 0.85])
    G, B, D = film_integrals(e, 1e-3)
    delta = G * D - B * B
    np.testing.assert_allclose(mobilities(e**2, 1e-3), [D / delta, (G - D) / (delta * e**2), B / (delta * e)], rtol=1e-10)


@pytest.mark.parametrize("error", [1e-4, 1e-8, 1e-12])
def test_film_fit_keeps_its_promise_between_its_points(error):
    fit = film_fit(1e-3, 0.85, error)
    e2 = np.random.default_rng(1).uniform(0, 0.85**2, 300)
    assert np.abs(fit(e2) - mobilities(e2, 1e-3)).max() < 2 * error


def test_tighter_fits_take_more_products():
    assert film_fit(1e-3, 0.85, 1e-3).products < film_fit(1e-3, 0.85, 1e-12).products


def test_a_fit_that_cannot_be_had_is_refused():
    with pytest.raises(RangeError, match="the best has"):
        film_fit(1e-3, 0.85, 1e-18)


def test_the_c_kernel_leaves_the_arithmetic_of_the_process_alone(plain):
    """gcc links code into a library made with -ffast-math that flushes tiny numbers to zero where it is loaded."""
    try:
        compiler()
    except InputError as error:
        pytest.skip(str(error))
    CRun(plain, steps=61, lanes=2)  # a module that no other test has loaded
    halved = np.array([1e-310]) * 0.5
    assert halved.view(np.int64)[0] != 0  # its bits: a comparison would take tiny numbers for zero as well
