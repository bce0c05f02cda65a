"""Judgement of every statement of the paper about its results: a verdict and a score.

The statements are data (`claims.toml`); each has one function here, found by its id, that judges many parameter sets at
once. `reproduce` asks them about one machine, `identify` about thousands. "Almost all" is taken as `ALMOST_ALL`, a claim
that is met by at least `PARTLY` of its speeds holds partly. "Period 8T" is read as the period of the forcing, which 8T is
in the paper's clock.

A score lies in [0, 1], is 1 exactly where the claim holds, and grows towards it: it leads a search, and decides nothing.
"""

import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib.resources import files

import numpy as np
from numpy.typing import NDArray
from scipy.stats import rankdata

from whirlmap.results.regime import WITHOUT_BOUND, Regime
from whirlmap.studies.gear_psfd.claims.labelled import PSI, Array, Labelled, Mask, median_of, positive
from whirlmap.studies.gear_psfd.claims.thresholds import (
    ALMOST_ALL,
    BROADBAND,
    DIMENSION_ERRORS,
    GROWS,
    LARGER,
    LEAST_SPEEDS,
    MANY_LINES,
    PARTLY,
    SMALLER,
    THREE_WINDOWS,
    WINDOWS,
    chaotic_windows,
    windows_of,
)

#: Verdicts by their number.
WORDS = ("fails", "partly", "holds", "cannot be evaluated")
FAILS, PARTLY_HOLDS, HOLDS, UNKNOWN = range(4)

#: Largest score of a claim that does not hold.
NEARLY = 0.95


@dataclass(frozen=True)
class Claim:
    """One statement of the paper; ``title`` says it in a few words, ``figures`` are those that it is about, if any."""

    id: str
    title: str
    where: str
    says: str
    measure: str
    figures: Sequence[int] = ()
    psi: float | None = None
    value: float | None = None


@dataclass(frozen=True)
class Judgement:
    """What was found about one claim, arrays of shape (set,): number of the word in `WORDS`, and score."""

    word: NDArray[np.int8]
    score: Array


def claims() -> tuple[Claim, ...]:
    """All statements, in the paper's order."""
    text = files("whirlmap.studies.gear_psfd").joinpath("claims.toml").read_text(encoding="utf-8")
    return tuple(Claim(**entry) for entry in tomllib.loads(text)["claim"])


def judge_all(d: Labelled) -> dict[str, Judgement]:
    """Judge every statement, for every parameter set."""
    return {claim.id: JUDGES[claim.id](d, claim) for claim in claims()}


def _judgement(word: NDArray[np.integer], near: Array) -> Judgement:
    near = np.clip(np.nan_to_num(near), 0.0, 1.0)
    return Judgement(word.astype(np.int8), np.where(word == HOLDS, 1.0, NEARLY * near))


def _words(share: Array) -> NDArray[np.int64]:
    """Return the verdicts on a claim about "almost all" speeds."""
    return np.where(share >= ALMOST_ALL, HOLDS, np.where(share >= PARTLY, PARTLY_HOLDS, FAILS))


def _nearness(d: Labelled, psi: int, wanted: str, where: Mask) -> Array:
    """Mean credit of a window, of which `ALMOST_ALL` is enough."""
    credit = d.credit(wanted)[:, psi][:, where]
    return np.minimum(credit.mean(axis=-1) / ALMOST_ALL, 1.0) if where.any() else np.zeros(len(credit))


def nonperiodic(d: Labelled, _claim: Claim) -> Judgement:
    """Share of speeds without a return at psi = 0; contact and divergence are no motion at all."""
    everywhere = np.ones(d.s.size, dtype=bool)
    word = np.where(d.ended[:, 0].all(axis=-1), UNKNOWN, _words(d.share(d.open[:, 0], everywhere)))
    return _judgement(word, _nearness(d, 0, "open", everywhere))


