"""``whirlmap reproduce``: the paper's figures and the verdict on its claims."""

from pathlib import Path
from typing import Annotated, Any

import typer

from whirlmap.cli import options, report
from whirlmap.cli.messages import choice
from whirlmap.cli.progress import Progress

QUALITIES = ("quick", "full")

EXAMPLES = (
    "whirlmap reproduce",
    "whirlmap reproduce --quality full --out reproduction-full",
)


def reproduce(
    quality: Annotated[
        str,
        typer.Option(
            "--quality", metavar="quick|full", rich_help_panel=options.COMPUTING,
            help="quick: about a minute and a half on 2 cores; full: at least 600 speeds for each"
            " permeability, about ten minutes. The first run also compiles.",
        ),
    ] = "quick",
    out: Annotated[
        Path,
        typer.Option(
            "--out", metavar="FOLDER", rich_help_panel=options.OUTPUT,
            help="Folder for figures, data and report; files of an earlier reproduction in it are replaced.",
        ),
    ] = Path("reproduction"),
    workers: options.Workers = None,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> None:  # fmt: skip
    """Draw Figures 2 to 7 of the paper and judge each of its claims.

    Computes the paper's system as printed, as derived, and as a machine; writes the figures, the data as
    NetCDF and report.html, which opens from disk.
    """
    choice("--quality", quality, QUALITIES)
    from whirlmap.studies.gear_psfd.reproduce import reproduce as run

    with Progress("reproduce", None, quiet=quiet) as progress:
        made: Any = run(out, quality=quality, workers=workers, progress=progress)
    if json:
        report.print_json({"quality": quality, "out": out, **made})
    else:
        typer.echo(f"written: {out}")
