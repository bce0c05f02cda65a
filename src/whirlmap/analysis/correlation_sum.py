"""Pairs of points closer than each of many radii: the counts behind a correlation sum.

All pairs are counted exactly, in blocks of points, so that the counts do not depend on the number of threads.
"""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.compiled import compiled

# Radii run down from the largest by eighths of an octave, 27 to a decade. The kernel sorts squared distances
# by the upper bits of their binary form (16 bins to an octave of r^2, no logarithm per pair), so the radii
# are those numbers 2^(e/2) sqrt(1 + j/16) which lie nearest to the even spacing: known exactly, even to 1 %.
_SUB = 16
_PICK = (0, 3, 7, 11)
_SHIFT = np.int64(48)  # 52 bits of mantissa less 4 bits for the 16 bins
_OCTAVES = 3  # of r^2 above the mean squared distance: nothing that is fitted lies there
_FLAGS = {"contract", "reassoc", "nsz", "arcp", "afn"}


@compiled(fastmath=_FLAGS)
def _count_pairs(
    x: NDArray[np.float64],
    wrap: NDArray[np.float64],
    first: NDArray[np.int64],
    rows: tuple[int, int],
    columns: tuple[int, int],
    maximum: bool,
    low: int,
    n_bins: int,
) -> NDArray[np.int64]:
    """Histogram of squared distances between points ``i`` in ``rows`` and ``j >= first[i]`` in ``columns``.

    ``x`` has shape (coordinate, point), the cyclic coordinates last with their periods in ``wrap``. Bin 0
    holds all distances below the lowest edge, the last one all above the highest.
    """
    d, n_plain = x.shape[0], x.shape[0] - wrap.shape[0]
    histogram = np.zeros(n_bins + 2, np.int64)
    buffer = np.empty(256)
    bits = buffer.view(np.int64)
    for i in range(rows[0], rows[1]):
        begin = max(columns[0], first[i])
        while begin < columns[1]:
            width = min(256, columns[1] - begin)
            # One coordinate at a time over a strip of points: the compiler turns the inner loop into vector
            # code, which beats leaving early pair by pair even with 20 coordinates.
            for j in range(width):
                buffer[j] = 0.0
            for k in range(d):
                here, there = x[k, i], x[k, begin : begin + width]
                period = wrap[k - n_plain] if k >= n_plain else 0.0
                if period > 0.0:
                    for j in range(width):
                        difference = there[j] - here
                        difference -= period * np.rint(difference / period)
                        square = difference * difference
                        buffer[j] = max(buffer[j], square) if maximum else buffer[j] + square
                elif maximum:
                    for j in range(width):
                        buffer[j] = max(buffer[j], (there[j] - here) ** 2)
                else:
                    for j in range(width):
                        buffer[j] += (there[j] - here) ** 2
            for j in range(width):
                histogram[min(max((bits[j] >> _SHIFT) - low + 1, 0), n_bins + 1)] += 1
            begin += width
    return histogram


def pair_counts(
    x: NDArray[np.float64],
    wrap: NDArray[np.float64],
    first: NDArray[np.int64],
    cuts: NDArray[np.int64],
    tasks: list[tuple[int, int]],
    *,
    maximum: bool,
    resolution: float,
    workers: int,
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]:
    """Count the pairs closer than each radius, for pairs of blocks of points.

    Parameters
    ----------
    x : array, shape (point, coordinate)
        Scaled so that the root mean square distance of two points is one; cyclic coordinates last.
    wrap : array
        Periods of the cyclic coordinates.
    first : array of int, shape (point,)
        First partner of each point.
    cuts : array of int, shape (block + 1,)
        Where the blocks begin and end.
    tasks : list of (int, int)
        The pairs of blocks.
    maximum : bool
        Maximum norm, else Euclidean.
    resolution : float
        Smallest radius.
    workers : int
        Threads.

    Returns
    -------
    radius : array, shape (radius,)
    inside : array of int, shape (task, radius)
        Pairs closer than each radius.
    pairs : array of int, shape (task,)
        All pairs.
    """
    lowest = int(np.floor(2 * np.log2(resolution)))
    bins = (_OCTAVES - lowest) * _SUB
    low_bits = int(np.float64(2.0**lowest).view(np.int64) >> _SHIFT)
    columns = np.ascontiguousarray(x.T)

    def count(task: tuple[int, int]) -> NDArray[np.int64]:
        a, b = ((int(cuts[k]), int(cuts[k + 1])) for k in task)
        return _count_pairs(columns, wrap, first, a, b, maximum, low_bits, bins)

    with ThreadPoolExecutor(workers) as pool:
        histograms = list(pool.map(count, tasks))
    edges = np.r_[np.arange(0, bins, _SUB)[:, None] + np.array(_PICK)].ravel()
    exponent, part = np.divmod(edges, _SUB)
    radius = np.sqrt(2.0 ** (exponent + lowest) * (1.0 + part / _SUB))
    inside = np.array([np.cumsum(h)[edges] for h in histograms])
    return radius, inside, np.array([h.sum() for h in histograms])
