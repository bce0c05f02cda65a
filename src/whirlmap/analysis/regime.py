"""The regime of operating points from independent indicators, each of which has a vote; where they disagree: undecided.

1. A run that ended says contact or diverged by itself.
2. ``periodic`` needs a return of the section, and no indicator that speaks for chaos.
3. ``quasi-periodic`` needs a largest exponent that is zero and Birkhoff averages that converge as on a torus.
4. ``chaotic`` needs a positive exponent and one more indicator: the 0-1 test or the Birkhoff averages.
5. One vote against, and the point is ``undecided``.

Only points that do not return need more than the return; for them one run with a tangent vector gives the exponent and
the section points for all the rest.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from whirlmap.analysis.evidence import LEAST, SectionEvidence, section_evidence, windings_of
from whirlmap.analysis.winding import Winding
from whirlmap.results.findings import Findings, gives_dataset
from whirlmap.results.regime import Regime
from whirlmap.results.schema import regime_variable, variable
from whirlmap.results.status import Status, flags

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

#: Growth of tangent vectors, beyond the logarithm of the number of periods, that is still compatible with none: on a
#: torus with shear they grow in proportion to time, and breathe.
BREATHING = 3.0
#: K of the 0-1 test above and below which it has a say (medians and the quartile on the side of doubt).
WANDERS, BOUNDED = (0.9, 0.5), (0.3, 0.2)
#: Digits of Birkhoff averages above which motion is smooth, and below which it may be chaotic.
SMOOTH, ROUGH = 6.0, 2.5
#: Error of a rotation number below which it is one, and above which there is none.
TURNS, WANDERING = 2e-5, 1e-4
#: Errors of a rotation number, and largest denominator, within which a ratio may be hops between bands.
HOPS, BANDS = 10.0, 32


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
    section : SectionEvidence
    winding : tuple of Winding
    """

    status: NDArray[np.int8]
    multiple: NDArray[np.int64]
    exponent: Array
    exponent_error: Array
    duration: Array
    section: SectionEvidence
    winding: tuple[Winding, ...]


@gives_dataset
def regime(
    status: ArrayLike,
    multiple: ArrayLike,
    *,
    exponent: ArrayLike,
    exponent_error: ArrayLike,
    duration: ArrayLike,
    section: Array | None = None,
    cyclic: Mapping[int, float] | None = None,
) -> Findings:
    """Label operating points, with the vote of every indicator.

    Parameters
    ----------
    status, multiple, exponent, exponent_error, duration : array, shape (point,)
        As in `Evidence`.
    section : array, shape (time, state, point), optional
        Section points once per common period, or crossings; the columns of points that return are not looked at.
    cyclic : mapping of state index to period, optional

    Returns
    -------
    xr.Dataset
        As `decide`.
    """
    where = np.atleast_1d(np.asarray(status, dtype=np.int8))
    returns = np.atleast_1d(np.asarray(multiple, dtype=np.int64))
    open_points = np.flatnonzero((where == Status.ok) & (returns == 0))
    if section is None:
        section = np.zeros((0, 1, where.size))
    judged = section_evidence(section[:, :, open_points], cyclic=cyclic)
    full = {n: np.full(where.size, np.nan) for n in ("growth", "growth_low", "digits")}
    for name, values in full.items():
        values[open_points] = getattr(judged, name)
    windings = [Winding(np.nan, np.nan, "not-finite")] * where.size
    for k, winding in zip(open_points, windings_of(section[:, :, open_points], cyclic), strict=True):
        windings[k] = winding
    given = (exponent, exponent_error, duration)
    value, error, time = (np.broadcast_to(np.asarray(v, dtype=float), where.shape) for v in given)
    said = SectionEvidence(**full, points=section.shape[0])
    return decide(Evidence(where, returns, value, error, time, said, tuple(windings)))


