"""Delay embedding of a scalar series: its lag, its dimension, and the embedded points.

All three functions take one series or many pieces of one attractor's series side by side, (time, lane);
pieces are never joined.
"""

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from whirlmap.errors import RangeError

LAG_STATUS = ("ok", "no-minimum", "constant")
"""Meaning of ``status`` of ``mutual_information`` by value."""
NEIGHBOUR_STATUS = ("ok", "no-dimension", "constant")
"""Meaning of ``status`` of ``false_neighbours`` by value."""


def mutual_information(series: ArrayLike, max_lag: int, *, bins: int = 16) -> xr.Dataset:
    """Mutual information between a series and itself some samples later, and its first minimum.

    Parameters
    ----------
    series : array, shape (time,) or (time, lane)
        Evenly spaced samples; lanes are pooled.
    max_lag : int
        Largest lag [samples].
    bins : int
        Bins along each axis of the histogram.

    Returns
    -------
    xr.Dataset
        ``mutual_information(lag)`` [bit], lags 0 to ``max_lag``; ``bias`` [bit], what independent values
        would show; ``first_minimum`` [samples], 0 unless ``status`` is ``ok``.

    Raises
    ------
    RangeError
        Too few samples for the bins (16 per cell are wanted) or the lag, or numbers that are not finite.

    Notes
    -----
    Fraser and Swinney (1986) with a fixed partition into bins of equal occupation (ranks) instead of their
    adaptive one: this makes the answer the same for any monotonic change of the series, and equal values are
    kept together. The estimate for independent values is (bins - 1)^2 / (2 n) nat rather than 0 and scatters
    by (bins - 1) / (sqrt(2) n) nat; the first minimum is the lowest value up to a lag, after which the curve
    climbs by more than three such scatters and one percent of the value at lag 0 before falling lower. A
    curve that falls to its end has none: ``no-minimum``, as for a map, where the lag is 1.

    References
    ----------
    Fraser and Swinney, Phys. Rev. A 33 (1986) 1134.
    """
    x = _checked(series)
    if bins < 2 or not 1 <= max_lag < x.shape[0]:
        raise RangeError(
            f"bins = {bins}, max_lag = {max_lag}: at least 2 bins and lags 1 to {x.shape[0] - 1}."
        )
    n = (x.shape[0] - max_lag) * x.shape[1]
    if n < 16 * bins**2:
        raise RangeError(
            f"{n} pairs for {bins}^2 cells: at least {16 * bins**2} are needed; lower bins or max_lag."
        )
    quantiles = np.quantile(x, np.arange(1, bins) / bins)
    symbol = np.searchsorted(quantiles, x, side="right")
    information = np.empty(max_lag + 1)
    for lag in range(max_lag + 1):
        # The same number of pairs at every lag, so that the bias is the same and cannot shape the curve.
        early, late = symbol[: x.shape[0] - max_lag], symbol[lag : lag + x.shape[0] - max_lag]
        joint = np.bincount((early * bins + late).ravel(), minlength=bins * bins).reshape(bins, bins) / n
        product = joint.sum(axis=1)[:, None] * joint.sum(axis=0)
        some = joint > 0
        information[lag] = np.sum(joint[some] * np.log2(joint[some] / product[some]))
    bias = (bins - 1) ** 2 / (2 * n) / np.log(2)
    rise = max(3 * (bins - 1) / (np.sqrt(2) * n) / np.log(2), 0.01 * information[0])
    minimum, status = 0, LAG_STATUS.index("constant" if information[0] == 0 else "no-minimum")
    lowest = 0
    for lag in range(1, max_lag + 1):
        if information[lag] < information[lowest]:
            lowest = lag
        elif lowest > 0 and information[lag] > information[lowest] + rise:
            minimum, status = lowest, LAG_STATUS.index("ok")
            break
    result = xr.Dataset(
        {
            "mutual_information": ("lag", information, {"units": "bit", "long_name": "mutual information"}),
            "bias": (
                (),
                bias,
                {"units": "bit", "long_name": "mutual information that independent values show"},
            ),
            "first_minimum": ((), minimum, {"units": "1", "long_name": "lag of the first minimum (0: none)"}),
            "status": ((), np.int8(status), _flags("status of the first minimum", LAG_STATUS)),
        },
        {"lag": ("lag", np.arange(max_lag + 1), {"units": "1", "long_name": "lag in samples"})},
    )
    result.attrs = {
        "bins": bins,
        "pairs": n,
        "algorithm": "Fraser and Swinney 1986, bins of equal occupation",
    }
    return result


def delay_embedding(series: ArrayLike, *, dimension: int, lag: int) -> NDArray[np.float64]:
    """Vectors (x(t), x(t + lag), ..., x(t + (dimension - 1) lag)).

    Parameters
    ----------
    series : array, shape (time,) or (time, lane)
        Evenly spaced samples.
    dimension : int
        Length of the vectors.
    lag : int
        Samples between two components.

    Returns
    -------
    array, shape (time - (dimension - 1) * lag, dimension) or (..., lane, dimension)
        In the order of time. For ``correlation_dimension`` pool the lanes: ``points.reshape(-1, dimension)``
        with ``trajectories=np.tile(np.arange(lanes), len(points))``.

    Raises
    ------
    RangeError
        The series is too short, or an option is not positive.
    """
    x = np.asarray(series, dtype=np.float64)
    if x.ndim not in (1, 2):
        raise RangeError(f"series has shape {x.shape}: (time,) or (time, lane) is needed.")
    if dimension < 1 or lag < 1 or x.shape[0] <= (dimension - 1) * lag:
        raise RangeError(f"dimension = {dimension}, lag = {lag}: positive, and to fit {x.shape[0]} samples.")
    length = x.shape[0] - (dimension - 1) * lag
    return np.stack([x[k * lag : k * lag + length] for k in range(dimension)], axis=-1)


