"""How a text file lays out its table: separator, decimal mark, first row, names, units, rate.

The *body* is the longest run of lines with one number of fields under one separator, at least one of them a number. The
line above it has the names; what lies above that is skipped, and said.
"""

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from whirlmap.errors import InputError
from whirlmap.recordings.column_names import is_time, is_unit
from whirlmap.recordings.declared_rate import declared_rate
from whirlmap.recordings.fields import EMPTY, NUMBER, TEXT, kind_of
from whirlmap.recordings.table import Column

#: Separators that are tried, in this order; None is any number of blanks.
SEPARATORS: tuple[str | None, ...] = ("\t", ";", "|", ",", None)
#: Lines at the top of a file in which the body is sought.
SOUGHT = 3000
NAMED = {"\t": "tabs", ";": "semicolons", ",": "commas", "|": "bars", None: "blanks"}
_LABELS = frozenset({"headers", "header", "names", "name", "columns", "column", "fields", "channels", "channel", "channelnames",
                     "labels", "signals", "data", "variables"})  # fmt: skip
_MARKS = ("#", "%", "//", "!", '"#', "'")


@dataclass(frozen=True)
class Layout:
    """What was understood of a text file.

    Attributes
    ----------
    separator : str or None
        None for blanks.
    decimal : str
        Mark before the decimals.
    first : int
        Index of the first line of the body, from 0.
    fields : int
        Fields of each of its lines.
    columns : tuple of Column
    rate : float or None
        Samples per second, where a line above the body says so.
    notices : list of str
    """

    separator: str | None
    decimal: str
    first: int
    fields: int
    columns: tuple[Column, ...]
    rate: float | None = None
    notices: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class _Run:
    separator: str | None
    decimal: str
    first: int
    kinds: tuple[str, ...]
    rows: int

    @property
    def score(self) -> float:
        return self.rows * sum(k != TEXT for k in self.kinds) / len(self.kinds)


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
    runs = [
        run
        for s in separators
        if s is None or any(s in line for line in lines)
        for d in decimals
        if s != d and (d == "." or any("," in line for line in lines)) and (run := _longest_run(lines, s, d))
    ]
    if not runs:
        names = next(line.strip() for line in lines if line.strip())
        raise InputError(f"{source}: found {names[:60]!r} and no rows of numbers; --separator, --decimal and --skip say how to read it")
    best = max(runs, key=lambda run: run.score)
    if separator is None and decimal is None:
        best = _decimal_comma(best, runs, lines, source)
    return _with_names(_from_its_start(best, lines), lines, source, skip)


def split(line: str, separator: str | None) -> list[str]:
    """Fields of a line, without blanks and quotes around them."""
    if separator is None:
        return [f.strip("\"'") for f in line.split()]
    if '"' in line:
        return [f.strip() for f in next(csv.reader([line.strip()] if separator != "\t" else [line], delimiter=separator, skipinitialspace=True))]
    return [f.strip(" '\t\r") for f in line.rstrip("\r\n").split(separator)]


def is_comment(line: str, decimal: str = ".") -> bool:
    """Whether a line holds no row: empty, or begins with a comment mark; ``;`` is one only before words."""
    text = line.strip(" \t\r\n\ufeff\x1a\x0c")
    if not text:
        return not line.strip(" \r\n\ufeff\x1a\x0c") or not line.strip()
    if text.startswith(";"):
        head = text.lstrip(";").split(";")[0].strip()
        return kind_of(head, decimal) == TEXT
    return text.startswith(_MARKS[:5]) or (text.startswith("'") and kind_of(text.split("'")[1] if text.count("'") > 1 else "x", decimal) == TEXT)


def _longest_run(lines: Sequence[str], separator: str | None, decimal: str) -> _Run | None:
    best: _Run | None = None
    run: _Run | None = None
    for k, line in enumerate(lines):
        if not line.strip() or is_comment(line, decimal):
            continue
        kinds = tuple(kind_of(f, decimal) for f in split(line, separator))
        merged = _merged(run.kinds, kinds) if run else None
        if run and merged:
            run = replace(run, kinds=merged, rows=run.rows + 1)
        else:
            run = _Run(separator, decimal, k, kinds, 1)
        if NUMBER in run.kinds and (best is None or run.score > best.score):
            best = run
    return best


def _merged(a: tuple[str, ...], b: tuple[str, ...]) -> tuple[str, ...] | None:
    """Kinds of two rows together, None where they cannot be rows of one table."""
    if len(a) != len(b) or NUMBER not in b:
        return None
    both = [x if x == y or y == EMPTY else y if x == EMPTY else None for x, y in zip(a, b, strict=True)]
    return None if None in both else tuple(str(k) for k in both)


def _from_its_start(run: _Run, lines: Sequence[str]) -> _Run:
    """The run with what belongs to the same table above it, where a line that does not fit has cut it."""
    for k, line in enumerate(lines[: run.first]):
        if line.strip() and not is_comment(line, run.decimal):
            kinds = tuple(kind_of(f, run.decimal) for f in split(line, run.separator))
            if len(kinds) == len(run.kinds) and kinds[0] == run.kinds[0] and _merged(run.kinds, kinds):
                return replace(run, first=k)
    return run