def decide(evidence: Evidence) -> Findings:
    """Combine the votes of the indicators.

    Returns
    -------
    Findings
        Over ``point``: ``regime``; ``confidence``, the share of the indicators asked that speak for the label (1 for
        ended runs, 0 for undecided); ``vote(indicator, point)``; the numbers ``zero_one``, ``zero_one_low``, ``digits``,
        ``winding`` and ``winding_error``.

    Notes
    -----
    A zero exponent is one whose total growth, exponent x duration, stays below ln(periods) + 3: distances on a torus grow in
    proportion to time. They do not shrink: one below zero by three errors is no zero, and a sure fall below -3 contracts.
    Narrow bands of chaos hop round a cycle with a rational rotation number to many digits, so that a number within ten
    errors of a ratio with a denominator up to 32 does not speak for a torus. A section that turns slowly (oversampled)
    gives the 0-1 test no say.

    Limits: a torus about to break up, and chaos whose exponent is below 10 / duration, are undecided. A transient longer
    than the run is what it looks like.
    """
    votes = np.stack([_return_votes(evidence), _exponent_votes(evidence), _zero_one_votes(evidence), _birkhoff(evidence)])
    chaotic, torus = votes == Vote.chaotic, votes == Vote.torus
    returned = evidence.multiple > 0
    stable = (votes == Vote.periodic)[1]
    neutral = (votes == Vote.regular)[1]
    label = np.full(evidence.status.size, Regime.undecided, dtype=np.int8)
    label[returned & ~chaotic.any(axis=0)] = Regime.periodic
    against_chaos = (torus | (votes == Vote.regular) | (votes == Vote.periodic)).any(axis=0)
    label[~returned & chaotic[1] & (chaotic.sum(axis=0) >= 2) & ~against_chaos] = Regime.chaotic
    label[~returned & neutral & torus[3] & ~chaotic.any(axis=0) & ~stable] = Regime.quasi_periodic
    asked = np.ones_like(votes, dtype=bool)
    asked[1] = np.isfinite(evidence.exponent)
    asked[2:] = np.isfinite(np.stack([evidence.section.growth, evidence.section.digits]))
    asked[0] = returned  # that nothing returned is the occasion for the others, not a vote
    speaks = torus | (votes == Vote.regular)
    speaks = np.where(label == Regime.periodic, votes == Vote.periodic, speaks)
    speaks = np.where(label == Regime.chaotic, chaotic, speaks)
    confidence = (speaks & asked).sum(axis=0) / np.maximum(asked.sum(axis=0), 1)
    confidence[label == Regime.undecided] = 0.0
    for status, ended in ((Status.contact, Regime.contact), (Status.diverged, Regime.diverged)):
        label[evidence.status == status], confidence[evidence.status == status] = ended, 1.0
    other = ~np.isin(evidence.status, (Status.ok, Status.contact, Status.diverged))
    label[other], confidence[other] = Regime.undecided, 0.0
    s, w = evidence.section, evidence.winding
    return Findings(
        {
            "regime": regime_variable("point", label),
            "confidence": variable("point", confidence, "1", "share of the indicators asked that speak for the label"),
            "vote": variable(("indicator", "point"), votes.astype(np.int8), "1", "vote of each indicator", **flags(Vote)),
            "zero_one": variable("point", s.growth, "1", "K of the 0-1 test"),
            "zero_one_low": variable("point", s.growth_low, "1", "its lower quartile over angles"),
            "digits": variable("point", s.digits, "1", "digits to which Birkhoff averages converge"),
            "winding": variable("point", [v.number for v in w], "1", "rotation number of the section, turns per point"),
            "winding_error": variable("point", [v.error for v in w], "1", "its error"),
        },
        {"indicator": ("indicator", list(INDICATORS))},
    )


def _return_votes(e: Evidence) -> NDArray[np.int64]:
    return np.where(e.multiple > 0, Vote.periodic, Vote.none)


def _exponent_votes(e: Evidence) -> NDArray[np.int64]:
    """Chaotic, periodic (contracting) or regular (zero) by the total growth of tangent vectors."""
    with np.errstate(invalid="ignore", divide="ignore"):
        grown = e.exponent * e.duration
        limit = np.log(np.maximum(e.section.points, LEAST)) + BREATHING
        sure = np.abs(e.exponent) > 3 * e.exponent_error
        vote = np.where((np.abs(grown) < limit) & ~(sure & (grown < 0)), Vote.regular, Vote.none)
        vote = np.where(sure & (grown >= limit), Vote.chaotic, vote)
        return np.where(contracts(e.exponent, e.exponent_error, e.duration), Vote.periodic, vote)


def contracts(exponent: Array, error: Array, duration: Array) -> NDArray[np.bool_]:
    """Whether tangent vectors have shrunk for sure.

    Shear makes neutral ones longer, never shorter: what shrinks by more than they breathe is contracting.
    """
    with np.errstate(invalid="ignore"):
        shrunk: NDArray[np.bool_] = (np.abs(exponent) > 3 * error) & (exponent * duration <= -BREATHING)
    return shrunk


def _zero_one_votes(e: Evidence) -> NDArray[np.int64]:
    K, low = e.section.growth, e.section.growth_low
    with np.errstate(invalid="ignore"):
        vote = np.where((WANDERS[0] < K) & (low > WANDERS[1]), Vote.chaotic, Vote.none)
        return np.where((BOUNDED[0] > K) & (low < BOUNDED[1]), Vote.regular, vote)


def _birkhoff(e: Evidence) -> NDArray[np.int64]:
    vote = np.full(e.status.size, Vote.none, dtype=np.int64)
    for k, (digits, w) in enumerate(zip(e.section.digits, e.winding, strict=True)):
        if not np.isfinite(digits):
            continue
        turns = w.status == "ok" and w.error < TURNS
        near = max(HOPS * w.error, 1e-9)
        hops = turns and any(abs(w.number - round(w.number * q) / q) <= near for q in range(1, BANDS + 1))
        if (turns and not hops) or digits > SMOOTH:
            vote[k] = Vote.torus
        elif digits < ROUGH and not (w.status == "ok" and w.error < WANDERING and not hops):
            vote[k] = Vote.chaotic
    return vote
