"""The functions and symbols that expressions of a model may contain, and the messages about all others."""

from collections.abc import Iterable
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.core.relational import Relational
from sympy.functions.elementary.piecewise import ExprCondPair
from sympy.logic.boolalg import BooleanAtom, BooleanFunction

from whirlmap.equations.pieces import magnitude, tabulated
from whirlmap.equations.quantities import DELAYS, State, t

#: Functions of everything.
FUNCTIONS = (
    sp.sin, sp.cos, sp.tan, sp.asin, sp.acos, sp.atan, sp.atan2, sp.sinh, sp.cosh, sp.tanh, sp.asinh, sp.acosh, sp.atanh,
    sp.exp, sp.log, sp.erf, sp.erfc, sp.Abs, sp.sign, sp.Heaviside, sp.Max, sp.Min, magnitude, sp.Piecewise,
)  # fmt: skip
#: Functions of parameters alone: of a state they jump at endlessly many places.
STEPS = (sp.floor, sp.ceiling, sp.Mod, sp.frac)

_FORM = (sp.Symbol, sp.Add, sp.Mul, sp.Pow, tabulated, Relational, BooleanAtom, BooleanFunction, ExprCondPair)
_WAYS_OUT: dict[Any, str] = {
    sp.DiracDelta: "an impulse has no rate; expected a force over a short time, such as when(condition, force)",
    sp.Derivative: "a derivative is the rate of a state; expected a state of its own for it",
    sp.Integral: "expected a state of its own whose rate is the integrand",
}


def fault(expressions: Iterable[Any]) -> str:
    """Say what in some expressions cannot be computed, and the way out; empty where all can be."""
    seen: set[int] = set()
    waiting = [sp.sympify(e) for e in expressions]
    for e in waiting:
        if not isinstance(e, sp.Expr):
            return f"{e} is no number; expected an expression, such as when({e}, 1, 0) for a condition"
    alive = list(waiting)  # addresses stay those of the parts that were seen
    while waiting:
        e = waiting.pop()
        if id(e) in seen:
            continue
        seen.add(id(e))
        alive.append(e)
        if not isinstance(e, tabulated):  # its first arguments say which table it is
            found = _fault(e)
            if found:
                return found
            waiting.extend(e.args)
        else:
            waiting.extend(e.coordinates)
    return ""


def _fault(e: Any) -> str:
    if isinstance(e, AppliedUndef):
        return _of_unknown(e)
    if isinstance(e, STEPS):
        if not (e.has(State) or e.has(t)):
            return ""
        return (
            f"{e} jumps at endlessly many places; {type(e).__name__} may be taken of parameters alone. Expected"
            " when(condition, value, otherwise) for each jump, or sines and cosines of an angle, which need no wrapping"
        )
    for kind, way in _WAYS_OUT.items():
        if isinstance(e, kind):
            return f"{e} cannot be computed: {way}"
    if isinstance(e, sp.Piecewise) and e.args[-1].cond != True:  # noqa: E712 (SymPy's own truth)
        return (
            f"guarded term without a default: {e}; say what it is where no condition holds, such as"
            " when(condition, value, otherwise)"
        )
    if isinstance(e, sp.Expr) and e.is_number:
        return _of_number(e)
    if isinstance(e, (*_FORM, *FUNCTIONS)):
        return ""
    known = ", ".join(f.__name__ for f in FUNCTIONS if f is not sp.Piecewise)
    return (
        f"{e} cannot be computed: {type(e).__name__} is not among the functions that models may use, which are {known}, when"
    )


def _of_unknown(e: Any) -> str:
    name = e.func.__name__
    if e.has(t):
        return f"{e} is a function of time that is not known: {DELAYS.format(name=name)}"
    return f"{e} calls {name}, which is no function that is known; expected its formula, or a Table"


def _of_number(e: Any) -> str:
    if e.is_finite is False or e is sp.nan or e.has(sp.zoo, sp.nan, sp.oo):
        return f"{e} is not finite"
    value = sp.N(e) if not e.is_real else e
    if value.is_real is False or value.as_real_imag()[1] != 0:
        return f"{e} is a complex number; states and their rates are real"
    return ""


