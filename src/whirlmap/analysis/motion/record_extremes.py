"""Extremes of every state and output over the record of settled points.

They are those of cubics between steps (`Ensemble.advance`), over one return, or the whole record where nothing returns.
The steps are `FINER` times shorter than the accuracy asks for, and no longer than T/`EXTREMES_STEPS`: a peak is then missed
by less than 1e-5 of the range. Where nothing returns they are `OPEN_FINER` times shorter, no longer than twice that, which
misses it by less than 2e-4: the record itself misses the largest values of such a motion by more.

A return of an unforced motion is no whole number of typical times: it is timed between crossings of the section, and the
record has steps that divide it. A mean over some turns and a part of one would depend on where the record begins.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.motion.section_crossing import run_with_crossings
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.turns import with_turns
from whirlmap.kernels.lowering.surfaces import sided

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Steps per T from which extremes are read: so many times those of the point, where it returns and not, at least so many.
FINER, OPEN_FINER, EXTREMES_STEPS = 6, 3, 32
#: The latter where rates kink or jump: a contact is far shorter than T, and located corners let few steps carry it.
KINKED_EXTREMES = 4 * EXTREMES_STEPS
#: T of an unforced model, over the crossings of a return, within which the return is timed: a typical time is at most twice
#: as long as a turn (`turn_times`), or half as long.
TIMED = 3


def empty_extremes(ensemble: Ensemble) -> dict[str, Array]:
    """Extremes, mean and rms of every state and output, shape (row, point), of which nothing is known yet."""
    rows = ensemble.model.dimension + len(ensemble.model.outputs)
    return {name: np.full((rows, ensemble.points), np.nan) for name in ("minimum", "maximum", "mean", "rms")}


def extremes_of_record(
    ensemble: Ensemble, members: NDArray[np.intp], multiple: Integers, kept: int, progress: Callable[[int], None] | None
) -> dict[str, Array]:
    """Extremes, mean and rms of all rows, shape (row, member), from where some points stand; the ensemble is not moved.

    Over one return, ``multiple`` common periods, of the points that return; over the ``kept`` T of the record of others.
    """
    finer = np.where(multiple > 0, FINER, OPEN_FINER)
    least = KINKED_EXTREMES if sided(ensemble.model).surfaces else EXTREMES_STEPS
    steps = np.maximum(finer * ensemble.point_steps[members], np.where(multiple > 0, least, least // 2))
    once = multiple * ensemble.strobe  # one return
    if ensemble.model.forced:
        fine = ensemble.subset(members, steps=steps)
    else:
        turn = _turns(ensemble, members, multiple)
        once = np.where(np.isfinite(turn), multiple, kept)
        turn = np.where(np.isfinite(turn), turn, ensemble.period[members])
        steps = np.ceil(steps * turn / ensemble.period[members]).astype(np.int64)
        fine = with_turns(ensemble.subset(members, steps=steps), turn)
    found = fine.advance(np.where(multiple > 0, once, kept), extremes="between", progress=progress).extremes
    assert found is not None
    return found


def _turns(ensemble: Ensemble, members: NDArray[np.intp], multiple: Integers) -> Array:
    """Mean time between the crossings of one return of points of an unforced model; NaN where it is not known."""
    turn = np.full(members.size, np.nan)
    for crossings in np.unique(multiple[multiple > 0]):
        at = np.flatnonzero(multiple == crossings)
        run = ensemble.subset(members[at])
        _, times, _ = run_with_crossings(run, TIMED * (int(crossings) + 1))
        if len(times) > crossings:
            turn[at] = (times[crossings] - times[0]) / crossings
    return turn
