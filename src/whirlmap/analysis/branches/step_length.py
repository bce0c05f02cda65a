"""How long the next step along a branch is: by Newton's iterations, and by how straight the branch is."""

import numpy as np

from whirlmap.analysis.branches.corrector import Corrected
from whirlmap.analysis.branches.limits import Limits

#: Iterations at which a step grows, and at which it shrinks.
FEW, MANY = 4, 7
#: Angle between neighbouring tangents up to which a branch is straight.
STRAIGHT = 0.01


def next_step(a: Corrected, b: Corrected, step: float, limits: Limits) -> float:
    """Length of the step from ``b``, after one from ``a``.

    A straight branch, as that of a small vibration whose mean moves by many times its size, is followed by steps that are
    the longest along the free parameters alone.
    """
    longer = 1.5 if b.iterations <= FEW else 0.7 if b.iterations >= MANY else 1.0
    return min(step * longer, limits.longest * _farther(a, b))


def _farther(a: Corrected, b: Corrected) -> float:
    if a.point.x.shape != b.point.x.shape:
        return 1.0
    sizes = a.linear.sizes
    one, other = a.tangent / sizes, b.tangent / sizes
    length = float(np.linalg.norm(other))
    turn = np.arccos(np.clip(one @ other / np.linalg.norm(one) / length, -1.0, 1.0))
    if turn > STRAIGHT:
        return 1.0
    along = float(np.abs(other[-b.point.free.size :]).max()) / length
    return 1 / along if along > 0 else 1.0
