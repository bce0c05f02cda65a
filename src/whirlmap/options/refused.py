"""Values of options that make no sense, refused where the option is made: each message names the option and what it was."""

from collections.abc import Iterable
from numbers import Integral, Real
from typing import Any

from whirlmap.errors import RangeError, nearest

#: Names of the integration methods (`whirlmap.kernels.methods` has their coefficients).
METHODS = ("rk4", "tsit5", "dop853")


def refuse_count(name: str, value: Any, least: int, most: int) -> None:
    """Refuse what is no whole number of these.

    Raises
    ------
    RangeError
        Naming the option, its limits and the value.
    """
    if not isinstance(value, Integral) or isinstance(value, bool):
        raise RangeError(f"{name} must be a whole number, not {value!r}")
    if not least <= int(value) <= most:
        raise RangeError(f"{name} must lie between {least} and {most}, not {value}")


def refuse_number(name: str, value: Any, least: float, most: float) -> None:
    """Refuse what is no number of these, the least one included where it is above zero, the largest excluded.

    Raises
    ------
    RangeError
        Naming the option, its limits and the value.
    """
    if not isinstance(value, Real) or isinstance(value, bool):
        raise RangeError(f"{name} must be a number, not {value!r}")
    number = float(value)
    if not (number > 0 and least <= number < most):
        raise RangeError(f"{name} must lie between {least:g} and {most:g}, not {value}")


def refuse_steps(steps: Any) -> None:
    """Refuse steps per T, one number or one for each point, that are not whole numbers from 1 to 1000000.

    Raises
    ------
    RangeError
        Naming the first that is not.
    """
    several = steps.ravel().tolist() if hasattr(steps, "ravel") else steps  # an array, without importing NumPy
    for value in several if isinstance(several, Iterable) and not isinstance(several, str) else (several,):
        refuse_count("steps per T", value, 1, 1_000_000)


def refuse_method(name: Any) -> None:
    """Refuse a method that there is not.

    Raises
    ------
    RangeError
        With the nearest name.
    """
    if name not in METHODS:
        raise RangeError(f"there is no method {name!r}.{nearest(str(name), METHODS)}\n  methods: {', '.join(METHODS)}")
