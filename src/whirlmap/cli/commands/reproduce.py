"""``whirlmap reproduce``: the paper's figures and the verdict on its claims."""

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from whirlmap.cli.common import options, report
from whirlmap.cli.common.interrupts import INTERRUPTED
from whirlmap.cli.common.messages import choice, say
from whirlmap.cli.common.progress import Progress

QUALITIES = ("quick", "full")

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
    choice("--quality", quality, QUALITIES)
    from whirlmap.studies.gear_psfd.reproduction.reproduce import reproduce as run

    begun = time.time()
    try:
        with Progress("reproduce", longest(quality, case), quiet=quiet, most=True) as progress:
            made = run(out, quality=quality, cases=case, workers=workers, progress=progress)
    except KeyboardInterrupt:
        made_now = [f.name for f in sorted(out.glob("[!.]*")) if f.stat().st_mtime >= begun] if out.is_dir() else []
        kept = f"data, figures and report that were finished are in {out}: {', '.join(made_now)}"
        say(f"interrupted: {kept if made_now else f'nothing was finished, so nothing was written into {out}'}")
        say("  the same command computes everything again; with --case one edition at a time")
        raise typer.Exit(INTERRUPTED) from None
    if json:
        report.print_json({"quality": quality, "out": out, **made})
        return
    editions = list(made["verdicts"])
    claims = dict.fromkeys(claim for found in made["verdicts"].values() for claim in found)
    rows = [[claim, *(made["verdicts"][e].get(claim, {}).get("verdict", "-") for e in editions)] for claim in claims]
    report.show(report.table("Verdicts", ("claim", *editions), rows))
    typer.echo("The paper does not give its parameters: the report says what that means for each verdict.")
    report.print_written([made["report"]])


def longest(quality: str, cases: Sequence[str] | None = None) -> int:
    """Periods T that a reproduction takes at most, over all points."""
    from whirlmap.analysis.diagnosis.diagnosis import RUNS
    from whirlmap.integrate.loading import load
    from whirlmap.studies.gear_psfd.claims.labelled import PSI
    from whirlmap.studies.gear_psfd.reproduction.edition_data import EDITIONS, edition_of, quality_named, speeds

    level = quality_named(quality)
    sweep, orbit = level.settling, level.orbit_settling
    at = speeds(level).size
    settled = at * (sweep.transient + 4 * sweep.most) + RUNS * (orbit.transient + 4 * orbit.most) + level.points
    exponents = 2 * at * level.exponent_periods + RUNS * level.most_periods
    editions = EDITIONS if cases is None else [edition_of(case) for case in cases]
    return len(PSI) * sum(load(edition.case).common_multiple * settled + exponents for edition in editions)
