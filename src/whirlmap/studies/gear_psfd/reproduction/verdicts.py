"""The verdict on every claim for one reproduced machine, with the numbers that decided it, in words."""

import json
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import xarray as xr

from whirlmap.errors import counted
from whirlmap.results.regime import Regime
from whirlmap.results.status import Status
from whirlmap.studies.gear_psfd.claims.claims import (
    WORDS,
    Claim,
    claims,
    judge_all,
    rank_correlation,
    suppressed,
)
from whirlmap.studies.gear_psfd.claims.labelled import ORBITS, PSI, Array, Labelled, Mask, Orbits, least_exponent, median_of
from whirlmap.studies.gear_psfd.claims.measured import Measured, measured
from whirlmap.studies.gear_psfd.claims.thresholds import THREE_WINDOWS, WINDOWS, chaotic_windows, windows_of
from whirlmap.studies.gear_psfd.reproduction.edition_data import EditionData, dimension_text

#: Regime of a point whose numbers could not be had: it is of no kind.
NOT_KNOWN = -1


@dataclass(frozen=True)
class ClaimVerdict:
    """A word, the number that it comes from, and all numbers that decided it, in words."""

    claim: Claim
    word: str
    measured: Measured
    found: str


def judge(evidence: EditionData) -> list[ClaimVerdict]:
    """Judge every statement by the evidence of one edition."""
    d = labelled(evidence)
    judged = judge_all(d)
    return [
        ClaimVerdict(c, WORDS[int(judged[c.id].word[0])], measured(d, c), FOUND[c.id](evidence, d, c)) for c in claims()
    ]


def labelled(e: EditionData) -> Labelled:
    """Arrange the evidence of one edition as the claims read it: one parameter set."""
    first = e.diagrams[PSI[0]]

    def rows(name: str) -> Array:
        return np.stack([e.diagrams[psi][name].values for psi in PSI])[None]

    span = np.stack([amplitude(e.diagrams[psi]) for psi in PSI])[None]
    longest = e.quality.settling.longest
    waited = rows("settled_after") if "settled_after" in first else np.zeros(span.shape)
    return Labelled(
        s=first["paper_s"].values, regime=known_regime(rows("regime"), rows("status")),
        period=rows("period_T").astype(np.int64),
        exponent=rows("lyapunov"), error=rows("lyapunov_error"), amplitude=span,
        slowness=np.clip(waited / longest, 0.0, 1.0), forced=first.attrs["common_multiple"],
        least=least_exponent(e.quality.exponent_periods, e.system.period), orbits=_orbits(e),
    )  # fmt: skip


def known_regime(regime: Array, status: Array) -> np.ndarray:
    """Regimes, with `NOT_KNOWN` for points whose run failed: they are no evidence of anything."""
    return np.where(np.isin(status, (Status.unresolved, Status.failed)), NOT_KNOWN, regime).astype(np.int8)


def amplitude(ds: xr.Dataset, state: str = "yp") -> Array:
    """Peak-to-peak of a state over the record, at every speed; NaN where the run ended."""
    return np.asarray((ds["maximum"] - ds["minimum"]).sel(quantity=state).values, dtype=float)


def _orbits(e: EditionData) -> Orbits:
    def each(read: Callable[[xr.Dataset], float]) -> Array:
        return np.array([[read(e.orbits[psi]) for psi in PSI]])

    def spectral(name: str) -> Callable[[xr.Dataset], float]:
        def read(ds: xr.Dataset) -> float:
            found = json.loads(ds.attrs["indicators"]).get("spectrum")
            return np.nan if found is None else float(found[name] or 0.0)

        return read

    def first(name: str) -> Callable[[xr.Dataset], float]:
        return lambda ds: float(ds[name][0]) if name in ds else np.nan

    def plane(coordinate: str) -> tuple[Array, Array]:
        made = [e.dimensions[psi, coordinate].get("plane") for psi in PSI]
        good = [ds if ds is not None and int(ds["status"]) == 0 else None for ds in made]
        value, error = ([[np.nan if ds is None else float(ds[name]) for ds in good]] for name in ("D2", "D2_error"))
        return np.array(value), np.array(error)

    return Orbits(
        regime=each(lambda ds: int(ds["regime"])).astype(np.int8), exponent=each(first("lyapunov")),
        error=each(first("lyapunov_error")), lines=each(spectral("lines")), broadband=each(spectral("broadband_fraction")),
        dimension={y: plane(y) for y in ORBITS},
    )  # fmt: skip


