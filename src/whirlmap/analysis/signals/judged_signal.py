"""Verdict on one evenly spaced signal, with the evidence: what `diagnose_series` and its windows are made of."""

import json
from math import ceil
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray
from scipy import signal

from whirlmap.analysis.signals.embedded_votes import add_embedded, embedding_of, lag_of, zero_one_vote
from whirlmap.analysis.signals.regular_motion import RegularMotion, regular_motion
from whirlmap.analysis.signals.steadiness import steadiness
from whirlmap.analysis.signals.verdict import CLEAN, decide, reason, sentences
from whirlmap.analysis.spectra.spectral_lines import spectral_lines
from whirlmap.analysis.spectra.spectrum import power_spectrum
from whirlmap.errors import RangeError
from whirlmap.results.findings import Findings
from whirlmap.results.provenance import package_version
from whirlmap.results.regime import Regime
from whirlmap.results.schema import regime_variable, variable, with_attributes

Array = NDArray[np.float64]

#: Least number of samples, and of oscillations of the motion, for a diagnosis.
FEWEST, FEWEST_SWINGS = 1000, 30
#: Share of the power in the strongest bins, over which the mean frequency is taken: noise lies in the others.
STRONG = 0.95
#: Samples per oscillation to which a finely sampled signal is thinned before it is embedded.
FINE = 40
CITED = (
    "gottwald2009 rosenstein1993 kantz1994 savitzky1964 fraser1986 kennel1992 grassberger1983 theiler1986 marwan2007"
    " andrews1993"
)


class NoMotionError(RangeError):
    """A signal in which there is too little motion; ``reason`` says it in some words."""

    def __init__(self, message: str, reason: str) -> None:
        super().__init__(message)
        self.reason = reason


