"""Options and help of ``whirlmap bifurcation``."""

from typing import Annotated

import typer

from whirlmap.cli.common import options
from whirlmap.options.computed import LABELLING, Labelling
from whirlmap.options.execution import EXECUTION, Execution

SWEEP = "Sweep"

EXAMPLES = (
    "whirlmap bifurcation duffing --vary gamma=0.2:0.5:300 --out gamma.png",
    "whirlmap bifurcation duffing --vary gamma=0.2:0.5:99 --follow both",
    "whirlmap bifurcation duffing --set delta=0.05 --set alpha=1 --set beta=0.1 --set gamma=0.18 --vary omega=0.8:1.6:81"
    " --follow both --branches --out duffing",
    "whirlmap bifurcation gear-psfd/intended --vary s=0.3:4:600 --out figure4",
    "whirlmap bifurcation gear-psfd/machine --vary psi=1e-5:1:50:log --plot yp",
)


@options.computing("keep", *options.LABELS)
def bifurcation(
    case: options.CaseName,
    vary: Annotated[
        str,
        typer.Option(
            "--vary", metavar="NAME=START:STOP:COUNT[:log]", rich_help_panel=SWEEP,
            help="Parameter and range, ascending: s=0.3:4:600, or psi=1e-5:1:50:log; of a case with dimensions also"
            ' "speed=500 rpm:6000 rpm:200", or another input, c=40um:80um:50, whose groups all follow.',
        ),
    ],
    follow: Annotated[
        str | None,
        typer.Option(
            "--follow", metavar="up|down|both", rich_help_panel=SWEEP,
            help="Carry the state from each point to the next; both shows hysteresis."
            " Without it each point starts cold.",
        ),
    ] = None,
    branches: Annotated[
        bool,
        typer.Option(
            "--branches", rich_help_panel=SWEEP,
            help="Follow the branches of its periodic points, stable or not (`whirlmap continue`), and draw them over it; a"
            " folder of --out gets their data too.",
        ),
    ] = False,
    changes: options.Changes = None,
    start: options.Start = None,
    labelling: Labelling = LABELLING,
    execution: Execution = EXECUTION,
    plot: Annotated[
        str | None,
        typer.Option(
            "--plot", metavar="STATE,...", rich_help_panel=options.OUTPUT,
            help="States in the picture and, with their section, in the data, separated by commas; the displacements of"
            " the model where absent.",
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
    """Sweep one parameter of CASE and label the regime of every point.

    Each point is integrated until its section returns, and gives its Poincaré section once per T. Ctrl-C keeps the
    points that are finished: they are reported and written, marked as incomplete. A case with dimensions is shown in um,
    mm/s, N, rpm and 1/s.
    """