def counts(d: Labelled, psi: int, where: Mask) -> str:
    """How many points of each kind a window holds, in words."""
    parts = [f"{int(n)} {name}" for name, m in d.kinds.items() if (n := (m[0, psi] & where).sum())]
    return f"of {counted(int(where.sum()), 'speed')}: " + (", ".join(parts) or "none")


def _share(d: Labelled, psi: int, kind: str, where: Mask) -> float:
    return float(d.share(d.kinds[kind][:, psi], where)[0])


def _nonperiodic(_e: EditionData, d: Labelled, _claim: Claim) -> str:
    everywhere = np.ones(d.s.size, dtype=bool)
    return f"{float(d.open[0, 0].mean()):.0%} of the speeds do not return; {counts(d, 0, everywhere)}"


def _amplitude_grows(_e: EditionData, d: Labelled, _claim: Claim) -> str:
    running = int(np.isfinite(d.amplitude[0, 0]).sum())
    rank = float(rank_correlation(d)[0])
    if np.isnan(rank):
        return f"{counted(running, 'speed')} run to the end, of which no rank correlation can be had"
    return f"rank correlation of the peak-to-peak of y_p with s: {rank:+.2f} over {counted(running, 'speed')}"


def _window(psi: float, low: float, high: float) -> Callable[[EditionData, Labelled, Claim], str]:
    def found(_e: EditionData, d: Labelled, _claim: Claim) -> str:
        where = d.between(low, high)
        if not where.any():
            return f"no computed speed in {low:g} .. {high:g}"
        return f"s = {low:g} .. {high:g}: {counts(d, PSI.index(psi), where)}"

    return found


def _chaos_window(e: EditionData, d: Labelled, claim: Claim) -> str:
    both = counts(d, PSI.index(1e-4), d.between(1.61, 1.80))
    psi, low, high, _ = WINDOWS[claim.id]
    return f"{_window(psi, low, high)(e, d, claim)}; s = 1.61 .. 1.80, where the paper says both: {both}"


def _large_amplitude(_e: EditionData, d: Labelled, _claim: Claim) -> str:
    at = PSI.index(1e-4)
    inside, rest = chaotic_windows(d)
    if not (d.kinds["chaotic"][0, at] & (inside | rest)).any():
        return "no speed in 1.18 .. 1.60 is chaotic"
    a, b = (float(median_of(d.amplitude[:, at], where)[0]) for where in (inside, rest))
    return f"median peak-to-peak of y_p {a:.3g} in 1.48 .. 1.60, {b:.3g} in 1.18 .. 1.475"


def _three_windows(psi: float) -> Callable[[EditionData, Labelled, Claim], str]:
    def found(_e: EditionData, d: Labelled, _claim: Claim) -> str:
        at = PSI.index(psi)
        low, high, other = ((kind, where) for kind, where in windows_of(d))
        return (
            f"chaotic in 1.60 .. 1.62: {_share(d, at, *low):.0%}, above 3.15: {_share(d, at, *high):.0%};"
            f" with the period of the forcing elsewhere: {_share(d, at, *other):.0%} ({counts(d, at, other[1])})"
        )

    return found


def _each_psi(tell: Callable[[EditionData, float, int], str]) -> Callable[[EditionData], str]:
    return lambda e: "; ".join(f"psi = {psi:g}: {tell(e, psi, k)}" for k, psi in enumerate(PSI))


def _label(e: EditionData, psi: float) -> str:
    return Regime(int(e.orbits[psi]["regime"])).label


