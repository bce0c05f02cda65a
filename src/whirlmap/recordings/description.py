"""Description of a file as plain data: format, columns, ranges, rate and warnings."""

from collections.abc import Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np

from whirlmap.errors import InputError
from whirlmap.recordings.clock import find_clock, seconds_of
from whirlmap.recordings.even_grid import even_grid
from whirlmap.recordings.fields import NUMBER
from whirlmap.recordings.open_table import open_table
from whirlmap.recordings.table import Table


def describe_file(
    path: str | Path, *, time: str | None = None, separator: str | None = None, decimal: str | None = None, skip: int = 0
) -> dict[str, Any]:
    """Format, rows, columns with unit and range, and rate of a file.

    Parameters
    ----------
    path, time, separator, decimal, skip
        As in `signal.read_signal`.

    Returns
    -------
    dict
        ``file``, ``form``, ``rows``, ``columns`` (each with ``position``, ``name``, ``unit``, ``kind``, ``minimum``,
        ``maximum``, ``missing``), ``time``, ``rate``, ``start``, ``warnings``.
    """
    with closing(open_table(path, separator=separator, decimal=decimal, skip=skip, words_missing=True)) as table:
        return _described(table, time)


def _described(table: Table, time: str | None) -> dict[str, Any]:
    clock = find_clock(table, time)
    numbers = [k for k, c in enumerate(table.columns) if c.kind == NUMBER]
    wanted = list(dict.fromkeys([*numbers, *(clock.positions if clock else ())]))
    same = [k for k in wanted if len(table.first_rows[k])]
    lows: dict[int, float] = {}
    highs: dict[int, float] = {}
    counts = dict.fromkeys(wanted, 0)
    kept: dict[int, list[Any]] = {k: [] for k in (clock.positions if clock else ())}
    for values in _columns(table, same):
        for k, v in values.items():
            counts[k] += v.size
            if k in kept:
                kept[k].append(v)
            if v.dtype.kind == "f" and np.isfinite(v).any():
                lows[k] = min(lows.get(k, np.inf), float(np.nanmin(v)))
                highs[k] = max(highs.get(k, -np.inf), float(np.nanmax(v)))
    notices, rate, start = list(table.notices), table.rate, None
    if clock:
        t, start, written = seconds_of(clock, [np.concatenate(kept[k]) for k in clock.positions])
        try:
            grid = even_grid(clock, t, start, written, table.place)
            rate = grid.rate
            notices += grid.notices
        except InputError as fault:
            rate = None
            notices.append(str(fault))
    notices += [
        f"column {k + 1}, {table.columns[k].title!r}, is constant at {lows[k]:.6g}: there is no motion in it"
        for k in numbers
        if counts[k] > 1 and k in lows and lows[k] == highs[k]
    ]
    columns = [
        {
            "position": k + 1,
            "name": c.title,
            "unit": c.unit,
            "kind": c.kind,
            "minimum": lows.get(k),
            "maximum": highs.get(k),
            "missing": table.absent[k].count if k in table.absent else 0,
            "first_missing": table.place(table.absent[k].row) if k in table.absent and table.absent[k].count else None,
        }
        for k, c in enumerate(table.columns)
    ]
    return {
        "file": table.source,
        "form": table.form,
        "rows": max(counts.values(), default=0),
        "columns": columns,
        "time": clock.name if clock else None,
        "rate": rate,
        "start": start,
        "warnings": notices,
    }


def _columns(table: Any, positions: Sequence[int]) -> Any:
    """Blocks as a mapping; columns of a binary file may differ in length, and are read one by one."""
    if hasattr(table, "arrays"):
        for k in positions:
            for block in table.blocks([k]):
                yield {k: block.values[0]}
        return
    for block in table.blocks(positions):
        yield dict(zip(positions, block.values, strict=True))
