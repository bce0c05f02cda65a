"""Classes of the fields of a text table: number, date, clock time, empty, or text."""

import re
from datetime import UTC, datetime, timedelta

#: Words that stand for a value that is not there.
ABSENT = frozenset(
    {
        "",
        "nan",
        "na",
        "n/a",
        "#n/a",
        "#na",
        "null",
        "none",
        "-",
        "--",
        "?",
        "inf",
        "-inf",
        "+inf",
        "1.#qnan",
        "-1.#ind",
        "1.#inf",
        "#num!",
        "#value!",
        "#div/0!",
        "missing",
    }
)
_NUMBER = {
    mark: re.compile(rf"[+-]?(?:\d+(?:{re.escape(mark)}\d*)?|{re.escape(mark)}\d+)(?:[eEdD][+-]?\d+)?") for mark in ".,"
}
_CLOCK = r"(\d{1,2}):(\d{2})(?::(\d{2})(?:[.,:](\d{1,9}))?)?\s*([AaPp][Mm])?"
_CLOCK_ONLY = re.compile(_CLOCK)
_YEAR_FIRST = re.compile(rf"(\d{{4}})([-/.])(\d{{1,2}})\2(\d{{1,2}})(?:[T ]+{_CLOCK})?\s*(?:Z|UTC|[+-]\d{{2}}:?\d{{2}})?")
_YEAR_LAST = re.compile(rf"(\d{{1,2}})([-/.])(\d{{1,2}})\2(\d{{2}}|\d{{4}})(?:[T ,]+{_CLOCK})?")
_ORIGIN = datetime(1970, 1, 1, tzinfo=UTC)
NUMBER, DATE, CLOCK, EMPTY, TEXT = "number", "date", "clock", "empty", "text"


def kind_of(field: str, decimal: str) -> str:
    """Class of a field, stripped of blanks and quotes: one of the five words above."""
    if _NUMBER[decimal].fullmatch(field):
        return NUMBER
    if field.lower() in ABSENT:
        return EMPTY
    if ":" in field and _CLOCK_ONLY.fullmatch(field):
        return CLOCK
    return DATE if _YEAR_FIRST.fullmatch(field) or _YEAR_LAST.fullmatch(field) else TEXT


def number_of(field: str, decimal: str) -> float | None:
    """Value of a number; ``1,5D-3`` is one too. None for anything else."""
    if not _NUMBER[decimal].fullmatch(field):
        return None
    return float(field.replace(decimal, ".").replace("d", "e").replace("D", "e"))


def nanoseconds(field: str) -> int | None:
    """Nanoseconds since midnight of a clock time, since 1970 of a date; None for anything else.

    ``13.02.2024`` and ``02/13/2024`` are read as what they must be; with dots the day comes first, with slashes the month.
    """
    if found := _CLOCK_ONLY.fullmatch(field):
        return _of_clock(*found.groups())
    if found := _YEAR_FIRST.fullmatch(field):
        year, _, month, day, *clock = found.groups()
    elif found := _YEAR_LAST.fullmatch(field):
        first, mark, second, year, *clock = found.groups()
        day, month = (first, second) if mark == "." or int(first) > 12 else (second, first)
        if int(month) > 12:
            day, month = month, day
        year = year if len(year) == 4 else f"20{year}"
    else:
        return None
    try:
        date = datetime(int(year), int(month), int(day), tzinfo=UTC) - _ORIGIN
    except ValueError:
        return None
    return date // timedelta(microseconds=1) * 1000 + (_of_clock(*clock) if clock[0] else 0)


def _of_clock(hour: str, minute: str, second: str | None, fraction: str | None, half: str | None) -> int:
    hours = int(hour)
    if half:
        hours = hours % 12 + 12 * (half.lower() == "pm")
    whole = (hours * 60 + int(minute)) * 60 + int(second or 0)
    return whole * 1_000_000_000 + int((fraction or "").ljust(9, "0"))
