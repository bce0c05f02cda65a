"""Unforced models: their steps, and the period of their motion, whatever typical time is declared.

The typical time of a model is a guess, and may be wrong by a thousand. It is the unit in which transients and windows are
counted, so that steps are chosen in parts of it, and once the motion has been seen to turn its own time takes the place of
the guess (`Ensemble.period`), point by point.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from whirlmap.integrate.accuracy import Rungs, StepVerdict, choose_steps
from whirlmap.integrate.ensemble import Ensemble

Array = NDArray[np.float64]

#: Parts of a typical time over which steps are tried: over many turns of a chaotic motion no two rungs agree.
PARTS = (1, 32, 1024)
#: Steps per typical time beyond which a motion is too stiff for an explicit method.
MOST = 600_000


def choose_unforced_steps(
    ensemble: Ensemble, accuracy: float, progress: Callable[[int], None] | None = None
) -> Rungs:
    """Steps per T of an unforced model, as `choose_steps`, where T may be far too long.

    A point for which no rung meets the accuracy is tried over a 32nd part of T, then over a 1024th, with the error for each
    part. More than `MOST` steps per T are not taken: such a point is stiff.
    """
    whole = choose_steps(ensemble, accuracy, progress=progress)
    for parts in PARTS[1:]:
        left = np.flatnonzero(whole.verdict != StepVerdict.met)
        if not left.size:
            break
        short = with_turns(ensemble.subset(left), ensemble.period[left] / parts)
        found = choose_steps(short, accuracy, progress=progress)
        better = found.verdict < whole.verdict[left]
        good = better & (parts * found.steps <= MOST)
        at = left[good]
        whole.steps[at], whole.error[at] = parts * found.steps[good], found.error[good]
        whole.verdict[at], whole.first[at], whole.size[:, at] = found.verdict[good], found.first[good], found.size[:, good]
    return whole


def with_turns(ensemble: Ensemble, turn: Array) -> Ensemble:
    """Give the points of an unforced model another T, in place; what they have run is forgotten."""
    ensemble.period, ensemble.turns = np.array(turn, dtype=float), np.zeros_like(ensemble.turns)
    ensemble.limit(ensemble.limits)
    return ensemble
