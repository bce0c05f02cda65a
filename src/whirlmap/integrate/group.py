"""Points of an ensemble that share one kernel and one number of steps, advanced some blocks at a time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from math import lcm
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.equations.model import Model
from whirlmap.integrate.rescue import Rescue
from whirlmap.integrate.workers import stop_if_given_up
from whirlmap.kernels.running.lanes import Inputs, LaneKernel, Waves, blocked, lane_kernel, slopes_for, unblocked
from whirlmap.kernels.running.reference import reference_outputs
from whirlmap.kernels.writing.event_location import FINE, pieces
from whirlmap.kernels.writing.routine import LANES
from whirlmap.results.status import Status

if TYPE_CHECKING:
    from whirlmap.integrate.ensemble import Ensemble

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Points = NDArray[np.intp]

#: Seconds that one call of a kernel should take: Ctrl-C waits for it, and progress is said behind it. Steps of blocks in the
#: first call of a run, from whose time the length of the others follows, and least steps in one.
CALL, FIRST, LEAST = 0.2, 1 << 15, 64


@dataclass(frozen=True)
class Record:
    """Arrays that the blocks of one call fill."""

    saved: Array
    growth: Array
    sums: Array


class Group:
    """Points that share one kernel, one number of steps and one of orthonormalisations.

    The kernel is that of a model's plain form where a parameter is zero, or that of the model itself.
    """

    def __init__(self, ensemble: Ensemble, model: Model, members: Points, steps: int, orth: int) -> None:
        self.ensemble, self.members, self.steps, self.orth = ensemble, members, steps, orth
        self.kernel: LaneKernel = lane_kernel(
            model, ensemble.method, slopes=slopes_for(ensemble.tangents), kind="locked"
        )
        limits = ensemble.limits[:, members]
        self.inputs: Inputs = self.kernel.inputs(ensemble.values[:, members], limits, ensemble.sizes[:, members])
        self.h = ensemble.period[members] / steps
        self.waves = Waves.of(ensemble.orders, steps, self.kernel.source.nodes)
        self._packed: tuple[Points, dict[str, Any]] = np.zeros(0, dtype=np.intp), {}  # of the last call
        self.rescue = Rescue(
            model, ensemble.method, ensemble.tangents, ensemble.values[:, members], limits, redo=ensemble.redo
        )

    def advance(
        self, local: Points, n_periods: int, save: Fraction | int, record: Record, place: Points, *, between: bool,
        progress: Callable[[int], None] | None = None,
    ) -> None:  # fmt: skip
        """Advance some points, redoing failed steps until each has reached the end or ended.

        ``local`` holds indices into the group's members; ``place`` the columns of all points in the record; ``between``
        says whether extremes between steps count. The kernel is called for some steps at a time (`CALL`), which changes no
        bit.
        """
        e = self.ensemble
        at = self.members[local]
        run = _Run(self, local, n_periods * self.steps, int(save * self.steps), record, between=between)
        length, said = max(FIRST // run.blocks, 1), 0
        while run.begin < run.total:
            stop_if_given_up()
            begun = perf_counter()
            run.end = min(run.begin + length, run.total)
            self._reach_end(local, run)
            if run.end < run.total:
                if not run.alive.any():
                    run.end = run.total
                faster = CALL / max(perf_counter() - begun, 1e-6)
                length = max(int(length * min(faster, 8.0)), LEAST)
            run.begin = run.end
            if progress:
                now = run.end * at.size // self.steps
                progress(now - said)
                said = now
        to = place[at]
        e._y[: run.y.shape[1], at] = unblocked(run.y, at.size)
        if e.crossings.size and self.kernel.source.sizes.surfaces:
            crossings, grazings = unblocked(run.tally, at.size)
            e.crossings[at] += crossings
            e.grazings[at] += grazings
        for name in ("saved", "growth", "sums"):
            into, blocks = getattr(record, name), getattr(run, name)
            if into.size:
                flat = unblocked(blocks.reshape(run.blocks, -1, LANES), at.size)
                # The growth between the orthonormalisations of one T adds up.
                into[:, :, to] = flat.reshape(into.shape[0], -1, into.shape[1], at.size).sum(axis=1)

    def _reach_end(self, local: Points, run: _Run) -> None:
        """Take the points of a run that have not ended to the end of the present call."""
        chosen = np.arange(run.blocks)
        if run.begin:
            run.active[:], run.first[:] = run.alive, run.begin
            chosen = np.flatnonzero(run.active.any(axis=(1, 2)))
        while chosen.size:
            run.call(chosen, int(self.ensemble.turns[self.members[local[0]]]) * self.steps)
            lost = np.flatnonzero(run.failed.reshape(-1)[: local.size] >= 0)
            if not lost.size:
                break
            run.active[:] = 0
            self._mend(local, lost, run)
            run.failed[:] = -1
            chosen = np.flatnonzero(run.active.any(axis=(1, 2)))

    def packed(self, local: Points) -> dict[str, Any]:
        """Steps and inputs of some points in blocks; they are often those of the call before."""
        last, blocks = self._packed
        if not (blocks and np.array_equal(last, local)):
            blocks = {"h": blocked(self.h[None, local]), **self.inputs.blocks(local)}
            self._packed = local, blocks  # at once: another thread may have other points
        return blocks

    def _mend(self, local: Points, lost: Points, run: _Run) -> None:
        """Redo the failed steps of lost points, given by their positions in a run; those that get through go on."""
        e = self.ensemble
        members, points = local[lost], self.members[local[lost]]
        block, lane = lost // LANES, lost % LANES
        failed, part = run.failed[block, 0, lane], run.reached[block, 0, lane]
        h, y = self.h[members], np.ascontiguousarray(run.y[block, :, lane].T)
        step = e.turns[points] * self.steps + failed
        outcome = self.rescue.mend(members, y, self.waves.angles(step, part), (1 - part) * h, run.cause[block, 0, lane])
        run.y[block, :, lane] = y.T
        ended = outcome.status != Status.ok
        e.status[points[ended]] = outcome.status[ended]
        e.end_time[points[ended]] = ((step + part) * h + outcome.time)[ended]
        e.end_stop[points[ended]] = outcome.stop[ended]
        on = ~ended
        run.alive[block[ended], 0, lane[ended]] = 0
        if not on.any():
            return
        done = failed[on] + 1
        run.first[block[on], 0, lane[on]] = done
        run.active[block[on], 0, lane[on]] = done < run.end
        run.after_mended_step(block[on], lane[on], done)
        if run.folded:
            self._fold(members[on], block[on], lane[on], run)

    def _fold(self, members: Points, block: Points, lane: Points, run: _Run) -> None:
        """Fold the end of a mended step into the statistics, as the kernel does with its own steps."""
        x = run.y[block, : self.ensemble.model.dimension, lane].T
        rows = np.concatenate([x, reference_outputs(self.rescue.model)(x, self.rescue.values[:, members])]).T
        sums = run.sums[block, :, :, lane]  # a copy, (point, kind, row)
        less = rows - sums[:, 0]
        sums[:, 1] = np.minimum(sums[:, 1], rows)
        sums[:, 2] = np.maximum(sums[:, 2], rows)
        with np.errstate(over="ignore", invalid="ignore"):  # of a motion that runs away
            sums[:, 3] += less
            sums[:, 4] += less**2
        run.sums[block, :, :, lane] = sums


#: Arrays of a run that a kernel changes, beside those that it saves into.
_IN_PLACE = ("y", "active", "failed", "sums", "cause", "reached", "tally")


class _Run:
    """Arrays of one advance of some points, laid out in blocks; a call takes them from ``begin`` to ``end``, in steps."""

    def __init__(
        self, group: Group, local: Points, total: int, save_every: int, record: Record, *, between: bool
    ) -> None:
        e = group.ensemble
        self.group, self.local, self.total, self.save_every = group, local, total, save_every or total + 1
        self.count, self.n = e.tangents, e.model.dimension
        rows = self.n * (1 + self.count) + group.kernel.source.sizes.surfaces
        self.y = blocked(e._y[:rows, group.members[local]])
        self.blocks = self.y.shape[0]
        self.inputs = group.packed(local)
        self.first, self.active, self.failed = (np.full((self.blocks, 1, LANES), v, dtype=np.int64) for v in (0, 0, -1))
        self.active.reshape(-1)[: local.size] = 1
        self.alive = self.active.copy()  # those that have not ended
        self.begin = self.end = 0
        self.saved = np.full((self.blocks, record.saved.shape[0], self.n, LANES), np.nan)
        self.growth = np.zeros((self.blocks, group.orth * record.growth.shape[0], self.count, LANES))
        self.orth_every = group.steps // group.orth if record.growth.shape[0] else total + 1
        self.cause = np.zeros((self.blocks, 1, LANES), dtype=np.int64)
        self.reached, self.tally = np.zeros((self.blocks, 1, LANES)), np.zeros((self.blocks, 2, LANES))
        self.folded = 0 if not record.sums.shape[1] else 2 if between else 1
        self.sums = np.zeros((self.blocks, 5, record.sums.shape[1], LANES))
        if self.folded:
            self.sums[:, 0, : self.n] = self.y[:, : self.n]  # the reference: the present state
            self.sums[:, 1], self.sums[:, 2] = np.inf, -np.inf

    def call(self, chosen: Points, phase: int) -> None:
        """Call the kernel for some blocks; arrays of blocks that are not all of them go there and back as copies.

        ``phase`` is the number of steps after phase zero at which the run began. The kernel begins at the last step before
        the call at which what is saved and the growths both begin anew: up to the call's own first step all lanes wait.
        """
        begin = 0
        if self.begin:
            unit = lcm(self.save_every if self.saved.shape[1] else 1, self.orth_every if self.growth.shape[1] else 1)
            begin = self.begin // unit * unit
        whole, all_steps = chosen.size == self.blocks, begin == 0 and self.end == self.total
        arrays: dict[str, Any] = {name: getattr(self, name) for name in _IN_PLACE}
        steady = {name: self.inputs[name] for name in ("h", "p", "offsets")}
        if not whole:
            arrays = {name: np.ascontiguousarray(a[chosen]) for name, a in arrays.items()}
            steady = {name: np.ascontiguousarray(a[chosen]) for name, a in steady.items()}
        first, parts = self.first, dict[str, slice]()
        if whole and all_steps:
            arrays |= {"saved": self.saved, "growth": self.growth}
        else:
            for name, every in (("saved", self.save_every), ("growth", self.orth_every)):
                parts[name] = slice(begin // every, self.end // every)
                arrays[name] = np.ascontiguousarray(getattr(self, name)[chosen, parts[name]])
            first = np.ascontiguousarray(first[chosen] - begin)
        kernel = self.group.kernel
        kernel.advance(
            blocks=chosen.size, count=self.count, **arrays, **steady, first=first, tables=self.inputs["tables"],
            **self.group.waves.arguments(phase + begin), steps=self.end - begin, save_every=self.save_every,
            saves=arrays["saved"].shape[1], orth_every=self.orth_every, events=arrays["growth"].shape[1], folded=self.folded,
            pieces=FINE if self.folded == 2 else pieces(self.group.steps), work=kernel.work(),
        )  # fmt: skip
        if not whole:
            for name in _IN_PLACE:
                getattr(self, name)[chosen] = arrays[name]
        for name, part in parts.items():
            getattr(self, name)[chosen, part] = arrays[name]
        if begin:
            self.failed[self.failed >= 0] += begin

    def after_mended_step(self, block: Points, lane: Points, done: Integers) -> None:
        """Do after mended steps what the kernel does after its own where it is due: orthonormalise, and save."""
        k, n = self.count, self.n
        due = done % self.orth_every == 0
        if k and due.any():
            b, l, event = block[due], lane[due], done[due] // self.orth_every - 1  # noqa: E741
            rows = slice(n, n * (1 + k))
            size = self.group.ensemble.sizes[:, self.group.members[self.local[b * LANES + l]]].T[:, :, None]
            vectors = self.y[b, rows, l].reshape(-1, k, n).transpose(0, 2, 1)
            q, r = np.linalg.qr(vectors / size)
            length = np.diagonal(r, axis1=1, axis2=2)
            self.y[b, rows, l] = (size * q * np.sign(length)[:, None, :]).transpose(0, 2, 1).reshape(-1, n * k)
            self.growth[b, event, :, l] += np.log(np.abs(length))
        save = (done % self.save_every == 0) & (done // self.save_every <= self.saved.shape[1])
        b, l, event = block[save], lane[save], done[save] // self.save_every - 1  # noqa: E741
        self.saved[b, event, :, l] = self.y[b, :n, l]
