"""Pairs of points closer than each of many radii: the counts behind a correlation sum.

All pairs are counted exactly, in blocks of points, so that the counts do not depend on the number of threads.
"""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from whirlmap.kernels.running.loops import compiled

# Radii run down from the largest by eighths of an octave, 27 to a decade. The kernel sorts squared distances
# by the upper bits of their binary form (16 bins to an octave of r^2, no logarithm per pair), so the radii
# are those numbers 2^(e/2) sqrt(1 + j/16) which lie nearest to the even spacing: known exactly, even to 1 %.
_SUB = 16
_PICK = (0, 3, 7, 11)
_SHIFT = np.int64(48)  # 52 bits of mantissa less 4 bits for the 16 bins
_OCTAVES = 3  # of r^2 above the mean squared distance: nothing that is fitted lies there
_STRIP = 256  # points whose distances from one are computed together
_FLAGS = {"contract", "reassoc", "nsz", "arcp", "afn"}


@compiled(
    {
        "x": "doubles", "d": "int", "points": "int", "wrap": "doubles", "cyclic": "int", "first": "ints", "row": "int",
        "rows_end": "int", "column": "int", "columns_end": "int", "maximum": "int", "low": "int", "n_bins": "int",
        "buffer": "doubles", "bits": "ints", "histogram": "ints",
    },
    fastmath=_FLAGS,
)  # fmt: skip
def _count_pairs(
    x: NDArray[np.float64],
    d: int,
    points: int,
    wrap: NDArray[np.float64],
    cyclic: int,
    first: NDArray[np.int64],
    row: int,
    rows_end: int,
    column: int,
    columns_end: int,
    maximum: int,
    low: int,
    n_bins: int,
    buffer: NDArray[np.float64],
    bits: NDArray[np.int64],
    histogram: NDArray[np.int64],
) -> None:
    """Histogram of squared distances between points ``i`` from ``row`` on and ``j >= first[i]`` from ``column`` on.

    ``x`` has shape (coordinate, point), the cyclic coordinates last with their periods in ``wrap``. Bin 0
    holds all distances below the lowest edge, the last one all above the highest. ``buffer`` is room for `_STRIP`
    numbers, and ``bits`` the same room as integers.
    """
    n_plain = d - cyclic
    for i in range(row, rows_end):
        begin = max(column, first[i])
        while begin < columns_end:
            width = min(_STRIP, columns_end - begin)
            # One coordinate at a time over a strip of points: the compiler turns the inner loop into vector
            # code, which beats leaving early pair by pair even with 20 coordinates.
            for j in range(width):
                buffer[j] = 0.0
            for k in range(d):
                here, there = x[k * points + i], k * points + begin
                period = wrap[k - n_plain] if k >= n_plain else 0.0
                if period > 0.0:
                    for j in range(width):
                        difference = x[there + j] - here
                        difference -= period * np.rint(difference / period)
                        square = difference * difference
                        buffer[j] = max(buffer[j], square) if maximum else buffer[j] + square
                elif maximum:
                    for j in range(width):
                        buffer[j] = max(buffer[j], (x[there + j] - here) ** 2)
                else:
                    for j in range(width):
                        buffer[j] += (x[there + j] - here) ** 2
            for j in range(width):
                histogram[min(max((bits[j] >> _SHIFT) - low + 1, 0), n_bins + 1)] += 1
            begin += width


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
        (row, rows_end), (column, columns_end) = ((int(cuts[k]), int(cuts[k + 1])) for k in task)
        buffer, histogram = np.empty(_STRIP), np.zeros(bins + 2, np.int64)
        _count_pairs(
            x=columns, d=columns.shape[0], points=columns.shape[1], wrap=wrap, cyclic=wrap.size, first=first, row=row,
            rows_end=rows_end, column=column, columns_end=columns_end, maximum=int(maximum), low=low_bits, n_bins=bins,
            buffer=buffer, bits=buffer.view(np.int64), histogram=histogram,
        )  # fmt: skip
        return histogram

    with ThreadPoolExecutor(workers) as pool:
        histograms = list(pool.map(count, tasks))
    edges = np.r_[np.arange(0, bins, _SUB)[:, None] + np.array(_PICK)].ravel()
    exponent, part = np.divmod(edges, _SUB)
    radius = np.sqrt(2.0 ** (exponent + lowest) * (1.0 + part / _SUB))
    inside = np.array([np.cumsum(h)[edges] for h in histograms])
    return radius, inside, np.array([h.sum() for h in histograms])
