"""Extremes of every state and output over the record of settled points.

They are those of cubics between steps (`Ensemble.advance`), over one return, or the whole record where nothing returns.
The steps are `FINER` times shorter than the accuracy asks for, and no longer than T/`EXTREMES_STEPS`: a peak is then missed
by less than 1e-5 of the range. Where nothing returns they are `OPEN_FINER` times shorter, which misses it by less than 2e-4:
a record of some 64 T misses the largest values of such a motion by more.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from whirlmap.integrate.ensemble import Ensemble
from whirlmap.kernels.surfaces import sided

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Steps per T from which extremes are read: so many times those of the point, where it returns and not, at least so many.
FINER, OPEN_FINER, EXTREMES_STEPS = 6, 3, 32
#: The latter where rates kink or jump: a contact is far shorter than T, and located corners let few steps carry it.
KINKED_EXTREMES = 4 * EXTREMES_STEPS


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
    fine = ensemble.subset(members, steps=np.maximum(finer * ensemble.point_steps[members], least))
    out = empty_extremes(fine)
    length = np.where((multiple > 0) & fine.model.forced, multiple * fine.strobe, kept)
    for periods in np.unique(length):
        these = np.flatnonzero(length == periods)
        found = fine.advance(int(periods), members=these, extremes="between", progress=progress).extremes
        assert found is not None
        for name, values in found.items():
            out[name][:, these] = values
    return out
