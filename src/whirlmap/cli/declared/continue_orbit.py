"""Options and help of ``whirlmap continue``."""

from typing import Annotated

import typer

from whirlmap.cli.common import options
from whirlmap.options.computed import LABELLING, Labelling
from whirlmap.options.execution import EXECUTION, Execution

BRANCH, BEGIN = "Branch", "First point"

EXAMPLES = (
    "whirlmap continue duffing --set delta=0.3 --set omega=1.2 --vary gamma=0.2:0.35 --doublings 2",
    "whirlmap continue gear_backlash --set F_ah=0.05 --set zeta=0.05 --vary Omega=0.5:1.6 --out backlash.png",
    "whirlmap continue lorenz --vary rho=10:30 --orbit x=6,y=6,z=13 --from 14",
    'whirlmap continue machines/turbo-gearbox --vary "speed=3000 rpm:9000 rpm" --out branches',
)


@options.computing(*options.LABELS)
def continue_orbit(
    case: options.CaseName,
    vary: Annotated[
        list[str],
        typer.Option(
            "--vary", metavar="NAME=START:STOP", rich_help_panel=BRANCH,
            help="Parameter and range, ascending, without a number of points; with units as elsewhere,"
            ' "speed=500 rpm:6000 rpm" or c=40um:80um. Given twice, with --event, for a curve in two parameters.',
        ),
    ],
    begin: Annotated[
        str | None,
        typer.Option(
            "--from", metavar="VALUE", rich_help_panel=BEGIN,
            help="Value at which the branch begins, with its settled motion; START where absent.",
        ),
    ] = None,
    period: Annotated[
        int | None,
        typer.Option(
            "--period", metavar="N", min=1, rich_help_panel=BEGIN,
            help="T of one return (of an unforced cycle: crossings of its section); by default of the settled motion.",
        ),
    ] = None,
    orbit: Annotated[
        str | None,
        typer.Option(
            "--orbit", metavar="STATE=VALUE,...", rich_help_panel=BEGIN,
            help="A state near the orbit at phase zero, or near the equilibrium of an unforced model: Newton's method begins"
            " there, in place of the settled motion. Every state needs a value.",
        ),
    ] = None,
    seeds: Annotated[
        str | None,
        typer.Option(
            "--seeds", metavar="FILE|STORE", rich_help_panel=BEGIN,
            help="A labelled diagram (NAME.nc, or a store) with the section of all states, whose point at --from is the"
            " first orbit; without --from one point of each of its stretches of one period.",
        ),
    ] = None,
    coexisting: Annotated[
        bool,
        typer.Option(
            "--all", rich_help_panel=BEGIN,
            help="Begin with all periodic attractors that coexist there (`whirlmap attractors`).",
        ),
    ] = False,
    starts: Annotated[
        int,
        typer.Option("--starts", metavar="N", min=1, rich_help_panel=BEGIN, help="Starts from which --all seeks them."),
    ] = 256,
    direction: Annotated[
        str,
        typer.Option(
            "--direction", metavar="up|down|both", rich_help_panel=BRANCH, help="Where to follow it from its first point.",
        ),
    ] = "both",
    doublings: Annotated[
        int,
        typer.Option(
            "--doublings", metavar="K", min=0, rich_help_panel=BRANCH,
            help="Successive period doublings that are followed onto their doubled branches.",
        ),
    ] = 0,
    event: Annotated[
        str | None,
        typer.Option(
            "--event", metavar="fold|period-doubling|neimark-sacker", rich_help_panel=BRANCH,
            help="Follow the curve of this event in two parameters, instead of a branch.",
        ),
    ] = None,
    near: Annotated[
        str | None,
        typer.Option(
            "--near", metavar="VALUE", rich_help_panel=BRANCH,
            help="With --event: value of the first parameter near which the event is; where absent the curves of all events"
            " of the kind on the branch are followed.",
        ),
    ] = None,
    points: Annotated[
        int,
        typer.Option("--points", metavar="N", min=2, rich_help_panel=BRANCH, help="Most points in each direction."),
    ] = 2000,
    longest: Annotated[
        float,
        typer.Option(
            "--longest", metavar="X", rich_help_panel=BRANCH,
            help="Longest step, in units of the range and of the sizes of the states; where the branch is straight, of the"
            " range alone.",
        ),
    ] = 0.02,
    plot: Annotated[
        str | None,
        typer.Option(
            "--plot", metavar="NAME,...", rich_help_panel=options.OUTPUT,
            help="States or outputs in the picture, separated by commas; the displacements of the model where absent.",
        ),
    ] = None,
    resume: Annotated[
        bool,
        typer.Option(
            "--resume", rich_help_panel=BRANCH,
            help="Go on with the interrupted branches in the data file of --out, with the same options as before.",
        ),
    ] = False,
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
    """Follow branches of periodic orbits of CASE against one parameter, stable or not, and locate their bifurcations.

    The branch begins with the settled motion at START (or --from) and is followed both ways, around folds, until it leaves
    the range, closes, or ends in contact. Stability comes from the multipliers of each orbit. Options under Computing say
    how the settled motion is found; --accuracy is also the largest error of an orbit's segments, 1e-11 where absent.
    """
