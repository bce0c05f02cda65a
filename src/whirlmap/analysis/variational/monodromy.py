"""Monodromy matrices of many orbits at once, and their largest multipliers.

The tangent vectors of an orbit begin as the unit vectors and are integrated over one return without orthonormalisation;
they end as the columns of its monodromy matrix. The largest modulus of its eigenvalues is good to rounding relative to
itself, the small ones drown in that rounding: `floquet` finds these, for one orbit.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.scales import scales_between

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Points = NDArray[np.intp]

#: Orbits that are integrated together: a matrix of twenty states takes 3 kB, the points of a long return twenty times as
#: much.
BATCH = 512


@dataclass(frozen=True)
class Rounds:
    """One return of some points of an ensemble.

    Attributes
    ----------
    multiple : array of int, shape (point,)
        Their lengths in common periods.
    path : array, shape (common period, state, point)
        States at the end of each common period; NaN behind the return, and from where the motion ends.
    matrix : array, shape (point, state, state)
        Derivative of the last of these by the first state; NaN where the motion ends, or sticks to a surface.
    scale : array, shape (state, point)
        Sizes of the states over the return.
    """

    multiple: Integers
    path: Array
    matrix: Array
    scale: Array

    @property
    def end(self) -> Array:
        """States at the ends of the returns, shape (state, point)."""
        return self.path[self.multiple - 1, :, np.arange(self.multiple.size)].T

    def of(self, points: Points) -> "Rounds":
        """Those of some of the points, with paths as long as the longest of their returns."""
        multiple = self.multiple[points]
        path = self.path[: multiple.max(initial=0), :, points]
        return Rounds(multiple, path, self.matrix[points], self.scale[:, points])


def batches(points: int) -> list[Points]:
    """Indices of so many points, as many in each part as go round together."""
    return np.array_split(np.arange(points), -(-points // BATCH)) if points else []


def monodromies(ensemble: Ensemble, points: Points, multiple: Integers, x: Array) -> Rounds:
    """Go round once, with all tangent vectors: each point its own return.

    Parameters
    ----------
    ensemble : Ensemble
        Stays as it is, at phase zero.
    points : array of int
    multiple : array of int, shape like ``points``
        Return of each, in common periods.
    x : array, shape (state, len(points))
        Where the returns begin.
    """
    e = Ensemble(
        ensemble.model, ensemble.values[:, points], x, orders=ensemble.orders,
        steps=ensemble.point_steps[points], method=ensemble.method, tangents=ensemble.model.dimension,
        workers=ensemble.workers, orthonormal=False, turn=ensemble.period[points], beyond=ensemble.limits[:, points],
    )  # fmt: skip
    segment = e.advance(multiple * e.strobe, save_periods=e.strobe, extremes=True)
    matrix = np.where(e.running[:, None, None], e.vectors.transpose(2, 1, 0), np.nan)
    assert segment.extremes is not None
    low, high = segment.extremes["minimum"], segment.extremes["maximum"]
    return Rounds(multiple, segment.saved, matrix, scales_between(e.model, e.period, low, high))


def largest_multipliers(ensemble: Ensemble, points: Points, multiple: Integers, x: Array | None = None) -> Array:
    """Largest modulus of the multipliers over one return of some points that lie on periodic orbits.

    Parameters
    ----------
    ensemble : Ensemble
        Stays as it is, at phase zero.
    points : array of int
    multiple : array of int, shape like ``points``
        Return of each, in common periods.
    x : array, shape (state, len(points)), optional
        A point of each orbit; the present states where absent.

    Returns
    -------
    array, shape like ``points``
        Infinite where the orbit ends before its return, or sticks to a surface.
    """
    x, largest = ensemble.x[:, points] if x is None else x, np.empty(points.size)
    for these in batches(points.size):
        largest[these] = spectral_radius(monodromies(ensemble, points[these], multiple[these], x[:, these]).matrix)
    return largest


def spectral_radius(matrix: Array) -> Array:
    """Largest modulus of the eigenvalues of matrices (..., n, n); infinite where one is not finite."""
    known = np.isfinite(matrix).all(axis=(-2, -1))
    largest = np.full(known.shape, np.inf)
    if known.any():
        largest[known] = np.abs(np.linalg.eigvals(matrix[known])).max(axis=-1)
    return largest
