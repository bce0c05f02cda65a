"""``whirlmap basins``: the attractor of each start state of a slice."""

from dataclasses import replace
from pathlib import Path

from whirlmap.cli.commands.attractors import say_attractors, summary
from whirlmap.cli.common import pictures, report
from whirlmap.cli.common.opening import open_system
from whirlmap.cli.common.outputs import claim
from whirlmap.cli.common.progress import Progress
from whirlmap.errors import RangeError
from whirlmap.integrate.dimensions import Dimensions
from whirlmap.integrate.own_units import in_states
from whirlmap.integrate.ranges import Range
from whirlmap.options.computed import Labelling
from whirlmap.options.execution import Execution
from whirlmap.results.memory import refuse_points
from whirlmap.sweep.attractors.basins import basins as find
from whirlmap.sweep.diagrams.in_batches import expected_periods


def basins(
    *, case: str, grid: list[str], changes: list[str] | None, start: list[str] | None, labelling: Labelling,
    execution: Execution, dimensionless: bool, out: Path | None, size: str | None, dpi: int | None, title: str | None,
    force: bool, json: bool, quiet: bool,
) -> None:  # fmt: skip
    """Do what `whirlmap.cli.declared.basins` says."""
    ranges = [Range.parse(text, "--grid") for text in grid]
    if len(ranges) != 2 or ranges[0].name == ranges[1].name:
        raise RangeError(f"--grid: found {' and '.join(r.name for r in ranges)}, expected two different states")
    refuse_points(r.count for r in ranges)
    destination = claim(out, "basins", force=force, size=size, dpi=dpi, title=title)
    system = open_system(case, changes, start)

    ranges = [in_states(system, one, "--grid") for one in ranges]
    points = ranges[0].count * ranges[1].count
    with Progress("basins", expected_periods(system, points, labelling.settling), quiet=quiet, points=points) as progress:
        axes = {r.name: r.values for r in ranges}
        work = find.parts(system, axes, labelling=labelling, execution=replace(execution, progress=progress)).run()
    if work.dataset is None:
        raise KeyboardInterrupt
    ds, units = work.dataset, Dimensions(system, own=dimensionless)
    files = destination.write(ds, lambda done: pictures.basins(units, done))
    report.say_doubts(ds.attrs)
    facts = summary(units, ds)
    if json:
        report.print_json({**facts, "grid": {r.name: [r.start, r.stop, r.count] for r in ranges}, "files": files})
    else:
        say_attractors(facts)
        report.print_written(files)
    if not work.complete:
        report.interrupted(facts["incomplete"], files, "the same command integrates all starts again")
