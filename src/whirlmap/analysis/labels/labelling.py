"""Operating points measured and labelled: what diagrams, maps, attractors, speeds and `diagnose` all rest on.

1. Points settle, and those that return are recorded (`returns`). One that has not returned after `BRIEF` T is handed over.
2. Points that do not return run with a tangent vector until the rule knows what they are (`nonperiodic_points`).
3. What contracts is on its way to an orbit. Newton's method finds it (`closing`); where it does not, the point settles on
   for the time that its exponent says, and is judged once more. What still is not known then is called not settled.
4. A torus whose section all but returns is tried as an orbit, too: high locking looks like that. Chaos is followed on for a
   while: one that is a transient returns at last, or ends.
5. Motion that grows, drifts or dies away steadily is labelled as such (`unbounded`).

The numbers of a point depend on its own parameters and start alone: not on the points computed with it, their number or
order, nor on the number of threads.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from whirlmap.analysis.labels.closing import close_orbits
from whirlmap.analysis.labels.measured import RETURNS, Measured, joined
from whirlmap.analysis.labels.nonperiodic_points import OpenPoints, judge_open_points
from whirlmap.analysis.labels.regime import FORGOTTEN, Rule
from whirlmap.analysis.lyapunov import BLOCKS
from whirlmap.analysis.points import cyclic_states, make_ensemble, parameter_values
from whirlmap.analysis.returns import Returns, record, settle_and_record
from whirlmap.analysis.settling import Settled, Settling
from whirlmap.analysis.settling_accurately import settle_accurately
from whirlmap.analysis.unbounded import Trends, label_trends
from whirlmap.errors import RangeError
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.orders import order_groups
from whirlmap.integrate.scales import scales
from whirlmap.integrate.system import System
from whirlmap.results.regime import Regime

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Points = NDArray[np.intp]
Progress = Callable[[int], None]

#: T after which a point that has not returned is handed over to a tangent vector, but so many common periods at least.
BRIEF, FEWEST = 512, 100
#: T that chaos is followed on without a tangent vector, but `FEWEST` common periods at least.
FOLLOWED = 4096
#: T, and common periods, over which the exponent of a point that does not return is measured at most, the longer of both.
LONGEST, LONGEST_COMMON = 16384, 1024
#: A motion that contracts is given the time to forget its start until it is given up, but no more than so many times the
#: longest run of an exponent.
PATIENCE = 2
#: Scaled distance of a near return that makes a torus worth a trial as an orbit; longest such orbit, in T times tangent
#: vectors.
NEARLY, WORTH = 1e-4, 6_000


@dataclass(frozen=True)
class Labelling:
    """How points are measured: the options of `label_points`, and the states whose section is kept."""

    settling: Settling
    lyapunov: int | None = None
    steps: int | None = None
    accuracy: float | None = None
    method: str | None = None
    workers: int | None = None
    kept: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Refuse a length of the exponent's run that gives no error."""
        if self.lyapunov and not BLOCKS <= self.lyapunov <= 10_000_000:
            raise RangeError(f"lyapunov must be 0, or from {BLOCKS} to 10000000 T, not {self.lyapunov}")

    def longest(self, strobe: int) -> int:
        """T over which exponents are measured at most, with this many T between section points that show returns."""
        return max(LONGEST, LONGEST_COMMON * strobe) if self.lyapunov is None else self.lyapunov

    def measure(
        self,
        system: System,
        values: Mapping[str, ArrayLike],
        *,
        starts: Array | None = None,
        progress: Progress | None = None,
    ) -> tuple[Measured, Ensemble]:
        """Measure points, each from its own start.

        Returns
        -------
        measured : Measured
        ensemble : Ensemble
            Stands where the points were left. Where the common periods of points differ, those of one length are measured
            together, and this is the ensemble of the longest.
        """
        columns = {name: np.atleast_1d(np.asarray(v, dtype=float)) for name, v in values.items()}
        groups = order_groups(system, parameter_values(system, columns), columns)
        parts = []
        for group in groups:
            at = group.members
            some = {name: column[at] for name, column in columns.items()}
            begin = None if starts is None else starts[:, at]
            ensemble, found = make_ensemble(
                system, some, starts=begin, steps=self.steps, accuracy=self.accuracy, method=self.method,
                workers=self.workers,
            )  # fmt: skip
            parts.append(self.measure_ensemble(system, some, ensemble, found, progress))
        return (parts[0] if len(parts) == 1 else joined(parts, [group.members for group in groups])), ensemble

    def measure_ensemble(
        self,
        system: System,
        values: Mapping[str, Array],
        ensemble: Ensemble,
        start_found: NDArray[np.bool_],
        progress: Progress | None = None,
    ) -> Measured:
        """Measure the points of an ensemble, in place: all at phase zero, with the same orders of harmonics."""
        return _Points(self, system, values, ensemble, progress).measure(start_found)


