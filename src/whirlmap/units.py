"""Numbers with units, converted once on input; inside, everything is an SI float.

Numbers are read as exact fractions of what was written (`50` and `1e-6`, not the floats nearest to them),
units are scaled exactly, and only the result is rounded, once: ``"50 um"`` is the float ``5e-05``, not
``4.9999999999999996e-05``.

The SI units of case files are known here; pint, which takes a second to start, is imported for any other.
"""

import re
from decimal import Decimal
from fractions import Fraction
from functools import lru_cache
from math import isfinite
from numbers import Integral, Real
from typing import Any

from whirlmap.errors import CaseError, nearest

#: Units that engineers write; what a misspelt unit is compared with.
COMMON = (
    "1", "%", "kg", "g", "lb", "N", "kN", "lbf", "m", "mm", "um", "cm", "in", "mil", "s", "ms", "min", "rpm",
    "rad/s", "turn/s", "rad", "deg", "Pa", "kPa", "MPa", "Pa*s", "mPa*s", "cP", "N/m", "kN/m", "N/um",
    "lbf/in", "N*s/m", "kN*s/m", "N/m^3", "N*m", "m^2", "mm^2", "um^2", "m/s^2", "darcy", "mm/s", "g*mm", "mm^2/s",
    "cSt", "kg/m^3", "kg*m^2", "kW", "MW", "N*m/rad", "N*m*s/rad", "degC", "K",
)  # fmt: skip

_PI = Fraction("3.1415926535897932384626433832795028841971693993751")

#: Size in grams, metres, seconds and radians, and the powers of these.
_UNITS: dict[tuple[int, int, int, int], dict[str, int | Fraction]] = {
    (1, 0, 0, 0): {"kg": 1000, "g": 1},
    (0, 1, 0, 0): {
        "m": 1, "mm": Fraction(1, 10**3), "um": Fraction(1, 10**6), "in": Fraction(254, 10**4),
        "mil": Fraction(254, 10**7),  # a thousandth of an inch; to pint a mil is an angle
    },
    (0, 2, 0, 0): {"m^2": 1, "mm^2": Fraction(1, 10**6), "um^2": Fraction(1, 10**12)},
    (0, 0, 1, 0): {"s": 1, "ms": Fraction(1, 10**3), "min": 60},
    (0, 0, 0, 1): {"rad": 1, "deg": _PI / 180},
    (0, 0, -1, 1): {"rad/s": 1, "turn/s": 2 * _PI, "rpm": _PI / 30},
    (0, 1, -2, 0): {"m/s^2": 1},
    (0, 1, -1, 0): {"m/s": 1, "mm/s": Fraction(1, 10**3)},
    (0, 2, -1, 0): {"m^2/s": 1, "mm^2/s": Fraction(1, 10**6), "cSt": Fraction(1, 10**6)},
    (1, 1, 0, 0): {"kg*m": 1000, "g*mm": Fraction(1, 10**3), "kg*mm": 1},
    (1, -3, 0, 0): {"kg/m^3": 1000, "g/cm^3": 10**6},
    (1, 2, 0, 0): {"kg*m^2": 1000},
    (1, 2, -3, 0): {"W": 1000, "kW": 10**6, "MW": 10**9},
    (1, 2, -2, -1): {"N*m/rad": 1000},
    (1, 2, -1, -1): {"N*m*s/rad": 1000},
    (1, 1, -2, 0): {"N": 10**3, "kN": 10**6},
    (1, 2, -2, 0): {"N*m": 10**3},
    (1, 0, -2, 0): {"N/m": 10**3, "N/mm": 10**6, "kN/m": 10**6, "N/um": 10**9},
    (1, -2, -2, 0): {"N/m^3": 10**3},
    (1, 0, -1, 0): {"N*s/m": 10**3, "kN*s/m": 10**6},
    (1, -1, -2, 0): {"Pa": 10**3, "kPa": 10**6, "MPa": 10**9},
    (1, -1, -1, 0): {"Pa*s": 10**3, "mPa*s": 1, "cP": 1},
    (0, 0, 0, 0): {"1": 1, "%": Fraction(1, 100)},
}
_SI = {unit: (Fraction(size), powers) for powers, units in _UNITS.items() for unit, size in units.items()}
_BASES = ("gram", "meter", "second", "radian")  # as pint calls them

_NUMBER = r"[+-]?(?:\d[\d_]*\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_QUANTITY = re.compile(
    rf"\s*(?P<number>{_NUMBER}(?:\s*/\s*\d+(?![\d.eE]))?)\s*(?P<unit>\S.*?)?\s*", re.DOTALL
)
_NOT_FINITE = re.compile(r"\s*[+-]?(nan|inf|infinity)\b", re.IGNORECASE)
# Numbers in a unit are exponents or the 1 of "1/s"; nothing that could be evaluated into a huge power.
_UNIT = re.compile(r"[\w\s.*/^()%°·⋅+-]*")
_TOWER = re.compile(r"(\^|\*\*)\s*\(?\s*[-+]?\d{3,}|(\^|\*\*)[^*/ ]*(\^|\*\*)|\d{3,}")
_LARGEST = 307
_TOO_FAR = f"expected one between 1e-{_LARGEST} and 1e{_LARGEST} in size"


