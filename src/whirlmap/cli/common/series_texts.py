"""Texts of the options of recorded signals."""

import re
from typing import Any

from whirlmap.errors import InputError, RangeError
from whirlmap.recordings.shaft_speed import turns_per

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


def samples_per_second(text: str) -> float:
    """Read ``--rate``: a number, with a unit of frequency or none."""
    found = re.fullmatch(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*([kMG]?)(?:Hz|S/s|Sa/s|sps|/s|1/s)?\s*", text)
    if not found:
        raise InputError(f"--rate: found {text!r}, expected a number of samples per second, or such as '25.6 kHz'")
    return float(found[1]) * {"": 1.0, "k": 1e3, "M": 1e6, "G": 1e9}[found[2]]


def turns_per_second(text: str | None) -> tuple[float | None, str | None]:
    """Read ``--speed``: turns per second, or the name of a column."""
    found = re.fullmatch(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)(?:\s*([a-zA-Z/]\S*)|\s+(1/\S+))\s*", text or "")
    if not found:
        return None, text
    speed = abs(float(found[1])) * turns_per(found[2] or found[3], f"--speed {text}")
    if speed == 0:
        raise RangeError(f"--speed: found {text!r}, expected a speed that is not zero")
    return speed, None


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
