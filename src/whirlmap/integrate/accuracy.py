"""How many steps per T a point needs: each tries itself on a ladder of steps until the asked accuracy is met.

The error of a rung is measured, not estimated from the method: the largest difference, at the ends of all T of one common
period, between a run with that rung's steps and a run with the next one's. The lowest rung whose error is small enough is
the point's own: it depends on its model, parameters, start and the asked accuracy alone, never on its neighbours.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from whirlmap.errors import RangeError
from whirlmap.integrate.ensemble import Ensemble, Segment
from whirlmap.integrate.scales import scales
from whirlmap.results.status import Status

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Steps per T that are tried.
LADDER = (6, 8, 10, 12, 16, 20, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512, 768, 1024)

#: Steps within which a divergence is not believed.
FEW = 8
#: Where the error falls by less than this from a rung to the one at least twice as high, the method has lost its order.
STALLED = 4.0
#: The rung from which on a lost order is believed: below it the steps may only be too long for any order to show.
BELIEVED = 48
#: Steps of a point whose method has lost its order: between steps a corner moves by their error, and with 64 of them that
#: shakes a periodic orbit of the dead zone by 2e-4, which its tangent vector takes for chaos.
KINKED = 256


class Verdict(IntEnum):
    """Whether a point's steps meet the asked accuracy."""

    met = 0
    nonsmooth = 1
    stiff = 2

    @property
    def advice(self) -> str:
        """What the verdict means, and what to try."""
        return {
            Verdict.met: "the asked accuracy is met",
            Verdict.nonsmooth: "the error falls slowly with the steps: the right-hand side is not smooth along this orbit"
            " (with the fixed film arc, close to the bearing's centre); try the arc of positive pressure, or less accuracy",
            Verdict.stiff: "the highest rung of the ladder is not enough: the system is too stiff here for an explicit"
            " method; try more steps by hand, less stiffness, or a lower accuracy",
        }[self]


def doubtful(verdicts: NDArray[np.int8]) -> str:
    """Say how many points do not meet the accuracy, and what to try; empty where all do."""
    counts = {v: int((verdicts == v).sum()) for v in Verdict if v != Verdict.met}
    return "; ".join(f"{count} of {verdicts.size} points: {v.advice}" for v, count in counts.items() if count)


@dataclass(frozen=True)
class Rungs:
    """Steps of every point.

    Attributes
    ----------
    steps : array of int, shape (point,)
        Steps per T.
    error : array, shape (point,)
        Measured error of these steps over one common period; NaN where no two rungs could be compared.
    verdict : array of int, shape (point,)
        `Verdict`.
    """

    steps: Integers
    error: Array
    verdict: NDArray[np.int8]


def choose_steps(
    ensemble: Ensemble,
    accuracy: float,
    *,
    members: NDArray[np.intp] | None = None,
    progress: Callable[[int], None] | None = None,
) -> Rungs:
    """Find the rung of every point from its present state; the ensemble is not moved.

    Parameters
    ----------
    accuracy : float
        Largest error over one common period (of an unforced model: one typical time), for each state relative to its
        range over it, or to the largest of those that it is alike to (`scales`).
    members : array of int, optional
        Indices of the points; all of them where absent. The result is theirs, in their order.

    Notes
    -----
    A trial does not redo failed steps: a point that fails on a rung tries the next one. A point that ends in contact on two
    rungs running, at times that differ by less than the accuracy of one T, takes the first; one that diverges, likewise,
    where the times are within a step. A point that has lost its order goes on to `KINKED` steps, or to the accuracy.

    Raises
    ------
    RangeError
        Where the accuracy is not in (0, 1), or below 1e-13, which rounding does not allow.
    """
    if not 1e-13 <= accuracy < 1:
        raise RangeError(f"accuracy must lie between 1e-13 and 1, not {accuracy}")
    members = np.arange(ensemble.points) if members is None else members
    n = members.size
    steps = np.full(n, LADDER[0], dtype=np.int64)
    error, verdict = np.full(n, np.nan), np.zeros(n, dtype=np.int8)
    left = np.flatnonzero(ensemble.running[members])
    verdict[left] = Verdict.stiff
    before = _Trial.of(ensemble, members[left], LADDER[0], progress)
    history, kinked = np.full((len(LADDER), n), np.nan), np.zeros(n, dtype=bool)
    for i, rung in enumerate(LADDER[1:]):
        if not left.size:
            break
        now = _Trial.of(ensemble, members[left], rung, progress)
        found = before.difference(now)
        history[i, left] = error[left] = found
        steps[left] = LADDER[i]
        good = found <= accuracy
        kinked[left] |= _stalled(history[:, left], i)
        stalled = kinked[left] & ~good & (LADDER[i] >= KINKED)
        verdict[left[good]], verdict[left[stalled]] = Verdict.met, Verdict.nonsmooth
        stay = ~good & ~stalled
        steps[left[stay]] = rung
        left, before = left[stay], now.keep(stay)
    return Rungs(steps, error, verdict)