def _decimal_comma(best: _Run, runs: Sequence[_Run], lines: Sequence[str], source: str) -> _Run:
    """Say whether the commas between whole numbers are decimal marks.

    ``11,8`` may be one number or two. Names above, a first column that counts, ``-0,5`` and ``3,05`` tell; where nothing does,
    nothing is guessed.
    """
    one = next((r for r in runs if r.separator is None and r.decimal == "," and len(r.kinds) == 1), None)
    if best.separator == "," and len(best.kinds) > 2 and not _counts([split(x, ",")[0] for x in lines[best.first : best.first + 50]]):
        rows = [split(line, ",") for line in lines[best.first :] if line.strip()]
        if all(re.fullmatch(r"[+-]?\d+", f) for row in rows[:50] for f in row) and any("-0" in row for row in rows):
            raise InputError(f"{source}: found commas that are both decimal marks and separators ('-0' is no whole number), expected"
                             " one meaning; write the table with semicolons")  # fmt: skip
    if one is None or best not in (one, *[r for r in runs if r.separator == ","]) or one.rows < 2:
        return best
    two = next((r for r in runs if r.separator == "," and len(r.kinds) == 2), None)
    named = _names_above(min(one.first, two.first) if two else 0, lines, ",")
    if two and len(named) == 2 and all(kind_of(n, ".") == TEXT for n in named):
        return two
    if two is None or one.rows > two.rows:
        return one if one.score >= best.score else best
    rows = [split(line, ",") for line in lines[two.first :] if line.strip() and not is_comment(line)]
    rows = [row for row in rows if len(row) == 2]
    names = _names_above(two.first, lines, ",")
    if len(names) == 1 and kind_of(names[0], ".") == TEXT:
        return two if _counts([row[0] for row in rows], 1) else one
    after = [row[1] for row in rows]
    if len(names) == 2 or _counts([row[0] for row in rows]) or any(not f.isdigit() for f in after):
        return two
    if any(row[0] == "-0" for row in rows) or any(len(f) > 1 and f.startswith("0") for f in after):
        return one
    widths = {len(f) for f in after}
    if len(widths) > 1 and any(f.endswith("0") and f != "0" for f in after):
        return two
    raise InputError(f"{source}: found rows such as {lines[two.first].strip()!r}, one number with a decimal comma or two whole numbers;"
                     " expected --decimal , or --separator , to say which")  # fmt: skip


def _counts(fields: Sequence[str], first: int | None = None) -> bool:
    """Whether the fields are whole numbers that ascend by equal steps."""
    try:
        numbers = [int(f) for f in fields[:200]]
    except ValueError:
        return False
    step = numbers[1] - numbers[0] if len(numbers) > 1 else 0
    even = step > 0 and all(b - a == step for a, b in zip(numbers, numbers[1:], strict=False))
    return even and first in (None, numbers[0])


def _names_above(first: int, lines: Sequence[str], separator: str | None) -> list[str]:
    """Fields of the nearest line above the body, without comment marks and labels."""
    above = next((line for line in reversed(lines[:first]) if line.strip()), "")
    return _header_fields(above, separator)


def _header_fields(line: str, separator: str | None) -> list[str]:
    text = line.strip("\r\n\ufeff")
    marked = text.strip(" ").lstrip("#%!/" if separator == "/" else "#%!/;") if is_comment(text) else text
    if separator is None and any(mark in marked for mark in "[(\t,;"):  # names with blanks in their units, or other separators
        for other in ("\t", ",", ";"):
            if other in marked:
                return [f.strip() for f in split(marked.strip(), other)]
        return re.findall(r"[^\s\[(]+(?:\s*[\[(][^\])]*[\])])?", marked)
    return [f.strip() for f in split(marked.strip() if is_comment(text) else marked, separator)]


