"""Published and independently computed numbers, with their errors.

Block standard errors of one chaotic run are too small (two runs differed by 2.6 of them), so that exponents are means
over 32 lanes with different starts; tolerance: three of the table's errors plus 1 %, as its head says.
"""

import numpy as np
import pytest

import whirlmap
from whirlmap.analysis.steady.periodicity import return_multiple
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.system import System
from whirlmap.models import family
from whirlmap.results.regime import Regime


def lanes(name, values, x, steps, swept=None):
    """Ensemble with one tangent vector; ``swept`` gives one parameter a value in each lane."""
    system = System(family(name).model(), values)
    many = np.repeat(system.vector[:, None], x.shape[1], axis=1)
    for parameter, numbers in (swept or {}).items():
        many[system.parameters.index(parameter)] = numbers
    return Ensemble(system.model, many, x, orders=system.orders, steps=steps, tangents=1)


def starts(seed, low, high, count=32):
    return np.random.default_rng(seed).uniform(np.array(low)[:, None], np.array(high)[:, None], (len(low), count))


PUBLISHED = "published", "Sprott, common chaotic systems"
OWN = "independent", "Runge-Kutta in tangent space with QR, other code"
DUFFING_UEDA = {"delta": 0.2, "alpha": -1.0, "beta": 1.0, "gamma": 0.3, "omega": 1.0}
DUFFING = {"delta": 0.3, "alpha": -1.0, "beta": 1.0, "gamma": 0.5, "omega": 1.2}


@pytest.mark.parametrize(
    ("name", "values", "low", "high", "steps", "periods", "exponent", "error"),
    [
        ("lorenz", {"sigma": 10.0, "rho": 28.0, "beta": 8 / 3}, (-5, -5, 20), (5, 5, 30), 75, 8000, 0.9056, 0.0004),
        ("roessler", {"a": 0.2, "b": 0.2, "c": 5.7}, (-3, -3, 0), (3, 3, 0.3), 200, 1500, 0.0714, 0.0003),
        ("duffing", DUFFING_UEDA, (-1, -1), (1, 1), 100, 8000, 0.1587, 0.0004),
        ("duffing", DUFFING, (-1, -1), (1, 1), 100, 3000, 0.1057, 0.001),
    ],
)
def test_largest_exponents(name, values, low, high, steps, periods, exponent, error, validate):
    e = lanes(name, values, starts(1, low, high), steps)
    e.advance(60)
    growth = e.advance(periods).growth[:, 0]
    assert (e.status == 0).all()
    each = growth.mean(axis=0) / e.period
    assert each.min() > 0  # every start is on the chaotic attractor
    own_error = each.std() / np.sqrt(each.size)
    assert own_error < error  # the lanes are enough to speak
    tier, source = PUBLISHED if name in ("lorenz", "roessler") else OWN
    shown = ", ".join(f"{key} {value:g}" for key, value in values.items())
    validate(
        f"{name}, {shown}: largest Lyapunov exponent", each.mean(), exponent, tier=tier, source=source,
        within=3 * error + 0.01 * exponent,
    )  # fmt: skip


LADDER = {0.20: 1, 0.28: 2, 0.29: 4, 0.37: 5, 0.50: 0, 0.65: 2}  # multiple 0: nothing returns


def multiples(name, values, swept, x, *, settle, steps, most=16):
    e = lanes(name, values, x, steps, swept)
    e.advance(settle)
    part = e.advance(2 * most + 1, save_every=steps)
    size = e.advance(2 * most, extremes=True).extremes
    scale = (size["maximum"] - size["minimum"])[: x.shape[0]]
    return return_multiple(part.saved, scale=scale, tolerance=1e-6, most=most)


@pytest.mark.parametrize("start", [(1.0, 0.0), (0.0, 0.0), (-1.0, 0.5)])
def test_duffings_period_ladder(start, validate):
    gamma = np.array(list(LADDER))
    x = np.repeat(np.array(start)[:, None], gamma.size, axis=1)
    found = multiples("duffing", DUFFING, {"gamma": gamma}, x, settle=1500, steps=150)
    said, truth = (", ".join(f"{g:g}: {n}T" if n else f"{g:g}: none" for g, n in zip(gamma, ns, strict=True))
                   for ns in (found.multiple.values, LADDER.values()))  # fmt: skip
    validate(f"Duffing, delta 0.3, omega 1.2, from {start}: period at each gamma", said, truth, tier="independent",
             source="Newton's method on the stroboscopic map, other code")  # fmt: skip
    assert found.nearest_multiple.values[4] > 0
    assert found.distance.values[4] > 1e-3  # chaos is far from returning, not just beyond the tolerance