#: Temperatures in degC: size of the unit, and where its zero lies. Differences of temperature are no inputs here.
_ZEROS = {
    "degC": (Fraction(1), Fraction(0)),
    "K": (Fraction(1), Fraction("-273.15")),
    "degF": (Fraction(5, 9), Fraction(-160, 9)),
}


#: A value as engineers write it, by the SI unit of the quantity.
_EXAMPLES = {
    "1": "0.3", "rad": "0.3", "m": "0.05 mm", "kg": "12 kg", "rad/s": "1500 rpm", "Pa*s": "0.02 Pa*s", "degC": "60 degC",
    "N/m": "5e7 N/m", "N*s/m": "400 N*s/m", "W": "300 kW", "kg*m": "30 g*mm", "N*m": "200 N*m", "Pa": "0.2 MPa",
    "s": "20 ms", "kg/m^3": "870 kg/m^3", "m^2/s": "32 mm^2/s", "m/s": "2.5 mm/s", "N": "500 N", "N/m^3": "1e12 N/m^3",
}  # fmt: skip


def example(unit: str) -> str:
    """Return a value with a unit in which engineers write quantities of this one: ``1500 rpm`` for rad/s."""
    return _EXAMPLES.get(unit, f"1 {unit}")


def such_as(unit: str) -> str:
    """Return a unit in which engineers write quantities of this one: ``rpm`` for rad/s."""
    return {"rad/s": "rpm", "W": "kW", "kg*m": "g*mm", "m/s": "mm/s"}.get(unit, unit)


#: What people write for units of temperature. To pint C is a coulomb and F a farad, but no temperature is given in them.
_TEMPERATURES = {"degK": "K", "°K": "K", "C": "degC", "°C": "degC", "℃": "degC", "F": "degF", "°F": "degF", "℉": "degF"}


def split(text: str, unit: str = "1") -> tuple[Fraction, str]:
    """Split ``"0.02 Pa*s"`` into the exact number and the text of the unit (or nothing).

    Ratios of integers, ``"1/4"``, are numbers too. ``unit`` is the declared one, for the example in a message.

    Raises
    ------
    CaseError
        Where the text does not begin with a finite number, or the number has no place in a float.
    """
    if _NOT_FINITE.match(text):
        raise CaseError(f"found {text!r}, expected a finite number")
    if re.match(r"\s*[+-]?\d*,\d", text):
        raise CaseError(f"found {text!r} with a comma, expected a decimal point, as in {example(unit)!r}")
    found = _QUANTITY.fullmatch(text)
    if not found:
        bare = unit in ("1", "rad")  # 0.3 is an example of no grade, and of no number of teeth
        expected = "a number" if bare else f"a number with its unit, as in {example(unit)!r}"
        raise CaseError(f"found {text!r}, expected {expected}")
    number, _, divisor = found["number"].partition("/")
    exact = _exact(number.strip())
    if divisor:
        below = _exact(divisor.strip())
        if not below:
            raise CaseError(f"found {text!r}, expected a ratio whose divisor is not zero")
        exact /= below
    return exact, found["unit"] or ""


def _exact(number: str) -> Fraction:
    decimal = Decimal(number)
    if decimal and not -_LARGEST <= decimal.adjusted() <= _LARGEST:  # before a power of ten fills the memory
        raise CaseError(f"found {number[:40]}, {_TOO_FAR}")
    return Fraction(decimal)


def _sized(value: Fraction) -> Fraction:
    if value and not 1 <= abs(value) * 10 ** (_LARGEST + 1) < 10 ** (2 * _LARGEST + 2):
        raise CaseError(f"found a number beyond the range of floats, {_TOO_FAR}")
    return value


def exact(value: Any) -> Fraction:
    """Read a number exactly as it was written; a float counts as the shortest decimal that rounds to it.

    Raises
    ------
    CaseError
        Where the value is not a finite number.
    """
    if isinstance(value, Fraction):
        return value
    if isinstance(value, bool) or not isinstance(value, Real | Decimal):
        raise CaseError(f"found {value!r}, expected a number")
    if isinstance(value, Integral):
        return _sized(Fraction(int(value)))
    if not isinstance(value, Decimal):
        value = float(value)
    if not (value.is_finite() if isinstance(value, Decimal) else isfinite(value)):
        raise CaseError(f"found {value}, expected a finite number")
    return _exact(str(value))


