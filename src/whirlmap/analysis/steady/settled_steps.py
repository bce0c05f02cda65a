"""Check of the steps on the settled motion, over the whole of its return, and the tolerance of returns that follows from it.

The start says little of a whirl that has grown since, and a stop may be reached late in a return of many common periods.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.motion.section_crossing import turns_of
from whirlmap.analysis.steady.settling import Settling
from whirlmap.analysis.steady.turn_times import OPEN, moves
from whirlmap.integrate.accuracy import LADDER, StepVerdict, choose_steps
from whirlmap.integrate.ensemble import Ensemble

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Common periods over which the steps of a settled motion that returns are checked, at most; of an open one: `OPEN`.
CHECKED = 8
#: Error of its steps from which a settled motion is not that of the equations: the point begins anew, with more of them.
LOST = 1e-2
#: Steps with which points are confirmed whose method has lost its order.
CONFIRMED = LADDER[-1]


def steps_of_settled(
    ensemble: Ensemble, members: NDArray[np.intp], multiple: Integers, progress: Callable[[int], None] | None
) -> tuple[Integers, Array]:
    """Steps that settled points need, and the error of those that they took.

    They are asked over all of the common periods that they return after, up to `CHECKED`; where they do not, over `OPEN`.
    Those whose method has lost its order are confirmed with `CONFIRMED` steps, and their error is that of fewer ones.
    Errors and verdicts of the ensemble are set.
    """
    assert ensemble.accuracy is not None
    steps, first = ensemble.point_steps[members].copy(), np.zeros(members.size)
    # Few different numbers of sections, for points with the same are tried together: 1, `OPEN` and `CHECKED`.
    sections = np.where(multiple[members] == 1, 1, np.where(multiple[members] <= OPEN, OPEN, CHECKED))
    met = ensemble.step_verdict[members] == StepVerdict.met
    for count in np.unique(sections[met]):
        at = np.flatnonzero(met & (sections == count))
        here: NDArray[np.intp] = members[at]
        how: dict[str, Any] = {"sections": int(count)}
        if not ensemble.model.forced:
            at = at[moves(ensemble, members[at])]
            here, how = members[at], {"span": OPEN, **({"observe": turns_of} if ensemble.model.section else {})}
        rungs = choose_steps(ensemble, ensemble.accuracy, members=here, least=steps[at], progress=progress, **how)
        ensemble.step_error[here], ensemble.step_verdict[here] = rungs.error, rungs.verdict
        steps[at], first[at] = np.maximum(steps[at], rungs.steps), rungs.first
    rough = np.flatnonzero(ensemble.step_verdict[members] == StepVerdict.nonsmooth)
    steps[rough] = np.maximum(steps[rough], CONFIRMED)
    there = rough[ensemble.point_steps[members[rough]] >= CONFIRMED]
    if there.size:
        here = members[there]
        last = np.full(here.size, LADDER[-2])
        tried = choose_steps(
            ensemble, ensemble.accuracy, members=here, least=last, highest=CONFIRMED, progress=progress
        )
        ensemble.step_error[here] = tried.error
    return steps, first


def check_steps(ensemble: Ensemble, progress: Callable[[int], None] | None = None) -> bool:
    """Give points the steps that their motion asks for where they stand, in place; returns whether any took more."""
    if ensemble.accuracy is None:
        return False
    members = np.flatnonzero(ensemble.running)
    steps, _ = steps_of_settled(ensemble, members, np.zeros(ensemble.points, dtype=np.int64), progress)
    more = steps > ensemble.point_steps[members]
    if more.any():
        here = members[more]
        ensemble.absorb(ensemble.subset(here, steps=steps[more]), here)
    return bool(more.any())


def wider_tolerance(ensemble: Ensemble, settling: Settling) -> Array:
    """How much wider than asked the tolerance of each point is: a return is no finer than the error of the steps.

    Steps that were given have no error that is known: the tolerance stays as asked.
    """
    if ensemble.accuracy is None:
        return np.ones(ensemble.points)
    return np.asarray(np.fmax(np.fmin(ensemble.step_error, LOST) / settling.tolerance, 1.0))
