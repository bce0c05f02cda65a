"""The clock of a recording: which columns tell the time, and the even grid that they show."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from whirlmap.errors import InputError
from whirlmap.recordings.column_names import CLOCK_PARTS, is_time, seconds_per, unit_of_time_name
from whirlmap.recordings.fields import CLOCK, DATE, NUMBER
from whirlmap.recordings.table import Array, Table, find_column

#: Share of a step by which times may lie beside an even grid, and scatter of the steps that is taken for jitter.
BESIDE, JITTER = 0.1, 0.05
#: Width, in steps, of the band around an even grid in which times lie that jitter.
HALF = 0.5
#: Longest gap that is filled [samples], and largest share of samples that are.
LONGEST_GAP, MOST_FILLED = 3, 0.15
#: Rows up to which no step is called usual.
FEW = 10
DAY = 86400.0


@dataclass(frozen=True)
class Clock:
    """Columns that tell the time.

    Attributes
    ----------
    positions : tuple of int
        One column; a date and a clock time; or hour, minute, second and their parts.
    scales : tuple of float
        Seconds in one unit of each.
    name : str
    unit : str
        As written; nothing where seconds are assumed.
    kind : str
        ``number``, ``date`` or ``parts``.
    """

    positions: tuple[int, ...]
    scales: tuple[float, ...]
    name: str
    unit: str
    kind: str


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


def find_clock(table: Table, wanted: str | None) -> Clock | None:
    """Find the columns that tell the time; None where there is none.

    Parameters
    ----------
    wanted : str, optional
        Name or position of the time column, its unit in brackets where the file says none or another; ``none``.
    """
    if wanted is not None:
        if wanted.strip().lower() == "none":
            return None
        name, bracket, unit = wanted.rstrip("] ").partition("[")
        at = find_column(table, name if bracket else wanted, "--time")
        scale = seconds_per(unit.strip()) if bracket else None
        if bracket and scale is None:
            raise InputError(f"--time: found the unit {unit.strip()!r}, expected one of time, such as [ms]")
        column = table.columns[at]
        return _one(table, at) if scale is None else Clock((at,), (scale,), column.title or f"column {at + 1}", unit.strip(), NUMBER)
    parts = _parts(table)
    if parts:
        return parts
    times = [k for k, c in enumerate(table.columns) if c.kind in (DATE, CLOCK) or (c.kind == NUMBER and is_time(c.name))]
    numbers = [k for k in times if table.columns[k].kind == NUMBER]
    dates = [k for k in times if table.columns[k].kind == DATE]
    clocks = [k for k in times if table.columns[k].kind == CLOCK]
    if numbers:
        return _one(table, numbers[0])
    if dates and clocks:
        both = dates[0], clocks[0]
        return Clock(both, (1e-9, 1e-9), " and ".join(table.columns[k].title or f"column {k + 1}" for k in both), "ns", DATE)
    if dates or clocks:
        return _one(table, (dates or clocks)[0])
    return _nameless(table)


def _one(table: Table, at: int) -> Clock:
    column = table.columns[at]
    name = column.title or f"column {at + 1}"
    if column.kind in (DATE, CLOCK):
        return Clock((at,), (1e-9,), name, "ns", DATE)
    unit = column.unit or unit_of_time_name(column.name)
    unit = "1" if unit == "time" else unit  # of a model without dimensions
    scale = seconds_per(unit) if unit else None
    if scale is None and unit not in ("", "1"):
        raise InputError(f"{table.source}: found the unit {unit!r} of the times in {name!r}, expected one of time;"
                         f" --time \"{column.name or at + 1} [s]\" says it")  # fmt: skip
    return Clock((at,), (scale or _magnitude(table.first_rows[at]),), name, unit if scale or unit == "1" else "", NUMBER)


def _magnitude(first: Array) -> float:
    """Seconds in one unit of times without a unit: stamps since 1970 and days of calendars are told by their size."""
    known = first[np.isfinite(first)]
    if not known.size:
        return 1.0
    size = abs(float(np.median(known)))
    for least, scale in ((1e17, 1e-9), (1e14, 1e-6), (1e11, 1e-3)):
        if size > least:
            return scale
    days = 3e4 < size < 8e5 and known.size > 2 and 0 < float(np.median(np.diff(known))) < 0.01
    return DAY if days else 1.0


def _parts(table: Table) -> Clock | None:
    """Hour, minute, second and smaller parts in columns of their own, by name or, without names, by what they hold."""
    named = {k: CLOCK_PARTS[c.name.strip().lower()] for k, c in enumerate(table.columns) if c.name.strip().lower() in CLOCK_PARTS}
    if len(named) >= 3 and 1.0 in named.values() and 60.0 in named.values() and len(set(named.values())) == len(named):
        ordered = sorted(named, key=lambda k: -named[k])
        titles = ", ".join(table.columns[k].title for k in ordered)
        return Clock(tuple(ordered), tuple(named[k] for k in ordered), titles, "s", "parts")
    if any(c.title for c in table.columns) or len(table.columns) < 5:
        return None
    first = table.first_rows[:4]
    if any(f.size < 10 or not np.isfinite(f).all() or (f < 0).any() or (f != np.round(f)).any() for f in first):
        return None
    hour, minute, second, small = first
    if hour.max() > 23 or minute.max() > 59 or second.max() > 59 or not 999 < small.max() < 1e6:
        return None
    t = 3600 * hour + 60 * minute + second + 1e-6 * small
    steps = np.diff(t)
    return Clock((0, 1, 2, 3), (3600.0, 60.0, 1.0, 1e-6), "columns 1 to 4", "s", "parts") if (steps > 0).all() else None


def _nameless(table: Table) -> Clock | None:
    """First column, where it has no name and ascends evenly by steps that are no whole number: times, not a count."""
    if len(table.columns) < 2 or table.columns[0].title or table.columns[0].kind != NUMBER:
        return None
    first = table.first_rows[0]
    steps = np.diff(first)
    if first.size < 10 or not np.isfinite(first).all() or steps.min() <= 0 or np.ptp(steps) > 0.05 * steps.mean():
        return None
    return None if (first == np.round(first)).all() else Clock((0,), (1.0,), "column 1", "", NUMBER)


def seconds_of(clock: Clock, columns: Sequence[NDArray[np.generic]]) -> tuple[Array, float, float]:
    """Times since the first one [s], the time of the first one, and the step in which they are written."""
    if clock.kind == DATE:
        stamps = sum((np.asarray(c, dtype=np.int64) for c in columns[1:]), np.asarray(columns[0], dtype=np.int64))
        t = (stamps - stamps[0]) * 1e-9
        start, written = 0.0, _written_step((stamps[:5000] - stamps[0]).astype(float)) * 1e-9
    elif clock.kind == "parts":
        t = sum(s * (np.asarray(c, dtype=float) - float(np.asarray(c[0]))) for s, c in zip(clock.scales, columns, strict=True))
        t, start, written = np.asarray(t), 0.0, clock.scales[-1]
    else:
        raw = np.asarray(columns[0], dtype=float)
        t, start = (raw - raw[0]) * clock.scales[0], float(raw[0]) * clock.scales[0]
        written = _written_step(raw[:5000] - raw[0]) * clock.scales[0]
        start = 0.0 if abs(start) > 1e8 else start
    if clock.kind != NUMBER:  # midnight
        jumps = np.diff(t)
        t = t + DAY * np.r_[0.0, np.cumsum((jumps < -DAY / 2) & (jumps > -1.5 * DAY))]
    return t, start, written


def _written_step(values: Array) -> float:
    """Power of ten of which all values are multiples; 0 where there is none of 12 digits."""
    size = float(np.abs(values).max()) if values.size else 0.0
    if not size > 0 or not np.isfinite(size):
        return 0.0
    top = int(np.floor(np.log10(size)))
    for k in range(top, top - 10, -1):
        scaled = values / 10.0**k
        if np.abs(scaled - np.round(scaled)).max() < 1e-4 * max(1.0, 1e-9 * size / 10.0**k):
            return float(10.0**k)
    return 0.0


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
    and its rate the slope, which a thousand rounded times give to 1e-5. Else the median step is refined over the steps of one
    sample; steps of none are doubled stamps, whose later row is dropped, steps of some are gaps. Gaps of up to 3 samples are
    to be filled where they take up to 15 % of the samples.
    """
    name, n = clock.name, t.size
    if n < 3:
        raise InputError(f"{name}: found {n} times, expected more, ascending by equal steps")
    steps = np.diff(t)
    if (steps < 0).any():
        k = int(np.argmax(steps < 0))
        raise InputError(f"{place(k + 1)}: the time in {name!r} goes back by {-steps[k]:.6g} s ({int((steps < 0).sum())} times), expected"
                         " times that ascend by equal steps; several records in one file? --window takes a part of one,"
                         " --time none with --rate leaves the times out")  # fmt: skip
    if t[-1] <= 0:
        raise InputError(f"{name}: found the same time in all rows, expected times that ascend by equal steps; --time none leaves them out")
    row = np.arange(n) - (n - 1) / 2
    slope = float(row @ (t - t.mean()) / (row @ row))
    beside = t - t.mean() - slope * row
    rounding = 1.5 * written + 8 * np.spacing(float(abs(start) + t[-1]))
    notices = []
    if not clock.unit:
        notices.append(f"the times in {name!r} have no unit: {_said(clock)}; the step is {slope:.6g} s")
    if np.ptp(beside) <= 1e-6 * slope + 8 * np.spacing(float(abs(start) + t[-1])):
        return Grid((n - 1) / float(t[-1]), start, notices=notices)
    # Steps of one and two units may be a step of 1.1 that was rounded, or missing samples: the plainer reading is the second.
    missing = written > 0 and float(np.mean(np.abs(steps - written) < 1e-6 * written)) > 0.7
    if n > FEW and np.ptp(beside) <= rounding and t[-1] > 5 * written and not missing:
        if written > 2 * slope:  # the rows at which the time steps are known to one row
            at = np.flatnonzero(steps > 0) + 1
            slope = 1 / float(np.polyfit(t[at] - t.mean(), row[at], 1)[0])
        notices.append(f"the times in {name!r} are rounded to {written:g} s: the mean step of {slope:.7g} s is taken, {1 / slope:.6g} Hz")
        return Grid(1 / slope, start, notices=notices)
    return _uneven(name, t, steps, start, written, place, notices)


