"""Options and help of ``whirlmap linear``."""

from typing import Annotated

import typer

from whirlmap.cli.common import options

EXAMPLES = (
    "whirlmap linear jeffcott",
    "whirlmap linear machines/jeffcott-rig --json",
    "whirlmap linear jeffcott --set Gamma=0.2 --threshold s=0.5:4",
)


def linear(
    case: options.CaseName,
    changes: options.Changes = None,
    threshold: Annotated[
        str | None,
        typer.Option(
            "--threshold", metavar="NAME=LOW:HIGH", rich_help_panel=options.COMPUTING,
            help="Also find the lowest value in this bracket at which the equilibrium loses its stability; of a case with"
            ' dimensions also "speed=1000 rpm:9000 rpm".',
        ),
    ] = None,
    dimensionless: options.Dimensionless = False,
    json: options.Json = False,
) -> None:  # fmt: skip
    """Linearise CASE about its static equilibrium, with all forcing off.

    A case with dimensions is shown in um, Hz, 1/s and N.
    """
