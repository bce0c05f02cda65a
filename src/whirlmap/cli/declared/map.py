"""Options and help of ``whirlmap map``."""

from pathlib import Path
from typing import Annotated

import typer

from whirlmap.cli.common import options
from whirlmap.options.computed import LABELLING, Labelling
from whirlmap.options.execution import EXECUTION, Execution

SWEEP, STORE = "Sweep", "Store and machines"

EXAMPLES = (
    "whirlmap map duffing --vary gamma=0.1:0.7:200 --vary omega=0.6:1.6:150 --store duffing.map --out duffing.png",
    "whirlmap map gear-psfd/machine --vary s=0.3:5:400 --vary psi=1e-5:1:300:log --store machine.map --refine",
    "whirlmap map gear-psfd/machine --vary s=0.3:5:400 --vary psi=1e-5:1:300:log --store machine.map --share 3/8",
    "whirlmap map gear-psfd/machine --draw psi=uniform:20% --draw xi_m=normal:5% --draws 1000 --store draws.map",
    "whirlmap map --status machine.map",
)


@options.computing(*options.LABELS)
def map(  # noqa: A001 (the command's name)
    case: Annotated[str | None, typer.Argument(metavar="CASE", help="Name or path of a case, as of every command.")] = None,
    vary: Annotated[
        list[str] | None,
        typer.Option(
            "--vary", metavar="NAME=START:STOP:COUNT[:log]", rich_help_panel=SWEEP,
            help="Parameter and range, ascending; given twice for a map, once for a line; of a case with dimensions also"
            ' "speed=500 rpm:6000 rpm:200", or another input, c=40um:80um:50, whose groups all follow.',
        ),
    ] = None,
    draw: Annotated[
        list[str] | None,
        typer.Option(
            "--draw", metavar="NAME=TOLERANCE", rich_help_panel=SWEEP,
            help="Parameter that is drawn at random: uniform:LOW:HIGH, normal:MEAN:SPREAD, or uniform:10% and normal:3%"
            " of the case's value. May be repeated.",
        ),
    ] = None,
    draws: Annotated[
        int | None, typer.Option("--draws", metavar="N", min=1, rich_help_panel=SWEEP, help="Number of random draws.")
    ] = None,
    seed: Annotated[
        int, typer.Option("--seed", metavar="N", min=0, rich_help_panel=SWEEP, help="Master seed of the random draws.")
    ] = 0,
    refine: Annotated[
        bool,
        typer.Option(
            "--refine", rich_help_panel=SWEEP,
            help="Compute every eighth point along both parameters, then only points near differing labels, down to the"
            " grid; the others get the label of their surroundings and are marked as inferred.",
        ),
    ] = False,
    sections: Annotated[
        bool,
        typer.Option(
            "--sections", rich_help_panel=SWEEP,
            help="Keep the section of every point, once per T: with one --vary the store holds a bifurcation diagram.",
        ),
    ] = False,
    curves: Annotated[
        str | None,
        typer.Option(
            "--curves", metavar="EVENT,...", rich_help_panel=SWEEP,
            help="Follow curves of fold, period-doubling or neimark-sacker points in the plane of a map of two parameters"
            " (`whirlmap continue --event`), and draw them over it.",
        ),
    ] = None,
    changes: options.Changes = None,
    start: options.Start = None,
    store: Annotated[
        Path | None,
        typer.Option(
            "--store", metavar="DIR", rich_help_panel=STORE,
            help="Folder of the Zarr store; xarray.open_zarr opens it. Without it nothing is kept but --out.",
        ),
    ] = None,
    resume: Annotated[
        bool,
        typer.Option(
            "--resume", rich_help_panel=STORE,
            help="Continue the store; create it where it is absent, empty or incomplete.",
        ),
    ] = False,
    status: Annotated[
        Path | None,
        typer.Option("--status", metavar="DIR", rich_help_panel=STORE, help="Print how far a store is, running or not."),
    ] = None,
    share: Annotated[
        str | None,
        typer.Option(
            "--share", metavar="I/N", rich_help_panel=STORE,
            help="Work on share I of N of the chunks (I from 1): the jobs of a Slurm array work on one store with"
            " --share $SLURM_ARRAY_TASK_ID/N. A share that is run again continues where it stopped.",
        ),
    ] = None,
    dask: Annotated[
        str | None,
        typer.Option(
            "--dask", metavar="ADDRESS", rich_help_panel=STORE,
            help="Compute on the workers of the Dask scheduler at this address, tcp://host:8786; they need the store's"
            " folder under the same path.",
        ),
    ] = None,
    chunk: Annotated[
        int | None,
        typer.Option(
            "--chunk", metavar="N", min=1, rich_help_panel=STORE,
            help="Points in one task; chosen by a pilot where absent, so that a task takes about 3 s.",
        ),
    ] = None,
    labelling: Labelling = LABELLING,
    execution: Execution = EXECUTION,
    plot: Annotated[
        str | None,
        typer.Option(
            "--plot", metavar="QUANTITY", rich_help_panel=options.OUTPUT,
            help="State or output whose amplitude (peak to peak) gives the contour lines; the first displacement"
            " where absent.",
        ),
    ] = None,
    dimensionless: options.Dimensionless = False,
    out: options.Out = None,
    size: options.Size = None,
    dpi: options.Dpi = None,
    title: options.Title = None,
    force: Annotated[
        bool,
        typer.Option(
            "--force", rich_help_panel=options.OUTPUT,
            help="Replace what --out names, and, without --resume, what --store names.",
        ),
    ] = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> None:  # fmt: skip
    """Label the regime of every point of a grid over parameters of CASE.

    Every point has its regime, exponent, amplitudes, largest eccentricity, thinnest film, and status. Chunks
    of points are committed one by one: after a crash, a kill or Ctrl-C the same command with --resume goes on, and the
    result is the same to the bit. The picture of a case with dimensions is in rpm and um.
    """
