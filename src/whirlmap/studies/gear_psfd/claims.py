"""Every statement of the paper about its results, turned into a number and a verdict.

The statements are data (`claims.toml`); each has one function here, found by its id, that reads the evidence of one
edition. "Almost all" is taken as `ALMOST_ALL`, a claim that is met by at least `PARTLY` of its speeds holds partly.
"Period 8T" is read as the period of the forcing, which 8T is in the paper's clock. A point is called chaotic here where
it does not return and its largest exponent lies three standard errors above zero.
"""

import json
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from importlib.resources import files
from itertools import pairwise
from typing import Literal

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.stats import spearmanr

from whirlmap.analysis.dimension import STATUS as DIMENSION_STATUS
from whirlmap.results.regime import Regime
from whirlmap.studies.gear_psfd.evidence import PSI, Evidence, dimension_text

Word = Literal["holds", "fails", "partly", "cannot be evaluated"]
Mask = NDArray[np.bool_]

#: "Almost all", and the least share at which a claim is met in part.
ALMOST_ALL, PARTLY = 0.9, 0.5
#: Lines above the floor, and share of power beside them, from which a spectrum has "numerous excitation frequencies".
MANY_LINES, BROADBAND = 10, 0.01


@dataclass(frozen=True)
class Claim:
    """One statement of the paper."""

    id: str
    where: str
    says: str
    measure: str
    psi: float | None = None
    value: float | None = None


@dataclass(frozen=True)
class Verdict:
    """A word, and the numbers that decided it."""

    claim: Claim
    word: Word
    found: str


def claims() -> tuple[Claim, ...]:
    """All statements, in the paper's order."""
    text = files("whirlmap.studies.gear_psfd").joinpath("claims.toml").read_text(encoding="utf-8")
    return tuple(Claim(**entry) for entry in tomllib.loads(text)["claim"])


def judge(evidence: Evidence) -> list[Verdict]:
    """Judge every statement by the evidence of one edition."""
    return [Verdict(claim, *JUDGES[claim.id](evidence, claim)) for claim in claims()]


Judgement = tuple[Word, str]


def kinds(ds: xr.Dataset) -> dict[str, Mask]:
    """Which points of a diagram return with the forcing or otherwise, are open (of three kinds), or ended."""
    regime, period = ds["regime"].values, ds["period_T"].values
    forced = ds.attrs["common_multiple"]
    returns = regime == Regime.periodic
    open_motion = regime == Regime.undecided
    grows = open_motion & (ds["lyapunov"].values > 3 * ds["lyapunov_error"].values)
    return {
        "with the forcing": returns & (period == forced),
        "periodic otherwise": returns & (period != forced),
        "quasi-periodic": regime == Regime.quasi_periodic,
        "chaotic": (regime == Regime.chaotic) | grows,
        "undecided": open_motion & ~grows,
        "contact": regime == Regime.contact,
        "diverged": regime == Regime.diverged,
    }


def between(ds: xr.Dataset, low: float, high: float) -> Mask:
    """Points whose speed, in the paper's s, lies in a window (closed, to rounding)."""
    s = ds["paper_s"].values
    return (s >= low - 1e-9) & (s <= high + 1e-9)


def counts(ds: xr.Dataset, where: Mask) -> str:
    """How many points of each kind a window holds, in words."""
    parts = [f"{int((m & where).sum())} {name}" for name, m in kinds(ds).items() if (m & where).any()]
    return f"of {int(where.sum())} speeds: " + (", ".join(parts) or "none")


def by_share(share: float) -> Word:
    """Return the verdict on a claim about "almost all" speeds."""
    return "holds" if share >= ALMOST_ALL else "partly" if share >= PARTLY else "fails"


def _share(wanted: Mask, where: Mask) -> float:
    return float((wanted & where).sum() / max(int(where.sum()), 1))


