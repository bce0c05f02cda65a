"""Periodic orbits that motions approach too slowly to wait for, found by Newton's method on the map of one return.

A motion that contracts by 1e-5 in a period takes two million of them to return to 1e-9. Its orbit is found from where it
stands: F is the map over m common periods, M its Jacobian, which all tangent vectors of one round give, and x goes to
x + (I - M)^-1 (F(x) - x) until it stands still. The orbit counts only if all of these hold:

1. It closes to rounding, and all its multipliers lie inside the unit circle by three times what the steps leave of error.
2. The motion goes there: its distance from the orbit has fallen, over the record that is given, at least half as fast as
   the largest multiplier says, or is smaller than `BESIDE` all over the last part of it.

The smallest return of the orbit is then that of its own points.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.winding import weighted_average
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.scales import scales

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Points = NDArray[np.intp]

#: Rounds of Newton's method at most, and scaled residual with which it has converged: what rounding leaves of a round.
ROUNDS, CLOSED = 8, 1e-9
#: Largest step of Newton's method, over the sizes of the states over one round: an orbit may be far smaller than the way
#: to it, but what asks for more has lost it.
FARTHEST = 1e6
#: Errors of the multiplier that the circle must be away, and part of the circle within which they are measured.
SURE, NEAR = 3.0, 0.02
#: Part of the rate of the largest multiplier at which a motion must have come nearer to its orbit.
FOLLOWS = 0.5
#: Parts of a record whose distances are compared, and scaled distance that is near enough by itself: the record may have
#: other steps, and so an orbit that lies beside this one by their error.
PARTS, BESIDE = 3, 1e-3
#: Orbits that go round together.
BATCH = 512


@dataclass(frozen=True)
class Orbits:
    """Orbits of some points, each array ending in the point axis.

    Attributes
    ----------
    multiple : array of int
        Smallest return in common periods; 0 where no stable orbit was found that the motion goes to.
    x : array, shape (state, point)
        A point of the orbit, at phase zero of the common period.
    distance : array
        Scaled distance after one return.
    scale : array, shape (state, point)
        Sizes of the states over the orbit.
    """

    multiple: Integers
    x: Array
    distance: Array
    scale: Array


@dataclass(frozen=True)
class _Round:
    """One round of some points: ends less starts, Jacobians (point, state, state), sizes and points on the way."""

    change: Array
    jacobian: Array
    scale: Array
    path: Array
    running: NDArray[np.bool_]


def close_orbits(
    ensemble: Ensemble, points: Points, multiple: Integers, paths: Sequence[Array], cyclic: dict[int, float],
    tolerance: float,
) -> Orbits:  # fmt: skip
    """Find the orbits that some points of a forced model contract to.

    Parameters
    ----------
    ensemble : Ensemble
        Stays as it is; at phase zero.
    points : array of int
    multiple : array of int, shape like ``points``
        Return that is tried for each, in common periods.
    paths : sequence of array, shape (time, state)
        Section points of each up to its present state, once per common period.
    cyclic : mapping of state index to period
    tolerance : float
        Of a return.
    """
    states = ensemble.model.dimension
    out = Orbits(
        np.zeros(points.size, dtype=np.int64), ensemble.x[:, points].copy(), np.full(points.size, np.nan),
        np.ones((states, points.size)),
    )  # fmt: skip
    for m in np.unique(multiple):
        at = np.flatnonzero(multiple == m)
        for these in np.array_split(at, -(-at.size // BATCH)):
            _close(ensemble, points, these, int(m), paths, cyclic, tolerance, out)
    return out


def _close(
    ensemble: Ensemble, points: Points, these: Points, m: int, paths: Sequence[Array], cyclic: dict[int, float],
    tolerance: float, out: Orbits,
) -> None:  # fmt: skip
    """Newton's method for points that share a return, into ``out``."""
    x, left = ensemble.x[:, points[these]], these
    closed: list[Points] = []
    for _ in range(ROUNDS):
        went = _round(ensemble, points[left], x, m, cyclic)
        step = _newton_step(went)
        with np.errstate(invalid="ignore"):
            residual = np.abs(went.change / went.scale).max(axis=0)
            done = went.running & (residual <= CLOSED) & (np.abs(step / went.scale).max(axis=0) <= CLOSED**0.5)
            goes = went.running & ~done & (np.abs(step / went.scale).max(axis=0) <= FARTHEST)
        if done.any():
            here = left[done]
            out.x[:, here], out.distance[here], out.scale[:, here] = x[:, done], residual[done], went.scale[:, done]
            good = _believed(ensemble, points[here], x[:, done], m, went, done, [paths[k] for k in here], cyclic)
            out.multiple[here] = np.where(good, _smallest(went.path[:, :, done], went.scale[:, done], tolerance), 0)
            closed.append(here)
        x, left = (x + step)[:, goes], left[goes]
        if not left.size:
            break


