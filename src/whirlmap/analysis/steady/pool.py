"""The pool of points that settle now: their last section points, when each is looked at, and whether it has returned.

`settling` runs them between two looks. Which lane a point runs in, and when it entered, changes none of its bits.
"""

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.steady.acceleration import Attempts
from whirlmap.analysis.steady.extrapolation import DIFFERENCES
from whirlmap.analysis.steady.return_search import search_windows
from whirlmap.analysis.steady.settled import Settled
from whirlmap.analysis.steady.slow_approach import LONGEST_RETURN
from whirlmap.analysis.trends.film_thinning import narrowest_gap, thinning_power, turning
from whirlmap.analysis.trends.trend import trend
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.scales import scales
from whirlmap.kernels.running.loops import compiled
from whirlmap.kernels.writing.routine import LANES
from whirlmap.options.computed import Settling
from whirlmap.results.status import Status

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Common periods between two convergence checks of a point, at first; later the largest power of two that is at most a
#: `SELDOM`-th of those it has run, up to `MOST`: for small models one check costs more than the periods between two checks.
ROUND, SELDOM, MOST = 4, 8, 32
#: Part of the largest magnitude that a state has had at all which counts as its magnitude: one that has died out
#: does not return by its own size.
PAST = 1e-3
#: A drift may swing, within the time between two looks, by so many times the way that it goes.
SWINGS = 10.0
#: Blocks of lanes in the pool, for each worker: many, for what Python does in a round is shared by them. Section points of
#: all of them take so many bytes at most, where that leaves a block to each worker.
POOL, BYTES = 128, 2**27


