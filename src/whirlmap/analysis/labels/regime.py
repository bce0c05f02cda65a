"""The rule: the regime of operating points from independent indicators, each of which has a vote.

1. A run that ended says contact or diverged by itself.
2. ``periodic`` needs a return of the section, and no indicator that speaks for chaos.
3. ``quasi-periodic`` needs a largest exponent that is zero and Birkhoff averages that converge as on a torus; where they do
   so slowly, only the longest run is enough.
4. ``chaotic`` needs a positive exponent and one more indicator: the 0-1 test or the Birkhoff averages; after the longest
   run a growth that goes on as fast to its end is enough where these are silent.
5. ``locked`` needs a negative exponent, where the forcing has no common period to return after, and a run in which all of a
   start has died out, or averages that converge.
6. One vote against, and the point is ``undecided``.

An exponent that lies more than three errors from zero is not zero, however little it has grown: what contracts is no torus.
Only growth may be shear: distances on a torus grow in proportion to time, and their growth comes to an end.
"""

from collections.abc import Mapping
from enum import IntEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from whirlmap.analysis.indicators.birkhoff import RotationNumber
from whirlmap.analysis.indicators.section_coordinates import Watch, rotation_numbers_of
from whirlmap.analysis.indicators.section_indicators import LEAST, SMOOTH, evidence_of
from whirlmap.analysis.labels.forgetting import FORGOTTEN
from whirlmap.analysis.labels.votes import INDICATORS, Evidence, Vote, grows_plainly, rests, sure_of_zero, votes_of
from whirlmap.results.findings import Findings, gives_dataset
from whirlmap.results.regime import Regime
from whirlmap.results.schema import regime_variable, variable
from whirlmap.results.status import Status, flags

Array = NDArray[np.float64]


class Rule(IntEnum):
    """The rule that decided, or what is known of a point without a label."""

    none = 0
    returns = 1
    smooth = 2
    slowly_smooth = 3
    exponent_and_section = 4
    exponent_alone = 5
    closed_orbit = 6
    contracts = 7
    regular = 8
    disagreement = 9
    end = 10
    trend = 11
    forgotten = 12

    @property
    def meaning(self) -> str:
        """The rule in words."""
        return {
            Rule.none: "nothing speaks clearly",
            Rule.returns: "the section returns",
            Rule.smooth: "a zero exponent, averages that converge to six digits",
            Rule.slowly_smooth: "a zero exponent, averages that converge slowly over the longest run",
            Rule.exponent_and_section: "a positive exponent, a section that wanders",
            Rule.exponent_alone: "an exponent that is sure over the longest run, a section that does not say",
            Rule.closed_orbit: "a closed orbit with all multipliers inside the circle, which the motion comes nearer to",
            Rule.contracts: "contracts",
            Rule.regular: "regular: a torus, or a long period",
            Rule.disagreement: "indicators disagree",
            Rule.end: "the run ended",
            Rule.forgotten: "contracts so long that nothing is left of the start",
            Rule.trend: "the motion comes to rest, grows, drifts or creeps steadily",
        }[self]


#: Section points, once per common period, from which a rotation number is sought; what is said where there are fewer.
TURNED, UNKNOWN = 128, RotationNumber(np.nan, np.nan, "not-finite")


