"""Layout of the table in a text file: separator, decimal mark, first row, names, units, rate.

The *body* is the longest run of lines with one number of fields under one separator, at least one of them a number. The
line above it has the names; what lies above that is skipped, and said.
"""

import re
from collections.abc import Sequence

from whirlmap.errors import InputError
from whirlmap.recordings.decimal_comma import decimal_comma
from whirlmap.recordings.text_names import Layout, with_names
from whirlmap.recordings.text_rows import from_its_start, longest_run

#: Separators that are tried, in this order; None is any number of blanks.
SEPARATORS: tuple[str | None, ...] = ("\t", ";", "|", ",", None)
#: Lines at the top of a file in which the body is sought.
SOUGHT = 3000
NAMED = {"\t": "tabs", ";": "semicolons", ",": "commas", "|": "bars", None: "blanks"}


def find_layout(
    lines: Sequence[str], source: str, *, separator: str | None = None, decimal: str | None = None, skip: int = 0
) -> Layout:
    """Find the table in the first lines of a file.

    Parameters
    ----------
    lines : sequence of str
    source : str
        Name of the file, for messages.
    separator, decimal : str, optional
        What is known of them; ``"blank"`` for blanks.
    skip : int
        Lines at the top that are not looked at.

    Raises
    ------
    InputError
        No rows of numbers; names and fields that differ in number; a comma that may be either mark.
    """
    lines = ["" if k < skip else line for k, line in enumerate(lines[: SOUGHT + skip])]
    if not any(line.strip() for line in lines):
        raise InputError(f"{source}: found nothing, expected rows of numbers")
    for line in lines[skip : skip + 3]:  # Excel's way of naming the separator
        if separator is None and (named := re.fullmatch(r'"?sep=(.|\\t)"?', line.strip("\ufeff\r\n "))):
            separator = named[1].replace("\\t", "\t")
            lines[lines.index(line)] = ""
    separators = SEPARATORS if separator is None else (None if separator in ("blank", " ") else separator,)
    decimals = (".", ",") if decimal is None else (decimal,)
    quoted, commas = (any(mark in line for line in lines) for mark in ('"', ","))
    runs = [
        run
        for s in separators
        if s is None or any(s in line for line in lines)
        for d in decimals
        if (s != d or quoted) and (d == "." or commas) and (run := longest_run(lines, s, d))
    ]
    if not runs:
        names = next(line.strip() for line in lines if line.strip())
        raise InputError(
            f"{source}: found {names[:60]!r} and no rows of numbers; --separator, --decimal and --skip say how to read it"
        )
    best = max(runs, key=lambda run: run.score)
    if separator is None and decimal is None:
        best = decimal_comma(best, runs, lines, source)
    return with_names(from_its_start(best, lines), lines, source)
