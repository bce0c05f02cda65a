"""Proof of returns: the motion that returned lies on an orbit that attracts, and what is left of its way there is small.

A section returns within any tolerance where the motion hardly moves: on its way along a slow direction, whose change hides
below that of faster ones, or while it leaves an orbit that repels slowly. Near a period doubling such a motion alternates
for thousands of periods, and would be called 2T. The tangent vectors of one return tell: whether the orbit attracts, and
what is left of the way to it (`variational.monodromy.go_round`).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.steady.settled import Settled
from whirlmap.analysis.variational.monodromy import go_round
from whirlmap.integrate.ensemble import Ensemble

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Points = NDArray[np.intp]

#: Change over a return that is rounding: it tells nothing of the way that is left.
ROUNDING = 1e-12
#: Distance of the largest multiplier from one within which it tells neither attraction nor repulsion: of motions without
#: damping.
NEUTRAL = 1e-6
#: What a motion grows to, over the tolerance, before it is asked again whether it returns.
LEAVES = 10.0


@dataclass(frozen=True)
class Unproved:
    """Points whose return is no proof, in the order of ``points``.

    Attributes
    ----------
    points : array of int
    strict : array
        Part of the tolerance within which a return will be one: for those that approach slowly.
    ahead : array of int
        Common periods in which those that leave their orbit grow beyond the tolerance; zero for the others.
    """

    points: Points
    strict: Array
    ahead: Integers


def unproved(
    ensemble: Ensemble, settled: Settled, points: Points, tolerance: float, cyclic: dict[int, float], longest: Integers
) -> Unproved:
    """Find points whose return does not stand.

    Parameters
    ----------
    ensemble : Ensemble
        Without tangent vectors, at phase zero. It stays as it is.
    settled : Settled
        How its points settled.
    points : array of int
        Points that are asked; those that have not returned, or were proved by their multipliers already, are left out.
    longest : array of int, shape (all points,)
        Common periods after which each is given up.

    Notes
    -----
    An orbit that sticks to a surface, or ends within its return, has no multipliers: its return stands.
    """
    asked = points[(settled.multiple[points] > 0) & ~settled.accelerated[points] & ensemble.running[points]]
    if not asked.size:
        return Unproved(asked, np.ones(0), np.zeros(0, dtype=np.int64))
    multiple = settled.multiple[asked]
    went = go_round(ensemble, asked, multiple, cyclic=cyclic)
    change, left = (np.abs(way / settled.scale[:, asked]).max(axis=0) for way in (went.change, went.left))
    mu = went.largest
    known = np.isfinite(mu) & (change > ROUNDING) & (np.abs(1 - mu) > NEUTRAL)
    with np.errstate(divide="ignore", invalid="ignore"):
        slow = known & (mu < 1) & (left > tolerance)
        leaves = known & (mu > 1)
        strict = np.where(slow, np.maximum(change / left, ROUNDING / tolerance), 1.0)
        returns = np.log(np.maximum(LEAVES * tolerance / change, 1.0)) / np.log(mu)
    ahead = np.where(leaves, np.ceil(np.where(leaves, returns, 0.0)) * multiple, 0)
    ahead = np.minimum(ahead, longest[asked]).astype(np.int64)
    which = np.flatnonzero(slow | leaves)
    return Unproved(asked[which], strict[which], ahead[which])