@gives_dataset
def regime(
    status: ArrayLike,
    multiple: ArrayLike,
    *,
    exponent: ArrayLike,
    exponent_error: ArrayLike,
    duration: ArrayLike,
    late_growth: ArrayLike | None = None,
    section: Array | None = None,
    common: int = 1,
    cyclic: Mapping[int, float] | None = None,
    final: bool = True,
    returns: bool = True,
) -> Findings:
    """Label operating points, with the vote of every indicator.

    Parameters
    ----------
    status, multiple, exponent, exponent_error, duration : array, shape (point,)
        As in `Evidence`.
    late_growth : array, shape (point,), optional
        As there; half of the growth where absent.
    section : array, shape (time, state, point), optional
        Section points once per T, or crossings; the columns of points that return are not used.
    common : int
        Number of T after which the forcing repeats.
    cyclic : mapping of state index to period, optional
    final, returns : bool
        As in `Evidence`.

    Returns
    -------
    xr.Dataset
        As `decide`.
    """
    where = np.atleast_1d(np.asarray(status, dtype=np.int8))
    multiples = np.atleast_1d(np.asarray(multiple, dtype=np.int64))
    nonperiodic = np.flatnonzero((where == Status.ok) & (multiples == 0))
    if section is None:
        section = np.zeros((0, 1, where.size))
    seen = section[:, :, nonperiodic]
    judged = evidence_of(Watch(seen, cyclic)(seen, np.arange(nonperiodic.size)), common=common)
    windings = [UNKNOWN] * where.size
    strobed = seen[(section.shape[0] - 1) % common :: common]
    if returns and section.shape[0] >= LEAST and len(strobed) >= TURNED:  # without a common period a section is no curve
        for k, winding in zip(nonperiodic, rotation_numbers_of(strobed, cyclic), strict=True):
            windings[k] = winding
    given = (exponent, exponent_error, duration)
    value, error, time = (np.broadcast_to(np.asarray(v, dtype=float), where.shape) for v in given)
    late = value * time / 2 if late_growth is None else np.broadcast_to(np.asarray(late_growth, dtype=float), where.shape)
    said = judged.spread(nonperiodic, where.size)
    return decide(Evidence(where, multiples, value, error, time, late, said, tuple(windings), final, returns))


