"""Compiled kernels against the reference kernel: every stock model, edition, film and arc; Jacobians; NaN."""

import numpy as np
import pytest
from tests.independent.newton import Machine

from whirlmap.films.porous_short import fixed_arc_velocity, positive_arc_velocity
from whirlmap.integrate.system import System
from whirlmap.kernels.running.reference import reference_rates
from whirlmap.models import FAMILIES, family

GEAR_PAIRS = [
    ("intended", "porous", "fixed", 0.0), ("intended", "porous", "fixed", 1e-3),
    ("physical", "porous", "positive", 0.0), ("physical", "porous", "positive", 0.1),
    ("intended", "printed", "fixed", 1e-3), ("literal", "printed", "fixed", 0.0),
    ("literal", "printed", "fixed", 0.1),
    ("literal", "porous", "fixed", 0.0), ("literal", "porous", "fixed", 1e-4),
]  # fmt: skip
OTHERS = [
    ("duffing", {}), ("pendulum", {}), ("van_der_pol", {}), ("lorenz", {}), ("roessler", {}),
    ("gear_backlash", {}),
    ("jeffcott", {"rotor": "rigid"}), ("jeffcott", {"rotor": "flexible", "arc": "fixed"}),
    ("jeffcott", {"rotor": "flexible", "arc": "positive"}),
]  # fmt: skip


def gear_pair(edition, film, arc, psi, s=1.7):
    model = family("gear_pair").model(edition=edition, film=film, arc=arc)
    ratios = {"r_p": 1.0, "r_g": -0.5, "r_m": 20.0, "j_p": 1.0, "j_g": -0.5}
    groups = {**Machine(chi_p=0.3, chi_g=-1.1).groups(s, **ratios), "psi": psi, "xi_5": 0.06}
    return System(model, {p.name: groups[p.name] for p in model.parameters})


def other(name, switches, seed=1):
    model = family(name).model(**switches)
    rng = np.random.default_rng(seed)
    return System(model, {p.name: rng.uniform(0.5, 1.5) for p in model.parameters})


def states_of(system, rng, count, largest=0.95):
    """Random states; pairs of states that are a journal's position stay inside the bearing."""
    x = rng.uniform(-0.6, 0.6, (system.model.dimension, count))
    names = list(system.states)
    for first in [n for n in names if n in ("u1x", "u2x", "ux")]:
        i = names.index(first)
        size, angle = rng.uniform(0.1, largest, count), rng.uniform(-np.pi, np.pi, count)
        x[i], x[i + 1] = size * np.cos(angle), size * np.sin(angle)
    return x


def test_every_stock_model_is_here():
    assert {"gear_pair", *(name for name, _ in OTHERS)} == set(FAMILIES)


@pytest.mark.parametrize(("edition", "film", "arc", "psi"), GEAR_PAIRS)
def test_gear_pair_compiled_is_its_reference(edition, film, arc, psi):
    system = gear_pair(edition, film, arc, psi)
    x = states_of(system, np.random.default_rng(2), 100)
    limit = 1e-12 if film == "printed" or (psi == 0 and arc == "fixed") else 1e-9  # closed form; table
    for time in (0.0, 3.7, 1234.5):
        got, expected = system.rhs(time, x), system.reference_rhs(time, x)
        assert np.max(np.abs(got - expected) / np.maximum(1, np.abs(expected))) < limit
    assert np.ptp(system.rhs(0.0, x[:, 0]) - system.rhs(0.7, x[:, 0])) > 0.01  # time does something


@pytest.mark.parametrize(("name", "switches"), OTHERS)
def test_stock_model_compiled_is_its_reference(name, switches):
    system = other(name, switches)
    x = states_of(system, np.random.default_rng(3), 60)
    limit = 1e-9 if system.model.tables else 1e-12
    for time in (0.0, 3.7):
        got, expected = system.rhs(time, x), system.reference_rhs(time, x)
        assert np.max(np.abs(got - expected) / np.maximum(1, np.abs(expected))) < limit


# --- Jacobians ---------------------------------------------------------------------------------------------

SIXTH_ORDER = {1: 45 / 60, 2: -9 / 60, 3: 1 / 60}


def differences(rates, x, h):
    """Central differences of order six; shape (state, state, lane)."""
    out = []
    for j in range(x.shape[0]):
        e = np.zeros((x.shape[0], 1))
        e[j] = h
        out.append(sum(k * (rates(x + n * e) - rates(x - n * e)) for n, k in SIXTH_ORDER.items()) / h)
    return np.stack(out, axis=1)


