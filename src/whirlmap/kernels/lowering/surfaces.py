"""Discontinuity surfaces of a model: where its rates have a kink or a jump, found in its expressions.

``sign(g)``, ``Abs(g)`` and every comparison inside of a condition change at ``g = 0``. Each such ``g`` that depends on
states or time is a *surface*. The expressions are rewritten for one side of it: the sign of ``g`` becomes a symbol of its
own, the *side*, which a kernel holds constant during a step and changes where the step crosses the surface. So the rates of
a step are smooth, whatever the model is made of, and a crossing is the zero of a smooth function.

Not found, and so not located: surfaces inside of tables, those that are no real number at some states (``log(x) > 0``), for
no side of them is known there, and points at which a root of a sum of squares is singular.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sympy import Abs, Expr, Integer, Pow, Symbol, cos, sign
from sympy.core.relational import GreaterThan, LessThan, StrictGreaterThan, StrictLessThan

from whirlmap.equations.model import Model
from whirlmap.equations.pieces import magnitude, tabulated
from whirlmap.equations.quantities import t
from whirlmap.kernels.lowering.formulas import array_function
from whirlmap.kernels.lowering.normal_form import may_be_nan, normal_form

UPWARD, DOWNWARD = StrictGreaterThan | GreaterThan, StrictLessThan | LessThan

#: Random states at which the rates on both sides of a surface are compared, and the relative difference that is a jump.
SAMPLES, JUMP = 12, 1e-6
#: Newton steps towards a surface from a random state.
NEWTON = 40


def side_name(k: int) -> str:
    """Name of the symbol that stands for the sign of surface ``k``."""
    return f"m{k}"


@dataclass
class Sided:
    """A model's rates, written for one side of each surface.

    Attributes
    ----------
    rates : list of Expr
        In the order of the states, with the symbols of `sides`.
    surfaces : list of Expr
        Positive on one side; they may contain the sides of earlier ones.
    sides : list of Symbol
        One for each surface: 1 where it is positive, -1 where it is negative.
    jumps : list of bool
        Whether the rates jump at a surface; where not, they have a kink.
    flat : list of bool
        Whether a surface's gradient by the states is constant: tangent vectors can then slide on it.
    held : list of Expr
        What does not change while a motion slides on a surface, and whose rate jumps there: the surface's value; or its
        rate, where that does not jump (a mass that is pressed against a preloaded stop rests on x = 0 with v = 0).
    """

    rates: list[Expr] = field(default_factory=list)
    surfaces: list[Expr] = field(default_factory=list)
    sides: list[Symbol] = field(default_factory=list)
    jumps: list[bool] = field(default_factory=list)
    flat: list[bool] = field(default_factory=list)
    held: list[Expr] = field(default_factory=list)

    @property
    def holds(self) -> list[list[int]]:
        """Other surfaces on which a motion stays while it slides on a surface: dry friction of the mass on that stop."""
        return [
            [j for j, g in enumerate(self.surfaces) if j != k and 0 in ((g - held).expand(), (g + held).expand())]
            for k, held in enumerate(self.held)
        ]


@lru_cache(maxsize=64)
def sided(model: Model) -> Sided:
    """Find the surfaces of a model, and rewrite its rates for one side of each."""
    out = Sided()
    moving = {*model.states, t}
    for state in model.states:
        out.rates.append(_odd(_rewritten(normal_form(model.equations[state]), moving, out), out))
    out.jumps = _jumps(model, out) if out.surfaces else []
    varying = moving | set(out.sides)
    out.held = [_held(model, out, k) for k in range(len(out.surfaces))]
    flat = [not any(g.diff(s).free_symbols & varying for s in model.states) for g in out.surfaces]
    out.flat = [constant and held == g for constant, held, g in zip(flat, out.held, out.surfaces, strict=True)]
    return out


def _held(model: Model, found: Sided, k: int) -> Expr:
    """The value of a surface, or its rate where the rates jump there and this one does not."""
    surface = found.surfaces[k]
    slopes = [surface.diff(s) * rate for s, rate in zip(model.states, found.rates, strict=True)]
    rate = sum(slopes, surface.diff(t))
    alike = found.jumps[k] and found.sides[k] not in rate.free_symbols and not rate.has(tabulated)
    return rate if alike and rate.free_symbols & {*model.states} else surface


def _rewritten(e: Any, moving: set[Any], found: Sided) -> Any:
    """An expression or condition with sides in place of signs, inner ones first."""
    if not getattr(e, "args", ()) or not e.free_symbols & moving:
        return e
    args = [_rewritten(a, moving, found) for a in e.args]
    if isinstance(e, sign | Abs):
        side = _side(args[0], moving, found)
        if side is not None:
            return side if isinstance(e, sign) else side * args[0]
    elif isinstance(e, UPWARD | DOWNWARD):
        side = _side(args[0] - args[1] if isinstance(e, UPWARD) else args[1] - args[0], moving, found)
        if side is not None:
            strict = isinstance(e, StrictGreaterThan | StrictLessThan)
            if side.is_Symbol:
                return side > 0 if strict else side >= 0
            return -side < 0 if strict else -side <= 0
    return e.func(*args)


def _side(g: Expr, moving: set[Any], found: Sided) -> Expr | None:
    """The side of a surface: its symbol, or minus that of the opposite one.

    None where something is read from a table, where it may be no number, or where it is made of sides alone and so changes
    with them.
    """
    g = _odd(g, found)
    if g.has(tabulated) or not g.free_symbols & moving or may_be_nan(g):
        return None
    for known, side in zip(found.surfaces, found.sides, strict=True):
        if (g - known).expand() == 0:
            return side
        if (g + known).expand() == 0:
            return -side
    found.surfaces.append(g)
    found.sides.append(Symbol(side_name(len(found.sides)), real=True))
    return found.sides[-1]


def _odd(e: Expr, found: Sided) -> Expr:
    """An expression in which powers of sides are written as the side itself, or as one."""
    sides = set(found.sides)
    return e.replace(
        lambda a: isinstance(a, Pow) and a.base in sides and a.exp.is_Integer,
        lambda a: a.base if a.exp % 2 else Integer(1),
    )


def _jumps(model: Model, found: Sided) -> list[bool]:
    """Whether any rate differs between the two sides of each surface, at random states on it.

    A surface on which no state was found counts as one where rates jump: its crossings then cost more, and nothing else.
    """
    symbols = [*model.states, *model.parameters, t]
    rates = array_function([symbols, found.sides], [_without_tables(e) for e in found.rates])
    out = []
    for k, surface in enumerate(found.surfaces):
        slopes = [surface.diff(s) for s in (*model.states, t)]
        g = array_function([symbols, found.sides], [surface, *slopes])
        differences = list(_differences(g, rates, k, len(model.states), len(symbols), len(found.sides)))
        out.append(not differences or max(differences) > JUMP)
    return out


def _differences(
    g: Callable[..., Any], rates: Callable[..., Any], k: int, states: int, symbols: int, sides: int
) -> Iterator[float]:
    """Relative differences of the rates between the sides of a surface, at random points put on it by Newton's method."""
    rng = np.random.default_rng(5)
    for _ in range(SAMPLES):
        point, side = rng.uniform(0.4, 1.6, symbols), rng.choice([-1.0, 1.0], sides)
        point[:states] *= rng.choice([-1.0, 1.0], states)
        with np.errstate(all="ignore"):
            for _ in range(NEWTON):
                value, *slope = (float(v) for v in g(point, side))
                size = sum(v * v for v in slope)
                if not (np.isfinite(size) and size > 0):
                    break
                point[:states] -= value / size * np.array(slope[:states])
                point[-1] -= value / size * slope[-1]
            if not (np.isfinite(size) and size > 0 and abs(value) <= 1e-12 * (abs(value) + size**0.5)):
                continue
            one, other = (np.array(rates(point, _with(side, k, m)), dtype=float) for m in (1.0, -1.0))
        if np.isfinite(one).all() and np.isfinite(other).all():
            yield float(np.abs(one - other).max() / max((np.abs(one) + np.abs(other)).max(), 1e-300))


def _with(sides: NDArray[np.float64], k: int, value: float) -> NDArray[np.float64]:
    out = sides.copy()
    out[k] = value
    return out


def _without_tables(e: Expr) -> Expr:
    """The expression with a smooth function in place of each table: a jump is not in there."""
    return e.replace(magnitude, Abs).replace(lambda a: isinstance(a, tabulated), lambda a: cos(sum(a.coordinates)) + 2)
