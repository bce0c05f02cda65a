"""The nearest return in a record of section points, and whether the end of the record has reached it."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.periodic_orbits.newton import wrapped
from whirlmap.analysis.steady.return_search import ROUNDING

Array = NDArray[np.float64]

#: Longest return that is sought, in section points.
LONGEST = 200


def near_return(path: Array, size: Array, cyclic: Mapping[int, float], tolerance: float) -> tuple[int, float, bool]:
    """Find the nearest return of a record.

    Parameters
    ----------
    path : array, shape (time, state)
        Section points, once per common period.
    size : array, shape (state,)
        What differences are divided by.
    cyclic : mapping of state index to period
        Angles.
    tolerance : float
        Of a return.

    Returns
    -------
    nearest : int
        The smallest number of section points after which the end of the record returns, else the one whose distance, by the
        last point, is the smallest; 0 where the record is too short.
    nearness : float
        That distance.
    returned : bool
        Whether it returns: what is left of the approach, at the rate at which differences over a return shrink, is within
        the tolerance (`return_search.to_limit`).
    """
    most = min(LONGEST, len(path) - 1)
    if most < 1:
        return 0, np.nan, False
    distance = np.abs(wrapped(path[-1] - path[-2 : -2 - most : -1], cyclic, axis=1) / size).max(axis=1)
    for m in np.flatnonzero(distance <= tolerance) + 1:
        if _to_limit(path, int(m), size, cyclic) <= tolerance:
            return int(m), float(distance[m - 1]), True
    nearest = int(distance.argmin())
    return nearest + 1, float(distance[nearest]), False


def _to_limit(path: Array, m: int, size: Array, cyclic: Mapping[int, float]) -> float:
    """Largest scaled distance of the last m points from the limit of their approach; infinite where there is none."""
    if len(path) < 3 * m:
        return np.inf
    late, early = (
        float(np.abs(wrapped(path[k - m : k] - path[k - 2 * m : k - m], cyclic, axis=1) / size).max())
        for k in (len(path), len(path) - m)
    )  # fmt: skip
    if late <= ROUNDING:
        return late
    return late + late * late / (early - late) if late < early else np.inf
