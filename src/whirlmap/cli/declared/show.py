"""Options and help of ``whirlmap show``."""

from typing import Annotated

import typer

from whirlmap.cli.common import options
from whirlmap.cli.common import series_options as signals

EXAMPLES = (
    "whirlmap show gear-psfd/machine",
    'whirlmap show gear-psfd/machine --set "speed=1500 rpm" --set arc=fixed',
    "whirlmap show duffing --equations",
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
    json: options.Json = False,
) -> None:
    """Print every symbol of CASE with its value, unit, meaning and source.

    Dimensional inputs stand beside the dimensionless groups that follow from them; then come the switches,
    the start state, the clocks and periods, and warnings. Nothing is simulated. For a recorded
    signal it prints the layout of the file: table, columns with unit and range, rate.
    """
