"""Largest Lyapunov exponent of a recorded signal from the parting of whole neighbourhoods."""

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree

from whirlmap.analysis.embedding import delay_embedding
from whirlmap.analysis.stretching import STATUS, exponent_of
from whirlmap.errors import RangeError


def kantz_exponent(
    series: ArrayLike,
    *,
    dimension: int,
    lag: int,
    theiler: int,
    steps: int,
    rate: float = 1.0,
    radii: int = 5,
    least_neighbours: int = 5,
    references: int = 1000,
    window: int = 3,
    tolerance: float = 0.15,
    least_growth: float = 1.2,
    blocks: int = 8,
) -> xr.Dataset:
    """Largest exponent from the mean distance within neighbourhoods of several sizes.

    Parameters
    ----------
    series, dimension, lag, theiler, steps, rate, window, tolerance, least_growth, blocks
        As in `rosenstein_exponent`.
    radii : int
        Neighbourhood sizes tried: from the smallest in which half of the reference points have enough neighbours,
        upwards by factors of sqrt(2).
    least_neighbours : int
        Reference points with fewer neighbours are left out.
    references : int
        Reference points, evenly spaced.

    Returns
    -------
    xr.Dataset
        As `stretching.exponent_of`, of the radius whose range grows by most, if most of the radii have one;
        ``exponent_error`` also holds half the spread of the exponent between radii with a range. ``radius``, and
        ``radius_exponent(radius_tried)``, NaN where that radius has no range.

    Raises
    ------
    RangeError
        As in `rosenstein_exponent`.

    Notes
    -----
    [kantz1994]: S(n) = mean over reference points of ln(mean over neighbours of |x_{i+n} - x_{j+n}|), with the scalar
    distance of the last component, which has forgotten the embedding. Averaging over neighbourhoods before the
    logarithm damps noise that a single nearest neighbour follows.
    """
    x = np.asarray(series, dtype=np.float64)
    if x.ndim != 1 or not np.isfinite(x).all() or np.ptp(x) == 0:
        raise RangeError(f"series has shape {x.shape}: one series of finite numbers that vary is needed.")
    if min(dimension, lag, theiler, steps, radii, least_neighbours) < 1 or blocks < 2:
        raise RangeError(f"dimension = {dimension}, lag = {lag}, theiler = {theiler}, steps = {steps}: at least 1 each.")
    points = delay_embedding(x, dimension=dimension, lag=lag)
    usable = len(points) - steps
    if usable < max(100, 4 * theiler, 10 * blocks):
        raise RangeError(f"{x.size} samples leave {usable} vectors to follow for {steps} samples: too few.")
    last = x[(dimension - 1) * lag :]  # the newest component of each vector
    tree = cKDTree(points[:usable])
    at = np.unique(np.linspace(0, usable - 1, min(references, usable)).astype(int))
    radius = _first_radius(tree, points, at, theiler, least_neighbours)
    fit = {"rate": rate, "window": window, "tolerance": tolerance, "least_growth": least_growth}
    tried, found = [], []
    for k in range(radii):
        size = radius * 2.0 ** (k / 2)
        curves = _curves(tree, points, last, at, size, theiler, steps, least_neighbours, blocks, usable)
        tried.append(size)
        found.append(exponent_of(curves, least_steps=dimension * lag, **fit))  # type: ignore[arg-type]
    each = np.array([float(f["exponent"]) for f in found])
    good = np.isfinite(each)
    best = int(np.nanargmax([float(f["growth"]) for f in found])) if good.any() else 0
    ds = found[best]
    if good.sum() > 1:
        ds["exponent_error"] = (
            (), float(np.hypot(ds["exponent_error"], np.ptp(each[good]) / 2)), ds["exponent_error"].attrs
        )  # fmt: skip
    if good.sum() <= radii // 2:  # what only some radii show is no scaling
        for name in ("exponent", "exponent_error", "growth"):
            ds[name] = ((), np.nan, ds[name].attrs)
        ds["status"] = ((), np.int8(STATUS.index("no-scaling-range")), ds["status"].attrs)
    ds["radius"] = ((), tried[best], {"units": "1", "long_name": "size of the neighbourhoods"})
    ds["radius_exponent"] = ("radius_tried", each, {"units": "1/time", "long_name": "exponent at each radius"})
    ds = ds.assign_coords(radius_tried=("radius_tried", tried, {"units": "1", "long_name": "size of the neighbourhoods"}))
    ds.attrs |= {"algorithm": "kantz1994", "dimension": dimension, "lag": lag, "theiler": theiler}
    return ds


def _first_radius(tree: cKDTree, points: np.ndarray, at: np.ndarray, theiler: int, least: int) -> float:
    """Median distance to the neighbour that makes a neighbourhood large enough, those in time not counted."""
    some = at[:: max(at.size // 500, 1)]
    k = min(least + 2 * theiler + 1, tree.n)
    distance, index = tree.query(points[some], k=k)
    far = np.abs(index - some[:, None]) >= theiler
    enough = np.cumsum(far, axis=1) >= least
    reached = enough.any(axis=1)
    radius = float(np.median(distance[reached, enough[reached].argmax(axis=1)])) if reached.any() else 0.0
    return max(radius, 1e-12 * float(np.abs(points).max()))


def _curves(
    tree: cKDTree, points: np.ndarray, last: np.ndarray, at: np.ndarray, radius: float, theiler: int, steps: int,
    least: int, blocks: int, usable: int,
) -> np.ndarray:  # fmt: skip
    total, count = np.zeros((blocks, steps + 1)), np.zeros((blocks, 1))
    span = np.arange(steps + 1)
    for i, near in zip(at, tree.query_ball_point(points[at], radius), strict=True):
        j = np.asarray(near)
        j = j[np.abs(j - i) >= theiler]
        if j.size < least:
            continue
        j = j[:: max(j.size // 50, 1)]  # fifty neighbours give the mean
        distance = np.abs(last[i + span] - last[j[:, None] + span]).mean(axis=0)
        if (distance > 1e-13).all():
            block = min(i * blocks // usable, blocks - 1)
            total[block] += np.log(distance)
            count[block] += 1
    with np.errstate(invalid="ignore"):
        curves = total / count
    return curves if (count >= 5).all() else np.full_like(curves, np.nan)
