"""Diagnosis of a recorded signal: the indicators that need no equations, and the regime that they give together."""

import json
from math import ceil
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray
from scipy import signal

from whirlmap.analysis.indicators.correlation_dimension import correlation_dimension
from whirlmap.analysis.indicators.recurrence import recurrence
from whirlmap.analysis.indicators.zero_one import STATUS as ZERO_ONE_STATUS
from whirlmap.analysis.indicators.zero_one import zero_one_test
from whirlmap.analysis.signals.embedding import delay_embedding, false_neighbours, mutual_information
from whirlmap.analysis.signals.regular_motion import RegularMotion, regular_motion
from whirlmap.analysis.signals.signal_exponents import signal_exponents
from whirlmap.analysis.signals.steadiness import steadiness
from whirlmap.analysis.signals.verdict import CLEAN, decide, sentences
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
#: Samples used for false neighbours, vectors used for distances, and points used for recurrences.
NEIGHBOURS, VECTORS, RECURRENT = 12_000, 8_000, 1_500
#: Smallest rate, and the inverse of the largest.
SLOWEST = 1e-280
#: Damping of the 0-1 test, for noise.
DAMPING = 1.0
CITED = (
    "gottwald2009 rosenstein1993 kantz1994 savitzky1964 fraser1986 kennel1992 grassberger1983 theiler1986 marwan2007"
    " andrews1993"
)
#: K of the 0-1 test above and below which it has a say; clean sections allow tighter ones (`regime`).
WANDERS, BOUNDED = 0.8, 0.3


def diagnose_series(values: ArrayLike, *, rate: float, unit: str = "s") -> xr.Dataset:
    """Say of a recorded signal whether it is periodic, quasi-periodic or chaotic, with the evidence.

    Parameters
    ----------
    values : array, shape (time,)
        Evenly spaced samples.
    rate : float
        Samples per unit of time.
    unit : str
        Unit of time.

    Returns
    -------
    xr.Dataset
        ``regime``, ``series(time)``, and under the names of their functions what the indicators gave: spectrum and lines,
        ``mutual_information(lag)``, ``false_neighbours(dimension)``, ``rosenstein(step)``, ``kantz(step)`` and
        ``dimension_*``, where they were asked. ``attrs["indicators"]`` is a JSON object of every vote, ``attrs["verdict"]``
        some sentences; ``attrs["period"]`` and ``attrs["frequency"]`` are there where the signal has them.

    Raises
    ------
    RangeError
        Fewer than 1000 samples or 30 oscillations, a constant signal, numbers that are not finite, a rate that is not
        positive.

    Notes
    -----
    1. The root mean square frequency, over the strongest bins of the spectrum that hold 95 % of the power, gives the
       oscillation. A signal with more than 80 samples per oscillation is thinned, after an anti-alias filter, to about 40;
       exponents and dimension are of the thinned signal.
    2. Steadiness (`steadiness`): where level, frequency or mean change within the record, it is ``not-steady``.
    3. Regular motion (`regular_motion`): 98 % of the power in lines; periodic where they have a common fundamental and
       the signal is itself again after its period, quasi-periodic where they have none.
    4. Where the motion is steady and does not return: lag from the first minimum of the mutual information (without one, a
       quarter swing, which is said), dimension from false neighbours; without one at that lag, nor at a half or a quarter of
       it, none of the embedded indicators speaks: noise, or too many dimensions. Exponents as `signal_exponents` says. On
       signals that return neighbours coincide, and no exponent is asked; nor of a torus whose lines hold 99.9 % of the
       power.
    5. Chaotic: the 0-1 test wanders, the lines do not hold all of the power, Rosenstein's or Kantz's exponent is
       positive over a scaling range, and so is the other, or the dimension has one: coloured noise may show one of them
       by chance. Quasi-periodic motion must not wander nor have Rosenstein's exponent. Else undecided.

    A signal says less than equations: exponents have no other error than the scatter within the one record, coloured noise
    can imitate a low dimension, and filters add dimensions.

    References
    ----------
    [takens1981] embedding; [fraser1986] its lag; [kennel1992] its dimension.
    [rosenstein1993] and [kantz1994] exponents; [grassberger1983] and [theiler1986] dimension; [gottwald2009] 0-1 test.
    [andrews1993] steadiness.
    """
    raw, scale = _checked(values, rate)
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
    data, coords = _spectral_data(x * scale, spectrum, lines, thin, scale, rate, unit)
    lag, dimension = _lag(x, per_swing, votes, data, coords), 0
    votes["zero_one"] = _zero_one_vote(x, lag)
    torus = votes["spectrum"]["vote"] == "quasi-periodic" and regular.broad < CLEAN
    if steady.changes or regular.period is not None or torus:
        why = "not-steady" if steady.changes else "lines-hold-all" if torus else "neighbours-coincide"
        votes["neighbours"] = {"vote": why, "dimension": None}
        votes |= {name: {"vote": why, "value": None, "error": None, "range": None} for name in ("rosenstein", "kantz")}
    else:
        lag, dimension = _dimension(x, lag, per_swing, votes, data, coords)
    if dimension:
        _embedded(x, lag, dimension, per_swing, rate / thin, votes, data, coords)
    label, confidence = decide(votes)
    data["regime"] = regime_variable((), label)
    data["confidence"] = variable((), confidence, "1", "share of the indicators with a vote that speak for the regime")
    facts = {
        "rate": rate, "unit": unit, "samples": raw.size, "thinned": thin, "swing": swing / rate,
        "lag": lag, "embedding_dimension": dimension, "indicators": json.dumps(votes),
        "verdict": sentences(label, votes, rate=rate, unit=unit, period=regular.period, thinned=thin),
        "whirlmap_version": package_version("whirlmap"), "citations": CITED, **_cycle(label, regular, rate),
    }  # fmt: skip
    return with_attributes(xr.Dataset(data, coords=coords), facts)


