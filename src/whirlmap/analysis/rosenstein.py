"""Largest Lyapunov exponent of a recorded signal from the parting of nearest neighbours."""

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree

from whirlmap.analysis.embedding import delay_embedding
from whirlmap.analysis.stretching import exponent_of
from whirlmap.errors import RangeError


def rosenstein_exponent(
    series: ArrayLike,
    *,
    dimension: int,
    lag: int,
    theiler: int,
    steps: int,
    rate: float = 1.0,
    window: int = 3,
    tolerance: float = 0.15,
    least_growth: float = 1.2,
    blocks: int = 8,
) -> xr.Dataset:
    """Largest exponent from the mean logarithm of the distance between nearest neighbours.

    Parameters
    ----------
    series : array, shape (time,)
        Evenly spaced samples.
    dimension, lag : int
        Delay embedding.
    theiler : int
        Neighbours less than this number of samples apart do not count; one mean period of a flow, at least.
    steps : int
        Samples over which neighbours are followed.
    rate : float
        Samples per unit of time.
    window, tolerance, least_growth
        Of the scaling range, as in `stretching.exponent_of`.
    blocks : int
        Parts of the series whose scatter gives the error.

    Returns
    -------
    xr.Dataset
        ``exponent``, ``exponent_error``, ``divergence(step)`` and ``status``, as `stretching.exponent_of` says. Where there
        is no straight range of growth the answer is ``no-scaling-range``: regular motion, or noise.

    Raises
    ------
    RangeError
        The series is too short, not finite or constant; or an option is out of range.

    Notes
    -----
    [rosenstein1993]: each vector's one nearest neighbour outside the Theiler window, the Euclidean distance of the
    vectors averaged in the logarithm. Pairs that coincide exactly are left out; where most do (a cycle without noise)
    the status is ``neighbours-coincide``. Limits: noise above the small scales hides the range; the growth saturates at
    the size of the attractor, so that few points (below 10^dimension) leave no range.
    """
    x = np.asarray(series, dtype=np.float64)
    if x.ndim != 1 or not np.isfinite(x).all() or np.ptp(x) == 0:
        raise RangeError(f"series has shape {x.shape}: one series of finite numbers that vary is needed.")
    if min(dimension, lag, theiler, steps) < 1 or blocks < 2:
        raise RangeError(f"dimension = {dimension}, lag = {lag}, theiler = {theiler}, steps = {steps}: at least 1 each.")
    points = delay_embedding(x, dimension=dimension, lag=lag)
    usable = len(points) - steps
    if usable < max(100, 4 * theiler, 10 * blocks):
        raise RangeError(f"{x.size} samples leave {usable} vectors to follow for {steps} samples: too few.")
    neighbour = _nearest(points[:usable], theiler)
    own = np.flatnonzero(neighbour >= 0)
    first = np.linalg.norm(points[own] - points[neighbour[own]], axis=1)
    own = own[first > 1e-12 * np.abs(x).max()]  # rounding of a cycle parts by chance
    curves = np.full((blocks, steps + 1), np.nan)
    if own.size >= max(usable // 4, blocks):
        part = np.minimum(own * blocks // usable, blocks - 1)
        for k in range(steps + 1):
            distance = np.linalg.norm(points[own + k] - points[neighbour[own] + k], axis=1)
            some = distance > 0
            count = np.bincount(part[some], minlength=blocks)
            total = np.bincount(part[some], weights=np.log(distance[some]), minlength=blocks)
            curves[:, k] = np.divide(total, count, out=np.full(blocks, np.nan), where=count > 0)
    ds = exponent_of(
        curves, rate=rate, window=window, tolerance=tolerance, least_growth=least_growth, least_steps=dimension * lag
    )
    ds.attrs |= {"algorithm": "rosenstein1993", "dimension": dimension, "lag": lag, "theiler": theiler}
    return ds


def _nearest(points: np.ndarray, theiler: int) -> np.ndarray:
    """Index of each point's nearest neighbour outside its Theiler window, -1 where the search found none."""
    tree = cKDTree(points)
    found = np.full(len(points), -1)
    left, k = np.arange(len(points)), 4
    while left.size:
        k = min(k, len(points))
        _, index = tree.query(points[left], k=k)
        far = np.abs(index - left[:, None]) >= theiler
        hit = far.any(axis=1)
        found[left[hit]] = index[hit, far[hit].argmax(axis=1)]
        left = left[~hit] if k < len(points) else left[:0]
        k *= 4
    return found
