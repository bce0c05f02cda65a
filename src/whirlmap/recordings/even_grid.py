"""The even sampling grid in the times of a recording, and its faults: rounding, jitter, gaps, doubled stamps."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from whirlmap.errors import InputError, counted
from whirlmap.recordings.clock import DAY, Clock
from whirlmap.recordings.table import Array

#: Share of a step by which times may lie beside an even grid, and scatter of the steps that is taken for jitter.
BESIDE, JITTER = 0.1, 0.05
#: Width, in steps, of the band around an even grid in which times lie that jitter.
HALF = 0.5
#: Longest gap that is filled [samples], and largest share of samples that are.
LONGEST_GAP, MOST_FILLED = 3, 0.15
#: Rows up to which no step is called usual.
FEW = 10


@dataclass(frozen=True)
class Grid:
    """Even sampling as the times show it.

    Attributes
    ----------
    rate : float
        Samples per second.
    start : float
        Time of the first sample [s]; 0 for dates.
    rows : array of int or None
        Rows that are kept, None for all.
    index : array of int or None
        Place of each kept row on the even grid; None where it is its number.
    notices : list of str
    """

    rate: float
    start: float
    rows: NDArray[np.intp] | None = None
    index: NDArray[np.int64] | None = None
    notices: list[str] = field(default_factory=list)


def even_grid(clock: Clock, t: Array, start: float, written: float, place: Callable[[int], str]) -> Grid:
    """Find the even grid of times, with what is odd about it.

    Parameters
    ----------
    t : array, shape (row,)
        Seconds since the first one.
    written : float
        Step in which the times are written [s]; 0 where they have all their digits.
    place : callable
        Name of a row: ``line 17``.

    Raises
    ------
    InputError
        The times go back, do not ascend by equal steps, or are too few.

    Notes
    -----
    A straight line is fitted to the times. Where they lie within the step in which they are written, the sampling is even
    and its rate the slope, which a thousand rounded times give to 1e-5. Else the median step is refined over the steps of
    one sample; steps of none are doubled stamps, whose later row is dropped, steps of some are gaps. Gaps of up to 3
    samples are to be filled where they take up to 15 % of the samples.
    """
    name, n = clock.name, t.size
    if n < 3:
        raise InputError(f"{name}: found {counted(n, 'time')}, expected more, ascending by equal steps")
    steps = np.diff(t)
    if (steps < 0).any():
        k = int(np.argmax(steps < 0))
        raise InputError(
            f"{place(k + 1)}: the time in {name!r} goes back by {-steps[k]:.6g} s ({int((steps < 0).sum())} "
            "times), expected"
            " times that ascend by equal steps; several records in one file? --window takes a part of one,"
            " --time none with --rate leaves the times out"
        )
    if t[-1] <= 0:
        raise InputError(
            f"{name}: found the same time in all rows, expected times that ascend by equal steps; --time none leaves "
            "them out"
        )
    row = np.arange(n) - (n - 1) / 2
    slope = float(row @ (t - t.mean()) / (row @ row))
    beside = t - t.mean() - slope * row
    rounding = 1.5 * written + 8 * np.spacing(float(abs(start) + t[-1]))
    notices = []
    if not clock.unit:
        notices.append(f"the times in {name!r} have no unit: {_said(clock)}; the step is {slope:.6g} s")
    if np.ptp(beside) <= 1e-6 * slope + 8 * np.spacing(float(abs(start) + t[-1])):
        return Grid((n - 1) / float(t[-1]), start, notices=notices)
    # Steps of one and two units may be a step of 1.1 that was rounded, or missing samples: the plainer reading is the
    # second.
    missing = written > 0 and float(np.mean(np.abs(steps - written) < 1e-6 * written)) > 0.7
    if n > FEW and np.ptp(beside) <= rounding and t[-1] > 5 * written and not missing:
        if written > 2 * slope:  # the rows at which the time steps are known to one row
            at = np.flatnonzero(steps > 0) + 1
            slope = 1 / float(np.polyfit(t[at] - t.mean(), row[at], 1)[0])
        notices.append(
            f"the times in {name!r} are rounded to {written:g} s: the mean step of {slope:.7g} s is taken, "
            f"{1 / slope:.6g} Hz"
        )
        return Grid(1 / slope, start, notices=notices)
    return _uneven(name, t, steps, start, written, place, notices)


def _uneven(
    name: str, t: Array, steps: Array, start: float, written: float, place: Callable[[int], str], notices: list[str]
) -> Grid:
    step = float(np.median(steps[steps > 0]))
    for _ in range(4):
        whole = np.round(steps / step)
        step = float(steps[whole == 1].mean()) if (whole == 1).any() else step
    whole = np.round(steps / step)
    off = np.abs(steps - whole * step)
    tolerance = max(min(1.01 * written, 0.35 * step), BESIDE * step)
    if (
        t.size > FEW
        and written < 1.01 * step
        and (off <= tolerance).all()
        and ((whole != 1).any() or off.std() <= JITTER * step)
    ):
        return _gaps(name, t, whole.astype(np.int64), step, start, place, notices)
    row = np.arange(t.size) - (t.size - 1) / 2
    mean = float(row @ (t - t.mean()) / (row @ row))
    if t.size > FEW and np.ptp(t - t.mean() - mean * row) < HALF * mean:  # a row more or less would show
        notices.append(
            f"the steps of the times in {name!r} scatter by {100 * steps.std() / mean:.3g} %: the mean step "
            f"of {mean:.6g} s"
            f" is taken, {1 / mean:.6g} Hz"
        )
        return Grid(1 / mean, start, notices=notices)
    k = int(np.argmax(np.abs(steps - step)))
    raise InputError(
        f"{place(k + 1)}: found a step of {steps[k]:.6g} s in the times in {name!r} where {step:.6g} s is "
        "usual (they range from"
        f" {steps.min():.4g} to {steps.max():.4g} s), expected times that ascend by equal steps; "
        "interpolate the signal to even"
        " steps first, or --time none with --rate leaves the times out"
    )


def _gaps(
    name: str, t: Array, whole: NDArray[np.int64], step: float, start: float, place: Callable[[int], str], notices: list[str]
) -> Grid:
    doubled, gaps = np.flatnonzero(whole == 0), np.flatnonzero(whole > 1)
    rows = np.flatnonzero(np.r_[True, whole != 0])
    index = np.r_[0, np.cumsum(whole)][rows]
    if doubled.size:
        notices.append(
            f"{place(int(doubled[0]) + 1)}: the time in {name!r} is that of the row before ({doubled.size} such rows are "
            "dropped)"
        )
    if gaps.size:
        missing, longest = int((whole[gaps] - 1).sum()), int(whole[gaps].max()) - 1
        said = (
            f"{place(int(gaps[0]) + 1)}: the time in {name!r} steps by {whole[gaps[0]] * step:.6g} s instead of "
            f"{step:.6g} s"
            f" ({counted(gaps.size, 'gap')}, {counted(missing, 'missing sample')})"
        )
        if longest <= LONGEST_GAP and missing <= MOST_FILLED * (index[-1] + 1):
            notices.append(f"{said}: filled by cubic interpolation")
        else:
            ends = np.r_[0, np.flatnonzero(np.diff(index) > 1) + 1, index.size]
            best = int(np.argmax(np.diff(ends)))
            rows, index = rows[ends[best] : ends[best + 1]], index[ends[best] : ends[best + 1]]
            notices.append(
                f"{said}: only the longest part without a gap is read, {rows.size} rows from {place(int(rows[0]))}"
            )
            start, index = start + float(t[rows[0]]), index - index[0]
    even = rows.size == t.size
    return Grid(1 / step, start, None if even else rows, None if (np.diff(index) == 1).all() else index, notices)


def _said(clock: Clock) -> str:
    scale = clock.scales[0]
    words = {1.0: "seconds are assumed", DAY: "days of a calendar are assumed"}
    return words.get(scale, f"stamps since 1970 in units of {scale:g} s are assumed")
