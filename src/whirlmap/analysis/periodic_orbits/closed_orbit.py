"""Closed orbits to which runs converge, and whether a run still in its transient converges to a known one.

A run that settles slowly returns to the tolerance long before it stands on its orbit: what is left is the last difference
over 1 - rho, rho the largest multiplier. Two such runs are therefore compared by the orbits that they settle on, as Newton's
method closes them (`newton`).

A run in its transient converges to a known orbit where the map is nearly linear about the orbit: with the
eigenvectors of the monodromy matrix as coordinates, w, one return must take w to L w (L the multipliers) up to half of
(1 - rho) |w|. What the map adds to its linear part shrinks with the square of |w|, so that from there on every return brings
the run nearer. Kinks in the map are no such remainder, and another orbit that lies about this one can look like an approach
for one return; so several successive returns must be like that.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.indicators.distribution import own_scale
from whirlmap.analysis.periodic_orbits.newton import CLOSED, newton, wrapped
from whirlmap.analysis.variational.monodromy import batches, spectral_radius
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.scales import scales_between

Array = NDArray[np.float64]

#: Tolerances of settling within which a run that has returned is on a closed orbit; and the part of each state's range
#: within which it is on one that could not be closed.
SETTLED, SAME_POINT = 10, 1e-4
#: How far Newton's method may take a run that has returned, over the scale of each state: beyond, it belongs to
#: another orbit.
FAR = 0.03
#: Part of what one return contracts by that its map may differ from the linear one.
LINEAR = 0.5
#: Successive returns that must bring a run nearer, at most and at least: one of two may where it alternates about the orbit.
RETURNS, LEAST_RETURNS = 8, 3


@dataclass(frozen=True)
class ClosedOrbit:
    """A periodic orbit.

    Attributes
    ----------
    points : array, shape (row, state)
        The orbit at all phases at which the equations are the same, in the order of time from phase zero on.
    scale : array, shape (state,)
        What differences of each state are divided by (`whirlmap.integrate.scales`).
    matrix : array, shape (state, state)
        Derivative of the map over one return from the first point on; NaN where the orbit could not be closed.
    within : float
        Scaled distance within which a settled run stands on it.
    """

    points: Array
    scale: Array
    matrix: Array
    within: float

    @property
    def closed(self) -> bool:
        """Whether Newton's method has closed it, and it attracts."""
        return bool(np.isfinite(self.matrix).all())

    def distance(self, x: Array, cyclic: Mapping[int, float] | None = None) -> tuple[Array, NDArray[np.intp]]:
        """Scaled distance of states (state, run) to the nearest point, in every state at most, and the row of that point."""
        apart = np.stack([scaled(x - point[:, None], self.scale, cyclic) for point in self.points])
        return apart.min(axis=0), apart.argmin(axis=0)


