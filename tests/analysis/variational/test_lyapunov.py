"""Exponents from the tangent dynamics: exact sums, eigenvalues, and known chaotic values."""

import numpy as np
import pytest

import whirlmap
from whirlmap.analysis.variational.lyapunov import in_phase, mean_and_error
from whirlmap.errors import RangeError


def test_exponents_of_an_equilibrium_are_the_real_parts_of_its_eigenvalues():
    """Lorenz below the first bifurcation settles at the origin: the spectrum is exact there."""
    system = whirlmap.load("lorenz", rho=0.5)
    ds = whirlmap.lyapunov_spectrum(system, transient=60, common_periods=64, starts=2)
    eigenvalues = np.sort(np.linalg.eigvals(system.jacobian(0.0, np.zeros(3))).real)[::-1]
    np.testing.assert_allclose(ds["lyapunov"], eigenvalues, atol=1e-5)  # RK4's own error at 100 steps per turn


@pytest.mark.parametrize(("case", "total"), [("lorenz", -(10 + 1 + 8 / 3)), ("duffing", -0.3)])
def test_exponents_sum_to_the_divergence(case, total):
    ds = whirlmap.lyapunov_spectrum(whirlmap.load(case), transient=40, common_periods=64, starts=2)
    assert float(ds["lyapunov"].sum()) == pytest.approx(total, abs=1e-6)


def test_duffing_is_chaotic_with_the_known_exponent():
    """0.1057 +- 0.001 from an independent computation; three errors of both, and one percent."""
    ds = whirlmap.lyapunov_spectrum(whirlmap.load("duffing"), transient=200, common_periods=1600, starts=32)
    error = float(ds["lyapunov_error"][0])
    assert error < 0.002
    assert abs(float(ds["lyapunov"][0]) - 0.1057) < 3 * np.hypot(error, 0.001) + 0.01 * 0.1057
    assert float(ds["phase_exponent"]) == 0.0


def test_the_running_mean_is_the_estimate_of_every_shorter_run():
    """After k periods it is the spectrum of a run of k periods, and at each k its exponents add up to the divergence."""
    system, short = whirlmap.load("duffing"), 17
    ds = whirlmap.lyapunov_spectrum(system, transient=20, common_periods=32, starts=4)
    assert ds["running"].shape == (32, 2)
    np.testing.assert_allclose(ds["running"].sum("exponent"), -0.3, atol=1e-6)
    assert np.ptp(ds["running"].values[:, 0]) > 0.05  # chaos: the mean has far to go
    for periods, of in ((short, whirlmap.lyapunov_spectrum(system, transient=20, common_periods=short, starts=4)), (32, ds)):
        np.testing.assert_allclose(ds["running"][periods - 1], of["lyapunov"], rtol=1e-9)


def test_impossible_counts_are_refused():
    system = whirlmap.load("duffing")
    with pytest.raises(RangeError, match="2 exponents; 3"):
        whirlmap.lyapunov_spectrum(system, count=3)
    with pytest.raises(RangeError, match="at least 16 periods"):
        whirlmap.lyapunov_spectrum(system, common_periods=4)


@pytest.mark.parametrize("cycle", [16.0, 15.97, 20.9, 3.7])
def test_a_growth_that_returns_has_no_sign(cycle):
    """The growth of a vector along a cycle is that of the speed; cut off anywhere, also in blocks in step with the cycle."""
    phase = 2 * np.pi * (0.3 + np.arange(257) / cycle)
    rates = np.diff(np.log(1.2 + np.cos(phase)))
    value, error = mean_and_error(rates)
    shared = float(in_phase(np.repeat(rates[:, None, None], 32, axis=2))[0])
    assert abs(value) <= 3 * shared + 1e-12 and shared <= error < 0.03


def test_random_records_keep_the_error_of_their_blocks():
    rates = np.random.default_rng(3).normal(size=(1024, 50))
    error = mean_and_error(rates)[1]
    assert np.mean(error) == pytest.approx(1 / 32, rel=0.05)
