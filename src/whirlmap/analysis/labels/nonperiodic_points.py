"""Non-periodic operating points: exponent, section and label, each with an adaptive run length.

A run with one tangent vector gives exponent and section points, once per T. Its length is doubled until the rule (`regime`)
has a label and the error of the exponent is small enough, or to the longest length. A point whose tangent vector shrinks for
sure approaches a periodic orbit, for which it needs no tangent vector, and stops. A point is judged by its whole record.
Its numbers depend on its own run alone.
"""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.indicators.section_coordinates import OBSERVABLES, rotation_numbers_of
from whirlmap.analysis.indicators.section_indicators import LEAST, evidence_of
from whirlmap.analysis.labels.forgetting import LEFT, forget
from whirlmap.analysis.labels.locked import locked_multiple
from whirlmap.analysis.labels.near_return import near_return
from whirlmap.analysis.labels.nonperiodic_results import NonperiodicResults
from whirlmap.analysis.labels.regime import TURNED, UNKNOWN, Rule, decide
from whirlmap.analysis.labels.section_record import SectionRecord
from whirlmap.analysis.labels.votes import SURE, Evidence, contracts
from whirlmap.analysis.motion.divergence import shrinks_areas
from whirlmap.analysis.trends.trend_labels import Trends
from whirlmap.analysis.variational.exponents_with_section import run_with_section
from whirlmap.analysis.variational.lyapunov import mean_and_error
from whirlmap.analysis.variational.tangent_accuracy import tuned
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.scales import scales_between
from whirlmap.progress import tell
from whirlmap.results.regime import Regime

Array = NDArray[np.float64]
Points = NDArray[np.intp]

#: Error of the largest exponent, relative and in units of 2 pi/T, at which a labelled point stops.
ENOUGH = (0.05, 0.005)
#: Points that run together, and numbers of their sections that are held until they are judged, about.
TOGETHER, HELD = 512, 2**23
#: T that the longest of those records has, in the mean.
USUAL = 1024
#: Points whose trends are computed together: the working memory is several times their section points.
TRENDS = 64
#: Section points, once per common period, that are kept of a point that contracts.
KEPT = 4096
#: Last section points from which n of a locked motion is sought at most: with more of them it takes as long as all else.
SOUGHT = 2048
#: T between the section points that show trends where the forcing has no common period.
SPARSE = 16


