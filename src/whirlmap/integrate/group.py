"""Points of an ensemble that share one kernel and one number of steps, advanced block by block."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from whirlmap.equations.model import Model
from whirlmap.integrate.rescue import Rescue
from whirlmap.kernels.lanes import Inputs, LaneKernel, Waves, lane_kernel, padded
from whirlmap.kernels.reference import reference_outputs
from whirlmap.kernels.source import LANES
from whirlmap.results.status import Status

if TYPE_CHECKING:
    from whirlmap.integrate.ensemble import Ensemble

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass(frozen=True)
class Record:
    """Arrays that the blocks of one call fill."""

    saved: Array
    growth: Array
    sums: Array


class Group:
    """Points that share one kernel and one number of steps.

    The kernel is that of a model's plain form where a parameter is zero, or that of the model itself.
    """

    def __init__(self, ensemble: Ensemble, model: Model, members: NDArray[np.intp], steps: int) -> None:
        self.ensemble, self.members, self.steps = ensemble, members, steps
        carries = ensemble.tangents > 0 or ensemble.one_kernel
        self.kernel: LaneKernel = lane_kernel(model, ensemble.method, tangents=carries, kind="locked")
        self.inputs: Inputs = self.kernel.inputs(ensemble.values[:, members])
        self.h = ensemble.period[members] / steps
        self.waves = Waves.of(ensemble.orders, steps, self.kernel.source.nodes)
        self.rescue = Rescue(model, ensemble.method, ensemble.tangents, ensemble.values[:, members], redo=ensemble.redo)

    def advance(
        self, block: NDArray[np.intp], n_periods: int, save: Fraction | int, record: Record, place: NDArray[np.intp]
    ) -> None:
        """Advance one block, redoing failed steps until every lane has reached the end or ended.

        ``block`` holds indices into the group's members; ``place`` the columns of all points in the record.
        """
        e = self.ensemble
        at, lanes = self.members[block], padded(block)
        total, save_every = n_periods * self.steps, int(save * self.steps) or n_periods * self.steps + 1
        y = padded(e._y[:, at])
        active = np.zeros(LANES, dtype=np.int64)
        active[: at.size] = 1
        p, tables, offsets = self.inputs.lanes(lanes)
        h = self.h[lanes]
        wide = np.tile(h, e.model.dimension)
        saved = np.full((record.saved.shape[0], e.model.dimension * LANES), np.nan)
        growth = np.zeros((max(record.growth.shape[0], 1), max(e.tangents, 1) * LANES))
        sums = _empty_sums(record.sums, y)
        first = np.zeros(LANES, dtype=np.int64)
        begin = int(e.turns[at[0]]) * self.steps
        while active.any():
            failed = np.full(LANES, -1, dtype=np.int64)
            counters = np.array([begin % n for n in self.waves.lengths], dtype=np.int64)
            flat = y.ravel()
            self.kernel.module.advance(
                flat, wide, p.ravel(), tables, offsets.ravel(), self.waves.table, self.waves.starts, self.waves.lengths,
                counters, total, first, active, failed, save_every, saved, self.steps, growth, sums.ravel(),
            )  # fmt: skip
            y = flat.reshape(y.shape)
            lost = np.flatnonzero(failed >= 0)
            active[:] = 0
            if lost.size == 0:
                break
            active[lost], first = self._mend(lanes, at, y, failed, lost, total)
            ended = e.status[at[lost]] != Status.ok
            self._record(lost[~ended], first, y, save_every, saved, growth)
            if sums.size:
                self._fold(lanes, lost[~ended], y, sums)
        e._y[:, at] = y[:, : at.size]
        to = place[at]
        record.saved[:, :, to] = saved.reshape(saved.shape[0], e.model.dimension, LANES)[:, :, : at.size]
        if record.growth.size:
            record.growth[:, :, to] = growth.reshape(growth.shape[0], e.tangents, LANES)[:, :, : at.size]
        if sums.size:
            record.sums[:, :, to] = sums[:, :, : at.size]

    def _mend(
        self, lanes: NDArray[np.intp], at: NDArray[np.intp], y: Array, failed: Integers, lost: NDArray[np.intp], total: int
    ) -> tuple[Integers, Integers]:
        """Redo the failed step of the lost lanes; say which go on, and from which step."""
        e = self.ensemble
        h = self.h[lanes]
        time = (padded(e.turns[at]) * self.steps + np.maximum(failed, 0)) * h
        outcome = self.rescue.mend(lanes, lost, y, time, h)
        ended = outcome.status[lost] != Status.ok
        points = at[lost[ended]]
        e.status[points] = outcome.status[lost[ended]]
        e.end_time[points] = outcome.time[lost[ended]]
        e.end_stop[points] = outcome.stop[lost[ended]]
        first = np.zeros(LANES, dtype=np.int64)
        first[lost] = failed[lost] + 1
        return (~ended & (first[lost] < total)).astype(np.int64), first

    def _record(
        self, lanes: NDArray[np.intp], first: Integers, y: Array, save_every: int, saved: Array, growth: Array
    ) -> None:
        """Do after a mended step what the kernel does after its own where it is due: orthonormalise, and save."""
        n, k = self.ensemble.model.dimension, self.ensemble.tangents
        turned = lanes[first[lanes] % self.steps == 0]
        if k and turned.size:
            q, r = np.linalg.qr(y[n:, turned].reshape(k, n, -1).transpose(2, 1, 0))
            length = np.diagonal(r, axis1=1, axis2=2)
            y[n:, turned] = (q * np.sign(length)[:, None, :]).transpose(2, 1, 0).reshape(n * k, -1)
            rows = growth.reshape(growth.shape[0], k, LANES)
            rows[first[turned] // self.steps - 1, :, turned] += np.log(np.abs(length))
        rows = saved.reshape(saved.shape[0], n, LANES)
        due = lanes[first[lanes] % save_every == 0]
        rows[first[due] // save_every - 1, :, due] = y[:n, due].T

    def _fold(self, lanes: NDArray[np.intp], mended: NDArray[np.intp], y: Array, sums: Array) -> None:
        """Fold the end of a mended step into the statistics, as the kernel does with its own steps."""
        x = y[: self.ensemble.model.dimension, mended]
        seen = reference_outputs(self.rescue.model)(x, self.rescue.values[:, lanes[mended]])
        rows = np.concatenate([x, seen])
        less = rows - sums[0][:, mended]
        sums[1][:, mended] = np.minimum(sums[1][:, mended], rows)
        sums[2][:, mended] = np.maximum(sums[2][:, mended], rows)
        sums[3][:, mended] += less
        sums[4][:, mended] += less**2


def _empty_sums(sums: Array, y: Array) -> Array:
    out = np.zeros((5, sums.shape[1], LANES))
    if sums.shape[1]:
        n = min(y.shape[0], sums.shape[1])
        out[0, :n] = y[:n]  # the reference: the present state
        out[1], out[2] = np.inf, -np.inf
    return out
