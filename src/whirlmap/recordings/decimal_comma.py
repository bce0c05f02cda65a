"""Whether the commas between whole numbers are decimal marks or separators."""

import re
from collections.abc import Sequence
from itertools import pairwise

from whirlmap.errors import InputError
from whirlmap.recordings.fields import TEXT, kind_of
from whirlmap.recordings.text_rows import Run, header_fields, is_comment, split


def decimal_comma(best: Run, runs: Sequence[Run], lines: Sequence[str], source: str) -> Run:
    """Say whether the commas between whole numbers are decimal marks.

    ``11,8`` may be one number or two. Names above, a first column that counts, ``-0,5`` and ``3,05`` tell; where nothing
    does, nothing is guessed.
    """
    one = next((r for r in runs if r.separator is None and r.decimal == "," and len(r.kinds) == 1), None)
    if (
        best.separator == ","
        and len(best.kinds) > 2
        and not counts([split(x, ",")[0] for x in lines[best.first : best.first + 50]])
    ):
        rows = [split(line, ",") for line in lines[best.first :] if line.strip()]
        if all(re.fullmatch(r"[+-]?\d+", f) for row in rows[:50] for f in row) and any("-0" in row for row in rows):
            raise InputError(
                f"{source}: found commas that are both decimal marks and separators ('-0' is no whole "
                "number), expected"
                " one meaning; write the table with semicolons"
            )
    if one is None or best not in (one, *[r for r in runs if r.separator == ","]) or one.rows < 2:
        return best
    two = next((r for r in runs if r.separator == "," and len(r.kinds) == 2), None)
    named = names_above(min(one.first, two.first) if two else 0, lines, ",")
    if two and len(named) == 2 and all(kind_of(n, ".") == TEXT for n in named):
        return two
    if two is None or one.rows > two.rows:
        return one if one.score >= best.score else best
    rows = [split(line, ",") for line in lines[two.first :] if line.strip() and not is_comment(line)]
    rows = [row for row in rows if len(row) == 2]
    names = names_above(two.first, lines, ",")
    if len(names) == 1 and kind_of(names[0], ".") == TEXT:
        return two if counts([row[0] for row in rows], 1) else one
    after = [row[1] for row in rows]
    if len(names) == 2 or counts([row[0] for row in rows]) or any(not f.isdigit() for f in after):
        return two
    if any(row[0] == "-0" for row in rows) or any(len(f) > 1 and f.startswith("0") for f in after):
        return one
    widths = {len(f) for f in after}
    if len(widths) > 1 and any(f.endswith("0") and f != "0" for f in after):
        return two
    raise InputError(
        f"{source}: found rows such as {lines[two.first].strip()!r}, one number with a decimal comma or two "
        "whole numbers;"
        " expected --decimal , or --separator , to say which"
    )


def counts(fields: Sequence[str], first: int | None = None) -> bool:
    """Whether the fields are whole numbers that ascend by equal steps."""
    try:
        numbers = [int(f) for f in fields[:200]]
    except ValueError:
        return False
    step = numbers[1] - numbers[0] if len(numbers) > 1 else 0
    even = step > 0 and all(b - a == step for a, b in pairwise(numbers))
    return even and first in (None, numbers[0])


def names_above(first: int, lines: Sequence[str], separator: str | None) -> list[str]:
    """Fields of the nearest line above the body, without comment marks and labels."""
    above = next((line for line in reversed(lines[:first]) if line.strip()), "")
    return header_fields(above, separator)
