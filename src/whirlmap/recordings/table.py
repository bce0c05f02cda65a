"""A table of a file, whatever its format: columns with names and units, read block by block."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from whirlmap.errors import InputError, nearest
from whirlmap.recordings.column_names import split_unit

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Column:
    """One column.

    Attributes
    ----------
    title : str
        As it stands in the file, or nothing.
    name, unit : str
        The two parts of the title; the unit may come from a row of units.
    kind : str
        ``number``, ``date``, ``clock``, ``empty`` or ``text``, as in `fields`.
    """

    title: str
    name: str
    unit: str
    kind: str

    @classmethod
    def of(cls, title: str, kind: str, unit: str = "") -> "Column":
        """Make a column from its title; a unit of a row of its own wins."""
        name, written = split_unit(title)
        return cls(title, name, unit or written, kind)


@dataclass
class Absent:
    """Fields of a column that hold no number: how many, and where the first one stands."""

    count: int = 0
    row: int = -1
    text: str = ""


@dataclass(frozen=True)
class Block:
    """Some consecutive rows of the columns asked for.

    Attributes
    ----------
    values : list of array, shape (row,)
        Floats, NaN where there is no number; nanoseconds as int64 for dates and clock times.
    """

    values: list[NDArray[np.generic]]


class Table(Protocol):
    """What every format gives; a file is open until `close`."""

    source: str
    notices: list[str]
    absent: dict[int, Absent]

    @property
    def form(self) -> str:
        """Format in words."""
        ...

    @property
    def columns(self) -> tuple[Column, ...]:
        """Columns, in the order of the file."""
        ...

    @property
    def rate(self) -> float | None:
        """Samples per second that the file declares."""
        ...

    @property
    def first_rows(self) -> list[Array]:
        """First rows of every column, NaN where there is no number."""
        ...

    def close(self) -> None:
        """Close the file."""
        ...

    def blocks(self, positions: Sequence[int]) -> Iterator[Block]:
        """Read columns, once."""
        ...

    def place(self, row: int) -> str:
        """Where a row stands: ``line 17``."""
        ...


def find_column(table: Table, wanted: str | None, option: str = "--column") -> int:
    """Position of a column, from 0.

    Raises
    ------
    InputError
        There is no such column, two have the name, or none is named and there are several.
    """
    known = [c.title or str(k) for k, c in enumerate(table.columns, 1)]
    shown = ", ".join(known) if any(c.title for c in table.columns) else f"1 to {len(known)}, without names"
    if wanted is None:
        if len(known) == 1:
            return 0
        raise InputError(f"{table.source}: found {len(known)} columns, expected {option} to say which: {shown}")
    wanted = wanted.strip()
    titles = [c.title for c in table.columns]
    for names in (
        titles,
        [c.name for c in table.columns],
        [t.lower() for t in titles],
        [c.name.lower() for c in table.columns],
    ):
        at = [
            k
            for k, name in enumerate(names)
            if name == (wanted if names is titles else wanted.lower() if name.islower() else wanted)
        ]
        if len(at) > 1:
            numbers = " and ".join(str(k + 1) for k in at)
            raise InputError(
                f"{table.source}: found the name {wanted!r} at columns {numbers}, expected one; give the position, as in"
                f" {option} {at[0] + 1}"
            )
        if at and not (wanted.isdigit() and 1 <= int(wanted) <= len(known)):
            return at[0]
    if wanted.isdigit() and 1 <= int(wanted) <= len(known):
        return int(wanted) - 1
    raise InputError(f"{table.source}: there is no column {wanted!r}.{nearest(wanted, titles)}\n  columns: {shown}")


@dataclass
class ArrayTable:
    """A table whose columns are arrays of a binary file, or what NumPy reads as such from a file that is open."""

    source: str
    form: str
    columns: tuple[Column, ...]
    arrays: list[Any]
    rate: float | None = None
    notices: list[str] = field(default_factory=list)
    absent: dict[int, Absent] = field(default_factory=dict)
    closing: Callable[[], None] | None = None

    @property
    def first_rows(self) -> list[Array]:
        """First rows of every column."""
        return [np.asarray(a[:200], dtype=np.float64) for a in self.arrays]

    def load(self) -> None:
        """Read all columns, and close the file."""
        self.arrays = [np.asarray(a) for a in self.arrays]
        self.close()

    def close(self) -> None:
        """Close the file, where one is open."""
        if self.closing is not None:
            self.closing()
            self.closing = None

    def blocks(self, positions: Sequence[int]) -> Iterator[Block]:
        """Give the columns, of one length, as one block."""
        sizes = {self.arrays[k].size for k in positions}
        if len(sizes) > 1:
            raise InputError(
                f"{self.source}: found columns of {' and '.join(map(str, sorted(sizes)))} values, expected one length"
            )
        values = [np.asarray(self.arrays[k], dtype=np.float64) for k in positions]
        for k, v in zip(positions, values, strict=True):
            bad = np.flatnonzero(~np.isfinite(v))
            if bad.size:
                self.absent[k] = Absent(bad.size, int(bad[0]), str(v[bad[0]]))
        yield Block(list(values))

    def place(self, row: int) -> str:
        """``sample 17``."""
        return f"sample {row + 1}"
