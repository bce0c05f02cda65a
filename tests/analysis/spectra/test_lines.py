"""Names of spectral lines, given and found."""

from fractions import Fraction

import numpy as np
import pytest

from whirlmap.analysis.spectra.line_names import name_lines, named_shares
from whirlmap.analysis.spectra.spectral_lines import spectral_lines
from whirlmap.analysis.spectra.spectrum import power_spectrum
from whirlmap.errors import RangeError

GEAR = {"mesh": 1, "pinion": Fraction(1, 4), "gear": Fraction(-1, 8)}


def named(*frequencies, orders=GEAR, **options):
    return [line.name for line in name_lines(frequencies, orders, tolerance=1e-4, **options)]


def test_multiples_come_by_their_simplest_name():
    assert named(1.0, 2.0, 0.25, 0.125, 0.75, 0.375) == [
        "mesh", "2 mesh", "pinion", "gear", "mesh - pinion", "pinion + gear",
    ]  # fmt: skip


def test_sums_and_differences_of_incommensurate_orders():
    orders = {"mesh": 23.0, "pinion": 1.0, "gear": 23 / 41}
    assert named(45.0, 22.0, 23 - 23 / 41, 24 + 23 / 41, orders=orders) == [
        "2 mesh - pinion", "mesh - pinion", "mesh - gear", "mesh + pinion + gear",
    ]  # fmt: skip


def test_subharmonics_are_fractions():
    assert named(1 / 3, 2 / 7, orders={"forcing": 1.0}) == ["1/3 forcing", "2/7 forcing"]


def test_what_fits_nothing_has_no_name():
    (line,) = name_lines([np.sqrt(0.5)], {"forcing": 1.0}, tolerance=1e-4)
    assert line.name == "" and np.isnan(line.deviation)


def test_too_coarse_a_resolution_is_refused():
    with pytest.raises(RangeError, match="longer record"):
        name_lines([1.0], GEAR, tolerance=0.1)


def test_lines_of_a_series_get_names_and_shares():
    """Amplitudes 2, 1 and 0.5: shares 4 : 1 : 0.25 of the power."""
    t = np.arange(8192) / 16
    x = 2 * np.sin(2 * np.pi * t) + np.sin(2 * np.pi * 0.25 * t + 1) + 0.5 * np.sin(2 * np.pi * 1.75 * t + 2)
    spectrum = power_spectrum(x, rate=16)
    found = named_shares(spectral_lines(spectrum), GEAR, step=float(spectrum["frequency_step"]))
    assert [f["name"] for f in found] == ["mesh", "pinion", "2 mesh - pinion"]
    np.testing.assert_allclose([f["share"] for f in found], np.array([4, 1, 0.25]) / 5.25, rtol=1e-3)


def test_a_frequency_of_its_own_becomes_a_base():
    """Forcing 1 and an incommensurate 0.381966: sums are named with f1."""
    f = (3 - np.sqrt(5)) / 2
    t = np.arange(8192) / 16
    x = 2 * np.sin(2 * np.pi * t) + np.sin(2 * np.pi * f * t) + 0.3 * np.sin(2 * np.pi * (1 + f) * t)
    x += 0.2 * np.sin(2 * np.pi * (1 - f) * t)
    spectrum = power_spectrum(x, rate=16)
    step = float(spectrum["frequency_step"])
    found = named_shares(spectral_lines(spectrum), {"forcing": 1.0}, step=step)
    assert [n["name"] for n in found] == ["forcing", "f1", "forcing + f1", "forcing - f1"]
    alone = named_shares(spectral_lines(spectrum), {}, step=step)
    assert [n["name"] for n in alone] == ["f1", "f2", "f1 + f2", "f1 - f2"]