def _uneven(name: str, t: Array, steps: Array, start: float, written: float, place: Callable[[int], str], notices: list[str]) -> Grid:
    step = float(np.median(steps[steps > 0]))
    for _ in range(4):
        whole = np.round(steps / step)
        step = float(steps[whole == 1].mean()) if (whole == 1).any() else step
    whole = np.round(steps / step)
    off = np.abs(steps - whole * step)
    tolerance = max(min(1.01 * written, 0.35 * step), BESIDE * step)
    if t.size > FEW and written < 1.01 * step and (off <= tolerance).all() and ((whole != 1).any() or off.std() <= JITTER * step):
        return _gaps(name, t, whole.astype(np.int64), step, start, place, notices)
    row = np.arange(t.size) - (t.size - 1) / 2
    mean = float(row @ (t - t.mean()) / (row @ row))
    if np.ptp(t - t.mean() - mean * row) < HALF * mean:  # a row more or less would show
        notices.append(f"the steps of the times in {name!r} scatter by {100 * steps.std() / mean:.2g} %: the mean step of {mean:.6g} s"
                       f" is taken, {1 / mean:.6g} Hz")  # fmt: skip
        return Grid(1 / mean, start, notices=notices)
    k = int(np.argmax(np.abs(steps - step)))
    raise InputError(f"{place(k + 1)}: found a step of {steps[k]:.6g} s in the times in {name!r} where {step:.6g} s is usual (they range from"
                     f" {steps.min():.4g} to {steps.max():.4g} s), expected times that ascend by equal steps; interpolate the signal to even"
                     " steps first, or --time none with --rate leaves the times out")  # fmt: skip


