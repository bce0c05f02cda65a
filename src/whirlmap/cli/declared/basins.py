"""Options and help of ``whirlmap basins``."""

from typing import Annotated

import typer

from whirlmap.cli.common import options
from whirlmap.options.computed import LABELLING, Labelling
from whirlmap.options.execution import EXECUTION, Execution

EXAMPLES = (
    "whirlmap basins duffing --set gamma=0.2 --grid x=-2:2:200 --grid v=-2:2:200 --out basins.png",
    "whirlmap basins pendulum --set g=1.35 --grid x=-3:3:60 --grid v=-3:3:60 --json",
)


@options.computing(*options.LABELS, lyapunov=options.MeasuredLyapunov)
def basins(
    case: options.CaseName,
    grid: Annotated[
        list[str],
        typer.Option(
            "--grid", metavar="STATE=START:STOP:COUNT", rich_help_panel="Start states",
            help="State and range of its start values, of a case with dimensions also 'ux=-50 um:50 um:20'; given twice. The"
            " other states keep their start value.",
        ),
    ],
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
    """Colour a two-dimensional slice of start states of CASE by the attractor that each leads to.

    Starts that end in contact, diverge, or stay undecided are shown as such, and belong to no attractor.
    """
