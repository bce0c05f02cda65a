"""Limits of axes that show a point as a point, and the cells of swept values.

A settled period-1 orbit has section points that differ by 1e-11. On axes scaled to that range they look like
a line or a cloud; here no axis is shorter than a share of the peak-to-peak of the motion.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

#: Shortest axis over the range of the whole orbit, the largest magnitude, and the largest of all states.
OF_AMPLITUDE, OF_MAGNITUDE, OF_OTHERS = 0.05, 1e-3, 1e-6


def limits(values: ArrayLike, *, amplitude: float = 0.0, others: float = 0.0, margin: float = 0.05) -> tuple[float, float]:
    """Lower and upper end of an axis that shows values.

    Parameters
    ----------
    values : array_like
        What is shown; numbers that are not finite are left out.
    amplitude : float
        Peak-to-peak range of the whole motion, of which the values may be a section.
    others : float
        Largest magnitude of all states, for one that is constant but for rounding.
    margin : float
        Room on either side, over the range.
    """
    v = np.asarray(values, dtype=float)
    v = v[np.isfinite(v)]
    if v.size == 0:
        return -1.0, 1.0
    low, high = float(v.min()), float(v.max())
    least = max(OF_AMPLITUDE * amplitude, OF_MAGNITUDE * max(abs(low), abs(high)), OF_OTHERS * others)
    size = max(high - low, least if least > 0 else 1.0)
    middle, half = (low + high) / 2, size * (0.5 + margin)
    return middle - half, middle + half


def markersize(u: Array, v: Array, size: tuple[float, float], *, most: float = 5.0, least: float = 0.9) -> float:
    """Size of points [pt] by the number of places they fall on: the few of a periodic orbit are drawn large.

    ``size`` is the width and the height of what the points are seen in.
    """
    grid = np.stack([u / max(size[0], 1e-300), v / max(size[1], 1e-300)], axis=1)
    places = len(np.unique(np.rint(300 * (grid - grid[:1])), axis=0)) if u.size else 1
    return float(np.clip(40.0 / np.sqrt(places), least, most))


def is_log(values: ArrayLike) -> bool:
    """Whether swept values are spaced by a constant factor, over at least half a decade."""
    v = np.asarray(values, dtype=float)
    if v.size < 3 or v[0] <= 0 or v[-1] / v[0] < 3:
        return False
    steps = np.diff(np.log(v))
    return bool(np.allclose(steps, steps[0], rtol=1e-3))


def cell_edges(values: ArrayLike, *, log: bool = False) -> Array:
    """Edges of the cells that the swept values stand for: half-way between neighbours."""
    v = np.asarray(values, dtype=float)
    v = np.log(v) if log else v
    if v.size == 1:
        half = 0.5 if log or v[0] == 0 else 0.01 * abs(v[0])
        edges = np.array([v[0] - half, v[0] + half])
    else:
        middle = (v[1:] + v[:-1]) / 2
        edges = np.concatenate([[2 * v[0] - middle[0]], middle, [2 * v[-1] - middle[-1]]])
    return np.exp(edges) if log else edges


def runs(keys: list[object]) -> list[tuple[int, int]]:
    """First and last index (inclusive) of each run of equal neighbours."""
    out: list[tuple[int, int]] = []
    for i, key in enumerate(keys):
        if out and keys[i - 1] == key:
            out[-1] = (out[-1][0], i)
        else:
            out.append((i, i))
    return out
