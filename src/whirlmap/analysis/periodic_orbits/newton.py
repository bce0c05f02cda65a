"""Periodic orbits by Newton's method, also those that motions approach too slowly for integration.

F is the map over m common periods, M its Jacobian, the monodromy matrix, and x goes to x + (I - M)^-1 (F(x) - x) until it
converges [parker1989, ch. 5]. It converges quadratically: what the last step leaves is of the order of its square.

A motion that contracts by 1e-5 in a period takes two million of them to return to 1e-9. Its orbit is found from its present
state, and counts only if all of these hold:

1. It closes to rounding, and all its multipliers lie inside the unit circle by three times what the steps leave of error.
2. The motion goes there: its distance from the orbit has fallen, over the record that is given, at least half as fast as
   the largest multiplier says, or is smaller than `BESIDE` all over the last part of it.

The smallest return of the orbit is then that of its own points.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.indicators.birkhoff import weighted_average
from whirlmap.analysis.variational.monodromy import Rounds, batches, monodromies, spectral_radius
from whirlmap.integrate.ensemble import Ensemble

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Points = NDArray[np.intp]
Cyclic = Mapping[int, float] | None

#: Rounds of Newton's method at most, and scaled residual with which it has converged: what rounding leaves of a round.
ROUNDS, CLOSED = 8, 1e-9
#: The same over the magnitude of a state.
ROUNDED = 1e-13
#: Scaled last step: at a multiplier of 1 - 1e-5 it is a hundred thousand residuals, and a residual alone closes nothing.
STILL = 1e-6
#: Largest step of Newton's method, over the sizes of the states over one round: an orbit may be far smaller than the
#: distance to it, but a larger step shows that the iteration has left it.
FARTHEST = 1e6
#: Errors of the multiplier that the circle must be away, and part of the circle within which they are measured.
SURE, NEAR = 3.0, 0.02
#: Part of the rate of the largest multiplier at which a motion must have come nearer to its orbit.
FOLLOWS = 0.5
#: Parts of a record whose distances are compared, and scaled distance that is near enough by itself: the record may have
#: other steps, and so an orbit that lies beside this one by their error.
PARTS, BESIDE = 3, 1e-3
#: Scaled distance at which a record returns by itself, and how far from the orbit it may then be: steep motion shows the
#: error of its steps.
RETURNS, AS_INTEGRATED = 1e-5, 0.05


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
        Scaled distance after one return, before the last step of Newton's method.
    scale : array, shape (state, point)
        Sizes of the states over the orbit.
    """

    multiple: Integers
    x: Array
    distance: Array
    scale: Array


def close_orbits(
    ensemble: Ensemble, points: Points, multiple: Integers, paths: Sequence[Array], cyclic: Cyclic, tolerance: float
) -> Orbits:
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
    shape = ensemble.model.dimension, points.size
    out = Orbits(np.zeros(points.size, dtype=np.int64), np.empty(shape), np.full(points.size, np.nan), np.ones(shape))
    for these in batches(points.size):
        out.x[:, these], out.distance[these], went = newton(ensemble, points[these], multiple[these], cyclic)
        closed = np.flatnonzero(np.isfinite(out.distance[these]))
        if not closed.size:
            continue
        these, orbits = these[closed], went.of(closed)
        out.scale[:, these] = orbits.scale
        good = _stable(ensemble, points[these], out.x[:, these], orbits)
        for m in np.unique(orbits.multiple):
            same = np.flatnonzero(orbits.multiple == m)
            here, orbit = these[same], orbits.of(same)
            approached = _approached(orbit, [paths[k] for k in here], cyclic)
            out.multiple[here] = np.where(good[same] & approached, _smallest(orbit, tolerance, cyclic), 0)
    return out


def newton(
    ensemble: Ensemble, points: Points, multiple: Integers, cyclic: Cyclic = None, *, still: float = STILL
) -> tuple[Array, Array, Rounds]:
    """Newton's method for periodic orbits, from the present states of some points of a forced model.

    Parameters
    ----------
    ensemble : Ensemble
        Stays as it is; at phase zero.
    points : array of int
    multiple : array of int, shape like ``points``
        Return of each, in common periods.
    cyclic : mapping of state index to period, optional
    still : float
        Scaled last step with which a point has converged.

    Returns
    -------
    x : array, shape (state, point)
        A point of each orbit, whether it attracts or repels; an intermediate iterate where the method has not converged.
    distance : array, shape (point,)
        Scaled distance after one return, before the last step; NaN where the method has not converged.
    went : Rounds
        The last return; NaN where the method has not converged.
    """
    x, distance = ensemble.x[:, points], np.full(points.size, np.nan)
    n, count = x.shape
    path = np.full((multiple.max(initial=0), n, count), np.nan)
    last = Rounds(multiple, path, np.full((count, n, n), np.nan), np.full((n, count), np.nan))
    left = np.arange(count)
    for _ in range(ROUNDS):
        if not left.size:
            break
        went = monodromies(ensemble, points[left], multiple[left], x[:, left])
        change = wrapped(went.end - x[:, left], cyclic)
        step = _step(change, went)
        with np.errstate(invalid="ignore"):
            residual, size = (np.abs(a / went.scale).max(axis=0) for a in (change, step))
            # A state with little ripple on a large mean closes to the rounding of its mean.
            least = np.maximum(went.scale, ROUNDED / CLOSED * np.abs(x[:, left]))
            exact, rests = (np.abs(change) <= CLOSED * least).all(axis=0), (np.abs(step) <= still * least).all(axis=0)
        done = exact & rests
        here, goes = left[done], size <= FARTHEST
        x[:, left[goes]] += step[:, goes]
        distance[here] = residual[done]
        last.path[: len(went.path), :, here], last.scale[:, here] = went.path[:, :, done], went.scale[:, done]
        last.matrix[here] = went.matrix[done]
        left = left[goes & ~done]
    return x, distance, last