def closed_orbits(
    ensemble: Ensemble,
    multiple: NDArray[np.int64],
    *,
    every: int,
    tolerance: float,
    cyclic: Mapping[int, float] | None = None,
    far: float | None = FAR,
) -> list[ClosedOrbit]:
    """Close the orbits that runs stand on or near.

    Parameters
    ----------
    ensemble : Ensemble
        Stays as it is, at phase zero.
    multiple : array of int, shape (run,)
        Their returns in common periods.
    every : int
        T between the rows of the orbits: the time after which the equations are the same.
    tolerance : float
        That of settling.
    far : float, optional
        How far Newton's method may go, over the scale of each state; None takes the runs as they are.

    Returns
    -------
    list of ClosedOrbit
        One for each run. Those that could not be closed begin in the run's own state: the method did not converge, went too
        far, ends on an orbit that repels, or the motion sticks to a surface (there the map has no derivative).
    """
    out: dict[int, ClosedOrbit] = {}
    groups = [(int(m), np.flatnonzero(multiple == m)) for m in np.unique(multiple)]
    for m, at in ((m, same[part]) for m, same in groups for part in batches(same.size)):
        part, matrix = ensemble.subset(at), np.full((at.size, *[ensemble.model.dimension] * 2), np.nan)
        if far is not None:
            x, _, went = newton(part, np.arange(at.size), multiple[at], cyclic, still=CLOSED)
            moved = (np.abs(wrapped(x - part.x, cyclic)) / went.scale).max(axis=0)
            closed = np.flatnonzero((spectral_radius(went.matrix) < 1) & (moved <= far))
            part.put(closed, x[:, closed])
            matrix[closed] = went.matrix[closed]
        begin = part.x.copy()
        segment = part.advance(m * part.strobe, save_periods=every, extremes=True)
        points = np.concatenate([begin[None], segment.saved[:-1]])
        assert segment.extremes is not None
        scale = scales_between(part.model, part.period, segment.extremes["minimum"], segment.extremes["maximum"])
        for k, run in enumerate(at):
            within = SETTLED * tolerance if np.isfinite(matrix[k]).all() else SAME_POINT
            out[int(run)] = ClosedOrbit(points[:, :, k], scale[:, k], matrix[k], within)
    return [out[run] for run in range(ensemble.points)]


def nearest_return(record: Array | None, rows: int, cyclic: Mapping[int, float] | None = None) -> int:
    """Common periods after which a record (time, state) comes nearest to its end; 1 where it is too short.

    ``rows`` of the record make one common period.
    """
    if record is None or len(record) <= rows:
        return 1
    apart = scaled((record[-1] - record[-1 - rows :: -rows]).T, own_scale(record), cyclic)
    return 1 + int(apart.argmin())


def scaled(difference: Array, scale: Array, cyclic: Mapping[int, float] | None) -> Array:
    """Largest difference (state, ...) over the scales of the states; angles modulo their period."""
    over = scale.reshape(-1, *[1] * (difference.ndim - 1))
    return np.asarray((np.abs(wrapped(difference, cyclic)) / over).max(axis=0))


def flows_into(saved: Array, orbit: ClosedOrbit, cyclic: Mapping[int, float] | None = None) -> NDArray[np.bool_]:
    """Whether runs are on an orbit, or converge to it.

    Parameters
    ----------
    saved : array, shape (row, state, run)
        Successive states, as far apart in time as the orbit's rows, over `LEAST_RETURNS` returns and one more; the last
        `RETURNS` count.
    orbit : ClosedOrbit

    Returns
    -------
    array of bool, shape (run,)
        False where the orbit is not closed, rows are too few, or a run has ended.
    """
    rows = len(orbit.points)
    out = np.zeros(saved.shape[2], dtype=bool)
    returns = min(RETURNS, len(saved) // rows - 1)
    if not orbit.closed or returns < LEAST_RETURNS:
        return out
    last = saved[-(returns + 1) * rows :]
    good = np.flatnonzero(np.isfinite(last).all(axis=(0, 1)))
    value, vector = np.linalg.eig(orbit.matrix * orbit.scale / orbit.scale[:, None])
    if not good.size or np.linalg.cond(vector) > 1 / np.finfo(float).eps:  # a defective matrix has no such coordinates
        return out
    last = last[:, :, good]
    distance, at = orbit.distance(last[0], cyclic)
    first, each = -at % rows, np.arange(good.size)  # rows until the run stands near the orbit's first point
    w = []
    for turn in range(returns + 1):
        beside = wrapped(last[first + turn * rows, :, each].T - orbit.points[0][:, None], cyclic) / orbit.scale[:, None]
        w.append(np.linalg.solve(vector, beside))
    linear = distance <= 1
    for before, after in pairwise(w):
        rest = np.abs(after - value[:, None] * before).max(axis=0)
        linear &= rest <= LINEAR * (1 - np.abs(value).max()) * np.abs(before).max(axis=0)
    out[good] = linear | (np.abs(beside).max(axis=0) <= orbit.within)
    return out
