"""Division of an ensemble's run: into calls of a kernel, and among models in closed form."""

import os

import numpy as np
from numpy.typing import NDArray

from whirlmap.equations.model import Model
from whirlmap.integrate.plain_models import plain_model
from whirlmap.kernels.writing.routine import LANES

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Calls of a kernel for each worker, and blocks in one call at most. Calls of fewer steps of blocks than `SHORT` are not
#: divided: they take less than some milliseconds, Python's part of a call 0.1. As little work in all starts no threads.
TASKS, MOST_BLOCKS, SHORT = 4, 16, 4096


def cores() -> int:
    """Number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def tasks_of(local: NDArray[np.intp], to_do: Integers, workers: int) -> list[NDArray[np.intp]]:
    """Whole blocks for one call of a kernel: enough calls to keep all workers busy to the end, none of them small.

    Points with about as many steps ``to_do`` share a block: it takes as long as the longest of its runs.
    """
    local = local[np.argsort(to_do[local], kind="stable")]
    steps = int(to_do[local].mean()) if local.size else 1
    blocks = -(-local.size // LANES)
    each = min(-(-blocks // (TASKS * workers)), MOST_BLOCKS) if workers > 1 else MOST_BLOCKS
    each = max(each, -(-SHORT // max(steps, 1))) * LANES
    return [local[i : i + each] for i in range(0, local.size, each)]


def variants(model: Model, values: Array) -> list[tuple[Model, NDArray[np.intp]]]:
    """Split points between a model and its plain form: a point's kernel depends on its own parameters alone."""
    everything = np.arange(values.shape[1])
    if not model.plain:
        return [(model, everything)]
    (parameter, _), *more = model.plain.items()
    assert not more, "one plain parameter is all that any model has needed"
    zero = values[model.parameters.index(parameter)] == 0.0
    split = [(plain_model(model, parameter), everything[zero]), (model, everything[~zero])]
    return [(m, members) for m, members in split if members.size]
