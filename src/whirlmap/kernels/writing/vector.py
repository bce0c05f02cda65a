"""Lowered expressions as vector instructions: every operation works on all lanes of a block at once."""

from typing import Any

from llvmlite import ir
from sympy import Abs, Add, Expr, Integer, Mul, Piecewise, Pow, cos, sin, zoo
from sympy import sign as sympy_sign
from sympy.core.relational import Relational
from sympy.logic.boolalg import ITE, And, BooleanAtom, Not, Or

from whirlmap.errors import ModelError
from whirlmap.kernels.lowering.powers import inverse, power, product_of_roots, quarters_of, root
from whirlmap.kernels.writing.roots import Roots
from whirlmap.kernels.writing.routine import LANES, MASK, Routine, Value, number
from whirlmap.kernels.writing.sines import Sines

#: Functions of the C library: they work on one lane at a time, and belong outside of a right-hand side where possible.
LIBRARY = {
    name: name for name in (
        "exp", "log", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "asinh", "acosh", "atanh", "erf",
        "erfc",
    )
} | {"power": "pow"}  # fmt: skip


class VectorCode:
    """Straight-line code inside a routine: a value for every name, and for every expression of names.

    Parameters
    ----------
    routine : Routine
    names : dict of str to Value
        Values of the symbols; an assignment adds one.
    roots : Roots
        How square roots and reciprocals are computed.
    sines : Sines
        How sines and cosines are.
    """

    def __init__(self, routine: Routine, names: dict[str, Value], roots: Roots, sines: Sines) -> None:
        self.r, self.names, self.roots, self.sines = routine, names, roots, sines
        self.made: dict[Expr, Value] = {}
        self.waves: dict[Expr, tuple[Value, Value]] = {}

    def value(self, e: Expr) -> Value:
        """Instructions of an expression."""
        if e.is_Symbol:
            return self.names[e.name]
        if e not in self.made:
            self.made[e] = self._write(e)
        return self.made[e]

    def _write(self, e: Any) -> Value:
        r = self.r
        if e.is_number:
            return number(_real(e))
        if isinstance(e, Add):
            return self._sum(e)
        if isinstance(e, Mul):
            negative, factors = self._factors(e)
            product = self._product(factors)
            return r.sub(number(-0.0), product) if negative else product
        if isinstance(e, Pow):
            return self._power(e)
        if isinstance(e, power) and (quarters := quarters_of(e.args[1])) is not None:
            return self.value(product_of_roots(e.args[0], quarters))
        if isinstance(e, root | inverse):
            return self.roots.write(r, e, self.value)
        if isinstance(e, sin | cos):
            angle = e.args[0]
            if angle not in self.waves:
                self.waves[angle] = self.sines.pair(r, self.value(angle))
            return self.waves[angle][0 if isinstance(e, sin) else 1]
        if isinstance(e, Abs):
            return r.absolute(self.value(e.args[0]))
        if isinstance(e, sympy_sign):
            x = self.value(e.args[0])
            below = r.b.select(r.less(x, number(0.0)), number(-1.0), number(0.0))
            return r.b.select(r.less(number(0.0), x), number(1.0), below)
        if isinstance(e, Piecewise):
            return self._guarded(e)
        name = type(e).__name__
        if name not in LIBRARY:
            raise ModelError(f"function {name} cannot be lowered: {e}")
        return r.per_lane(LIBRARY[name], *(self.value(a) for a in e.args))

    def _sum(self, e: Add) -> Value:
        plus: list[Value] = []
        minus: list[Value] = []
        for term in e.args:
            negative, factors = self._factors(term)
            (minus if negative else plus).append(self._product(factors))
        total = plus[0] if plus else number(0.0)
        for value in plus[1:]:
            total = self.r.add(total, value)
        for value in minus:
            total = self.r.sub(total, value)
        return total

    def _factors(self, e: Expr) -> tuple[bool, tuple[Expr, ...]]:
        """Whether a product is written with a minus, and its factors without it."""
        coefficient, rest = e.as_coeff_Mul()
        if not coefficient.is_negative:
            return False, e.args if isinstance(e, Mul) else (e,)
        size = () if coefficient == -1 else (-coefficient,)
        return True, (*size, *(rest.args if isinstance(rest, Mul) else (rest,)))

    def _product(self, factors: tuple[Expr, ...]) -> Value:
        product = self.value(factors[0])
        for factor in factors[1:]:
            product = self.r.mul(product, self.value(factor))
        return product

    def _power(self, e: Pow) -> Value:
        if not isinstance(e.exp, Integer) or e.exp < 1:
            raise ModelError(f"power {e} reached the kernel")
        square, left, out = self.value(e.base), int(e.exp), None
        while left:
            if left & 1:
                out = square if out is None else self.r.mul(out, square)
            left >>= 1
            if left:
                square = self.r.mul(square, square)
        return out

    def _guarded(self, e: Piecewise) -> Value:
        *cases, (value, condition) = e.args
        if condition != True:  # noqa: E712 (SymPy's own truth)
            raise ModelError(f"guarded term without a default: {e}")
        out = self.value(value)
        for value, condition in reversed(cases):
            out = self.r.b.select(self.truth(condition), self.value(value), out)
        return out

    def truth(self, condition: Any) -> Value:
        """Instructions of a condition."""
        b = self.r.b
        if isinstance(condition, Relational):
            return b.fcmp_ordered(condition.rel_op, self.value(condition.lhs), self.value(condition.rhs))
        if isinstance(condition, And | Or):
            parts = [self.truth(a) for a in condition.args]
            out = parts[0]
            for part in parts[1:]:
                out = b.and_(out, part) if isinstance(condition, And) else b.or_(out, part)
            return out
        if isinstance(condition, Not):
            return b.xor(self.truth(condition.args[0]), ir.Constant(MASK, [1] * LANES))
        if isinstance(condition, ITE):
            return b.select(*(self.truth(a) for a in condition.args))
        if isinstance(condition, BooleanAtom):
            return ir.Constant(MASK, [int(bool(condition))] * LANES)
        raise ModelError(f"condition {condition} cannot be lowered")


def _real(constant: Expr) -> float:
    """A constant of a branch: NaN where it is complex, infinite where it is a reciprocal of zero."""
    if constant.has(zoo):
        return float("inf")
    value = complex(constant)
    return value.real if value.imag == 0.0 else float("nan")
