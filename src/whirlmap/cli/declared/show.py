"""Options and help of ``whirlmap show``."""

from pathlib import Path
from typing import Annotated

import typer

from whirlmap.cli.common import options
from whirlmap.cli.common import series_options as signals

EXAMPLES = (
    "whirlmap show gear-psfd/machine",
    'whirlmap show gear-psfd/machine --set "speed=1500 rpm" --set arc=fixed',
    "whirlmap show duffing --equations",
    "whirlmap show machines/two-shaft-gearbox --out machine.png",
    "whirlmap show my_rotor.toml --json",
    "whirlmap show --series run7.csv",
)


def show(
    case: Annotated[
        str | None,
        typer.Argument(
            metavar="CASE",
            help="Name of a stock case (listed by `whirlmap cases`), or the path of a case file, my.toml."
            " Left out with --series.",
        ),
    ] = None,
    changes: options.Changes = None,
    start: options.Start = None,
    equations: Annotated[bool, typer.Option("--equations", help="Print the equations of motion too.")] = False,
    series: signals.File = None,
    time: signals.Time = None,
    separator: signals.Separator = None,
    decimal: signals.Decimal = None,
    skip: signals.Skip = 0,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", metavar="PLACE", rich_help_panel=options.OUTPUT,
            help="Draw a machine from parts: NAME.png, .svg or .pdf. Without it no file is written.",
        ),
    ] = None,
    size: options.Size = None,
    dpi: options.Dpi = None,
    title: options.Title = None,
    force: options.Force = False,
    json: options.Json = False,
) -> None:
    """Print every symbol of CASE with its value, unit, meaning and source.

    Of a machine from parts, its shafts, bearings and meshes come first, with static loads, kept modes and what their
    truncation costs; --out draws it. Dimensional inputs stand beside the dimensionless groups that follow from them; then
    come the switches, the start state, the clocks and periods, and warnings. Nothing is simulated. For a recorded
    signal it prints the layout of the file: table, columns with unit and range, rate.
    """
