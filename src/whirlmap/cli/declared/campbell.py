"""Options and help of ``whirlmap campbell``."""

from typing import Annotated

import typer

from whirlmap.cli.common import options

EXAMPLES = (
    "whirlmap campbell jeffcott --vary s=0.3:5:100 --out campbell.png",
    'whirlmap campbell machines/turbo-gearbox --vary "speed=3000 rpm:12000 rpm:200" --json',
)


def campbell(
    case: options.CaseName,
    vary: Annotated[
        str,
        typer.Option(
            "--vary", metavar="NAME=START:STOP:COUNT[:log]", rich_help_panel="Sweep",
            help='Parameter and range, ascending, as a rule the speed: s=0.3:5:100, or "speed=500 rpm:6000 rpm:100".',
        ),
    ],
    changes: options.Changes = None,
    dimensionless: options.Dimensionless = False,
    out: options.Out = None,
    size: options.Size = None,
    dpi: options.Dpi = None,
    title: options.Title = None,
    force: options.Force = False,
    json: options.Json = False,
) -> None:  # fmt: skip
    """Compute the damped frequencies of CASE against a parameter, and the critical speeds at which order lines cross them.

    Each mode has the name of the part that moves most in it and its sense of whirl, and the shape: how far every part moves
    over that one. A case with dimensions is shown in rpm and Hz.
    """
