"""Executors of a search: this process, or the workers of a Dask cluster. The bits are the same.

A piece goes to a cluster in parts of `PART` sets, for a point's bits do not depend on its company; each part comes back as a
Dataset, so that workers need no folder in common with the store.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from whirlmap.errors import OutputError
from whirlmap.options.execution import EXECUTION, Execution
from whirlmap.studies.gear_psfd.claims.labelled import Array
from whirlmap.studies.gear_psfd.search.coarse_diagrams import METHOD, Progress, Settings, diagrams
from whirlmap.studies.gear_psfd.search.variants import Variant
from whirlmap.sweep.store.fingerprint import kernel_hash

#: Sets in one part: 900 points, some seconds of one core.
PART = 16
#: What a message about a lost cluster ends with.
GO_ON = "\n  what is finished is kept in the store; --resume goes on"


@dataclass(frozen=True)
class Task:
    """A piece of a search: its name in the store, its variant, and its sets, shape (group, set)."""

    name: str
    variant: Variant
    values: Array


def computed(
    tasks: Iterable[Task],
    settings: Settings,
    execution: Execution = EXECUTION,
) -> Iterator[tuple[str, xr.Dataset]]:
    """Compute pieces and yield each, with its name, as it is finished.

    Parameters
    ----------
    tasks : iterable of Task
        Asked for one by one: by this process when the one before is finished, for a cluster all at once.
    execution : Execution
        Threads of this process; or a client of a Dask cluster, whose workers take one core for each of their threads.

    Raises
    ------
    OutputError
        Where the scheduler is gone, or a worker failed: with an error, by dying again and again, or because it has other
        kernels than this process.
    """
    if execution.cluster is None:
        for task in tasks:
            yield task.name, diagrams(task.variant, task.values, settings, execution)
    else:
        yield from _by_cluster(list(tasks), settings, execution.cluster, execution.progress)


def _by_cluster(
    tasks: list[Task], settings: Settings, client: Any, progress: Progress | None
) -> Iterator[tuple[str, xr.Dataset]]:
    from distributed import as_completed

    parts: dict[str, dict[int, xr.Dataset]] = {task.name: {} for task in tasks}
    places: dict[str, tuple[str, int, int]] = {}  # key of a future -> piece, number of the part, and of how many
    futures = []
    try:
        for task in tasks:
            kernel = kernel_hash(task.variant.system(), METHOD)
            sets = np.array_split(task.values, range(PART, task.values.shape[1], PART), axis=1)
            for k, values in enumerate(sets):
                futures.append(client.submit(_part, task.variant, values, settings, kernel, pure=False))
                places[futures[-1].key] = task.name, k, len(sets)
        for future in as_completed(futures):
            name, k, of = places[future.key]
            if future.status in ("cancelled", "lost"):
                raise OutputError(f"the Dask scheduler is gone, and with it {name}{GO_ON}")
            if future.status == "error":  # its own, or that it killed its workers again and again
                raise OutputError(f"{name}: a worker failed: {future.exception()}{GO_ON}") from future.exception()
            parts[name][k] = future.result()
            if progress:
                progress(parts[name][k]["regime"].size)
            if len(parts[name]) == of:
                made = parts.pop(name)
                whole = xr.concat(
                    [made[at] for at in range(of)], "set", data_vars="minimal", coords="minimal", compat="override",
                    combine_attrs="drop_conflicts",
                )  # fmt: skip
                yield name, whole
    except (OSError, TimeoutError) as error:
        raise OutputError(f"the Dask scheduler is gone ({type(error).__name__}){GO_ON}") from None
    finally:
        client.cancel(futures)


def _part(variant: Variant, values: Array, settings: Settings, kernel: str) -> xr.Dataset:
    own = kernel_hash(variant.system(), METHOD)
    if own != kernel:
        raise OutputError(
            f"this worker's kernels are {own[:12]}, those of the search {kernel[:12]}: another version of whirlmap or its"
            " libraries, or another processor, WHIRLMAP_CPU or WHIRLMAP_ROOTS"
        )
    return diagrams(variant, values, settings, Execution(workers=1))
