"""``whirlmap basins``: which attractor each start state of a slice leads to."""



from pathlib import Path

from whirlmap.analysis.steady.settling import Settling
from whirlmap.cli.commands.attractors import say_attractors, summary
from whirlmap.cli.common import pictures, report
from whirlmap.cli.common.opening import open_system
from whirlmap.cli.common.outputs import claim
from whirlmap.cli.common.progress import Progress
from whirlmap.cli.common.ranges import in_states, read_range
from whirlmap.errors import RangeError
from whirlmap.integrate.dimensions import Dimensions
from whirlmap.results.memory import refuse_points
from whirlmap.sweep.attractors.basins import basins_in_parts as find
from whirlmap.sweep.diagrams.in_batches import expected_periods


def basins(
    *, case: str, grid: list[str], changes: list[str] | None, start: list[str] | None, transient: int, most: int,
    tolerance: float, lyapunov: int | None, steps: int | None, accuracy: float | None, method: str | None,
    workers: int | None, dimensionless: bool, out: Path | None, size: str | None, dpi: int | None, title: str | None,
    force: bool, json: bool, quiet: bool,
) -> None:  # fmt: skip
    """Do what `whirlmap.cli.declared.basins` says."""
    read = [read_range(text, "--grid") for text in grid]
    ranges = [one for one, _ in read]
    if len(ranges) != 2 or ranges[0].name == ranges[1].name:
        raise RangeError(f"--grid: found {' and '.join(r.name for r in ranges)}, expected two different states")
    refuse_points(r.count for r in ranges)
    destination = claim(out, "basins", force=force, size=size, dpi=dpi, title=title)
    system = open_system(case, changes, start)
    ranges = [in_states(system, *one, option="--grid") for one in read]

    settling = Settling(transient=transient, most=most, tolerance=tolerance)
    points = ranges[0].count * ranges[1].count
    with Progress("basins", expected_periods(system, points, settling), quiet=quiet, points=points) as progress:
        work = find(
            system, {r.name: r.values for r in ranges}, settling=settling, lyapunov=lyapunov, steps=steps,
            accuracy=accuracy, method=method, workers=workers, progress=progress,
        )  # fmt: skip
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
        report.interrupted(facts["incomplete"], files, "the same command settles all starts anew")
