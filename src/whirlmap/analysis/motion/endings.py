"""Confirmation of the ends of runs: by runs with more steps.

Steps are chosen where a motion begins. A stop that is reached later, a wall or a stiff contact may ask for many more, and a
run with too few of them ends in a divergence, or at a wall, that is its own. So a point that has ended is run again from
its start, twice at most, each time with twice the steps or as many as the motion shortly before its end asks for
(`choose_steps`):

1. An end is believed where the next run ends alike, at the same time.
2. Where the motion before it is chaotic the times differ: then it is believed where all runs end alike.
3. A point that does not end with more steps goes on with these.
4. A divergence is believed where `FINE` times as many steps, from shortly before it, find it as well.
5. What ends otherwise each time, or diverges though no steps of the ladder meet the accuracy, is unresolved.

An explicit method whose steps are too long for a contact may grow without an end: while the contact is open a huge motion
dies away as accurately as a small one, and nothing in it tells that steps made it. So a motion that has grown far beyond
that for which its steps were chosen (`GROWN`) is run again as well, and is believed where it comes to the same size.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from whirlmap.integrate.accuracy import StepVerdict, choose_steps
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.rung_runs import ALIKE, motion_sizes
from whirlmap.integrate.scales import start_sizes
from whirlmap.results.status import Status

Array = NDArray[np.float64]
Points = NDArray[np.intp]

#: Runs after the first one, and how much more steps each takes at least.
RUNS, MORE = 2, 2
#: Common periods before an end from which the steps are chosen, and over which they are tried.
BEFORE, SPAN = 1, 2
#: Times as many steps with which a divergence is sought again from shortly before, and steps per T that this takes at most.
FINE, MOST = 32, 65_536
#: Difference of two times of an end, in T, that are the same; of a divergence beside `ALIKE` steps of the coarser run.
SAME_TIME = 1e-3
#: Growth of a motion, over its size in the first common period, that is believed only where more steps find it again; how
#: many times as many; the factor between two sizes that are the same; and how many runs are made for it at most.
GROWN, MANY, SAME_SIZE, MORE_OFTEN = 1e4, 4, 3.0, 4


def confirm_ends(
    ensemble: Ensemble, start: Array, began: NDArray[np.int64], settle_again: Callable[[Ensemble, Points], None],
    believed: NDArray[np.bool_],
) -> None:  # fmt: skip
    """Run points that have ended again, with more steps, in place: they go on, or their end is believed, or unresolved.

    Parameters
    ----------
    ensemble : Ensemble
        Its steps were chosen for an accuracy.
    start : array, shape (state, point)
    began : array of int, shape (point,)
        The ``turns`` at which the points began there, whole common periods.
    settle_again : callable
        ``settle_again(part, members)`` runs a part of the points on from their start as they were run before.
    believed : array of bool, shape (point,)
        Points whose end is known: their steps failed for a film that thins on and on.
    """
    assert ensemble.accuracy is not None
    left = np.flatnonzero(~ensemble.running & ~believed)
    every = [ensemble.status.copy()]
    for _ in range(RUNS):
        if not left.size:
            break
        steps, stiff = _steps_before_the_end(ensemble, left, start, began)
        part = restarted(ensemble, left, start, began, np.maximum(MORE * ensemble.point_steps[left], steps))
        coarse = ensemble.point_steps[left]
        status, time = ensemble.status[left], ensemble.end_time[left] / ensemble.period[left]
        settle_again(part, left)
        ensemble.absorb(part, left)
        every.append(ensemble.status.copy())
        with np.errstate(invalid="ignore"):
            apart = np.abs(part.end_time / part.period - time)
            alike = (part.status == status) & (apart <= SAME_TIME + np.where(status == Status.diverged, ALIKE / coarse, 0.0))
        # Before a pole no steps are enough.
        doubt = stiff & (part.status == Status.diverged) & (part.end_stop < len(part.model.stops))
        ensemble.status[left[doubt]], ensemble.step_verdict[left[doubt]] = Status.unresolved, StepVerdict.stiff
        left = left[(part.status != Status.ok) & ~alike & ~doubt]
    different = (np.array(every)[:, left] != every[-1][left]).any(axis=0)
    ensemble.status[left[different]] = Status.unresolved
    _refuse_explosions(ensemble, start, began)


def confirm_run(ensemble: Ensemble, start: Array, began: NDArray[np.int64], periods: int) -> bool:
    """Confirm the ends of points that ran some T from their start (`confirm_ends`), in place.

    Returns whether any of them goes on with more steps: these points stand at the end of the run, with these steps. Steps
    that were given are taken as they are.
    """
    ended = ~ensemble.running
    if ensemble.accuracy is None or not ended.any():
        return False

    def again(part: Ensemble, _: Points) -> None:
        part.advance(periods)

    confirm_ends(ensemble, start, began, again, np.zeros(ended.size, dtype=bool))
    return bool((ended & ensemble.running).any())


def confirm_growth(
    ensemble: Ensemble, start: Array, began: NDArray[np.int64], settle_again: Callable[[Ensemble, Points], None],
    moved: Callable[[], Array],
) -> None:  # fmt: skip
    """Run points that have grown far again, with more steps, in place, until two runs come to the same size.

    Parameters
    ----------
    ensemble, start, began, settle_again
        As of `confirm_ends`.
    moved : callable
        Gives the largest range of each state so far, shape (state, point), of all points.
    """
    left = np.flatnonzero(ensemble.running)
    left = left[_grown(ensemble, left, start, began, moved()[:, left])]
    for _ in range(MORE_OFTEN):
        if not left.size:
            return
        before = moved()[:, left].max(axis=0)
        part = restarted(ensemble, left, start, began, MANY * ensemble.point_steps[left])
        settle_again(part, left)
        ensemble.absorb(part, left)
        now = moved()[:, left]
        same = np.abs(np.log(now.max(axis=0) / before)) < np.log(SAME_SIZE)
        left = left[part.running & ~same]
        left = left[_grown(ensemble, left, start, began, moved()[:, left])]
    ensemble.status[left], ensemble.step_verdict[left] = Status.unresolved, StepVerdict.stiff


def _grown(ensemble: Ensemble, members: Points, start: Array, began: NDArray[np.int64], moved: Array) -> NDArray[np.bool_]:
    """Whether some points have moved far beyond their first common period, for which their steps were chosen."""
    with np.errstate(invalid="ignore"):
        far = moved > GROWN * start_sizes(ensemble.model, ensemble.period[members], start[:, members])
    far[[s.cyclic is not None for s in ensemble.model.states]] = False
    grown = np.asarray(far.any(axis=0))
    suspects = np.flatnonzero(grown)
    if suspects.size:  # a start may be far smaller than the motion that the forcing leads to at once
        here = members[suspects]
        part = restarted(ensemble, here, start, began, ensemble.point_steps[here])
        first = part.advance(part.strobe, save_periods=1, extremes=True)
        size = motion_sizes(part, first, start[:, here])
        grown[suspects] = (far[:, suspects] & (moved[:, suspects] > GROWN * size)).any(axis=0)
    return grown


def _refuse_explosions(ensemble: Ensemble, start: Array, began: NDArray[np.int64]) -> None:
    """Make divergences unresolved that `FINE` times as many steps from shortly before do not find: a method's own, in place.

    Where a motion is stiff all steps of the ladder explode at the same fast turn, one as the other.
    """
    away = np.flatnonzero((ensemble.status == Status.diverged) & (ensemble.end_stop < len(ensemble.model.stops)))
    if not away.size:
        return
    part = _before_the_end(ensemble, away, start, began)
    fine = part.subset(np.arange(away.size), steps=np.minimum(FINE * part.point_steps, MOST))
    fine.advance(2 * SPAN * fine.strobe)
    explodes = away[fine.status != Status.diverged]
    ensemble.status[explodes], ensemble.step_verdict[explodes] = Status.unresolved, StepVerdict.stiff


def restarted(
    ensemble: Ensemble, members: Points, start: Array, began: NDArray[np.int64], steps: NDArray[np.int64]
) -> Ensemble:
    """Points back at their start, with other steps."""
    part = ensemble.subset(members, steps=steps)
    part.put(np.arange(members.size), start[:, members])
    part.status[:], part.end_time[:], part.end_stop[:], part.turns[:] = Status.ok, np.nan, -1, began[members]
    return part


def _steps_before_the_end(
    ensemble: Ensemble, members: Points, start: Array, began: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Steps that the motion just before its end asks for, and where no steps of the ladder meet the accuracy."""
    assert ensemble.accuracy is not None
    part = _before_the_end(ensemble, members, start, began)
    steps, stiff = np.zeros(members.size, dtype=np.int64), np.zeros(members.size, dtype=bool)
    at = np.flatnonzero(part.running)
    rungs = choose_steps(part, ensemble.accuracy, members=at, least=part.point_steps[at], span=SPAN)
    steps[at], stiff[at] = rungs.steps, rungs.verdict == StepVerdict.stiff
    return steps, stiff


def _before_the_end(ensemble: Ensemble, members: Points, start: Array, began: NDArray[np.int64]) -> Ensemble:
    """Points that have ended, run from their start to `BEFORE` common periods before that."""
    part = restarted(ensemble, members, start, began, ensemble.point_steps[members])
    common = part.strobe
    with np.errstate(invalid="ignore"):
        ended = np.floor(ensemble.end_time[members] / (part.period * common))
    count = np.where(np.isfinite(ended), ended, 0).astype(np.int64) - began[members] // common
    count = np.maximum(count - BEFORE, 0)
    for periods in np.unique(count[count > 0]):
        part.advance(int(periods) * common, members=np.flatnonzero(count == periods))
    return part
