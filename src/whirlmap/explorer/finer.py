"""Maps and diagrams computed while the page looks on: of a case, of other values, or of a range that one zoomed into."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from whirlmap.explorer.exploration import Exploration, axis_of, axis_values
from whirlmap.explorer.jobs import Job
from whirlmap.explorer.overview import overview
from whirlmap.integrate.system import System
from whirlmap.options.execution import Execution
from whirlmap.options.storage import Storage
from whirlmap.sweep.diagrams.in_batches import diagram_in_batches
from whirlmap.sweep.maps.run_sweep import ChunkReport, run_sweep
from whirlmap.sweep.parameters.space import space_of
from whirlmap.sweep.store.zarr_store import Store

#: Points of a diagram, and of each axis of a map, that a zoom computes where the page does not say how many.
DIAGRAM, MAP = 160, 32
#: Points of a chunk of a map that is not kept: so many appear, or are lost where it is cancelled, at once.
LIVE = 48

Axes = Mapping[str, tuple[Sequence[float], str]]


def range_axes(exploration: Exploration, ranges: Mapping[str, tuple[float, float]], count: int | None = None) -> Axes:
    """Axes of an exploration over a part of their ranges, evenly or logarithmically spaced as the slider of each is."""
    number = count or (DIAGRAM if len(exploration.axes) == 1 else MAP)
    axes = {}
    for name, (values, unit) in exploration.axes.items():
        low, high = ranges.get(name, (float(values[0]), float(values[-1])))
        spaced = np.geomspace if exploration.controls[name].log and low > 0 else np.linspace
        axes[name] = spaced(low, high, number).tolist(), unit
    return axes


def compute(
    job: Job, exploration: Exploration, system: System, axes: Axes, *, workers: int | None = None, store: Path | None = None
) -> Any:
    """Label all points of a diagram or a map; the job's result grows while they come.

    Parameters
    ----------
    store : Path, optional
        Where a map is kept; in a passing folder where absent.

    Returns
    -------
    xr.Dataset
        The labelled points.
    """
    names = list(axes)
    if len(names) == 1:
        (name,), (values, unit) = names, axes[names[0]]
        work = diagram_in_batches(
            system, name, axis_of(system, name, values, unit), follow=exploration.follow, labelling=exploration.labelling,
            execution=Execution(workers, lambda _: job.check()), batch=16,
        )  # fmt: skip
        job.total = work.total
        for done in work:
            job.done = done
            job.check()
            ds = work.dataset
            if ds is not None:
                filled = np.asarray(ds[name], dtype=float).tolist()
                job.put(overview(system, {name: (filled, unit)}, ds))
        return work.dataset
    vary = {name: axis_values(values, unit) for name, (values, unit) in axes.items()}
    space = space_of(system, vary)
    job.total = space.points
    with TemporaryDirectory(prefix="whirlmap-") as passing:
        place = store or Path(passing) / "map"
        kept = Storage(place, resume=True) if store else Storage(place, chunk=LIVE)

        def look(now: ChunkReport) -> None:
            job.done = now.points_done
            job.check()
            job.put(overview(system, axes, Store(place).open().load()))

        ds = run_sweep(
            system, space, exploration.labelling, Execution(workers), kept,
            refine=False, sections=False, on_chunk=look,
        ).load()  # fmt: skip
    job.put(overview(system, axes, ds))
    return ds

