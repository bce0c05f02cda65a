"""Exponents from the tangent dynamics: exact sums, eigenvalues, and known chaotic values."""

import numpy as np
import pytest

import whirlmap
from whirlmap.errors import RangeError


def test_exponents_of_an_equilibrium_are_the_real_parts_of_its_eigenvalues():
    """Lorenz below the first bifurcation settles at the origin: the spectrum is exact there."""
    system = whirlmap.load("lorenz", rho=0.5)
    ds = whirlmap.lyapunov_spectrum(system, transient=60, periods=64, starts=2)
    eigenvalues = np.sort(np.linalg.eigvals(system.jacobian(0.0, np.zeros(3))).real)[::-1]
    np.testing.assert_allclose(ds["lyapunov"], eigenvalues, atol=1e-5)  # RK4's own error at 100 steps per turn


@pytest.mark.parametrize(("case", "total"), [("lorenz", -(10 + 1 + 8 / 3)), ("duffing", -0.3)])
def test_exponents_sum_to_the_divergence(case, total):
    ds = whirlmap.lyapunov_spectrum(whirlmap.load(case), transient=40, periods=64, starts=2)
    assert float(ds["lyapunov"].sum()) == pytest.approx(total, abs=1e-6)


def test_duffing_is_chaotic_with_the_known_exponent():
    """0.1057 +- 0.001 from an independent computation; three errors of both, and one percent."""
    ds = whirlmap.lyapunov_spectrum(whirlmap.load("duffing"), transient=200, periods=1600, starts=32)
    error = float(ds["lyapunov_error"][0])
    assert error < 0.002
    assert abs(float(ds["lyapunov"][0]) - 0.1057) < 3 * np.hypot(error, 0.001) + 0.01 * 0.1057
    assert float(ds["phase_exponent"]) == 0.0


def test_the_running_mean_ends_at_the_estimate():
    ds = whirlmap.lyapunov_spectrum(whirlmap.load("duffing"), transient=20, periods=32, starts=4)
    np.testing.assert_allclose(ds["running"][-1], ds["lyapunov"], rtol=1e-12)


def test_impossible_counts_are_refused():
    system = whirlmap.load("duffing")
    with pytest.raises(RangeError, match="2 exponents; 3"):
        whirlmap.lyapunov_spectrum(system, count=3)
    with pytest.raises(RangeError, match="at least 16 periods"):
        whirlmap.lyapunov_spectrum(system, periods=4)
