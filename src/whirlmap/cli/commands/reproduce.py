"""``whirlmap reproduce``: the paper's figures and the verdict on its claims."""

import time
from collections.abc import Sequence
from pathlib import Path

import typer

from whirlmap.analysis.diagnosis.diagnosis import RUNS
from whirlmap.cli.common import report
from whirlmap.cli.common.interrupts import INTERRUPTED
from whirlmap.cli.common.messages import choice, say
from whirlmap.cli.common.progress import Progress
from whirlmap.integrate.loading import load
from whirlmap.studies.gear_psfd.claims.labelled import PSI
from whirlmap.studies.gear_psfd.reproduction.edition_data import EDITIONS, edition_of, quality_named, speeds
from whirlmap.studies.gear_psfd.reproduction.reproduce import reproduce as run

QUALITIES = ("quick", "full")


def reproduce(
    *, quality: str, case: list[str] | None, out: Path, workers: int | None, json: bool, quiet: bool,
) -> None:  # fmt: skip
    """Do what `whirlmap.cli.declared.reproduce` says."""
    choice("--quality", quality, QUALITIES)

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
    level = quality_named(quality)
    sweep, orbit = level.settling, level.orbit_settling
    at = speeds(level).size
    settled = at * (sweep.transient + 4 * sweep.most) + RUNS * (orbit.transient + 4 * orbit.most) + level.points
    exponents = 2 * at * level.exponent_periods + RUNS * level.most_periods
    editions = EDITIONS if cases is None else [edition_of(case) for case in cases]
    return len(PSI) * sum(load(edition.case).common_multiple * settled + exponents for edition in editions)
