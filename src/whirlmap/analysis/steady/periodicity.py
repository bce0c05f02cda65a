"""Return of section points, and its number of periods: the evidence for the label ``periodic(n)``.

Two steps, because only points one *common* period apart see the same forcing: ``return_multiple`` finds after
how many common periods the motion repeats, ``period_in_T`` then finds the smallest number of T which divides
that and returns too.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from whirlmap.analysis.steady.return_search import nearest_returns
from whirlmap.errors import RangeError
from whirlmap.integrate.scales import FLOOR
from whirlmap.results.findings import Findings, gives_dataset

Array = NDArray[np.float64]

RETURN_STATUS = ("returns", "no-return", "not-finite")
"""Meaning of ``status`` of ``return_multiple`` by value."""
PERIOD_STATUS = ("periodic", "no-return", "not-finite", "window-too-short")
"""Meaning of ``status`` of ``period_in_T`` by value."""


@gives_dataset
def return_multiple(
    section: ArrayLike,
    *,
    scale: ArrayLike | None = None,
    tolerance: float = 1e-6,
    most: int = 64,
    cyclic: Mapping[int, float] | None = None,
    floor: float = FLOOR,
    alike: bool = True,
) -> Findings:
    """Smallest number of common periods after which each lane's section points repeat.

    Parameters
    ----------
    section : array, shape (period, state) or (period, state, lane)
        Successive section points, one per common period, already settled. At least ``2 * most`` of them: each
        m is judged on at least m differences, so that all m points of an orbit are compared with their
        return.
    scale : array, shape (state,) or (state, lane), optional
        Size of each state's motion, by which differences are divided: give the range of the state over a
        whole orbit, for only that says what a small difference is. Left out, it is guessed from the section
        alone, which cannot see how far the motion swings between the points: the larger of the spread of its
        points and one hundredth of their largest magnitude (cyclic states: of the period).
    tolerance : float
        Largest scaled difference, over the window and all states, that counts as a return.
    most : int
        Largest multiple that is tried.
    cyclic : mapping of state index to period, optional
        States, such as a pendulum's angle, whose differences are taken modulo a period.
    floor : float
        No scale is smaller than this fraction of the state's largest magnitude, nor, where the states are alike,
        than this fraction of the lane's largest scale. A state that hardly moves must not decide by its rounding
        errors: with the defaults, differences below 1e-12 of its magnitude, or of the largest motion, never
        forbid a return.
    alike : bool
        Whether all states have one unit, so that one can be small beside another. What a model says of that comes
        with ``scale`` (`whirlmap.integrate.scales`).

    Returns
    -------
    xr.Dataset
        Per lane: ``multiple`` (m, or 0 if nothing returned), ``distance`` (the largest scaled difference at
        m; for m = 0 the smallest such number of any multiple tried), ``nearest_multiple`` (where that was),
        ``deciding_state`` (index of the state with the largest difference), ``drift`` (largest scaled
        difference of any two points a whole number of nearest multiples apart: a slow beat or an unfinished
        transient shows as a drift much larger than the distance), and ``status``. Lanes with numbers that are
        not finite have ``distance`` and ``drift`` NaN and ``status`` not-finite.

    Raises
    ------
    RangeError
        The window is shorter than ``2 * most``, or a scale, period or tolerance is not positive.

    Notes
    -----
    d(m) = max over i and states k of |x_k(i + m) - x_k(i)| / scale_k; the answer is the smallest m with
    d(m) < tolerance. The maximum, not a mean: one point that fails to return is enough. A motion whose period
    doubled by less than the tolerance is not told apart from the simpler one; a quasi-periodic motion whose
    beat moves it by less than the tolerance in m periods passes, which is why ``drift`` is reported.
    """
    x = _checked(section, "section", tolerance)
    if most < 1 or x.shape[0] < 2 * most:
        raise RangeError(
            f"section holds {x.shape[0]} points: multiples up to {most} need at least {2 * max(most, 1)}. "
            f"Record more, or ask for most={x.shape[0] // 2}."
        )
    period = _periods(cyclic, x.shape[1])
    finite = np.asarray(np.isfinite(x).all(axis=(0, 1)))
    size = _scales(x, scale, period, floor, finite, alike=alike)
    multiple, distance, nearest, deciding = nearest_returns(x, size, period, tolerance, most)
    drift = np.full(x.shape[2], np.nan)
    for m in np.unique(nearest[finite]):
        those = np.flatnonzero(finite & (nearest == m))
        drift[those] = _largest_within_classes(x[:, :, those], int(m), period, size[:, those])

    status = np.where(~finite, 2, np.where(multiple > 0, 0, 1)).astype(np.int8)
    return Findings(
        {
            "multiple": _lane(multiple, "common periods after which the motion repeats (0: none found)"),
            "distance": _lane(distance, "largest scaled difference between points that far apart"),
            "nearest_multiple": _lane(nearest, "number of common periods with the smallest distance"),
            "deciding_state": _lane(deciding, "state with the largest scaled difference (-1: none)"),
            "drift": _lane(drift, "largest scaled difference over the window at the nearest multiple"),
            "status": _lane(status, "whether the section returns", RETURN_STATUS),
        },
        attrs={"tolerance": tolerance, "most": most, "window": x.shape[0], "floor": floor},
    )


@gives_dataset
def period_in_T(
    points: ArrayLike,
    multiple: ArrayLike,
    *,
    common_over_T: int,
    scale: ArrayLike | None = None,
    tolerance: float = 1e-6,
    cyclic: Mapping[int, float] | None = None,
    floor: float = FLOOR,
    alike: bool = True,
) -> Findings:
    """Smallest number n of periods T after which lanes that return at the common period repeat.

    Parameters
    ----------
    points : array, shape (T, state) or (T, state, lane)
        Successive section points, one per T, settled. At least ``multiple * common_over_T`` of them, for then
        the largest proper divisor is still judged on as many differences as it has points.
    multiple : array of int, shape () or (lane,)
        ``multiple`` of ``return_multiple``; 0 where nothing returned.
    common_over_T : int
        The common period in T: 8 in the paper's clock, 40 for 20 and 40 teeth.
    scale, tolerance, cyclic, floor, alike
        As in ``return_multiple``; use the same.

    Returns
    -------
    xr.Dataset
        Per lane: ``period`` (n, the n of periodic(n); 0 where none), ``distance`` (the largest scaled
        difference at n; NaN where n is the whole ``multiple * common_over_T`` and the window holds no later
        point to compare, as ``distance_status`` says, or where there is no n), ``status``.

    Raises
    ------
    RangeError
        Shapes disagree, or a number is out of range.

    Notes
    -----
    n runs through the divisors of m * common_over_T upwards, because the return times of a periodic orbit are
    the multiples of the smallest. The last divisor needs no test: ``return_multiple`` has found that return.
    """
    x = _checked(points, "points", tolerance)
    if common_over_T < 1:
        raise RangeError(f"common_over_T = {common_over_T}: the common period is at least one T.")
    m = np.atleast_1d(np.asarray(multiple))
    if m.shape != x.shape[2:] or not np.issubdtype(m.dtype, np.integer) or (m < 0).any():
        raise RangeError(f"multiple must hold {x.shape[2]} whole numbers >= 0, one per lane; got {m!r}.")
    period = _periods(cyclic, x.shape[1])
    finite = np.asarray(np.isfinite(x).all(axis=(0, 1)))
    size = _scales(x, scale, period, floor, finite, alike=alike)
    n, distance = np.zeros(m.size, np.int64), np.full(m.size, np.nan)
    status = np.where(~finite, 2, np.where(m == 0, 1, 0)).astype(np.int8)
    status[(status == 0) & (m * common_over_T > x.shape[0])] = 3
    for multiple_here in np.unique(m[status == 0]):
        whole = int(multiple_here) * common_over_T
        left = np.flatnonzero((status == 0) & (m == multiple_here))
        for divisor in (k for k in range(1, whole + 1) if whole % k == 0):
            if divisor < x.shape[0]:
                differences = _difference(x[divisor:, :, left] - x[:-divisor, :, left], period)
                largest = (differences.max(axis=0) / size[:, left]).max(axis=0)
            else:
                largest = np.full(left.size, np.nan)
            found = (largest < tolerance) | (divisor == whole)
            n[left[found]], distance[left[found]] = divisor, largest[found]
            left = left[~found]
            if left.size == 0:
                break
    return Findings(
        {
            "period": _lane(n, "number of periods T after which the motion repeats (0: none found)"),
            "distance": _lane(distance, "largest scaled difference between points that far apart"),
            "distance_status": _lane(
                np.isnan(distance).astype(np.int8), "distance", ("given", "not-measured")
            ),
            "status": _lane(status, "whether the motion is periodic", PERIOD_STATUS),
        },
        attrs={"tolerance": tolerance, "window": x.shape[0], "floor": floor, "common_over_T": common_over_T},
    )


def _checked(values: ArrayLike, name: str, tolerance: float) -> NDArray[np.float64]:
    """(period, state, lane) as floats, or a RangeError."""
    x = np.asarray(values, dtype=np.float64)
    if x.ndim == 2:
        x = x[:, :, None]
    if x.ndim != 3 or 0 in x.shape:
        raise RangeError(f"{name} has shape {x.shape}: (period, state) or (period, state, lane) is needed.")
    if not tolerance > 0:
        raise RangeError(f"tolerance = {tolerance}: a positive number is needed.")
    return x


def _periods(cyclic: Mapping[int, float] | None, n_states: int) -> NDArray[np.float64]:
    """Period of each state, infinite where it is not cyclic."""
    period = np.full(n_states, np.inf)
    for k, value in (cyclic or {}).items():
        if not (0 <= k < n_states and 0 < value < np.inf):
            raise RangeError(f"cyclic = {{{k}: {value}}}: states are 0 to {n_states - 1}, periods positive.")
        period[k] = value
    return period


def _difference(raw: NDArray[np.float64], period: NDArray[np.float64]) -> NDArray[np.float64]:
    """Magnitude of differences (..., state, lane), in place; the shorter way round for cyclic states."""
    for k in np.flatnonzero(np.isfinite(period)):
        raw[..., k, :] -= period[k] * np.rint(raw[..., k, :] / period[k])
    return np.abs(raw, out=raw)


def _scales(
    x: NDArray[np.float64],
    scale: ArrayLike | None,
    period: NDArray[np.float64],
    floor: float,
    finite: NDArray[np.bool_],
    *,
    alike: bool,
) -> NDArray[np.float64]:
    """Scale of each state and lane, floors applied; 1 in lanes that are not finite (they are not judged)."""
    if not floor > 0:
        raise RangeError(f"floor = {floor}: a positive number is needed.")
    states, lanes = x.shape[1:]
    size = np.ones((states, lanes))
    y = x[:, :, finite]
    around = np.isfinite(period)
    magnitude = np.where(around[:, None], np.where(around, period, 0.0)[:, None], np.abs(y).max(axis=0))
    if scale is None:
        from_first = y - y[:1]
        for k in np.flatnonzero(around):
            from_first[:, k] -= period[k] * np.rint(from_first[:, k] / period[k])
        own = np.maximum(np.ptp(from_first, axis=0), 0.01 * magnitude)
    else:
        given = np.asarray(scale, dtype=np.float64)
        if given.ndim < 2:
            given = np.broadcast_to(given, (states,))[:, None]
        if given.shape not in ((states, 1), (states, lanes)):
            raise RangeError(f"scale has shape {given.shape}: ({states},) or ({states}, {lanes}) is needed.")
        own = np.broadcast_to(given, (states, lanes))[:, finite]
        if not (np.isfinite(own) & (own >= 0)).all():
            raise RangeError("scale holds numbers that are negative or not finite.")
    floored = np.maximum(own, floor * magnitude)
    if alike:
        floored = np.maximum(floored, floor * floored.max(axis=0))
    size[:, finite] = np.where(floored > 0, floored, 1.0)  # a state that does not move at all: its differences are zero
    return size


def period_of(cyclic: Mapping[int, float] | None, states: int) -> Array:
    """Period of each state, infinite where it is not cyclic."""
    return _periods(cyclic, states)


def _largest_within_classes(
    x: NDArray[np.float64], m: int, period: NDArray[np.float64], size: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Largest scaled difference, per lane, of any point from the first one a multiple of m before it."""
    first = x[np.arange(x.shape[0]) % m]
    return np.asarray((_difference(x - first, period).max(axis=0) / size).max(axis=0))


def _lane(
    values: NDArray[Any], long_name: str, meanings: tuple[str, ...] = ()
) -> tuple[str, NDArray[Any], dict[str, Any]]:
    """One variable over lanes with its attributes."""
    attributes: dict[str, Any] = {"units": "1", "long_name": long_name}
    if meanings:
        flags = np.arange(len(meanings), dtype=np.int8)
        attributes |= {"flag_values": flags, "flag_meanings": " ".join(meanings)}
    return "lane", values, attributes
