"""Numbers with units: exact reading, angles as a dimension, and one clear message for each mistake."""

import re
import subprocess
import sys
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest

from whirlmap import units
from whirlmap.errors import CaseError
from whirlmap.models import FAMILIES
from whirlmap.units import convert, exact, factor, read, split


@pytest.mark.parametrize(
    ("value", "unit", "expected"),
    [
        ("50 um", "m", 5e-5),  # through floats: 4.9999999999999996e-05
        ("50 µm", "m", 5e-5),
        ("0.02 Pa*s", "Pa*s", 0.02),
        ("20 mPa*s", "Pa*s", 0.02),
        ("20 cP", "Pa*s", 0.02),
        ("5.2e-16 m^2", "m^2", 5.2e-16),
        ("1e-3 N/um^3", "N/m^3", 1e15),
        ("4 kN/mm", "N/m", 4e6),
        ("250 N s/m", "N*s/m", 250.0),
        ("1 in", "m", 0.0254),
        ("1500 rpm", "rad/s", 50 * np.pi),
        ("25 turn/s", "rad/s", 50 * np.pi),
        ("180 deg", "rad", np.pi),
        ("0.5", "rad", 0.5),
        ("12.5 %", "1", 0.125),
        ("2/3", "1", 2 / 3),
        ("1/4 in", "m", 0.00635),
        (" -3 ", "1", -3.0),
        (3, "1", 3.0),
        (np.float64(0.1), "1", 0.1),
        (np.int64(7), "1", 7.0),
        (Decimal("1e-3"), "1", 1e-3),
        (0, "1", 0.0),
    ],
)
def test_reads_to_the_nearest_float(value, unit, expected):
    assert float(read(value, unit)) == expected


def test_numbers_are_what_was_written_not_the_nearest_float():
    assert read("0.1", "1") == Fraction(1, 10)
    assert exact(0.1) == Fraction(1, 10)
    assert split("50 um") == (50, "um")
    assert read(5, "m", given="um") == Fraction(1, 200_000)


@pytest.mark.parametrize(
    ("value", "unit", "message"),
    [
        ("50", "m", "found '50' without a unit, expected a unit such as m"),
        (50, "m", "found 50 without a unit"),
        ("50 kg", "m", "found the unit 'kg', expected a unit such as m"),
        ("50 umm", "m", "unknown unit 'umm', expected one such as m. Did you mean 'um'?"),
        ("1500 RPM", "rad/s", "Did you mean 'rpm'?"),
        ("25 Hz", "rad/s", "whether turns or radians are meant"),
        ("1500 1/min", "rad/s", "whether turns or radians are meant"),
        ("3 deg", "1", "found the unit 'deg', expected no unit"),
        ("20 degC", "Pa*s", "has an offset"),
        ("nan", "1", "found 'nan', expected a finite number"),
        ("-inf m", "m", "expected a finite number"),
        (float("nan"), "1", "found nan, expected a finite number"),
        (float("inf"), "1", "expected a finite number"),
        (Decimal("NaN"), "1", "expected a finite number"),
        ("abc", "1", "found 'abc', expected a number"),
        ("", "1", "found '', expected a number"),
        ("1e999", "1", "found 1e999, expected one between"),
        (10**400, "1", "beyond the range of floats"),
        ("1e307 km", "m", "beyond the range of floats"),
        ("1/0", "1", "divisor is not zero"),
        (True, "1", "found True, expected a number"),
        (None, "1", "found None, expected a number"),
        ("9 m**99**99**99", "m", "is not a unit"),
        ("9 m^999999999", "m", "is not a unit"),
        ("5 m;import os", "m", "is not a unit"),
        ("5 kg*(", "kg", "unknown unit 'kg*('"),
    ],
)
def test_one_message_says_what_was_found_and_expected(value, unit, message):
    with pytest.raises(CaseError, match=re.escape(message)) as caught:
        read(value, unit)
    assert "\n" not in str(caught.value)


def test_a_unit_is_given_once():
    with pytest.raises(CaseError, match="unit twice"):
        read("50 um", "m", given="um")


def test_convert_shows_a_speed():
    assert convert(50 * np.pi, "rad/s", "rpm") == pytest.approx(1500, rel=1e-15)


def test_every_declared_unit_is_one():
    for family in FAMILIES.values():
        model = family.model()
        inputs = family.groups.inputs if family.groups else ()
        for quantity in (*model.states, *model.parameters, *inputs):
            if quantity.unit not in ("1", "degC"):
                assert factor(f"1 * {quantity.unit}", quantity.unit) == 1


def test_dimensionless_cases_never_load_pint():
    code = (
        "import sys; from whirlmap.cases import read, resolve; resolve(read('duffing'), {'gamma': '0.29'});"
        " assert 'pint' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_units_known_without_pint_are_those_of_pint():
    """A wrong size or power in the table would be a wrong machine, without a word."""
    assert len(units._SI) > 30
    for unit in units._SI.keys() - {"mil"}:  # an angle to pint; an engineer's mil is a thousandth of an inch
        assert units._root(unit, unit) == units._looked_up(unit, unit), unit


@pytest.mark.parametrize(("text", "celsius"), [("65 degC", 65), ("338.15 K", 65), ("149 degF", 65), ("-40 degF", -40)])
def test_temperatures_have_their_zeros(text, celsius):
    assert read(text, "degC") == celsius


def test_a_mil_is_a_length():
    assert read("2 mil", "um") == Fraction("50.8")


def test_stock_cases_never_start_pint():
    """It takes a second, at the start of every command."""
    code = (
        "import sys\nfrom whirlmap.cases import names\nfrom whirlmap.integrate.loading import load\n"
        "for name in names(): load(name)\nassert 'pint' not in sys.modules, 'pint was imported'"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
