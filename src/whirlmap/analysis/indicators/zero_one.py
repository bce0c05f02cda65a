"""The 0-1 test for chaos: a signal drives a walk in a rotating frame, which diffuses for chaos and is bounded otherwise."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from whirlmap.errors import RangeError
from whirlmap.kernels.running.loops import compiled
from whirlmap.results.findings import Findings, gives_dataset

Array = NDArray[np.float64]

STATUS = ("ok", "oversampled", "constant", "not-finite")
"""Meaning of ``status`` by value."""

#: Mean square of successive differences over the variance, below which a series counts as oversampled: a sine has
#: this at 20 samples per period, and a chaotic flow sampled like that shows K near 0 although it is chaotic.
OVERSAMPLED = 0.1


#: Lags at which the displacement is taken, evenly spaced: more do not change its correlation with them.
LAGS = 25


@compiled(
    {
        "series": "doubles", "lanes": "int", "n": "int", "angles": "doubles", "turns": "int", "lags": "ints", "count": "int",
        "p": "doubles", "q": "doubles", "out": "doubles",
    },
    fastmath={"contract", "reassoc", "nsz"},
)  # fmt: skip
def _displacements(
    series: Array, lanes: int, n: int, angles: Array, turns: int, lags: NDArray[np.int64], count: int, p: Array, q: Array,
    out: Array,
) -> None:  # fmt: skip
    """Mean square displacement of the walk of each series, shape (lane, time), and angle; ``out``: (lane, angle, lag).

    ``p`` and ``q`` are room for one walk.
    """
    used = n - lags[count - 1]
    for lane in range(lanes):
        for a in range(turns):
            turn_x, turn_y = np.cos(angles[a]), np.sin(angles[a])
            x = y = 0.0
            c, s = turn_x, turn_y
            for i in range(n):
                x += series[lane * n + i] * c
                y += series[lane * n + i] * s
                p[i], q[i] = x, y
                c, s = c * turn_x - s * turn_y, c * turn_y + s * turn_x
            for k in range(count):
                lag = lags[k]
                total = 0.0
                for i in range(used):
                    total += (p[i + lag] - p[i]) ** 2 + (q[i + lag] - q[i]) ** 2
                out[(lane * turns + a) * count + k] = total / used


@gives_dataset
def zero_one_test(
    series: ArrayLike, *, angles: int = 100, damping: float = 0.0, longest: float = 0.1, seed: int = 2009
) -> Findings:
    """Asymptotic growth rate K of the 0-1 test: near 1 for chaos, near 0 for regular motion.

    Parameters
    ----------
    series : array, shape (time,) or (time, lane)
        Successive values of one observable: section points, iterates of a map, or a flow sampled so coarsely that
        neighbours in time are not alike. Settled.
    angles : int
        Number of random angles c of the rotating frame, from (pi/5, 4 pi/5), the same for all lanes.
    damping : float
        Weight of the damping term; 0 for clean section points, about 1 for measured signals. It hides bounded
        oscillation and weak noise, at the price of needing longer series to see weak chaos.
    longest : float
        Largest lag used, as a share of the series.
    seed : int
        Of the angles.

    Returns
    -------
    xr.Dataset
        Per lane ``K``, the median over the angles; ``K_low`` and ``K_high``, its quartiles; ``status``. K is NaN
        unless ``status`` is ``ok``, or ``oversampled``, where the value is given but must not be believed if small.

    Raises
    ------
    RangeError
        Fewer than 100 samples, or an option out of range.

    Notes
    -----
    1. The mean is taken off, and the series divided by its standard deviation. The oscillating term of the
       displacement, (mean)^2 (1 - cos nc) / (1 - cos c), by which [gottwald2009] modify it, is then zero.
    2. p(n) = sum phi_j cos jc, q(n) = sum phi_j sin jc; D(n) = mean of (p(j+n) - p(j))^2 + (q(j+n) - q(j))^2 over
       the same number of j, at 25 n up to ``longest``.
    3. To D(n), ``damping`` times sin(sqrt(2) n) is added [gottwald2005], here in units of the variance.
    4. K_c is the correlation of D(n) with n; K is the median over c, because single angles are resonant
       [gottwald2009].

    Limits: a long transient and a slow drift appear regular. Bands of chaos around a periodic cycle appear regular until
    the diffusion inside outgrows the hops between: take off the cycle first (`remove_cycle`). K between 0.2
    and 0.8 says nothing.
    """
    x = np.asarray(series, dtype=np.float64)
    x = x[:, None] if x.ndim == 1 else x
    if x.ndim != 2 or x.shape[0] < 100:
        raise RangeError(f"series has shape {x.shape}: (time,) or (time, lane) with at least 100 samples is needed.")
    if angles < 10 or not 0 < longest <= 0.5 or damping < 0:
        raise RangeError(
            f"angles = {angles}, longest = {longest}, damping = {damping}: at least 10, in (0, 0.5], not negative."
        )
    (K_low, middle, K_high), status, reach = growth_rates(x, angles, damping, longest, seed)
    flags = {"flag_values": np.arange(len(STATUS), dtype=np.int8), "flag_meanings": " ".join(STATUS)}
    return Findings(
        {
            "K": _lane(middle, "growth rate of the 0-1 test, median over angles"),
            "K_low": _lane(K_low, "lower quartile over angles"),
            "K_high": _lane(K_high, "upper quartile over angles"),
            "status": _lane(status, "status of the 0-1 test", **flags),
        },
        attrs={"angles": angles, "damping": damping, "longest": reach, "samples": x.shape[0], "seed": seed},
    )


def growth_rates(
    x: Array, angles: int, damping: float = 0.0, longest: float = 0.1, seed: int = 2009
) -> tuple[Array, NDArray[np.int8], int]:
    """Quartiles of K, shape (3, lane), index of the status, and the largest lag: the 0-1 test without a Dataset."""
    c = np.random.default_rng(seed).uniform(np.pi / 5, 4 * np.pi / 5, angles)
    reach = max(int(longest * x.shape[0]), 10)
    lags = np.unique(np.linspace(1, reach, min(reach, LAGS)).astype(np.int64))
    n = lags.astype(float)
    wobble = damping * np.sin(np.sqrt(2.0) * n)
    series = np.ascontiguousarray(x.T)  # sums along a row do not depend on the other rows
    status = np.zeros(len(series), np.int8)
    finite = np.isfinite(series).all(axis=1)
    with np.errstate(invalid="ignore"):
        deviation = series.std(axis=1)
        constant = finite & (deviation <= 1e-12 * np.abs(series).max(axis=1))
    status[~finite], status[constant] = STATUS.index("not-finite"), STATUS.index("constant")
    K = np.full((len(series), angles), np.nan)
    if (judged := np.flatnonzero(finite & ~constant)).size:
        walks = (series[judged] - series[judged].mean(axis=1, keepdims=True)) / deviation[judged, None]
        status[judged[np.mean(np.diff(walks) ** 2, axis=1) < OVERSAMPLED]] = STATUS.index("oversampled")
        displacement = np.empty((judged.size, angles, lags.size))
        p, q = np.empty_like(walks[0]), np.empty_like(walks[0])
        _displacements(
            series=walks, lanes=judged.size, n=walks.shape[1], angles=c, turns=angles, lags=lags, count=lags.size, p=p, q=q,
            out=displacement,
        )  # fmt: skip
        K[judged] = _correlation(n, displacement + wobble)
    return np.percentile(K, (25, 50, 75), axis=1), status, reach


def remove_cycle(series: ArrayLike, *, most: int = 16, least_share: float = 0.9) -> tuple[Array, NDArray[np.int64]]:
    """Take off the cycle that a series hops around, where there is one.

    Parameters
    ----------
    series : array, shape (time, lane)
    most : int
        Longest cycle tried.
    least_share : float
        A cycle is taken off only if it explains at least this share of the variance.

    Returns
    -------
    rest : array, shape (time, lane)
        Less the mean of each phase of the cycle; unchanged where no cycle was found.
    cycle : array of int, shape (lane,)
        Its length, 1 where none was found.

    Notes
    -----
    The shortest cycle whose unexplained variance is within twice that of the best one, so that multiples do not win.
    Quasi-periodic motion stays quasi-periodic, chaos stays chaos.
    """
    x = np.ascontiguousarray(np.asarray(series, dtype=np.float64).T)
    rest, cycle = x - x.mean(axis=1, keepdims=True), np.ones(len(x), np.int64)
    whole = (rest**2).mean(axis=1)
    most = min(most, x.shape[1] // 8)
    left = np.stack([whole] + [((x - phase_means(x, m)) ** 2).mean(axis=1) for m in range(2, most + 1)])
    hops = left.min(axis=0) < (1 - least_share) * whole
    cycle[hops] = (left[:, hops] <= 2 * left[:, hops].min(axis=0)).argmax(axis=0) + 1
    for m in np.unique(cycle[hops & (cycle > 1)]):
        these = hops & (cycle == m)
        rest[these] = x[these] - phase_means(x[these], int(m))
    return rest.T, cycle


def phase_means(x: Array, m: int) -> Array:
    """Mean of every m-th sample of each row, shape (series, time), repeated over the row."""
    rounds = x.shape[1] // m
    means = x[:, : rounds * m].reshape(len(x), rounds, m).mean(axis=1)
    return means[:, np.arange(x.shape[1]) % m]


def _correlation(n: Array, rows: Array) -> Array:
    """Correlation of each row, along the last axis, with n."""
    a, b = n - n.mean(), rows - rows.mean(axis=-1, keepdims=True)
    size = np.sqrt((a**2).sum() * (b**2).sum(axis=-1))
    return np.divide((b * a).sum(axis=-1), size, out=np.zeros(size.shape), where=size > 0)


def _lane(values: Any, long_name: str, **more: Any) -> tuple[str, Any, dict[str, Any]]:
    return "lane", values, {"units": "1", "long_name": long_name, **more}
