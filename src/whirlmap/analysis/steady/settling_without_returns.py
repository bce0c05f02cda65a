"""Transients of forced models whose forcing has no common period, so that no return can be sought.

Points run for the time that is given, and the size of their motion is that of the last half of it. Whether they have
settled, the rule sees from the run with a tangent vector that follows (`labels`), until nothing is left of the start.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.steady.settled import Settled
from whirlmap.analysis.steady.settled_steps import wider_tolerance
from whirlmap.analysis.steady.settling import Settling
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.scales import scales_between

Integers = NDArray[np.int64]


def settle_without_returns(
    ensemble: Ensemble, settling: Settling, longest: Integers, _cyclic: dict[int, float] | None,
    progress: Callable[[int], None] | None,
) -> Settled:  # fmt: skip
    """Run all points for ``longest`` T, in place; none of them returns."""
    settled = Settled.none(ensemble)
    states, running = ensemble.model.dimension, np.flatnonzero(ensemble.running)
    for periods in np.unique(longest[running]):
        for length in (int(periods) - int(periods) // 2, int(periods) // 2):
            these = running[(longest[running] == periods) & ensemble.running[running]]
            if not (length and these.size):
                continue
            extremes = ensemble.advance(length, members=these, extremes=True, progress=progress).extremes
            assert extremes is not None
            low, high = extremes["minimum"], extremes["maximum"]
            settled.moved[:, these] = np.fmax(settled.moved[:, these], (high - low)[:states])
            scale = scales_between(ensemble.model, ensemble.period[these], low, high)
            settled.scale[:, these] = scale * wider_tolerance(ensemble, settling)[these]
            settled.waited[these] += length
    return settled
