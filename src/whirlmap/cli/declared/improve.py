"""Options and help of ``whirlmap improve``."""

from typing import Annotated

import typer

from whirlmap.cli.common import options
from whirlmap.cli.declared.speeds import SPEEDS, Limit, Quantity, Span
from whirlmap.options.computed import LABELLING, Labelling
from whirlmap.options.execution import EXECUTION, Execution

EXAMPLES = (
    'whirlmap improve gear-psfd/machine --vary psi=1e-4:1:8:log --limit "40 um" --range "1500 rpm:9000 rpm"',
    "whirlmap improve machines/jeffcott-rig --vary c=60um:140um:5 --vary L=4mm:8mm:5 --out rig",
    "whirlmap improve gear-psfd/intended --vary xi_m=0.01:0.1:4 --limit 0.6 --range 0.5:2",
)


@options.computing(*options.LABELS)
def improve(
    case: options.CaseName,
    vary: Annotated[
        list[str],
        typer.Option(
            "--vary", metavar="NAME=START:STOP:COUNT[:log]", rich_help_panel=SPEEDS,
            help="Design parameter and its values: a symbol, psi=1e-4:1:8:log, or a dimensional input with its unit,"
            " c=40um:60um:5. Once or twice.",
        ),
    ],
    limit: Limit = None,
    span: Span = None,
    points: Annotated[
        int, typer.Option("--points", metavar="N", min=2, rich_help_panel=SPEEDS, help="Speeds at which each design runs.")
    ] = 60,
    quantity: Quantity = None,
    coarse: Annotated[
        bool, typer.Option("--coarse", rich_help_panel=SPEEDS, help="Try the values given alone, and none around the best.")
    ] = False,
    follow: Annotated[
        bool,
        typer.Option(
            "--follow/--no-follow", rich_help_panel=SPEEDS,
            help="Whether to judge the best designs in run-up and run-down as well, which shows coexisting motions.",
        ),
    ] = True,
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
    """Compare values of one or two design parameters of CASE by the safe speeds that they give.

    Every design runs at the same speeds of the first shaft. The report gives its widest window of safe speeds and its
    largest amplitude over the whole range; around the best designs more values are tried. Ctrl-C keeps the designs that are
    finished: they are reported and written, marked as incomplete.
    """
