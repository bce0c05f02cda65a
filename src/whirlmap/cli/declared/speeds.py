"""Options and help of ``whirlmap speeds``."""

from typing import Annotated

import typer

from whirlmap.cli.common import options
from whirlmap.options.computed import LABELLING, Labelling
from whirlmap.options.execution import EXECUTION, Execution

SPEEDS = "Speeds"

EXAMPLES = (
    'whirlmap speeds machines/turbo-gearbox --limit "25 um"',
    'whirlmap speeds gear-psfd/machine --limit "40 um" --range "1500 rpm:9000 rpm" --out speeds.png',
    'whirlmap speeds machines/jeffcott-rig --input-tolerance c=5% --input-tolerance M=10% --draws 64',
    "whirlmap speeds gear-psfd/intended --limit 0.6 --range 0.5:4 --points 200 --no-follow",
)

Limit = Annotated[
    str | None,
    typer.Option(
        "--limit", metavar="LENGTH", rich_help_panel=SPEEDS,
        help='Largest peak-to-peak displacement that is allowed: "20 um", or a number of clearances. The limit in the'
        " case's table [operation] where absent.",
    ),
]  # fmt: skip

Span = Annotated[
    str | None,
    typer.Option(
        "--range", metavar="LOW:HIGH", rich_help_panel=SPEEDS,
        help='Speeds of the reference shaft (the first of a gear pair), "500 rpm:6000 rpm", or values of s. The range in the'
        " table [operation] where absent.",
    ),
]  # fmt: skip

Quantity = Annotated[
    str | None,
    typer.Option(
        "--quantity", metavar="NAME", rich_help_panel=SPEEDS,
        help="State or output whose peak-to-peak counts, or a disk, bearing or other station, whose x and y both count;"
        " where absent the largest of some displacements, which the report names.",
    ),
]  # fmt: skip


@options.computing(*options.LABELS)
def speeds(
    case: options.CaseName,
    limit: Limit = None,
    span: Span = None,
    points: Annotated[
        int, typer.Option("--points", metavar="N", min=2, rich_help_panel=SPEEDS, help="Speeds judged.")
    ] = 100,
    quantity: Quantity = None,
    follow: Annotated[
        bool,
        typer.Option(
            "--follow/--no-follow", rich_help_panel=SPEEDS,
            help="Whether to run up and down as well, which shows coexisting motions, for about three times the work.",
        ),
    ] = True,
    input_tolerance: Annotated[
        list[str] | None,
        typer.Option(
            "--input-tolerance", metavar="NAME=PERCENT", rich_help_panel=SPEEDS,
            help="Parameter or input and its tolerance, half the width of the range of its draws; may be repeated.",
        ),
    ] = None,
    draws: Annotated[int, typer.Option("--draws", metavar="N", min=1, rich_help_panel=SPEEDS, help="Machines drawn.")] = 64,
    seed: Annotated[int, typer.Option("--seed", metavar="N", min=0, rich_help_panel=SPEEDS, help="Seed of draws.")] = 0,
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
    """Find the windows of speed in which CASE runs periodically and within a limit of vibration.

    Each speed is judged from a cold start and in a run-up and a run-down. The report gives the windows, how far the
    machine's own speed is from their ends, what forbids the speeds between them, the thinnest
    film and the largest bearing load.
    """
