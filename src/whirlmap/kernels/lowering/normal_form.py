"""Normal form of nonsmooth terms: every kink and jump is written with ``sign``, ``Abs`` and ``Piecewise`` alone.

``Max``, ``Min`` and ``Heaviside`` are written in these three, and so are the conditions of a ``Piecewise``: as ``And``,
``Or`` and ``Not`` of relations. What follows (lowering, differentiation, a search for surfaces at which the rates have a
kink or a jump) then has three functions to know.
"""

from typing import Any

from sympy import (
    And,
    Heaviside,
    Integer,
    Max,
    Min,
    Mul,
    Not,
    Or,
    Piecewise,
    Pow,
    Rational,
    acos,
    acosh,
    asin,
    atanh,
    log,
    nan,
    oo,
    sign,
    sympify,
    zoo,
)  # fmt: skip
from sympy.core.expr import Expr
from sympy.core.relational import Relational
from sympy.functions.elementary.piecewise import ExprCondPair
from sympy.logic.boolalg import Boolean, BooleanAtom, BooleanFunction

from whirlmap.equations.quantities import State, t
from whirlmap.errors import ModelError

#: Functions that are real numbers for some real arguments only.
PARTIAL = (log, asin, acos, acosh, atanh)
REWRITTEN = (Max, Min, Heaviside, Piecewise, Pow, sign)


def normal_form(expression: Any) -> Expr:
    """Write an expression so that its kinks and jumps stand in ``sign``, ``Abs`` and ``Piecewise`` only.

    Parameters
    ----------
    expression : Expr or number

    Returns
    -------
    Expr
        Equal to the expression everywhere. Parts without such terms are the same objects as before. Every ``Piecewise``
        has a default, its conditions are ``And``, ``Or`` and ``Not`` of relations; one may stand inside another one, and
        inside a relation.

    Raises
    ------
    ModelError
        A ``Piecewise`` has no default, or a condition is no relation between real expressions.
    """
    try:
        return sympify(expression).replace(lambda e: isinstance(e, REWRITTEN), _rewritten)
    except TypeError as error:  # SymPy compares no complex numbers
        raise ModelError(f"{expression} cannot be computed: {error}") from None


def _rewritten(e: Any) -> Expr:
    if isinstance(e, Pow):
        return _power(e)
    if isinstance(e, Max | Min):
        e = _extreme(e)
    elif isinstance(e, Heaviside):
        e = normal_form(_step(*e.args))
    elif isinstance(e, sign) and may_be_nan(x := e.args[0]):
        e = Piecewise((Integer(1), x > 0), (Integer(-1), x < 0), (x, True))  # zero itself, or NaN
    return _piecewise(e) if isinstance(e, Piecewise) else e  # SymPy writes a Piecewise within a relation as ITE


def _extreme(e: Max | Min) -> Expr:
    """The first argument that no later one exceeds, and NaN where one of them is NaN.

    Failed comparisons end at the last argument, so one that may be NaN stands there; beside a second one the default is the
    sum of both.
    """
    arguments = sorted(e.args, key=lambda a: (not a.is_number, may_be_nan(a), a.has(State) or a.has(t)))  # stable
    relation = (lambda a, b: a >= b) if isinstance(e, Max) else (lambda a, b: a <= b)
    if len(arguments) > 1 and may_be_nan(arguments[-2]):
        cases = [(a, _condition(And(*(relation(a, other) for other in arguments if other != a)))) for a in arguments]
        return Piecewise(*cases, (sum(a for a in arguments if may_be_nan(a)), True))
    cases = [
        (value, _condition(And(*(relation(value, other) for other in arguments[i + 1 :]))))
        for i, value in enumerate(arguments[:-1])
    ]  # fmt: skip
    return Piecewise(*cases, (arguments[-1], True))


def may_be_nan(e: Expr) -> bool:
    """Whether an expression may be no real number at some states: a logarithm, an arc, a power of what may be negative."""
    of_base = [p.base for p in e.atoms(Pow) if not p.exp.is_integer and not p.base.is_nonnegative]
    return any(inner.has(State) or inner.has(t) for inner in (*of_base, *(call.args[0] for call in e.atoms(*PARTIAL))))


def _step(x: Expr, at_zero: Expr) -> Expr:
    """Heaviside's step with its own value at zero, which is one half where none was said."""
    if at_zero == Rational(1, 2):
        return (1 + sign(x)) / 2
    if at_zero in (0, 1):
        return Piecewise((Integer(1), x > 0 if at_zero == 0 else x >= 0), (Integer(0), True))
    return Piecewise((Integer(1), x > 0), (Integer(0), x < 0), (at_zero, True))


def _power(e: Pow) -> Expr:
    """Power of a Piecewise as the Piecewise of powers: ``Max(x, 0)**p`` has slope 0, not 0 times infinity, where x < 0."""
    base, exponent = e.args
    factors = [f for f in Mul.make_args(base) if isinstance(f, Piecewise)]
    if len(factors) != 1 or isinstance(exponent, Integer):
        return e
    rest = Mul(*(f for f in Mul.make_args(base) if f is not factors[0]))
    powers = [(rest * pair.expr) ** exponent for pair in factors[0].args]
    return Piecewise(*((_real(p), pair.cond) for p, pair in zip(powers, factors[0].args, strict=True)))


def _real(e: Expr) -> Expr:
    """A constant as floating point has it: infinite for a reciprocal of zero, and NaN where it is complex."""
    if not e.is_number or e.is_extended_real:
        return e
    return oo if e is zoo else nan


def _piecewise(e: Piecewise) -> Expr:
    if e.args[-1].cond != True:  # noqa: E712 (SymPy's own truth)
        raise ModelError(
            f"guarded term without a default: {e}; say what it is where no condition holds,"
            " such as when(condition, value, otherwise)"
        )
    conditions = [_condition(pair.cond) for pair in e.args]
    if all(new is pair.cond for new, pair in zip(conditions, e.args, strict=True)):
        return e
    return Piecewise(*(ExprCondPair(pair.expr, c) for pair, c in zip(e.args, conditions, strict=True)))


def _relation(relation: Relational) -> Boolean:
    """The relation, of a difference to zero where neither side is a number or a symbol.

    SymPy's canonical form of some others alternates between two forever.
    """
    if any(side.is_number or side.is_Symbol for side in relation.args):
        return relation
    return relation.func(relation.lhs - relation.rhs, 0)


def _condition(condition: Boolean) -> Boolean:
    """The condition in And, Or and Not of relations; the same object where it is so already."""
    if isinstance(condition, Relational):
        return _relation(condition)
    if isinstance(condition, BooleanAtom):
        return condition
    if isinstance(condition, And | Or | Not):
        parts = [_condition(a) for a in condition.args]
        same = all(new is old for new, old in zip(parts, condition.args, strict=True))
        return condition if same else condition.func(*parts)
    if isinstance(condition, BooleanFunction):  # Xor, ITE, Implies and others
        return _condition(condition.to_nnf(simplify=False))
    raise ModelError(f"condition {condition} is not a relation between expressions such as x > 1, or And, Or, Not of such")