def judge_nonperiodic_points(
    tangent: Ensemble,
    most: int,
    cyclic: Mapping[int, float] | None,
    progress: Callable[[int], None] | None = None,
    *,
    ranges: Array,
    tolerance: float,
    contraction_ends: bool = False,
) -> NonperiodicResults:
    """Measure and judge points that have settled but do not return.

    Parameters
    ----------
    tangent : Ensemble
        At the settled states, at phase zero, with one tangent vector. Its ``status`` and ``turns`` are taken forward in
        place.
    most : int
        T (unforced: typical times) run at most; one stretch where that is less than `LEAST`.
    ranges : array, shape (state, point)
        Of the states over the motion.
    tolerance : float
        Of a return.
    contraction_ends : bool
        Whether points that can return stop, undecided, once their tangent vectors have shrunk for sure, or their section
        shrinks steadily or to a return.
    """
    n, states = tangent.points, tangent.model.dimension
    found = NonperiodicResults.none(tangent.x)
    together = int(np.clip(HELD // (USUAL * (OBSERVABLES + states // tangent.strobe)), 16, TOGETHER))
    for first in range(0, n, together):
        members = np.arange(first, min(first + together, n))
        judge = _Judge(tangent, members, most, dict(cyclic or {}), ranges[:, members], tolerance, found, progress)
        judge.run(contraction_ends and tangent.returns)
    return found


class _Judge:
    """Some of the points, while they are judged."""

    def __init__(
        self, tangent: Ensemble, members: Points, most: int, cyclic: dict[int, float], ranges: Array,
        tolerance: float, found: NonperiodicResults, progress: Callable[[int], None] | None,
    ) -> None:  # fmt: skip
        self.tolerance = tolerance
        self.tangent, self.members, self.cyclic, self.found, self.progress = tangent, members, cyclic, found, progress
        cycle = tangent.strobe
        self.first = -(-min(LEAST, most) // cycle) * cycle  # whole common periods, so that all stops are at phase zero
        self.most = max(most // cycle * cycle, self.first)
        self.align = -(-max(self.first // 10, 5) // cycle) * cycle
        self.rates = np.full((self.most, members.size), np.nan)
        self.no_torus = shrinks_areas(tangent.subset(members)) if tangent.returns else np.zeros(members.size, dtype=bool)
        self.every = cycle if tangent.returns else SPARSE
        self.record = SectionRecord(members.size, tangent.model.dimension, self.every, cyclic, ranges)

    def run(self, contraction_ends: bool) -> None:
        """Run the points until all have labels or have reached the longest length."""
        carried, found = tuned(self.tangent.subset(self.members)), self.found
        left, run, done, stretch = np.arange(self.members.size), carried.ensemble, 0, self.first
        while left.size:
            local, section = run_with_section(run, stretch, align=0 if done else self.align, progress=self.progress)
            self.rates[done : done + stretch, left] = local[:, 0]
            done += stretch
            self.record.keep(left, section)
            at = self.members[left]
            self.tangent.status[at], self.tangent.end_time[at], self.tangent.turns[at] = run.status, run.end_time, run.turns
            found.x[:, at] = run.x
            self._trends(left, done)
            found.exponent[at], error = mean_and_error(self.rates[:done, left], run.strobe)
            found.error[at] = np.fmax(error, carried.error[0, left])
            found.periods[at] = done
            late = (self.rates[done // 2 : done, left].sum(axis=0)) * run.period
            found.shrinks[at] = contracts(found.exponent[at], found.error[at], done * run.period, late)
            target = np.maximum(ENOUGH[0] * np.abs(found.exponent[at]), ENOUGH[1] * 2 * np.pi / run.period)
            sure = found.error[at] <= target
            # One with a label is judged anew when it stops: a label that an early stretch gave does not stay by itself.
            due = (found.regime[at] == Regime.undecided) | sure | (done >= self.most)
            self._vote(run, np.flatnonzero(run.running & due), left, done, late, final=done >= self.most)
            # A torus does not change its size steadily: a section that does is a transient, or beats more slowly than this.
            torus, forbidden = found.regime[at] == Regime.quasi_periodic, self.no_torus[left]
            changes = at[torus & (np.isfinite(found.growth[at]) | forbidden)]
            found.regime[changes], found.confidence[changes], found.rule[changes] = Regime.undecided, 0.0, Rule.regular
            found.closes[at[torus & forbidden]] = True
            open_ = found.regime[at] == Regime.undecided
            if contraction_ends:
                open_ &= ~(found.shrinks[at] | found.closes[at] | (found.growth[at] < 0))
            stay = run.running & (open_ | (~sure & (found.regime[at] != Regime.locked)))
            stretch = min(done, self.most - done)
            if not stretch:
                stay[:] = False
            if not run.returns:
                fades = np.flatnonzero(stay & open_ & found.shrinks[at])
                self._forget(run, fades, left, done)
                stay[fades] = False
            if run.returns and run.model.forced:
                self._near_returns(run, left[~stay & run.running])
            left, run = left[stay], run.subset(np.flatnonzero(stay))
            tell(self.progress, "nonperiodic_points", left.size + self.tangent.points - 1 - int(self.members[-1]), done)

    def _forget(self, run: Ensemble, lanes: Points, left: Points, done: int) -> None:
        """Run points whose exponents are known to be negative until their transients have decayed, and judge them."""
        at, found, tangent = self.members[left[lanes]], self.found, self.tangent
        plain, ran = forget(
            run.subset(lanes), found.exponent[at], found.error[at], done=done, most=self.most, progress=self.progress,
            keep=lambda which, section: self.record.keep(left[lanes[which]], section),
        )  # fmt: skip
        found.x[:, at] = plain.x
        tangent.status[at], tangent.end_time[at], tangent.turns[at] = plain.status, plain.end_time, plain.turns
        late = np.zeros(run.points)
        late[lanes] = found.exponent[at] * ran * run.period[lanes] / 2
        self._vote(run, lanes[plain.running], left, done, late, final=True)

    def _trends(self, left: Points, done: int) -> None:
        """Trends of the sections so far, once per common period."""
        tangent, at = self.tangent, self.members[left]
        sections = [self.record.strobed[point] for point in left]
        count = np.array([len(s) for s in sections], dtype=np.int64)
        for rows in np.unique(count[count > 0]):  # forced: all that still run have the same
            same = np.flatnonzero(count == rows)
            for these in np.array_split(same, -(-same.size // TRENDS)):
                points = at[these]
                period, end = tangent.period[points], tangent.end_time[points]
                time = self.every * period
                if not tangent.model.forced:  # crossings come as often as they come: the rate is one on the mean
                    time = np.where(np.isfinite(end), end - self.align * period, done * period) / rows
                unknown = np.full(points.size, np.nan)
                section = np.stack([sections[k] for k in these], axis=2)
                seen = Trends.of(tangent.model, tangent.period[points], section, time, unknown, unknown, self.cyclic)
                for name in ("growth", "drift", "centre", "reach"):
                    getattr(self.found, name)[..., points] = getattr(seen, name)

    def _vote(self, run: Ensemble, lanes: Points, left: Points, done: int, late: Array, *, final: bool) -> None:
        """Judge points, each from as many section points as it has itself."""
        found, common = self.found, run.common_multiple
        count = np.array([self.record.watched[left[k]].shape[1] for k in lanes], dtype=np.int64)
        for rows in np.unique(count[count >= LEAST]):  # forced: all have the same
            these = lanes[count == rows]
            at = self.members[left[these]]
            duration = (int(rows) if run.model.forced else done) * run.period[these]
            value, error = found.exponent[at], found.error[at]
            watched = np.stack([self.record.watched[left[k]] for k in these])
            seen = evidence_of(watched, common=common, grows=value > SURE * error, final=final)
            winding = [UNKNOWN] * these.size
            if run.returns and rows // self.every >= TURNED:
                strobed = np.stack([self.record.strobed[left[k]] for k in these], axis=2)
                winding = rotation_numbers_of(strobed, self.cyclic, self.record.ranges[:, left[these]])
            judged = decide(
                Evidence(
                    run.status[these], np.zeros(these.size, dtype=np.int64), value, error, duration, late[these], seen,
                    tuple(winding), final, run.returns,
                )
            )  # fmt: skip
            for name in ("regime", "rule", "confidence", "winding"):
                getattr(found, name)[at] = judged[name]
            found.closes[at] = seen.closes
            locked = np.flatnonzero(judged["regime"] == Regime.locked)
            if locked.size:
                self._locked(run, at[locked], watched[locked], value[locked] * duration[locked], final=final)

    def _locked(self, run: Ensemble, at: Points, watched: Array, grown: Array, *, final: bool) -> None:
        """Find n of locked points, from the end of their transients on; that may need more of their run."""
        found, rows = self.found, watched.shape[2]
        forgotten = rows * np.log(LEFT) / np.minimum(grown, np.log(LEFT))
        # Few begins, for what begins together is fitted together.
        begin = np.maximum(np.ceil(forgotten / LEAST) * LEAST, rows - SOUGHT).astype(np.int64)
        orders = tuple(abs(order) for order in run.orders if order)
        n = np.zeros(at.size, dtype=np.int64)
        for first in np.unique(begin[begin <= rows - LEAST]):
            those = np.flatnonzero(begin == first)
            points = np.moveaxis(watched[those][:, :, first:], 0, 2).swapaxes(0, 1)
            n[those] = locked_multiple(points, orders, scale=np.ptp(points, axis=0))[0]
        found.multiple[at] = n
        open_ = at[(n == 0) & (rows - begin < SOUGHT) & (not final)]
        found.regime[open_], found.confidence[open_], found.rule[open_] = Regime.undecided, 0.0, Rule.contracts

    def _near_returns(self, run: Ensemble, stopped: Points) -> None:
        """Return that the section of each point comes nearest to, and its last section points once per common period."""
        for point in stopped:
            at, path = self.members[point], self.record.strobed[int(point)]
            low, high = path.min(axis=0)[:, None], path.max(axis=0)[:, None]
            size = scales_between(run.model, self.tangent.period[[at]], low, high)[:, 0]
            near = near_return(path, size, self.cyclic, self.tolerance)
            self.found.nearest[at], self.found.nearness[at], self.found.returned[at] = near
            self.found.paths[int(at)] = path[-KEPT:]
