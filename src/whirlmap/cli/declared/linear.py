"""Options and help of ``whirlmap linear``."""

from pathlib import Path
from typing import Annotated

import typer

from whirlmap.cli.common import options

RESPONSE = "Unbalance response"

EXAMPLES = (
    "whirlmap linear jeffcott",
    "whirlmap linear machines/jeffcott-rig --json",
    "whirlmap linear jeffcott --set Gamma=0.2 --threshold s=0.5:4",
    'whirlmap linear machines/two-shaft-gearbox --response --vary "speed=1000 rpm:12000 rpm:200" --out bode.png',
    "whirlmap linear machines/jeffcott-rig --response --nonlinear 20",
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
    response: Annotated[
        bool,
        typer.Option(
            "--response", rich_help_panel=RESPONSE,
            help="Compute the response to unbalance against the speed in place of the eigenvalues: amplitude and phase at"
            " stations, critical speeds, amplification factors and separation margins.",
        ),
    ] = False,
    vary: Annotated[
        str | None,
        typer.Option(
            "--vary", metavar="NAME=START:STOP:COUNT[:log]", rich_help_panel=RESPONSE,
            help='Range of the speed: s=0.3:5:200, or "speed=500 rpm:6000 rpm:200". From a twentieth to 1.25 of the highest'
            " speed of the case, in 200 points, where absent.",
        ),
    ] = None,
    probe: Annotated[
        list[str] | None,
        typer.Option(
            "--probe", metavar="STATION", rich_help_panel=RESPONSE,
            help="Where to probe: a bearing, a disk, a wheel or another body; may be repeated. All of them where absent.",
        ),
    ] = None,
    nonlinear: Annotated[
        int | None,
        typer.Option(
            "--nonlinear", metavar="N", min=2, rich_help_panel=RESPONSE,
            help="Also compute the steady nonlinear motion at N speeds of the range, each from a cold start.",
        ),
    ] = None,
    over: Annotated[
        Path | None,
        typer.Option(
            "--over", metavar="FILE.nc", rich_help_panel=RESPONSE,
            help="Diagram of `whirlmap bifurcation --vary speed=...` whose peak to peak is laid over the linear response.",
        ),
    ] = None,
    dimensionless: options.Dimensionless = False,
    out: options.Out = None,
    size: options.Size = None,
    dpi: options.Dpi = None,
    title: options.Title = None,
    force: options.Force = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> None:  # fmt: skip
    """Linearise CASE about its static equilibrium, with all forcing off.

    With --response, its response to unbalance against the speed: amplitude and phase, and critical speeds with amplification
    factor and separation margin as API 617 defines them. A case with dimensions is shown in um, Hz, 1/s, N and rpm.
    """