def read(value: Any, unit: str, *, given: str | None = None) -> Fraction:
    """Read a value and express it in the declared unit, exactly.

    Parameters
    ----------
    value : number or str
        ``0.02``, or ``"0.02 Pa*s"``.
    unit : str
        Declared unit of the quantity; ``"1"`` where it has no dimension.
    given : str, optional
        Unit of a value that stands beside its unit, as in a case file.

    Raises
    ------
    CaseError
        Not a finite number, no unit where one is needed, two units, an unknown unit, or one of another
        dimension.
    """
    if isinstance(value, str):
        number, written = split(value, unit)
        if written and given is not None:
            raise CaseError(f"found the unit twice, in {value!r} and as {given!r}; expected it once")
        given = written or given
    else:
        number = exact(value)
    if not given:
        if unit in ("1", "rad"):
            return number
        expected = f"a unit such as {such_as(unit)}, as in {example(unit)!r}"
        raise CaseError(f"found {_shown(value)} without a unit, expected {expected}")
    if unit == "degC":
        return _temperature(number, given)
    return _sized(number * factor(given, unit))


def _temperature(number: Fraction, given: str) -> Fraction:
    name = _TEMPERATURES.get(given.strip(), given)
    if name not in _ZEROS:
        raise CaseError(f"found the unit {given!r}, expected one of {', '.join(_ZEROS)}.{nearest(given, _ZEROS)}")
    size, zero = _ZEROS[name]
    return number * size + zero


def _shown(value: Any) -> str:
    return repr(value) if isinstance(value, str) else str(value)


@lru_cache(maxsize=512)
def factor(unit: str, to: str) -> Fraction:
    """How many ``to`` one ``unit`` is, exactly (pi to 50 digits).

    Angles count as a dimension: a speed in ``1/s`` or ``Hz`` does not say whether turns or radians are meant,
    and is refused.

    Raises
    ------
    CaseError
        Where the unit is unknown, has an offset (degC), or is of another dimension.
    """
    if unit == to:
        return Fraction(1)
    scale, dimensions = _root(unit, to)
    scale_to, dimensions_to = _root(to, to)
    if dimensions != dimensions_to:
        hint = ""
        if {**dimensions, "radian": 1} == dimensions_to:
            hint = "; write rpm, turn/s or rad/s, so that it is clear whether turns or radians are meant"
        elif unit not in _SI:  # nobody's unit, though a registry can read it: Pas are petaseconds
            hint = "." + near if (near := _nearest(unit, to)) else ""
        elif (dimensions, to) == (_root("m^2/s", "")[1], "Pa*s"):
            hint = "; this is a kinematic viscosity, which is a dynamic one over the density of the oil"
        expected = "no unit" if to == "1" else f"a unit such as {such_as(to)}"
        raise CaseError(f"found the unit {unit!r}, expected {expected}{hint}")
    return scale / scale_to


def _root(unit: str, expected: str) -> tuple[Fraction, dict[str, Fraction]]:
    if unit in _SI:
        scale, powers = _SI[unit]
        return scale, {base: Fraction(power) for base, power in zip(_BASES, powers, strict=True) if power}
    return _looked_up(unit, expected)


def _looked_up(unit: str, expected: str) -> tuple[Fraction, dict[str, Fraction]]:
    if len(unit) > 60 or not _UNIT.fullmatch(unit) or _TOWER.search(unit):
        raise CaseError(f"found {unit[:60]!r}, which is not a unit, expected one such as {expected}")
    registry = _registry()
    try:
        parsed = registry.parse_units(unit.strip().replace("⋅", "*").replace("·", "*"))
        scale, root = registry.get_root_units(parsed)
    except Exception as error:
        # pint raises its own errors, and for broken text those of Python's tokenizer: all mean the same here.
        raise CaseError(
            f"found the unknown unit {unit!r}, expected one such as {such_as(expected)}.{_nearest(unit, expected)}"
        ) from error
    if any(not registry._units[name].is_multiplicative for name in parsed._units):
        raise CaseError(f"found the unit {unit!r}, which has an offset, expected one such as {expected}")
    return Fraction(scale), {name: Fraction(power) for name, power in root._units.items()}


def _nearest(unit: str, expected: str) -> str:
    """Suggest a unit of the dimension that is expected."""
    if expected == "degC":
        return nearest(unit, _ZEROS)
    if expected not in _SI:
        return nearest(unit, COMMON)
    return nearest(unit, [name for name in COMMON if name in _SI and _SI[name][1] == _SI[expected][1]])


def is_unit_of(text: str, unit: str) -> bool:
    """Whether a text is a unit that engineers write, of more than one letter and of the dimension of another unit."""
    return len(text) > 1 and text in _SI and unit in _SI and _SI[text][1] == _SI[unit][1]


def known(unit: str) -> bool:
    """Whether a text is a unit, of whatever dimension; degC is one too."""
    try:
        _root(unit, "1")
    except CaseError as fault:
        return "has an offset" in str(fault)
    return True


@lru_cache(maxsize=1)
def _registry() -> Any:
    from pint import UnitRegistry  # 0.5 s to a second

    return UnitRegistry(non_int_type=Fraction, cache_folder=None)


def convert(value: float, unit: str, to: str) -> float:
    """Convert a float from one unit to another, for showing: ``convert(157.08, "rad/s", "rpm")``."""
    return float(value * float(factor(unit, to)))
