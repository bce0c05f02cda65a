"""Start states: the static equilibrium with all forcing off, by damped Newton, for many operating points at once."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from whirlmap.equations.model import Model
from whirlmap.integrate.ensemble import variants
from whirlmap.integrate.evaluation import Evaluator
from whirlmap.integrate.rescue import stop_function

Array = NDArray[np.float64]

#: Newton steps before a point counts as having no equilibrium.
MOST_STEPS = 60
#: How often a step is halved before its point counts as stuck.
HALVINGS = 30
#: Steps from the guess's own rates to zero, where Newton's method alone finds nothing.
STAGES = 5
#: Newton steps in each of these: they start close by, so that more means that there is nothing to find.
STAGE_STEPS = 12


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
    x, found = equilibrium(model, values, fixed + offset)
    return np.where(found, x, fixed + offset), found


def equilibrium(model: Model, values: Array, guess: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Solve rates = 0 with all forcing off, each point on its own.

    Damped Newton on the compiled kernel with its own Jacobian: the step is halved until every gap stays open and the
    residual falls; a point ends when its step is below 1e-11, or is given up after `MOST_STEPS`. Points that this leaves
    without an equilibrium (journals carried close to the wall) are led there from the guess:
    rates = (1 - k/n) rates(guess) for k = 1..n, n = `STAGES`, each solved from the one before. What is found is the rest
    state of the kernel: as good as the tables of its films.

    Returns
    -------
    x : array, shape (state, point)
    found : array of bool, shape (point,)
    """
    x, found = guess.copy(), np.zeros(guess.shape[1], dtype=bool)
    for form, members in variants(model, values):
        rates = _Rates(form, values[:, members])
        local = np.arange(members.size)
        near, there = _newton(rates, local, guess[:, members])
        x[:, members], found[members] = near, there
        left = local[~there]
        if left.size:
            near = guess[:, members[left]]
            away = rates(near, left)[0]
            for k in range(1, STAGES + 1):
                near, there = _newton(rates, left, near, less=(1 - k / STAGES) * away, most=STAGE_STEPS)
                near, away, left = near[:, there], away[:, there], left[there]
                if not left.size:
                    break
            x[:, members[left]], found[members[left]] = near, True
    return x, found


class _Rates:
    """Rates of some points with all forcing off, and their Jacobian."""

    def __init__(self, model: Model, values: Array) -> None:
        self.values, self.gaps = values, stop_function(model, "gap")
        self.evaluate = Evaluator.of(model, values, jacobian=True)

    def __call__(self, x: Array, points: NDArray[np.intp]) -> tuple[Array, Array]:
        """Rates, shape (state, column), and Jacobian, (column, row, state); infinite behind a closed gap."""
        rates, jacobian = self.evaluate(0.0, x, points, forced=False)
        rows = self.gaps(list(x), list(self.values[:, points]))
        open_gaps = [np.broadcast_to(gap, points.shape) > 0 for gap in rows]
        rates[:, ~np.all(open_gaps or [np.full(points.size, True)], axis=0)] = np.inf
        return rates, jacobian.transpose(2, 0, 1)


def _newton(
    rates: _Rates, points: NDArray[np.intp], guess: Array, *, less: Array | None = None, most: int = MOST_STEPS
) -> tuple[Array, NDArray[np.bool_]]:
    def residual(x: Array, at: NDArray[np.intp]) -> tuple[Array, Array]:
        f, jacobian = rates(x, points[at])
        return (f if less is None else f - less[:, at]), jacobian

    x, found = guess.copy(), np.zeros(points.size, dtype=bool)
    active = np.arange(points.size)
    for _ in range(most):
        now = x[:, active]
        f, jacobian = residual(now, active)
        regular = np.asarray(np.isfinite(jacobian).all(axis=(1, 2)) & np.isfinite(f).all(axis=0))
        regular[regular] = np.linalg.slogdet(jacobian[regular])[0] != 0
        active, now, f, jacobian = active[regular], now[:, regular], f[:, regular], jacobian[regular]
        if active.size == 0:
            break
        step = np.asarray(np.linalg.solve(jacobian, -f.T[..., None])[..., 0].T, dtype=float)
        size, worse = _halvings(residual, now, step, f, active)
        x[:, active] = np.where(worse, now, now + size * step)
        small = np.abs(step).max(axis=0) < 1e-11 * (1 + np.abs(now).max(axis=0))
        found[active[small]] = True  # a step this small cannot lower a residual that is rounding already
        active = active[~small & ~worse]
    return x, found


def _halvings(
    residual: Callable[[Array, NDArray[np.intp]], tuple[Array, Array]], x: Array, step: Array, f: Array,
    at: NDArray[np.intp],
) -> tuple[Array, NDArray[np.bool_]]:  # fmt: skip
    """Largest of 1, 1/2, ... of each step that lowers the residual, and where none does: two calls for all of them."""
    norm, size = np.linalg.norm(f, axis=0), np.ones(at.size)
    worse = ~(np.linalg.norm(residual(x + step, at)[0], axis=0) < norm)
    left = np.flatnonzero(worse)
    if left.size:
        sizes = 0.5 ** np.arange(1, HALVINGS + 1)[:, None]
        trial = x[:, None, left] + sizes * step[:, None, left]
        found = residual(trial.reshape(x.shape[0], -1), np.tile(at[left], HALVINGS))[0].reshape(trial.shape)
        lower = np.linalg.norm(found, axis=0) < norm[left]
        worse[left] = ~lower.any(axis=0)
        size[left] = sizes[lower.argmax(axis=0), 0]
    return size, worse
