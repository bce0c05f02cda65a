"""Scales of the states, with which differences are compared: from the motion itself, never an absolute number.

A model may count its lengths in metres or in micrometres, its time in seconds or in nanoseconds. A number that has a unit is
therefore compared with a size that has the same one, and that changes with it:

1. The range of the state over the motion.
2. At least `FLOOR` of its largest magnitude, where rounding is felt. A position and its rate, x' = v, are one
   coordinate: the magnitude of either counts for both, with T/2 pi between them.
3. At least a part of the largest size among the states that are *alike*, so that one which hardly moves (by symmetry, or by
   rounding) does not decide by its noise. That part is `FLOOR` where each state counts by its own motion (returns), and
   one where what counts is the motion as a whole (errors of steps, displacements of start states).

Alike are states that the model adds up or compares: two of them that stand in one sum with the same factor and the same
power (x^2 + y^2, x - y), or that are declared with the same unit other than "1", or as alike. States that nothing links
have sizes of their own. All of this changes in proportion when the unit of a length or of time changes, so that the labels
stay.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import pi
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sympy import Add, Expr, Symbol, sympify

from whirlmap.equations.identity import model_digest
from whirlmap.equations.model import Model
from whirlmap.kernels.cache import remembered

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Part of its magnitude, and of the sizes that it is alike to, below which a motion of a state does not count.
FLOOR = 1e-6
#: Least size of a state over the largest one, in lengths of tangent vectors: a motion that has died out has none.
SMALLEST = 1e-30
#: Growth of a state, over the size in which it began, that is taken for a divergence where the model declares no bound. Far
#: beyond any motion that grows from rounding (1e-16) to its own size, and reached by a blow-up within a few steps.
GROWTH = 1e30


@dataclass(frozen=True)
class Likeness:
    """Which states of a model can be compared, each an array of shape (state,).

    Attributes
    ----------
    coordinate : array of int
        A position and its rates share one.
    group : array of int
        Coordinates that are alike share one.
    order : array of int
        How often the state's coordinate is differentiated.
    factor : array
        What its numbers are multiplied by beside that: x' = 3 v gives v the factor 3.
    """

    coordinate: Integers
    group: Integers
    order: Integers
    factor: Array

    def weights(self, period: Array) -> Array:
        """What brings sizes of states to those of their coordinates, shape (state, point)."""
        return self.factor[:, None] * (period / (2 * pi)) ** self.order[:, None]


@lru_cache(maxsize=64)
def likeness(model: Model) -> Likeness:
    """Find which states of a model are alike, from its expressions."""
    found = remembered(
        f"likeness\n{model_digest(model)}{_declared(model)}", lambda: _likeness(model),
        lambda data: isinstance(data, dict) and set(data) == {"coordinate", "group", "order", "factor"},
    )  # fmt: skip
    whole = {name: np.array(found[name], dtype=np.int64) for name in ("coordinate", "group", "order")}
    return Likeness(**whole, factor=np.array(found["factor"], dtype=float))


def scales(
    model: Model, period: Array, extent: Array, magnitude: Array, *, share: float = FLOOR,
    rows: Sequence[int] | None = None,
) -> Array:  # fmt: skip
    """Sizes that differences of states are divided by.

    Parameters
    ----------
    model : Model
    period : array, shape (point,)
        T; of an unforced model its typical time.
    extent, magnitude : array, shape (state, point)
        Range of each state over the motion, and its largest absolute value; an angle's are at most its period.
    share : float
        The part of 3. above.
    rows : sequence of int, optional
        States whose sizes these are; all of them where absent.

    Returns
    -------
    array, shape (state, point)
        One where neither the state nor any that it is alike to has a size: its differences are zero as well.
    """
    like, kept = likeness(model), slice(None) if rows is None else list(rows)
    weight = like.weights(period)[kept]
    coordinate, group = like.coordinate[kept], like.group[kept]
    size, largest = np.array(extent, dtype=float), np.array(magnitude, dtype=float)
    for k, s in enumerate(model.states if rows is None else [model.states[row] for row in rows]):
        if s.cyclic is not None:
            size[k], largest[k] = np.minimum(size[k], s.cyclic), s.cyclic
    size = np.maximum(size, FLOOR * largest_of(coordinate, largest * weight) / weight)
    size = np.maximum(size, share * largest_of(group, size * weight) / weight)
    return np.where(size > 0, size, 1.0)


def scales_between(model: Model, period: Array, low: Array, high: Array) -> Array:
    """`scales` of motions between extremes, shape (state, point); rows of outputs may follow those of the states."""
    low, high = low[: model.dimension], high[: model.dimension]
    return scales(model, period, high - low, np.maximum(np.abs(low), np.abs(high)))


def start_sizes(model: Model, period: Array, x: Array) -> Array:
    """Sizes of the states that a start shows, shape (state, point): its own, or of those alike to it.

    Where it has none, that of the start which the model declares; zero where nothing tells the size of a state. A start that
    is given counts alone: the model's own may be in metres, and the motion in nanometres.
    """
    declared = np.abs([s.start for s in model.states])[:, None]
    like = likeness(model)
    weight = like.weights(period)
    own = largest_of(like.group, np.where(np.isfinite(x), np.abs(x), 0.0) * weight)
    return np.asarray(np.where(own > 0, own, largest_of(like.group, declared * weight)) / weight)


def tangent_sizes(model: Model, period: Array, x: Array) -> Array:
    """Sizes of the states in which lengths of tangent vectors are measured, shape (state, point).

    They are in the proportions of `start_sizes`; of states of which nothing is known, a position and its rates have T/2 pi
    between them. The largest of each point lies between one and two, by a power of two: no square of them overflows.
    """
    return unit_sizes(model, period, start_sizes(model, period, x))


def unit_sizes(model: Model, period: Array, size: Array) -> Array:
    """Sizes of states, shape (state, point), as `tangent_sizes` gives them: a state that is zero by chance needs others."""
    size = np.where(size > 0, size, 1 / likeness(model).weights(period))
    whole = np.exp2(np.frexp(size.max(axis=0))[1] - 1.0)
    return np.asarray(np.maximum(size / whole, SMALLEST))


def limits(model: Model, period: Array, x: Array) -> Array:
    """Sizes beyond which states have diverged, shape (state, point), infinite where there is none.

    They are the model's own bound where it declares one, else `GROWTH` times the size of the start.
    """
    if model.bound is not None:
        found = np.full(x.shape, float(model.bound))
    else:
        size = start_sizes(model, period, x)
        found = np.where(size > 0, GROWTH * size, np.inf)
    found[[s.cyclic is not None for s in model.states]] = np.inf
    return found


def largest_of(kind: Integers, size: Array) -> Array:
    """Largest size among the states of each kind, given back to each of its states."""
    out = np.empty_like(size)
    for rows in _rows_of(kind.tobytes()):
        out[rows] = size[rows].max(axis=0)
    return out


@lru_cache(maxsize=256)
def _rows_of(kind: bytes) -> tuple[Integers, ...]:
    """Rows of each kind: asked at every look at a motion, of few models."""
    kinds = np.frombuffer(kind, dtype=np.int64)
    return tuple(np.flatnonzero(kinds == which) for which in np.unique(kinds))


# --- what the expressions say --------------------------------------------------------------------------------


def _declared(model: Model) -> str:
    """What a model declares to be alike, for the name of the entry in the cache."""
    return "".join(f"\nalike {' '.join(s.name for s in some)}" for some in model.alike)


def _likeness(model: Model) -> dict[str, list[Any]]:
    states = list(model.states)
    index: dict[Any, int] = {s: k for k, s in enumerate(states)}
    position: dict[int, tuple[int, float]] = {}  # of each rate that is a state, and the factor between them

    def root(k: int) -> tuple[int, int, float]:
        order, factor = 0, 1.0
        while k in position:
            k, times = position[k]
            order, factor = order + 1, factor / times
        return k, order, factor

    for k, s in enumerate(states):
        number, rate = sympify(model.equations[s]).as_coeff_Mul()
        # A ring, x' = y and y' = -x, has one position: the first.
        if rate in index and number != 0 and index[rate] not in position and root(k)[0] != index[rate]:
            position[index[rate]] = k, 1 / abs(float(number))
    coordinate, order, factor = (list(part) for part in zip(*map(root, range(len(states))), strict=True))
    group = list(coordinate)
    for a, b in _linked(model, states):
        if order[a] == order[b] and factor[a] == factor[b]:
            group = [group[a] if g == group[b] else g for g in group]
    return {"coordinate": coordinate, "group": group, "order": order, "factor": factor}


def _linked(model: Model, states: list[Any]) -> Iterable[tuple[int, int]]:
    """Pairs of states that some sum holds with the same factor and power, that have the same unit, or are declared alike."""
    for some in model.alike:
        yield from ((states.index(some[0]), states.index(s)) for s in some[1:])
    for a, s in enumerate(states):
        for b in range(a):
            if s.unit == states[b].unit != "1":
                yield b, a
    known: dict[Symbol, int] = {s: k for k, s in enumerate(states)}
    expressions = [
        *model.equations.values(), *(o.expression for o in model.outputs.values()),
        *(stop.gap for stop in model.stops.values()), *(q.surface for q in model.switchings.values()),
    ]  # fmt: skip
    sums = {a for e in expressions for a in sympify(e).atoms(Add)}
    for one in sums:
        kinds: dict[Any, int] = {}
        for term in one.args:
            power = _power_of_state(term, known)
            if power is None:
                continue
            state, key = power
            if key in kinds:
                yield kinds[key], state
            else:
                kinds[key] = state


def _power_of_state(term: Expr, known: dict[Symbol, int]) -> tuple[int, Any] | None:
    """The state of a term c x^n, with |c| and n; None where it is no such term."""
    number, rest = term.as_coeff_Mul()
    factors = list(rest.args) if rest.is_Mul else [rest]
    found = [f for f in factors if f.free_symbols & set(known)]
    if len(found) != 1:
        return None
    base, power = found[0].as_base_exp()
    if base not in known or not power.is_number:
        return None
    others = sorted(str(f) for f in factors if f is not found[0])
    return known[base], (str(abs(number)), tuple(others), str(power))
