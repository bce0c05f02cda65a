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


def largest_multipliers(ensemble: Ensemble, points: NDArray[np.intp], multiple: NDArray[np.int64]) -> Array:
    """Largest modulus of the multipliers over one return of some points that lie on periodic orbits.

    Parameters
    ----------
    ensemble : Ensemble
        Stays as it is, at phase zero.
    points : array of int
    multiple : array of int, shape like ``points``
        Return of each, in common periods.

    Returns
    -------
    array, shape like ``points``
        Infinite where the orbit ends before its return, or sticks to a surface.
    """
    n = ensemble.model.dimension
    largest = np.full(points.size, np.inf)
    for m in np.unique(multiple):
        at = np.flatnonzero(multiple == m)
        for these in np.array_split(at, -(-at.size // BATCH)):
            e = Ensemble(
                ensemble.model, ensemble.values[:, points[these]], ensemble.x[:, points[these]], orders=ensemble.orders,
                steps=ensemble.point_steps[points[these]], method=ensemble.method, tangents=n, workers=ensemble.workers,
                orthonormal=False, turn=ensemble.period[points[these]],
            )  # fmt: skip
            e.advance(int(m) * e.strobe)
            columns = e.vectors[:, :, e.running].transpose(2, 1, 0)
            largest[these[e.running]] = np.abs(np.linalg.eigvals(columns)).max(axis=1)
    return largest
