"""Many operating points of one model, integrated together in lanes with steps locked to the forcing's phase.

A lane never sees its neighbours: its numbers depend on its own parameters, start and steps alone, whatever block it is
in and however many threads run.
"""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from fractions import Fraction
from math import lcm

import numpy as np
from numpy.typing import NDArray

from whirlmap.equations.model import Model
from whirlmap.errors import RangeError
from whirlmap.integrate.rescue import Rescue
from whirlmap.integrate.system import periods
from whirlmap.kernels.lanes import Inputs, LaneKernel, Waves, lane_kernel, padded
from whirlmap.kernels.methods import RK4, Method
from whirlmap.kernels.reference import reference_outputs
from whirlmap.kernels.source import LANES
from whirlmap.results.status import Status

Array = NDArray[np.float64]


def cores() -> int:
    """Number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@dataclass(frozen=True)
class Segment:
    """What one call of `Ensemble.advance` recorded.

    Attributes
    ----------
    saved : array, shape (save, state, point)
        States at the asked steps; NaN once a point has ended.
    growth : array, shape (event, vector, point)
        Logarithmic growth of the tangent vectors between orthonormalisations.
    extremes : dict or None
        ``minimum``, ``maximum``, ``mean``, ``rms`` (about the mean) of every state and output, shape (row, point);
        NaN for points that have ended.
    """

    saved: Array
    growth: Array
    extremes: dict[str, Array] | None


class Ensemble:
    """Points of one model, at one phase of the forcing.

    Parameters
    ----------
    model : Model
    values : array, shape (parameter, point)
    x : array, shape (state, point)
        Start states, at phase zero.
    orders : tuple of Fraction
        Orders of the harmonics over the fastest.
    steps : int
        Steps per T.
    method : Method
    tangents : int
        Tangent vectors carried along, started from a fixed random orthonormal set.
    workers : int, optional
        Threads; all cores where absent. The numbers do not depend on it.
    one_kernel : bool
        Use the kernel that can carry tangent vectors even while there are none: where both are run once, a second
        kernel takes longer to compile or to load than it saves.

    Attributes
    ----------
    x : array, shape (state, point)
        State at the present step, or the last good one of a point that has ended.
    status : array of int, shape (point,)
        `Status` of each point.
    end_time : array, shape (point,)
        When a point ended (NaN while it runs), in the model's time.
    end_stop : array of int, shape (point,)
        Which of the model's stops ended it, else -1.
    step_count : array of int, shape (point,)
        Steps that each point has taken; equal modulo the common period.
    """

    def __init__(
        self,
        model: Model,
        values: Array,
        x: Array,
        *,
        orders: tuple[Fraction, ...],
        steps: int,
        method: Method = RK4,
        tangents: int = 0,
        workers: int | None = None,
        one_kernel: bool = False,
    ) -> None:
        n = values.shape[1]
        if steps < 1:
            raise RangeError(f"steps per T must be at least 1, not {steps}")
        if x.shape != (model.dimension, n):
            raise RangeError(f"start states have shape {x.shape}, expected {(model.dimension, n)}")
        self.model, self.steps, self.method, self.tangents = model, steps, method, tangents
        self.orders, self.workers, self.one_kernel = orders, workers or cores(), one_kernel
        self.points = n
        self.period = periods(model, values)
        self.values = values
        self.status = np.zeros(n, dtype=np.int8)
        self.end_time = np.full(n, np.nan)
        self.end_stop = np.full(n, -1, dtype=np.int8)
        self.step_count = np.zeros(n, dtype=np.int64)
        self._groups = [_Group(self, m, members) for m, members in _variants(model, values)]
        self._y = np.concatenate([x, _tangent_start(model.dimension, tangents, n)])

    @property
    def x(self) -> Array:
        """Present states, shape (state, point)."""
        return self._y[: self.model.dimension]

    @property
    def running(self) -> NDArray[np.bool_]:
        """Which points have not ended."""
        return self.status == Status.ok

    @property
    def common_multiple(self) -> int:
        """Number of T in the common period."""
        return lcm(*(o.denominator for o in self.orders)) if self.orders else 1

    def subset(self, members: NDArray[np.intp]) -> "Ensemble":
        """Return an ensemble of some of the points, at their present states; `absorb` takes it back."""
        part = Ensemble(
            self.model, self.values[:, members], self.x[:, members], orders=self.orders, steps=self.steps,
            method=self.method, tangents=self.tangents, workers=self.workers, one_kernel=self.one_kernel,
        )  # fmt: skip
        part._y = self._y[:, members].copy()
        for name in ("status", "end_time", "end_stop", "step_count"):
            setattr(part, name, getattr(self, name)[members].copy())
        return part

    def absorb(self, part: "Ensemble", members: NDArray[np.intp]) -> None:
        """Take over the states of a subset that has run on, by whole common periods."""
        self._y[:, members] = part._y
        for name in ("status", "end_time", "end_stop", "step_count"):
            getattr(self, name)[members] = getattr(part, name)

    def advance(
        self,
        n_periods: int,
        *,
        save_every: int = 0,
        orthonormalise_every: int = 0,
        extremes: bool = False,
        progress: Callable[[int], None] | None = None,
    ) -> Segment:
        """Run all points for ``n_periods`` T.

        Parameters
        ----------
        save_every : int
            Steps between saved states; zero saves none.
        orthonormalise_every : int
            Steps between orthonormalisations of the tangent vectors; zero is once per T.
        extremes : bool
            Whether to track extremes, mean and rms of every state and output over all steps.
        progress : callable, optional
            Called with the number of points x periods done since the last call.
        """
        total = n_periods * self.steps
        every = orthonormalise_every or self.steps
        saves = total // save_every if save_every else 0
        events = -(-total // every) if self.tangents else 0
        rows = self.model.dimension + len(self.model.outputs)
        saved = np.full((saves, self.model.dimension, self.points), np.nan)
        growth = np.zeros((events, self.tangents, self.points))
        sums = np.zeros((5, rows if extremes else 0, self.points))
        tasks = [(group, block) for group in self._groups for block in range(group.blocks)]

        def work(task: tuple["_Group", int]) -> None:
            group, block = task
            group.advance(block, total, save_every or total + 1, saved, every, growth, sums)
            if progress:
                progress(n_periods * group.members_of(block).size)

        if self.workers == 1 or len(tasks) == 1:
            for task in tasks:
                work(task)
        else:
            pool = ThreadPoolExecutor(self.workers)
            try:
                for _ in pool.map(work, tasks):
                    pass
            finally:
                pool.shutdown(cancel_futures=True)  # an interrupt waits for the blocks that run, not for the queue
        self.step_count[self.running] += total
        return Segment(saved, growth, _statistics(sums, total, self.running) if extremes else None)


class _Group:
    """Points that share one kernel: a model's plain form where a parameter is zero, or the model itself."""

    def __init__(self, ensemble: Ensemble, model: Model, members: NDArray[np.intp]) -> None:
        self.ensemble, self.members = ensemble, members
        carries = ensemble.tangents > 0 or ensemble.one_kernel
        self.kernel: LaneKernel = lane_kernel(model, ensemble.method, tangents=carries, kind="locked")
        whole = padded(ensemble.values[:, members])
        self.inputs: Inputs = self.kernel.inputs(whole)
        self.h = padded(ensemble.period[members]) / ensemble.steps
        self.waves = Waves.of(ensemble.orders, ensemble.steps, self.kernel.source.nodes)
        self.blocks = whole.shape[1] // LANES
        self.rescue = Rescue(model, ensemble.method, ensemble.tangents, whole)

    def members_of(self, block: int) -> NDArray[np.intp]:
        """Indices of the points in a block."""
        return self.members[block * LANES : (block + 1) * LANES]

    def advance(
        self, block: int, total: int, save_every: int, saved: Array, orth_every: int, growth: Array, sums: Array
    ) -> None:
        """Advance one block, redoing failed steps until every lane has reached the end or ended."""
        e, lanes = self.ensemble, slice(block * LANES, (block + 1) * LANES)
        at = self.members_of(block)
        y = np.ascontiguousarray(padded(e._y[:, at]))
        active = np.zeros(LANES, dtype=np.int64)
        active[: at.size] = e.status[at] == Status.ok
        if not active.any():
            return
        p, tables, offsets = self.inputs.block(lanes)
        h = np.ascontiguousarray(self.h[lanes])
        block_saved = np.full((saved.shape[0], e.model.dimension * LANES), np.nan)
        block_growth = np.zeros((max(growth.shape[0], 1), max(e.tangents, 1) * LANES))
        block_sums = _empty_sums(sums, y)
        first = np.zeros(LANES, dtype=np.int64)
        begin = int(e.step_count[at[active[: at.size] > 0][0]])  # of those that run: an ended point's count stands still
        while active.any():
            failed = np.full(LANES, -1, dtype=np.int64)
            counters = np.array([begin % n for n in self.waves.lengths], dtype=np.int64)
            flat = y.ravel()
            self.kernel.module.advance(
                flat, h, p.ravel(), tables, offsets.ravel(), self.waves.table, self.waves.starts, self.waves.lengths,
                counters, total, first, active, failed, save_every, block_saved, orth_every, block_growth,
                block_sums.ravel(),
            )  # fmt: skip
            y = flat.reshape(y.shape)
            lost = np.flatnonzero(failed >= 0)
            active[:] = 0
            if lost.size == 0:
                break
            active[lost], first = self._mend(lanes, at, y, failed, lost, total)
            ended = e.status[at[lost]] != Status.ok
            self._record(lost[~ended], first, y, save_every, block_saved)
            if sums.size:
                self._fold(lanes, lost[~ended], y, block_sums)
        e._y[:, at] = y[:, : at.size]
        saved[:, :, at] = block_saved.reshape(saved.shape[0], e.model.dimension, LANES)[:, :, : at.size]
        if growth.size:
            growth[:, :, at] = block_growth.reshape(growth.shape[0], e.tangents, LANES)[:, :, : at.size]
        if sums.size:
            sums[:, :, at] = block_sums[:, :, : at.size]

    def _mend(
        self, lanes: slice, at: NDArray[np.intp], y: Array, failed: NDArray[np.int64], lost: NDArray[np.intp], total: int
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Redo the failed step of the lost lanes; say which go on, and from which step."""
        e = self.ensemble
        time = (padded(e.step_count[at]) + np.maximum(failed, 0)) * self.h[lanes]
        outcome = self.rescue.mend(lanes, lost, y, time, np.ascontiguousarray(self.h[lanes]))
        ended = outcome.status[lost] != Status.ok
        points = at[lost[ended]]
        e.status[points] = outcome.status[lost[ended]]
        e.end_time[points] = outcome.time[lost[ended]]
        e.end_stop[points] = outcome.stop[lost[ended]]
        first = np.zeros(LANES, dtype=np.int64)
        first[lost] = failed[lost] + 1
        return (~ended & (first[lost] < total)).astype(np.int64), first

    def _record(
        self, lanes: NDArray[np.intp], first: NDArray[np.int64], y: Array, save_every: int, saved: Array
    ) -> None:
        """Save the state after a mended step where a save was due; the kernel goes on behind it."""
        rows = saved.reshape(saved.shape[0], self.ensemble.model.dimension, LANES)
        due = lanes[first[lanes] % save_every == 0]
        rows[first[due] // save_every - 1, :, due] = y[: rows.shape[1], due].T

    def _fold(self, block: slice, lanes: NDArray[np.intp], y: Array, sums: Array) -> None:
        """Fold the end of a mended step into the statistics, as the kernel does with its own steps."""
        x = y[: self.ensemble.model.dimension, lanes]
        seen = reference_outputs(self.rescue.model)(x, self.rescue.values[:, block][:, lanes])
        rows = np.concatenate([x, seen])
        less = rows - sums[0][:, lanes]
        sums[1][:, lanes] = np.minimum(sums[1][:, lanes], rows)
        sums[2][:, lanes] = np.maximum(sums[2][:, lanes], rows)
        sums[3][:, lanes] += less
        sums[4][:, lanes] += less**2


def _variants(model: Model, values: Array) -> list[tuple[Model, NDArray[np.intp]]]:
    """Split points between a model and its plain form: a point's kernel depends on its own parameters alone."""
    from whirlmap.integrate.system import _plain

    everything = np.arange(values.shape[1])
    if not model.plain:
        return [(model, everything)]
    (parameter, _), *more = model.plain.items()
    assert not more, "one plain parameter is all that any model has needed"
    zero = values[model.parameters.index(parameter)] == 0.0
    split = [(_plain(model, parameter), everything[zero]), (model, everything[~zero])]
    return [(m, members) for m, members in split if members.size]


def _tangent_start(n: int, count: int, points: int) -> Array:
    """Orthonormal tangent vectors, the same random set for every point."""
    if count == 0:
        return np.zeros((0, points))
    if count > n:
        raise RangeError(f"{count} tangent vectors in {n} dimensions")
    q, _ = np.linalg.qr(np.random.default_rng(20240101).normal(size=(n, count)))
    return np.repeat(q.T.reshape(n * count, 1), points, axis=1)


def _empty_sums(sums: Array, y: Array) -> Array:
    out = np.zeros((5, sums.shape[1], LANES))
    if sums.shape[1]:
        n = min(y.shape[0], sums.shape[1])
        out[0, :n] = y[:n]  # the reference: the present state
        out[1], out[2] = np.inf, -np.inf
    return out


def _statistics(sums: Array, steps: int, running: NDArray[np.bool_]) -> dict[str, Array]:
    """Extremes, mean and rms of what `fold` summed; NaN for points that did not run to the end."""
    reference, low, high, total, squares = sums
    mean = total / steps
    variance = np.maximum(squares / steps - mean**2, 0.0)  # rounding alone can make it negative
    out = {"minimum": low, "maximum": high, "mean": reference + mean, "rms": np.sqrt(variance)}
    return {name: np.where(running, values, np.nan) for name, values in out.items()}
