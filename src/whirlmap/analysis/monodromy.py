"""The largest Floquet multipliers of many periodic orbits at once: stable or not, orbit by orbit.

All tangent vectors of an orbit go once round it, from the unit vectors and without orthonormalisation; they end as the
columns of its monodromy matrix. The largest modulus of its eigenvalues is good to rounding relative to itself, the small
ones drown in that rounding: `floquet` finds these, for one orbit.
"""

import numpy as np
from numpy.typing import NDArray

from whirlmap.integrate.ensemble import Ensemble

Array = NDArray[np.float64]

#: Orbits that go round together: a matrix of twenty states takes 3 kB.
BATCH = 1024


def monodromies(
    ensemble: Ensemble, points: NDArray[np.intp], multiple: NDArray[np.int64], x: Array | None = None
) -> tuple[Array, Array]:
    """Where one return takes some points, and its derivative there.

    Parameters
    ----------
    ensemble : Ensemble
        Stays as it is, at phase zero.
    points : array of int
    multiple : array of int, shape like ``points``
        Return of each, in common periods.
    x : array, shape (state, len(points)), optional
        Where the returns begin; the present states where absent.

    Returns
    -------
    end : array, shape (state, len(points))
    matrix : array, shape (len(points), state, state)
        Both NaN where the motion ends before its return, or sticks to a surface.
    """
    n = ensemble.model.dimension
    x = ensemble.x[:, points] if x is None else x
    end, matrix = np.full((n, points.size), np.nan), np.full((points.size, n, n), np.nan)
    for m in np.unique(multiple):
        at = np.flatnonzero(multiple == m)
        for these in np.array_split(at, -(-at.size // BATCH)):
            e = Ensemble(
                ensemble.model, ensemble.values[:, points[these]], x[:, these], orders=ensemble.orders,
                steps=ensemble.point_steps[points[these]], method=ensemble.method, tangents=n, workers=ensemble.workers,
                orthonormal=False, turn=ensemble.period[points[these]],
            )  # fmt: skip
            e.advance(int(m) * e.strobe)
            end[:, these[e.running]] = e.x[:, e.running]
            matrix[these[e.running]] = e.vectors[:, :, e.running].transpose(2, 1, 0)
    return end, matrix


def largest_multipliers(ensemble: Ensemble, points: NDArray[np.intp], multiple: NDArray[np.int64]) -> Array:
    """Largest modulus of the multipliers over one return of some points that lie on periodic orbits.

    Parameters as of `monodromies`.

    Returns
    -------
    array, shape like ``points``
        Infinite where the orbit ends before its return, or sticks to a surface.
    """
    _, matrix = monodromies(ensemble, points, multiple)
    return spectral_radius(matrix)


def spectral_radius(matrix: Array) -> Array:
    """Largest modulus of the eigenvalues of matrices (..., n, n); infinite where one is not finite."""
    known = np.isfinite(matrix).all(axis=(-2, -1))
    largest = np.full(known.shape, np.inf)
    if known.any():
        largest[known] = np.abs(np.linalg.eigvals(matrix[known])).max(axis=-1)
    return largest
