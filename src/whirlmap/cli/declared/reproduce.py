"""Options and help of ``whirlmap reproduce``."""

from pathlib import Path
from typing import Annotated

import typer

from whirlmap.cli.common import options

EXAMPLES = (
    "whirlmap reproduce",
    "whirlmap reproduce --quality full --out reproduction-full",
    "whirlmap reproduce --case gear-psfd/intended-best --case gear-psfd/literal-best --out best",
)


def reproduce(
    quality: Annotated[
        str,
        typer.Option(
            "--quality", metavar="quick|full", rich_help_panel=options.COMPUTING,
            help="quick: about a minute and a half on 2 cores; full: at least 600 speeds for each"
            " permeability, which takes many times longer. The first run also compiles.",
        ),
    ] = "quick",
    case: Annotated[
        list[str] | None,
        typer.Option(
            "--case", metavar="CASE", rich_help_panel=options.COMPUTING,
            help="Judge this case of the gear pair instead of the three editions; may be repeated.",
        ),
    ] = None,
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