def amplitude(ds: xr.Dataset, state: str = "yp") -> NDArray[np.float64]:
    """Peak-to-peak of a state over the record, at every speed; NaN where the run ended."""
    span = ds["maximum"] - ds["minimum"]
    return np.asarray(span.sel(quantity=state).values, dtype=float)


def nonperiodic(e: Evidence, _claim: Claim) -> Judgement:
    """Fraction of speeds without a return; contact and divergence are no motion at all."""
    ds = e.diagrams[0.0]
    k = kinds(ds)
    everywhere = np.ones(ds.sizes["s"], dtype=bool)
    share = _share(k["quasi-periodic"] | k["chaotic"] | k["undecided"], everywhere)
    if (k["contact"] | k["diverged"]).all():
        return "cannot be evaluated", counts(ds, everywhere)
    return by_share(share), f"{share:.0%} of the speeds do not return; {counts(ds, everywhere)}"


def amplitude_grows(e: Evidence, _claim: Claim) -> Judgement:
    """Rank correlation of the amplitude with the speed."""
    ds = e.diagrams[0.0]
    pp = amplitude(ds)
    ok = np.isfinite(pp)
    if ok.sum() < 8:
        return "cannot be evaluated", f"only {int(ok.sum())} speeds run to their end"
    if np.ptp(pp[ok]) == 0:
        return "cannot be evaluated", "the amplitude is the same at every speed"
    rank = float(spearmanr(ds["s"].values[ok], pp[ok]).statistic)
    found = f"rank correlation of the peak-to-peak of y_p with s: {rank:+.2f} over {int(ok.sum())} speeds"
    return ("holds" if rank > 0.8 else "partly" if rank > 0.3 else "fails"), found


def window(psi: float, low: float, high: float, kind: str) -> Callable[[Evidence, Claim], Judgement]:
    """Judge a window of speeds by the share of one kind in it."""

    def judged(e: Evidence, _claim: Claim) -> Judgement:
        ds = e.diagrams[psi]
        where = between(ds, low, high)
        if not where.any():
            return "cannot be evaluated", f"no computed speed in {low:g} .. {high:g}"
        return by_share(_share(kinds(ds)[kind], where)), f"s = {low:g} .. {high:g}: {counts(ds, where)}"

    return judged


def chaos_window(e: Evidence, _claim: Claim) -> Judgement:
    """Chaos in 1.18 .. 1.60, and what is found where the paper says both chaos and 8T."""
    ds = e.diagrams[1e-4]
    word, found = window(1e-4, 1.18, 1.60, "chaotic")(e, _claim)
    return word, f"{found}; s = 1.61 .. 1.80, where the paper says both: {counts(ds, between(ds, 1.61, 1.80))}"


def large_amplitude(e: Evidence, _claim: Claim) -> Judgement:
    """Amplitude in 1.48 .. 1.60 against the rest of the window."""
    ds = e.diagrams[1e-4]
    pp, chaotic = amplitude(ds), kinds(ds)["chaotic"]
    inside, rest = between(ds, 1.48, 1.60), between(ds, 1.18, 1.475)
    if not (chaotic & (inside | rest)).any():
        return "cannot be evaluated", "no speed in 1.18 .. 1.60 is chaotic"
    a, b = np.nanmedian(pp[inside]), np.nanmedian(pp[rest])
    word: Word = "holds" if a > 1.2 * b and (chaotic & inside).any() else "fails"
    return word, f"median peak-to-peak of y_p {a:.3g} in 1.48 .. 1.60, {b:.3g} in 1.18 .. 1.475"


