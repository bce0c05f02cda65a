"""``whirlmap speeds``: safe speed windows within a limit of vibration, and the reason for every other speed."""

import json as js
from dataclasses import replace
from pathlib import Path

import numpy as np

from whirlmap.cli.common import pictures, report, speed_report
from whirlmap.cli.common.assignments import tolerances_of
from whirlmap.cli.common.opening import open_system
from whirlmap.cli.common.outputs import claim
from whirlmap.cli.common.progress import Progress
from whirlmap.cli.common.violated import say_assumptions
from whirlmap.integrate.dimensions import Dimensions
from whirlmap.options.computed import Labelling
from whirlmap.options.execution import Execution
from whirlmap.results.memory import refuse_points
from whirlmap.sweep.diagrams.in_batches import expected_periods
from whirlmap.sweep.parameters.engineering import drawn_machines, limit_of, speeds_of
from whirlmap.sweep.speeds.designs import safe_probability
from whirlmap.sweep.speeds.safe_speeds import safe_speeds


def speeds(
    *, case: str, limit: str | None, span: str | None, points: int, quantity: str | None, follow: bool,
    input_tolerance: list[str] | None, draws: int, seed: int, changes: list[str] | None, start: list[str] | None,
    labelling: Labelling, execution: Execution, dimensionless: bool, out: Path | None, size: str | None, dpi: int | None,
    title: str | None, force: bool, json: bool, quiet: bool,
) -> None:  # fmt: skip
    """Do what `whirlmap.cli.declared.speeds` says."""
    tolerances = tolerances_of(input_tolerance)
    destination = claim(out, "speeds", force=force, size=size, dpi=dpi, title=title)
    system = open_system(case, changes, start)

    allowed = limit_of(system, limit, "--limit")
    low, high = speeds_of(system, span, "--range")
    refuse_points([points, draws] if tolerances else [points])
    at = np.linspace(low, high, points)
    judged = points * (3 if follow else 1)
    drawn_points = judged * draws if tolerances else 0
    with Progress("speeds", expected_periods(system, judged, labelling.settling), quiet=quiet, points=judged) as progress:
        progress.later(drawn_points)
        execution = replace(execution, progress=progress)
        work = safe_speeds.parts(
            system, at, allowed, quantity=quantity, follow=follow, labelling=labelling, execution=execution
        ).run()  # fmt: skip
        if work.dataset is None:
            raise KeyboardInterrupt
        ds = work.dataset
        if tolerances and work.complete:
            progress.later(0)
            progress.more_points(drawn_points)
            drawn, limits = drawn_machines(system, tolerances, draws, allowed, seed=seed, option="--input-tolerance")
            try:
                chance = safe_probability(
                    system, drawn, at, limits, quantity=quantity, follow=follow, labelling=labelling, execution=execution
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
    facts["assumptions"] = say_assumptions(system, {system.speed: (low, high)})
    if json:
        report.print_json({**facts, "files": files})
    else:
        speed_report.show(facts)
        report.print_written(files)
    if facts["incomplete"]:
        report.interrupted(facts["incomplete"], files, "the same command judges all speeds again; with --range, fewer")
