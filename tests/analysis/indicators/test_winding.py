"""Weighted Birkhoff averages: exact on rigid rotations, super-convergent on the circle map, slow in chaos."""

from fractions import Fraction

import numpy as np
import pytest
from tests.analysis.maps import GOLDEN, circle_map, logistic, sines

from whirlmap.analysis.indicators.birkhoff import converged_digits, locking_ratio, rotation_number, weighted_average
from whirlmap.errors import RangeError


def plane(turns, *, wobble=0.3):
    """A closed curve that is no circle, gone round by the given angles."""
    angle = 2 * np.pi * np.asarray(turns)
    radius = 1 + wobble * np.cos(angle + 1)
    return radius * np.cos(angle), 0.4 * radius * np.sin(angle)


def test_average_of_a_constant_is_exact():
    np.testing.assert_allclose(weighted_average(np.full(100, 2.5)), 2.5, rtol=1e-14)


def test_average_converges_faster_than_any_power():
    """cos^2 over a golden rotation has mean 1/2; a plain mean of 1000 is good to 1e-3."""
    x = np.cos(2 * np.pi * GOLDEN * np.arange(2000)) ** 2
    assert abs(float(weighted_average(x[:500])) - 0.5) < 1e-7
    assert abs(float(weighted_average(x)) - 0.5) < 1e-13
    assert abs(x[:500].mean() - 0.5) > 1e-5


@pytest.mark.parametrize("rate", [GOLDEN, 1 - GOLDEN, 0.02137, 0.49, 1 / np.pi])
def test_winding_of_a_rigid_rotation(rate, validate):
    found = rotation_number(*plane(rate * np.arange(2000) + 0.1))
    assert found.status == "ok"
    validate(f"rigid rotation by {rate:.4g}: rotation number", found.number, rate, tier="exact", source="as it was made",
             within=1e-9)  # fmt: skip
    assert found.error < 1e-7


def test_winding_of_the_circle_map_against_its_lift():
    """The lift's total turn over N is the rotation number to 1/N; the average is far better, as half a record shows."""
    lift = circle_map(0.4, 0.8, 4000)
    found = rotation_number(*plane(lift))
    assert found.number == pytest.approx((lift[-1] - lift[0]) / 3999, abs=3e-4)
    assert found.error < 1e-9
    assert not locking_ratio(found.number, found.error).locked


def test_a_locked_circle_map_has_a_rational_winding():
    """K = 0.9 at Omega = 1/2: by symmetry the rotation number is exactly 1/2. At 0.5 + 1e-3 it is locked there."""
    found = rotation_number(*plane(circle_map(0.501, 0.9, 2000)))
    assert found.number == pytest.approx(0.5, abs=1e-12)
    locking = locking_ratio(found.number, found.error)
    assert locking.locked and locking.ratio == Fraction(1, 2)


def test_locking_names_the_nearest_ratio_where_it_is_none():
    locking = locking_ratio(GOLDEN, 1e-12, most=21)
    assert (locking.locked, locking.ratio) == (False, Fraction(13, 21))
    with pytest.raises(RangeError, match="cannot be told"):
        locking_ratio(0.3, 1e-3)


def test_digits_tell_tori_from_chaos():
    torus = np.stack([sines(1024, GOLDEN / 2, np.sqrt(2) - 1), np.cos(2 * np.pi * circle_map(0.4, 0.8, 1024))], axis=1)
    chaos = np.stack([logistic(4.0, 1024), logistic(3.7, 1024)], axis=1)
    assert (converged_digits(torus) > 6).all()
    assert (converged_digits(chaos) < 3).all()
    assert np.isnan(converged_digits(np.ones(100)))


def test_chaos_has_no_winding_number():
    x = logistic(4.0, 2000)
    assert rotation_number(x[1:], x[:-1]).status == "through-centre"