def _stalled(history: Array, i: int) -> NDArray[np.bool_]:
    """Whether the error has fallen too slowly since a rung at most half as high."""
    half = max((j for j in range(i) if 2 * LADDER[j] <= LADDER[i]), default=None)
    if half is None or LADDER[i] < BELIEVED:
        return np.zeros(history.shape[1], dtype=bool)
    slow: NDArray[np.bool_] = history[half] < STALLED * history[i]
    return slow & np.isfinite(history[i])


@dataclass(frozen=True)
class _Trial:
    """One common period of some points with some steps; ``size`` is what their differences are divided by."""

    steps: int
    sections: Array
    size: Array
    status: NDArray[np.int8]
    end: Array

    @classmethod
    def of(
        cls, ensemble: Ensemble, members: NDArray[np.intp], steps: int, progress: Callable[[int], None] | None
    ) -> "_Trial":
        part = Ensemble(
            ensemble.model, ensemble.values[:, members], ensemble.x[:, members], orders=ensemble.orders, steps=steps,
            method=ensemble.method, workers=ensemble.workers, redo=False,
        )  # fmt: skip
        begin, start = ensemble.turns[members], part.x.copy()
        part.turns = begin.copy()
        run = part.advance(part.common_multiple, save_periods=1, extremes=True, progress=progress)
        return cls(steps, run.saved, motion_sizes(part, run, start), part.status, part.end_time / part.period - begin)

    def keep(self, which: NDArray[np.bool_]) -> "_Trial":
        return _Trial(
            self.steps, self.sections[:, :, which], self.size[:, which], self.status[which], self.end[which]
        )

    def difference(self, finer: "_Trial") -> Array:
        """Largest scaled difference of every point; infinite where only one of the two ended, or either failed."""
        with np.errstate(invalid="ignore"):
            gap = np.abs(self.sections - finer.sections)
        seen = np.isfinite(gap)
        out: Array = (np.where(seen, gap, 0.0).max(axis=0, initial=0.0) / finer.size).max(axis=0)
        ended = (self.status != Status.ok) | (finer.status != Status.ok)
        apart = np.abs(self.end - finer.end)
        contact = (self.status == Status.contact) & (finer.status == Status.contact)
        # The end of a divergence is known to a step only; one within a few steps may be the method's own.
        diverged = (self.status == Status.diverged) & (finer.status == Status.diverged)
        diverged &= (apart <= 1 / self.steps) & (self.end >= FEW / self.steps)
        out = np.where(contact, np.maximum(out, apart), out)
        return np.where(ended & ~contact & ~diverged, np.inf, out)


def motion_sizes(ensemble: Ensemble, run: Segment, start: Array) -> Array:
    """Size of the motion of every point over a run that tracked extremes, shape (state, point); see `scales`.

    A run that ended is judged by the section points that it reached.
    """
    assert run.extremes is not None
    n = ensemble.model.dimension
    points = np.concatenate([start[None], run.saved])
    known = np.isfinite(points)
    least = np.fmin(run.extremes["minimum"][:n], np.where(known, points, np.inf).min(axis=0))
    most = np.fmax(run.extremes["maximum"][:n], np.where(known, points, -np.inf).max(axis=0))
    magnitude = np.maximum(np.abs(least), np.abs(most))
    return scales(ensemble.model, ensemble.period, most - least, magnitude, share=1.0)
