"""Short cuts of weakly damped motion to its periodic orbit, each proved by a plain run or taken back.

A point whose section approaches an orbit slowly is put where its own last differences lead (`extrapolation.limit`), and goes
on as plainly as before. It has settled there only if all of these hold:

1. The multipliers that its approach shows lie inside the unit circle, and its last three differences shrink as they say.
2. `STAYS` returns of the plain run from there stay within the tolerance, and what is left of the approach at the rate of the
   largest multiplier seen is within it too.
3. The multiple is the smallest: no shorter return is within ten tolerances.
4. All Floquet multipliers of the orbit lie inside the unit circle: it is stable. The approach was no slower than the largest
   of them: the orbit is the one that the point was contracting to. What is left of the approach at the rate of the largest
   of all is within the tolerance as well.

Otherwise the point goes back to the state before, and plain settling goes on as though nothing had been tried.

The multipliers cost as much as 13 to 17 common periods for the twenty states of the gear pair, so they are asked last, of
all points together that have passed the rest (`Trials.refuse_unproved`).
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.extrapolation import DIFFERENCES, FOLLOWS, limit, wrapped
from whirlmap.analysis.monodromy import largest_multipliers
from whirlmap.analysis.periodicity import period_of, scales
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.results.status import Status

Array = NDArray[np.float64]
Points = NDArray[np.intp]

#: Returns that the plain run from an accepted point stays within the tolerance.
STAYS = 5
#: Largest return, in common periods, that is extrapolated.
LONGEST_RETURN = 4
#: A short cut is tried where plain settling is expected to take this many times what the trial costs.
WORTH = 1.5
#: After a trial that failed, plain periods until the next one, over those run so far.
PAUSE = 0.15
#: Points whose approach is looked at together: the fit of all their multiples takes 50 kB for each.
LOOKED_AT = 512
#: Above this scaled size differences are not those of a linear approach.
LINEAR = 0.1


@dataclass(frozen=True)
class _Passed:
    """Points that the plain run has passed, their returns, last scaled differences over one, and states before the trial."""

    points: Points
    multiple: NDArray[np.int64]
    change: Array
    before: Array


class Trials:
    """Points of a pool that are on trial, and what they go back to.

    Parameters
    ----------
    ensemble : Ensemble
        Points without tangent vectors.
    slot : array of int, shape (point,)
        Place of each point in the pool, kept by the pool.
    size : int
        Places of the pool.
    every : int
        Common periods between two looks at a point.
    tolerance : float
    cyclic : mapping of state index to period
        States that are angles.

    Attributes
    ----------
    multiple : array of int, shape (point,)
        Return of each point that is on trial, in common periods; 0 of the others.
    """

    def __init__(
        self, ensemble: Ensemble, slot: Points, size: int, *, every: int, tolerance: float, cyclic: dict[int, float]
    ) -> None:
        n, states = ensemble.points, ensemble.model.dimension
        self.ensemble, self.slot, self.every, self.tolerance = ensemble, slot, every, tolerance
        self.period = period_of(cyclic, states)
        self.multiple = np.zeros(n, dtype=np.int64)
        self._next = np.full(n, DIFFERENCES + 1, dtype=np.int64)  # plain periods at which a point may try (again)
        self._ran, self._turns = np.zeros(n, dtype=np.int64), np.zeros(n, dtype=np.int64)
        self._leading = np.full(n, np.nan)
        self._before = np.full((states, size), np.nan)
        self._needed = np.array([0, *map(self.needs, range(1, LONGEST_RETURN + 1))])
        self._points = np.full((self.needs(LONGEST_RETURN) + 1, states, size), np.nan)
        self._passed: list[_Passed] = []

    def needs(self, multiple: int) -> int:
        """Common periods that a trial takes."""
        return -(-STAYS * multiple // self.every) * self.every

    def left(self, points: Points) -> NDArray[np.int64]:
        """Common periods until the trials of points end."""
        return np.asarray(self._needed[self.multiple[points]] - self._ran[points])

    def begin(self, members: Points, ran: NDArray[np.int64], last: Callable[[Points, int], Array], size: Array) -> None:
        """Put the points on trial for which it is worth it.

        Parameters
        ----------
        members : array of int
            Points that run and have not returned.
        ran : array of int, shape (all points,)
            Plain common periods.
        last : callable
            ``last(points, count)``: their last section points, shape (count, state, point).
        size : array, shape (state, all points)
            Range of each state.
        """
        due = members[ran[members] >= self._next[members]]
        for first in range(0, due.size, LOOKED_AT):
            self._begin(due[first : first + LOOKED_AT], ran, last, size)

    def _begin(self, due: Points, ran: NDArray[np.int64], last: Callable[[Points, int], Array], size: Array) -> None:
        # Every return that may be tried of every point, side by side: NumPy's calls cost more than their numbers.
        multiples = range(1, LONGEST_RETURN + 1)
        long_enough = [due[ran[due] >= m * DIFFERENCES + 1] for m in multiples]
        points = np.concatenate(long_enough)
        if not points.size:
            return
        multiple = np.repeat(multiples, [p.size for p in long_enough])
        x = np.concatenate(
            [last(p, m * DIFFERENCES + 1)[::m] for m, p in zip(multiples, long_enough, strict=True)], axis=2
        )  # fmt: skip
        scale = scales(x, size[:, points], self.period)
        change = np.abs(wrapped(np.diff(x, axis=0), self.period) / scale).max(axis=1)
        first, end = change[:4].max(axis=0), change[-4:].max(axis=0)
        slow = (end < LINEAR) & (end < first) & (end > self.tolerance)
        rate = np.log(np.where(slow, first / np.where(slow, end, 1.0), np.exp(1))) / (DIFFERENCES - 4)
        left = multiple * np.log(np.where(slow, end / self.tolerance, 1.0)) / rate + 8
        slow &= left > WORTH * self._needed[multiple]
        at = np.flatnonzero(slow)
        if not at.size:
            return
        found = limit(x[:, :, at], scale[:, at], self.period, self.tolerance / 4)
        good = np.flatnonzero(np.isfinite(found.error))
        chosen, shortest = np.unique(points[at[good]], return_index=True)  # multiples ascend: the first is the shortest
        good = good[shortest]
        self._next[chosen] = (ran[chosen] * (1 + PAUSE)).astype(np.int64)
        self._start(chosen, multiple[at[good]], found.x[:, good], found.leading[good])

    def _start(self, points: Points, multiple: NDArray[np.int64], x: Array, leading: Array) -> None:
        e, slot = self.ensemble, self.slot[points]
        self._before[:, slot], self._turns[points] = e.x[:, points], e.turns[points]
        self._points[0, :, slot], self._ran[points] = x.T, 0
        self.multiple[points], self._leading[points] = multiple, leading
        e.x[:, points] = x

    def record(self, members: Points, saved: Array) -> None:
        """Take over section points of points on trial, shape (period, state, member)."""
        rows = self._ran[members] + 1 + np.arange(len(saved))[:, None]
        self._points[rows, :, self.slot[members]] = saved.transpose(0, 2, 1)
        self._ran[members] += len(saved)

    def look(self, members: Points, size: Array) -> tuple[Points, NDArray[np.int64], Array]:
        """Judge points whose trial is over, or whose run has ended; return those that have settled, multiples and distances.

        ``size`` has shape (state, all points). Points that failed are as they were before their trial.
        """
        distance, change = np.full(members.size, np.inf), np.full(members.size, np.inf)
        multiple = self.multiple[members]
        alive = self.ensemble.running[members]
        for m in np.unique(multiple):
            at = np.flatnonzero(alive & (multiple == m))
            x = self._points[: self.needs(m) + 1, :, self.slot[members[at]]]
            distance[at], change[at] = self._distance(x, int(m), size[:, members[at]], self._leading[members[at]])
        passed = distance <= self.tolerance
        lost, proved = members[~passed], members[passed]
        self._take_back(lost, self._before[:, self.slot[lost]])
        if proved.size:
            self._passed.append(_Passed(proved, multiple[passed], change[passed], self._before[:, self.slot[proved]]))
        self.multiple[members] = 0
        return members[passed], multiple[passed], distance[passed]

    def refuse_unproved(self) -> Points:
        """Ask the multipliers of all points that have passed; put back, and return, those whose orbit they refuse."""
        if not self._passed:
            return np.zeros(0, dtype=np.intp)
        points, multiple, change, before = (
            np.concatenate([getattr(p, name) for p in self._passed], axis=-1)
            for name in ("points", "multiple", "change", "before")
        )
        self._passed = []
        largest = largest_multipliers(self.ensemble, points, multiple)
        stable = largest < 1
        left = change * largest / np.where(stable, 1 - largest, 1.0)
        bad = ~stable | (left > self.tolerance) | (self._leading[points] > (1 + FOLLOWS) * largest)
        self._take_back(points[bad], before[:, bad])
        return points[bad]

    def _distance(self, x: Array, m: int, size: Array, leading: Array) -> tuple[Array, Array]:
        """Largest scaled distance of a run from its first return, infinite where a condition fails; its last change."""
        if not x.shape[2]:
            return np.zeros(0), np.zeros(0)
        scale = scales(x, size, self.period)

        def apart(a: Array, b: Array) -> Array:
            largest: Array = np.abs(wrapped(a - b, self.period) / scale).max(axis=(0, 1))
            return largest

        change = apart(x[-1:], x[-1 - m : -m])
        bad = change * leading / (1 - leading) > self.tolerance
        for d in range(1, m):
            if m % d == 0:
                bad |= apart(x[d:], x[:-d]) < 10 * self.tolerance
        return np.where(bad, np.inf, apart(x, x[np.arange(x.shape[0]) % m])), change

    def _take_back(self, points: Points, before: Array) -> None:
        e = self.ensemble
        e.x[:, points], e.turns[points] = before, self._turns[points]
        e.status[points], e.end_time[points], e.end_stop[points] = Status.ok, np.nan, -1
