"""Steady-state search for unforced models: returns are counted in crossings of the declared section.

A point runs its transient, and is then cut at the section. Windows are as many typical times as would be common periods,
each twice the one before, for the points that have not returned; those that still approach an orbit go on.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.motion.endings import restarted
from whirlmap.analysis.motion.section_crossing import run_with_crossings
from whirlmap.analysis.steady.crossing_returns import settled_returns
from whirlmap.analysis.steady.periodicity import period_of
from whirlmap.analysis.steady.settled import Settled
from whirlmap.analysis.steady.settled_steps import wider_tolerance
from whirlmap.analysis.steady.settling import Settling
from whirlmap.analysis.steady.turn_times import SOUGHT, TURNS, learn_turns
from whirlmap.analysis.trends.trend import trend
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.scales import scales_between
from whirlmap.results.status import Status

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

#: T of an unforced motion that left its limits that are looked at, at most.
LAST = 512
#: A point whose distance from a return is small, and smaller by this factor than in the window before, is on its way to an
#: orbit: it is given more of the longest windows, so many at most.
NEAR, NEARER, MORE = 0.1, 0.9, 64


def settle_unforced(
    ensemble: Ensemble, settling: Settling, longest: Integers, cyclic: dict[int, float] | None,
    progress: Callable[[int], None] | None,
) -> Settled:  # fmt: skip
    """Settle all points, in place; ``longest`` less the settling's own is what the transient is longer by."""
    settled = Settled.none(ensemble)
    transient = longest - settling.longest + settling.transient
    running = np.flatnonzero(ensemble.running)
    first = ensemble.subset(running).advance(1, extremes=True).extremes  # how far the states move before they settle
    assert first is not None
    ranges = (first["maximum"] - first["minimum"])[: ensemble.model.dimension]
    settled.moved[:, running] = np.fmax(ranges, 0.0)
    learn_turns(ensemble, running, SOUGHT, settled, progress)
    _run_transient(ensemble, np.flatnonzero(ensemble.running), transient, settled, progress)
    learn_turns(ensemble, np.flatnonzero(ensemble.running), TURNS + 1, settled, progress)
    wide = wider_tolerance(ensemble, settling)
    window = min(settling.first_window, 2 * settling.most)
    left = np.flatnonzero(ensemble.running)
    before, extra, period = np.full(ensemble.points, np.inf), 0, period_of(cyclic, ensemble.model.dimension)
    approaches = np.zeros(ensemble.points, dtype=bool)
    while left.size:
        begin, section = ensemble.subset(left), ensemble.subset(left)
        points, times, _ = run_with_crossings(section, window, progress=progress)
        extremes = begin.advance(window, extremes=True, progress=progress).extremes
        assert extremes is not None
        ensemble.absorb(section, left)
        low, high = extremes["minimum"], extremes["maximum"]
        settled.scale[:, left] = scales_between(ensemble.model, ensemble.period[left], low, high) * wide[left]
        ranges = (high - low)[: ensemble.model.dimension]
        settled.moved[:, left] = np.fmax(settled.moved[:, left], ranges)
        settled.waited[left] += window
        approaches[left] = False
        count = np.where(ensemble.running[left], np.isfinite(times).sum(axis=0), 0)
        for shared in np.unique(count[count > 1]):  # each point is judged by all of its crossings, whatever others have
            columns = np.flatnonzero(count == shared)
            these = left[columns]
            found, distance = settled_returns(
                points[:shared][:, :, columns], settled.scale[:, these], period, settling.tolerance,
                int(min(window, shared)) // 2,
            )  # fmt: skip
            settled.multiple[these], settled.distance[these] = np.maximum(found, 0), distance * wide[these]
            approaches[these] = found < 0
        left = left[ensemble.running[left] & (settled.multiple[left] == 0)]
        if window >= 2 * settling.most:
            nearer = (settled.distance[left] < NEAR) & (settled.distance[left] < NEARER * before[left])
            left, extra = left[nearer | approaches[left]], extra + 1
            if extra > MORE:
                break
        before[left] = settled.distance[left]
        window = min(2 * window, 2 * settling.most)
    return settled


def _run_transient(
    ensemble: Ensemble, members: NDArray[np.intp], transient: Integers, settled: Settled,
    progress: Callable[[int], None] | None,
) -> None:  # fmt: skip
    for times in np.unique(transient[members][transient[members] > 0]):
        these = members[transient[members] == times]
        ensemble.advance(int(times), members=these, progress=progress)
    settled.waited[members] += transient[members]


def trends_beyond(
    ensemble: Ensemble, settled: Settled, start: Array, began: Integers, cyclic: dict[int, float] | None
) -> None:
    """See whether points of an unforced model that left their limits had grown or drifted there steadily."""
    points = np.flatnonzero(ensemble.status == Status.diverged)
    if not points.size:
        return
    part = restarted(ensemble, points, start, began, ensemble.point_steps[points])
    whole = np.minimum(ensemble.end_time[points] / part.period, LAST).astype(np.int64)
    for count in np.unique(whole[whole > 0]):
        at = np.flatnonzero(whole == count)
        seen = trend(part.advance(int(count), members=at, save_periods=1).saved, cyclic)
        settled.growth[points[at]], settled.drift[:, points[at]] = seen.growth, seen.drift
