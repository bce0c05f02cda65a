"""Start states: the static equilibrium with all forcing off, by damped Newton, for many operating points at once."""

import numpy as np
from numpy.typing import NDArray
from sympy import lambdify

from whirlmap.equations.model import Model
from whirlmap.kernels.reference import reference_rates

Array = NDArray[np.float64]

#: Newton steps before a point counts as having no equilibrium.
MOST_STEPS = 60


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

    Damped Newton on the reference kernel with a central-difference Jacobian: the step is halved until every gap stays
    open and the residual falls; a point ends when its step is below 1e-12, or is given up after `MOST_STEPS`.

    Returns
    -------
    x : array, shape (state, point)
    found : array of bool, shape (point,)
    """
    groups = _by_table_parameter(model, values)
    x, found = guess.copy(), np.zeros(guess.shape[1], dtype=bool)
    for members in groups:
        x[:, members], found[members] = _newton(model, values[:, members], guess[:, members])
    return x, found


def _by_table_parameter(model: Model, values: Array) -> list[NDArray[np.intp]]:
    """Split points by the values that select a table: the exact functions take one at a time."""
    if not model.tables:
        return [np.arange(values.shape[1])]
    from whirlmap.equations.pieces import tabulated

    names = {e.parameter for rate in model.equations.values() for e in rate.atoms(tabulated)}
    rows = [i for i, p in enumerate(model.parameters) if p in names]
    _, index = np.unique(values[rows], axis=1, return_inverse=True)
    return [np.flatnonzero(index.ravel() == k) for k in range(int(index.max()) + 1)]


def _newton(model: Model, values: Array, guess: Array) -> tuple[Array, NDArray[np.bool_]]:
    rates = reference_rates(model, forced=False)
    gaps = lambdify([list(model.states)], [stop.gap for stop in model.stops.values()], modules="numpy")
    n, points = guess.shape

    def residual(x: Array, at: NDArray[np.intp]) -> Array:
        with np.errstate(invalid="ignore", divide="ignore"):
            return rates(0.0, x, values[:, at])

    def open_gaps(x: Array) -> NDArray[np.bool_]:
        return np.all([np.broadcast_to(g, x.shape[1:]) > 0 for g in gaps(list(x))] or [True], axis=0)

    x, found = guess.copy(), np.zeros(points, dtype=bool)
    active = np.arange(points)
    h = 1e-6
    for _ in range(MOST_STEPS):
        if active.size == 0:
            break
        now = x[:, active]
        f = residual(now, active)
        jac = np.empty((active.size, n, n))
        for j in range(n):
            e = np.zeros((n, 1))
            e[j] = h
            jac[:, :, j] = ((residual(now + e, active) - residual(now - e, active)) / (2 * h)).T
        solvable = np.isfinite(jac).all(axis=(1, 2)) & np.isfinite(f).all(axis=0)
        solvable[solvable] &= np.abs(np.linalg.det(jac[solvable] / np.abs(jac[solvable]).max(axis=2, keepdims=True))) > 0
        active, now, f, jac = active[solvable], now[:, solvable], f[:, solvable], jac[solvable]
        if active.size == 0:
            break
        step = np.linalg.solve(jac, -f.T[..., None])[..., 0].T
        size, norm = np.ones(active.size), np.linalg.norm(f, axis=0)
        for _ in range(30):
            trial = now + size * step
            new = np.linalg.norm(residual(trial, active), axis=0)
            worse = ~(open_gaps(trial) & ((new < norm) | (norm < 1e-11)))
            if not worse.any():
                break
            size = np.where(worse, size / 2, size)
        x[:, active] = np.where(worse, now, now + size * step)
        small = np.abs(step).max(axis=0) < 1e-12 * (1 + np.abs(now).max(axis=0)) + 1e-13
        done = ~worse & small
        found[active[done]] = True
        stuck = worse & ~small
        found[active[worse & small]] = True
        active = active[~done & ~stuck & ~(worse & small)]
    return x, found
