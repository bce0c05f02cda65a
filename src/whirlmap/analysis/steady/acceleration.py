"""Convergence acceleration: extrapolate to the periodic orbit, verify by integration, else restore.

A point whose section approaches an orbit slowly is moved to its extrapolated orbit (`extrapolation.step_to_limit`) and
integrated from there. It has converged only if all of these hold:

1. The multipliers that its approach shows lie inside the unit circle, and its last three differences shrink as they say.
2. `STAYS` returns of the verification run stay within the tolerance, and so does what is left of the approach at the rate of
   the largest multiplier seen.
3. The multiple is the smallest: no shorter return is within ten tolerances.
4. All Floquet multipliers of the orbit lie inside the unit circle: it is stable. The approach was no slower than the largest
   of them: the orbit is the one that the point was contracting to. What is left of the approach at the rate of the largest
   of all is within the tolerance as well.

Otherwise the state before is restored, and integration continues as without the attempt.

The multipliers cost as much as 13 to 17 common periods for the twenty states of the gear pair, so they are asked last, of
all points together that have passed the rest (`Attempts.refuse_unproved`).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.steady.extrapolation import DIFFERENCES, FOLLOWS
from whirlmap.analysis.steady.return_search import PARTS, across, place, sized, step
from whirlmap.analysis.steady.slow_approach import LONGEST_RETURN, ends_of_approaches, room_for_approaches
from whirlmap.analysis.variational.monodromy import largest_multipliers
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.kernels.running.loops import compiled
from whirlmap.results.status import Status

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Points = NDArray[np.intp]

#: Returns of the verification run that stay within the tolerance.
STAYS = 5
#: After a failed extrapolation attempt, periods of plain integration until the next one, over those run so far.
PAUSE = 0.15


@dataclass(frozen=True)
class _Passed:
    """Points that passed the verification run: returns, last scaled differences over one, and states before the attempt."""

    points: Points
    multiple: NDArray[np.int64]
    change: Array
    before: Array


@compiled(
    {
        "members": "ints", "chosen": "int", "slot": "ints", "points": "doubles", "rows": "int", "states": "int", "n": "int",
        "needed": "ints", "multiple": "ints", "leading": "doubles", "period": "doubles", "tolerance": "doubles",
        "scale": "doubles", "own": "doubles", "size": "doubles", "distance": "doubles", "change": "doubles",
    },
    parts=PARTS,
)  # fmt: skip
def _distances(
    members: Integers, chosen: int, slot: Integers, points: Array, rows: int, states: int, n: int, needed: Integers,
    multiple: Integers, leading: Array, period: Array, tolerance: Array, scale: Array, own: Array, size: Array,
    distance: Array, change: Array,
) -> None:  # fmt: skip
    """Largest scaled distance of runs from their first return, infinite where a condition fails; their last change.

    ``points`` has shape (slot, row, state), ``scale`` (state, n).
    """
    for j in range(chosen):
        p = members[j]
        m, base, count = multiple[p], slot[p] * rows * states, needed[multiple[p]] + 1
        for k in range(states):
            own[k] = scale[k * n + p]
        distance[j] = np.inf
        if not sized(points, base, rows, 0, count, 1, states, own, size):
            continue
        last = place(base, 0, count - 1, rows, states)
        change[j] = step(points, last, last - m * states, states, period, size)
        good = change[j] * leading[p] / (1 - leading[p]) <= tolerance[0]
        for d in range(1, m):
            enough = 10 * tolerance[0]
            if m % d == 0 and across(points, base, rows, 0, count, d, states, period, size, enough) < enough:
                good = False
        if good:
            distance[j] = 0.0
            for i in range(m, count):
                at, first = base + i * states, base + i % m * states
                distance[j] = max(distance[j], step(points, at, first, states, period, size))


class Attempts:
    """Points of a pool under an extrapolation attempt, and the states to which failed ones are restored.

    Parameters
    ----------
    ensemble : Ensemble
        Points without tangent vectors.
    slot : array of int, shape (point,)
        Slot of each point in the pool, kept by the pool.
    size : int
        Slots of the pool.
    every : int
        Common periods between two convergence checks of a point.
    tolerance : float
    period : array, shape (state,)
        Of cyclic states; infinite for the others.

    Attributes
    ----------
    multiple : array of int, shape (point,)
        Return of each point under an attempt, in common periods; 0 of the others.
    ran : array of int, shape (point,)
        Common periods of its attempt.
    needed : array of int
        Common periods that an attempt takes, by multiple.
    points : array, shape (slot, row, state)
        Section points of the attempts, the first one where each began.
    """

    def __init__(
        self, ensemble: Ensemble, slot: Points, size: int, *, every: int, tolerance: float, period: Array
    ) -> None:
        n, states = ensemble.points, ensemble.model.dimension
        self.ensemble, self.slot, self.every, self.period = ensemble, slot, every, period
        self.tolerance = np.array([tolerance])
        self.multiple = np.zeros(n, dtype=np.int64)
        self._next = np.full(n, DIFFERENCES + 1, dtype=np.int64)  # plain periods at which a point may try (again)
        self.ran, self._turns = np.zeros(n, dtype=np.int64), np.zeros(n, dtype=np.int64)
        self._leading = np.full(n, np.nan)
        self._before = np.full((states, size), np.nan)
        self.needed = np.array([0, *map(self.needs, range(1, LONGEST_RETURN + 1))])
        self.points = np.full((size, self.needs(LONGEST_RETURN) + 1, states), np.nan)
        self._own, self._size = np.empty(states), np.empty(states)
        self._fit = room_for_approaches(states)
        self._passed: list[_Passed] = []

    def needs(self, multiple: int) -> int:
        """Common periods that an attempt takes."""
        return -(-STAYS * multiple // self.every) * self.every

    def left(self, points: Points) -> NDArray[np.int64]:
        """Common periods until the attempts of points end."""
        return np.asarray(self.needed[self.multiple[points]] - self.ran[points])

    def begin(self, members: Points, ran: Integers, history: Array, size: Array) -> None:
        """Extrapolate the points for which that is expected to save time.

        Parameters
        ----------
        members : array of int
            Points that run and have not returned.
        ran : array of int, shape (all points,)
            Plain common periods.
        history : array, shape (slot, ring, state)
            Their last section points.
        size : array, shape (state, all points)
            Range of each state.
        """
        due = members[ran[members] >= self._next[members]]
        if not due.size:
            return
        multiple, x, leading = ends_of_approaches(
            due, self.slot, history, ran, self.needed, self.period, self.tolerance, size, self._fit
        )
        found = np.flatnonzero(multiple)
        if found.size:
            chosen = due[found]
            self._next[chosen] = (ran[chosen] * (1 + PAUSE)).astype(np.int64)
            self._start(chosen, multiple[found], x[found].T, leading[found])

    def _start(self, points: Points, multiple: NDArray[np.int64], x: Array, leading: Array) -> None:
        e, slot = self.ensemble, self.slot[points]
        self._before[:, slot], self._turns[points] = e.x[:, points], e.turns[points]
        self.points[slot, 0], self.ran[points] = x.T, 0
        self.multiple[points], self._leading[points] = multiple, leading
        e.put(points, x)

    def look(self, members: Points, size: Array) -> tuple[Points, NDArray[np.int64], Array]:
        """Judge points whose attempt is over, or whose run has ended; return those that converged, multiples and distances.

        ``size`` has shape (state, all points). Points that failed are as they were before their attempt.
        """
        distance, change = np.full(members.size, np.inf), np.full(members.size, np.inf)
        multiple = self.multiple[members]
        alive = np.flatnonzero(self.ensemble.running[members])
        found = np.empty(alive.size), np.empty(alive.size)
        _distances(
            members=members[alive], chosen=alive.size, slot=self.slot, points=self.points, rows=self.points.shape[1],
            states=self.period.size, n=self.slot.size, needed=self.needed, multiple=self.multiple, leading=self._leading,
            period=self.period, tolerance=self.tolerance, scale=size, own=self._own, size=self._size,
            distance=found[0], change=found[1],
        )  # fmt: skip
        distance[alive], change[alive] = found
        passed = distance <= self.tolerance[0]
        lost, proved = members[~passed], members[passed]
        self._take_back(lost, self._before[:, self.slot[lost]])
        if proved.size:
            self._passed.append(_Passed(proved, multiple[passed], change[passed], self._before[:, self.slot[proved]]))
        self.multiple[members] = 0
        return members[passed], multiple[passed], distance[passed]

    def refuse_unproved(self) -> Points:
        """Compute Floquet multipliers of all accepted points; restore, and return, those whose orbit is not stable."""
        if not self._passed:
            return np.zeros(0, dtype=np.intp)
        points, multiple, change, before = (
            np.concatenate([getattr(p, name) for p in self._passed], axis=-1)
            for name in ("points", "multiple", "change", "before")
        )
        self._passed = []
        largest = largest_multipliers(self.ensemble, points, multiple)
        stable = largest < 1
        left = change * np.where(stable, largest, 0.0) / np.where(stable, 1 - largest, 1.0)
        bad = ~stable | (left > self.tolerance[0]) | (self._leading[points] > (1 + FOLLOWS) * largest)
        self._take_back(points[bad], before[:, bad])
        return points[bad]

    def _take_back(self, points: Points, before: Array) -> None:
        e = self.ensemble
        e.put(points, before)
        e.turns[points] = self._turns[points]
        e.status[points], e.end_time[points], e.end_stop[points] = Status.ok, np.nan, -1
