"""The sampling times of a recording: which columns hold them, and the times in seconds."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from whirlmap.errors import InputError
from whirlmap.recordings.column_names import CLOCK_PARTS, is_time, seconds_per, unit_of_time_name
from whirlmap.recordings.fields import CLOCK, DATE, NUMBER
from whirlmap.recordings.table import Array, Table, find_column

DAY = 86400.0


@dataclass(frozen=True)
class Clock:
    """Columns that hold the time.

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


def find_clock(table: Table, wanted: str | None) -> Clock | None:
    """Find the columns that hold the time; None where there is none.

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
        return (
            _one(table, at)
            if scale is None
            else Clock((at,), (scale,), column.title or f"column {at + 1}", unit.strip(), NUMBER)
        )
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
        raise InputError(
            f"{table.source}: found the unit {unit!r} of the times in {name!r}, expected one of time;"
            f' --time "{column.name or at + 1} [s]" says it'
        )
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
    named = {
        k: CLOCK_PARTS[c.name.strip().lower()] for k, c in enumerate(table.columns) if c.name.strip().lower() in CLOCK_PARTS
    }
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
        t = sum(
            s * (np.asarray(c, dtype=float) - float(np.asarray(c[0]))) for s, c in zip(clock.scales, columns, strict=True)
        )
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