def rank_correlation(d: Labelled) -> Array:
    """Spearman's correlation of amplitude and speed at psi = 0; NaN where it cannot be had."""
    pp = d.amplitude[:, 0]
    ok = np.isfinite(pp)
    usable = (ok.sum(axis=-1) >= LEAST_SPEEDS) & (np.ptp(np.where(ok, pp, median_of(pp, ok)[:, None]), axis=-1) > 0)
    out = np.full(len(pp), np.nan)
    if usable.any():
        ok, pp = ok[usable], pp[usable]
        both = (np.where(ok, v, np.nan) for v in (pp, np.broadcast_to(d.s, pp.shape)))
        ranks = [np.asarray(rankdata(v, axis=-1, nan_policy="omit")) for v in both]
        a, b = (np.where(ok, r - np.nanmean(r, axis=-1, keepdims=True), 0.0) for r in ranks)
        out[usable] = (a * b).sum(axis=-1) / np.sqrt((a**2).sum(axis=-1) * (b**2).sum(axis=-1))
    return out


def amplitude_grows(d: Labelled, _claim: Claim) -> Judgement:
    """Rank correlation of the amplitude with the speed."""
    rank = rank_correlation(d)
    with np.errstate(invalid="ignore"):
        word = np.where(rank > GROWS[1], HOLDS, np.where(rank > GROWS[0], PARTLY_HOLDS, FAILS))
    return _judgement(np.where(np.isnan(rank), UNKNOWN, word), (rank + 1) / 1.8)


def window(psi: float, low: float, high: float, kind: str) -> Callable[[Labelled, Claim], Judgement]:
    """Judge a window of speeds by the share of one kind in it."""
    at = PSI.index(psi)

    def judged(d: Labelled, _claim: Claim) -> Judgement:
        where = d.between(low, high)
        word = _words(d.share(d.kinds[kind][:, at], where)) if where.any() else np.full(len(d.regime), UNKNOWN)
        return _judgement(word, _nearness(d, at, kind, where))

    return judged


def own_windows(d: Labelled, k: int) -> dict[str, Callable[[Labelled, Claim], Judgement]]:
    """Claims that one set of some diagrams makes true: at each psi, each stretch of equal kind as a window.

    With these a search can be tested: the machine that they come from satisfies all of them.
    """
    out = {}
    for p, psi in enumerate(PSI):
        kind = np.array([next((name for name, m in d.kinds.items() if m[k, p, i]), "") for i in range(d.s.size)])
        begins = np.flatnonzero(np.r_[True, kind[1:] != kind[:-1]])
        for a, b in zip(begins, [*begins[1:], d.s.size], strict=True):
            low, high = float(d.s[a]), float(d.s[b - 1])
            if kind[a]:  # a run that failed says nothing
                out[f"psi {psi:g}, s {low:g} .. {high:g}: {kind[a]}"] = window(psi, low, high, str(kind[a]))
    return out


def large_amplitude(d: Labelled, _claim: Claim) -> Judgement:
    """Amplitude in 1.48 .. 1.60 against the rest of the window."""
    at = PSI.index(1e-4)
    inside, rest = chaotic_windows(d)
    pp, chaotic = d.amplitude[:, at], d.kinds["chaotic"][:, at]
    a, b = median_of(pp, inside), median_of(pp, rest)
    with np.errstate(invalid="ignore", divide="ignore"):
        larger, ratio = a > LARGER * b, np.minimum(a / (LARGER * b), 1.0)
    word = np.where(larger & (chaotic & inside).any(axis=-1), HOLDS, FAILS)
    word = np.where((chaotic & (inside | rest)).any(axis=-1), word, UNKNOWN)
    credit = d.credit("chaotic")[:, at]
    best = np.where(inside, credit, 0.0).max(axis=-1, initial=0.0)
    return _judgement(word, 0.5 * np.nan_to_num(ratio) + 0.5 * best)


