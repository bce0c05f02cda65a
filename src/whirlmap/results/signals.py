"""Recorded signals as text files of columns: reading one, writing a simulation."""

import csv
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from whirlmap.errors import InputError, nearest
from whirlmap.results.files import replace_file

if TYPE_CHECKING:
    import xarray as xr

#: Separators that are tried on the first lines of a file, in this order.
SEPARATORS = (";", "\t", ",")


def read_column(path: str | Path, column: str | None = None) -> NDArray[np.float64]:
    """Read one column of numbers from a CSV file.

    Parameters
    ----------
    path : path
        Text in UTF-8, values separated by semicolons, tabs, commas or blanks; a first line of names; empty lines and
        lines that begin with # are skipped.
    column : str, optional
        Its name, or its number from 1. May be left out where there is only one.

    Returns
    -------
    array, shape (row,)

    Raises
    ------
    InputError
        The file cannot be read as text, holds no numbers, has no such column, or a row of it holds no finite number; the
        line is named.
    """
    place = Path(path)
    try:
        text = place.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise InputError(f"{place}: cannot be read ({error.strerror})") from None
    except UnicodeDecodeError:
        raise InputError(f"{place}: found bytes that are no text, expected a CSV file in UTF-8") from None
    lines = [(i, line) for i, line in enumerate(text.splitlines(), 1) if line.strip() and not line.lstrip().startswith("#")]
    if not lines:
        raise InputError(f"{place}: found nothing, expected rows of numbers")
    separator = next((s for s in SEPARATORS if s in lines[0][1]), None)
    rows = [(i, _fields(line, separator)) for i, line in lines]
    head = rows[0][1]
    names = [] if any(_number(field) is not None for field in head) else head
    if names:
        rows = rows[1:]
    if not rows:
        raise InputError(f"{place}: found the names {', '.join(names)} and no rows of numbers")
    index = _index(place, column, names, len(rows[0][1]))
    values = np.empty(len(rows))
    for k, (i, fields) in enumerate(rows):
        if index >= len(fields):
            raise InputError(f"{place}, line {i}: found {len(fields)} columns, expected at least {index + 1}")
        value = _number(fields[index])
        if value is None or not np.isfinite(value):
            raise InputError(f"{place}, line {i}: found {fields[index]!r} in column {index + 1}, expected a finite number")
        values[k] = value
    return values


def has_column(path: str | Path, name: str) -> bool:
    """Whether a file has a column of this name."""
    try:
        read_column(path, name)
    except InputError as fault:
        if "there is no column" in str(fault):
            return False
        raise
    return True


def rate_of(path: str | Path) -> float:
    """Samples per unit of the column ``time``.

    Raises
    ------
    InputError
        Where the times do not ascend by equal steps (to 1e-6 of one).
    """
    time = read_column(path, "time")
    steps = np.diff(time)
    if steps.size == 0 or steps.mean() <= 0 or np.ptp(steps) > 1e-6 * steps.mean():
        raise InputError(f"{path}: found times that do not ascend by equal steps, expected an evenly sampled signal")
    return float(1 / steps.mean())


def write_series(ds: "xr.Dataset", path: str | Path, *, force: bool = False) -> Path:
    """Write time, states and outputs of a simulation as CSV, complete or not at all; `read_column` reads it back exactly.

    The first line is a comment with the unit of each column, the second has their names.

    Raises
    ------
    OutputError
        See `whirlmap.results.files.check_writable`.
    """
    names, units, columns = ["time"], [str(ds["time"].attrs.get("units", "1"))], [ds["time"].values]
    for key, dim in (("x", "state"), ("outputs", "output")):
        each = str(ds[key].attrs.get("unit_of_each", "")).split()
        names += [str(name) for name in ds[dim].values]
        units += each if len(each) == ds.sizes[dim] else [str(ds[key].attrs.get("units", "1"))] * ds.sizes[dim]
        columns += list(ds[key].transpose(dim, "time").values)
    head = f"# units: {','.join(units)}\n{','.join(names)}"

    def fill(trial: Path) -> None:
        np.savetxt(trial, np.column_stack(columns), fmt="%.17g", delimiter=",", header=head, comments="", encoding="utf-8")

    return replace_file(Path(path), fill, force=force)


def _fields(line: str, separator: str | None) -> list[str]:
    if separator is None:
        return line.split()
    return [field.strip() for field in next(csv.reader([line], delimiter=separator))]


def _number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None


def _index(place: Path, column: str | None, names: list[str], count: int) -> int:
    if column is None:
        if count > 1:
            known = f": {', '.join(names)}" if names else f", 1 to {count}"
            raise InputError(f"{place}: found {count} columns, expected --column to say which{known}")
        return 0
    if column in names:
        return names.index(column)
    if column.isdigit() and 1 <= int(column) <= max(count, len(names)):
        return int(column) - 1
    known = f"\n  columns: {', '.join(names)}" if names else f"\n  columns: 1 to {count}, without names"
    raise InputError(f"{place}: there is no column {column!r}.{nearest(column, names)}{known}")
