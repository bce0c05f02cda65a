"""Options and help of ``whirlmap simulate``."""

from pathlib import Path
from typing import Annotated

import typer

from whirlmap.cli.common import options
from whirlmap.options.computed import INTEGRATION, Integration
from whirlmap.options.execution import EXECUTION, Execution

#: Help panel of a run at a changing speed.
RUN_UP = "Run-up and coast-down"
EXAMPLES = (
    "whirlmap simulate duffing",
    "whirlmap simulate duffing --set gamma=0.29 --start x=0.5 --transient 100 --out run.png",
    "whirlmap simulate machines/jeffcott-rig --transient 100 --animate orbit.gif",
    'whirlmap simulate machines/jeffcott-rig --vary "speed=2000 rpm:9000 rpm" --time "20 s" --out run_up.png',
    'whirlmap simulate gear-psfd/machine --set "speed=1500 rpm" --periods 10 --every 5 --out run.nc',
)


@options.computing(*options.INTEGRATION, "workers")
def simulate(
    case: options.CaseName,
    changes: options.Changes = None,
    start: options.Start = None,
    periods: Annotated[
        int | None,
        typer.Option(
            "--periods", metavar="N", rich_help_panel=options.COMPUTING,
            help="Periods T recorded (unforced models: typical times); 20 turns of the slowest clock where absent.",
        ),
    ] = None,
    transient: Annotated[
        int,
        typer.Option(
            "--transient", metavar="N", help="Periods T dropped.", rich_help_panel=options.COMPUTING
        ),
    ] = 0,
    every: Annotated[
        int,
        typer.Option(
            "--every", metavar="N", help="Steps between samples.", rich_help_panel=options.COMPUTING
        ),
    ] = 1,
    vary: Annotated[
        str | None,
        typer.Option(
            "--vary", metavar="NAME=BEGIN:END", rich_help_panel=RUN_UP,
            help='Run up, or coast down: the speed changes from one to the other, as in "speed=3000 rpm:9000 rpm".',
        ),
    ] = None,
    time: Annotated[
        str | None,
        typer.Option("--time", metavar="TIME", rich_help_panel=RUN_UP, help='How long that takes: "20 s".'),
    ] = None,
    diagram: Annotated[
        Path | None,
        typer.Option(
            "--diagram", metavar="NAME.nc", rich_help_panel=RUN_UP,
            help="A Dataset that bifurcation wrote for the same speed: its labelled points stand behind the run.",
        ),
    ] = None,
    integration: Integration = INTEGRATION,
    execution: Execution = EXECUTION,
    animate: Annotated[
        Path | None,
        typer.Option(
            "--animate", metavar="NAME.gif", rich_help_panel=options.OUTPUT,
            help="Write two seconds of the orbit as it moves: the last 4 T, or two turns of a slower shaft; with --periods"
            " all that is recorded.",
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
    """Integrate one operating point of CASE and report the range of each state and output.

    T is the period of the fastest forcing; `whirlmap show` says how many of them a turn of each clock takes. Ctrl-C keeps
    what was recorded until then. --out NAME.csv writes time, states and outputs as a table. A case with dimensions is shown
    in um, mm/s, N and s.

    With --vary and --time the speed changes at a constant rate, with its angular acceleration: amplitude and phase at each
    clock, extremes and spectra against speed.
    """