def looks(ran: Integers, longest: Integers) -> Integers:
    """Common periods after which points that have run ``ran`` of them, and run ``longest``, are looked at next."""
    every = np.clip(2 ** np.floor(np.log2(np.maximum(ran, 1) / SELDOM)), ROUND, MOST).astype(np.int64)
    return np.asarray(np.minimum((ran // every + 1) * every, -(-longest // ROUND) * ROUND))


@compiled(
    {
        "active": "ints", "chosen": "int", "slot": "ints", "saved": "doubles", "rows": "ints",
        "states": "int", "low": "doubles", "high": "doubles", "least": "doubles", "most": "doubles", "history": "doubles",
        "ring": "int", "ran": "ints", "waited": "ints", "attempt": "ints", "attempt_points": "doubles",
        "attempt_rows": "int", "attempt_ran": "ints",
    },
)  # fmt: skip
def _take_over(
    active: Integers, chosen: int, slot: Integers, saved: Array, rows: Integers, states: int, low: Array, high: Array,
    least: Array, most: Array, history: Array, ring: int, ran: Integers, waited: Integers, attempt: Integers,
    attempt_points: Array, attempt_rows: int, attempt_ran: Integers,
) -> None:  # fmt: skip
    """Take over ``rows`` section points of each active point, shape (row, state, active), and the extremes (state, active).

    Points under an attempt have theirs in ``attempt_points``, the others in ``history``.
    """
    for j in range(chosen):
        p = active[j]
        at = slot[p]
        waited[p] += rows[j]
        for k in range(states):
            if low[k * chosen + j] < least[at * states + k]:
                least[at * states + k] = low[k * chosen + j]
            if high[k * chosen + j] > most[at * states + k]:
                most[at * states + k] = high[k * chosen + j]
        for r in range(rows[j]):
            for k in range(states):
                x = saved[(r * states + k) * chosen + j]
                if attempt[p] > 0:
                    attempt_points[(at * attempt_rows + attempt_ran[p] + 1 + r) * states + k] = x
                else:
                    history[(at * ring + (ran[p] + r) % ring) * states + k] = x
        if attempt[p] > 0:
            attempt_ran[p] += rows[j]
        else:
            ran[p] += rows[j]


class Pool:
    """Points that run now, with their last section points, and the queue of those that wait."""

    def __init__(
        self, ensemble: Ensemble, settling: Settling, longest: Integers, wide: Array, strict: Array, period: Array
    ) -> None:
        n, states = ensemble.points, ensemble.model.dimension
        self.ensemble, self.settling, self.longest, self.period = ensemble, settling, longest.astype(np.int64), period
        self.accelerate = settling.accelerate and not ensemble.tangents
        self.wide, self.strict, self.waiting = wide, strict, 0
        self.active = np.zeros(0, dtype=np.intp)
        kept = max(2 * settling.most, settling.first_window, LONGEST_RETURN * DIFFERENCES + 1)
        ring, least = -(-kept // ROUND) * ROUND, LANES * ensemble.workers
        self.size = min(max(min(POOL * least, BYTES // (8 * ring * states)), least), n)
        self.history = np.full((self.size, ring, states), np.nan)
        self.low, self.high = np.empty((self.size, states)), np.empty((self.size, states))  # since the last look
        self.largest = np.empty((self.size, states))  # magnitude since the beginning
        self.slot = np.full(n, -1, dtype=np.intp)
        self.free = list(range(self.size))
        self.ran, self.looked = (np.zeros(n, dtype=np.int64) for _ in range(2))  # common periods without those of attempts
        self.next = looks(self.ran, longest)
        self.settled = Settled.none(ensemble)
        self.cyclic = {int(k): float(period[k]) for k in np.flatnonzero(np.isfinite(period))}
        self.windows = np.array(windows(settling))
        self.tolerance = np.array([settling.tolerance])
        self._own, self._size, self._room = np.empty(states), np.empty(states), np.empty(max(self.history.shape[1], states))
        self.attempts = Attempts(ensemble, self.slot, self.size, every=ROUND, tolerance=settling.tolerance, period=period)
        self.fill()

    def fill(self) -> None:
        """Give the free places of the pool to the next points that have not ended."""
        n, running = self.ensemble.points, self.ensemble.running
        entering = []
        while self.free and self.waiting < n:
            if running[self.waiting]:
                self.slot[self.waiting] = self.free.pop()
                entering.append(self.waiting)
            self.waiting += 1
        self.forget(np.array(entering, dtype=np.intp))
        self.largest[self.slot[entering]] = np.abs(self.ensemble.x[:, entering]).T
        self.active = np.concatenate([self.active, np.array(entering, dtype=np.intp)])

    def forget(self, points: NDArray[np.intp]) -> None:
        """Begin the ranges of points anew."""
        self.low[self.slot[points]], self.high[self.slot[points]] = np.inf, -np.inf

    def stretch(self) -> Integers:
        """Common periods until each active point is due for a check."""
        at = self.active
        return np.where(self.attempts.multiple[at] > 0, self.attempts.left(at), self.next[at] - self.ran[at])

    def take(self, rows: Integers, saved: Array, low: Array, high: Array) -> None:
        """Take over so many section points of each active point, and the extremes, and check them."""
        at, attempts = self.active, self.attempts
        _take_over(
            active=at, chosen=at.size, slot=self.slot, saved=saved, rows=rows, states=self.period.size, low=low, high=high,
            least=self.low, most=self.high, history=self.history, ring=self.history.shape[1], ran=self.ran,
            waited=self.settled.waited, attempt=attempts.multiple, attempt_points=attempts.points,
            attempt_rows=attempts.points.shape[1], attempt_ran=attempts.ran,
        )  # fmt: skip
        done = self.look(at, self.ensemble.running[at])
        if done.any():
            self.free += self.slot[at[done]].tolist()
            self.active = at[~done]
            self.fill()

    def look(self, at: NDArray[np.intp], running: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Look at points that are due; returns which of them are done."""
        s, trying = self.settled, self.attempts.multiple[at] > 0
        s.scale[:, at] = self.sizes(at, running)
        s.moved[:, at] = np.fmax(s.moved[:, at], (self.high[self.slot[at]] - self.low[self.slot[at]]).T)
        self.beyond(at[~running & ~trying & (self.ensemble.status[at] == Status.diverged)])
        self.thins(at[~running & ~trying & (self.ensemble.status[at] == Status.unresolved)])
        self.forget(at)
        plain = at
        if trying.any():
            passed, multiple, distance = self.attempts.look(at[trying], s.scale)
            s.multiple[passed], s.distance[passed], s.accelerated[passed] = multiple, distance, True
            plain = at[~trying]
        self.search(plain if running.all() else at[~trying & running])
        self.looked[plain] = self.ran[plain]
        self.next[plain] = looks(self.ran[plain], self.longest[plain])
        done: NDArray[np.bool_] = ~running | (s.multiple[at] > 0) | (self.ran[at] >= self.longest[at])
        if self.accelerate:
            self.attempts.begin(at[~done & ~trying], self.ran, self.history, s.scale)
        return done

    def sizes(self, at: NDArray[np.intp], running: NDArray[np.bool_]) -> Array:
        """What differences of points are divided by, since their last look: `scales`; one where they have ended."""
        slot, e = self.slot[at], self.ensemble
        low, high = (np.where(running, side[slot].T, 0.0) for side in (self.low, self.high))
        magnitude = np.maximum(np.abs(low), np.abs(high))
        self.largest[slot] = np.maximum(self.largest[slot], magnitude.T)
        size = scales(e.model, e.period[at], high - low, np.maximum(magnitude, PAST * self.largest[slot].T))
        return size * self.wide[at]

    def beyond(self, points: NDArray[np.intp]) -> None:
        """See whether points that went beyond the bound had grown or drifted there steadily.

        What only swings further from period to period has not drifted: its range since the last look is too large.
        """
        ring = self.history.shape[1]
        for p in points:
            rows = (self.ran[p] - np.arange(min(self.ran[p], ring), 0, -1)) % ring
            section = self.history[self.slot[p], rows]
            seen = trend(section[np.isfinite(section).all(axis=1), :, None], self.cyclic)
            drift, slot = seen.drift[:, 0], self.slot[p]
            way = np.abs(drift) * (self.ran[p] - self.looked[p])
            drifts = (self.high[slot] - self.low[slot] <= SWINGS * way) | (drift == 0)
            self.settled.growth[p], self.settled.drift[:, p] = seen.growth[0], drift if drifts.all() else 0.0

    def thins(self, points: NDArray[np.intp]) -> None:
        """See whether points whose steps failed had a film that thinned on and on."""
        e, ring = self.ensemble, self.history.shape[1]
        for p in points:
            rows = (self.ran[p] - np.arange(min(self.ran[p], ring), 0, -1)) % ring
            section = self.history[self.slot[p], rows]
            section = section[np.isfinite(section).all(axis=1)]
            widest = float(narrowest_gap(e.model, e.values[:, p], section).max(initial=0.0))
            late = section[len(section) // 2 :]
            begin = max(int(self.ran[p]) - len(rows), 0) + len(section) // 2
            self.settled.thinning[p] = thinning_power(e.model, e.values[:, p], late, begin, widest)
            self.settled.turning[p] = turning(late, self.cyclic)

    def search(self, points: NDArray[np.intp]) -> None:
        """Search the windows of points that are due."""
        s = self.settled
        search_windows(
            points=points, chosen=points.size, slot=self.slot, history=self.history, ring=self.history.shape[1],
            states=self.period.size, n=self.slot.size, windows=self.windows, lengths=self.windows.size, ran=self.ran,
            looked=self.looked, longest=self.longest, period=self.period, tolerance=self.tolerance, scale=s.scale,
            own=self._own, size=self._size, room=self._room, multiple=s.multiple, distance=s.distance,
        )  # fmt: skip
        s.distance[points] *= self.strict[points]


def windows(settling: Settling) -> list[int]:
    """Lengths of the windows, each twice the one before."""
    out = [min(settling.first_window, 2 * settling.most)]
    while out[-1] < 2 * settling.most:
        out.append(min(2 * out[-1], 2 * settling.most))
    return out
