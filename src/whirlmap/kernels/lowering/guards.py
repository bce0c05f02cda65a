"""Guarded terms with a branch that is infinite or not a number where it does not apply: ``when(x > 1, sqrt(x - 1))``.

A kernel computes every branch and selects. That is right for values; by the chain rule, however, the slope of a branch that
is not chosen would be multiplied by zero, and zero times infinity is no number. Such terms are differentiated branch by
branch.
"""

from sympy import Abs, Expr, Function, Piecewise, Symbol, asinh, atan, cos, erf, erfc, sign, sin, tanh
from sympy.core.relational import Relational

from whirlmap.kernels.lowering.lower import Read, Straight
from whirlmap.kernels.lowering.powers import inverse, power, root

#: Functions with finite values and slopes wherever their arguments are finite.
TAME = (sin, cos, atan, tanh, asinh, erf, erfc, sign, Abs, Piecewise)


class Guards:
    """What of some straight-line code needs to be differentiated branch by branch.

    Attributes
    ----------
    hidden : set of Symbol
        Assignments that may fail and that such a term depends on.
    """

    def __init__(self, lines: Straight) -> None:
        self._signs: dict[Symbol, Symbol] = {}
        self._failing: set[Symbol] = set()
        behind: set[Symbol] = set()
        assigned = [step for step in lines.steps if not isinstance(step, Read)]
        for symbol, e in assigned:
            if self._is_positive(e):
                self._signs[symbol] = Symbol(symbol.name, positive=True)
            elif e.xreplace(self._signs).is_nonnegative:
                self._signs[symbol] = Symbol(symbol.name, nonnegative=True)
            if self._may_fail(e):
                self._failing.add(symbol)
        for e in [*lines.results, *(e for _, e in reversed(assigned))]:
            for term in self.terms(e):
                behind |= set().union(*(pair.expr.free_symbols for pair in term.args))
        for symbol, e in reversed(assigned):
            if symbol in behind:
                behind |= e.free_symbols
        self.hidden = behind & self._failing

    def terms(self, e: Expr) -> list[Piecewise]:
        """The outermost guarded terms of an expression of which a branch may fail, in a fixed order."""
        if isinstance(e, Piecewise) and any(self._may_fail(pair.expr) for pair in e.args):
            return [e]
        if isinstance(e, Relational) or not e.args:
            return []
        found = (term for a in e.args for term in self.terms(a))
        return list(dict.fromkeys(found))

    def _may_fail(self, e: Expr) -> bool:
        """Whether the value or the slope of an expression may be infinite or no number where its symbols are finite."""
        if e.free_symbols & self._failing:
            return True
        return any(not isinstance(call, TAME) and not self._is_safe(call) for call in e.atoms(Function))

    def _is_safe(self, call: Expr) -> bool:
        return isinstance(call, root | inverse | power) and self._is_positive(call.args[0])

    def _is_positive(self, e: Expr) -> bool:
        return self._is_positive(e.args[0]) if isinstance(e, root | inverse) else bool(e.xreplace(self._signs).is_positive)
