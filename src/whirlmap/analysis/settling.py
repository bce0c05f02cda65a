"""Settling without waste: every point runs until its section has provably repeated, and the next one takes its place.

Forced models. All points share a pool of lanes. In each round the points in the pool run `ROUND` common periods; then each
is looked at on its own, by its own history:

1. The last `Settling.first_window` section points are searched for a return after m common periods; whenever the number of
   points has doubled, the longer window is searched too, for returns up to `Settling.most`.
2. A return counts once what is left of the transient is small as well: where successive differences shrink by a factor r
   from one return to the next, the distance to the limit is the last difference times r / (1 - r); and once no shorter
   return is still on its way.
3. A point that approaches its orbit slowly is put where its differences lead, and stays if that is proved
   (`acceleration`); where not it is put back, and the trial counts for nothing but time. Models whose rates jump have no
   multipliers to prove it by (`saltation`), and settle plainly.
4. A point that has returned, ended, or run its full length leaves the pool, and the next one enters.

Which lane a point runs in, and when, changes none of its bits (`Ensemble`).
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.acceleration import LONGEST_RETURN, Trials
from whirlmap.analysis.extrapolation import DIFFERENCES
from whirlmap.analysis.periodicity import distance_to_limit, nearest_return, shortest_return, shrinking
from whirlmap.errors import RangeError
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.kernels.routine import LANES

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Common periods between two looks at a point.
ROUND = 4
#: Blocks of lanes in the pool, for each worker: many, for what Python does in a round is shared by them.
POOL = 128


@dataclass(frozen=True)
class Settling:
    """How long to wait and how sure to be.

    Attributes
    ----------
    transient : int
        Common periods that a point which does not return runs before its longest window begins. Points that return
        earlier stop there.
    first_window : int
        Common periods of the first window; a return is sought up to half of it.
    most : int
        Largest return that is sought, in common periods.
    keep : int
        Least number of T that are recorded once settled; at least two common periods are.
    tolerance : float
        Largest difference that counts as a return, relative to the range of each state.
    accelerate : bool
        Whether slow approaches may be cut short.
    """

    transient: int = 100
    first_window: int = 8
    most: int = 64
    keep: int = 64
    tolerance: float = 1e-6
    accelerate: bool = True

    def __post_init__(self) -> None:
        """Refuse counts that make no sense, naming the one."""
        for name, least in (("transient", 0), ("first_window", 2), ("most", 1), ("keep", 1)):
            value = getattr(self, name)
            if not least <= value <= 10_000_000:
                raise RangeError(f"{name} must lie between {least} and 10000000, not {value}")
        if not 0 < self.tolerance < 1:
            raise RangeError(f"tolerance must lie between 0 and 1, not {self.tolerance}")

    @property
    def longest(self) -> int:
        """Common periods after which a point is given up."""
        return self.transient + max(2 * self.most, self.first_window)


@dataclass(frozen=True)
class Settled:
    """How every point of an ensemble settled; arrays end in the point axis.

    Attributes
    ----------
    multiple : array of int
        Smallest return in common periods; 0 where there is none.
    distance : array
        The return distance that decided, over the range of each state; where a point was given up, the smallest one. NaN
        where it ended.
    scale : array, shape (state, point)
        Range of each state over the last round.
    waited : array of int
        Common periods run, trials included.
    accelerated : array of bool
        Whether the approach was cut short.
    """

    multiple: Integers
    distance: Array
    scale: Array
    waited: Integers
    accelerated: NDArray[np.bool_]

    def take(self, again: "Settled", points: NDArray[np.intp]) -> None:
        """Take over how some points settled that have settled on, in place; the time they waited adds up."""
        self.multiple[points], self.distance[points] = again.multiple, again.distance
        self.scale[:, points], self.accelerated[points] = again.scale, again.accelerated
        self.waited[points] += again.waited


def settle(
    ensemble: Ensemble,
    settling: Settling,
    *,
    cyclic: dict[int, float] | None = None,
    progress: Callable[[int], None] | None = None,
) -> Settled:
    """Settle all points of a forced model, in place.

    Parameters
    ----------
    cyclic : mapping of state index to period, optional
        States that are angles.

    Returns
    -------
    Settled
        Points that ended, and points that did not return in `Settling.longest` common periods, have multiple 0.
    """
    common = ensemble.common_multiple
    pool = _Pool(ensemble, settling, cyclic or {})
    while pool.active.size:
        segment = ensemble.advance(
            ROUND * common, members=pool.active, save_periods=common, extremes=True, progress=progress
        )
        assert segment.extremes is not None
        pool.look(segment.saved, segment.extremes["maximum"] - segment.extremes["minimum"])
    refused = pool.trials.refuse_unproved()
    if refused.size:
        part = ensemble.subset(refused)
        again = settle(part, replace(settling, accelerate=False), cyclic=cyclic, progress=progress)
        ensemble.absorb(part, refused)
        pool.settled.take(again, refused)
    return pool.settled


class _Pool:
    """Points that run now, with their last section points, and the queue of those that wait."""

    def __init__(self, ensemble: Ensemble, settling: Settling, cyclic: dict[int, float]) -> None:
        n, states = ensemble.points, ensemble.model.dimension
        self.ensemble, self.settling, self.cyclic = ensemble, settling, cyclic
        self.accelerate = settling.accelerate and not ensemble.tangents and not ensemble.model.jumps
        self.waiting = 0
        self.active = np.zeros(0, dtype=np.intp)
        self.size = min(POOL * LANES * ensemble.workers, n)
        longest = max(2 * settling.most, settling.first_window, LONGEST_RETURN * DIFFERENCES + 1)
        longest = -(-longest // ROUND) * ROUND
        self.history = np.full((longest, states, self.size), np.nan)
        self.slot = np.full(n, -1, dtype=np.intp)
        self.free = list(range(self.size))
        self.ran = np.zeros(n, dtype=np.int64)  # common periods without those of trials
        self.settled = Settled(
            np.zeros(n, dtype=np.int64), np.full(n, np.nan), np.full((states, n), np.nan), np.zeros(n, dtype=np.int64),
            np.zeros(n, dtype=np.bool_),
        )  # fmt: skip
        self.trials = Trials(
            ensemble, self.slot, self.size, every=ROUND, tolerance=settling.tolerance, cyclic=self.cyclic
        )  # fmt: skip
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
        self.active = np.concatenate([self.active, np.array(entering, dtype=np.intp)])

    def look(self, saved: Array, size: Array) -> None:
        """Take over a round's section points, and let the points that are done leave."""
        at, s = self.active, self.settled
        s.waited[at] += ROUND
        s.scale[:, at] = size[: s.scale.shape[0]]
        trying = self.trials.multiple[at] > 0
        self.end_trials(at[trying], saved[:, :, trying])
        self.look_plainly(at[~trying], saved[:, :, ~trying])
        done = ~self.ensemble.running[at] | (s.multiple[at] > 0) | (self.ran[at] >= self.settling.longest)
        if self.accelerate:
            self.trials.begin(at[~done & ~trying], self.ran, self.last, positive(s.scale))
        self.free += self.slot[at[done]].tolist()
        self.active = at[~done]
        self.fill()

    def end_trials(self, at: NDArray[np.intp], saved: Array) -> None:
        """Take over a round of points on trial, and the labels of those that have passed."""
        s = self.settled
        passed, multiple, distance = self.trials.look(at, saved, positive(s.scale))
        s.multiple[passed], s.distance[passed], s.accelerated[passed] = multiple, distance, True

    def look_plainly(self, at: NDArray[np.intp], saved: Array) -> None:
        """Take over a round of points that run plainly, and search the windows that are due."""
        rows = (self.ran[at] + np.arange(ROUND)[:, None]) % self.history.shape[0]
        self.history[rows, :, self.slot[at]] = saved.transpose(0, 2, 1)
        self.ran[at] += ROUND
        ran, alive = self.ran[at], self.ensemble.running[at]
        for k, window in enumerate(self.windows):
            due = (ran % window == 0) if k else (ran >= window)
            due |= (ran >= self.settling.longest) & (ran >= window)
            these = at[alive & due & (self.settled.multiple[at] == 0)]
            if these.size:
                self.search(these, window)

    def last(self, points: NDArray[np.intp], count: int) -> Array:
        """Last section points of plain running, shape (count, state, point)."""
        rows = (self.ran[points] - count + np.arange(count)[:, None]) % self.history.shape[0]
        return self.history[rows, :, self.slot[points]].transpose(0, 2, 1)

    @cached_property
    def windows(self) -> list[int]:
        """Lengths of the windows, each twice the one before."""
        out = [min(self.settling.first_window, 2 * self.settling.most)]
        while out[-1] < 2 * self.settling.most:
            out.append(min(2 * out[-1], 2 * self.settling.most))
        return out

    def search(self, points: NDArray[np.intp], window: int) -> None:
        """Look for a return in the last ``window`` section points."""
        s, tolerance = self.settled, self.settling.tolerance
        x = self.last(points, window)
        scale = positive(s.scale[:, points])
        multiple, s.distance[points] = shortest_return(
            x, scale=scale, tolerance=tolerance, most=max(window // 2, 1), cyclic=self.cyclic
        )
        given_up = (multiple == 0) & (self.ran[points] >= self.settling.longest)
        if window == self.windows[-1] and given_up.any():
            s.distance[points[given_up]] = nearest_return(
                x[:, :, given_up], scale=scale[:, given_up], tolerance=tolerance, most=max(window // 2, 1),
                cyclic=self.cyclic,
            )  # fmt: skip
        returned = np.flatnonzero(multiple > 0)
        if not returned.size:
            return
        multiple, scale, returned = multiple[returned], scale[:, returned], points[returned]
        near = distance_to_limit(self.last(returned, window), multiple, scale=scale, cyclic=self.cyclic) <= tolerance
        # a spiral of nearly m to the round looks like an orbit of m in one window, and not in two
        longer = (self.ran[returned] >= 2 * window) & (2 * window <= self.history.shape[0])
        for length in (window, 2 * window):
            at = np.flatnonzero(near & (longer == (length > window)))
            if at.size:
                x = self.last(returned[at], length)
                near[at] = ~shrinking(x, multiple[at], scale=scale[:, at], cyclic=self.cyclic)
        s.multiple[returned[near]] = multiple[near]


def positive(size: Array) -> Array:
    """Ranges, with those of states that do not move at all made one: their differences are zero anyway."""
    return np.where(size > 0, size, 1.0)
