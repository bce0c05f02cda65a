"""Start states: the static equilibrium with all forcing off, by damped Newton iteration, for many points at once."""

import numpy as np
from numpy.typing import NDArray
from sympy import sympify

from whirlmap.equations.model import Model
from whirlmap.integrate.division import variants
from whirlmap.integrate.evaluation import Evaluator
from whirlmap.integrate.harmonics import periods
from whirlmap.integrate.scales import largest_of, likeness
from whirlmap.integrate.step_retry import stop_function
from whirlmap.integrate.system import System

Array = NDArray[np.float64]

#: Newton steps before a point counts as having no equilibrium.
MOST_STEPS = 60
#: Points that are solved at a time: their Jacobians, and what their rates need, take 150 kB for each.
SOLVED = 256
#: How often a step is halved before its point counts as stuck.
HALVINGS = 30
#: Newton steps below this part of a state's size are rounding.
SMALL = 1e-11
#: Implicit steps of a run to rest, where Newton's method alone finds nothing, and the first of them in units of T/2 pi.
RUN, FIRST = 120, 0.1
#: Growth of a step that went well, and shrinking of one that did not.
GROWS, SHRINKS = 2.0, 0.25


def start_states(model: Model, values: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Default start states of many operating points.

    Parameters
    ----------
    values : array, shape (parameter, point)

    Returns
    -------
    x : array, shape (state, point)
    found : array of bool, shape (point,)
        Whether the model's default start was had; where no equilibrium exists the start is the states' own start plus
        the model's ``start_where_none``.
    """
    n = values.shape[1]
    fixed = np.repeat(np.array([s.start for s in model.states])[:, None], n, axis=1)
    if model.start == "states":
        return fixed, np.ones(n, dtype=bool)
    offset = np.array([model.start_where_none.get(s, 0.0) for s in model.states])[:, None]
    if model.near_equilibrium is None:
        x, found = equilibrium(model, values, fixed + offset)
        return np.where(found, x, fixed + offset), found
    near = model.near_equilibrium({p.name: row for p, row in zip(model.parameters, values, strict=True)})
    guess = np.stack([np.broadcast_to(near.get(s.name, 0.0), (n,)) for s in model.states]).astype(float)
    x, found = equilibrium(model, values, np.where(np.isfinite(guess).all(axis=0), guess, fixed + offset))
    left = np.flatnonzero(~found)
    if left.size:
        again, there = equilibrium(model, values[:, left], (fixed + offset)[:, left])
        x[:, left], found[left] = again, there
    return np.where(found, x, fixed + offset), found


def rest_state(system: System) -> dict[str, float] | None:
    """States of a system's static equilibrium, all forcing off; None where its model declares none, or none is found."""
    model = system.model
    if model.equilibrium:
        numbers = {p: float(system.values[p.name]) for p in model.parameters}
        return {s.name: float(sympify(model.equilibrium.get(s, 0)).subs(numbers)) for s in model.states}
    if model.start != "equilibrium":
        return None
    x, found = start_states(system.plain_model(), system.vector[:, None])
    return dict(zip(system.states, map(float, x[:, 0]), strict=True)) if found[0] else None


def equilibrium(model: Model, values: Array, guess: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Solve rates = 0 with all forcing off, each point on its own.

    Damped Newton on the compiled kernel with its own Jacobian: the step is halved until every gap stays open and the
    residual falls; a point ends when its step is below `SMALL` of the sizes that the states, or those alike to them
    (`scales`), have had on the way, or is given up after `MOST_STEPS`. Points that this leaves
    without an equilibrium (journals carried close to the wall) are first run to rest from the guess (`_run_to_rest`). What
    is found is the rest state of the kernel: as good as the tables of its films.

    Returns
    -------
    x : array, shape (state, point)
    found : array of bool, shape (point,)
    """
    x, found = guess.copy(), np.zeros(guess.shape[1], dtype=bool)
    parts = (
        (form, members[first : first + SOLVED])
        for form, members in variants(model, values) for first in range(0, members.size, SOLVED)
    )  # fmt: skip
    for form, members in parts:
        rates = _Rates(form, values[:, members])
        near, there = _newton(rates, np.arange(members.size), guess[:, members])
        x[:, members], found[members] = near, there
        left = np.flatnonzero(~there)
        if left.size:
            near, there = _newton(rates, left, _run_to_rest(rates, left, guess[:, members[left]]))
            x[:, members[left[there]]], found[members[left[there]]] = near[:, there], True
    return x, found


class _Rates:
    """Rates of some points with all forcing off, and their Jacobian; ``clock`` is T/2 pi, ``weight`` that of `Likeness`."""

    def __init__(self, model: Model, values: Array) -> None:
        self.values, self.gaps = values, stop_function(model, "gap")
        self.evaluate = Evaluator.of(model, values, jacobian=True)
        self.like, period = likeness(model), periods(model, values)
        self.clock, self.weight = period / (2 * np.pi), self.like.weights(period)

    def residual(self, f: Array, points: NDArray[np.intp]) -> Array:
        """Size of rates, those of positions and of velocities in one unit."""
        with np.errstate(over="ignore"):  # what is infinite falls nowhere
            return np.asarray(np.linalg.norm(f * self.weight[:, points] * self.clock[points], axis=0))

    def sizes(self, seen: Array, points: NDArray[np.intp]) -> Array:
        """What a Newton step of each state is small against, from the largest values that the states have had."""
        weight = self.weight[:, points]
        return np.asarray(largest_of(self.like.group, seen * weight) / weight)

    def __call__(self, x: Array, points: NDArray[np.intp]) -> tuple[Array, Array]:
        """Rates, shape (state, column), and Jacobian, (column, row, state); infinite behind a closed gap."""
        rates, jacobian = self.evaluate(0.0, x, points, forced=False)
        return self._behind_gaps(rates, x, points), jacobian.transpose(2, 0, 1)

    def alone(self, x: Array, points: NDArray[np.intp]) -> Array:
        """Rates without their Jacobian."""
        return self._behind_gaps(self.evaluate.rates(0.0, x, points, forced=False), x, points)

    def _behind_gaps(self, rates: Array, x: Array, points: NDArray[np.intp]) -> Array:
        rows = self.gaps(list(x), list(self.values[:, points]))
        open_gaps = [np.broadcast_to(gap, points.shape) > 0 for gap in rows]
        rates[:, ~np.all(open_gaps or [np.full(points.size, True)], axis=0)] = np.inf
        return rates


def _run_to_rest(rates: _Rates, points: NDArray[np.intp], x: Array) -> Array:
    """Pseudo-transient continuation: implicit Euler steps that grow, so that a run to rest ends as Newton's method.

    A step is taken where it keeps every gap open and does not raise the rates by more than half; else it is shortened.
    """
    step = FIRST * rates.clock[points]
    f, jacobian = rates(x, points)
    for _ in range(RUN):
        matrix = np.eye(x.shape[0]) / step[:, None, None] - jacobian
        moves = np.asarray(np.isfinite(f).all(axis=0) & np.isfinite(matrix).all(axis=(1, 2)))
        moves[moves] = np.linalg.slogdet(matrix[moves])[0] != 0
        change = np.zeros_like(x)
        change[:, moves] = np.linalg.solve(matrix[moves], f[:, moves].T[..., None])[..., 0].T
        trial, slopes = rates(x + change, points)
        good = moves & np.isfinite(slopes).all(axis=(1, 2))
        good &= rates.residual(trial, points) < 1.5 * rates.residual(f, points)
        x, f = np.where(good, x + change, x), np.where(good, trial, f)
        jacobian = np.where(good[:, None, None], slopes, jacobian)
        step *= np.where(good, GROWS, SHRINKS)
    return x


def _newton(rates: _Rates, points: NDArray[np.intp], guess: Array) -> tuple[Array, NDArray[np.bool_]]:
    x, found, seen = guess.copy(), np.zeros(points.size, dtype=bool), np.abs(guess)
    active = np.arange(points.size)
    f, jacobian = rates(x, points)
    for _ in range(MOST_STEPS):
        now = x[:, active]
        regular = np.asarray(np.isfinite(jacobian).all(axis=(1, 2)) & np.isfinite(f).all(axis=0))
        regular[regular] = np.linalg.slogdet(jacobian[regular])[0] != 0
        active, now, f, jacobian = active[regular], now[:, regular], f[:, regular], jacobian[regular]
        if active.size == 0:
            break
        step = np.asarray(np.linalg.solve(jacobian, -f.T[..., None])[..., 0].T, dtype=float)
        size, worse, f, jacobian = _halvings(rates, points[active], now, step, f)
        x[:, active] = np.where(worse, now, now + size * step)
        seen[:, active] = np.maximum(seen[:, active], np.abs(x[:, active]))
        small = (np.abs(step) <= SMALL * rates.sizes(seen[:, active], points[active])).all(axis=0)
        found[active[small]] = True  # a step this small cannot lower a residual that is rounding already
        stay = ~small & ~worse
        active, size, f, jacobian = active[stay], size[stay], f[:, stay], jacobian[stay]
        shorter = np.flatnonzero(size < 1)  # whole steps have their rates and Jacobian already
        if shorter.size:
            f[:, shorter], jacobian[shorter] = rates(x[:, active[shorter]], points[active[shorter]])
    return x, found


def _halvings(
    rates: _Rates, points: NDArray[np.intp], x: Array, step: Array, f: Array
) -> tuple[Array, NDArray[np.bool_], Array, Array]:
    """Largest of 1, 1/2, ... of each step that lowers the residual, and where none does: two calls for all of them.

    And rates and Jacobian after the whole step.
    """
    norm, size = rates.residual(f, points), np.ones(points.size)
    after, slopes = rates(x + step, points)
    worse = ~(rates.residual(after, points) < norm)
    left = np.flatnonzero(worse)
    if left.size:
        sizes = 0.5 ** np.arange(1, HALVINGS + 1)[:, None]
        trial = x[:, None, left] + sizes * step[:, None, left]
        many = np.tile(points[left], HALVINGS)
        found = rates.residual(rates.alone(trial.reshape(x.shape[0], -1), many), many).reshape(trial.shape[1:])
        lower = found < norm[left]
        worse[left] = ~lower.any(axis=0)
        size[left] = sizes[lower.argmax(axis=0), 0]
    return size, worse, after, slopes
