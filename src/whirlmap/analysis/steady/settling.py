"""Steady-state search for forced models: every point runs until its section returns; then the next point takes its lane.

All points share a pool of lanes. In each round every point in the pool runs until it is due for a convergence
check. A point is checked on its own, by its own history, every `ROUND` common periods, and less often the longer it has run
(`pool.looks`):

1. The last `Settling.first_window` section points are searched for a return after m common periods; whenever a longer
   window, each twice the one before, has filled anew, it is searched too, for returns up to `Settling.most`.
2. A return counts once what is left of the transient is small as well: where successive differences shrink by a factor r
   from one return to the next, the distance to the limit is the last difference times r / (1 - r); and once no shorter
   return is still on its way.
3. A point that approaches its orbit slowly is moved to its extrapolated orbit, and kept there if the verification run
   succeeds (`acceleration`); otherwise it is restored, and the attempt costs nothing but time.
4. A point that has returned, ended, or run its full length leaves the pool, and the next one enters.
5. Points that have returned are asked for their multipliers, all together (`proof`): one whose way is not over, or that
   leaves an orbit which repels it, settles on, and counts as not returned where that does not help.

Which lane a point runs in, and when, changes none of its bits (`Ensemble`).
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.steady.periodicity import period_of
from whirlmap.analysis.steady.pool import Pool
from whirlmap.analysis.steady.proof import unproved
from whirlmap.analysis.steady.settled import Settled
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.options.computed import Settling as Settling

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

#: How often a point whose return was no proof settles on.
PROOFS = 2


def settle(
    ensemble: Ensemble,
    settling: Settling,
    *,
    longest: Integers | None = None,
    wide: Array | None = None,
    cyclic: dict[int, float] | None = None,
    progress: Callable[[int], None] | None = None,
) -> Settled:
    """Settle all points of a forced model, in place.

    Parameters
    ----------
    longest : array of int, shape (point,), optional
        Common periods after which each point is given up; `Settling.longest` where absent.
    wide : array, shape (point,), optional
        Tolerance of each point over that of the settling.
    cyclic : mapping of state index to period, optional
        States that are angles.

    Returns
    -------
    Settled
        Points that ended, and points that did not return in the longest time, have multiple 0.
    """
    longest = np.full(ensemble.points, settling.longest) if longest is None else longest
    wide = np.ones(ensemble.points) if wide is None else wide
    period = period_of(cyclic, ensemble.model.dimension)
    settled = _settle(ensemble, settling, longest, wide, np.ones(ensemble.points), period, progress)
    left: NDArray[np.intp] = np.arange(ensemble.points if not ensemble.tangents else 0)
    for proof in range(PROOFS + 1):
        doubt = unproved(ensemble, settled, left, settling.tolerance, cyclic or {}, longest)
        left = doubt.points
        if not left.size:
            break
        if proof == PROOFS:
            settled.multiple[left] = 0
            break
        part = ensemble.subset(left)
        part.advance(doubt.ahead * part.strobe, progress=progress)
        again = _settle(part, settling, longest[left], wide[left], doubt.strict, period, progress)
        again.waited[:] += doubt.ahead
        ensemble.absorb(part, left)
        settled.take(again, left)
    return settled


def _settle(
    ensemble: Ensemble, settling: Settling, longest: Integers, wide: Array, strict: Array, period: Array,
    progress: Callable[[int], None] | None,
) -> Settled:  # fmt: skip
    """Settle; returns of points that have not been accelerated are within the part ``strict`` of their tolerance."""
    common = ensemble.strobe
    pool = Pool(ensemble, settling, longest, wide, strict, period)
    while pool.active.size:
        stretch = pool.stretch()
        segment = ensemble.advance(
            stretch * common, members=pool.active, save_periods=common, extremes=True, progress=progress
        )
        assert segment.extremes is not None
        pool.take(stretch, segment.saved, segment.extremes["minimum"], segment.extremes["maximum"])
    refused = pool.attempts.refuse_unproved()
    kept = np.setdiff1d(np.arange(ensemble.points), refused)
    if refused.size:
        part = ensemble.subset(refused)
        plainly = replace(settling, accelerate=False)
        again = _settle(part, plainly, longest[refused], wide[refused], strict[refused], period, progress)
        ensemble.absorb(part, refused)
        pool.settled.take(again, refused)
    pool.settled.distance[kept] *= wide[kept]
    return pool.settled
