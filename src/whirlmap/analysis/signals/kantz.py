"""Largest Lyapunov exponent of a recorded signal from the divergence of neighbourhoods (Kantz)."""

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from whirlmap.analysis.signals.divergence_slope import STATUS, exponent_of
from whirlmap.analysis.signals.neighbour_divergence import FAR, checked, follow, mean_logarithms, near_passes
from whirlmap.errors import RangeError


def kantz_exponent(
    series: ArrayLike,
    *,
    dimension: int,
    lag: int,
    theiler: int,
    steps: int,
    flow: bool,
    rate: float = 1.0,
    least_distance: float = 0.0,
    neighbours: tuple[int, ...] = (4, 6, 8, 12, 16),
    references: int = 1000,
    tolerance: float = 0.15,
    least_growth: float = 1.0,
    blocks: int = 8,
) -> xr.Dataset:
    """Largest exponent from the mean distance within neighbourhoods of several sizes.

    Parameters
    ----------
    series, dimension, lag, theiler, steps, flow, rate, least_distance, references, tolerance, least_growth, blocks
        As in `rosenstein_exponent`.
    neighbours : tuple of int
        Neighbourhood sizes tried: so many nearest neighbours of every reference point.

    Returns
    -------
    xr.Dataset
        As `divergence_slope.exponent_of`, of the neighbourhood size whose range grows by most, if most of the sizes have
        one; ``exponent_error`` also holds half the spread of the exponent between sizes with a range.

    Raises
    ------
    RangeError
        As in `rosenstein_exponent`.

    Notes
    -----
    [kantz1994] averages over the neighbours of each reference point, so that noise of one pair counts less, and looks at
    several sizes of neighbourhoods, which must agree. Three things differ from it, each because it biased the exponent:
    neighbourhoods hold a number of neighbours instead of a radius, for only dense places have enough within a radius, and
    their references are no average over the attractor (Lorenz: slopes from 0.25 to 2.2 of the exponent); distances are of
    the vectors across the flow (`neighbour_divergence`); and the mean over neighbours is that of logarithms, for a mean
    distance follows the few pairs that have parted most (10 to 30 % too high).
    """
    x = checked(series)
    if not neighbours or min(neighbours) < 1 or blocks < 2:
        raise RangeError(f"neighbours = {neighbours}, blocks = {blocks}: at least one neighbour, and 2 blocks.")
    most = max(neighbours)
    embedded: dict[str, Any] = {"dimension": dimension, "lag": lag, "theiler": theiler, "steps": steps, "flow": flow}
    near = near_passes(x, references=references, wanted=most, least=least_distance, **embedded)
    whole = np.isfinite(near.distance[:, -1])
    own, other = np.repeat(near.own[whole], most), near.other[whole].ravel()
    distance = follow(x, own, other, **embedded).reshape(-1, most, steps + 1)
    found = []
    fit: dict[str, Any] = {"tolerance": tolerance, "least_growth": least_growth, "least_steps": (dimension - 1) * lag}
    for count in neighbours:
        pairs = distance[:, :count].reshape(-1, steps + 1)
        far = (pairs > FAR * near.size).mean(axis=0) if pairs.size else np.ones(steps + 1)
        curves = mean_logarithms(pairs, blocks)
        found.append(exponent_of(curves, far, rate=rate, **fit))
    each = np.array([float(f["exponent"]) for f in found])
    good = np.isfinite(each)
    best = int(np.nanargmax([float(f["growth"]) for f in found])) if good.any() else 0
    ds = found[best]
    if good.sum() > 1:
        ds["exponent_error"] = (
            (), float(np.hypot(ds["exponent_error"], np.ptp(each[good]) / 2)), ds["exponent_error"].attrs
        )  # fmt: skip
    if good.sum() <= len(found) // 2:  # what only some radii show is no scaling
        for name in ("exponent", "exponent_error", "growth"):
            ds[name] = ((), np.nan, ds[name].attrs)
        ds["status"] = ((), np.int8(STATUS.index("no-scaling-range")), ds["status"].attrs)
    ds.attrs |= {"algorithm": "kantz1994", "dimension": dimension, "lag": lag, "theiler": theiler}
    return ds
