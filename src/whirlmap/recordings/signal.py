"""One column of a file as an evenly spaced signal, with its rate and warnings about its faults."""

from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from whirlmap.errors import InputError
from whirlmap.recordings.clock import Clock, find_clock, seconds_of
from whirlmap.recordings.declared_rate import samples_per_second
from whirlmap.recordings.even_grid import Grid, even_grid
from whirlmap.recordings.missing_values import filled, is_missing, words_are_missing
from whirlmap.recordings.open_table import open_table
from whirlmap.recordings.shaft_speed import ShaftSpeed, shaft_speed, speed_column
from whirlmap.recordings.suspects import suspects
from whirlmap.recordings.table import Array, Table, find_column

#: Difference between a rate that was asked for and that of the times, relative, from which it is said.
CONTRADICTS = 5e-3


@dataclass(frozen=True)
class Signal:
    """An evenly spaced signal of a file.

    Attributes
    ----------
    values : array, shape (time,)
        All finite.
    rate : float or None
        Samples per second; None where nothing says it.
    start : float
        Time of the first sample [s], by the file's own times.
    source, column, unit : str
        File, column and unit as they stand in the file.
    form : str
        Format of the file in words.
    shaft : ShaftSpeed or None
        Angle of the shaft over the samples that are kept, where a column with its speed was asked for.
    notices : tuple of str
        What was skipped, filled, assumed or looks wrong, one sentence each.
    """

    values: Array
    rate: float | None
    start: float
    source: str
    column: str
    unit: str
    form: str
    shaft: ShaftSpeed | None
    notices: tuple[str, ...]

    @property
    def speed(self) -> float | None:
        """Mean speed of the shaft [turns per second], where a column with its speed was asked for."""
        if self.shaft is None or self.rate is None:
            return None
        mean = self.shaft.per_sample(0, self.values.size)
        return None if mean is None else mean * self.rate


def read_signal(
    path: str | Path,
    *,
    column: str | None = None,
    time: str | None = None,
    rate: float | str | None = None,
    separator: str | None = None,
    decimal: str | None = None,
    skip: int = 0,
    missing: Sequence[str | float] = (),
    window: tuple[float, float] | None = None,
    speed: str | None = None,
) -> Signal:
    """Read one column of a file as an evenly spaced signal.

    Parameters
    ----------
    path : path
        A file of any format of `open_table`; ``-`` for text on standard input.
    column : str, optional
        Name or position from 1; may be left out where there is only one.
    time : str, optional
        Name or position of the time column, with its unit where the file says none: ``"t [ms]"``; ``none`` for no times.
    rate : float or str, optional
        Samples per second, or ``"25.6 kHz"``; where it contradicts the times, it is taken and that is said.
    separator, decimal, skip
        What is known of a text file.
    missing : sequence of str or float
        Values that mean that there is none: ``-999``; ``nan`` for whatever is no number, words and lines of text too.
    window : (float, float), optional
        Part of the record that is kept [s], by the file's own times; from its start where these are dates.
    speed : str, optional
        A column with the shaft's speed, or with pulses once per turn.

    Returns
    -------
    Signal
        ``values``, ``rate``, ``start``, ``shaft``; ``notices`` says what was skipped, filled, assumed or looks wrong.

    Raises
    ------
    InputError
        The file or an option cannot be understood; line, what was found and what to do are said.

    Notes
    -----
    The format is found from the first bytes; the table of a text file is the longest run of lines with one number of
    fields, at least one of them a number. Up to three missing samples in a row are filled by cubic interpolation; a longer
    gap ends the record, and its longest part is read.
    """
    given = samples_per_second(rate) if isinstance(rate, str) else rate
    words = words_are_missing(missing)
    with closing(open_table(path, separator=separator, decimal=decimal, skip=skip, words_missing=words)) as table:
        return _signal(table, column, time, given, missing, window, speed)


