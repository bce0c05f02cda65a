"""Options of recorded signals."""

from pathlib import Path
from typing import Annotated

import typer

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
        help="A value that means that there is none: -999; nan for what is no number, such as the word OVL. "
        "Up to three in a row are filled, "
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