def _with_names(run: _Run, lines: Sequence[str], source: str, skip: int) -> Layout:
    """Find names, units, rate above the body, and put the columns together."""
    count, first, names, notices = len(run.kinds), run.first, [""] * len(run.kinds), []
    body = [split(x, run.separator) for x in lines[first:] if x.strip() and not is_comment(x, run.decimal)][:200]
    rows = [row for row in body if len(row) == count]
    used = 0  # lines above the body that were used
    if header := _numeric_header(rows):
        names, first = header, next(k for k in range(first + 1, len(lines)) if lines[k].strip())
        notices.append(f"line {run.first + 1} has names that are numbers: {', '.join(n or '(nameless)' for n in names)}")
        if len(rows) > 1:
            run = replace(run, kinds=tuple(kind_of(f, run.decimal) for f in rows[1]))
    above = [k for k in range(run.first) if lines[k].strip()]
    units = [""] * count
    if not header and above:
        fields = _header_fields(lines[above[-1]], run.separator)
        if run.separator == ";" and len(whole := split(lines[above[-1]], ";")) == count and len(fields) != count:
            fields = whole  # ``;time;a``: the first has no name, and the line is no comment
        higher = _header_fields(lines[above[-2]], run.separator) if len(above) > 1 else []
        if _are_units(fields, count, higher, run.decimal):
            units, used = [_bare_unit(f) for f in _fitted(fields, count)], 1
            fields, higher = higher, []
        if found := _names(fields, count, rows, run, source, above[-1 - used] if len(above) > used else 0, lines):
            names, used = found, used + 1
            if higher and higher[0].lower().startswith("units:"):  # whirlmap's own tables
                higher[0] = higher[0][6:].strip()
                units = higher if len(higher) == count else units
                used += 1
        elif used:
            units, used = [""] * count, 0
    rest = above[: len(above) - used]
    rate, said = declared_rate([lines[k] for k in rest])
    if rest:
        what = f"lines {rest[0] + 1} to {rest[-1] + 1} above the table are" if len(rest) > 1 else f"line {rest[0] + 1} above the table is"
        notices.append(f"{what} skipped{f'; {said}' if said else ''}")
    kinds = list(run.kinds)
    columns = tuple(Column.of(n, k, u if u not in ("-",) else "1") for n, k, u in zip(names, kinds, units, strict=True))
    if columns[-1].kind == EMPTY and not columns[-1].title and count > 1 and rows and all(not row[-1] for row in rows):
        columns = columns[:-1]  # every line ends with a separator
    return Layout(run.separator, run.decimal, first, count, columns, rate, notices)


def _numeric_header(rows: Sequence[Sequence[str]]) -> list[str] | None:
    """First row, where it can only be names: ``,0`` of pandas; ``0,1,2`` above numbers with decimals."""
    if len(rows) < 3:
        return None
    head, rest = rows[0], rows[1:]
    if not head[0] and any(head) and all(row[0] for row in rest):
        return list(head)
    whole = [f.isdigit() for f in head]
    counted = all(whole) and [int(f) for f in head] in ([*range(len(head))], [*range(1, len(head) + 1)])
    return list(head) if counted and all(not f.lstrip("+-").isdigit() for row in rest for f in row) else None


def _names(
    fields: list[str], count: int, rows: Sequence[Sequence[str]], run: _Run, source: str, at: int, lines: Sequence[str]
) -> list[str]:
    """Names of the columns, or nothing where the line above has none."""
    if not fields or not any(fields):
        return []
    if len(fields) == count + 1 and re.sub(r"[^a-z]", "", fields[0].lower()) in _LABELS:
        fields = fields[1:]
    if len(fields) == count + 1 and not fields[-1]:
        fields = fields[:-1]
    if len(fields) == count - 1 and run.kinds[-1] == EMPTY:
        fields = [*fields, ""]
    words = [kind_of(f, run.decimal) in (TEXT, EMPTY) for f in fields]
    if len(fields) == count and (all(words) or (words[0] and (is_time(fields[0]) or not fields[0])) or sum(words) > count / 2):
        return fields if any(fields) else []
    comment = is_comment(lines[at])
    if not all(words) or (len(fields) < 2 and count != 2) or len(fields) == count:
        return []
    if len(fields) == count - 1 and not comment and _counts([row[0] for row in rows], 1) and _no_fractions(rows, lines[run.first]):
        return ["", *fields]  # R's row names
    if comment or len(fields) == 1 or any(len(f) > 40 for f in fields):
        return []
    comma = "; a decimal comma between commas?" if run.separator == "," else ""
    raise InputError(
        f"{source}, line {at + 1}: found {len(fields)} names, {', '.join(fields)}, above rows of {count} fields, such as"
        f" {lines[run.first].strip()[:60]!r}; expected as many names as fields{comma} (--skip {at + 1} leaves the names out)"
    )


def _no_fractions(rows: Sequence[Sequence[str]], line: str) -> bool:
    """Whether no field can be what stands behind a decimal comma, so that an extra one is a row's name."""
    quoted = line.lstrip().startswith('"')
    return quoted or any(not f.isdigit() for row in rows for f in row[2:]) or len(rows[0]) == 2


def _are_units(fields: list[str], count: int, higher: list[str], decimal: str) -> bool:
    """Whether the line above the body has units, and names stand above it."""
    fields = _fitted(fields, count)
    if len(fields) != count or len(_fitted(higher, count)) != count or not all(kind_of(f, decimal) in (TEXT, EMPTY) for f in higher):
        return False
    bracketed = all(re.fullmatch(r"[\[(].*[\])]|-?", f) for f in fields)
    return any(fields) and (bracketed or (all(not f or is_unit(f) for f in fields) and not any(is_time(f) for f in fields)))


def _fitted(fields: list[str], count: int) -> list[str]:
    """Without a label in front or a separator at the end."""
    if len(fields) == count + 1 and (re.sub(r"[^a-z]", "", fields[0].lower()) in ("units", "unit") or not fields[-1]):
        return fields[1:] if fields[-1] else fields[:-1]
    return [*fields, ""] if len(fields) == count - 1 and count > 2 else fields


def _bare_unit(field: str) -> str:
    found = re.fullmatch(r"[\[(](.*)[\])]", field)
    unit = found[1].strip() if found else field
    return unit if is_unit(unit) else ""