def judge_signal(
    values: ArrayLike, rate: float, unit: str = "s", *, quantity: str = "", quantity_unit: str = "1"
) -> xr.Dataset:
    """Judge one signal; parameters, result and algorithm are those of `diagnose_series`."""
    raw, scale = _checked(values)
    spectrum = power_spectrum.find(raw, rate=1.0)
    swing = _swing(raw, spectrum, rate)
    lines = spectral_lines.find(spectrum)
    regular = regular_motion(raw, spectrum, lines)
    steady = steadiness(raw, swing, regular.frequency, regular.share, regular.broad)
    votes: dict[str, Any] = {
        "steadiness": {
            "vote": "not-steady" if steady.changes else "steady", "changes": list(steady.changes),
            "rms": (steady.rms * scale).tolist(), "frequency": (steady.frequency * rate).tolist(),
            "mean": (steady.mean * scale).tolist(), "statistics": steady.statistics,
            "frequency_of": "strongest line" if steady.followed else "whole spectrum",
        }
    }  # fmt: skip
    votes |= regular.votes
    for line in votes["spectrum"]["named"]:
        line["frequency"] *= rate
    thin = int(swing // FINE) if swing > 2 * FINE else 1
    x, per_swing = _thinned(raw, thin), max(ceil(swing / thin), 2)
    data, coords = _spectral_data(
        x * scale, spectrum, lines, regular, thin, scale, rate, unit, quantity, quantity_unit
    )
    lag, dimension = lag_of(x, per_swing, votes, data, coords), 0
    votes["zero_one"] = {"vote": "not-steady", "value": None} if steady.changes else zero_one_vote(x, lag)
    torus = votes["spectrum"]["vote"] == "quasi-periodic" and regular.broad < CLEAN
    if steady.changes or regular.period is not None or torus:
        why = "not-steady" if steady.changes else "lines-hold-all" if torus else "neighbours-coincide"
        votes["neighbours"] = {"vote": why, "dimension": None}
        votes |= {name: {"vote": why, "value": None, "error": None, "range": None} for name in ("rosenstein", "kantz")}
    else:
        lag, dimension = embedding_of(x, lag, per_swing, votes, data, coords)
    if dimension:
        add_embedded(x, lag, dimension, per_swing, rate / thin, votes, data, coords)
    label, confidence = decide(votes)
    data["regime"] = regime_variable((), label)
    data["confidence"] = variable((), confidence, "1", "share of the indicators asked that speak for the regime")
    facts = {
        "quantity": quantity, "rate": rate, "unit": unit, "samples": raw.size, "thinned": thin, "swing": swing / rate,
        "lag": lag, "embedding_dimension": dimension, "indicators": json.dumps(votes),
        "why": reason(label, votes),
        "verdict": sentences(label, votes, rate=rate, unit=unit, period=regular.period, thinned=thin),
        "whirlmap_version": package_version("whirlmap"), "citations": CITED, **_cycle(label, regular, rate),
    }  # fmt: skip
    return with_attributes(xr.Dataset(data, coords=coords), facts)


def _checked(values: ArrayLike) -> tuple[Array, float]:
    """Signal over a power of two, so that squares stay within floats, and that power."""
    try:
        raw = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise RangeError(f"values of type {type(values).__name__}: numbers are needed") from None
    if raw.ndim != 1 or raw.size < FEWEST:
        raise RangeError(f"the signal has shape {raw.shape}: one series of at least {FEWEST} samples is needed")
    if not np.isfinite(raw).all():
        at = int(np.flatnonzero(~np.isfinite(raw))[0])
        raise RangeError(
            f"sample {at + 1} of the signal is {raw[at]}: all must be finite numbers; missing=['nan'] leaves others out"
        )
    largest = float(np.abs(raw).max())
    if largest == 0 or float(raw.max()) / largest - float(raw.min()) / largest <= 1e-12:
        raise NoMotionError(f"the signal is constant ({raw[0]:g}): there is no motion in it", "constant")
    scale = float(np.ldexp(1.0, int(np.frexp(largest)[1]) - 1))
    return raw / scale, scale


def _swing(raw: Array, spectrum: Findings, rate: float) -> float:
    """Samples per swing."""
    power = np.asarray(spectrum["power"], dtype=float).copy()
    power[:2] = 0.0  # offset and slow drift are no swing
    strongest = np.argsort(-power, kind="stable")
    held = strongest[: int(np.searchsorted(np.cumsum(power[strongest]), STRONG * power.sum())) + 1]
    squares = np.asarray(spectrum["frequency"], dtype=float)[held] ** 2
    swing = 1.0 / float(np.sqrt(np.average(squares, weights=power[held])))
    if raw.size < FEWEST_SWINGS * swing:
        count = raw.size / swing
        raise NoMotionError(
            f"the signal holds {count:.3g} oscillations of its mean frequency, {rate / swing:.4g}:"
            f" at least {FEWEST_SWINGS} are needed. Record longer, or remove a slow drift.",
            f"too short: {count:.3g} oscillations, {FEWEST_SWINGS} needed",
        )
    return swing


def _thinned(raw: Array, thin: int) -> Array:
    x = raw - raw.mean()
    if thin > 1:
        edge = 20  # the filter's reach, in samples of the thinned signal
        x = signal.resample_poly(x, 1, thin)[edge:-edge]
    return np.asarray(x)


def _cycle(label: Regime, regular: RegularMotion, rate: float) -> dict[str, float]:
    """Period and frequency: of the cycle where there is one, else the strongest line's frequency."""
    if label == Regime.periodic and regular.period is not None:
        return {"period": regular.period / rate, "frequency": rate / regular.period}
    return {"frequency": float(regular.frequency[0]) * rate} if regular.frequency.size and label != Regime.not_steady else {}


def _spectral_data(
    x: Array, spectrum: Findings, lines: Findings, regular: RegularMotion, thin: int, scale: float, rate: float,
    unit: str, quantity: str, quantity_unit: str,
) -> tuple[dict[str, Any], dict[str, Any]]:  # fmt: skip
    """Variables and coordinates of signal, spectrum and lines in units of the record."""
    square = scale * scale if 1e-140 < scale < 1e140 else 1.0
    word = "power of a line, a^2/2" if square != 1.0 or scale == 1.0 else f"power of a line, a^2/2, over {scale:g}^2"
    each = np.array(lines["line_frequency"], dtype=float)
    each[regular.counted] = regular.frequency  # fitted: better than the peaks of the spectrum
    per = "1" if unit == "1" else f"1/{unit}"
    squared = "1" if quantity_unit == "1" else f"{quantity_unit}^2" if quantity_unit.isalpha() else f"({quantity_unit})^2"
    data: dict[str, Any] = {
        "power": variable("frequency", spectrum["power"] * square, squared, word),
        "line_frequency": variable("line", each * rate, per, "frequency of the line"),
        "line_power": variable("line", lines["line_power"] * square, squared, word.replace("a line", "the line")),
        "series": variable("time", x, quantity_unit, f"{quantity or 'signal'}, thinned where it was sampled finely"),
    }
    coords = {
        "time": variable("time", np.arange(x.size) * thin / rate, unit, "time"),
        "frequency": variable("frequency", spectrum["frequency"] * rate, per, "frequency"),
    }
    return data, coords