def series_json(ds: xr.Dataset) -> dict[str, Any]:
    """Label, sentences and votes of `diagnose_series` as plain data; unknown numbers as None."""
    votes = json.loads(ds.attrs["indicators"])
    keys = ("rate", "unit", "samples", "thinned", "swing", "lag", "embedding_dimension")
    return {
        "regime": Regime(int(ds["regime"])).label, "confidence": float(ds["confidence"]), "verdict": ds.attrs["verdict"],
        "period": ds.attrs.get("period"), "frequency": ds.attrs.get("frequency"),
        "lyapunov": votes.get("rosenstein", {}).get("value"), "lyapunov_error": votes.get("rosenstein", {}).get("error"),
        "correlation_dimension": votes.get("dimension", {}).get("value"),
        "correlation_dimension_error": votes.get("dimension", {}).get("error"), "indicators": votes,
        **{key: ds.attrs[key] for key in keys},
    }  # fmt: skip


def _checked(values: ArrayLike, rate: Any) -> tuple[Array, float]:
    """Signal over a power of two, so that squares stay within floats, and that power."""
    try:
        raw, per_unit = np.asarray(values, dtype=np.float64), float(rate)
    except (TypeError, ValueError):
        raise RangeError(f"values of type {type(values).__name__}, rate = {rate!r}: numbers are needed") from None
    if raw.ndim != 1 or raw.size < FEWEST:
        raise RangeError(f"the signal has shape {raw.shape}: one series of at least {FEWEST} samples is needed")
    if not np.isfinite(raw).all():
        at = int(np.flatnonzero(~np.isfinite(raw))[0])
        raise RangeError(f"sample {at + 1} of the signal is {raw[at]}: all must be finite numbers")
    if isinstance(rate, str) or not SLOWEST < per_unit < 1 / SLOWEST:
        raise RangeError(f"rate = {rate!r}: a positive number of samples per unit of time, {SLOWEST:g} to "
            f"{1 / SLOWEST:g}, is needed")
    largest = float(np.abs(raw).max())
    if largest == 0 or float(raw.max()) / largest - float(raw.min()) / largest <= 1e-12:
        raise RangeError(f"the signal is constant ({raw[0]:g}): there is no motion in it")
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
        raise RangeError(
            f"the signal holds {raw.size / swing:.3g} oscillations of its mean frequency, {rate / swing:.4g}:"
            f" at least {FEWEST_SWINGS} are needed. Record longer, or remove a slow drift."
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
    x: Array, spectrum: Findings, lines: Findings, thin: int, scale: float, rate: float, unit: str
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Variables and coordinates of signal, spectrum and lines in units of the record."""
    square = scale * scale if 1e-140 < scale < 1e140 else 1.0
    word = "power of a line, a^2/2" if square != 1.0 or scale == 1.0 else f"power of a line, a^2/2, over {scale:g}^2"
    data: dict[str, Any] = {
        "power": variable("frequency", spectrum["power"] * square, "1", word),
        "line_frequency": variable("line", lines["line_frequency"] * rate, f"1/{unit}", "frequency of the line"),
        "line_power": variable("line", lines["line_power"] * square, "1", word.replace("a line", "the line")),
        "series": variable("time", x, "1", "signal, thinned where it was sampled finely"),
    }
    coords = {
        "time": variable("time", np.arange(x.size) * thin / rate, unit, "time"),
        "frequency": variable("frequency", spectrum["frequency"] * rate, f"1/{unit}", "frequency"),
    }
    return data, coords


def _lag(x: Array, swing: int, votes: dict[str, Any], data: dict[str, Any], coords: dict[str, Any]) -> int:
    """Lag of the embedding [samples]."""
    part = x[:NEIGHBOURS]
    longest = min(2 * swing + 2, part.size // 10)
    information = mutual_information(part, longest, bins=16 if part.size > 6000 else 7)
    lag = int(information["first_minimum"])
    votes["lag"] = {"vote": None, "samples": lag, "from": "first minimum of the mutual information"}
    if not lag:
        lag = max(swing // 4, 1)
        votes["lag"] |= {"samples": lag, "from": "a quarter swing: the mutual information has no minimum"}
    coords["lag"] = variable("lag", information["lag"].values, "1", "lag in samples")
    data["mutual_information"] = variable("lag", information["mutual_information"].values, "bit", "mutual information")
    return lag


def _dimension(
    x: Array, lag: int, swing: int, votes: dict[str, Any], data: dict[str, Any], coords: dict[str, Any]
) -> tuple[int, int]:
    """Lag, shortened where that helps, and dimension; dimension 0 where false neighbours find none."""
    part = x[:NEIGHBOURS]
    most = min(8, max((part.size - 200) // (2 * lag), 1))
    first = lag
    for shorter in dict.fromkeys(max(first // k, 1) for k in (1, 2, 4)):
        neighbours = false_neighbours(part, lag=shorter, most=most, theiler=swing, enough=0.02)
        dimension = int(neighbours["dimension_found"])
        if dimension:
            lag = shorter
            break
    if lag != first:
        votes["lag"] |= {"samples": lag, "from": f"false neighbours end at no dimension with the lag {first}, but here"}
    coords["dimension"] = variable("dimension", neighbours["dimension"].values, "1", "embedding dimension")
    data["false_neighbours"] = variable("dimension", neighbours["fraction"].values, "1", "share of false neighbours")
    votes["neighbours"] = {"vote": "ok" if dimension else "no-dimension", "dimension": dimension or None}
    return lag, dimension


def _zero_one_vote(x: Array, lag: int) -> dict[str, Any]:
    thinned = x[::lag][:4000]
    if thinned.size < 300:
        return {"vote": "none", "value": None, "reason": f"{thinned.size} samples {lag} apart are too few"}
    found = zero_one_test(thinned, damping=DAMPING)
    K, low = float(found["K"][0]), float(found["K_low"][0])
    status = ZERO_ONE_STATUS[int(found["status"][0])]
    vote = "chaotic" if K > WANDERS and low > 0.3 else "regular" if K < BOUNDED and status == "ok" else "none"
    return {"vote": vote, "value": K, "lower_quartile": low, "points": thinned.size, "status": status}


def _embedded(
    x: Array, lag: int, dimension: int, swing: int, rate: float,
    votes: dict[str, Any], data: dict[str, Any], coords: dict[str, Any],
) -> None:  # fmt: skip
    """Exponents, dimension and recurrence of the embedded signal."""
    exponents, factor = signal_exponents(x, dimension=dimension, lag=lag, swing=swing, rate=rate)
    for name, found in exponents.items():
        status = str(found["status"].attrs["flag_meanings"]).split()[int(found["status"])]
        value, error = float(found["exponent"]), float(found["exponent_error"])
        positive = status == "ok" and value > 2 * error
        votes[name] = {
            "vote": "positive" if positive else status if status != "ok" else "none", "value": _finite(value),
            "error": _finite(error),
            "range": [int(found[end]) for end in ("range_begin", "range_end")] if status == "ok" else None,
        }  # fmt: skip
        data[name] = variable("step", found["divergence"].values, "1", f"mean logarithm of distances, {name}")
    coords["step"] = variable("step", np.arange(found.sizes["step"]) / factor, "1", "samples")
    vectors = delay_embedding(x, dimension=dimension, lag=lag)
    every = max(len(vectors) // VECTORS, 1)
    d = correlation_dimension(vectors[::every], theiler=max(ceil(swing / every), 1))
    status = str(d["status"].attrs["flag_meanings"]).split()[int(d["status"])]
    votes["dimension"] = {"vote": status, "value": _finite(float(d["D2"])), "error": _finite(float(d["D2_error"]))}
    for key, v in d.data_vars.items():
        data[f"dimension_{key}"] = v
    coords |= {str(key): c.variable for key, c in d.coords.items()}
    r = recurrence(vectors[:: max(lag, 1)][:RECURRENT], theiler=max(ceil(swing / max(lag, 1)), 1))
    votes["recurrence"] = {"vote": None, "rate": float(r["recurrence_rate"]), "determinism": float(r["determinism"])}


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None