def false_neighbours(
    series: ArrayLike,
    *,
    lag: int,
    most: int = 10,
    theiler: int = 1,
    ratio: float = 15.0,
    size: float = 2.0,
    enough: float = 0.01,
) -> xr.Dataset:
    """Share of nearest neighbours that part when the embedding gains a dimension, and the dimension to use.

    Parameters
    ----------
    series : array, shape (time,) or (time, lane)
        Evenly spaced samples; lanes are pooled.
    lag : int
        Samples between two components.
    most : int
        Largest dimension tried.
    theiler : int
        Points less than this number of samples apart on the same lane are no neighbours.
    ratio, size : float
        The two thresholds of Kennel: a neighbour is false if the new component parts them by more than
        ``ratio`` times their distance, or puts them further apart than ``size`` standard deviations of the
        series.
    enough : float
        The dimension is the first whose share is below this.

    Returns
    -------
    xr.Dataset
        ``fraction(dimension)``, ``dimension_found`` (0 unless ``status`` is ``ok``), ``status``. Noise shows
        ``no-dimension``: the ``size`` test sees that its neighbours are nowhere near.

    Raises
    ------
    RangeError
        Too few samples, or numbers that are not finite.

    Notes
    -----
    Kennel, Brown and Abarbanel (1992). Distances smaller than 1e-10 standard deviations count as that, or the
    rounding errors of a periodic motion, whose neighbours coincide, would part. Neighbours in Euclidean
    distance by k-d tree.

    References
    ----------
    Kennel, Brown and Abarbanel, Phys. Rev. A 45 (1992) 3403.
    """
    x = _checked(series)
    if min(lag, most, theiler) < 1:
        raise RangeError(f"lag = {lag}, most = {most}, theiler = {theiler}: at least 1 each.")
    length = x.shape[0] - most * lag
    if length * x.shape[1] < 100 or length <= 2 * theiler:
        raise RangeError(
            f"{x.shape[0]} samples leave {length} vectors: 100, and more than twice theiler, are needed."
        )
    deviation = float(x.std())
    fraction = np.zeros(most)
    status, found = NEIGHBOUR_STATUS.index("constant" if deviation == 0 else "no-dimension"), 0
    time, lane = (v.ravel() for v in np.indices((length, x.shape[1])))
    for m in range(1, most + 1) if deviation > 0 else ():
        points = delay_embedding(x, dimension=m, lag=lag)[:length].reshape(-1, m)
        component = x[m * lag : m * lag + length].ravel()
        distance, neighbour = _nearest(points, time, lane, theiler)
        parted = np.abs(component - component[neighbour])
        near = np.maximum(distance, 1e-10 * deviation)
        fraction[m - 1] = np.mean((parted > ratio * near) | (np.hypot(distance, parted) > size * deviation))
        if fraction[m - 1] < enough and found == 0:
            found, status = m, NEIGHBOUR_STATUS.index("ok")
    result = xr.Dataset(
        {
            "fraction": (
                "dimension",
                fraction,
                {"units": "1", "long_name": "share of false nearest neighbours"},
            ),
            "dimension_found": ((), found, {"units": "1", "long_name": "embedding dimension (0: none)"}),
            "status": ((), np.int8(status), _flags("status of the embedding dimension", NEIGHBOUR_STATUS)),
        },
        {
            "dimension": (
                "dimension",
                np.arange(1, most + 1),
                {"units": "1", "long_name": "embedding dimension"},
            )
        },
    )
    result.attrs = {"lag": lag, "theiler": theiler, "ratio": ratio, "size": size, "enough": enough}
    return result


def _nearest(
    points: NDArray[np.float64], time: NDArray[np.int64], lane: NDArray[np.int64], theiler: int
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Distance and index of each point's nearest neighbour outside its Theiler window."""
    tree = cKDTree(points)
    distance, neighbour = np.empty(len(points)), np.empty(len(points), np.int64)
    left, k = np.arange(len(points)), 4
    while left.size:
        k = min(k, len(points))
        d, index = tree.query(points[left], k=k)
        far = (lane[index] != lane[left, None]) | (np.abs(time[index] - time[left, None]) >= theiler)
        far &= index != left[:, None]
        first, some = far.argmax(axis=1), far.any(axis=1)
        distance[left[some]], neighbour[left[some]] = d[some, first[some]], index[some, first[some]]
        left = left[~some]
        k *= 4  # ends: the window holds fewer points than there are, which false_neighbours has checked
    return distance, neighbour


def _checked(series: ArrayLike) -> NDArray[np.float64]:
    """Give the series as (time, lane), or a RangeError."""
    x = np.asarray(series, dtype=np.float64)
    if x.ndim == 1:
        x = x[:, None]
    if x.ndim != 2 or 0 in x.shape:
        raise RangeError(f"series has shape {x.shape}: (time,) or (time, lane) is needed.")
    if not np.isfinite(x).all():
        raise RangeError("the series holds numbers that are not finite: leave out points that diverged.")
    return x


def _flags(long_name: str, meanings: tuple[str, ...]) -> dict[str, Any]:
    """CF attributes of an integer flag."""
    values = np.arange(len(meanings), dtype=np.int8)
    return {"units": "1", "long_name": long_name, "flag_values": values, "flag_meanings": " ".join(meanings)}