def three_windows(psi: float) -> Callable[[Evidence, Claim], Judgement]:
    """Chaos at 1.60 .. 1.62 and above 3.15, the period of the forcing elsewhere."""

    def judged(e: Evidence, _claim: Claim) -> Judgement:
        ds = e.diagrams[psi]
        k = kinds(ds)
        s = ds["paper_s"].values
        low, high = between(ds, 1.60, 1.62), s > 3.15
        other = ~(low | high)
        shares = [_share(k["chaotic"], low), _share(k["chaotic"], high), _share(k["with the forcing"], other)]
        met = [by_share(v) for v in shares]
        word: Word = met[0] if len(set(met)) == 1 else "partly"
        return word, (
            f"chaotic in 1.60 .. 1.62: {shares[0]:.0%}, above 3.15: {shares[1]:.0%};"
            f" with the period of the forcing elsewhere: {shares[2]:.0%} ({counts(ds, other)})"
        )

    return judged


def lyapunov_positive(e: Evidence, _claim: Claim) -> Judgement:
    """Largest exponent at s = 3.27 for every psi, three standard errors above zero or not."""
    votes, parts = [], []
    for psi, ds in e.orbits.items():
        label = Regime(int(ds["regime"])).label
        if "lyapunov" not in ds:
            parts.append(f"psi = {psi:g}: {label}")
            continue
        value, error = float(ds["lyapunov"][0]), float(ds["lyapunov_error"][0])
        votes.append(value > 3 * error)
        parts.append(f"psi = {psi:g}: {value:+.4f} ± {error:.4f} per radian ({label})")
    if not votes:
        return "cannot be evaluated", "; ".join(parts)
    word: Word = "holds" if all(votes) and len(votes) == len(PSI) else "partly" if any(votes) else "fails"
    return word, "; ".join(parts)


def dimension(coordinate: str) -> Callable[[Evidence, Claim], Judgement]:
    """D2 of the section in the plane (y, y'), with the other two estimates beside it."""

    def judged(e: Evidence, claim: Claim) -> Judgement:
        assert claim.value is not None
        met, parts = [], []
        for psi in PSI:
            found = e.dimensions[psi, coordinate]
            if not found:
                label = Regime(int(e.orbits[psi]["regime"])).label
                parts.append(f"psi = {psi:g}: no dimension ({label})")
                continue
            plane = found["plane"]
            parts.append(f"psi = {psi:g}: " + ", ".join(f"{name} {dimension_text(ds)}" for name, ds in found.items()))
            if DIMENSION_STATUS[int(plane["status"])] == "ok":
                met.append(abs(float(plane["D2"]) - claim.value) <= 2 * float(plane["D2_error"]))
        wanted = f"the paper says {claim.value}"
        if not met:
            return "cannot be evaluated", f"{'; '.join(parts)}; {wanted}"
        return ("holds" if any(met) else "fails"), f"{'; '.join(parts)}; {wanted}"

    return judged


def spectrum(e: Evidence, _claim: Claim) -> Judgement:
    """Lines above the floor and broadband power at s = 3.27."""
    many, parts = [], []
    for psi, ds in e.orbits.items():
        found = json.loads(ds.attrs["indicators"]).get("spectrum")
        if found is None:
            parts.append(f"psi = {psi:g}: no spectrum ({Regime(int(ds['regime'])).label})")
            continue
        broad = found["broadband_fraction"] or 0.0
        many.append(found["lines"] >= MANY_LINES or broad >= BROADBAND)
        parts.append(f"psi = {psi:g}: {found['lines']} lines, {broad:.1%} of the power beside them")
    if not many:
        return "cannot be evaluated", "; ".join(parts)
    word: Word = "holds" if all(many) else "partly" if any(many) else "fails"
    return word, "y_p: " + "; ".join(parts).replace("; ", ";  ")


