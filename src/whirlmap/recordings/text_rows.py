"""Rows of a text table: fields of a line, comments, and the longest run of lines that look alike."""

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from whirlmap.recordings.fields import EMPTY, NUMBER, TEXT, kind_of

_MARKS = ("#", "%", "//", "!", '"#', "'")


@dataclass(frozen=True)
class Run:
    """Consecutive lines with fields of the same kinds."""

    separator: str | None
    decimal: str
    first: int
    kinds: tuple[str, ...]
    rows: int

    @property
    def score(self) -> float:
        """Rows, less the share of fields that are words."""
        return self.rows * sum(k != TEXT for k in self.kinds) / len(self.kinds)


def split(line: str, separator: str | None) -> list[str]:
    """Fields of a line, without blanks and quotes around them."""
    if "\u2212" in line:  # the minus of typographers
        line = line.replace("\u2212", "-")
    if separator is None:
        return [f.strip("\"'") for f in line.split()]
    if '"' in line:
        return [
            f.strip()
            for f in next(
                csv.reader([line.strip()] if separator != "\t" else [line], delimiter=separator, skipinitialspace=True)
            )
        ]
    return [f.strip(" '\t\r\u00a0\u202f") for f in line.rstrip("\r\n").split(separator)]


def is_comment(line: str, decimal: str = ".") -> bool:
    """Whether a line holds no row: empty, or begins with a comment mark; ``;`` is one only before words."""
    text = line.strip(" \t\r\n\ufeff\x1a\x0c")
    if not text:
        return not line.strip(" \r\n\ufeff\x1a\x0c") or not line.strip()
    if text.startswith(";"):
        head = text.lstrip(";").split(";")[0].strip()
        return kind_of(head, decimal) == TEXT
    return text.startswith(_MARKS[:5]) or (
        text.startswith("'") and kind_of(text.split("'")[1] if text.count("'") > 1 else "x", decimal) == TEXT
    )


def longest_run(lines: Sequence[str], separator: str | None, decimal: str) -> Run | None:
    """Find the longest run under one separator and decimal mark; None where no line has a number."""
    best: Run | None = None
    run: Run | None = None
    for k, line in enumerate(lines):
        if not line.strip() or is_comment(line, decimal):
            continue
        kinds = tuple(kind_of(f, decimal) for f in split(line, separator))
        merged = _merged(run.kinds, kinds) if run else None
        if run and merged:
            run = replace(run, kinds=merged, rows=run.rows + 1)
        else:
            run = Run(separator, decimal, k, kinds, 1)
        if NUMBER in run.kinds and (best is None or run.score > best.score):
            best = run
    return best


def _merged(a: tuple[str, ...], b: tuple[str, ...]) -> tuple[str, ...] | None:
    """Kinds of two rows together, None where they cannot be rows of one table."""
    if len(a) != len(b) or NUMBER not in b:
        return None
    both = [x if x == y or y == EMPTY else y if x == EMPTY else None for x, y in zip(a, b, strict=True)]
    return None if None in both else tuple(str(k) for k in both)


def from_its_start(run: Run, lines: Sequence[str]) -> Run:
    """The run with what belongs to the same table above it, where a line that does not fit has cut it."""
    for k, line in enumerate(lines[: run.first]):
        if line.strip() and not is_comment(line, run.decimal):
            kinds = tuple(kind_of(f, run.decimal) for f in split(line, run.separator))
            if len(kinds) == len(run.kinds) and kinds[0] == run.kinds[0] and _merged(run.kinds, kinds):
                return replace(run, first=k)
    return run


def header_fields(line: str, separator: str | None) -> list[str]:
    """Fields of a line of names, without its comment mark; names over blanks may have units with blanks."""
    text = line.strip("\r\n\ufeff")
    marked = text.strip(" ").lstrip("#%!/" if separator == "/" else "#%!/;") if is_comment(text) else text
    if separator is None and any(
        mark in marked for mark in "[(\t,;"
    ):  # names with blanks in their units, or other separators
        for other in ("\t", ",", ";"):
            if other in marked:
                return [f.strip() for f in split(marked.strip(), other)]
        return re.findall(r"[^\s\[(]+(?:\s*[\[(][^\])]*[\])])?", marked)
    return [f.strip() for f in split(marked.strip() if is_comment(text) else marked, separator)]


def fields_per_line(text: str, separator: str | None) -> int:
    """Fields of every line, -1 where lines differ."""
    data = np.frombuffer(text.encode("utf-8", errors="replace"), dtype=np.uint8)
    ends = np.flatnonzero(data == 10)
    if separator is None:
        blank = (data == 32) | (data == 9) | (data == 13) | (data == 10)
        marks = np.flatnonzero(~blank & np.r_[True, blank[:-1]])
    else:
        marks = (
            np.flatnonzero(data == ord(separator)) if len(separator) == 1 and ord(separator) < 128 else np.zeros(0, np.intp)
        )
    counts = np.diff(np.searchsorted(marks, ends), prepend=0)
    if not counts.size or (counts != counts[0]).any():
        return -1
    return int(counts[0]) + (separator is not None)
