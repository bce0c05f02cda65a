"""What happens to a lane whose step failed: an event is located, a step that was too long is redone with shorter ones."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from whirlmap.equations.model import Model
from whirlmap.kernels.formulas import Formula, numpy_function
from whirlmap.kernels.lanes import lane_kernel
from whirlmap.kernels.methods import Method
from whirlmap.kernels.source import LANES
from whirlmap.results.status import Status

Array = NDArray[np.float64]

#: Halvings of a failed step before the point counts as unresolved.
SHORTEST = 10
#: Bisections of a step that ends at a closed gap: the bracket shrinks to 1e-15 of the step.
BISECTIONS = 50
#: Substeps of every trial of the bisection.
TRIAL_STEPS = 4
#: A gap below this at the bracket's open end is an event; above it, the step failed for another reason.
CLOSED = 1e-6


@dataclass(frozen=True)
class Outcome:
    """How failed lanes went on, each array of shape (lane,)."""

    status: NDArray[np.int8]
    time: Array
    stop: NDArray[np.int8]


class Rescue:
    """Redoes failed steps of one group of points, all lost lanes of a block together.

    1. A lane whose step ends finite, at open gaps but beyond the model's bound, has diverged.
    2. The step is redone in 4, 16, 64, 256 and 1024 shorter ones; a lane that gets through goes on.
    3. Where a gap may physically close, the end is bisected: the last time at which the step still ends at open gaps.
    4. What is left has diverged if it was near its bound, else it is unresolved.

    With ``redo`` off, 2 is left out and 3 is done where the step plainly ended behind a stop.
    """

    def __init__(self, model: Model, method: Method, tangents: int, values: Array, *, redo: bool = True) -> None:
        self.model, self.method, self.tangents, self.values, self.redo = model, method, tangents, values, redo
        self.cyclic = np.array([s.cyclic is not None for s in model.states])

    def mend(self, lanes: NDArray[np.intp], lost: NDArray[np.intp], y: Array, time: Array, h: Array) -> Outcome:
        """Redo the step of the lost lanes of a block from ``y`` at ``time``; ``y`` of those that go on is replaced.

        ``lanes`` holds the group's indices of the points in the block, ``lost`` the positions of those that failed.
        """
        status = np.zeros(LANES, dtype=np.int8)
        end, stop = np.full(LANES, np.nan), np.full(LANES, -1, dtype=np.int8)
        pending = np.zeros(LANES, dtype=bool)
        pending[lost] = True
        n = self.model.dimension
        after, _ = self._march(lanes, y, time, h, 1)
        size = np.abs(after[:n][~self.cyclic]).sum(axis=0)
        closed = self._gaps(lanes, after[:n]) <= 0
        diverged = pending & np.isfinite(size) & ~closed.any(axis=0) & (size >= self.model.bound)
        status[diverged], end[diverged] = Status.diverged, (time + h)[diverged]
        pending &= ~diverged
        # A step that plainly ends behind a gap which can close is an event: shorter steps would only find it again.
        reachable = self._reachable(lanes)
        plainly = pending & np.isfinite(size) & (closed & reachable).any(axis=0)
        for halvings in range(2, SHORTEST + 1, 2):
            trying = pending & ~plainly
            if not (trying.any() and self.redo):
                break
            parts = 2**halvings
            again, good = self._march(lanes, y, time, h / parts, parts)
            through = trying & good
            y[:, through] = again[:, through]
            pending &= ~through
        candidates = pending & reachable.any(axis=0) if self.redo else plainly
        if candidates.any():
            self._locate(lanes, candidates, y, time, h, status, end, stop)
        left = pending & (status == Status.ok)
        near = np.abs(y[:n][~self.cyclic]).sum(axis=0) > 1e-2 * self.model.bound
        status[left & near], status[left & ~near] = Status.diverged, Status.unresolved
        end[left] = time[left]
        return Outcome(status, end, stop)

    def _locate(
        self, lanes: NDArray[np.intp], which: NDArray[np.bool_], y: Array, time: Array, h: Array,
        status: NDArray[np.int8], end: Array, stop: NDArray[np.int8],
    ) -> None:  # fmt: skip
        """Bisect the end of the step between its good start and its bad end."""
        low, high = np.zeros(LANES), np.ones(LANES)
        last = y.copy()
        for _ in range(BISECTIONS):
            middle = (low + high) / 2
            trial, good = self._march(lanes, y, time, h * middle / TRIAL_STEPS, TRIAL_STEPS)
            low, high = np.where(good, middle, low), np.where(good, high, middle)
            last[:, good] = trial[:, good]
        gaps = np.where(self._reachable(lanes), self._gaps(lanes, last[: self.model.dimension]), np.inf)
        event = which & (gaps.min(axis=0, initial=np.inf) < CLOSED)
        y[:, event] = last[:, event]
        status[event], end[event] = Status.contact, (time + low * h)[event]
        stop[event] = gaps.argmin(axis=0)[event] if gaps.shape[0] else -1

    def _march(
        self, lanes: NDArray[np.intp], y: Array, time: Array, h: Array, steps: int
    ) -> tuple[Array, NDArray[np.bool_]]:
        kernel = lane_kernel(self.model, self.method, tangents=self.tangents > 0, kind="free")
        p, tables, offsets = kernel.inputs(self.values[:, lanes]).lanes(np.arange(LANES))
        flat, good = y.copy().ravel(), np.zeros(LANES, dtype=np.int64)
        wide = np.tile(h, self.model.dimension)
        kernel.module.march(flat, time.copy(), wide, p.ravel(), tables, offsets.ravel(), steps, good)
        return flat.reshape(y.shape), good > 0

    def _gaps(self, lanes: NDArray[np.intp], x: Array) -> Array:
        return self._stops("gap", lanes, x)

    def _reachable(self, lanes: NDArray[np.intp]) -> NDArray[np.bool_]:
        return self._stops("reachable", lanes, np.zeros((self.model.dimension, LANES))) > 0

    def _stops(self, field: Literal["gap", "reachable"], lanes: NDArray[np.intp], x: Array) -> Array:
        with np.errstate(over="ignore", invalid="ignore"):  # a state that has run away has no gap worth knowing
            rows = stop_function(self.model, field)(list(x), list(self.values[:, lanes]))
        return np.array([np.broadcast_to(np.asarray(r, dtype=float), (LANES,)) for r in rows]).reshape(-1, LANES)


@lru_cache(maxsize=64)
def stop_function(model: Model, field: Literal["gap", "reachable"]) -> Callable[..., Any]:
    """One field of each of a model's stops, as a function of lists of states and parameters."""
    expressions = [getattr(stop, field) for stop in model.stops.values()]
    return numpy_function(model, f"stops: {field}", lambda: Formula([model.states, model.parameters], expressions))
