"""``whirlmap speeds``: where may this machine run, within a limit of vibration, and why not elsewhere."""

import json as js
from pathlib import Path

import numpy as np

from whirlmap.analysis.steady.settling import Settling
from whirlmap.cli.common import pictures, report, speed_report
from whirlmap.cli.common.assignments import assignments
from whirlmap.cli.common.engineering_input import drawn_machines, limit_of, range_of, tolerances_of
from whirlmap.cli.common.opening import open_system
from whirlmap.cli.common.outputs import claim
from whirlmap.cli.common.progress import Progress
from whirlmap.cli.common.strains import say_assumptions
from whirlmap.integrate.dimensions import Dimensions
from whirlmap.results.memory import refuse_points
from whirlmap.sweep.diagrams.in_batches import expected_periods
from whirlmap.sweep.speeds.designs import safe_probability
from whirlmap.sweep.speeds.safe_speeds import safe_speeds_in_parts


def speeds(
    *, case: str, limit: str | None, span: str | None, points: int, quantity: str | None, follow: bool,
    tolerance: list[str] | None, draws: int, seed: int, changes: list[str] | None, start: list[str] | None,
    transient: int, accuracy: float | None, method: str | None, workers: int | None, dimensionless: bool,
    out: Path | None, size: str | None, dpi: int | None, title: str | None, force: bool, json: bool, quiet: bool,
) -> None:  # fmt: skip
    """Do what `whirlmap.cli.declared.speeds` says."""
    tolerances = tolerances_of(tolerance)
    destination = claim(out, "speeds", force=force, size=size, dpi=dpi, title=title)
    system = open_system(case, changes, start)

    allowed = limit_of(system, limit)
    low, high = range_of(system, span)
    refuse_points([points, draws] if tolerances else [points])
    at, settling = np.linspace(low, high, points), Settling(transient=transient)
    judged = points * (3 if follow else 1)
    drawn_points = judged * draws if tolerances else 0
    with Progress("speeds", expected_periods(system, judged, settling), quiet=quiet, points=judged) as progress:
        progress.later(drawn_points)
        work = safe_speeds_in_parts(
            system, at, allowed, quantity=quantity, follow=follow, settling=settling, accuracy=accuracy, method=method,
            workers=workers, progress=progress,
        )  # fmt: skip
        if work.dataset is None:
            raise KeyboardInterrupt
        ds = work.dataset
        if tolerances and work.complete:
            progress.later(0)
            progress.more_points(drawn_points)
            settings = assignments(changes, "--set")
            drawn, limits = drawn_machines(system, case, settings, tolerances, draws, seed, allowed)
            try:
                chance = safe_probability(
                    system, drawn, at, limits, quantity=quantity, follow=follow, settling=settling, accuracy=accuracy,
                    method=method, workers=workers, progress=progress,
                )  # fmt: skip
            except KeyboardInterrupt:
                ds.attrs["incomplete"] = "interrupted before the probabilities over the tolerances were known"
            else:
                report.say_doubts(chance.attrs)
                ds = ds.merge(chance, combine_attrs="override")
                ds = ds.assign_attrs(seed=seed, draws=draws, tolerances=js.dumps(tolerances))
    units = Dimensions(system, own=dimensionless)
    files = destination.write(ds, lambda made: pictures.speeds(units, made))
    report.say_doubts(ds.attrs)
    facts = speed_report.summary(units, ds)
    facts["assumptions"] = say_assumptions(system, {"s": (low, high)})
    if json:
        report.print_json({**facts, "files": files})
    else:
        speed_report.show(facts)
        report.print_written(files)
    if facts["incomplete"]:
        report.interrupted(facts["incomplete"], files, "the same command judges all speeds anew; with --range, fewer")
