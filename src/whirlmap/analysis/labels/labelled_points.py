"""Steps by which operating points get their labels: steady-state search, non-periodic run, Newton's method, verification.

1. The steady-state search: points that return are recorded as periodic (`returns`). It ends after `BRIEF` T.
2. Points that have not returned run with a tangent vector until the rule gives a label (`nonperiodic_points`).
3. A point with a negative exponent approaches a periodic orbit. Newton's method finds it (`newton`); where it does not, the
   point runs on for the time in which its exponent says that the transient decays, and is judged once more. Where it still
   has no label it is called not settled.
4. Newton's method is tried on a torus whose section nearly returns, too: locking of high order looks like that. Chaos runs
   on for a while: transient chaos returns at last, or ends.
5. Motion that grows, drifts or dies away steadily is labelled as such (`trend_labels`).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.labels.forgetting import FORGOTTEN
from whirlmap.analysis.labels.measured import RETURNS, Measured
from whirlmap.analysis.labels.nonperiodic_points import judge_nonperiodic_points
from whirlmap.analysis.labels.nonperiodic_results import NonperiodicResults
from whirlmap.analysis.labels.regime import Rule
from whirlmap.analysis.motion.ensembles import cyclic_states, make_ensemble
from whirlmap.analysis.motion.record_length import MANY, record_periods
from whirlmap.analysis.periodic_orbits.newton import close_orbits
from whirlmap.analysis.steady.returns import RECORDED, Returns, record, section_and_extremes, settle_and_record
from whirlmap.analysis.steady.settled import Settled
from whirlmap.analysis.steady.settling import Settling
from whirlmap.analysis.steady.settling_accurately import settle_accurately
from whirlmap.analysis.trends.trend_labels import Trends, label_trends
from whirlmap.analysis.variational.monodromy import largest_multipliers
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.scales import scales_between
from whirlmap.integrate.system import System
from whirlmap.options.computed import Integration
from whirlmap.options.execution import Execution
from whirlmap.progress import tell
from whirlmap.results.regime import Regime

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Points = NDArray[np.intp]
Progress = Callable[[int], None]

#: T after which a point that has not returned gets a tangent vector, but so many common periods at least.
BRIEF, FEWEST = 512, 100
#: Stands for the common period of a forcing that has no reasonable one.
ENDLESS = np.iinfo(np.int64).max
#: T for which chaos runs on without a tangent vector, but `FEWEST` common periods at least.
FOLLOWED = 4096
#: Contracting points are integrated until perturbations have decayed by this factor, but at most so many times the longest
#: run of an exponent.
PATIENCE = 2
#: Scaled distance of a near return below which Newton's method is tried on a torus; longest such orbit, in T times tangent
#: vectors.
NEARLY, WORTH = 1e-4, 6_000
#: Least relative error of a multiplier.
ROUNDING = 1e-12


class LabelledPoints:
    """Points of an ensemble that are being labelled, all at phase zero, with the same orders of harmonics.

    Parameters
    ----------
    system : System
    values : mapping of str to array
        Parameters that differ between the points.
    ensemble : Ensemble
        Taken forward in place.
    settling : Settling
    longest : int
        T over which exponents are measured at most; 0: not.
    kept : sequence of str
        States whose section is kept.
    """

    def __init__(
        self, system: System, values: Mapping[str, Array], ensemble: Ensemble, settling: Settling, *, longest: int,
        kept: Sequence[str] = (), progress: Progress | None = None,
    ) -> None:  # fmt: skip
        self.system, self.values, self.ensemble, self.settling = system, values, ensemble, settling
        self.longest, self.progress, self.cyclic = longest, progress, cyclic_states(system)
        self.found = NonperiodicResults.none(ensemble.x)
        self.kept = [system.states.index(name) for name in kept]
        self.returns: Returns
        self.ends: Array  # states at the ends of the records, and the T there since phase zero
        self.end_turns: Integers
        # Which points are away from their record, for their judgement ran on, and the T that they have run by then.
        self.away, self.turns = np.zeros(ensemble.points, dtype=bool), ensemble.turns.copy()

    def measure(self, start_found: NDArray[np.bool_]) -> Measured:
        """Run the steps of the module's list."""
        e, found = self.ensemble, self.found
        tell(self.progress, "begin", e.points, e.strobe * (self.settling.transient + self.settling.first_window))
        self.returns = self._settle(e, self._brief())
        self.ends, self.end_turns = e.x.copy(), e.turns.copy()
        known = self.returns.regime != Regime.undecided
        found.regime[:], found.confidence[:] = self.returns.regime, np.where(known, 1.0, 0.0)
        found.rule[:] = np.where(self.returns.multiple > 0, Rule.returns, np.where(known, Rule.trend, Rule.none))
        found.rule[~e.running] = Rule.end
        nonperiodic = np.flatnonzero(~known & e.running)
        tell(self.progress, "settled", e.points, nonperiodic.size if self.longest else 0, self.longest)
        if self.longest and nonperiodic.size:
            self._judge(nonperiodic, contraction_ends=True)
            if e.model.forced and e.returns:
                self._close(nonperiodic)
            shrinks = self._open(nonperiodic, found.shrinks)
            if shrinks.size and e.returns:
                self._settle_on(shrinks)
            early = found.shrinks | found.closes | (found.growth < 0)
            again = self._open(nonperiodic, early & (found.periods < self.longest))
            if again.size:  # they stopped early for an orbit that is not there
                self._judge(again, contraction_ends=False)
                if e.model.forced and e.returns:
                    self._close(again)
            found.regime[self._open(nonperiodic, found.shrinks)] = Regime.not_settled
            self._follow(nonperiodic[(found.regime[nonperiodic] == Regime.chaotic) & e.running[nonperiodic]])
            if e.model.forced:
                self._record_where_left(nonperiodic[self.away[nonperiodic] & e.running[nonperiodic]])
            tell(self.progress, "closed", nonperiodic.size)
        thins = np.isfinite(self.returns.thinning)
        found.winding[:] = np.where(thins, self.returns.turning, found.winding)
        period = np.where(found.regime == Regime.locked, found.multiple, self.returns.period)
        return Measured(
            replace(self.returns, regime=found.regime, period=period), e.status, e.end_time, found.exponent, found.error,
            found.periods, found.confidence, found.winding, found.rule, start_found, e.point_steps, e.step_error,
            e.step_verdict, e.grazings.astype(np.int64), np.full(e.points, float(e.common_multiple)),
            np.where(e.running, self.ends, np.nan), self.end_turns % (e.strobe if e.returns else ENDLESS),
        )  # fmt: skip

    def _brief(self) -> Integers | None:
        """Common periods after which points get a tangent vector; None where exponents are not asked for."""
        if not (self.longest and self.ensemble.model.forced):
            return None
        brief = max(BRIEF // self.ensemble.strobe, FEWEST)
        return np.full(self.ensemble.points, min(self.settling.longest, brief))

    def _open(self, points: Points, which: NDArray[np.bool_]) -> Points:
        """Those of some points that run, have no label yet, and fulfil a condition."""
        return points[self._left(points) & which[points] & self.ensemble.running[points]]

    def _left(self, points: Points) -> NDArray[np.bool_]:
        return np.asarray(self.found.regime[points] == Regime.undecided)

    def _settle(self, ensemble: Ensemble, longest: Integers | None) -> Returns:
        return settle_and_record(
            ensemble, self.settling, longest=longest, kept=self.kept, cyclic=self.cyclic, progress=self.progress
        )

    def _judge(self, points: Points, *, contraction_ends: bool) -> None:
        """Judge points by a run with a tangent vector, and leave them where it ends."""
        e, found = self.ensemble, self.found
        tangent, _ = make_ensemble(
            self.system, {name: np.asarray(v, dtype=float)[points] for name, v in self.values.items()},
            starts=e.x[:, points], integration=Integration(e.method.name, e.point_steps[points]), tangents=1,
            turn=e.period[points], ranges=self._ranges(points), execution=Execution(e.workers),
        )  # fmt: skip
        tangent.turns[:] = e.turns[points]
        judged = judge_nonperiodic_points(
            tangent, self.longest, self.cyclic, self.progress, ranges=self._ranges(points),
            tolerance=self.settling.tolerance, contraction_ends=contraction_ends,
        )
        ends = ~tangent.running
        judged.regime[ends], judged.confidence[ends], judged.rule[ends] = Regime.undecided, 0.0, Rule.none
        judged.shrinks[ends] = False
        found.take(judged, points)
        self._label_trends(points)
        on = np.flatnonzero(~ends)
        self.away[points[on]], self.turns[points[on]] = True, tangent.turns[on]
        if e.returns:
            e.put(points[on], judged.x[:, on])
            e.turns[points[on]] += judged.periods[on]
        if ends.any():  # such an end is believed once it is confirmed with finer steps, without a tangent vector
            periods = judged.periods[ends] + tangent.strobe
            self._settle_longer(points[ends], -(-2 * periods // tangent.strobe))

    def _ranges(self, points: Points) -> Array:
        """How far each state moves over the record, shape (state, points)."""
        extremes = self.returns.extremes
        return np.asarray((extremes["maximum"] - extremes["minimum"])[: self.ensemble.model.dimension, points])

    def _label_trends(self, points: Points) -> None:
        """Label non-periodic points that die away, grow or drift for ever."""
        e, found, returns = self.ensemble, self.found, self.returns
        parts = (found.growth, found.drift, found.centre, found.reach, found.exponent, found.error)
        endless = label_trends(e, points, Trends(*(a[..., points] for a in parts)), self._ranges(points))
        known = endless.regime != Regime.undecided
        at = points[known]
        growth, drift = returns.growth.copy(), returns.drift.copy()
        growth[at], drift[:, at] = endless.growth[known], endless.drift[:, known]
        found.regime[at], found.confidence[at], found.rule[at] = endless.regime[known], 1.0, Rule.trend
        self.returns = replace(returns, growth=growth, drift=drift)

    def _close(self, points: Points) -> None:
        """Find the orbits of points that contract, or all but return, and record them."""
        e, found = self.ensemble, self.found
        vectors = e.strobe * e.model.dimension
        for tried in ("nearest", "first"):
            contracts = self._left(points) & (found.shrinks | found.closes | (found.growth < 0))[points]
            nearly = (found.regime[points] == Regime.quasi_periodic) & (found.nearness[points] < NEARLY)
            multiple = found.nearest[points] if tried == "nearest" else np.ones(points.size, dtype=np.int64)
            which = contracts | nearly if tried == "nearest" else contracts & (found.nearest[points] > 1)
            which &= e.running[points] & (multiple > 0) & (multiple * vectors <= WORTH)
            here = points[which]
            if not here.size:
                continue
            paths = [found.paths[int(p)] for p in here]
            orbits = close_orbits(e, here, multiple[which], paths, self.cyclic, self.settling.tolerance)
            good = np.flatnonzero(orbits.multiple)
            if not good.size:
                continue
            self._record(
                here[good], orbits.x[:, good], orbits.multiple[good], orbits.distance[good], orbits.scale[:, good],
                Rule.closed_orbit,
            )  # fmt: skip

        long = found.nearest * vectors > WORTH
        back = self._open(points, found.returned & long)
        if back.size:
            self._record(back, e.x[:, back], found.nearest[back], found.nearness[back], None, Rule.returns)

    def _record(
        self, points: Points, x: Array, multiple: Integers, distance: Array, scale: Array | None, rule: Rule
    ) -> None:
        """Record points on orbits that return after so many common periods."""
        part = self.ensemble.subset(points)
        part.put(np.arange(points.size), x)
        settled = Settled.none(part)
        settled.multiple[:], settled.distance[:] = multiple, distance
        if scale is None:
            low, high = (self.returns.extremes[name][:, points] for name in ("minimum", "maximum"))
            scale = scales_between(part.model, part.period, low, high)
        settled.scale[:] = scale
        self._take(part, points, record(part, settled, self.settling, kept=self.kept, cyclic=self.cyclic))
        self.found.rule[points[~self._left(points)]] = rule

    def _record_where_left(self, points: Points) -> None:
        """Record points that do not return anew, from where their judgement left them: less of their starts is left there.

        Where the forcing has no common period the extremes are those of a longer record. Its last part is the section.
        """
        e = self.ensemble
        phase = self.turns[points] % (e.strobe if e.returns else ENDLESS)
        periods = record_periods(e.orders, self.settling.keep, MANY)
        section, extremes = self.returns.section.copy(), {k: v.copy() for k, v in self.returns.extremes.items()}
        for turns in np.unique(phase):
            for at in np.split(points[phase == turns], range(RECORDED, int((phase == turns).sum()), RECORDED)):
                part = e.subset(at)
                part.put(np.arange(at.size), self.found.x[:, at])
                part.turns[:] = turns
                none = np.zeros(at.size, dtype=np.int64)
                saved, found = section_and_extremes(part, np.arange(at.size), none, periods, self.progress)
                on = np.flatnonzero(part.running)
                section[:, :, at[on]] = saved[-len(section) :, self.kept][:, :, on]
                for name, values in found.items():
                    extremes[name][:, at[on]] = values[:, on]
                self.ends[:, at[on]], self.end_turns[at[on]] = part.x[:, on], part.turns[on]
        self.returns = replace(self.returns, section=section, extremes=extremes)

    def _settle_on(self, points: Points) -> None:
        """Continue the search for points whose motion contracts but has not returned, for the time that this takes at most.

        The time of each is a power of two of common periods: points of like exponents are checked together.
        """
        e = self.ensemble
        needed = np.log(FORGOTTEN) / (self.found.exponent[points] * (e.strobe * e.period)[points])
        most = max(PATIENCE * self.longest // e.strobe, self.settling.longest)
        extra = np.minimum(2 ** np.ceil(np.log2(np.maximum(needed, 1))), most).astype(np.int64)
        # Steps chosen anew move the orbit by their error, from which it settles in a part of this time.
        self._settle_longer(points, extra + extra // 4)

    def _follow(self, points: Points) -> None:
        """Check whether chaos persists: transient chaos returns at last, or ends."""
        if not points.size:
            return
        part, start = self.ensemble.subset(points), self.ensemble.x[:, points]
        longest = np.full(points.size, max(FOLLOWED // part.strobe, FEWEST))
        settled = settle_accurately(part, self.settling, longest, self.cyclic, self.progress)
        over = np.flatnonzero((settled.multiple > 0) | ~part.running | (not part.model.forced))  # unforced motion may rest
        if over.size:
            ended = part.subset(over)
            found = record(
                ended, settled.of(over), self.settling, start=start[:, over], kept=self.kept, cyclic=self.cyclic
            )
            self._take(ended, points[over], found, np.flatnonzero((found.regime != Regime.undecided) | ~ended.running))

    def _settle_longer(self, points: Points, transient: Integers) -> None:
        """Continue the steady-state search of points for so many common periods more."""
        part, settling = self.ensemble.subset(points), self.settling
        self._take(part, points, self._settle(part, transient + settling.longest - settling.transient))

    def _take(self, part: Ensemble, points: Points, again: Returns, which: Points | slice = slice(None)) -> None:
        """Take over those of some points that have settled after all, all where absent; labels stay where there is none."""
        found, points = self.found, points[which]
        part = part if isinstance(which, slice) else part.subset(which)
        self.ensemble.absorb(part, points)
        self.ends[:, points], self.away[points] = part.x, False
        values: dict[str, Any] = {name: getattr(self.returns, name).copy() for name in RETURNS}
        extremes = {k: v.copy() for k, v in self.returns.extremes.items()}
        for name, one in values.items():
            one[..., points] = getattr(again, name)[..., which] + (one[points] if name == "waited" else 0)
        for name, one in extremes.items():
            one[..., points] = again.extremes[name][..., which]
        self.returns = replace(self.returns, **values, extremes=extremes)
        regime, multiple = again.regime[which], again.multiple[which]
        known = regime != Regime.undecided
        at = points[known]
        found.regime[at], found.confidence[at] = regime[known], 1.0
        found.rule[at] = np.where(multiple[known] > 0, Rule.returns, Rule.trend)
        back = np.flatnonzero(known & (multiple > 0) & (found.periods[points] > 0))
        if back.size and part.model.forced and part.returns:
            self._exponents_of_orbits(part, back, points[back], multiple[back])

    def _exponents_of_orbits(self, part: Ensemble, which: Points, points: Points, multiple: Integers) -> None:
        """Take exponents of orbits from their multipliers: a run that led to one holds its transient, or what it left."""
        largest = largest_multipliers(part, which, multiple)
        time, found = multiple * part.strobe * part.period[which], self.found
        known = np.isfinite(largest) & (largest > 0)
        at = points[known]
        found.exponent[at] = np.log(largest[known]) / time[known]
        found.error[at] = np.fmax(part.step_error[which], ROUNDING)[known] / time[known]
