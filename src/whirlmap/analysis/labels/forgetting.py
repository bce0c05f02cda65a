"""Transients of contracting motions, integrated without tangent vectors once their exponents are known.

A step with a tangent vector costs two to three plain ones, and transients decay slowly.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from whirlmap.integrate.ensemble import Ensemble

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Points = NDArray[np.intp]

#: Part of a difference of start states below which the transient has decayed.
FORGOTTEN = 1e-9
#: Part of it that may be left where n of a locked motion is sought, and T that are run beyond for that.
LEFT, SHOWN = 1e-7, 1024
#: Points stop at multiples of so many T, so that many are at one phase of the forcing, and go on together.
STRETCH = 2048


def forget(
    run: Ensemble, exponent: Array, error: Array, *, done: int, most: int, keep: Callable[[Points, Array], None],
    progress: Callable[[int], None] | None,
) -> tuple[Ensemble, Integers]:  # fmt: skip
    """Run points on until their transients have decayed and their locking can be determined.

    Parameters
    ----------
    run : Ensemble
        Points that have run ``done`` T; stays as it is.
    exponent, error : array, shape (point,)
        Per unit of the model's time; negative by more than its error.
    most : int
        T that a point runs at most, those done included.
    keep : callable
        ``keep(points, section)`` is given section points, once per T, shape (time, state, points), of some of the points.

    Returns
    -------
    plain : Ensemble
        Where they are then, without tangent vectors.
    ran : array of int, shape (point,)
        T that each has run, those done included.
    """
    plain = run.subset(np.arange(run.points), plain=True)
    rate = (exponent + error) * run.period
    needed = np.maximum(np.log(FORGOTTEN) / rate, np.log(LEFT) / rate + SHOWN)
    ran = np.full(run.points, done)
    while (left := np.flatnonzero((ran < needed) & (ran < most) & plain.running)).size:
        at = int(ran[left[0]])
        stretch = min(STRETCH - at % STRETCH, most - at)
        keep(left, plain.advance(stretch, members=left, save_periods=1, progress=progress).saved)
        ran[left] += stretch
    return plain, ran