@pytest.mark.parametrize(
    "case",
    [
        ("intended", "porous", "fixed", 0.0),
        ("intended", "porous", "fixed", 1e-3),
        ("intended", "porous", "fixed", 0.1),
        ("literal", "printed", "fixed", 0.1),
        pytest.param(("literal", "porous", "fixed", 0.0), marks=pytest.mark.slow),
        pytest.param(("literal", "porous", "fixed", 1e-3), marks=pytest.mark.slow),
        pytest.param(("physical", "porous", "positive", 1e-3), marks=pytest.mark.slow),
        *OTHERS[:-1],
        pytest.param(OTHERS[-1], marks=pytest.mark.slow),
    ],
    ids=str,
)  # fmt: skip
def test_jacobian_is_the_differenced_right_hand_side(case):
    """To 1e-8 of max(1, |.|). Eccentricities 0.1 to 0.8: at those ends step 2e-3 errs by 1e-10."""
    system = gear_pair(*case) if len(case) == 4 else other(*case)
    x = states_of(system, np.random.default_rng(4), 30, largest=0.8)
    if case[0] == "gear_backlash":
        x = np.concatenate([x, x + 2, x - 2], axis=1)[:, :90]  # within the dead zone and beyond both its edges
        x[0] = np.where(np.abs(np.abs(x[0]) - 1) < 0.01, 0.0, x[0])  # its edges have no derivative
    expected = differences(lambda y: system.reference_rhs(1.3, y), x, 2e-3)
    got = system.jacobian(1.3, x)
    assert np.max(np.abs(got - expected) / np.maximum(1, np.abs(expected))) < 1e-8


# --- tables ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("psi", [1e-6, 1e-4, 1e-3, 0.1, 1.0, 10.0])
@pytest.mark.parametrize("arc", ["fixed", "positive"])
def test_tables_err_by_less_than_1e_9(arc, psi):
    """Velocity per unit load, up to the wall and a little beyond, against the film solved without a table."""
    system = gear_pair("intended", "porous", arc, psi)
    rng = np.random.default_rng(6)
    n = 640
    x = np.zeros((20, n))
    size = np.where(rng.random(n) < 0.5, rng.uniform(0, 1, n), 1 - 10 ** rng.uniform(-6, -1, n))
    size[:20] = 1 + 0.29 * np.cbrt(psi)  # a stage may overshoot
    angle, load = rng.uniform(-np.pi, np.pi, (2, n))
    load[::2] = angle[::2] + 10 ** rng.uniform(-4, -1, n // 2)  # towards the wall
    x[0], x[1] = size * np.cos(angle), size * np.sin(angle)
    Gs = 2 * float(system.values["Gamma_1"]) * 1.7
    x[4], x[5] = x[0] + Gs * np.cos(load), x[1] + Gs * np.sin(load)  # q = d/(2 Gamma s) of length one
    rates = system.rhs(0.0, x)[:2]
    got = rates - 0.5 * np.stack([-x[1], x[0]])
    q = np.cos(load), np.sin(load)
    exact = fixed_arc_velocity(x[0], x[1], *q, psi) if arc == "fixed" else positive_arc_velocity(x[0], x[1], *q, psi)
    assert np.max(np.abs(got - np.stack(exact))) < 1e-9


# --- what is not a number ----------------------------------------------------------------------------------


def test_nan_stays_in_its_own_lane():
    """Fast-math must not lose it, and no table may be read out of bounds through it."""
    for psi, arc in ((0.0, "fixed"), (1e-3, "fixed"), (0.1, "positive")):
        system = gear_pair("intended", "porous", arc, psi)
        x = states_of(system, np.random.default_rng(5), 64)
        good = system.rhs(1.0, x)
        bad = x.copy()
        bad[0, 7], bad[5, 40], bad[1, 41] = np.nan, np.inf, 1e300
        got = system.rhs(1.0, bad)
        others = np.setdiff1d(np.arange(64), [7, 40, 41])
        np.testing.assert_array_equal(got[:, others], good[:, others])
        assert np.isnan(got[0, 7])
        assert not np.isfinite(got[:, 40]).all()
        assert not np.isfinite(got[:, 41]).all()


def test_plain_film_beyond_the_wall_is_not_a_number():
    """At psi = 0 there is no film at eccentricity 1: the root of a negative number must surface."""
    system = gear_pair("intended", "porous", "fixed", 0.0)
    x = states_of(system, np.random.default_rng(5), 2)
    x[0], x[1] = [1.0001, 0.5], 0.0
    assert np.isnan(system.rhs(0.0, x)[0, 0])
    assert np.isfinite(system.rhs(0.0, x)[:, 1]).all()


def test_the_reference_without_forcing_is_the_mean_of_the_forced_one():
    """Forcing enters linearly here, so that its mean over the common period is the autonomous part."""
    system = gear_pair("physical", "porous", "fixed", 0.0)
    x = states_of(system, np.random.default_rng(8), 1)[:, 0]
    times = np.arange(64) / 64 * system.common_period
    mean = np.mean([system.reference_rhs(time, x) for time in times], axis=0)
    still = reference_rates(system.plain_model(), forced=False)(0.0, x, system.vector)
    np.testing.assert_allclose(mean, still, rtol=0, atol=1e-13)
