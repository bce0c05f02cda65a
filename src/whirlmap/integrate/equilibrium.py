"""Start states: the static equilibrium with all forcing off, by damped Newton, for many operating points at once."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from whirlmap.equations.model import Model
from whirlmap.integrate.rescue import stop_function
from whirlmap.kernels.reference import reference_rates

Array = NDArray[np.float64]

#: Newton steps before a point counts as having no equilibrium.
MOST_STEPS = 60
#: Points that are solved together: their Jacobians and the film's quadrature nodes then stay in the caches.
PIECE = 256
#: Steps with the last Jacobian, after the tables have done their part.
CHORDS = 2
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

    Damped Newton on the reference kernel with a forward-difference Jacobian: the step is halved until every gap stays
    open and the residual falls; a point ends when its step is below 1e-11, or is given up after `MOST_STEPS`. Points
    that this leaves without an equilibrium (journals carried close to the wall) are led there from the guess:
    rates = (1 - k/n) rates(guess) for k = 1..n, n = `STAGES`, each solved from the one before. All of this reads the
    film's tables; what is found is then mended with what they are fitted to, by `CHORDS` steps with the last Jacobian.

    Returns
    -------
    x : array, shape (state, point)
    found : array of bool, shape (point,)
    """
    x, found = guess.copy(), np.zeros(guess.shape[1], dtype=bool)
    for members in _pieces(_by_table_parameter(model, values)):
        x[:, members], found[members] = _newton(model, values[:, members], guess[:, members])
        left = members[~found[members]]
        if left.size:
            near = guess[:, left]
            away = reference_rates(model, forced=False, tables="read")(0.0, near, values[:, left])
            for k in range(1, STAGES + 1):
                near, there = _newton(model, values[:, left], near, less=(1 - k / STAGES) * away, most=STAGE_STEPS)
                near, away, left = near[:, there], away[:, there], left[there]
                if not left.size:
                    break
            x[:, left], found[left] = near, True
        if model.tables and found[members].any():
            solved = members[found[members]]
            x[:, solved] = _mended(model, values[:, solved], x[:, solved])
    return x, found


def _mended(model: Model, values: Array, x: Array) -> Array:
    """Take equilibria of the tables to those of the functions that these are fitted to."""
    read = reference_rates(model, forced=False, tables="read")
    smooth = reference_rates(model, forced=False, tables="samples")
    everything = np.arange(x.shape[1])
    jacobian = _differences(lambda z, at: read(0.0, z, values[:, at]), x, read(0.0, x, values), everything)
    for _ in range(CHORDS):
        x = x - np.linalg.solve(jacobian, smooth(0.0, x, values).T[..., None])[..., 0].T
    return x


def _by_table_parameter(model: Model, values: Array) -> list[NDArray[np.intp]]:
    """Split points by the values that select a table: the exact functions take one at a time."""
    if not model.tables:
        return [np.arange(values.shape[1])]
    from whirlmap.equations.pieces import tabulated

    names = {e.parameter for rate in model.equations.values() for e in rate.atoms(tabulated)}
    rows = [i for i, p in enumerate(model.parameters) if p in names]
    _, index = np.unique(values[rows], axis=1, return_inverse=True)
    return [np.flatnonzero(index.ravel() == k) for k in range(int(index.max()) + 1)]


def _pieces(groups: list[NDArray[np.intp]]) -> list[NDArray[np.intp]]:
    """Cut groups into pieces of at most `PIECE` points."""
    return [members[i : i + PIECE] for members in groups for i in range(0, members.size, PIECE)]


def _newton(
    model: Model, values: Array, guess: Array, *, less: Array | None = None, most: int = MOST_STEPS
) -> tuple[Array, NDArray[np.bool_]]:
    rates = reference_rates(model, forced=False, tables="read")
    gaps = stop_function(model, "gap")
    points = guess.shape[1]

    def residual(x: Array, at: NDArray[np.intp]) -> Array:
        """Rates at points whose gaps are open; infinite elsewhere, where no film exists."""
        out = np.full(x.shape, np.inf)
        open_gaps = [np.broadcast_to(g, x.shape[1:]) > 0 for g in gaps(list(x), list(values[:, at]))]
        inside = np.all(open_gaps or [np.full(at.size, True)], axis=0)
        if inside.any():
            out[:, inside] = rates(0.0, x[:, inside], values[:, at[inside]])
            if less is not None:
                out[:, inside] -= less[:, at[inside]]
        return out

    x, found = guess.copy(), np.zeros(points, dtype=bool)
    active = np.arange(points)
    for _ in range(most):
        now = x[:, active]
        f = residual(now, active)
        jacobian = _differences(residual, now, f, active)
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
    residual: Callable[[Array, NDArray[np.intp]], Array], x: Array, step: Array, f: Array, at: NDArray[np.intp]
) -> tuple[Array, NDArray[np.bool_]]:
    """Largest of 1, 1/2, ... of each step that lowers the residual, and where none does: two calls for all of them."""
    norm, size = np.linalg.norm(f, axis=0), np.ones(at.size)
    worse = ~(np.linalg.norm(residual(x + step, at), axis=0) < norm)
    left = np.flatnonzero(worse)
    if left.size:
        sizes = 0.5 ** np.arange(1, HALVINGS + 1)[:, None]
        trial = x[:, None, left] + sizes * step[:, None, left]
        found = residual(trial.reshape(x.shape[0], -1), np.tile(at[left], HALVINGS)).reshape(trial.shape)
        lower = np.linalg.norm(found, axis=0) < norm[left]
        worse[left] = ~lower.any(axis=0)
        size[left] = sizes[lower.argmax(axis=0), 0]
    return size, worse


def _differences(
    residual: Callable[[Array, NDArray[np.intp]], Array], x: Array, f: Array, at: NDArray[np.intp]
) -> Array:
    """Jacobian of the residual by forward differences, shape (point, row, column): good enough for Newton's method."""
    n, h = x.shape[0], 1e-7
    moved = x[:, None, :] + h * np.eye(n)[:, :, None]  # (state, moved state, point)
    rows = residual(moved.reshape(n, -1), np.tile(at, n)).reshape(n, n, -1)
    with np.errstate(invalid="ignore"):  # inf - inf at a closed gap: the point is given up by the caller
        out: Array = ((rows - f[:, None, :]) / h).transpose(2, 0, 1)
    return out
