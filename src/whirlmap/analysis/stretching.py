"""The scaling range of a curve of growing distances: where neighbours part exponentially, and how fast.

Shared by `rosenstein` and `kantz`, which differ in how they make the curve.
"""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

Array = NDArray[np.float64]

STATUS = ("ok", "no-scaling-range", "neighbours-coincide")
"""Meaning of ``status`` by value."""


def exponent_of(
    curves: Array,
    *,
    rate: float,
    window: int,
    tolerance: float,
    least_growth: float,
    least_steps: int,
) -> xr.Dataset:
    """Slope of the mean of several curves over their widest straight range.

    Parameters
    ----------
    curves : array, shape (block, step)
        Mean logarithmic distance after so many samples, of disjoint blocks of reference points.
    rate : float
        Samples per unit of time.
    window : int
        Steps over which a local slope is taken: about one swing of the motion, within which distances breathe.
    tolerance : float
        Largest departure of a local slope in the range from the fitted one, as a fraction of that.
    least_growth : float
        Growth over the range, in e-folds, below which nothing counts as a range.
    least_steps : int
        A range must be longer: more than the span of an embedded vector, for noise also parts while one component
        after the other is renewed.

    Returns
    -------
    xr.Dataset
        ``divergence(step)``, ``exponent`` [1/time], ``exponent_error``, ``range_begin`` and ``range_end`` [samples],
        ``growth`` (e-folds over the range), ``status``. Without a range the numbers are NaN and -1.

    Notes
    -----
    The widest range in e-folds wins. The error is the root of the squares of the standard error between the blocks and
    of half the difference of the slopes of its halves.
    """
    mean = curves.mean(axis=0)
    steps = np.arange(mean.size)
    window = min(max(window, 2), mean.size - 1)
    answer = {"exponent": np.nan, "exponent_error": np.nan, "growth": np.nan}
    ends = (-1, -1)
    status = "no-scaling-range"
    if not np.isfinite(mean).all():
        status = "neighbours-coincide"
    else:
        local = np.array([_slope(mean[k : k + window + 1]) for k in range(mean.size - window)])
        best = least_growth * (1 - 1e-12)
        for a in range(local.size):
            low = high = local[a]
            for b in range(a + window, mean.size):  # every local slope inside counts, short ranges too
                low, high = min(low, local[b - window]), max(high, local[b - window])
                if low <= 0 or high - low > 2 * tolerance * high:
                    break
                slope = _slope(mean[a : b + 1])
                grown = slope * (b - a)
                straight = high <= (1 + tolerance) * slope and low >= (1 - tolerance) * slope
                if b - a > least_steps and grown > best and straight:
                    best, ends, status = grown, (a, b), "ok"
        if status == "ok":
            a, b = ends
            each = np.array([_slope(c[a : b + 1]) for c in curves])
            middle = (a + b) // 2
            halves = abs(_slope(mean[a : middle + 1]) - _slope(mean[middle : b + 1])) / 2
            between = each.std(ddof=1) / np.sqrt(each.size)
            answer = {
                "exponent": _slope(mean[a : b + 1]) * rate,
                "exponent_error": float(np.hypot(between, halves)) * rate,
                "growth": best,
            }
    flags = {"flag_values": np.arange(len(STATUS), dtype=np.int8), "flag_meanings": " ".join(STATUS)}
    numbers = {
        "exponent": (answer["exponent"], "1/time", "largest Lyapunov exponent"),
        "exponent_error": (answer["exponent_error"], "1/time", "standard error of the exponent"),
        "growth": (answer["growth"], "1", "growth of distances over the range, e-folds"),
        "range_begin": (ends[0], "1", "first sample of the scaling range, -1: none"),
        "range_end": (ends[1], "1", "last sample of the scaling range, -1: none"),
    }
    ds = xr.Dataset(
        {name: ((), v, {"units": units, "long_name": meaning}) for name, (v, units, meaning) in numbers.items()},
        {"step": ("step", steps, {"units": "1", "long_name": "samples after the neighbours were found"})},
    )
    ds["divergence"] = ("step", mean, {"units": "1", "long_name": "mean logarithm of the distance of neighbours"})
    ds["status"] = ((), np.int8(STATUS.index(status)), {"units": "1", "long_name": "status of the exponent", **flags})
    ds.attrs = {"window": window, "tolerance": tolerance, "least_growth": least_growth, "rate": rate}
    ds.attrs["least_steps"] = least_steps
    return ds


def _slope(y: Array) -> float:
    """Least-squares slope per step."""
    x = np.arange(y.size) - (y.size - 1) / 2
    return float(x @ y / (x @ x))
