"""Accuracy of tangent vectors: steps and orthonormalisations per T of each point, and the error that these steps leave.

Two errors of exponents do not show in their scatter. Vectors that are orthonormalised too seldom all turn into the
fastest direction: once they have grown apart by more than doubles hold, the smaller exponents are rounding. And steps that
are good enough for the motion may be too long for directions that contract faster than it moves; where the record is in
step with the motion, every block of it then has the same error, and the scatter is none.

Both are measured on a test run from each point's own state, so that its numbers depend on nothing else:

1. With the vectors orthonormalised in every step, the growths of one test run say how often that is needed.
2. The same run with twice the steps, T by T from the same states, says how far the exponents are from theirs. Steps are
   doubled until that is small; what is left is the least error of each exponent.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from whirlmap.integrate.ensemble import Ensemble

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

#: T of a test run.
TRIAL = 4
#: Difference of the vectors' growths between two orthonormalisations, on average; of a double's 36 that leaves enough where
#: a motion contracts several times as fast in some parts of its period as in others.
APART = 8.0
#: Most steps per T, and most doublings of them.
MOST, DOUBLINGS = 8192, 5
#: Errors of the steps, over the exponent and over one growth in a T, that are small enough: for spectra, and for labels.
FINE, COARSE = (1e-6, 1e-6), (1e-3, 1e-4)
#: Fall of the error with twice the steps below which the method has lost its order.
STALLED = 4.0
#: What is left after doubling is at most this times the difference that it made.
LEFT = 2.0


@dataclass(frozen=True)
class Tuned:
    """An ensemble with tangent vectors that are carried well enough.

    Attributes
    ----------
    ensemble : Ensemble
        At the states of the one given.
    error : array, shape (exponent, point)
        Largest error of each exponent that its steps leave, per unit of time.
    """

    ensemble: Ensemble
    error: Array


    @property
    def of_ensemble(self) -> Array:
        """Error of each exponent where all points are runs of one operating point.

        The median: in chaos some runs diverge from their finer ones within the test run.
        """
        seen = self.error[:, np.isfinite(self.error).all(axis=0)]
        return np.median(seen, axis=1) if seen.size else np.zeros(len(self.error))


def tuned(ensemble: Ensemble, wanted: tuple[float, float] = COARSE, *, returns: bool = False) -> Tuned:
    """Choose how the tangent vectors of every point are carried from its present state on.

    Parameters
    ----------
    ensemble : Ensemble
        On its attractor, with tangent vectors; stays as it is.
    wanted : tuple of float
        Largest error of the steps, over the exponent and over one growth in a T: `FINE` or `COARSE`.
    returns : bool
        Whether the motion returns. Then errors at corners of the rates are the same in every round; else they are scatter,
        which the record itself shows.
    """
    steps, n = ensemble.point_steps.copy(), ensemble.points
    orth, error = np.ones(n, dtype=np.int64), np.full((ensemble.tangents, n), np.nan)
    left = np.flatnonzero(ensemble.running)
    for doubling in range(DOUBLINGS + 1):
        if not left.size:
            break
        coarse, finer = _trial(ensemble, left, steps[left])
        found = np.abs((finer - coarse).mean(axis=0)) / ensemble.period[left]
        size = np.abs(finer.mean(axis=0)) / ensemble.period[left]
        with np.errstate(invalid="ignore"):
            good = (found <= wanted[0] * size + wanted[1] / ensemble.period[left]).all(axis=0)
            falls = (found < np.maximum(error[:, left] / LEFT / STALLED, found.max(axis=0) / 1e3)).all(axis=0)
        seen, before = np.isfinite(found).all(axis=0), np.isfinite(error[:, left]).all(axis=0)
        # Where the error does not fall as it should, the rates have corners: more steps cost more than they bring.
        stalled = seen & before & ~falls
        takes = seen & ~stalled
        steps[left[stalled]] //= 2
        error[:, left[takes]] = LEFT * found[:, takes]
        if not returns:
            error[:, left[stalled]] = 0.0
        orth[left[seen]] = _needed(finer[..., seen], steps[left[seen]])
        # Where a test run ends, its steps are too long for the motion itself.
        stay = ((takes & ~good) | ~seen) & (2 * steps[left] <= MOST) & (doubling < DOUBLINGS)
        left = left[stay]
        steps[left] *= 2
    everything = np.arange(n)
    return Tuned(ensemble.subset(everything, steps=steps, orth=orth), error)


def _trial(ensemble: Ensemble, points: NDArray[np.intp], steps: Integers) -> tuple[Array, Array]:
    """Growth of the vectors in each T of a test run with these steps, and with twice as many, shape (T, vector, point).

    In each T both begin at the same states and vectors: in chaos they would diverge, and show that instead of their errors.
    """
    coarse, finer = (ensemble.subset(points, steps=n, orth=n) for n in (steps, 2 * steps))
    growths = []
    for _ in range(TRIAL):
        finer.copy_states(coarse)
        growths.append([part.advance(1).growth[0] for part in (coarse, finer)])
    both = np.array(growths)
    both[..., ~(coarse.running & finer.running)] = np.nan
    return both[:, 0], both[:, 1]


def _needed(growth: Array, steps: Integers) -> Integers:
    """Orthonormalisations per T, a divisor of the steps."""
    with np.errstate(invalid="ignore"):
        apart = np.maximum(np.ptp(growth, axis=1), np.abs(growth).max(axis=1) / 16).max(axis=0)
    need = np.where(np.isfinite(apart), np.ceil(apart / APART), 1.0)
    out = steps.copy()
    for k, (most, least) in enumerate(zip(steps, need, strict=True)):
        out[k] = next((q for q in range(int(max(least, 1)), int(most)) if most % q == 0), most)
    return out