def _step(change: Array, went: Rounds) -> Array:
    """Newton steps to the fixed points of a return, infinite where a return has ended."""
    step = np.full(change.shape, np.inf)
    good = np.flatnonzero(np.isfinite(went.matrix).all(axis=(1, 2)))
    if good.size:
        size = went.scale[:, good].T  # in sizes of the states, so that units do not matter
        matrix = np.eye(len(step)) - went.matrix[good] * size[:, None, :] / size[:, :, None]
        regular = np.linalg.slogdet(matrix).sign != 0
        good, size = good[regular], size[regular]
        step[:, good] = np.linalg.solve(matrix[regular], (change[:, good].T / size)[:, :, None])[:, :, 0].T * size.T
    return step


def wrapped(difference: Array, cyclic: Cyclic, axis: int = 0) -> Array:
    """Differences of states, which lie along an axis, with those of angles modulo their period."""
    out = np.array(difference)
    states = np.moveaxis(out, axis, 0)
    for k, period in (cyclic or {}).items():
        states[k] -= period * np.rint(states[k] / period)
    return out


def _stable(ensemble: Ensemble, points: Points, x: Array, orbit: Rounds) -> NDArray[np.bool_]:
    """Whether all multipliers lie inside the circle, by more than the steps leave of error."""
    largest = spectral_radius(orbit.matrix)
    error = np.zeros(points.size)
    near = np.flatnonzero(np.abs(largest - 1) < NEAR)
    if near.size:
        finer = ensemble.subset(points[near], steps=2 * ensemble.point_steps[points[near]])
        other = spectral_radius(monodromies(finer, np.arange(near.size), orbit.multiple[near], x[:, near]).matrix)
        error[near] = np.abs(other - largest[near])
    return np.asarray(largest < 1 - SURE * error)


def _approached(orbit: Rounds, paths: Sequence[Array], cyclic: Cyclic) -> NDArray[np.bool_]:
    """Whether records, which end where Newton's method began, have come nearer to the orbits."""
    rate = np.log(np.maximum(spectral_radius(orbit.matrix), np.finfo(float).tiny)) / len(orbit.path)
    out = np.zeros(len(paths), dtype=bool)
    rows = np.array([len(p) for p in paths])
    for count in np.unique(rows[rows >= PARTS]):
        at = np.flatnonzero(rows == count)
        records = np.stack([paths[int(k)] for k in at], axis=2)
        # The last row, at the present state, belongs to the last of the orbit, which is where it began.
        place = orbit.path[:, :, at][(np.arange(count) - count) % len(orbit.path)]
        far = np.abs(wrapped(records - place, cyclic, axis=1) / orbit.scale[:, at]).max(axis=1)
        length = count // PARTS
        # A weighted average tells a slow fall from what a window cuts off the turns of a spiral.
        first, last = (weighted_average(part**2) for part in (far[:length], far[-length:]))
        with np.errstate(divide="ignore", invalid="ignore"):
            nearer = np.log(last / first) / 2 <= FOLLOWS * rate[at] * (count - length)
        beside = far[-length:].max(axis=0)
        out[at] = nearer | (beside <= BESIDE)
        m = len(orbit.path)
        if count > 2 * m:  # a record that returns by itself, beside the orbit as other steps have it
            back = np.abs(wrapped(records[-m:] - records[-2 * m : -m], cyclic, axis=1) / orbit.scale[:, at]).max(axis=(0, 1))
            out[at] |= (back <= RETURNS) & (beside <= AS_INTEGRATED)
    return out


def _smallest(orbit: Rounds, tolerance: float, cyclic: Cyclic) -> Integers:
    """Smallest return of closed orbits from their points."""
    m = len(orbit.path)
    out = np.full(orbit.path.shape[2], m, dtype=np.int64)
    for d in range(m - 1, 0, -1):
        if m % d == 0:
            apart = wrapped(np.roll(orbit.path, -d, axis=0) - orbit.path, cyclic, axis=1)
            out[np.abs(apart / orbit.scale).max(axis=(0, 1)) <= 10 * tolerance] = d
    return out
