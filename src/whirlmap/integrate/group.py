"""Points of an ensemble that share one kernel, advanced some blocks at a time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from time import perf_counter
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from whirlmap.equations.model import Model
from whirlmap.integrate.step_retry import StepRetry
from whirlmap.integrate.workers import stop_if_given_up
from whirlmap.kernels.methods import Method
from whirlmap.kernels.running.lanes import HarmonicTables, Inputs, LaneKernel, blocked, lane_kernel, slopes_for, unblocked
from whirlmap.kernels.running.reference import reference_outputs
from whirlmap.kernels.writing.event_location import FINE, pieces
from whirlmap.kernels.writing.routine import LANES
from whirlmap.results.status import Status

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


class OfEnsemble(Protocol):
    """What a group needs of its ensemble: numbers of the points, and their present state, which it changes in place."""

    model: Model
    method: Method
    tangents: int
    orders: tuple[Fraction, ...]
    redo: bool
    values: Array
    limits: Array
    sizes: Array
    point_steps: Integers
    period: Array
    turns: Integers
    ahead: Integers
    status: NDArray[np.int8]
    end_time: Array
    end_stop: NDArray[np.int8]
    crossings: Array
    grazings: Array
    _y: Array


class Group:
    """Points that share one kernel, and one number of orthonormalisations per T.

    The kernel is that of a model's plain form where a parameter is zero, or that of the model itself. Each point has its own
    steps per T, phase and run.
    """

    def __init__(self, ensemble: OfEnsemble, model: Model, members: Points, orth: int) -> None:
        self.ensemble, self.members, self.orth = ensemble, members, orth
        self.kernel: LaneKernel = lane_kernel(
            model, ensemble.method, slopes=slopes_for(ensemble.tangents), kind="locked"
        )
        limits = ensemble.limits[:, members]
        self.inputs: Inputs = self.kernel.inputs(ensemble.values[:, members], limits, ensemble.sizes[:, members])
        self.steps = ensemble.point_steps[members]
        self.h = ensemble.period[members] / self.steps
        self._packed: tuple[Points, dict[str, Any]] = np.zeros(0, dtype=np.intp), {}  # of the last call
        self.step_retry = StepRetry(
            model, ensemble.method, ensemble.tangents, ensemble.values[:, members], limits, redo=ensemble.redo
        )

    @cached_property
    def harmonic_tables(self) -> HarmonicTables:
        """Tables of the harmonics; ensembles are often made for their states alone."""
        return HarmonicTables.of(self.ensemble.orders, self.steps, self.kernel.source.nodes)

    def advance(
        self, local: Points, to_do: Integers, save: Fraction | int, record: Record, place: Points, *, between: bool,
        progress: Callable[[int], None] | None = None,
    ) -> None:  # fmt: skip
        """Advance some points, redoing failed steps until each has reached its end or ended.

        ``local`` holds indices into the group's members, in an order in which neighbours have about as many steps ``to_do``;
        ``place`` the columns of all points in the record; ``between`` says whether extremes between steps count. The kernel
        is called for some steps at a time (`CALL`), which changes no bit.
        """
        e = self.ensemble
        at = self.members[local]
        run = _Run(self, local, to_do, save, record, between=between)
        length, most, said = max(FIRST // run.blocks, 1), int(run.total.max()), 0
        while run.goes_on:
            stop_if_given_up()
            begun = perf_counter()
            run.call(length)
            lost = np.flatnonzero(run.failed.reshape(-1)[: local.size] >= 0)
            if lost.size:
                self._mend(local, lost, run)
            faster = CALL / max(perf_counter() - begun, 1e-6)
            length = min(max(int(length * min(faster, 8.0)), LEAST), most)
            if progress:
                now = run.periods_done()
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

    def packed(self, local: Points) -> dict[str, Any]:
        """Arguments of some points that stay the same, in blocks; they are often those of the call before."""
        last, blocks = self._packed
        if not (blocks and np.array_equal(last, local)):
            waves = self.harmonic_tables.rows(self.steps[local])
            blocks = {"h": blocked(self.h[None, local]), "waves": self.harmonic_tables.table, **self.inputs.blocks(local)}
            blocks |= {name: blocked(rows) for name, rows in waves.items()}
            self._packed = local, blocks  # at once: another thread may have other points
        return blocks

    def _mend(self, local: Points, lost: Points, run: _Run) -> None:
        """Redo the failed steps of lost points, given by their positions in a run; those that get through go on."""
        e = self.ensemble
        members, points = local[lost], self.members[local[lost]]
        block, lane = lost // LANES, lost % LANES
        failed, part = run.failed[block, 0, lane], run.reached[block, 0, lane]
        run.failed[block, 0, lane] = -1
        h, steps, y = self.h[members], self.steps[members], np.ascontiguousarray(run.y[block, :, lane].T)
        angles = self.harmonic_tables.angles(steps, e.turns[points], e.ahead[points] + failed, part)
        outcome = self.step_retry.retry(members, y, angles, (1 - part) * h, run.cause[block, 0, lane])
        run.y[block, :, lane] = y.T
        ended = outcome.status != Status.ok
        e.status[points[ended]] = outcome.status[ended]
        e.end_time[points[ended]] = ((e.turns[points] * steps + e.ahead[points] + failed + part) * h + outcome.time)[ended]
        e.end_stop[points[ended]] = outcome.stop[ended]
        on = ~ended
        run.active[block[ended], 0, lane[ended]] = 0
        if not on.any():
            return
        done = failed[on] + 1
        run.first[block[on], 0, lane[on]] = done
        run.after_mended_step(block[on], lane[on], done)
        if run.folded:
            self._fold(members[on], block[on], lane[on], run)

    def _fold(self, members: Points, block: Points, lane: Points, run: _Run) -> None:
        """Fold the end of a mended step into the statistics, as the kernel does with its own steps."""
        x = run.y[block, : self.ensemble.model.dimension, lane].T
        rows = np.concatenate([x, reference_outputs(self.step_retry.model)(x, self.step_retry.values[:, members])]).T
        sums = run.sums[block, :, :, lane]  # a copy, (point, kind, row)
        less = rows - sums[:, 0]
        sums[:, 1] = np.minimum(sums[:, 1], rows)
        sums[:, 2] = np.maximum(sums[:, 2], rows)
        with np.errstate(over="ignore", invalid="ignore"):  # of a motion that runs away
            sums[:, 3] += less
            sums[:, 4] += less**2
        run.sums[block, :, :, lane] = sums


class _Run:
    """Arrays of one advance of some points, laid out in blocks.

    Every point takes the steps from its ``first`` on, to before its ``total``, as long as it is ``active``.
    """

    def __init__(
        self, group: Group, local: Points, to_do: Integers, save: Fraction | int, record: Record, *, between: bool
    ) -> None:
        e = group.ensemble
        self.group, self.local = group, local
        self.count, self.n = e.tangents, e.model.dimension
        rows = self.n * (1 + self.count) + group.kernel.source.sizes.surfaces
        self.y = blocked(e._y[:rows, group.members[local]])
        self.blocks = self.y.shape[0]
        self.inputs = group.packed(local)
        self.lanes = local[np.minimum(np.arange(self.blocks * LANES), local.size - 1)]  # the last one fills its block
        self.steps = group.steps[self.lanes]
        self.total, never = blocked(to_do[None]), np.full_like(self.steps, to_do.max() + 1)
        self.save_every, self.orth_every = (
            (steps if recorded.shape[0] else never).reshape(self.y.shape[0], 1, LANES)
            for steps, recorded in (
                (self.steps * save.numerator // save.denominator, record.saved), (self.steps // group.orth, record.growth),
            )
        )  # fmt: skip
        self.first, self.active, self.failed, self.cause = (
            np.full((self.blocks, 1, LANES), v, dtype=np.int64) for v in (0, 0, -1, 0)
        )
        self.active.reshape(-1)[: local.size] = 1
        self.saved = np.full((self.blocks, record.saved.shape[0], self.n, LANES), np.nan)
        self.growth = np.zeros((self.blocks, group.orth * record.growth.shape[0], self.count, LANES))
        self.reached, self.tally = np.zeros((self.blocks, 1, LANES)), np.zeros((self.blocks, 2, LANES))
        self.folded = 0 if not record.sums.shape[1] else 2 if between else 1
        self.pieces = np.full_like(self.first, FINE) if self.folded == 2 else pieces(self.steps)
        self.sums = np.zeros((self.blocks, 5, record.sums.shape[1], LANES))
        if self.folded:
            self.sums[:, 0, : self.n] = self.y[:, : self.n]  # the reference: the present state
            self.sums[:, 1], self.sums[:, 2] = np.inf, -np.inf

    @property
    def goes_on(self) -> bool:
        """Whether any point has steps to take."""
        return bool(((self.first < self.total) & (self.active != 0)).any())

    def periods_done(self) -> int:
        """T that all points have run; one that has ended has run all of them."""
        done = np.where(self.active != 0, self.first, self.total).reshape(-1)
        return int((done // self.steps)[: self.local.size].sum())

    def call(self, length: int) -> None:
        """Call the kernel: every point takes so many steps more, or those that it has left, up to one that fails."""
        kernel, e, points = self.group.kernel, self.group.ensemble, self.group.members[self.lanes]
        done = e.ahead[points] + self.first.reshape(-1)
        last = np.minimum(self.first + length, self.total)
        kernel.advance(
            blocks=self.blocks, count=self.count, y=self.y, **self.inputs, first=self.first, last=last, active=self.active,
            begin=blocked(self.group.harmonic_tables.begin(self.steps, e.turns[points], done)), failed=self.failed,
            save_every=self.save_every, saves=self.saved.shape[1], saved=self.saved, orth_every=self.orth_every,
            events=self.growth.shape[1], growth=self.growth, folded=self.folded, sums=self.sums, cause=self.cause,
            reached=self.reached, tally=self.tally, pieces=self.pieces, work=kernel.work(),
        )  # fmt: skip
        np.copyto(self.first, last, where=(self.failed < 0) & (self.active != 0))

    def after_mended_step(self, block: Points, lane: Points, done: Integers) -> None:
        """Do after mended steps what the kernel does after its own where it is due: orthonormalise, and save."""
        k, n = self.count, self.n
        every = self.orth_every[block, 0, lane]
        due = done % every == 0
        if k and due.any():
            b, l, event = block[due], lane[due], (done // every)[due] - 1  # noqa: E741
            rows = slice(n, n * (1 + k))
            size = self.group.ensemble.sizes[:, self.group.members[self.local[b * LANES + l]]].T[:, :, None]
            vectors = self.y[b, rows, l].reshape(-1, k, n).transpose(0, 2, 1)
            q, r = np.linalg.qr(vectors / size)
            length = np.diagonal(r, axis1=1, axis2=2)
            self.y[b, rows, l] = (size * q * np.sign(length)[:, None, :]).transpose(0, 2, 1).reshape(-1, n * k)
            self.growth[b, event, :, l] += np.log(np.abs(length))
        every = self.save_every[block, 0, lane]
        save = done % every == 0
        b, l, event = block[save], lane[save], (done // every)[save] - 1  # noqa: E741
        self.saved[b, event, :, l] = self.y[b, :n, l]