def _signal(
    table: Table,
    column: str | None,
    time: str | None,
    rate: float | None,
    missing: Sequence[str | float],
    window: tuple[float, float] | None,
    speed: str | None,
) -> Signal:
    at = find_column(table, column)
    clock = find_clock(table, time)
    tacho = None if speed is None else speed_column(table, speed)
    positions = [at, *(clock.positions if clock else ()), *([tacho] if tacho is not None else [])]
    unique = list(dict.fromkeys(positions))
    parts: list[list[NDArray[np.generic]]] = [block.values for block in table.blocks(unique)]
    joined = [np.concatenate(columns) for columns in zip(*parts, strict=True)] if parts else []
    if not joined or not joined[0].size:
        raise InputError(f"{table.source}: found no rows of numbers")
    loaded = dict(zip(unique, joined, strict=True))
    del parts, joined
    title = table.columns[at].title or f"column {at + 1}"
    if table.columns[at].kind in ("date", "clock"):
        raise InputError(f"{table.source}: found times in {title!r}, expected a column of numbers")
    notices = list(table.notices)
    whole = np.asarray(loaded[at], dtype=np.float64)
    values, counted = _without_count(table, whole, notices)
    if counted:
        loaded = {k: v[1:] for k, v in loaded.items()}

    def place(row: int) -> str:
        return table.place(row + counted)

    for k in clock.positions if clock else ():
        if table.absent.get(k) and table.absent[k].count:
            raise InputError(
                f"{table.source}, {table.place(table.absent[k].row)}: found {table.absent[k].text!r} in "
                f"column {k + 1},"
                " expected a time; --time none with --rate leaves the times out"
            )

    def refused(row: int, count: int) -> InputError:
        absent = table.absent.get(at)
        text = absent.text if absent and absent.count else str(values[row])
        return InputError(
            f"{table.source}, {place(row)}: found {text!r} in column {at + 1} ({count} such fields), expected a finite"
            " number; --missing nan leaves them out"
        )

    gone = is_missing(table.source, values, missing, notices, place, refused)
    grid = _grid(table, clock, loaded, rate, place, notices)
    sampled = grid.rate if grid else rate if rate is not None else table.rate
    if grid is None and rate is None and table.rate is not None and table.form.startswith("text"):
        notices.append(f"the rate is the one that the file declares, {table.rate:g} samples per second")
    start = grid.start if grid else 0.0
    present = np.flatnonzero(~gone)
    notices += suspects(values[present], lambda k: place(int(present[k])))
    pulses = None if tacho is None else np.asarray(loaded[tacho], dtype=np.float64)
    rows = np.arange(values.size) if grid is None or grid.rows is None else grid.rows
    index = np.arange(rows.size) if grid is None or grid.index is None else grid.index
    kept = ~gone[rows]
    values, offset = filled(values[rows][kept], np.asarray(index)[kept], notices)
    if sampled:
        start += offset / sampled
    if window is not None:
        values, start, cut = _window(table, values, sampled, start, window)
        offset += cut
    shaft = None
    if tacho is not None and pulses is not None:  # the speed may change within the record
        within = (index >= offset) & (index < offset + values.size)
        shaft = shaft_speed(table, tacho, index[within] - offset, pulses[rows[within]], sampled, notices)
    return Signal(values, sampled, start, table.source, title, table.columns[at].unit, table.form, shaft, tuple(notices))


def _without_count(table: Table, values: Array, notices: list[str]) -> tuple[Array, int]:
    """Leave out a first value that is the number of all others."""
    rest = values[1:]
    if len(table.columns) > 1 or table.columns[0].title or rest.size < 10 or values[0] != rest.size:
        return values, 0
    if values[0] <= 3 * np.abs(rest).max() and (rest == np.round(rest)).all():
        return values, 0  # it may be a value like the others
    notices.append(f"{table.place(0)} holds the number of samples, {values[0]:.0f}: skipped")
    return rest, 1


def _grid(
    table: Table,
    clock: Clock | None,
    loaded: dict[int, NDArray[np.generic]],
    rate: float | None,
    place: Callable[[int], str],
    notices: list[str],
) -> Grid | None:
    """Sampling by the times, compared with the rate that was given and the one that the file declares."""
    if clock is None:
        return None
    t, start, written = seconds_of(clock, [loaded[k] for k in clock.positions])
    try:
        grid = even_grid(clock, t, start, written, place)
    except InputError as fault:
        if rate is None:
            raise InputError(f"{table.source}: {fault}") from None
        notices.append(
            f"{str(fault).partition(', expected')[0]}; the samples are taken as evenly spaced, {rate:g} per second as "
            "--rate says"
        )
        return None
    notices += grid.notices
    for what, other in (("--rate", rate), ("the file itself", table.rate)):
        if other and abs(other / grid.rate - 1) > CONTRADICTS:
            taken = f"the rate of {what} is taken" if what == "--rate" else "the times are taken"
            notices.append(
                f"{place(0)} to {place(1)}: the time in {clock.name!r} steps by {1 / grid.rate:.6g} s, "
                f"{grid.rate:.6g} samples per"
                f" second, but {what} says {other:g}: {taken}"
            )
    if rate is None or abs(rate / grid.rate - 1) <= CONTRADICTS:
        return grid if rate is None else replace(grid, rate=rate)
    return Grid(rate, 0.0)


def _window(
    table: Table, values: Array, rate: float | None, start: float, window: tuple[float, float]
) -> tuple[Array, float, int]:
    """Values in the window, time of the first, and samples before it."""
    if not rate:
        raise InputError("--window: found it without a rate, expected --rate or a time column, for it is in seconds")
    end = start + values.size / rate
    first, last = (round((edge - start) * rate) for edge in (max(window[0], start), min(window[1], end)))
    if last - first < 1:
        raise InputError(
            f"--window: found {window[0]:g}:{window[1]:g}, but {table.source} goes from {start:.6g} to {end:.6g} s"
        )
    return values[first:last], start + first / rate, first