def decide(evidence: Evidence) -> Findings:
    """Combine the votes of the indicators.

    Returns
    -------
    Findings
        Over ``point``: ``regime``; ``rule``, which decided (`Rule`); ``confidence``, the share of the indicators asked that
        speak for the label (1 for ended runs, 0 for undecided); ``vote(indicator, point)``; the numbers ``zero_one``,
        ``zero_one_low``, ``digits``, ``rotation_number`` and ``rotation_number_error``.

    Notes
    -----
    The exponent is zero within three errors, or where it has grown by no more than ln(periods) + 3 and that growth comes to
    an end (`_exponent_votes`). Narrow bands of chaos hop round a cycle with a rational rotation number to many digits, so
    that a number within ten errors of a ratio with a denominator up to 32 does not speak for a torus. A section that turns
    slowly (oversampled) gives the 0-1 test no say.

    A torus needs averages that converge: six digits, or a rotation number known to six; or four that have grown by
    one since a quarter of the record. After the longest run fewer digits are enough where they have grown so: digits that
    stand still are chaos, digits that fall a transient. The extents of the first and last third must agree. No rotation
    number may be a ratio with a denominator up to 200 within its error, where that is small enough to say so, and no near
    return of the section may close further (`SectionEvidence.closes`): that is an approach to an orbit of high period.

    Limits: a torus about to break up, and chaos whose exponent is below 10 / duration, are undecided. A transient longer
    than the run is labelled by its appearance.
    """
    votes = votes_of(evidence)
    chaotic, torus = votes == Vote.chaotic, votes == Vote.torus
    returned = evidence.multiple > 0
    stable, neutral = (votes[1] == vote for vote in (Vote.periodic, Vote.regular))
    quiet = ~chaotic.any(axis=0)
    points = evidence.status.size
    label, rule = np.full(points, Regime.undecided, dtype=np.int8), np.full(points, Rule.none, dtype=np.int8)

    def decided(where: NDArray[np.bool_], what: Regime, why: Rule | NDArray[np.int8]) -> None:
        label[where], rule[where] = what, np.broadcast_to(why, where.shape)[where]

    slowly = np.where(evidence.section.digits >= SMOOTH, Rule.smooth, Rule.slowly_smooth).astype(np.int8)
    decided(returned & quiet, Regime.periodic, Rule.returns)
    against_chaos = (torus | (votes == Vote.regular) | (votes == Vote.periodic)).any(axis=0)
    decided(
        ~returned & chaotic[1] & (chaotic.sum(axis=0) >= 2) & ~against_chaos, Regime.chaotic, Rule.exponent_and_section
    )
    decided(~returned & grows_plainly(evidence) & ~against_chaos & (label == 0), Regime.chaotic, Rule.exponent_alone)
    # Where no return can be seen all regular motion has averages that converge: the exponent alone tells torus from locked.
    zero = neutral & (evidence.returns | sure_of_zero(evidence))
    decided(~returned & zero & torus[3] & quiet, Regime.quasi_periodic, slowly)
    sure = neutral & sure_of_zero(evidence) & rests(evidence)
    decided(~returned & sure & (label == 0), Regime.quasi_periodic, Rule.exponent_alone)
    if not evidence.returns:
        with np.errstate(invalid="ignore"):
            forgotten = evidence.exponent * evidence.duration <= np.log(FORGOTTEN)
        why = np.where(forgotten, Rule.forgotten, slowly).astype(np.int8)
        decided(~returned & stable & (forgotten | (quiet & torus[3])), Regime.locked, why)
    known = np.select(
        [returned | (chaotic.any(axis=0) & against_chaos), stable, neutral & quiet & torus[2:].any(axis=0)],
        [Rule.disagreement, Rule.contracts, Rule.regular], Rule.none,
    )  # fmt: skip
    rule[label == Regime.undecided] = known[label == Regime.undecided]
    asked = np.ones_like(votes, dtype=bool)
    asked[1] = np.isfinite(evidence.exponent)
    asked[2:] = np.isfinite(np.stack([evidence.section.growth, evidence.section.digits]))
    asked[0] = returned  # that nothing returned is the occasion for the others, not a vote
    speaks = torus | (votes == Vote.regular)
    speaks = np.where(label == Regime.locked, speaks | (votes == Vote.periodic), speaks)
    speaks = np.where(label == Regime.periodic, votes == Vote.periodic, speaks)
    speaks = np.where(label == Regime.chaotic, chaotic, speaks)
    confidence = (speaks & asked).sum(axis=0) / np.maximum(asked.sum(axis=0), 1)
    confidence[label == Regime.undecided] = 0.0
    for status, ended in ((Status.contact, Regime.contact), (Status.diverged, Regime.diverged)):
        there = evidence.status == status
        label[there], confidence[there], rule[there] = ended, 1.0, Rule.end
    other = ~np.isin(evidence.status, (Status.ok, Status.contact, Status.diverged))
    label[other], confidence[other], rule[other] = Regime.undecided, 0.0, Rule.end
    s, turns, errors = evidence.section, [v.number for v in evidence.winding], [v.error for v in evidence.winding]
    return Findings(
        {
            "regime": regime_variable("point", label),
            "rule": variable("point", rule, "1", "rule that decided", **flags(Rule)),
            "confidence": variable("point", confidence, "1", "share of the indicators asked that speak for the label"),
            "vote": variable(("indicator", "point"), votes.astype(np.int8), "1", "vote of each indicator", **flags(Vote)),
            "zero_one": variable("point", s.growth, "1", "K of the 0-1 test"),
            "zero_one_low": variable("point", s.growth_low, "1", "its lower quartile over angles"),
            "closes": variable("point", s.closes.astype(np.int8), "1", "whether a near return of the section comes nearer"),
            "digits": variable("point", s.digits, "1", "digits to which Birkhoff averages converge"),
            "rotation_number": variable("point", turns, "1", "rotation number of the section, turns per point"),
            "rotation_number_error": variable("point", errors, "1", "its error"),
            "winding": variable("point", turns, "1", "former name of rotation_number, for one release"),
            "winding_error": variable("point", errors, "1", "former name of rotation_number_error, for one release"),
        },
        {"indicator": ("indicator", list(INDICATORS))},
    )
