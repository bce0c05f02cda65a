"""Options and help of ``whirlmap attractors``."""

from typing import Annotated

import typer

from whirlmap.cli.common import options
from whirlmap.options.computed import LABELLING, Labelling
from whirlmap.options.execution import EXECUTION, Execution

STARTS = "Start states"

EXAMPLES = (
    "whirlmap attractors duffing --set gamma=0.2",
    "whirlmap attractors duffing --set gamma=0.2 --starts 2000 --box x=-2:2 --box v=-2:2 --out duffing.png",
    "whirlmap attractors gear_backlash --set Omega=1.0 --set F_ah=0.2 --set zeta=0.05 --box x=-3:3 --box v=-2:2",
)


@options.computing(*options.LABELS, lyapunov=options.MeasuredLyapunov)
def attractors(
    case: options.CaseName,
    starts: Annotated[
        int,
        typer.Option("--starts", metavar="N", min=1, rich_help_panel=STARTS, help="Start states drawn at random."),
    ] = 256,
    box: Annotated[
        list[str] | None,
        typer.Option(
            "--box", metavar="STATE=LOW:HIGH", rich_help_panel=STARTS,
            help="Range from which a state's starts are drawn, of a case with dimensions also 'y=-20 um:20 um'; may be"
            " repeated, and the other states keep their start value. Without it all states are drawn from twice the range of"
            " the motion from the default start.",
        ),
    ] = None,
    seed: Annotated[int, typer.Option("--seed", metavar="N", min=0, rich_help_panel=STARTS, help="Seed of the starts.")] = 0,
    changes: options.Changes = None,
    start: options.Start = None,
    labelling: Labelling = LABELLING,
    execution: Execution = EXECUTION,
    dimensionless: options.Dimensionless = False,
    out: options.Out = None,
    size: options.Size = None,
    dpi: options.Dpi = None,
    title: options.Title = None,
    force: options.Force = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> None:  # fmt: skip
    """Find the attractors that coexist at one operating point of CASE, and the share of the starts that lead to each.

    Starts that end in contact, diverge, or stay undecided are counted as such, and belong to no attractor. The picture
    shows the start states in the colour of their attractor, with its section points.
    """
