"""``whirlmap basins``: the attractor of each start state of a slice."""

from dataclasses import replace
from typing import Annotated

import typer

from whirlmap.cli.commands.attractors import say_attractors, summary
from whirlmap.cli.common import figures_of_commands as pictures
from whirlmap.cli.common import options, report
from whirlmap.cli.common.outputs import claim
from whirlmap.cli.common.progress import Progress
from whirlmap.errors import RangeError
from whirlmap.options.computed import LABELLING, Labelling
from whirlmap.options.execution import EXECUTION, Execution

EXAMPLES = (
    "whirlmap basins duffing --set gamma=0.2 --grid x=-2:2:200 --grid v=-2:2:200 --out basins.png",
    "whirlmap basins pendulum --set g=1.35 --grid x=-3:3:60 --grid v=-3:3:60 --json",
)


@options.computing(*options.LABELS, lyapunov=options.MeasuredLyapunov)
def basins(
    case: options.CaseName,
    grid: Annotated[
        list[str],
        typer.Option(
            "--grid", metavar="STATE=START:STOP:COUNT", rich_help_panel="Start states",
            help="State and range of its start values, of a case with dimensions also 'ux=-50 um:50 um:20'; given twice. The"
            " other states keep their start value.",
        ),
    ],
    changes: options.Changes = None,
    start: options.Start = None,
    labelling: Labelling = LABELLING,
    execution: Execution = EXECUTION,
    dimensionless: options.Dimensionless = False,
    out: options.Out = None,
    size: options.Size = None,
    dpi: options.Dpi = None,
    title: options.Title = None,
    force: options.Force = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> None:  # fmt: skip
    """Colour a two-dimensional slice of start states of CASE by the attractor that each leads to.

    Starts that end in contact, diverge, or stay undecided are shown as such, and belong to no attractor.
    """
    from whirlmap.results.memory import refuse_points
    from whirlmap.sweep.parameters.ranges import Range

    ranges = [Range.parse(text, "--grid") for text in grid]
    if len(ranges) != 2 or ranges[0].name == ranges[1].name:
        raise RangeError(f"--grid: found {' and '.join(r.name for r in ranges)}, expected two different states")
    refuse_points(r.count for r in ranges)
    destination = claim(out, "basins", force=force, size=size, dpi=dpi, title=title)
    system = options.open_system(case, changes, start)
    from whirlmap.integrate.dimensions import Dimensions
    from whirlmap.sweep.attractors.basins import basins as find
    from whirlmap.sweep.diagrams.in_batches import expected_periods
    from whirlmap.sweep.parameters.own_units import in_states

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