def _round(
    ensemble: Ensemble, points: Points, x: Array, m: int, cyclic: dict[int, float], finer: int = 1
) -> _Round:
    """One round from x, with all tangent vectors."""
    e = Ensemble(
        ensemble.model, ensemble.values[:, points], x.copy(), orders=ensemble.orders,
        steps=finer * ensemble.point_steps[points], method=ensemble.method, tangents=ensemble.model.dimension,
        workers=ensemble.workers, orthonormal=False, turn=ensemble.period[points], beyond=ensemble.limits[:, points],
    )  # fmt: skip
    segment = e.advance(m * e.strobe, save_periods=e.strobe, extremes=True)
    assert segment.extremes is not None
    low, high = (segment.extremes[name][: x.shape[0]] for name in ("minimum", "maximum"))
    scale = scales(e.model, e.period, high - low, np.maximum(np.abs(low), np.abs(high)))
    path = segment.saved - x
    for k, period in cyclic.items():
        path[:, k] -= period * np.rint(path[:, k] / period)
    return _Round(path[-1], e.vectors.transpose(2, 1, 0), scale, path, e.running)


def _newton_step(went: _Round) -> Array:
    """Steps to where points stand still over a round, infinite where a round has ended."""
    step = np.full(went.change.shape, np.inf)
    good = np.flatnonzero(went.running & np.isfinite(went.jacobian).all(axis=(1, 2)))
    if good.size:
        size = went.scale[:, good].T  # in sizes of the states, so that units do not matter
        matrix = np.eye(len(step)) - went.jacobian[good] * size[:, None, :] / size[:, :, None]
        regular = np.linalg.slogdet(matrix).sign != 0
        good, size = good[regular], size[regular]
        step[:, good] = np.linalg.solve(matrix[regular], (went.change[:, good].T / size)[:, :, None])[:, :, 0].T * size.T
    return step


def _believed(
    ensemble: Ensemble, points: Points, x: Array, m: int, went: _Round, which: NDArray[np.bool_], paths: Sequence[Array],
    cyclic: dict[int, float],
) -> NDArray[np.bool_]:  # fmt: skip
    """Whether orbits are stable for sure, and their motions go there."""
    largest = np.abs(np.linalg.eigvals(went.jacobian[which])).max(axis=1)
    error = np.zeros(points.size)
    near = np.flatnonzero(np.abs(largest - 1) < NEAR)
    if near.size:
        finer = _round(ensemble, points[near], x[:, near], m, cyclic, finer=2)
        with np.errstate(invalid="ignore"):
            other = np.abs(np.linalg.eigvals(np.nan_to_num(finer.jacobian))).max(axis=1)
        error[near] = np.abs(other - largest[near])
    stable = largest < 1 - SURE * error
    rate = np.log(np.maximum(largest, np.finfo(float).tiny)) / m
    path, scale = went.path[:, :, which], went.scale[:, which]
    comes = np.zeros(points.size, dtype=bool)
    rows = np.array([len(p) for p in paths])
    for count in np.unique(rows[rows >= PARTS]):
        at = np.flatnonzero(rows == count)
        records = np.stack([paths[k] for k in at], axis=2)
        comes[at] = _comes_near(x[:, at], path[:, :, at], scale[:, at], rate[at], records, cyclic)
    return stable & comes


def _comes_near(
    x: Array, orbit: Array, scale: Array, rate: Array, records: Array, cyclic: dict[int, float]
) -> NDArray[np.bool_]:
    """Whether records, which end where Newton's method began, have come nearer to the orbits through x."""
    rows, m = len(records), len(orbit)
    # Row r is r - rows + 1 common periods from the present state, whose place on the orbit is x.
    place = np.concatenate([np.zeros((1, *x.shape)), orbit[:-1]]) + x
    away = records - place[(np.arange(rows) - rows + 1) % m]
    for k, period in cyclic.items():
        away[:, k] -= period * np.rint(away[:, k] / period)
    far = np.abs(away / scale).max(axis=1)
    length = rows // PARTS
    # A weighted average tells a slow fall from what a window cuts off the turns of a spiral.
    first, last = (weighted_average(part**2) for part in (far[:length], far[-length:]))
    with np.errstate(divide="ignore", invalid="ignore"):
        nearer = np.log(last / first) / 2 <= FOLLOWS * rate * (rows - length)
    return np.asarray(nearer | (far[-length:].max(axis=0) <= BESIDE))


def _smallest(path: Array, scale: Array, tolerance: float) -> Integers:
    """Smallest return of closed orbits from their points, shape (m, state, point)."""
    m = len(path)
    out = np.full(path.shape[2], m, dtype=np.int64)
    for d in range(m - 1, 0, -1):
        if m % d == 0:
            apart = np.abs((np.roll(path, -d, axis=0) - path) / scale).max(axis=(0, 1))
            out[apart <= 10 * tolerance] = d
    return out