def three_windows(psi: float) -> Callable[[Labelled, Claim], Judgement]:
    """Chaos at 1.60 .. 1.62 and above 3.15, the period of the forcing elsewhere."""
    at = PSI.index(psi)

    def judged(d: Labelled, _claim: Claim) -> Judgement:
        met = np.stack([_words(d.share(d.kinds[kind][:, at], where)) for kind, where in windows_of(d)])
        near = np.stack([_nearness(d, at, kind, where) for kind, where in windows_of(d)])
        return _judgement(np.where((met == met[0]).all(axis=0), met[0], PARTLY_HOLDS), near.mean(axis=0))

    return judged


def lyapunov_positive(d: Labelled, _claim: Claim) -> Judgement:
    """Largest exponent at s = 3.27 for every psi, above zero or not."""
    o = d.orbits
    votes = positive(o.exponent, o.error, o.least)
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        z = np.clip(np.nan_to_num(o.exponent / o.error), -30, 30)
    asked = np.isfinite(o.exponent) | (o.regime == Regime.periodic)  # a stable cycle has no positive exponent
    word = np.where((votes & asked).all(axis=-1), HOLDS, np.where(votes.any(axis=-1), PARTLY_HOLDS, FAILS))
    near = np.where(np.isfinite(o.exponent), 0.2 + 0.75 / (1 + np.exp(-(z - 3))), 0.1 * asked)
    return _judgement(np.where(asked.any(axis=-1), word, UNKNOWN), np.where(votes, 1.0, near).mean(axis=-1))


def dimension(coordinate: str) -> Callable[[Labelled, Claim], Judgement]:
    """D2 of the section in the plane (y, y'), within two errors of the paper's number at any psi.

    Asked of motions that could have one: none that returns, ended, or is a torus, whose dimension is a whole number. It
    fails where all of these have another dimension, and cannot be evaluated where one has none that is known.
    """

    def judged(d: Labelled, claim: Claim) -> Judgement:
        assert claim.value is not None
        value, error = d.orbits.dimension[coordinate]
        with np.errstate(invalid="ignore"):
            met = np.abs(value - claim.value) <= DIMENSION_ERRORS * error
            near = np.nan_to_num(np.exp(-0.5 * ((value - claim.value) / (2 * error + 0.1)) ** 2))
        whole = (Regime.periodic, Regime.quasi_periodic, Regime.contact, *WITHOUT_BOUND)
        asked = ~np.isin(d.orbits.regime, whole)
        decided = asked.any(axis=-1) & (np.isfinite(value) | ~asked).all(axis=-1)
        word = np.where((met & asked).any(axis=-1), HOLDS, np.where(decided, FAILS, UNKNOWN))
        return _judgement(word, near.max(axis=-1))

    return judged


def spectrum(d: Labelled, _claim: Claim) -> Judgement:
    """Lines above the floor and broadband power of y_p at s = 3.27."""
    o, asked = d.orbits, np.isfinite(d.orbits.lines)
    with np.errstate(invalid="ignore"):
        many = (o.lines >= MANY_LINES) | (o.broadband >= BROADBAND)
        near = np.nan_to_num(np.minimum(np.fmax(o.lines / MANY_LINES, o.broadband / BROADBAND), 1.0))
    word = np.where((many | ~asked).all(axis=-1), HOLDS, np.where(many.any(axis=-1), PARTLY_HOLDS, FAILS))
    return _judgement(np.where(asked.any(axis=-1), word, UNKNOWN), near.mean(axis=-1))


def without_return(d: Labelled) -> Array:
    """Share of speeds that do not return, or end, shape (set, psi)."""
    return np.asarray((d.open | d.ended).mean(axis=-1))


def regularises(d: Labelled, _claim: Claim) -> Judgement:
    """Share of speeds that do not return, or end, against psi: it must never rise, and fall in all."""
    shares = without_return(d)
    never = (np.diff(shares, axis=-1) <= 1e-12).all(axis=-1)
    less = shares[:, -1] < shares[:, 0]
    word = np.where(never & less, HOLDS, np.where(less, PARTLY_HOLDS, FAILS))
    soft = np.where(d.ended, 1.0, d.credit("open")).mean(axis=-1)
    rises = np.maximum(np.diff(soft, axis=-1), 0.0).sum(axis=-1)
    near = 0.5 + (soft[:, 0] - soft[:, -1]) / 2 - rises / 2
    return _judgement(np.where((shares == 1.0).all(axis=-1), UNKNOWN, word), near)


