"""Steady-state search with steps that meet the asked accuracy on the steady motion.

The settled motion is asked whether its steps do (`settled_steps`): a point that needs more of them settles on with these,
and a point that has ended is run again with more (`endings`). Where the accuracy is not met, a return is one to the error of
the steps.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.motion.endings import confirm_ends, confirm_growth, restarted
from whirlmap.analysis.steady.settled import Settled
from whirlmap.analysis.steady.settled_steps import CHECKED, LOST, steps_of_settled, wider_tolerance
from whirlmap.analysis.steady.settling import Settling, settle
from whirlmap.analysis.steady.settling_unforced import settle_unforced, trends_beyond
from whirlmap.analysis.steady.settling_without_returns import settle_without_returns
from whirlmap.integrate.accuracy import StepVerdict, choose_steps
from whirlmap.integrate.ensemble import Ensemble

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

#: How often a point may be given more steps after it has settled.
MORE_STEPS = 3
#: Error over the accuracy up to which a non-periodic motion goes on with more steps as it is: so little is not why it does
#: not return.
SLACK = 10.0


def settle_accurately(
    ensemble: Ensemble, settling: Settling, longest: Integers, cyclic: dict[int, float] | None,
    progress: Callable[[int], None] | None,
) -> Settled:  # fmt: skip
    """Settle, and settle on with more steps where the settled motion, or what lies before an end, needs them."""
    how = settle_unforced if not ensemble.model.forced else _settle_forced if ensemble.returns else settle_without_returns

    def settle_part(part: Ensemble, members: NDArray[np.intp]) -> None:
        again = how(part, settling, longest[members], cyclic, progress)
        again.accelerated[:] |= settled.accelerated[members]
        settled.take(again, members)

    def begin_anew(part: Ensemble, members: NDArray[np.intp]) -> None:
        settled.forget(members)
        settle_part(part, members)

    def settle_on(part: Ensemble, members: NDArray[np.intp]) -> None:
        start, began = part.x.copy(), part.turns.copy()
        settle_part(part, members)
        if part.accuracy is not None:
            again = lambda anew, which: begin_anew(anew, members[which])  # noqa: E731
            confirm_growth(part, start, began, again, lambda: settled.moved[:, members])
            believed = np.isfinite(settled.thinning[members])
            confirm_ends(part, start, began, again, believed)
        if part is not ensemble:
            ensemble.absorb(part, members)

    settled, everything = Settled.none(ensemble), np.arange(ensemble.points)
    start, began = ensemble.x.copy(), ensemble.turns.copy()
    settle_on(ensemble, everything)
    if not ensemble.model.forced:
        trends_beyond(ensemble, settled, start, began, cyclic)
    if ensemble.accuracy is None:
        return settled
    # Points that did not return are asked too: steps that are too long may be why. One that returned has settled.
    left = everything
    for _ in range(MORE_STEPS):
        left = left[ensemble.running[left]]
        steps, first = steps_of_settled(ensemble, left, settled.multiple, progress)
        more = steps > ensemble.point_steps[left]
        left, steps, first = left[more], steps[more], first[more]
        if not left.size:
            break
        lost = first > LOST
        on = ~lost & (settled.multiple[left] == 0) & (first <= SLACK * ensemble.accuracy)
        for which, how_on in ((on, "stays"), (~lost & ~on, "settles"), (lost, "begins")):
            here = left[which]
            if not here.size:
                continue
            part = ensemble.subset(here, steps=steps[which])
            if how_on == "stays":
                ensemble.absorb(part, here)
                continue
            if how_on == "begins":
                settled.forget(here)
                part = restarted(ensemble, here, start, began, steps[which])
            settle_on(part, here)
    _take_fewer_steps(ensemble, np.flatnonzero((settled.multiple == 0) & ensemble.running))
    # What steps are so wrong about has no return that could be believed.
    settled.multiple[ensemble.step_error > LOST] = 0
    return settled


def _take_fewer_steps(ensemble: Ensemble, members: NDArray[np.intp]) -> None:
    """Give points that go on without a return the steps that their motion asks for: their starts may have asked for more."""
    members = members[ensemble.step_verdict[members] == StepVerdict.met]
    if not (members.size and ensemble.model.forced):
        return
    assert ensemble.accuracy is not None
    now = choose_steps(ensemble, ensemble.accuracy, members=members, sections=CHECKED)
    fewer = (now.verdict == StepVerdict.met) & (now.steps < ensemble.point_steps[members])
    if fewer.any():
        here = members[fewer]
        ensemble.absorb(ensemble.subset(here, steps=now.steps[fewer]), here)
        ensemble.step_error[here] = now.error[fewer]


def _settle_forced(
    ensemble: Ensemble, settling: Settling, longest: Integers, cyclic: dict[int, float] | None,
    progress: Callable[[int], None] | None,
) -> Settled:  # fmt: skip
    wide = wider_tolerance(ensemble, settling)
    return settle(ensemble, settling, longest=longest, wide=wide, cyclic=cyclic, progress=progress)
