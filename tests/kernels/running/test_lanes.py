"""The phase-locked kernel: RK4 as the textbook has it, and lanes that never see each other."""

from fractions import Fraction

import numpy as np
import pytest
from tests.independent.newton import Machine

from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.system import System
from whirlmap.kernels.methods import DOP853
from whirlmap.kernels.running.reference import reference_rates
from whirlmap.models import family

SWEEP_PSI = np.array([0.0, 1e-3, 0.0, 0.1, 1e-4, 0.0, 1e-3])


def gear_pair(psi=0.0, s=1.7, **changes):
    model = family("gear_pair").model(edition="physical", film="porous", arc="fixed")
    ratios = {"r_p": 1.0, "r_g": Fraction(-1, 2), "r_m": 20.0, "j_p": 1.0, "j_g": -0.5}
    groups = {**Machine(chi_g=0.4).groups(s, **ratios), "psi": psi, **changes}
    return System(model, {p.name: groups[p.name] for p in model.parameters})


def sweep(count, seed=0):
    """Operating points that differ in speed, permeability and start state."""
    rng = np.random.default_rng(seed)
    base = gear_pair()
    values = np.repeat(base.vector[:, None], count, axis=1)
    values[base.parameters.index("s")] = rng.uniform(1.2, 4.0, count)
    values[base.parameters.index("psi")] = np.resize(SWEEP_PSI, count)
    x = rng.uniform(-0.3, 0.3, (20, count))
    return base, values, x


def textbook(system, x, steps, count):
    """Kutta's method with the reference kernel, time from the step's number; states after each step."""
    rates, values = reference_rates(system.plain_model()), system.vector
    h, out = system.period / steps, []
    for n in range(count):
        f = lambda c, y: rates((n + c) * h, y, values)  # noqa: E731, B023
        k1 = f(0.0, x)
        k2 = f(0.5, x + h / 2 * k1)
        k3 = f(0.5, x + h / 2 * k2)
        k4 = f(1.0, x + h * k3)
        x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        out.append(x)
    return np.stack(out)


def ensemble(system, x, steps, **more):
    return Ensemble(system.model, system.vector[:, None], x[:, None], orders=system.orders, steps=steps, **more)


def test_gear_pair_steps_are_the_textbooks():
    """One and a half turns of the gear: the slow harmonics must not restart with T. Rounding only: 1e-12."""
    system = gear_pair()
    x = np.random.default_rng(1).uniform(-0.3, 0.3, 20)
    run = ensemble(system, x, 6)
    first = run.advance(25, save_every=1).saved[..., 0]  # in two calls, the second from the middle of a cycle
    second = run.advance(35, save_every=1).saved[..., 0]
    got = np.concatenate([first, second])
    expected = textbook(system, x, 6, 360)
    assert system.common_multiple == 40
    np.testing.assert_allclose(got, expected, rtol=0, atol=1e-12)


def test_forced_and_unforced_oscillators_step_like_the_textbook():
    for name, values in (
        ("duffing", {"delta": 0.2, "alpha": -1, "beta": 1, "gamma": 0.3, "omega": 1.2}),
        ("lorenz", {"sigma": 10, "rho": 28, "beta": 8 / 3}),
    ):
        system = System(family(name).model(), values)
        x = np.array([s.start for s in system.model.states])
        got = ensemble(system, x, 50, tangents=1).advance(3, save_every=1).saved[..., 0]  # shared kernel
        np.testing.assert_allclose(got, textbook(system, x, 50, 150), rtol=1e-11, atol=1e-11)


def numbers(values, x, base, which, **more):
    """Everything that a run of some of the points records."""
    e = Ensemble(base.model, values[:, which], x[:, which], orders=base.orders, steps=8, **more)
    part = e.advance(10, save_every=7, extremes=True)
    return [part.saved, e.x, *part.extremes.values()]


@pytest.fixture(scope="module")
def together():
    base, values, x = sweep(75)
    return base, values, x, numbers(values, x, base, np.arange(75), workers=1)


def same(got, expected, which):
    for a, b in zip(got, expected, strict=True):
        np.testing.assert_array_equal(a, b[..., which])


@pytest.mark.parametrize("workers", [2, 5])
def test_number_of_workers_changes_no_bit(together, workers):
    base, values, x, expected = together
    same(numbers(values, x, base, np.arange(75), workers=workers), expected, np.arange(75))


@pytest.mark.parametrize("seed", [1, 2])
def test_order_of_points_changes_no_bit(together, seed):
    """Every point gets another lane, another block and other neighbours; psi = 0 and psi > 0 are mixed."""
    base, values, x, expected = together
    which = np.random.default_rng(seed).permutation(75)
    same(numbers(values, x, base, which), expected, which)