def suppressed(d: Labelled) -> tuple[Mask, Array, Array]:
    """Speeds that run through at every psi; median amplitude there at each psi; share of them where it is smaller."""
    shared: Mask = np.asarray(np.isfinite(d.amplitude).all(axis=1))
    median = median_of(d.amplitude, shared[:, None, :])
    with np.errstate(invalid="ignore"):
        less = (d.amplitude[:, -1] < d.amplitude[:, 0]) & shared
    return shared, median, np.asarray(less.sum(axis=-1) / np.maximum(shared.sum(axis=-1), 1))


def suppresses(d: Labelled, _claim: Claim) -> Judgement:
    """Amplitude against psi, at the speeds that all permeabilities run through."""
    shared, median, less = suppressed(d)
    with np.errstate(invalid="ignore", divide="ignore"):
        word = np.where((median[:, -1] < SMALLER * median[:, 0]) & (less > PARTLY), HOLDS, FAILS)
        ratio = np.nan_to_num(np.minimum(SMALLER * median[:, 0] / median[:, -1], 1.0))
    enough = shared.sum(axis=-1) >= LEAST_SPEEDS
    near = np.where(enough, 0.5 * ratio + 0.5 * np.minimum(less / PARTLY, 1.0), 0.1 * shared.sum(axis=-1) / LEAST_SPEEDS)
    return _judgement(np.where(enough, word, UNKNOWN), near)


def calm_and_rough(d: Labelled) -> tuple[Mask, Array, Array]:
    """Whether there are periodic speeds and others to choose from; median amplitude of both; shape (set, psi)."""
    safe = d.regime == Regime.periodic
    moving = ~safe & np.isfinite(d.amplitude)
    return safe.any(axis=-1) & moving.any(axis=-1), median_of(d.amplitude, safe), median_of(d.amplitude, moving)


def safe_speeds(d: Labelled, _claim: Claim) -> Judgement:
    """Are there speeds to choose, and does choosing them lower the amplitude."""
    choice, calm, rough = calm_and_rough(d)
    with np.errstate(invalid="ignore", divide="ignore"):
        lowered = choice & (calm < rough)
        ratio = np.where(choice, np.minimum(rough / calm, 1.0), 0.0)
    word = np.where((lowered | ~choice).all(axis=-1), HOLDS, np.where(lowered.any(axis=-1), PARTLY_HOLDS, FAILS))
    near = ratio.sum(axis=-1) / np.maximum(choice.sum(axis=-1), 1)
    return _judgement(np.where(choice.any(axis=-1), word, UNKNOWN), near)


JUDGES: dict[str, Callable[[Labelled, Claim], Judgement]] = {
    "fig2-nonperiodic": nonperiodic,
    "fig2-amplitude-grows": amplitude_grows,
    "fig3-low-8T": window(*WINDOWS["fig3-low-8T"]),
    "fig3-chaos-window": window(*WINDOWS["fig3-chaos-window"]),
    "fig3-large-amplitude": large_amplitude,
    "fig3-mid-8T": window(*WINDOWS["fig3-mid-8T"]),
    "fig3-high-chaos": window(*WINDOWS["fig3-high-chaos"]),
    "fig4-windows": three_windows(THREE_WINDOWS["fig4-windows"]),
    "fig5-windows": three_windows(THREE_WINDOWS["fig5-windows"]),
    "fig67-lyapunov": lyapunov_positive,
    "fig6-dimension-yp": dimension("yp"),
    "fig7-dimension-y2": dimension("y2"),
    "fig67-spectrum": spectrum,
    "permeability-regularises": regularises,
    "permeability-suppresses-amplitude": suppresses,
    "safe-speeds": safe_speeds,
}

#: Claims that need more of a motion than its label: its section, or its spectrum.
NEED_ORBIT = ("fig6-dimension-yp", "fig7-dimension-y2", "fig67-spectrum")
