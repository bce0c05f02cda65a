"""Powers as the kernels compute them: products, square roots, reciprocals, and the C library's ``pow`` for all others.

Powers by multiples of a quarter are split so that one square root and one reciprocal serve all powers of a base.
"""

from collections.abc import Collection
from typing import Any

from sympy import Expr, Float, Function, Integer, Ne, Piecewise, Pow, Rational, log, sqrt


class root(Function):  # noqa: N801 (printed as a function)
    """Square root kept apart from powers, so that common-subexpression elimination finds it."""

    def fdiff(self, argindex: int = 1) -> Expr:  # noqa: ARG002
        """Derivative by the argument."""
        return inverse(self) / 2

    def _eval_evalf(self, prec: int) -> Any:
        return sqrt(self.args[0])._eval_evalf(prec)  # SymPy would call mpmath's root, which is another function


class inverse(Function):  # noqa: N801 (printed as a function)
    """Reciprocal kept apart from powers, for the same reason."""

    def fdiff(self, argindex: int = 1) -> Expr:  # noqa: ARG002
        """Derivative by the argument."""
        return -(self**2)

    def _eval_evalf(self, prec: int) -> Any:
        return (1 / self.args[0])._eval_evalf(prec)  # mpmath's inverse is that of a matrix


class power(Function):  # noqa: N801 (printed as a function)
    """A real power that is computed and differentiated as a whole.

    NaN for a negative base, unless the exponent is an integer; by the C library but for multiples of a quarter.
    """

    def fdiff(self, argindex: int = 1) -> Expr:
        """Derivative by the base or by the exponent; the second one has the limit 0 where the base is 0."""
        base, exponent = self.args
        if argindex == 1:
            less = exponent - 1
            return exponent * (power(base, less) if _has_slope_at_zero(less) else split_powers(base**less))
        return Piecewise((self * log(base), Ne(base, 0)), (Integer(0), True))

    def _eval_evalf(self, prec: int) -> Any:
        return (self.args[0] ** self.args[1])._eval_evalf(prec)


def keep_whole(expression: Expr, positive: Collection[Expr]) -> Expr:
    """Write powers such as 3/2 of what may be zero as `power`: as ``b root(b)`` their slope is 0 times infinity there.

    Parameters
    ----------
    positive : collection of Expr
        What is never zero, beside what SymPy knows to be positive.
    """

    def may_vanish(e: Expr) -> bool:
        base = e.args[0]
        return bool(base.free_symbols) and not base.is_positive and base not in positive

    return expression.replace(
        lambda e: isinstance(e, Pow) and _has_slope_at_zero(e.exp) and may_vanish(e), lambda e: power(*e.args)
    )


def split_powers(expression: Expr) -> Expr:
    """Write ``b**(-5/2)`` as ``inverse(b)**2 * inverse(root(b))`` and so on, ``b**0.7`` as ``power(b, 0.7)``."""

    def split(e: Pow) -> Expr:
        quarters = quarters_of(e.exp)
        return power(*e.args) if quarters is None else product_of_roots(e.base, quarters)

    return expression.replace(lambda e: isinstance(e, Pow) and not (isinstance(e.exp, Integer) and e.exp > 0), split)


def _has_slope_at_zero(exponent: Expr) -> bool:
    """Whether an exponent by quarters, and no integer, is above one."""
    quarters = quarters_of(exponent)
    return quarters is not None and quarters > 4 and quarters % 4 != 0


def quarters_of(exponent: Expr) -> int | None:
    """Four times an exponent where that is an integer; 1.5 is as good as 3/2."""
    if not isinstance(exponent, Rational | Float):
        return None
    quarters = float(4 * exponent)
    return int(quarters) if quarters.is_integer() else None


def product_of_roots(base: Expr, quarters: int) -> Expr:
    """A power by quarters in products, square roots and reciprocals."""
    size = abs(quarters)
    if quarters >= 0:
        fourth = root(root(base)) if size % 2 else 1
        return base ** (size // 4) * (root(base) if size % 4 >= 2 else 1) * fourth
    if size % 2:
        return inverse(root(root(base))) ** size
    return inverse(root(base)) ** (size // 2) if size % 4 else inverse(base) ** (size // 4)
