"""Harmonics of the forcing: frequencies, periods T, and orders as exact ratios, from which the common period follows."""

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import lru_cache
from math import lcm, pi
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sympy import Expr, Rational, sympify

from whirlmap.equations.model import Model
from whirlmap.errors import CaseError, RangeError
from whirlmap.kernels.lowering.formulas import Formula, numpy_function

Array = NDArray[np.float64]

#: Longest common period, in T, that returns are counted in. A longer one is none that a motion is seen to return after.
LONGEST = 128
#: Largest denominator of an order that counts as a ratio of integers, and of one that stands for any other number.
SIMPLE, FINEST = 10_000, 10**12


def exact_order(value: Any, name: str) -> Fraction | None:
    """Read the order of a harmonic exactly: an integer, a Fraction, text as "1/4", or a float that equals p/q.

    A float counts as p/q with q <= 10 000 where it agrees to 1e-12; else there is no exact order, and the result is None.
    """
    if isinstance(value, int | Fraction):
        return Fraction(value)
    if isinstance(value, str):
        try:
            return Fraction(value)
        except (ValueError, ZeroDivisionError):
            raise CaseError(f"{name}: {value!r} is not a ratio of integers such as 1/4") from None
    near = Fraction(float(value)).limit_denominator(SIMPLE)
    return near if abs(float(near) - float(value)) <= 1e-12 else None


def nearest_order(value: float) -> Fraction:
    """Order of a harmonic whose frequency ratio is any number: `exact_order`, else the nearest ratio of integers.

    Its denominator is at most `FINEST`, so that it is as near as rounding: nothing that a run of any length could show.
    """
    exact = exact_order(value, "order")
    return Fraction(value).limit_denominator(FINEST) if exact is None else exact


def common_multiple(orders: Sequence[Fraction]) -> int:
    """Number of T in the common period of harmonics with these orders over the fastest."""
    return lcm(*(order.denominator for order in orders)) if orders else 1


def strobe(orders: Sequence[Fraction]) -> int:
    """Number of T between section points that show returns: `strobe_of` their common period."""
    return strobe_of(common_multiple(orders))


def strobe_of(common: int) -> int:
    """Number of T between section points that show returns: the common period, or one T where that is above `LONGEST`."""
    return common if common <= LONGEST else 1


def repeats(orders: Sequence[Fraction]) -> bool:
    """Whether harmonics with these orders have a common period: all are ratios of integers, and it can be counted."""
    return all(order.denominator <= SIMPLE for order in orders) and common_multiple(orders) < 2**63


def common_multiple_attribute(orders: Sequence[Fraction]) -> dict[str, int]:
    """Attribute of a Dataset that says how many T the common period is; none where there is none."""
    return {"common_multiple": common_multiple(orders)} if repeats(orders) else {}


@lru_cache(maxsize=64)
def _frequencies(model: Model) -> Callable[..., Any]:
    """Frequency of every harmonic; for an unforced model its typical time."""
    times = model.harmonics if model.forced else (model.typical_time,)
    return numpy_function(model, "frequencies or typical time", lambda: Formula([model.parameters], times))


def frequencies(model: Model, values: Array) -> Array:
    """Angular frequency of every harmonic, shape (harmonic, point); typical time of an unforced model."""
    n = values.shape[1]
    return np.stack([np.broadcast_to(np.asarray(w, dtype=float), (n,)) for w in _frequencies(model)(list(values))])


def periods(model: Model, values: Array) -> Array:
    """Period T of every operating point (values of shape (parameter, point)); typical time of an unforced model."""
    rates = frequencies(model, values)
    if not model.forced:
        return np.asarray(rates[0])
    fastest = np.abs(rates).max(axis=0)
    if not np.all(fastest > 0):
        raise RangeError(f"{model.name}: every declared harmonic has frequency zero, so there is no period T")
    return 2 * pi / fastest


def harmonic_orders(model: Model, values: Mapping[str, Any]) -> tuple[Fraction, ...]:
    """Orders of a model's harmonics over the fastest one, as fractions (`nearest_order`)."""
    if not model.forced:
        return ()
    exact = {}
    for p in model.parameters:
        if p.order:
            order = exact_order(values[p.name], p.name)
            if order is None:
                order = nearest_order(float(values[p.name]))
            exact[p] = Rational(order.numerator, order.denominator)
    harmonics = [sympify(w).xreplace(exact) for w in model.harmonics]
    numbers = {p: float(values[p.name]) for p in model.parameters}
    sizes = [abs(float(w.subs(numbers))) for w in harmonics]
    fastest = harmonics[sizes.index(max(sizes))]
    return _ratios(harmonics, fastest if float(fastest.subs(numbers)) > 0 else -fastest, numbers)


def _ratios(harmonics: list[Expr], fastest: Expr, numbers: Mapping[Any, float]) -> tuple[Fraction, ...]:
    out = []
    for harmonic in harmonics:
        ratio = (harmonic / fastest).simplify()
        if isinstance(ratio, Rational) and ratio.q <= FINEST:  # the quotient of two other numbers' orders is finer
            out.append(Fraction(int(ratio.p), int(ratio.q)))
        else:
            out.append(nearest_order(float(ratio.subs(numbers))))
    return tuple(out)
