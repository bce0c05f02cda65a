"""Scaling range and slope of a divergence curve: where the distance of neighbours grows exponentially, and at which rate.

Shared by `rosenstein` and `kantz`, which differ in how they compute the curve.
"""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

Array = NDArray[np.float64]

STATUS = ("ok", "no-scaling-range", "neighbours-coincide")
"""Meaning of ``status`` by value."""
#: Share of the pairs that may be far apart in the range: what has reached the attractor's size grows no more, so that the
#: slope is low by about this share.
MOST_FAR = 0.15


def exponent_of(
    curves: Array, far: Array, *, rate: float, tolerance: float, least_growth: float, least_steps: int
) -> xr.Dataset:
    """Slope of the mean of several curves over their widest straight range.

    Parameters
    ----------
    curves : array, shape (block, step)
        Mean logarithmic distance after so many samples, of disjoint blocks of reference points.
    far : array, shape (step,)
        Share of the pairs that are farther apart than a fifth of two random points of the attractor.
    rate : float
        Samples per unit of time.
    tolerance : float
        Largest departure of the slopes of the three thirds of the range from that of the whole, as a fraction of it.
    least_growth : float
        Growth over the range, in e-folds, below which nothing counts as a range.
    least_steps : int
        A range must be longer: more than the span of an embedded vector, for smooth noise also parts while that is renewed.

    Returns
    -------
    xr.Dataset
        ``divergence(step)``, ``far_share(step)``, ``exponent`` [1/time], ``exponent_error``, ``range_begin`` and
        ``range_end`` [samples], ``growth`` (e-folds over the range), ``status``. Without a range the numbers are NaN and -1.

    Notes
    -----
    The range ends before `MOST_FAR` of the pairs are far apart. Of the straight ranges that are left the one with the most
    growth wins. The error is the root of the sum of squares of the standard error between the blocks, the spread of
    the slopes of the thirds (neighbours turn into the growing direction at one end and feel the size at the other, which is
    no scatter), and the slope times the mean share of far pairs.
    """
    mean = curves.mean(axis=0)
    steps = np.arange(mean.size)
    answer = {"exponent": np.nan, "exponent_error": np.nan, "growth": np.nan}
    ends = (-1, -1)
    status = "no-scaling-range"
    if not np.isfinite(mean).all():
        status = "neighbours-coincide"
    else:
        last = int(np.argmax(far > MOST_FAR)) if (far > MOST_FAR).any() else mean.size
        begin, end = np.triu_indices(last, k=6)  # thirds of three points at least
        slope = _slopes(mean, begin, end)
        thirds = _thirds(mean, begin, end)
        growth = slope * (end - begin)
        straight = (np.abs(thirds - slope) <= tolerance * slope).all(axis=0)
        straight &= (growth >= least_growth) & (end - begin > least_steps)
        if straight.any():
            best = int(np.argmax(np.where(straight, growth, -np.inf)))
            a, b = ends = (int(begin[best]), int(end[best]))
            status = "ok"
            each = np.array([_slopes(c, begin[[best]], end[[best]])[0] for c in curves])
            between = each.std(ddof=1) / np.sqrt(each.size)
            uneven = np.ptp(thirds[:, best])
            lost = slope[best] * far[a : b + 1].mean()
            answer = {
                "exponent": slope[best] * rate,
                "exponent_error": float(np.sqrt(between**2 + uneven**2 + lost**2)) * rate,
                "growth": growth[best],
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
    ds["far_share"] = ("step", far, {"units": "1", "long_name": "share of the pairs that feel the attractor's size"})
    ds["status"] = ((), np.int8(STATUS.index(status)), {"units": "1", "long_name": "status of the exponent", **flags})
    ds.attrs = {"tolerance": tolerance, "least_growth": least_growth, "least_steps": least_steps, "rate": rate}
    return ds


def _slopes(y: Array, begin: NDArray[np.intp], end: NDArray[np.intp]) -> Array:
    """Least-squares slopes per step of ``y[begin : end + 1]``, of many ranges at once, from running sums."""
    n = np.arange(y.size, dtype=np.float64)
    sums, moments = (np.r_[0.0, np.cumsum(v)] for v in (y - y.mean(), n * (y - y.mean())))
    count = end - begin + 1
    middle = (begin + end) / 2
    return np.asarray(
        (moments[end + 1] - moments[begin] - middle * (sums[end + 1] - sums[begin])) / (count * (count**2 - 1.0) / 12)
    )


def _thirds(y: Array, begin: NDArray[np.intp], end: NDArray[np.intp]) -> Array:
    """Slopes of the three thirds of every range, shape (3, range)."""
    first, second = begin + (end - begin) // 3, end - (end - begin) // 3
    return np.stack([_slopes(y, a, b) for a, b in ((begin, first), (first, second), (second, end))])