def _gaps(name: str, t: Array, whole: NDArray[np.int64], step: float, start: float, place: Callable[[int], str],
          notices: list[str]) -> Grid:  # fmt: skip
    doubled, gaps = np.flatnonzero(whole == 0), np.flatnonzero(whole > 1)
    rows = np.flatnonzero(np.r_[True, whole != 0])
    index = np.r_[0, np.cumsum(whole)][rows]
    if doubled.size:
        notices.append(f"{place(int(doubled[0]) + 1)}: the time in {name!r} is that of the row before ({doubled.size} such rows are dropped)")
    if gaps.size:
        missing, longest = int((whole[gaps] - 1).sum()), int(whole[gaps].max()) - 1
        said = (f"{place(int(gaps[0]) + 1)}: the time in {name!r} steps by {whole[gaps[0]] * step:.6g} s instead of {step:.6g} s"
                f" ({gaps.size} gaps, {missing} samples are missing)")  # fmt: skip
        if longest <= LONGEST_GAP and missing <= MOST_FILLED * (index[-1] + 1):
            notices.append(f"{said}: filled by cubic interpolation")
        else:
            ends = np.r_[0, np.flatnonzero(np.diff(index) > 1) + 1, index.size]
            best = int(np.argmax(np.diff(ends)))
            rows, index = rows[ends[best] : ends[best + 1]], index[ends[best] : ends[best + 1]]
            notices.append(f"{said}: only the longest part without a gap is read, {rows.size} rows from {place(int(rows[0]))}")
            start, index = start + float(t[rows[0]]), index - index[0]
    even = rows.size == t.size
    return Grid(1 / step, start, None if even else rows, None if (np.diff(index) == 1).all() else index, notices)


def _said(clock: Clock) -> str:
    scale = clock.scales[0]
    words = {1.0: "seconds are assumed", DAY: "days of a calendar are assumed"}
    return words.get(scale, f"stamps since 1970 in units of {scale:g} s are assumed")
