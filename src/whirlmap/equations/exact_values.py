"""Expressions compiled for many exact values: what `value_of` gives as a float, to the bit, at a hundredth of its time.

Numbers are quotients of whole numbers, which are not reduced: the last step divides, rounded once. Roots, functions and
constants such as pi have more than 160 bits, and a bound of their error goes along with them. The float is that of the exact
value unless a rounding boundary lies within that bound: such a value, and what is not known here, is left to `value_of`.
"""

from collections.abc import Callable, Mapping
from fractions import Fraction
from math import inf, isqrt
from sys import float_info
from typing import Any

import mpmath
import sympy
from mpmath.libmp import to_rational
from sympy import Abs, Add, Expr, Mul, Pow, Rational, Symbol, sign

from whirlmap.equations.groups import value_of

#: Numerator, denominator above zero, and a bound of the quotient's relative error: 0 where it is the exact value.
Number = tuple[int, int, float]
Node = Callable[[Mapping[str, Fraction]], Number]

#: Bits of a root, decimal digits of constants and functions, and the relative error of each, with room to spare.
BITS, DIGITS, ERROR = 200, 70, 1e-50
#: Largest relative error of a result, and the bits of a unit that it is counted in.
LARGEST, FINE = 1e-25, 200
#: Largest size of a function's argument, of its value, and of the value's inverse: `ERROR` holds for them.
ARGUMENT, VALUE = 1e6, 1e8
#: Functions whose slope is at most the square of their value, or of its inverse.
FUNCTIONS: dict[Any, Callable[[Any], Any]] = {
    sympy.cos: mpmath.cos, sympy.sin: mpmath.sin, sympy.tan: mpmath.tan, sympy.atan: mpmath.atan, sympy.exp: mpmath.exp,
    sympy.log: mpmath.log,
}  # fmt: skip


class _LeftToSymPy(Exception):  # noqa: N818 (no error: another way is taken)
    """What is not computed here at these values."""


def float_function(expression: Expr) -> Callable[[Mapping[str, Fraction]], float]:
    """Compile an expression: a function of the values of its symbols that gives ``float(value_of(expression, values))``."""
    node = _node(expression)

    def evaluate(values: Mapping[str, Fraction]) -> float:
        if node is not None:
            try:
                return _rounded(*node(values))
            except (_LeftToSymPy, OverflowError):
                pass
        return float(value_of(expression, values))

    return evaluate


def _rounded(above: int, below: int, error: float) -> float:
    found = above / below  # of whole numbers: rounded once
    if not error:
        return found
    if not error <= LARGEST or abs(found) < float_info.min:
        raise _LeftToSymPy
    part = int(error * 2.0**FINE) + 1
    low, high = (above * ((1 << FINE) + side) / (below << FINE) for side in (-part, part))
    if low != high:
        raise _LeftToSymPy
    return found


def _node(e: Expr) -> Node | None:
    if not e.free_symbols:
        return _constant(e)
    if isinstance(e, Symbol):
        return _symbol(e.name)
    parts = [_node(part) for part in e.args]
    nodes = [part for part in parts if part is not None]
    if len(nodes) < len(parts):
        return None
    if isinstance(e, Add):
        return _sum(nodes)
    if isinstance(e, Mul):
        return _product(nodes)
    if isinstance(e, Pow) and isinstance(e.exp, Rational) and e.exp.q in (1, 2):
        return _power(nodes[0], int(e.exp.p), root=e.exp.q == 2)
    if isinstance(e, Abs | sign):
        return _size(nodes[0], signed=isinstance(e, sign))
    return _function(nodes[0], FUNCTIONS[e.func]) if e.func in FUNCTIONS else None


def _symbol(name: str) -> Node:
    def evaluate(values: Mapping[str, Fraction]) -> Number:
        value = values[name]
        return value.numerator, value.denominator, 0.0

    return evaluate


def _constant(e: Expr) -> Node | None:
    exact = isinstance(e, Rational)
    if not exact and not (e.is_real and e.is_finite and e.is_zero is False):
        return None
    near = e if exact else Rational(e.evalf(DIGITS))
    value = int(near.p), int(near.q), 0.0 if exact else ERROR
    return lambda _: value


def _sum(nodes: list[Node]) -> Node:
    def evaluate(values: Mapping[str, Fraction]) -> Number:
        above, below, error = 0, 1, 0.0
        for node in nodes:
            a, b, err = node(values)
            left, right = above * b, a * below
            above, below = left + right, below * b
            if error or err:  # digits may cancel
                whole = abs(above)
                error = (_over(left, whole) * error + _over(right, whole) * err) * 1.001
        return above, below, error

    return evaluate


def _over(part: int, whole: int) -> float:
    return abs(part) / whole if whole else inf


def _product(nodes: list[Node]) -> Node:
    def evaluate(values: Mapping[str, Fraction]) -> Number:
        above, below, error = 1, 1, 0.0
        for node in nodes:
            a, b, err = node(values)
            above, below, error = above * a, below * b, (error + err) * 1.001
        return above, below, error

    return evaluate


def _power(base: Node, power: int, *, root: bool) -> Node:
    def evaluate(values: Mapping[str, Fraction]) -> Number:
        a, b, error = base(values)
        if a <= 0 and (root or power < 0):  # SymPy says what that is
            raise _LeftToSymPy
        if root:
            shift = max(BITS - (a * b).bit_length() // 2, 0)
            square = (a * b) << (2 * shift)  # the root of a/b is that of ab over b
            a, b = isqrt(square), b << shift
            error = error if a * a == square else error + ERROR
        error *= abs(power) * 1.001
        return (a**power, b**power, error) if power >= 0 else (b**-power, a**-power, error)

    return evaluate


def _function(inside: Node, function: Callable[[Any], Any]) -> Node:
    def evaluate(values: Mapping[str, Fraction]) -> Number:
        a, b, error = inside(values)
        if error or abs(a) > ARGUMENT * b:
            raise _LeftToSymPy
        with mpmath.workdps(DIGITS):
            value = function(mpmath.mpf(a) / b)
            if not (mpmath.isfinite(value) and isinstance(value, mpmath.mpf) and 1 / VALUE < abs(value) < VALUE):
                raise _LeftToSymPy
            above, below = to_rational(value._mpf_)
        return int(above), int(below), ERROR

    return evaluate


def _size(inside: Node, *, signed: bool) -> Node:
    def evaluate(values: Mapping[str, Fraction]) -> Number:
        a, b, error = inside(values)
        if signed and not error <= LARGEST:
            raise _LeftToSymPy
        return ((a > 0) - (a < 0), 1, 0.0) if signed else (abs(a), b, error)

    return evaluate
