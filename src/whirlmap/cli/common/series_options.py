"""Options of recorded signals, and how their text is read."""

import re
from pathlib import Path
from typing import Annotated, Any

import typer

from whirlmap.errors import InputError, RangeError
from whirlmap.recordings.shaft_speed import turns_per

PANEL = "Measured signal"

File = Annotated[
    Path | None,
    typer.Option(
        "--series",
        metavar="FILE",
        rich_help_panel=PANEL,
        help="A recorded signal instead of a case: text tables of any layout, .wav, .mat, .npy, .npz, .parquet, .nc, "
        ".lvm, .tdms,"
        " .uff; - for standard input.",
    ),
]
Column = Annotated[
    str | None,
    typer.Option(
        "--column", metavar="NAME", rich_help_panel=PANEL, help="Column of the signal, by its name or its number from 1."
    ),
]
Time = Annotated[
    str | None,
    typer.Option(
        "--time",
        metavar="NAME",
        rich_help_panel=PANEL,
        help="Column of the times, by name or number, with its unit where the file says none or another: 't [ms]'; none for"
        " no times.",
    ),
]
Rate = Annotated[
    str | None,
    typer.Option(
        "--rate",
        metavar="X",
        rich_help_panel=PANEL,
        help='Samples per second, or "25.6 kHz"; from the times, or a line above the table, where absent.',
    ),
]
Separator = Annotated[
    str | None,
    typer.Option(
        "--separator", metavar="C", rich_help_panel=PANEL, help="Character between fields, tab or blank; found where absent."
    ),
]
Decimal = Annotated[
    str | None,
    typer.Option("--decimal", metavar="C", rich_help_panel=PANEL, help="Decimal mark, . or , ; found where absent."),
]
Skip = Annotated[
    int, typer.Option("--skip", metavar="N", min=0, rich_help_panel=PANEL, help="Lines at the top to skip.")
]
Missing = Annotated[
    list[str] | None,
    typer.Option(
        "--missing",
        metavar="X",
        rich_help_panel=PANEL,
        help="A value that means that there is none: -999; nan for what is no number. Up to three in a row are filled, "
        "else the longest"
        " part without is read. May be repeated.",
    ),
]
Window = Annotated[
    str | None,
    typer.Option(
        "--window",
        metavar="A:B",
        rich_help_panel=PANEL,
        help="Part of the record that is judged, in seconds; one number L judges windows of that length too, half a "
        "window apart.",
    ),
]
Speed = Annotated[
    str | None,
    typer.Option(
        "--speed",
        metavar="X",
        rich_help_panel=PANEL,
        help='Speed of the shaft, "1480 rpm", or a column with it or with one pulse per turn: lines are named as orders.',
    ),
]
Teeth = Annotated[
    int | None,
    typer.Option(
        "--teeth",
        metavar="N",
        min=2,
        rich_help_panel=PANEL,
        help="Teeth of the gear on that shaft: mesh and sidebands are named.",
    ),
]

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
    found = re.fullmatch(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*([a-zA-Z/]\S*)\s*", text or "")
    if not found:
        return None, text
    speed = abs(float(found[1])) * turns_per(found[2], f"--speed {text}")
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
