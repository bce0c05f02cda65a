"""Texts of the options of recorded signals."""

from typing import Any

from whirlmap.errors import InputError
from whirlmap.recordings.shaft_speed import speed_of

_MARKS = {
    "tab": "\t",
    "\\t": "\t",
    "comma": ",",
    "semicolon": ";",
    "space": "blank",
    " ": "blank",
    "bar": "|",
    "point": ".",
    "dot": ".",
}


def mark(text: str | None) -> str | None:
    """Separator or decimal mark, from a character or its name."""
    return None if text is None else _MARKS.get(text.lower(), text)


def turns_per_second(text: str | None) -> tuple[float | None, str | None]:
    """Read ``--speed``: turns per second, or the name of a column."""
    speed = None if text is None else speed_of(text)
    return (speed, None) if speed is not None else (None, text)


def window_of(text: str | None) -> tuple[tuple[float, float] | None, float | None]:
    """Read ``--window``: a part, or the length of windows that slide."""
    if text is None:
        return None, None
    try:
        ends = [
            float(part) if part.strip() else fill for part, fill in zip(text.split(":"), (0.0, float("inf")), strict=False)
        ]
    except ValueError:
        ends = []
    if text.count(":") == 1 and len(ends) == 2 and ends[0] < ends[1]:
        return (ends[0], ends[1]), None
    if ":" not in text and len(ends) == 1 and 0 < ends[0] < float("inf"):
        return None, ends[0]
    raise InputError(
        f"--window: found {text!r}, expected first and last second, as in 0.5:2.5, or the length of windows, as in 0.5"
    )


def options_given(**given: Any) -> list[str]:
    """Names of the options of signals that were given, for refusing them without ``--series``."""
    return [f"--{name}" for name, value in given.items() if value not in (None, 0, [])]
