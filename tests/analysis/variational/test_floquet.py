"""Floquet multipliers against closed forms, published values, and the divergence (Liouville)."""

import numpy as np
import pytest

import whirlmap
from whirlmap.analysis.variational.floquet import floquet_multipliers
from whirlmap.analysis.variational.periodic_schur import eigenvalues_of_products
from whirlmap.errors import RangeError


def values_of(ds):
    return ds["real"].values + 1j * ds["imaginary"].values


def test_a_linear_oscillator_has_the_multipliers_of_its_eigenvalues():
    """x'' + delta x' + x = gamma cos(omega t): exp(lambda T), whatever the orbit."""
    system = whirlmap.load("duffing", alpha=1.0, beta=0.0, delta=0.3, gamma=0.5, omega=1.2)
    x = whirlmap.simulate(system, transient=200, periods=1)["x"].values[-1]
    ds = floquet_multipliers(system, x, system.period)
    root = -0.15 + 1j * np.sqrt(1 - 0.15**2)
    expected = np.exp(root * system.period)
    pair = sorted([expected, expected.conj()], key=np.imag)
    np.testing.assert_allclose(sorted(values_of(ds), key=np.imag), pair, rtol=1e-8)
    assert int(ds.trivial) == -1 and int(ds.stable) == 1
    assert float(ds.closure) < 1e-6


def test_the_product_of_the_multipliers_is_the_contraction_of_volume():
    """Duffing's 4T: exp(-delta 4 T), and stable."""
    system = whirlmap.load("duffing", gamma=0.29)
    x = whirlmap.simulate(system, transient=400, periods=1)["x"].values[-1]
    ds = floquet_multipliers(system, x, 4 * system.period)
    assert float(ds.log_modulus.sum()) == pytest.approx(-0.3 * 4 * system.period, rel=1e-8)
    assert int(ds.stable) == 1


def test_roesslers_unstable_cycle():
    """ChaosBook: T = 5.88108845586, multiplier -2.403953527, and the trivial one. The third from the divergence."""
    system = whirlmap.load("roessler")
    x, period = np.array([0.0, 6.09176831742, 1.29973195919]), 5.88108845586
    ds = floquet_multipliers(system, x, period, steps=8000)
    first, second, third = values_of(ds)
    assert first == pytest.approx(-2.403953527, rel=1e-7)
    assert int(ds.trivial) == 1 and float(ds.trivial_error) < 1e-7
    assert abs(second - 1) < 1e-7
    assert int(ds.stable) == 0
    assert abs(third) < 1e-12


def test_multipliers_below_1e_30_are_good_to_many_digits():
    """Known factors turned by random bases: 1e-12 per segment twice, next to 3 and a rotating pair."""
    rng = np.random.default_rng(2)
    bases = [rng.normal(size=(5, 5)) for _ in range(8)]
    c, s = np.cos(1.0), np.sin(1.0)
    core = np.zeros((5, 5))
    core[0, 0], core[3, 3], core[4, 4] = 1.1, 1e-3, 1e-5
    core[1:3, 1:3] = 0.5 * np.array([[c, -s], [s, c]])
    chain = [bases[(k + 1) % 8] @ core @ np.linalg.inv(bases[k]) for k in range(8)]
    (logs,), (angles,) = eigenvalues_of_products(np.array(chain)[None])
    order = np.argsort(-logs)
    np.testing.assert_allclose(logs[order], 8 * np.log([1.1, 0.5, 0.5, 1e-3, 1e-5]), rtol=1e-9)
    assert np.sort(np.abs(angles))[-2:] == pytest.approx(8.0 - 2 * np.pi)  # eight turns of 1 rad


def test_the_gear_pairs_twenty_multipliers():
    """Over 8 T: stable, their product the mean divergence, the smallest far below rounding."""
    system = whirlmap.load("gear-psfd/reference", s=3.27, psi=1e-4)
    x = whirlmap.simulate(system, transient=1600, periods=8)["x"].values[-1]
    ds = floquet_multipliers(system, x, system.common_period)
    exponents = whirlmap.lyapunov_spectrum(system, transient=60, periods=32, starts=2)["lyapunov"].values
    rates = ds["log_modulus"].values / system.common_period
    assert int(ds.stable) == 1
    np.testing.assert_allclose(rates[:2], exponents[:2], rtol=2e-3)
    assert rates.sum() == pytest.approx(exponents.sum(), rel=1e-3)


def test_impossible_orbits_are_refused():
    system = whirlmap.load("duffing")
    with pytest.raises(RangeError, match="positive time"):
        floquet_multipliers(system, np.zeros(2), 0.0)
