"""Indicators of a regime that need section points only, no equations: 0-1 test and weighted Birkhoff averages."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.indicators.birkhoff import converged_digits
from whirlmap.analysis.indicators.section_coordinates import TOGETHER
from whirlmap.analysis.indicators.zero_one import STATUS, growth_rates, phase_means, remove_cycle

Array = NDArray[np.float64]

#: Relative residual after removing the periodic part, below which an observable is ignored.
REST = 1e-5
#: Fewer section points say nothing.
LEAST = 256
#: Digits of Birkhoff averages above which a motion is smooth, and from which it may be, in so many section points.
SMOOTH, SLOWLY, LONG = 6.0, 3.0, 1000
#: Longest return that is sought, fewest section points for that, distance over the spread of a near return, and the factor
#: by which that distance falls along the record where the section closes.
LONGEST_RETURN, LEAST_RETURNS, NEAR, CLOSER = 200, 48, 0.02, 0.7
#: Distance of a return that is one already.
RETURNED = 1e-6
#: Last section points by which a return is near, at most.
LAST = 64
#: Points that the 0-1 test sees at most: its time grows with their square.
MOST = 1024
#: Rounds of a cycle that a record holds at least where the mean of each of its phases is taken off.
ROUNDS = 8


@dataclass(frozen=True)
class SectionEvidence:
    """Numbers of every operating point, each array of shape (point,); NaN where the section is too short or broken.

    Attributes
    ----------
    growth : array
        K of the 0-1 test, median over observables.
    growth_low : array
        Its lower quartile over angles.
    digits, digits_before : array
        `converged_digits` of the weighted Birkhoff average, median over observables: the larger of those of the whole record
        and of its last half, and those of its last quarter.
    rough : array
        The same of the whole record, relative to what is left without the cycle that the motion hops around.
    uneven : array
        How much the extents of the first and the last third of the record, or of its last half, differ, over the extent; the
        largest of the observables.
    closes : array of bool
        Whether the section comes near to a return, and nearer in the last third of the record than in the first; or returns.
    points, rounds : int
        Section points judged, and those of them once per common period.
    """

    growth: Array
    growth_low: Array
    digits: Array
    digits_before: Array
    rough: Array
    uneven: Array
    closes: NDArray[np.bool_]
    points: int
    rounds: int

    def spread(self, at: NDArray[np.intp], points: int) -> "SectionEvidence":
        """Evidence for that many points, NaN but for these."""
        full: dict[str, Any] = {}
        for name in ("growth", "growth_low", "digits", "digits_before", "rough", "uneven"):
            full[name] = np.full(points, np.nan)
            full[name][at] = getattr(self, name)
        closes = np.zeros(points, dtype=bool)
        closes[at] = self.closes
        return SectionEvidence(**full, closes=closes, points=self.points, rounds=self.rounds)


def evidence_of(
    watched: Array, *, common: int = 1, grows: NDArray[np.bool_] | None = None, final: bool = True, angles: int = 40
) -> SectionEvidence:
    """0-1 test and weighted Birkhoff averages of many operating points.

    Parameters
    ----------
    watched : array, shape (point, observable, time)
        Observables (`Watch`) of successive section points, one per T (or crossing), settled. Points with NaN, and records
        of fewer than `LEAST` points, are not judged.
    common : int
        Number of T after which the forcing repeats.
    grows : array of bool, shape (point,), optional
        Whose tangent vectors grow for sure: no return is sought for them; all may where absent.
    final : bool
        Where not, what tells chaos (the 0-1 test and ``rough``), which takes as long as all else, is asked only where a
        label can come of it: of points that grow, and of long records with averages that converge slowly.
    angles : int
        Of the 0-1 test.

    Notes
    -----
    What repeats with the forcing is taken off (the mean of each phase of the common period, where the record holds `ROUNDS`
    of these), and the cycle that the motion hops around (`remove_cycle`), for the 0-1 test and ``rough``, so that chaos in
    narrow bands is seen. The 0-1 test sees one point per common period, or as many more as it needs; an observable that
    turns slowly (oversampled) silences it. It is not asked where the averages converge (`SMOOTH`): it can only agree.
    """
    count, _, rows = watched.shape
    growth, low, digits, before, rough, uneven = (np.full(count, np.nan) for _ in range(6))
    closes = np.zeros(count, dtype=bool)
    everything = np.zeros(0, dtype=np.intp)
    if rows >= LEAST:
        with np.errstate(invalid="ignore"):
            moves = (np.ptp(watched, axis=2) > 0).any(axis=1) & np.isfinite(watched).all(axis=(1, 2))
        everything = np.flatnonzero(moves)
    for at in (everything[k : k + TOGETHER] for k in range(0, everything.size, TOGETHER)):
        x = watched[at]
        before[at] = _digits(x[:, :, -(rows // 4) :])
        digits[at] = np.maximum(_digits(x), _digits(x[:, :, -(rows // 2) :]))
        uneven[at] = np.minimum(_uneven(x), _uneven(x[:, :, -(rows // 2) :]))
        strobed = x[:, :, (rows - 1) % common :: common]
        rests = np.ones(at.size, dtype=bool) if grows is None else ~grows[at]
        if strobed.shape[2] >= LEAST_RETURNS and rests.any():
            closes[at[rests]] = _closes(strobed[rests])
        asked = final | ~rests | ((digits[at] >= SLOWLY) & (rows >= LONG))
        unsure = (digits[at] < SMOOTH) & asked
        at, x = at[unsure], x[unsure]
        left = _without_cycles(x.reshape(-1, rows), common).reshape(x.shape)
        # The residual without the cycle may be the tail of a transient, or rounding: it must not be judged.
        moving = (left.std(axis=2) >= REST * x.std(axis=2)).all(axis=1)
        at, left = at[moving], left[moving]
        if at.size:
            rough[at] = _digits(left)
            growth[at], low[at] = _zero_one(left, _stride(rows, common), angles)
    return SectionEvidence(growth, low, digits, before, rough, uneven, closes, rows, rows // common)


def _zero_one(left: Array, stride: int, angles: int) -> tuple[Array, Array]:
    """K of the 0-1 test, and its lower quartile, of observables, shape (point, observable, time)."""
    each = left.shape[:2]
    strided = left[:, :, (left.shape[2] - 1) % stride :: stride][:, :, -MOST:]
    (lower, middle, _), status, _ = growth_rates(strided.reshape(-1, strided.shape[-1]).T, angles)
    slow = (status.reshape(each) == STATUS.index("oversampled")).any(axis=1)
    median = [np.where(slow, np.nan, np.median(k.reshape(each), axis=1)) for k in (middle, lower)]
    return median[0], median[1]


def _uneven(x: Array) -> Array:
    """How much the extents of first and last third differ, at most, of observables, shape (point, observable, time)."""
    third = x.shape[2] // 3
    first, last = (np.ptp(x[:, :, part], axis=2) for part in (slice(third), slice(-third, None)))
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray((np.abs(first - last) / np.maximum(first, last)).max(axis=1))


def _digits(left: Array) -> Array:
    """Digits of observables, shape (point, observable, time): the median over observables."""
    flat = left.reshape(-1, left.shape[-1]).T
    return np.asarray(np.median(converged_digits(flat).reshape(left.shape[:2]), axis=1))


def _closes(strobed: Array) -> NDArray[np.bool_]:
    """Whether the nearest return of observables, shape (point, observable, time), comes nearer along the record.

    On a torus the distance over any number of common periods is that of a shift of the phase, and stays.
    """
    rows = strobed.shape[2]
    most, part = min(LONGEST_RETURN, rows // 2), min(rows // 6, LAST)
    last = strobed[:, :, -part:]
    near = np.stack([np.abs(last - strobed[:, :, -part - q : -q]).max(axis=(1, 2)) for q in range(1, most + 1)])
    nearest = near.argmin(axis=0) + 1
    out = np.zeros(len(strobed), dtype=bool)
    for q in np.unique(nearest[near.min(axis=0) < NEAR]):
        at = np.flatnonzero((nearest == q) & (near.min(axis=0) < NEAR))
        away = ((strobed[at, :, q:] - strobed[at, :, :-q]) ** 2).sum(axis=1)
        third = away.shape[1] // 3
        out[at] = away[:, -third:].mean(axis=1) < CLOSER**2 * away[:, :third].mean(axis=1)
    return out | (near.min(axis=0) < RETURNED)


def _stride(rows: int, common: int) -> int:
    """T between the points that the 0-1 test sees: the largest part of a common period that leaves it enough of them."""
    most = min(common, rows // LEAST)
    return max((d for d in range(1, most + 1) if common % d == 0), default=1)


def _without_cycles(series: Array, common: int) -> Array:
    """Series, shape (series, time), without their part that repeats with the forcing and their periodic part."""
    rows = series.shape[1]
    if rows < ROUNDS * common:
        return series - series.mean(axis=1, keepdims=True)
    left = series - phase_means(series, common)
    if common == 1:
        return np.ascontiguousarray(remove_cycle(left.T)[0].T)
    _, cycle = remove_cycle(left[:, ::common].T)
    for m in np.unique(cycle[(cycle > 1) & (rows >= ROUNDS * cycle * common)]):
        left[cycle == m] -= phase_means(left[cycle == m], int(m) * common)
    return left