@pytest.mark.parametrize("point", [0, 1, 3, 40, 74])
def test_a_point_alone_has_the_same_bits(together, point):
    base, values, x, expected = together
    assert np.isfinite(expected[0][..., point]).all()
    same(numbers(values, x, base, np.array([point])), expected, np.array([point]))


def test_neighbours_that_end_change_no_bit(together):
    """Points that diverge, start behind the wall or as NaN leave the others alone, also in their block."""
    base, values, x, expected = together
    broken = x.copy()
    broken[16, [5, 6, 33]] = [np.nan, 1e7, np.nan]  # a housing's velocity
    broken[0, [2, 8]], broken[1, [2, 8]] = 1.01, 0.0  # behind the wall
    others = np.setdiff1d(np.arange(75), [5, 6, 33, 2, 8])
    got = numbers(values, broken, base, np.arange(75))
    same([a[..., others] for a in got], expected, others)


def test_a_run_in_pieces_has_the_same_bits(together):
    base, values, x, expected = together
    e = Ensemble(base.model, values, x, orders=base.orders, steps=8)
    for n in (1, 2, 3, 4):
        e.advance(n)
    np.testing.assert_array_equal(e.x, expected[1])


def test_extremes_are_those_of_all_steps(together):
    base, values, x, _ = together
    which = np.arange(10)
    e = Ensemble(base.model, values[:, which], x[:, which], orders=base.orders, steps=8)
    part = e.advance(10, save_every=1, extremes=True)
    orbit = part.saved  # (step, state, point)
    eps = np.stack([np.hypot(orbit[:, 0], orbit[:, 1]), np.hypot(orbit[:, 2], orbit[:, 3])], axis=1)
    kappa_g = values[base.parameters.index("kappa_g"), which]
    sag = [orbit[:, 4 + k] - orbit[:, 8 + k] - orbit[:, k] for k in range(4)]  # rotor less housing less journal
    load = np.stack([np.hypot(*sag[:2]) / 2, kappa_g * np.hypot(*sag[2:]) / 2], axis=1)
    rows = np.concatenate([orbit, eps, load], axis=1)
    for name, expected in (
        ("minimum", rows.min(0)), ("maximum", rows.max(0)), ("mean", rows.mean(0)), ("rms", rows.std(0)),
    ):  # fmt: skip
        np.testing.assert_allclose(part.extremes[name], expected, rtol=1e-9, atol=1e-13, err_msg=name)


def test_tangents_do_not_depend_on_company_or_memory():
    """Growth and states of 40 Duffing oscillators, in two threads and one by one."""
    system = System(family("duffing").model(), {"delta": 0.2, "alpha": -1, "beta": 1, "gamma": 0.3, "omega": 1.0})
    rng = np.random.default_rng(9)
    x, values = rng.uniform(-1, 1, (2, 40)), np.repeat(system.vector[:, None], 40, axis=1)
    values[3] = rng.uniform(0.2, 0.5, 40)

    def run(which, workers):
        e = Ensemble(system.model, values[:, which], x[:, which], orders=system.orders, steps=20, tangents=1,
                     workers=workers)  # fmt: skip
        part = e.advance(30, save_every=9, extremes=True)
        return [part.growth, part.saved, e.x, *part.extremes.values()]

    expected = run(np.arange(40), 1)
    kept = []
    for _ in range(30):
        kept = [*kept[-20:], np.empty(rng.integers(1, 40_000))]
        same(run(np.arange(40), 2), expected, np.arange(40))
    for point in (0, 17, 39):
        same(run(np.array([point]), 1), expected, np.array([point]))


@pytest.mark.parametrize("psi", [0.0, 1e-3])
def test_one_tangent_vector_is_the_first_of_two(psi):
    """The derivative along a vector against the Jacobian's product with it: two kernels, equal to rounding."""
    base, values, x = sweep(20)
    values[base.parameters.index("psi")] = psi
    found = []
    for count in (1, 2):
        e = Ensemble(base.model, values, x, orders=base.orders, steps=12, tangents=count, method=DOP853)
        e._y[20:40] = np.eye(20)[7, :, None]  # along yg in all points; the second one stays as it was made
        found.append((e.advance(4).growth[:, 0], e._y[20:40]))
    assert np.abs(found[0][0]).max() > 0.1  # the vectors have grown or shrunk
    for one, two in zip(*found, strict=True):
        np.testing.assert_allclose(one, two, rtol=1e-9, atol=1e-9)