class _Points:
    """Points on the way to their labels."""

    def __init__(
        self, how: Labelling, system: System, values: Mapping[str, Array], ensemble: Ensemble, progress: Progress | None
    ) -> None:
        self.how, self.system, self.values, self.ensemble, self.progress = how, system, values, ensemble, progress
        self.cyclic = cyclic_states(system)
        self.found = OpenPoints.none(ensemble.x)
        names = list(system.states)
        self.kept = [names.index(name) for name in how.kept]
        self.longest = how.longest(ensemble.strobe)
        self.returns: Returns

    def measure(self, start_found: NDArray[np.bool_]) -> Measured:
        """Settle, judge, close, settle on."""
        e, found = self.ensemble, self.found
        self.returns = self._settle(e, self._brief())
        known = self.returns.regime != Regime.undecided
        found.regime[:], found.confidence[:] = self.returns.regime, np.where(known, 1.0, 0.0)
        found.rule[:] = np.where(self.returns.multiple > 0, Rule.returns, np.where(known, Rule.trend, Rule.none))
        found.rule[~e.running] = Rule.end
        open_points = np.flatnonzero(~known & e.running)
        if self.longest and open_points.size:
            self._judge(open_points, contraction_ends=True)
            if e.model.forced and e.returns:
                self._close(open_points)
            shrinks = self._open(open_points, found.shrinks)
            if shrinks.size and e.returns:
                self._settle_on(shrinks)
            again = self._open(open_points, (found.shrinks | found.closes) & (found.periods < self.longest))
            if again.size:  # they stopped early for an orbit that is not there
                self._judge(again, contraction_ends=False)
                if e.model.forced and e.returns:
                    self._close(again)
            found.regime[self._open(open_points, found.shrinks)] = Regime.not_settled
            self._follow(open_points[(found.regime[open_points] == Regime.chaotic) & e.running[open_points]])
        thins = np.isfinite(self.returns.thinning)
        found.winding[:] = np.where(thins, self.returns.turning, found.winding)
        period = np.where(found.regime == Regime.locked, found.multiple, self.returns.period)
        return Measured(
            replace(self.returns, regime=found.regime, period=period), e.status, e.end_time, found.exponent, found.error,
            found.periods, found.confidence, found.winding, found.rule, start_found, e.point_steps, e.step_error,
            e.step_verdict, e.grazings.astype(np.int64), np.full(e.points, float(e.common_multiple)),
            np.where(e.running, e.x, np.nan),
        )  # fmt: skip

    def _brief(self) -> Integers | None:
        """Common periods after which points are handed over; None where nothing takes them over."""
        if not (self.longest and self.ensemble.model.forced):
            return None
        brief = max(BRIEF // self.ensemble.strobe, FEWEST)
        return np.full(self.ensemble.points, min(self.how.settling.longest, brief))

    def _open(self, points: Points, which: NDArray[np.bool_]) -> Points:
        """Those of some points that run and have no label yet, and for which something holds."""
        return points[self._left(points) & which[points] & self.ensemble.running[points]]

    def _left(self, points: Points) -> NDArray[np.bool_]:
        return np.asarray(self.found.regime[points] == Regime.undecided)

    def _settle(self, ensemble: Ensemble, longest: Integers | None) -> Returns:
        return settle_and_record(
            ensemble, self.how.settling, longest=longest, kept=self.kept, cyclic=self.cyclic, progress=self.progress
        )

    def _judge(self, points: Points, *, contraction_ends: bool) -> None:
        """Judge points by a run with a tangent vector, and leave them where it ends."""
        e, found = self.ensemble, self.found
        tangent, _ = make_ensemble(
            self.system, {name: np.asarray(v, dtype=float)[points] for name, v in self.values.items()},
            starts=e.x[:, points], steps=e.point_steps[points], method=e.method.name, tangents=1, workers=e.workers,
            turn=e.period[points],
        )  # fmt: skip
        tangent.turns[:] = e.turns[points]
        judged = judge_open_points(
            tangent, self.longest, self.cyclic, self.progress, ranges=self._ranges(points),
            tolerance=self.how.settling.tolerance, contraction_ends=contraction_ends,
        )
        ends = ~tangent.running
        judged.regime[ends], judged.confidence[ends], judged.rule[ends] = Regime.undecided, 0.0, Rule.none
        judged.shrinks[ends] = False
        found.take(judged, points)
        self._label_trends(points)
        if e.returns:
            on = np.flatnonzero(~ends)
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
        """Label open points that die away, grow or drift for ever."""
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
            orbits = close_orbits(e, here, multiple[which], paths, self.cyclic, self.how.settling.tolerance)
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
            low, high = (self.returns.extremes[name][: len(x), points] for name in ("minimum", "maximum"))
            scale = scales(part.model, part.period, high - low, np.maximum(np.abs(low), np.abs(high)))
        settled.scale[:] = scale
        self._take(part, points, record(part, settled, self.how.settling, kept=self.kept, cyclic=self.cyclic))
        self.found.rule[points[~self._left(points)]] = rule

    def _settle_on(self, points: Points) -> None:
        """Settle points on whose motion contracts but has not returned, for the time that this takes at most.

        The time of each is a power of two of common periods: points of like exponents are looked at together.
        """
        e, how = self.ensemble, self.how
        needed = np.log(FORGOTTEN) / (self.found.exponent[points] * (e.strobe * e.period)[points])
        most = max(PATIENCE * self.longest // e.strobe, how.settling.longest)
        extra = np.minimum(2 ** np.ceil(np.log2(np.maximum(needed, 1))), most).astype(np.int64)
        # Steps chosen anew move the orbit by their error, from which it settles in a part of this time.
        self._settle_longer(points, extra + extra // 4)

    def _follow(self, points: Points) -> None:
        """See whether chaos goes on: one that is a transient returns at last, or ends."""
        if not points.size:
            return
        part, start = self.ensemble.subset(points), self.ensemble.x[:, points]
        longest = np.full(points.size, max(FOLLOWED // part.strobe, FEWEST))
        settled = settle_accurately(part, self.how.settling, longest, self.cyclic, self.progress)
        over = np.flatnonzero((settled.multiple > 0) | ~part.running | (not part.model.forced))  # or rests
        if over.size:
            ended = part.subset(over)
            found = record(
                ended, settled.of(over), self.how.settling, start=start[:, over], kept=self.kept, cyclic=self.cyclic
            )
            self._take(ended, points[over], found)

    def _settle_longer(self, points: Points, transient: Integers) -> None:
        """Settle points on for so many common periods more."""
        part, settling = self.ensemble.subset(points), self.how.settling
        self._take(part, points, self._settle(part, transient + settling.longest - settling.transient))

    def _take(self, part: Ensemble, points: Points, again: Returns) -> None:
        """Take over points that have settled after all; those that have not stay as they were known."""
        found = self.found
        self.ensemble.absorb(part, points)
        values: dict[str, Any] = {name: getattr(self.returns, name).copy() for name in RETURNS}
        extremes = {k: v.copy() for k, v in self.returns.extremes.items()}
        for name, one in values.items():
            one[..., points] = getattr(again, name) + (one[points] if name == "waited" else 0)
        for name, one in extremes.items():
            one[..., points] = again.extremes[name]
        self.returns = replace(self.returns, **values, extremes=extremes)
        known = again.regime != Regime.undecided
        at = points[known]
        found.regime[at], found.confidence[at] = again.regime[known], 1.0
        found.rule[at] = np.where(again.multiple[known] > 0, Rule.returns, Rule.trend)
