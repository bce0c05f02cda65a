"""Options and help of ``whirlmap explore``."""

from pathlib import Path
from typing import Annotated

import typer

from whirlmap.cli.common import options
from whirlmap.options.computed import LABELLING, Labelling
from whirlmap.options.execution import EXECUTION, Execution

SWEEP, PAGE = "Sweep", "Page"

EXAMPLES = (
    "whirlmap explore duffing.map",
    "whirlmap explore diagram.nc --branches branches.nc",
    "whirlmap explore duffing --vary gamma=0.2:0.5:300",
    "whirlmap explore diagram.nc --save page.html",
    "whirlmap explore duffing --vary gamma=0.1:0.7:100 --vary omega=0.6:1.6:80 --store duffing.map",
)


@options.computing(*options.LABELS)
def explore(
    source: Annotated[
        str,
        typer.Argument(
            metavar="STORE|FILE.nc|CASE",
            help="A store of `whirlmap map`, a file of `whirlmap map` or `bifurcation`, or a case, as of every command.",
        ),
    ],
    vary: Annotated[
        list[str] | None,
        typer.Option(
            "--vary", metavar="NAME=START:STOP:COUNT[:log]", rich_help_panel=SWEEP,
            help="Of a CASE: parameter and range, as of `whirlmap map`; once for a diagram, twice for a map, which fills"
            " while one looks. Without it the page shows one point.",
        ),
    ] = None,
    follow: Annotated[
        str | None,
        typer.Option(
            "--follow", metavar="up|down|both", rich_help_panel=SWEEP,
            help="Of a diagram: carry the state from each point to the next, as of `whirlmap bifurcation`.",
        ),
    ] = None,
    store: Annotated[
        Path | None,
        typer.Option(
            "--store", metavar="DIR", rich_help_panel=SWEEP,
            help="Keep the map that is computed here; where it is there already, it goes on. Without it a map is lost with"
            " the page.",
        ),
    ] = None,
    branches: Annotated[
        list[Path] | None,
        typer.Option(
            "--branches", metavar="FILE.nc", rich_help_panel=SWEEP,
            help="Branches of `whirlmap continue` that are drawn over a diagram, or curves of its --event over a map. May be"
            " repeated.",
        ),
    ] = None,
    case: Annotated[
        str | None,
        typer.Option(
            "--case", metavar="CASE", rich_help_panel=options.SYSTEM,
            help="Of a STORE or FILE.nc: where its case is, where that is no stock case and not where it was.",
        ),
    ] = None,
    changes: options.Changes = None,
    start: options.Start = None,
    labelling: Labelling = LABELLING,
    execution: Execution = EXECUTION,
    port: Annotated[
        int,
        typer.Option("--port", metavar="N", min=0, max=65535, rich_help_panel=PAGE, help="Port; 0 takes one that is free."),
    ] = 0,
    token: Annotated[
        str | None,
        typer.Option(
            "--token", metavar="TEXT", rich_help_panel=PAGE,
            help="Secret part of the address, of 16 to 64 letters, digits, - and _; a random one where absent. With --port"
            " and the token of an earlier page its links go on.",
        ),
    ] = None,
    browser: Annotated[
        bool,
        typer.Option("--browser/--no-browser", rich_help_panel=PAGE, help="Open the browser, or only print the address."),
    ] = True,
    save: Annotated[
        Path | None,
        typer.Option(
            "--save", metavar="PAGE.html", rich_help_panel=PAGE,
            help="Write the page as one file that needs no server and no network, with motions computed in the browser,"
            " and serve nothing.",
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace what --save names.", rich_help_panel=PAGE)] = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> None:  # fmt: skip
    """Explore a map or a diagram in the browser, with the motion of the point that one clicks.

    The page is served on this computer alone, until Ctrl-C. Click, arrow keys and sliders choose a point; its orbit,
    section, time series and spectrum, its label with the votes of the indicators, films and loads are computed at once.
    A zoom computes the range finer. The address of the page holds what is shown.

    With --save the page is a file to send: it holds the map or diagram, and the browser computes the motion of any point.
    """
