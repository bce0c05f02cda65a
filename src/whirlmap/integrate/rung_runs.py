"""Test runs of points with given steps per T, and the difference between two of them."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.scales import scales
from whirlmap.integrate.segment import Segment
from whirlmap.results.status import Status

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Steps within which the ends of one divergence lie: a pole is passed by a step, and what follows grows without bound.
ALIKE = 4
#: Steps of a run within which a divergence is not believed.
FEW = 8


class RungRuns:
    """Runs of points over some stretches, with any steps, from the section points of their motion.

    A stretch is a common period of the forcing, or where that is too long as many T as show its slowest harmonic; successive
    stretches then begin at different phases, and run one after another.
    """

    def __init__(
        self, ensemble: Ensemble, members: NDArray[np.intp], sections: int, span: int,
        observe: Callable[[Ensemble, int], Array] | None, progress: Callable[[int], None] | None,
    ) -> None:  # fmt: skip
        self.ensemble, self.members, self.observe, self.progress = ensemble, members, observe, progress
        self.stretch = ensemble.rung_periods
        self.periods, self.sections = span * self.stretch, sections
        self.starts = ensemble.x[None, :, members]
        if sections > 1:
            along = ensemble.subset(members)
            saved = along.advance((sections - 1) * self.stretch, save_periods=self.stretch, progress=progress).saved
            self.starts = np.concatenate([self.starts, saved])

    def run(self, points: NDArray[np.intp], steps: int | Integers) -> "RungRun":
        """Run some of the members, given by their place among them, with the same steps or each with its own."""
        together = self.stretch == self.ensemble.common_multiple
        blocks = [np.arange(self.sections)] if together else [np.array([k]) for k in range(self.sections)]
        first, *others = [self._run(points, steps, block) for block in blocks]
        return first.beside(others) if others else first

    def _run(self, points: NDArray[np.intp], steps: int | Integers, sections: NDArray[np.intp]) -> "RungRun":
        """Run points from some of their sections, which are at the same phase of the forcing."""
        steps = steps if isinstance(steps, int) else np.tile(steps, sections.size)
        e, at = self.ensemble, np.tile(self.members[points], sections.size)
        x = np.moveaxis(self.starts[sections][:, :, points], 0, 1).reshape(e.model.dimension, -1)
        # A motion that ended on the way to a section leaves none: its first one stands in for it.
        lost = ~np.isfinite(x)
        x = np.where(lost, np.tile(self.starts[0][:, points], sections.size), x)
        part = Ensemble(
            e.model, e.values[:, at], x, orders=e.orders, steps=steps, method=e.method, workers=e.workers, redo=False,
            beyond=e.limits[:, at], turn=e.period[at],
        )  # fmt: skip
        part.turns = e.turns[at] + (0 if sections.size > 1 else int(sections[0]) * self.stretch)
        begin = part.turns.copy()
        seen = self.observe(part, self.periods) if self.observe else np.zeros((0, at.size))
        run = part.advance(self.periods, save_periods=1, extremes=True, progress=self.progress)
        end = part.end_time / part.period - begin
        sizes = motion_sizes(part, run, x)
        return RungRun(steps, run.saved, sizes, part.status, end, seen, sections.size)


@dataclass(frozen=True)
class RungRun:
    """Some points with some steps; ``size`` is what differences are divided by. Columns are sections by points."""

    steps: int | Integers
    saved: Array
    size: Array
    status: NDArray[np.int8]
    end: Array
    seen: Array
    sections: int

    def keep(self, which: NDArray[np.intp]) -> "RungRun":
        """Some of the points, by their places, in that order."""
        k = (np.arange(self.sections)[:, None] * (self.status.size // self.sections) + which).ravel()
        return RungRun(
            self.steps, self.saved[:, :, k], self.size[:, k], self.status[k], self.end[k], self.seen[:, k], self.sections
        )  # fmt: skip

    def largest(self) -> Array:
        """Size of each point's motion, shape (state, point)."""
        return np.asarray(self.size.reshape(len(self.size), self.sections, -1).max(axis=1))

    def beside(self, others: "list[RungRun]") -> "RungRun":
        """The same points from later sections too."""
        every = [self, *others]
        rows = max(len(t.seen) for t in every)
        seen = [np.pad(t.seen, ((0, rows - len(t.seen)), (0, 0)), constant_values=np.nan) for t in every]
        steps = self.steps if isinstance(self.steps, int) else np.concatenate([np.atleast_1d(t.steps) for t in every])
        saved, size, status, end = (
            np.concatenate([getattr(t, n) for t in every], axis=-1) for n in ("saved", "size", "status", "end")
        )
        return RungRun(steps, saved, size, status, end, np.concatenate(seen, axis=-1), sum(t.sections for t in every))

    def joined(self, other: "RungRun") -> "RungRun":
        """These points, and others with the same steps."""

        def both(a: NDArray, b: NDArray) -> NDArray:
            parts = [v.reshape(*v.shape[:-1], self.sections, v.shape[-1] // self.sections) for v in (a, b)]
            return np.concatenate(parts, axis=-1).reshape(*a.shape[:-1], a.shape[-1] + b.shape[-1])

        names = ("saved", "size", "status", "end")
        saved, size, status, end = (both(getattr(self, n), getattr(other, n)) for n in names)
        rows = max(len(self.seen), len(other.seen))
        seen = both(*(np.pad(t.seen, ((0, rows - len(t.seen)), (0, 0)), constant_values=np.nan) for t in (self, other)))
        return RungRun(other.steps, saved, size, status, end, seen, self.sections)

    def difference(self, finer: "RungRun") -> tuple[Array, NDArray[np.bool_]]:
        """Largest scaled difference of every point, infinite where only one of the two ended, or either failed.

        And where both diverged, or failed, at the same time.
        """
        with np.errstate(invalid="ignore"):
            gap = np.abs(self.saved - finer.saved)
        seen = np.isfinite(gap)
        out: Array = (np.where(seen, gap, 0.0).max(axis=0, initial=0.0) / finer.size).max(axis=0)
        rows = min(len(self.seen), len(finer.seen))
        noted = np.abs(self.seen[:rows] - finer.seen[:rows])
        out = np.maximum(out, np.where(np.isfinite(noted), noted, 0.0).max(axis=0, initial=0.0))
        ended = (self.status != Status.ok) | (finer.status != Status.ok)
        apart = np.abs(self.end - finer.end)
        contact = (self.status == Status.contact) & (finer.status == Status.contact)
        # The end of a divergence is known to some steps only; one within a few steps may be the method's own. A pole is met
        # by steps that fail, which a run on a rung does not redo.
        gone = (Status.diverged, Status.unresolved)
        diverged = np.isin(self.status, gone) & np.isin(finer.status, gone)
        diverged &= (apart <= ALIKE / self.steps) & (self.end >= FEW / self.steps)
        out = np.where(contact, np.maximum(out, apart), out)
        worst: Array = np.where(ended & ~contact & ~diverged, np.inf, out).reshape(self.sections, -1).max(axis=0)
        return worst, np.asarray(diverged.reshape(self.sections, -1).any(axis=0))


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
