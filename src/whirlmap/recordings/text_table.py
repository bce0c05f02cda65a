"""Reading of a table in text, in pieces: only the requested columns stay in memory.

pandas reads a piece whose lines all have the right number of fields and whose wanted fields all are numbers. Any other
piece is gone through line by line, and what does not fit is named with its line.
"""

import io
import re
import warnings
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import IO

import numpy as np
from numpy.typing import NDArray

from whirlmap.errors import InputError, counted
from whirlmap.recordings.fields import ABSENT, CLOCK, DATE, EMPTY, NUMBER, TEXT, kind_of, nanoseconds, number_of
from whirlmap.recordings.table import Absent, Array, Block, Column
from whirlmap.recordings.text_layout import NAMED, SOUGHT, find_layout
from whirlmap.recordings.text_names import Layout
from whirlmap.recordings.text_rows import fields_per_line, is_comment, split

#: Characters of one piece.
PIECE = 1 << 22
#: Different words that are named where they are taken as missing values.
SHOWN_WORDS = 5
NOT_A_TIME = np.iinfo(np.int64).min


@dataclass
class TextTable:
    """A table in text; see `table.Table`."""

    source: str
    layout: Layout
    head: list[str]
    stream: IO[str]
    #: Whether words among the numbers are missing values, and lines of text among the rows are skipped.
    words_missing: bool = False
    absent: dict[int, Absent] = field(default_factory=dict)
    notices: list[str] = field(default_factory=list)
    #: Row from which on, and line of that row, wherever lines were left out.
    _rows: list[int] = field(default_factory=list)
    _lines: list[int] = field(default_factory=list)
    _footer: list[tuple[int, str]] = field(default_factory=list)
    _comments: list[tuple[int, str]] = field(default_factory=list)
    _texts: list[tuple[int, str]] = field(default_factory=list)
    #: Position of a column and a word in it -> line of the first one, and how many.
    _words: dict[tuple[int, str], tuple[int, int]] = field(default_factory=dict)

    @property
    def columns(self) -> tuple[Column, ...]:
        """Columns, as the layout has them."""
        return self.layout.columns

    @property
    def rate(self) -> float | None:
        """Rate that the lines above the table declare."""
        return self.layout.rate

    @property
    def form(self) -> str:
        """The layout in words."""
        mark = "point" if self.layout.decimal == "." else "comma"
        between = (
            ""
            if len(self.columns) == 1
            else f"fields separated by {NAMED.get(self.layout.separator, repr(self.layout.separator))}, "
        )
        return f"text, {between}decimal {mark}, table from line {self.layout.first + 1}"

    @property
    def first_rows(self) -> list[Array]:
        """First rows of every column."""
        rows = [
            split(x, self.layout.separator)
            for x in self.head[self.layout.first : self.layout.first + 200]
            if not is_comment(x)
        ]
        rows = [row for row in rows if len(row) == self.layout.fields]
        return [np.array([_value(row[k], self.layout.decimal) for row in rows]) for k in range(len(self.columns))]

    def place(self, row: int) -> str:
        """``line 17``."""
        at = bisect_right(self._rows, row) - 1
        return f"line {self._lines[at] + row - self._rows[at]}" if at >= 0 else f"row {row + 1}"

    def close(self) -> None:
        """Close the file."""
        self.stream.close()

    def blocks(self, positions: Sequence[int]) -> Iterator[Block]:
        """Read columns, once, piece by piece.

        Raises
        ------
        InputError
            A line has another number of fields, or text where a number should be; the line is named.
        """
        line, row = self.layout.first + 1, 0
        self.absent.update({p: Absent() for p in positions})
        for lines, ended in self._pieces():
            values = self._fast(lines, positions) if not self._footer else None
            at: Sequence[int] = range(line, line + len(lines))
            if values is None:
                values, at = self._slow(lines, line, row, positions, ended)
            for k, number in enumerate(at) if not isinstance(at, range) else ((0, line),):
                if not self._rows or number - self._lines[-1] != row + k - self._rows[-1]:
                    self._rows.append(row + k)
                    self._lines.append(number)
            line += len(lines)
            row += len(at)
            yield Block(values)
        for kind, skipped in (("a comment", self._comments), ("text", self._texts)):
            if skipped:
                first, text = skipped[0]
                more = f" ({len(skipped)} such lines)" if len(skipped) > 1 else ""
                how = " with --missing nan" if kind == "text" else ""
                self.notices.append(f"line {first}: {kind} within the table, {text[:40]!r}, skipped{how}{more}")
        for (p, word), (first, count) in list(self._words.items())[:SHOWN_WORDS]:
            self.notices.append(
                f"line {first}: {word[:40]!r} in column {p + 1} is no number ({counted(count, 'such field')}): missing with"
                " --missing nan"
            )
        if len(self._words) > SHOWN_WORDS:
            self.notices.append(f"{len(self._words) - SHOWN_WORDS} other words are no numbers either")
        if self._footer:
            first, text = self._footer[0]
            self.notices.append(
                f"{_lines(first, self._footer[-1][0])} after the table, beginning with {text[:40]!r}, skipped"
            )

    def _pieces(self) -> Iterator[tuple[list[str], bool]]:
        lines, rest = self.head[self.layout.first :], True
        while rest:
            text = self.stream.read(PIECE)
            rest = bool(text)
            if text and not text.endswith("\n"):
                text += self.stream.readline()
            if not rest and lines and not lines[-1]:
                lines.pop()
            if lines:
                yield lines, not rest
            lines = text.split("\n")
            if lines and not lines[-1]:
                lines.pop()

    def _fast(self, lines: list[str], positions: Sequence[int]) -> list[NDArray[np.generic]] | None:
        """Columns of a piece without surprises, else None."""
        text = "\n".join(lines) + "\n"
        separator = self.layout.separator
        if '"' in text or "'" in text or fields_per_line(text, separator) != self.layout.fields:
            return None
        import pandas as pd

        # A word in the first column tells a footer, or a line of text, from a row.
        read = sorted({*positions, 0} if self.columns[0].kind == NUMBER else set(positions))
        kinds = {p: "float64" if self.columns[p].kind in (NUMBER, EMPTY) else "str" for p in read}
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                frame = pd.read_csv(
                    io.StringIO(text),
                    sep=r"\s+" if separator is None else separator,
                    decimal=self.layout.decimal,
                    header=None,
                    usecols=read,
                    dtype=kinds,
                    na_filter=False,
                    quoting=3,
                    skipinitialspace=True,
                    skip_blank_lines=False,
                    engine="c",
                )
        except (ValueError, OverflowError, Warning):
            return None
        if len(frame) != len(lines):
            return None
        columns: list[NDArray[np.generic]] = []
        for p in positions:
            found = frame[p].to_numpy()
            if kinds[p] == "str":
                stamps = [nanoseconds(f.strip()) for f in found]
                if None in stamps:
                    return None
                found = np.array(stamps, dtype=np.int64)
            elif not np.isfinite(found).all():
                return None
            columns.append(found)
        return columns

    def _slow(
        self, lines: list[str], first: int, row: int, positions: Sequence[int], ended: bool
    ) -> tuple[list[NDArray[np.generic]], list[int]]:
        """Columns of a piece line by line, and the line of each row."""
        layout = self.layout
        rows: list[list[str]] = []
        at: list[int] = []
        for k, text in enumerate(lines, first):
            if is_comment(text, layout.decimal):
                if text.strip():
                    self._comments.append((k, text.strip()))
                continue
            fields = split(text, layout.separator)
            if self._is_footer(fields):
                self._footer.append((k, text.strip()))
                continue
            if self._footer:  # it was none: the table goes on
                self._resume(rows, at)
            if len(fields) != layout.fields:
                last = ended and k == first + len(lines) - 1
                if last and len(fields) < layout.fields and len(lines) > 2:
                    self.notices.append(
                        f"line {k}, the last one, has {len(fields)} fields instead of {layout.fields} (cut off?): skipped"
                    )
                    continue
                raise InputError(
                    f"{self.source}, line {k}: found {counted(len(fields), 'column')}, {text.strip()[:60]!r}, expected"
                    f" {layout.fields} as above; correct the line, or give --separator or --skip"
                )
            rows.append(fields)
            at.append(k)
        values: list[NDArray[np.generic]] = []
        for p in positions:
            times = self.columns[p].kind in (DATE, CLOCK)
            made = [nanoseconds(r[p]) if times else _value(r[p], layout.decimal) for r in rows]
            absent = self.absent[p]
            for j, v in enumerate(made):
                if v is None or v != v:
                    field_text = rows[j][p]
                    if times or field_text.lower() not in ABSENT:
                        if times or not self.words_missing:
                            raise InputError(
                                f"{self.source}, line {at[j]}: found {field_text[:60]!r} in column {p + 1}, expected a"
                                + (" time" if times else " finite number; --missing nan takes words as missing values")
                            )
                        begun, count = self._words.get((p, field_text), (at[j], 0))
                        self._words[p, field_text] = begun, count + 1
                    if not absent.count:
                        absent.row, absent.text = row + j, field_text
                    absent.count += 1
            values.append(np.array(made, dtype=np.int64 if times else np.float64))
        return values, at

    def _is_footer(self, fields: list[str]) -> bool:
        """Whether a line is none of the table: words where its first column has numbers."""
        kind = kind_of(fields[0], self.layout.decimal)
        return kind == TEXT and self.columns[0].kind != TEXT

    def _resume(self, rows: list[list[str]], at: list[int]) -> None:
        """Lines that looked like a footer, and are followed by rows: rows with a word, or lines of text, if these may be."""
        if not self.words_missing:
            self._complain_about_footer()
        for k, text in self._footer:
            fields = split(text, self.layout.separator)
            numbers = any(kind_of(f, self.layout.decimal) == NUMBER for f in fields)
            if len(fields) == self.layout.fields and (numbers or len(fields) == 1):
                rows.append(fields)
                at.append(k)
            else:
                self._texts.append((k, text))
        self._footer.clear()

    def _complain_about_footer(self) -> None:
        k, text = self._footer[0]
        raise InputError(
            f"{self.source}, line {k}: found {text[:60]!r} in the middle of the table, expected a row of "
            "numbers;"
            f" several tables in one file? --skip {k} reads the one below; --missing nan leaves lines of text out"
        )


def open_text_table(
    stream: IO[str], source: str, *, separator: str | None = None, decimal: str | None = None, skip: int = 0,
    words_missing: bool = False,
) -> TextTable:
    """Find the table in a stream of text; see `text_layout.find_layout`."""
    head: list[str] = []
    while len(head) < SOUGHT + skip and (line := stream.readline(1 << 20)):
        head.append(line.rstrip("\n"))
    if re.match(r"\s*(\{|<|\[\s*[\[{]|\[\s*-?\d[\d.eE+-]*\s*,)", head[0] if head else ""):
        raise InputError(f"{source}: found JSON or markup, {head[0].strip()[:40]!r}, expected a table in text")
    layout = find_layout(head, source, separator=separator, decimal=decimal, skip=skip)
    return TextTable(source, layout, head, stream, words_missing, notices=list(layout.notices))


def _value(field_text: str, decimal: str) -> float:
    value = number_of(field_text, decimal)
    return float("nan") if value is None else value


def _lines(first: int, last: int) -> str:
    return f"line {first}" if first == last else f"lines {first} to {last}"
