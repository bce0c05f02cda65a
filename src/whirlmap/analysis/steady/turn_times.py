"""Period of an unforced motion from crossings of its section: T of the point in place of its typical time.

A typical time is a guess of the model's; steps and windows that are parts of it are wrong where a turn takes far longer or
shorter.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.motion.section_crossing import run_with_crossings, turns_of
from whirlmap.analysis.steady.settled import Settled
from whirlmap.integrate.accuracy import LADDER, choose_steps
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.evaluation import Evaluator
from whirlmap.integrate.harmonics import periods as periods_of
from whirlmap.integrate.scales import FLOOR, scales
from whirlmap.integrate.turns import with_turns

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Crossings of the section by which an unforced motion's turns are timed, typical times in which they are sought at most,
#: and how many times longer or shorter than a turn a typical time may be.
TURNS, SOUGHT, FAR_OFF = 4, 65_536, 2.0
#: Motion in a typical time, over the size of a state, below which rounding moves the times of crossings: no turns are timed.
STILL = 1e-6
#: Typical times over which the steps of a motion that does not return are checked.
OPEN = 4


def learn_turns(
    ensemble: Ensemble, left: NDArray[np.intp], most: int, settled: Settled, progress: Callable[[int], None] | None
) -> None:
    """Give points whose typical time is far from that of a turn the latter, in place, with steps for it.

    Turns are timed between crossings of the section. A point is run on, twice as long each time, until it has met `TURNS` of
    them, or for ``most`` typical times: what has not turned by then keeps its own.
    """
    if ensemble.model.section is None:
        return
    start, length = ensemble.x.copy(), TURNS + 1
    left = left[moves(ensemble, left)]  # what is at rest crosses by rounding
    while left.size and length <= most:
        turn = _time_turns(ensemble, left, length, settled, progress)
        ratio = turn / ensemble.period[left]
        own = np.abs(ensemble.period[left] / periods_of(ensemble.model, ensemble.values[:, left]) - 1) > 0  # timed before
        with np.errstate(invalid="ignore"):
            wrong = (ratio < 1 / FAR_OFF) | (ratio > FAR_OFF) | (own & np.isfinite(ratio))
        here = left[wrong]
        if here.size:
            steps = np.maximum(np.ceil(ensemble.point_steps[here] * ratio[wrong]), 1).astype(np.int64)
            part = with_turns(ensemble.subset(here, steps=steps), turn[wrong])
            # Its steps were chosen for parts of another time: what they led to may be their own.
            part.put(np.arange(here.size), start[:, here])
            ensemble.absorb(part, here)
        known = left[np.isfinite(turn)]
        if known.size and ensemble.accuracy is not None:
            least = np.where(wrong[np.isfinite(turn)], LADDER[0], ensemble.point_steps[known])
            rungs = choose_steps(
                ensemble, ensemble.accuracy, members=known, least=least, span=OPEN, observe=turns_of,
                goes_on=wrong[np.isfinite(turn)], progress=progress,
            )  # back at the start of what has been run
            part = ensemble.subset(known, steps=rungs.steps)
            part.step_error[:], part.step_verdict[:] = rungs.error, rungs.verdict
            ensemble.absorb(part, known)
        left = left[np.isnan(turn) & ensemble.running[left] & moves(ensemble, left)]
        length *= 2


def _time_turns(
    ensemble: Ensemble, members: NDArray[np.intp], periods: int, settled: Settled, progress: Callable[[int], None] | None
) -> Array:
    """Run points on, in place, and time their turns, shape (member,); NaN where they cross fewer than `TURNS` times."""
    run = ensemble.subset(members)
    _, times, _ = run_with_crossings(run, periods, progress=progress)
    ensemble.absorb(run, members)
    settled.waited[members] += periods
    count = np.isfinite(times).sum(axis=0)
    turn = np.full(members.size, np.nan)
    for k in np.flatnonzero((count >= TURNS) & run.running):
        turn[k] = (times[count[k] - 1, k] - times[0, k]) / (count[k] - 1)
    return turn


def moves(ensemble: Ensemble, members: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Whether the rates still carry a state anywhere in a typical time, beyond rounding."""
    x, period = ensemble.x[:, members], ensemble.period[members]
    evaluate = Evaluator.of(ensemble.model, ensemble.values[:, members], jacobian=False)
    rates = np.abs(evaluate(0.0, x, np.arange(members.size))[0])
    size = scales(ensemble.model, period, np.zeros_like(x), np.abs(x)) / FLOOR
    return np.asarray((rates * period > STILL * size).any(axis=0))
