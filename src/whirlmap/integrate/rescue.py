"""What happens to a lane whose step failed: an event is located, a step that was too long is redone with shorter ones."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from whirlmap.equations.model import Model
from whirlmap.integrate.scales import GROWTH
from whirlmap.kernels.formulas import Formula, numpy_function
from whirlmap.kernels.lanes import blocked, lane_kernel, slopes_for, unblocked
from whirlmap.kernels.methods import Method
from whirlmap.kernels.routine import LANES
from whirlmap.kernels.saltation import CHATTERS, STICKS
from whirlmap.results.status import Status

Array = NDArray[np.float64]

#: Halvings of a failed step before the point counts as unresolved.
SHORTEST = 10
#: Bisections of a step that ends at a closed gap: the bracket shrinks to 1e-15 of the step.
BISECTIONS = 50
#: Substeps of every trial of the bisection.
TRIAL_STEPS = 4
#: A gap that has shrunk to this part of its size over the step at the bracket's open end is an event; above it, the step
#: failed for another reason.
CLOSED = 1e-6
#: Part of its bound, and growth since the start where the model declares none, from which a point has diverged whose
#: steps fail.
NEAR, GROWN = 1e-2, 1e6


@dataclass(frozen=True)
class Outcome:
    """How failed points went on, each array of shape (point,)."""

    status: NDArray[np.int8]
    time: Array
    stop: NDArray[np.int8]


class Rescue:
    """Redoes failed steps of one group of points, all that were lost together.

    1. A lane whose step ends finite, at open gaps but beyond its limits (`scales.limits`), has diverged.
    2. The step is redone in 4, 16, 64, 256 and 1024 shorter ones; a lane that gets through goes on.
    3. Where a gap may physically close, the end is bisected: the last time at which the step still ends at open gaps.
    4. What is left has diverged if it was near its bound (`NEAR`) or had grown far (`GROWN`), else it is unresolved.

    With ``redo`` off, 2 is left out and 3 is done where the step plainly ended behind a stop.
    """

    def __init__(
        self, model: Model, method: Method, tangents: int, values: Array, limits: Array, *, redo: bool = True
    ) -> None:
        self.model, self.method, self.tangents, self.values, self.redo = model, method, tangents, values, redo
        self.limits, self.near = limits, NEAR if model.bound is not None else GROWN / GROWTH

    def mend(
        self, members: NDArray[np.intp], y: Array, time: Array, h: Array, cause: NDArray[np.int64]
    ) -> Outcome:
        """Redo the step of some points from ``y``, shape (row, point), at ``time``; ``y`` of those that go on is replaced.

        ``members`` holds the group's indices of the points, ``cause`` why they were lost in a step through surfaces: shorter
        steps help neither a point that sticks nor one that chatters.
        """
        points = members.size
        status = np.zeros(points, dtype=np.int8)
        end, stop = np.full(points, np.nan), np.full(points, -1, dtype=np.int8)
        for reason, name in ((STICKS, Status.sticks), (CHATTERS, Status.chatters)):
            status[cause == reason] = name
        end[status != Status.ok] = time[status != Status.ok]
        pending = status == Status.ok
        if not pending.any():
            return Outcome(status, end, stop)
        n = self.model.dimension
        after, _ = self._march(members, y, time, h, 1)
        size = self._size(members, after[:n])
        closed = self._gaps(members, after[:n]) <= 0
        diverged = pending & np.isfinite(size) & ~closed.any(axis=0) & (size >= 1)
        status[diverged], end[diverged] = Status.diverged, (time + h)[diverged]
        pending &= ~diverged
        # A step that plainly ends behind a gap which can close is an event: shorter steps would only find it again.
        reachable = self._reachable(members)
        plainly = pending & np.isfinite(size) & (closed & reachable).any(axis=0)
        for halvings in range(2, SHORTEST + 1, 2):
            trying = np.flatnonzero(pending & ~plainly)
            if not (trying.size and self.redo):
                break
            parts = 2**halvings
            again, good = self._march(members[trying], y[:, trying], time[trying], h[trying] / parts, parts)
            y[:, trying[good]] = again[:, good]
            pending[trying[good]] = False
        candidates = np.flatnonzero(pending & reachable.any(axis=0) if self.redo else plainly)
        if candidates.size:
            self._locate(members, candidates, y, time, h, status, end, stop)
        left = pending & (status == Status.ok)
        near = self._size(members, y[:n]) > self.near
        status[left & near], status[left & ~near] = Status.diverged, Status.unresolved
        end[left] = time[left]
        return Outcome(status, end, stop)

    def _locate(
        self, members: NDArray[np.intp], which: NDArray[np.intp], y: Array, time: Array, h: Array,
        status: NDArray[np.int8], end: Array, stop: NDArray[np.int8],
    ) -> None:  # fmt: skip
        """Bisect the end of the step between its good start and its bad end."""
        low, high = np.zeros(which.size), np.ones(which.size)
        here, begin, last = members[which], y[:, which], y[:, which].copy()
        for _ in range(BISECTIONS):
            middle = (low + high) / 2
            trial, good = self._march(here, begin, time[which], h[which] * middle / TRIAL_STEPS, TRIAL_STEPS)
            low, high = np.where(good, middle, low), np.where(good, high, middle)
            last[:, good] = trial[:, good]
        reachable, n = self._reachable(here), self.model.dimension
        gaps = np.where(reachable, self._gaps(here, last[:n]), np.inf)
        # What a gap is small against: its own size where the step begins and, if that is a number, where it ends.
        end_gaps = np.abs(self._gaps(here, self._march(here, begin, time[which], h[which], 1)[0][:n]))
        size_of_gaps = np.fmax(np.abs(self._gaps(here, begin[:n])), np.where(np.isfinite(end_gaps), end_gaps, 0.0))
        left = np.divide(gaps, size_of_gaps, out=np.full_like(gaps, np.inf), where=size_of_gaps > 0)
        event = left.min(axis=0, initial=np.inf) <= CLOSED
        found = which[event]
        y[:, found] = last[:, event]
        status[found], end[found] = Status.contact, (time[which] + low * h[which])[event]
        stop[found] = left.argmin(axis=0)[event] if left.shape[0] else -1

    def _march(
        self, members: NDArray[np.intp], y: Array, time: Array, h: Array, steps: int
    ) -> tuple[Array, NDArray[np.bool_]]:
        kernel = lane_kernel(self.model, self.method, slopes=slopes_for(self.tangents), kind="free")
        run, points = blocked(y), members.size
        good = np.zeros((run.shape[0], 1, LANES), dtype=np.int64)
        kernel.march(
            blocks=run.shape[0], count=self.tangents, y=run, time=blocked(time[None]), h=blocked(h[None]),
            **kernel.inputs(self.values[:, members], self.limits[:, members]).blocks(np.arange(points)), steps=steps,
            good=good,
            work=kernel.work(),
        )  # fmt: skip
        return unblocked(run, points), unblocked(good, points)[0] != 0

    def _size(self, members: NDArray[np.intp], x: Array) -> Array:
        """States over their limits, summed as the kernel does; not a number where a state is not finite."""
        with np.errstate(invalid="ignore"):
            total: Array = (np.abs(x) / self.limits[:, members]).sum(axis=0)
        return np.where(np.isfinite(x).all(axis=0), total, np.nan)

    def _gaps(self, members: NDArray[np.intp], x: Array) -> Array:
        return self._stops("gap", members, x)

    def _reachable(self, members: NDArray[np.intp]) -> NDArray[np.bool_]:
        return self._stops("reachable", members, np.zeros((self.model.dimension, members.size))) > 0

    def _stops(self, field: Literal["gap", "reachable"], members: NDArray[np.intp], x: Array) -> Array:
        with np.errstate(over="ignore", invalid="ignore"):  # a state that has run away has no gap worth knowing
            rows = stop_function(self.model, field)(list(x), list(self.values[:, members]))
        return np.array([np.broadcast_to(np.asarray(r, dtype=float), members.shape) for r in rows]).reshape(-1, members.size)


@lru_cache(maxsize=64)
def stop_function(model: Model, field: Literal["gap", "reachable"]) -> Callable[..., Any]:
    """One field of each of a model's stops, as a function of lists of states and parameters."""
    expressions = [getattr(stop, field) for stop in model.stops.values()]
    return numpy_function(model, f"stops: {field}", lambda: Formula([model.states, model.parameters], expressions))
