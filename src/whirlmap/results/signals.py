"""Recorded signals: reading a column, writing a simulation as a text table."""

from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from whirlmap.errors import InputError
from whirlmap.recordings.clock import find_clock
from whirlmap.recordings.open_table import open_table
from whirlmap.recordings.signal import read_signal
from whirlmap.results.files import replace_file

if TYPE_CHECKING:
    import xarray as xr


def read_column(path: str | Path, column: str | None = None) -> NDArray[np.float64]:
    """Read one column of numbers of a file; see `whirlmap.recordings.signal.read_signal`, which also says what is odd.

    Raises
    ------
    InputError
        The file or the column cannot be read; the line is named.
    """
    return read_signal(path, column=column, time="none").values


def rate_of(path: str | Path) -> float:
    """Samples per second by the times of a file.

    Raises
    ------
    InputError
        There are none, or they do not ascend by equal steps.
    """
    with closing(open_table(path)) as table:
        clock = find_clock(table, None)
    if clock is None:
        raise InputError(f"{path}: found no column of times")
    found = read_signal(path, column=str(clock.positions[0] + 1)).rate
    if found is None:
        raise InputError(f"{path}: found no rate")
    return found


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