def regularises(e: Evidence, _claim: Claim) -> Judgement:
    """Fraction of speeds that do not return, against psi."""
    shares, parts = [], []
    for psi, ds in e.diagrams.items():
        k = kinds(ds)
        open_share = float((k["quasi-periodic"] | k["chaotic"] | k["undecided"]).mean())
        ended = float((k["contact"] | k["diverged"]).mean())
        shares.append(open_share + ended)
        parts.append(f"psi = {psi:g}: {open_share:.0%} non-periodic, {ended:.0%} contact or diverged")
    if all(s == 1.0 for s in shares):
        return "cannot be evaluated", "; ".join(parts)
    falls = all(b <= a + 1e-12 for a, b in pairwise(shares)) and shares[-1] < shares[0]
    return ("holds" if falls else "partly" if shares[-1] < shares[0] else "fails"), "; ".join(parts)


def suppresses(e: Evidence, _claim: Claim) -> Judgement:
    """Amplitude against psi, at the speeds that all permeabilities run through."""
    pp = np.stack([amplitude(ds) for ds in e.diagrams.values()])
    shared = np.isfinite(pp).all(axis=0)
    if shared.sum() < 8:
        return "cannot be evaluated", f"only {int(shared.sum())} speeds run to their end at every psi"
    median = np.median(pp[:, shared], axis=1)
    less = float(np.mean(pp[-1, shared] < pp[0, shared]))
    found = "; ".join(f"psi = {psi:g}: {m:.4g}" for psi, m in zip(PSI, median, strict=True))
    word: Word = "holds" if median[-1] < 0.95 * median[0] and less > PARTLY else "fails"
    return word, f"median peak-to-peak of y_p over {int(shared.sum())} shared speeds: {found}; smaller at {less:.0%} of them"


def safe_windows(ds: xr.Dataset) -> list[tuple[float, float, float]]:
    """Windows of neighbouring speeds that return: first and last speed (the paper's s), largest peak-to-peak of y_p."""
    safe = ds["regime"].values == Regime.periodic
    s, pp = ds["paper_s"].values, amplitude(ds)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], safe.astype(int), [0]])))
    return [(float(s[a]), float(s[b - 1]), float(pp[a:b].max())) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def safe_speeds(e: Evidence, _claim: Claim) -> Judgement:
    """Are there windows to choose, and does choosing them lower the amplitude."""
    parts, lowered, any_choice = [], [], False
    for psi, ds in e.diagrams.items():
        safe = ds["regime"].values == Regime.periodic
        pp = amplitude(ds)
        windows = ", ".join(f"{a:.2f} .. {b:.2f} (at most {m:.3g})" for a, b, m in safe_windows(ds)[:6])
        parts.append(f"psi = {psi:g}: {windows or 'no periodic speed'}")
        moving = ~safe & np.isfinite(pp)
        if safe.any() and moving.any():
            any_choice = True
            lowered.append(np.median(pp[safe]) < np.median(pp[moving]))
    found = "periodic windows, with the peak-to-peak of y_p: " + "; ".join(parts)
    if not any_choice:
        return "cannot be evaluated", "no permeability has both periodic and non-periodic speeds; " + found
    return ("holds" if all(lowered) else "partly" if any(lowered) else "fails"), found


JUDGES: dict[str, Callable[[Evidence, Claim], Judgement]] = {
    "fig2-nonperiodic": nonperiodic,
    "fig2-amplitude-grows": amplitude_grows,
    "fig3-low-8T": window(1e-4, 0.0, 1.1799, "with the forcing"),
    "fig3-chaos-window": chaos_window,
    "fig3-large-amplitude": large_amplitude,
    "fig3-mid-8T": window(1e-4, 1.61, 3.10, "with the forcing"),
    "fig3-high-chaos": window(1e-4, 3.11, np.inf, "chaotic"),
    "fig4-windows": three_windows(1e-3),
    "fig5-windows": three_windows(0.1),
    "fig67-lyapunov": lyapunov_positive,
    "fig6-dimension-yp": dimension("yp"),
    "fig7-dimension-y2": dimension("y2"),
    "fig67-spectrum": spectrum,
    "permeability-regularises": regularises,
    "permeability-suppresses-amplitude": suppresses,
    "safe-speeds": safe_speeds,
}
