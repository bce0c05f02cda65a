"""Operating points that do not return: exponent, section and verdict of each, run as long as that one needs.

A run with one tangent vector gives both. It goes on in stretches that double, until the indicators agree on a label and the
error of the exponent is small enough, or to the longest length. Where tangent vectors shrink for sure no label can come of
it: such a point is on its way to an orbit, for which it needs no tangent vector, and stops. A point's numbers depend on its
own run alone.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.evidence import LEAST
from whirlmap.analysis.lyapunov import mean_and_error
from whirlmap.analysis.regime import contracts, regime
from whirlmap.analysis.tangent_accuracy import tuned
from whirlmap.analysis.tangent_run import run_with_section
from whirlmap.analysis.unbounded import Trends
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.results.regime import Regime

Array = NDArray[np.float64]

#: Error of the largest exponent, relative and in units of 2 pi/T, with which a labelled point stops.
ENOUGH = (0.05, 0.005)
#: Points that run together: their section points are kept until they are judged.
TOGETHER = 512
#: Points whose trends are computed together: what that takes on the way is several times their section points.
TRENDS = 64


@dataclass(frozen=True)
class OpenPoints:
    """What was found, each array of shape (point,).

    Attributes
    ----------
    regime : array of int
        `Regime`: quasi-periodic, chaotic or undecided.
    confidence, winding : array
        As of `whirlmap.analysis.regime.regime`.
    exponent, error : array
        Largest Lyapunov exponent and one standard error, per unit of the model's time.
    periods : array of int
        Common periods over which it was measured.
    growth : array
        Rate per unit of time at which the section's range grows or falls steadily; NaN where it does not.
    drift : array, shape (state, point)
        Speed per unit of time at which the section's mean moves steadily; zero where it does not.
    centre, reach : array, shape (state, point)
        Of the section, as in `Trends`.
    """

    regime: NDArray[np.int8]
    confidence: Array
    winding: Array
    exponent: Array
    error: Array
    periods: NDArray[np.int64]
    growth: Array
    drift: Array
    centre: Array
    reach: Array

    @classmethod
    def none(cls, model_states: int, points: int) -> "OpenPoints":
        """Points of which nothing is known yet."""
        zero, unknown = np.zeros((model_states, points)), np.full((5, points), np.nan)
        return cls(
            np.full(points, Regime.undecided, dtype=np.int8), np.zeros(points), unknown[0], unknown[1], unknown[2],
            np.zeros(points, dtype=np.int64), unknown[3], zero, zero.copy(), zero.copy(),
        )  # fmt: skip


def judge_open_points(
    tangent: Ensemble,
    most: int,
    cyclic: Mapping[int, float] | None,
    progress: Callable[[int], None] | None = None,
    *,
    contraction_ends: bool = False,
) -> OpenPoints:
    """Measure and judge points that have settled but do not return.

    Parameters
    ----------
    tangent : Ensemble
        At the settled states, with one tangent vector; its ``status`` is taken forward in place.
    most : int
        Common periods (unforced: typical times) run at most; one stretch where that is less than `LEAST`.
    contraction_ends : bool
        Whether points of a forced model stop, undecided, once their tangent vectors have shrunk for sure.
    """
    n = tangent.points
    found = OpenPoints.none(tangent.model.dimension, n)
    for first in range(0, n, TOGETHER):
        members = np.arange(first, min(first + TOGETHER, n))
        _judge(tangent, members, most, cyclic, found, progress, contraction_ends and tangent.model.forced)
    return found


def _judge(
    tangent: Ensemble,
    members: NDArray[np.intp],
    most: int,
    cyclic: Mapping[int, float] | None,
    found: OpenPoints,
    progress: Callable[[int], None] | None,
    contraction_ends: bool,
) -> None:
    """Run some of the points to their verdicts, into ``found``."""
    rates = np.full((most, members.size), np.nan)
    sections: list[list[Array]] = [[] for _ in members]
    carried = tuned(tangent.subset(members))
    left, run = np.arange(members.size), carried.ensemble
    done, stretch, first = 0, min(LEAST, most), max(min(LEAST, most) // 10, 5)
    while left.size:
        local, section = run_with_section(run, stretch, align=0 if done else first, progress=progress)
        rates[done : done + stretch, left] = local[:, 0]
        done += stretch
        for k, point in enumerate(left):
            here = section[:, :, k]
            sections[point].append(here[np.isfinite(here[:, 0])])
        at = members[left]
        tangent.status[at], tangent.end_time[at] = run.status, run.end_time
        for point in left:
            sections[point] = [np.concatenate(sections[point])]
        _trends([sections[point][0] for point in left], first, done, at, tangent, cyclic, found)
        found.exponent[at], error = mean_and_error(rates[:done, left])
        found.error[at] = np.fmax(error, carried.error[0, left])
        found.periods[at] = done
        unsure = np.flatnonzero((found.regime[at] == Regime.undecided) & run.running)
        _vote(run, unsure, at, done, [sections[p][0] for p in left[unsure]], cyclic, found)
        # A torus does not change its size steadily: what does is on its way elsewhere, or beats more slowly than this.
        changes = (found.regime[at] == Regime.quasi_periodic) & np.isfinite(found.growth[at])
        found.regime[at[changes]], found.confidence[at[changes]] = Regime.undecided, 0.0
        target = np.maximum(ENOUGH[0] * np.abs(found.exponent[at]), ENOUGH[1] * 2 * np.pi / run.period)
        open_ = found.regime[at] == Regime.undecided
        if contraction_ends:
            open_ &= ~contracts(found.exponent[at], found.error[at], done * run.common_multiple * run.period)
        stay = run.running & (open_ | (found.error[at] > target))
        stretch = min(done, most - done)
        if not stretch:
            return
        left, run = left[stay], run.subset(np.flatnonzero(stay))


def _trends(
    sections: list[Array],
    align: int,
    done: int,
    at: NDArray[np.intp],
    run: Ensemble,
    cyclic: Mapping[int, float] | None,
    found: OpenPoints,
) -> None:
    """Trends of the sections so far of some points of a run, into ``found``."""
    count = np.array([len(s) for s in sections], dtype=np.int64)
    for rows in np.unique(count[count > 0]):  # forced: all that still run have the same
        same = np.flatnonzero(count == rows)
        for these in np.array_split(same, -(-same.size // TRENDS)):
            points = at[these]
            time = run.common_multiple * run.period[points]
            if not run.model.forced:  # crossings come as often as they come: the rate is per unit of time on the mean
                end = run.end_time[points]
                time = np.where(np.isfinite(end), end - align * time, done * time) / rows
            unknown = np.full(points.size, np.nan)
            section = np.stack([sections[k] for k in these], axis=2)
            seen = Trends.of(run.model, run.period[points], section, time, unknown, unknown, cyclic)
            for name in ("growth", "drift", "centre", "reach"):
                getattr(found, name)[..., points] = getattr(seen, name)


def _vote(
    run: Ensemble,
    unsure: NDArray[np.intp],
    at: NDArray[np.intp],
    done: int,
    sections: list[Array],
    cyclic: Mapping[int, float] | None,
    found: OpenPoints,
) -> None:
    """Judge the points of a run that have no label yet, each from as many section points as it has itself."""
    count = np.array([len(s) for s in sections], dtype=np.int64)
    duration = done * run.common_multiple * run.period
    for rows in np.unique(count[count >= LEAST]):  # forced: all have the same
        these = np.flatnonzero(count == rows)
        lanes = unsure[these]
        judged = regime.find(
            run.status[lanes], np.zeros(lanes.size, dtype=np.int64), exponent=found.exponent[at[lanes]],
            exponent_error=found.error[at[lanes]], duration=duration[lanes],
            section=np.stack([sections[k] for k in these], axis=2), cyclic=cyclic,
        )  # fmt: skip
        for name in ("regime", "confidence", "winding"):
            getattr(found, name)[at[lanes]] = judged[name]
