"""Failed steps: locate terminal events, or repeat with smaller steps."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from whirlmap.equations.model import Model
from whirlmap.integrate.scales import GROWTH
from whirlmap.kernels.lowering.formulas import Formula, numpy_function
from whirlmap.kernels.lowering.poles import pole_guards, poles
from whirlmap.kernels.methods import Method
from whirlmap.kernels.running.lanes import blocked, lane_kernel, slopes_for, unblocked
from whirlmap.kernels.writing.routine import LANES
from whirlmap.kernels.writing.saltation import CHATTERS, STICKS
from whirlmap.results.status import Status

Array = NDArray[np.float64]

#: Halvings of a failed step before the point counts as unresolved.
SHORTEST = 10
#: Bisections of a step that ends at a closed gap: the bracket shrinks to 1e-15 of the step.
BISECTIONS = 50
#: Substeps of every trial of the bisection.
TRIAL_STEPS = 4
#: Fall of a denominator in the second half of these bisections that shows a pole ahead; before a wall it stands still.
VANISHES = 0.5
#: A gap that has shrunk to this part of its size over the step at the bracket's open end is an event; above it, the step
#: failed for another reason.
CLOSED = 1e-6
#: Part of its bound, and growth since the start where the model declares none, from which a point has diverged whose
#: steps fail.
NEAR, GROWN = 1e-2, 1e5


@dataclass(frozen=True)
class RetryResult:
    """Result of repeating failed steps, each array of shape (point,); times are since the beginning of the step."""

    status: NDArray[np.int8]
    time: Array
    stop: NDArray[np.int8]


class StepRetry:
    """Repeats failed steps of one kernel batch, all that failed together.

    1. A lane whose step ends finite, at open gaps, but beyond its limits (`scales.limits`), has diverged; where there are
       poles only if nothing else is found, for a step may be thrown there by one.
    2. The step is redone in 4, 16, 64, 256 and 1024 shorter ones; a lane that gets through goes on.
    3. Where a gap may physically close, the end is bisected: the last time at which the step still ends at open gaps.
    4. What is left has diverged if it runs into a pole (`kernels.lowering.poles`), which counts on behind the model's stops
    as what
       ended it, if it was near its bound (`NEAR`) or had grown far (`GROWN`); else it is unresolved.

    With ``redo`` off, 2 is left out and 3 is done where the step plainly ended behind a stop.
    """

    def __init__(
        self, model: Model, method: Method, tangents: int, values: Array, limits: Array, *, redo: bool = True
    ) -> None:
        self.model, self.method, self.tangents, self.values, self.redo = model, method, tangents, values, redo
        self.limits, self.near = limits, NEAR if model.bound is not None else GROWN / GROWTH
        self.singular = bool(pole_function(model)(list(np.zeros(model.dimension)), list(np.zeros(len(model.parameters)))))

    def retry(
        self, members: NDArray[np.intp], y: Array, origin: Array, h: Array, cause: NDArray[np.int64]
    ) -> RetryResult:
        """Redo the step of some points from ``y``, shape (row, point); ``y`` of those that go on is replaced.

        ``origin`` holds the angle of each harmonic at its beginning, shape (harmonic, point), since which time counts.

        ``members`` holds the group's indices of the points, ``cause`` why they were lost in a step through surfaces: shorter
        steps do not help a point that sticks.
        """
        points = members.size
        status = np.zeros(points, dtype=np.int8)
        end, stop = np.full(points, np.nan), np.full(points, -1, dtype=np.int8)
        status[cause == STICKS], end[cause == STICKS] = Status.sticks, 0.0
        pending = status == Status.ok
        if not pending.any():
            return RetryResult(status, end, stop)
        n = self.model.dimension
        after, _ = self._march(members, y, origin, h, 1)
        size = self._size(members, after[:n])
        closed = self._gaps(members, after[:n]) <= 0
        beyond = pending & np.isfinite(size) & ~closed.any(axis=0) & (size >= 1)
        if not self.singular:
            status[beyond], end[beyond] = Status.diverged, h[beyond]
            pending &= ~beyond
        # A step that plainly ends behind a gap which can close is an event: shorter steps would only find it again.
        reachable = self._reachable(members)
        plainly = pending & np.isfinite(size) & (closed & reachable).any(axis=0)
        for halvings in range(2, SHORTEST + 1, 2):
            trying = np.flatnonzero(pending & ~plainly)
            if not (trying.size and self.redo):
                break
            parts = 2**halvings
            again, good = self._march(members[trying], y[:, trying], origin[:, trying], h[trying] / parts, parts)
            y[:, trying[good]] = again[:, good]
            pending[trying[good]] = False
        candidates = np.flatnonzero(pending & reachable.any(axis=0) if self.redo else plainly)
        if candidates.size:
            self._locate(members, candidates, y, origin, h, status, end, stop)
        left = pending & (status == Status.ok)
        if self.singular and left.any():
            self._approach(members, np.flatnonzero(left), y, origin, h, status, end, stop)
            left &= status == Status.ok
            status[left & beyond], end[left & beyond] = Status.diverged, h[left & beyond]
            left &= ~beyond
        near = self._size(members, y[:n]) > self.near
        status[left & near], status[left & ~near] = Status.diverged, Status.unresolved
        status[left & ~near & (cause == CHATTERS)] = Status.chatters
        end[left] = 0.0
        return RetryResult(status, end, stop)

    def _locate(
        self, members: NDArray[np.intp], which: NDArray[np.intp], y: Array, origin: Array, h: Array,
        status: NDArray[np.int8], end: Array, stop: NDArray[np.int8],
    ) -> None:  # fmt: skip
        """Bisect the end of the step between its good start and its bad end."""
        low, high = np.zeros(which.size), np.ones(which.size)
        here, begin, last = members[which], y[:, which], y[:, which].copy()
        for _ in range(BISECTIONS):
            middle = (low + high) / 2
            trial, good = self._march(here, begin, origin[:, which], h[which] * middle / TRIAL_STEPS, TRIAL_STEPS)
            low, high = np.where(good, middle, low), np.where(good, high, middle)
            last[:, good] = trial[:, good]
        reachable, n = self._reachable(here), self.model.dimension
        gaps = np.where(reachable, self._gaps(here, last[:n]), np.inf)
        # What a gap is small against: its own size where the step begins and, if that is a number, where it ends.
        end_gaps = np.abs(self._gaps(here, self._march(here, begin, origin[:, which], h[which], 1)[0][:n]))
        size_of_gaps = np.fmax(np.abs(self._gaps(here, begin[:n])), np.where(np.isfinite(end_gaps), end_gaps, 0.0))
        left = np.divide(gaps, size_of_gaps, out=np.full_like(gaps, np.inf), where=size_of_gaps > 0)
        event = left.min(axis=0, initial=np.inf) <= CLOSED
        found = which[event]
        y[:, found] = last[:, event]
        status[found], end[found] = Status.contact, (low * h[which])[event]
        stop[found] = left.argmin(axis=0)[event] if left.shape[0] else -1

    def _approach(
        self, members: NDArray[np.intp], which: NDArray[np.intp], y: Array, origin: Array, h: Array,
        status: NDArray[np.int8], end: Array, stop: NDArray[np.int8],
    ) -> None:  # fmt: skip
        """Go on in steps that halve, and see whether a denominator vanishes where the last of them goes."""
        here, now, at = members[which], y[:, which].copy(), np.zeros(which.size)
        for halving in range(1, BISECTIONS + 1):
            length = h[which] * 0.5**halving
            trial, good = self._march(here, now, origin[:, which], length, 1, at)
            now[:, good], at[good] = trial[:, good], (at + length)[good]
            if halving == BISECTIONS // 2:
                half = self._denominators(here, now)
        share = self._denominators(here, now) / half
        pole = share.min(axis=0) < VANISHES
        found = which[pole]
        y[:, found], status[found], end[found] = now[:, pole], Status.diverged, at[pole]
        stop[found] = len(self.model.stops) + share.argmin(axis=0)[pole]

    def _denominators(self, members: NDArray[np.intp], y: Array) -> Array:
        return np.abs(self._values(pole_function(self.model), members, y[: self.model.dimension]))

    def _march(
        self, members: NDArray[np.intp], y: Array, origin: Array, h: Array, steps: int, gone: Array | None = None
    ) -> tuple[Array, NDArray[np.bool_]]:
        kernel = lane_kernel(self.model, self.method, slopes=slopes_for(self.tangents), kind="free")
        run, points = blocked(y), members.size
        time = np.zeros(points) if gone is None else gone
        origin = origin if len(origin) else np.zeros((1, points))
        good = np.zeros((run.shape[0], 1, LANES), dtype=np.int64)
        inputs = kernel.inputs(self.values[:, members], self.limits[:, members]).blocks(np.arange(points))
        kernel.march(
            blocks=run.shape[0], count=self.tangents, y=run, time=blocked(time[None]), origin=blocked(origin),
            h=blocked(h[None]), **inputs, steps=steps, good=good, work=kernel.work(),
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
        return self._values(stop_function(self.model, field), members, x)

    def _values(self, function: Callable[..., Any], members: NDArray[np.intp], x: Array) -> Array:
        with np.errstate(over="ignore", invalid="ignore"):  # a state that has run away has no gap worth knowing
            rows = function(list(x), list(self.values[:, members]))
        return np.array([np.broadcast_to(np.asarray(r, dtype=float), members.shape) for r in rows]).reshape(-1, members.size)


@lru_cache(maxsize=64)
def stop_function(model: Model, field: Literal["gap", "reachable"]) -> Callable[..., Any]:
    """One field of each of a model's stops, as a function of lists of states and parameters."""
    expressions = [getattr(stop, field) for stop in model.stops.values()]
    return numpy_function(model, f"stops: {field}", lambda: Formula([model.states, model.parameters], expressions))


@lru_cache(maxsize=64)
def pole_function(model: Model) -> Callable[..., Any]:
    """Denominators of a model that have a zero to pass through, as a function of lists of states and parameters."""
    return numpy_function(model, "poles", lambda: Formula([model.states, model.parameters], pole_guards(model)))


def end_named(model: Model, index: int) -> str | None:
    """What ended a run, by `Ensemble.end_stop`: a stop's name, or the denominator that passed through zero; else None."""
    if index < 0:
        return None
    if index < len(model.stops):
        return list(model.stops)[index]
    return f"{poles(model)[index - len(model.stops)]} = 0"
