"""Square roots and reciprocals of vectors: exact, or by the processor's estimate and Newton's iteration.

A film asks for two roots and two reciprocals. The divider of a processor with 512-bit vectors takes 16 to 32 cycles for
each of them, more than all else in a right-hand side together. Its estimates are good to 2^-14; two iterations double the
digits twice, and what is left is rounding in the last place.
"""

from collections.abc import Callable
from dataclasses import dataclass

from llvmlite import ir
from sympy import Expr

from whirlmap.kernels.lowering.powers import inverse, root
from whirlmap.kernels.writing.routine import BYTE, LANE, LANES, Routine, Value, number

#: Iterations that take 14 good bits to 53.
ITERATIONS = 2


@dataclass(frozen=True)
class Roots:
    """A way to compute roots and reciprocals.

    Attributes
    ----------
    estimated : bool
        By estimates, which processors with AVX-512 have, instead of divisions.
    """

    estimated: bool

    def write(self, r: Routine, e: Expr, value: Callable[[Expr], Value]) -> Value:
        """Instructions of ``root(x)``, ``inverse(x)`` or ``inverse(root(x))``; limits at 0 and infinity are exact.

        ``value`` gives the instructions of an expression, made once for each.
        """
        if not self.estimated:
            return r.root(value(e.args[0])) if isinstance(e, root) else r.div(number(1.0), value(e.args[0]))
        inner = e.args[0]
        if isinstance(e, root):
            x = value(inner)
            one_over = value(inverse(e))
            # at 0 and infinity the product is 0 times infinity, and the root is its argument
            edge = r.b.or_(r.b.fcmp_ordered("==", x, number(0.0)), r.b.fcmp_ordered("==", x, number(float("inf"))))
            return r.b.select(edge, x, r.mul(x, one_over))
        if isinstance(inner, root):
            return _inverse_root(r, value(inner.args[0]))
        return _inverse(r, value(inner))


def _inverse(r: Routine, x: Value) -> Value:
    first = y = _estimate(r, "rcp14", x)
    for _ in range(ITERATIONS):
        y = r.add(y, r.mul(y, r.sub(number(1.0), r.mul(x, y))))
    return _or_first(r, y, first)


def _inverse_root(r: Routine, x: Value) -> Value:
    first = y = _estimate(r, "rsqrt14", x)
    half = r.mul(number(0.5), x)
    for _ in range(ITERATIONS):
        y = r.add(y, r.mul(y, r.sub(number(0.5), r.mul(half, r.mul(y, y)))))
    return _or_first(r, y, first)


def _or_first(r: Routine, y: Value, first: Value) -> Value:
    """The estimate itself where the iteration met 0 times infinity: it is exact there (0, infinity, not a number)."""
    return r.b.select(r.b.fcmp_unordered("uno", y, y), first, y)


def _estimate(r: Routine, name: str, x: Value) -> Value:
    full = f"llvm.x86.avx512.{name}.pd.512"
    kind = ir.FunctionType(LANE, [LANE, LANE, BYTE])
    function = r.module.globals.get(full) or ir.Function(r.module, kind, full)
    return r.b.call(function, [x, ir.Constant(LANE, [0.0] * LANES), ir.Constant(BYTE, -1)])
