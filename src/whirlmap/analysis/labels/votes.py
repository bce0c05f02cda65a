"""Votes of the single indicators of a regime: return, exponent, 0-1 test, Birkhoff averages, multipliers."""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.indicators.birkhoff import RotationNumber
from whirlmap.analysis.indicators.section_indicators import LEAST, LEAST_RETURNS, LONG, SLOWLY, SMOOTH, SectionEvidence

Array = NDArray[np.float64]


class Vote(IntEnum):
    """What one indicator says of a point."""

    none = 0
    periodic = 1
    regular = 2
    torus = 3
    chaotic = 4


#: Indicators that vote, in the order in which they stand in Datasets.
INDICATORS = ("return", "exponent", "zero_one", "birkhoff")

#: Errors of an exponent that it must be away from zero to have a sign.
SURE = 3.0
#: Growth of tangent vectors, beyond the logarithm of the number of periods, that is still compatible with none: on a
#: torus with shear they grow in proportion to time, and breathe.
BREATHING = 3.0
#: Part of the growth over a run that its last half has at least where it goes on: half of it, and of shear ln 2 in ln n.
GOES_ON = 0.25
#: Growth over the longest run, beyond the same, that says chaos by itself; part of a steady growth in its last half.
PLAIN, STEADY = 10.0, (0.35, 0.65)
#: K of the 0-1 test above and below which it has a say (medians and the quartile on the side of doubt).
WANDERS, BOUNDED = (0.9, 0.5), (0.3, 0.2)
#: Digits of Birkhoff averages below which motion may be chaotic, and is no torus.
ROUGH = 2.5
#: Digits that the average over a record has more than that over its last quarter, at least, where it converges; and digits
#: in all that are then enough before the longest run.
GAINS, CONVERGES = 1.0, 4.0
#: Largest difference of the extents of the first and last third of a motion that has settled.
UNEVEN = 0.02
#: Error of a rotation number below which it is one, and above which there is none.
TURNS, WANDERING = 2e-5, 1e-4
#: Errors of a rotation number, and largest denominator, within which a ratio may be hops between bands.
HOPS, BANDS = 10.0, 32
#: Largest denominator of a ratio within three errors of which a rotation number may be locked; least error of one.
LOCKED, RATIO = 200, 1e-9
#: Error of a rotation number with which it is no such ratio by chance.
KNOWN = 1e-7


@dataclass(frozen=True)
class Evidence:
    """What is known of operating points, each array of shape (point,); NaN where something was not measured.

    Attributes
    ----------
    status : array of int
        How the run ended (`Status`).
    multiple : array of int
        Return of the section in common periods (crossings), 0 where none.
    exponent, exponent_error : array
        Largest Lyapunov exponent [1/time].
    duration : array
        Time over which it was measured.
    late_growth : array
        Growth of the logarithm of the tangent vector over the last half of it.
    section : SectionEvidence
    winding : tuple of RotationNumber
    final : bool
        Whether this is the longest run.
    returns : bool
        Whether a return could be seen: not where the forcing has no common period.
    """

    status: NDArray[np.int8]
    multiple: NDArray[np.int64]
    exponent: Array
    exponent_error: Array
    duration: Array
    late_growth: Array
    section: SectionEvidence
    winding: tuple[RotationNumber, ...]
    final: bool = True
    returns: bool = True


def votes_of(e: Evidence) -> NDArray[np.int64]:
    """Vote of each of `INDICATORS` on each point, shape (indicator, point)."""
    returned = np.where(e.multiple > 0, Vote.periodic, Vote.none)
    return np.stack([returned, _exponent_votes(e), _zero_one_votes(e), _birkhoff(e)])


def _exponent_votes(e: Evidence) -> NDArray[np.int64]:
    """Chaotic, periodic (contracting) or regular (zero), by sign and growth of tangent vectors."""
    with np.errstate(invalid="ignore", divide="ignore"):
        grown = e.exponent * e.duration
        limit = np.log(np.maximum(e.section.points, LEAST)) + BREATHING
        sure = np.abs(e.exponent) > SURE * e.exponent_error
        # Shear slows down. What grows as fast in both halves, however little, may go on: only the longest run can say.
        share = e.late_growth / grown
        steady = (share > STEADY[0]) & (share < STEADY[1]) & (not e.final)
        shear = (grown > 0) & (grown < limit) & ~steady
        vote = np.where(~sure & (np.abs(grown) < limit), Vote.regular, Vote.none)
        vote = np.where(sure & shear, Vote.regular, vote)
        vote = np.where(sure & (grown >= limit) & (e.late_growth >= GOES_ON * grown), Vote.chaotic, vote)
        return np.where(contracts(e.exponent, e.exponent_error, e.duration, e.late_growth), Vote.periodic, vote)