def _lyapunov(e: EditionData, d: Labelled, _claim: Claim) -> str:
    def tell(e: EditionData, psi: float, k: int) -> str:
        value, error = float(d.orbits.exponent[0, k]), float(d.orbits.error[0, k])
        return _label(e, psi) if np.isnan(value) else f"{value:+.4f} ± {error:.4f} per radian ({_label(e, psi)})"

    return _each_psi(tell)(e)


def _dimension(coordinate: str) -> Callable[[EditionData, Labelled, Claim], str]:
    def found(e: EditionData, _d: Labelled, claim: Claim) -> str:
        def tell(e: EditionData, psi: float, _k: int) -> str:
            made = e.dimensions[psi, coordinate]
            if not made:
                return f"no dimension ({_label(e, psi)})"
            return ", ".join(f"{name} {dimension_text(ds)}" for name, ds in made.items())

        return f"{_each_psi(tell)(e)}; the paper says {claim.value}"

    return found


def _spectrum(e: EditionData, d: Labelled, _claim: Claim) -> str:
    def tell(e: EditionData, psi: float, k: int) -> str:
        if np.isnan(d.orbits.lines[0, k]):
            return f"no spectrum ({_label(e, psi)})"
        return f"{counted(int(d.orbits.lines[0, k]), 'line')}, {d.orbits.broadband[0, k]:.1%} of the power beside them"

    return "y_p: " + _each_psi(tell)(e)


def _regularises(e: EditionData, d: Labelled, _claim: Claim) -> str:
    def tell(_e: EditionData, _psi: float, k: int) -> str:
        return f"{float(d.open[0, k].mean()):.0%} non-periodic, {float(d.ended[0, k].mean()):.0%} contact or diverged"

    return _each_psi(tell)(e)


def _suppresses(e: EditionData, d: Labelled, _claim: Claim) -> str:
    shared, median, less = suppressed(d)
    n = int(shared.sum())
    if n == 0:
        return "no speed runs to its end at every psi"
    each = _each_psi(lambda _e, _psi, k: f"{float(median[0, k]):.4g}")(e)
    return f"median peak-to-peak of y_p over {n} shared speeds: {each}; smaller at {float(less[0]):.0%} of them"


def safe_windows(d: Labelled, psi: int) -> list[tuple[float, float, float]]:
    """Windows of neighbouring speeds that return: first and last speed (the paper's s), largest peak-to-peak of y_p."""
    safe, pp = d.regime[0, psi] == Regime.periodic, d.amplitude[0, psi]
    edges = np.flatnonzero(np.diff(np.concatenate([[0], safe.astype(int), [0]])))
    return [(float(d.s[a]), float(d.s[b - 1]), float(pp[a:b].max())) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def _safe_speeds(e: EditionData, d: Labelled, _claim: Claim) -> str:
    def tell(_e: EditionData, _psi: float, k: int) -> str:
        windows = ", ".join(f"{a:.2f} .. {b:.2f} (at most {m:.3g})" for a, b, m in safe_windows(d, k)[:6])
        return windows or "no periodic speed"

    return "periodic windows, with the peak-to-peak of y_p: " + _each_psi(tell)(e)


FOUND: dict[str, Callable[[EditionData, Labelled, Claim], str]] = {
    "fig2-nonperiodic": _nonperiodic,
    "fig2-amplitude-grows": _amplitude_grows,
    **{name: _window(psi, low, high) for name, (psi, low, high, _) in WINDOWS.items()},
    "fig3-chaos-window": _chaos_window,
    "fig3-large-amplitude": _large_amplitude,
    **{name: _three_windows(psi) for name, psi in THREE_WINDOWS.items()},
    "fig67-lyapunov": _lyapunov,
    "fig6-dimension-yp": _dimension("yp"),
    "fig7-dimension-y2": _dimension("y2"),
    "fig67-spectrum": _spectrum,
    "permeability-regularises": _regularises,
    "permeability-suppresses-amplitude": _suppresses,
    "safe-speeds": _safe_speeds,
}
