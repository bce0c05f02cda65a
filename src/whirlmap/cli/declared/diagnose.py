"""Options and help of ``whirlmap diagnose``."""

from typing import Annotated

import typer

from whirlmap.cli.common import options
from whirlmap.cli.common import series_options as signals
from whirlmap.options.computed import LABELLING, Labelling
from whirlmap.options.execution import EXECUTION, Execution

EXAMPLES = (
    "whirlmap diagnose duffing --set gamma=0.29",
    "whirlmap diagnose gear-psfd/intended --set s=3.27 --set psi=1e-4 --json",
    'whirlmap diagnose gear-psfd/machine --set "speed=1500 rpm" --out sheet.png',
    "whirlmap diagnose --series run7.csv --column y --rate 25600 --out run7.png",
    'whirlmap diagnose --series run7.csv --column y --speed "1480 rpm" --teeth 23',
)


@options.computing(*options.LABELS)
def diagnose(
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
    labelling: Labelling = LABELLING,
    execution: Execution = EXECUTION,
    exponents: Annotated[
        int | None,
        typer.Option(
            "--exponents", metavar="N", rich_help_panel=options.COMPUTING,
            help="Number of Lyapunov exponents, largest first; 4 where absent.",
        ),
    ] = None,
    max_periods: Annotated[
        int,
        typer.Option(
            "--max-periods", metavar="N", min=32, max=100_000_000, rich_help_panel=options.COMPUTING,
            help="T after which the exponents stop, whatever their error.",
        ),
    ] = 16384,
    points: Annotated[
        int,
        typer.Option(
            "--section-points", metavar="N", min=1, max=100_000_000, rich_help_panel=options.COMPUTING,
            help="Section points of the correlation dimension, where the motion does not return.",
        ),
    ] = 5000,
    series: signals.File = None,
    column: signals.Column = None,
    time: signals.Time = None,
    rate: signals.Rate = None,
    separator: signals.Separator = None,
    decimal: signals.Decimal = None,
    skip: signals.Skip = 0,
    missing: signals.Missing = None,
    window: signals.Window = None,
    speed: signals.Speed = None,
    teeth: signals.Teeth = None,
    dimensionless: options.Dimensionless = False,
    out: options.Out = None,
    size: options.Size = None,
    dpi: options.Dpi = None,
    title: options.Title = None,
    force: options.Force = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> None:  # fmt: skip
    """Diagnose the regime of one operating point of CASE, with the evidence.

    Many start states are integrated until their section returns. Lyapunov exponents and, where the motion does
    not return, its correlation dimension and spectrum are the evidence; where it does not agree, the motion
    is undecided. A recorded signal has no equations: delay embedding, exponents of neighbours, dimension, 0-1
    test and spectrum are its evidence.
    """