def contracts(exponent: Array, error: Array, duration: Array, late_growth: Array) -> NDArray[np.bool_]:
    """Whether tangent vectors shrink for sure and persistently: neutral ones shrink while they align."""
    with np.errstate(invalid="ignore"):
        grown = exponent * duration
        shrinks: NDArray[np.bool_] = (exponent < -SURE * error) & (late_growth <= GOES_ON * grown)
    return shrinks


def sure_of_zero(e: Evidence) -> NDArray[np.bool_]:
    """Whether the exponent is zero for sure: its error leaves no room for more than shear."""
    with np.errstate(invalid="ignore"):
        most = (np.abs(e.exponent) + SURE * e.exponent_error) * e.duration
        return np.asarray(most <= np.log(np.maximum(e.section.points, LEAST)) + BREATHING)


def rests(e: Evidence) -> NDArray[np.bool_]:
    """Whether averages and extents are constant after the longest run.

    With an exponent that is zero for sure that says torus: the 0-1 test takes slow beats of many frequencies for chaos, and
    averages over them converge slowly.
    """
    s = e.section
    with np.errstate(invalid="ignore"):
        return np.asarray(e.final & (s.digits >= ROUGH) & ~(s.uneven > UNEVEN) & ~s.closes)


def grows_plainly(e: Evidence) -> NDArray[np.bool_]:
    """Whether the exponent alone says chaos: after the longest run, far beyond shear, and as fast in both halves."""
    if not e.final:
        return np.zeros(e.status.size, dtype=bool)
    with np.errstate(invalid="ignore", divide="ignore"):
        grown = e.exponent * e.duration
        far = grown >= np.log(np.maximum(e.section.points, LEAST)) + PLAIN
        share = e.late_growth / grown
        moves = np.isfinite(e.section.digits)  # not where a motion stands on a place that repels
        return np.asarray(far & (e.exponent > SURE * e.exponent_error) & (share > STEADY[0]) & (share < STEADY[1]) & moves)


def _zero_one_votes(e: Evidence) -> NDArray[np.int64]:
    K, low = e.section.growth, e.section.growth_low
    with np.errstate(invalid="ignore"):
        vote = np.where((WANDERS[0] < K) & (low > WANDERS[1]), Vote.chaotic, Vote.none)
        return np.where((BOUNDED[0] > K) & (low < BOUNDED[1]), Vote.regular, vote)


def _birkhoff(e: Evidence) -> NDArray[np.int64]:
    """Torus where averages converge, chaotic where they do not and no rotation number is known."""
    s = e.section
    number, error = (np.array([getattr(w, name) for w in e.winding], dtype=float) for name in ("number", "error"))
    with np.errstate(invalid="ignore"):
        hops = _near_ratio(number, np.maximum(HOPS * error, RATIO), BANDS)
        locked = _near_ratio(number, np.maximum(SURE * error, RATIO), LOCKED)
        even = (s.digits >= ROUGH) & ~(s.uneven > UNEVEN)
        gains = s.digits >= s.digits_before + GAINS
        torus = (s.digits >= SMOOTH) | ((error <= 10.0**-SMOOTH) & ~hops & ~locked)
        turns = (error < TURNS) & ~hops
        bounded = (s.growth < BOUNDED[0]) & (s.growth_low < BOUNDED[1])
        torus |= (s.points >= LONG) & gains & ((s.digits >= CONVERGES) | ((s.digits >= SLOWLY) & turns & bounded))
        if e.final:
            torus |= turns | (gains & (s.digits >= SLOWLY))
        torus &= even & ~(locked & (error <= KNOWN)) & ~s.closes
        torus &= (s.rounds >= LEAST_RETURNS) | (not e.returns)  # fewer do not show an orbit of high period
        rough = (s.rough < ROUGH) & ~((error < WANDERING) & ~hops) & ~gains
    return np.where(torus, Vote.torus, np.where(rough, Vote.chaotic, Vote.none))


def _near_ratio(number: Array, within: Array, most: int) -> NDArray[np.bool_]:
    """Whether numbers lie within some distance of a ratio with a denominator up to ``most``."""
    q = np.arange(1, most + 1)
    return np.asarray((np.abs(number[:, None] - np.round(number[:, None] * q) / q) <= within[:, None]).any(axis=1))
