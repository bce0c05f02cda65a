"""Names, units and rate that stand above the rows of a text table."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from whirlmap.errors import InputError, counted
from whirlmap.recordings.column_names import is_time, is_unit
from whirlmap.recordings.decimal_comma import counts
from whirlmap.recordings.declared_rate import declared_rate
from whirlmap.recordings.fields import EMPTY, TEXT, kind_of
from whirlmap.recordings.table import Column
from whirlmap.recordings.text_rows import Run, header_fields, is_comment, split

_LABELS = frozenset(
    {
        "headers",
        "header",
        "names",
        "name",
        "columns",
        "column",
        "fields",
        "channels",
        "channel",
        "channelnames",
        "labels",
        "signals",
        "data",
        "variables",
    }
)


@dataclass(frozen=True)
class Layout:
    """The layout found in a text file.

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


def with_names(run: Run, lines: Sequence[str], source: str) -> Layout:
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
        fields = header_fields(lines[above[-1]], run.separator)
        if run.separator == ";" and len(whole := split(lines[above[-1]], ";")) == count and len(fields) != count:
            fields = whole  # ``;time;a``: the first has no name, and the line is no comment
        wide = re.split(r"\s{2,}|\t", lines[above[-1]].strip("#% \n"))
        if run.separator is None and len(wide) == count != len(fields):
            fields = wide  # names with blanks in them, set apart by several
        higher = header_fields(lines[above[-2]], run.separator) if len(above) > 1 else []
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
        what = (
            f"lines {rest[0] + 1} to {rest[-1] + 1} above the table are"
            if len(rest) > 1
            else f"line {rest[0] + 1} above the table is"
        )
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
    fields: list[str], count: int, rows: Sequence[Sequence[str]], run: Run, source: str, at: int, lines: Sequence[str]
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
    if len(fields) == count and (
        all(words) or (words[0] and (is_time(fields[0]) or not fields[0])) or sum(words) > count / 2
    ):
        return fields if any(fields) else []
    comment = is_comment(lines[at])
    if not all(words) or (len(fields) < 2 and count != 2) or len(fields) == count:
        return []
    if (
        len(fields) == count - 1
        and not comment
        and counts([row[0] for row in rows], 1)
        and _no_fractions(rows, lines[run.first])
    ):
        return ["", *fields]  # R's row names
    if comment or len(fields) == 1 or any(len(f) > 40 for f in fields):
        return []
    comma = "; a decimal comma between commas?" if run.separator == "," else ""
    raise InputError(
        f"{source}, line {at + 1}: found {counted(len(fields), 'name')}, {', '.join(fields)}, above rows of"
        f" {counted(count, 'field')}, such as {lines[run.first].strip()[:60]!r}"
        f"; expected as many names as fields{comma} (--skip {at + 1} leaves the names out)"
    )


def _no_fractions(rows: Sequence[Sequence[str]], line: str) -> bool:
    """Whether no field can be what stands behind a decimal comma, so that an extra one is a row's name."""
    quoted = line.lstrip().startswith('"')
    return quoted or any(not f.isdigit() for row in rows for f in row[2:]) or len(rows[0]) == 2


def _are_units(fields: list[str], count: int, higher: list[str], decimal: str) -> bool:
    """Whether the line above the body has units, and names stand above it."""
    fields = _fitted(fields, count)
    if (
        len(fields) != count
        or len(_fitted(higher, count)) != count
        or not all(kind_of(f, decimal) in (TEXT, EMPTY) for f in higher)
    ):
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