def test_duffings_first_doublings():
    """At 0.265581786 and 0.286693158, bracketed by 2e-4; 20 000 periods, for multipliers there are within 1 % of -1."""
    at = np.array([0.265581786, 0.286693158])
    gamma = np.array([at[0] - 2e-4, at[0] + 2e-4, at[1] - 2e-4, at[1] + 2e-4])
    x = np.repeat([[1.0], [0.0]], 4, axis=1)
    found = multiples("duffing", DUFFING, {"gamma": gamma}, x, settle=20_000, steps=100)
    assert found.multiple.values.tolist() == [1, 2, 2, 4]


def test_roesslers_one_loop_cycle(validate):
    """Through (0, 6.0918, 1.2997), back after 5.88108845586: ChaosBook. Located with one short step by the oracle."""
    system = System(family("roessler").model(), {"a": 0.2, "b": 0.2, "c": 5.7})
    x = np.array([0.0, 6.09176831742, 1.29973195919])
    e = lanes("roessler", system.values, x[:, None], 5900)  # typical time 5.9: steps of 0.001
    orbit = e.advance(1, save_every=1).saved[..., 0]
    falling = np.flatnonzero((orbit[:-1, 0] > 0) & (orbit[1:, 0] <= 0))  # as at the start: x' = -y - z < 0
    before = falling[-1]
    y, time = orbit[before], (before + 1) * 0.001
    period = time
    for _ in range(4):
        rate = system.reference_rhs(0.0, y)
        step = -y[0] / rate[0]
        middle = y + step / 2 * rate
        y, period = y + step * system.reference_rhs(0.0, middle), period + step
    validate("Roessler a = b = 0.2, c = 5.7: period of the one-loop cycle, integrated from its published point", period,
             5.88108845586, tier="published", source="ChaosBook", within=2e-8)  # eleven digits, times its multiplier
    np.testing.assert_allclose(y, x, rtol=0, atol=1e-7)


def test_lorenzs_hopf_bifurcation(validate):
    """rho = 470/19: a pair of eigenvalues of the foci lies on the imaginary axis."""
    rho = 470 / 19
    system = System(family("lorenz").model(), {"sigma": 10.0, "rho": rho, "beta": 8 / 3})
    r = np.sqrt(8 / 3 * (rho - 1))
    focus = np.array([r, r, rho - 1])
    np.testing.assert_allclose(system.rhs(0.0, focus), 0, atol=1e-13)
    values = np.linalg.eigvals(system.jacobian(0.0, focus))
    pair = values[np.abs(values.imag) > 1]
    assert pair.size == 2
    validate("Lorenz, rho = 470/19: real parts of the pair that crosses", pair.real, 0, tier="exact",
             source="Hopf bifurcation in closed form", within=1e-13)  # fmt: skip


def test_gear_with_backlash():
    """One degree of freedom, F_m = 0.1: labels of the table, and positive exponents in its chaotic windows."""
    base = {"zeta": 0.05, "F_m": 0.1, "F_ah": 0.2, "Omega": 1.0}
    x = np.repeat(np.array([[1.1, 0.0], [0.0, 0.0]]), 5, axis=1)
    Omega = np.tile(np.linspace(0.3, 1.3, 5), 2)
    x = np.array([[1.1] * 5 + [0.0] * 5, [0.0] * 10])
    quiet = multiples("gear_backlash", base, {"F_ah": np.full(10, 0.05), "Omega": Omega}, x, settle=1500, steps=200)
    assert quiet.multiple.values.tolist() == [1] * 10
    labels = multiples(
        "gear_backlash", base, {"Omega": np.array([0.8, 0.9, 1.0, 0.8, 0.9, 1.0])}, x[:, [0, 0, 0, 5, 5, 5]],
        settle=1500, steps=200,
    ).multiple.values  # fmt: skip
    assert labels[[0, 3]].tolist() == [2, 2]
    assert labels[[1, 4]].tolist() == [4, 4]
    assert set(labels[[2, 5]].tolist()) <= {2, 4}
    chaotic = lanes("gear_backlash", base, starts(4, (0.9, -0.1), (1.3, 0.1)), 200, {"Omega": np.repeat([1.1, 1.2], 16)})
    chaotic.advance(300)
    growth = chaotic.advance(3000).growth[:, 0].mean(axis=0) / chaotic.period
    assert 0.035 < np.median(growth[:16]) < 0.055  # the table's 0.041 to 0.048 and 0.056 to 0.060, fixed-step, widened
    assert 0.050 < np.median(growth[16:]) < 0.066


def test_a_linear_oscillator_that_is_hardly_damped_is_periodic_at_every_speed():
    """Contraction by 0.1 % is slow, and no torus: an exponent below zero by three errors is no zero."""
    system = whirlmap.load("duffing", start={"x": 1.0}, alpha=1.0, beta=0.0, delta=0.002, gamma=0.5)
    ds = whirlmap.bifurcation_diagram(system, "omega", np.linspace(1.9, 2.1, 9), lyapunov=1024)
    assert (ds["period_T"].values == 1).all() and (ds["regime"].values == Regime.periodic).all()
