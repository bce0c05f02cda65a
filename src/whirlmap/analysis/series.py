"""Diagnosis of a recorded signal: the indicators that need no equations, and what they say together."""

import json
from math import ceil
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray
from scipy import signal

from whirlmap.analysis.dimension import correlation_dimension
from whirlmap.analysis.embedding import delay_embedding, false_neighbours, mutual_information
from whirlmap.analysis.lines import named_shares
from whirlmap.analysis.recurrence import recurrence
from whirlmap.analysis.signal_exponents import signal_exponents
from whirlmap.analysis.spectral_lines import spectral_lines
from whirlmap.analysis.spectrum import power_spectrum
from whirlmap.analysis.zero_one import STATUS as ZERO_ONE_STATUS
from whirlmap.analysis.zero_one import zero_one_test
from whirlmap.errors import RangeError
from whirlmap.results.provenance import package_version
from whirlmap.results.regime import Regime
from whirlmap.results.schema import regime_variable, variable, with_attributes

Array = NDArray[np.float64]

#: Samples below which nothing is said, and swings of the motion below which nothing is.
FEWEST, FEWEST_SWINGS = 1000, 30
#: Share of the power in the strongest bins, over which the mean frequency is taken: noise lies in the others.
STRONG = 0.95
#: Samples per swing to which a finely sampled signal is thinned before it is embedded.
FINE = 40
#: Samples whose false neighbours, vectors whose distances, and points whose recurrences are looked at.
NEIGHBOURS, VECTORS, RECURRENT = 12_000, 8_000, 1_500
#: Damping of the 0-1 test, for noise.
DAMPING = 1.0
#: Shares of the power: of one line that counts, of all lines in regular motion, outside of lines in broadband motion.
LINE, LINES, BROAD = 1e-3, 0.98, 0.1
CITED = "gottwald2009 rosenstein1993 kantz1994 savitzky1964 fraser1986 kennel1992 grassberger1983 theiler1986 marwan2007"
#: K of the 0-1 test above and below which it has a say; clean sections allow tighter ones (`regime`).
WANDERS, BOUNDED = 0.8, 0.3


def diagnose_series(values: ArrayLike, *, rate: float, unit: str = "s") -> xr.Dataset:
    """Say of a recorded signal whether it is periodic, quasi-periodic or chaotic, with the evidence.

    Parameters
    ----------
    values : array, shape (time,)
        Evenly spaced samples of a steady motion.
    rate : float
        Samples per unit of time.
    unit : str
        Unit of time.

    Returns
    -------
    xr.Dataset
        ``regime``, ``series(time)``, and under the names of their functions what the indicators gave: spectrum and lines,
        ``mutual_information(lag)``, ``false_neighbours(dimension)``, ``rosenstein(step)``, ``kantz(step)`` and
        ``dimension_*``. ``attrs["indicators"]`` is a JSON object of every vote, ``attrs["verdict"]`` some sentences.

    Raises
    ------
    RangeError
        Fewer than 1000 samples or 30 swings, a constant signal, numbers that are not finite, a rate that is not positive.

    Notes
    -----
    1. The root mean square frequency, over the strongest bins of the spectrum that hold 95 % of the power, gives the
       swing. A signal with more than 80 samples per swing is thinned, after an anti-alias filter, to about 40;
       exponents and dimension are of the thinned signal.
    2. Lag from the first minimum of the mutual information (without one, a quarter swing, which is said), dimension from
       false neighbours; without one at that lag, nor at a half or a quarter of it, none of the embedded indicators
       speaks: noise, or too many dimensions.
    3. Exponents as `signal_exponents` says.
    4. Chaotic: the 0-1 test wanders, the lines do not hold all of the power, Rosenstein's or Kantz's exponent is
       positive over a scaling range, and so is the other, or the dimension has one: coloured noise may show one of them
       by chance. Regular: the lines do, the 0-1 test does not wander, and Rosenstein's exponent is not
       seen; periodic where all strong lines are multiples and fractions of one frequency, quasi-periodic where they
       need two. Else undecided.

    A signal says less than equations: exponents have no other error than the scatter within the one record, slow drift
    looks like slow motion, coloured noise can imitate a low dimension, and filters add dimensions.
    """
    x, thin, swing, spectrum = _prepared(values, rate)
    lines = spectral_lines(spectrum)
    votes: dict[str, Any] = {"spectrum": _spectrum_vote(lines, float(spectrum["frequency_step"]))}
    data: dict[str, Any] = {
        "power": variable("frequency", spectrum["power"].values, "1", "power of a line, a^2/2"),
        "line_frequency": variable("line", lines["line_frequency"].values, f"1/{unit}", "frequency of the line"),
        "line_power": variable("line", lines["line_power"].values, "1", "power of the line"),
        "series": variable("time", x, "1", "signal, thinned where it was sampled finely"),
    }
    coords = {
        "time": variable("time", np.arange(x.size) * thin / rate, unit, "time"),
        "frequency": variable("frequency", spectrum["frequency"].values, f"1/{unit}", "frequency"),
    }
    lag, dimension = _embedding(x, swing, votes, data, coords)
    votes["zero_one"] = _zero_one_vote(x, lag)
    if dimension:
        _embedded(x, lag, dimension, swing, rate / thin, votes, data, coords)
    label, confidence = _decide(votes)
    data["regime"] = regime_variable((), label)
    data["confidence"] = variable((), confidence, "1", "share of the indicators with a vote that speak for the regime")
    facts = {
        "rate": rate, "unit": unit, "samples": int(np.size(values)), "thinned": thin, "swing": swing * thin / rate,
        "lag": lag, "embedding_dimension": dimension, "indicators": json.dumps(votes),
        "verdict": _sentences(label, votes, unit), "whirlmap_version": package_version("whirlmap"),
        "citations": CITED,
    }  # fmt: skip
    return with_attributes(xr.Dataset(data, coords=coords), facts)


def series_json(ds: xr.Dataset) -> dict[str, Any]:
    """Label, sentences and votes of `diagnose_series` as plain data; unknown numbers as None."""
    votes = json.loads(ds.attrs["indicators"])
    keys = ("rate", "samples", "thinned", "swing", "lag", "embedding_dimension")
    return {
        "regime": Regime(int(ds["regime"])).label, "confidence": float(ds["confidence"]), "verdict": ds.attrs["verdict"],
        "lyapunov": votes.get("rosenstein", {}).get("value"), "lyapunov_error": votes.get("rosenstein", {}).get("error"),
        "correlation_dimension": votes.get("dimension", {}).get("value"),
        "correlation_dimension_error": votes.get("dimension", {}).get("error"), "indicators": votes,
        **{key: ds.attrs[key] for key in keys},
    }  # fmt: skip


def _prepared(values: ArrayLike, rate: float) -> tuple[Array, int, int, xr.Dataset]:
    """Signal, thinned; by how much; samples per swing; spectrum of the whole."""
    raw = np.asarray(values, dtype=np.float64)
    if raw.ndim != 1 or raw.size < FEWEST:
        raise RangeError(f"the signal has shape {raw.shape}: one series of at least {FEWEST} samples is needed")
    if not np.isfinite(raw).all():
        at = int(np.flatnonzero(~np.isfinite(raw))[0])
        raise RangeError(f"sample {at + 1} of the signal is {raw[at]}: all must be finite numbers")
    if not 0 < rate < np.inf:
        raise RangeError(f"rate = {rate}: a positive number of samples per unit of time is needed")
    if np.ptp(raw) <= 1e-12 * np.abs(raw).max():
        raise RangeError(f"the signal is constant ({raw[0]:g}): there is no motion in it")
    spectrum = power_spectrum(raw, rate=rate)
    power = spectrum["power"].values.copy()
    power[:2] = 0.0  # offset and slow drift are no swing
    strongest = np.argsort(-power, kind="stable")
    held = strongest[: int(np.searchsorted(np.cumsum(power[strongest]), STRONG * power.sum())) + 1]
    squares = spectrum["frequency"].values[held] ** 2
    swing = rate / float(np.sqrt(np.average(squares, weights=power[held])))
    if raw.size < FEWEST_SWINGS * swing:
        raise RangeError(
            f"the signal holds {raw.size / swing:.3g} swings of its mean frequency, {rate / swing:.4g}:"
            f" at least {FEWEST_SWINGS} are needed. Record longer, or take off a slow drift."
        )
    thin = int(swing // FINE) if swing > 2 * FINE else 1
    x = raw - raw.mean()
    if thin > 1:
        edge = 20  # the filter's reach, in samples of the thinned signal
        x = signal.resample_poly(x, 1, thin)[edge:-edge]
    return x, thin, max(ceil(swing / thin), 2), spectrum


def _spectrum_vote(lines: xr.Dataset, step: float) -> dict[str, Any]:
    broad = float(lines["broadband_fraction"])
    named = [line for line in named_shares(lines, {}, step=step) if float(str(line["share"])) > LINE]
    words = " ".join(str(line["name"]) for line in named)
    vote = "none"
    if broad > BROAD:
        vote = "broadband"
    elif 1 - broad > LINES and named and all(line["name"] for line in named):
        vote = "quasi-periodic" if "f2" in words else "periodic"
    return {"vote": vote, "broadband_fraction": broad, "lines": int(lines["count"]), "named": named}


def _embedding(
    x: Array, swing: int, votes: dict[str, Any], data: dict[str, Any], coords: dict[str, Any]
) -> tuple[int, int]:
    """Lag and dimension; dimension 0 where false neighbours find none."""
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


def _decide(votes: dict[str, Any]) -> tuple[Regime, float]:
    """Combine the votes; one against, and it is undecided."""
    wanders = votes["zero_one"]["vote"]
    lines = votes["spectrum"]["vote"]
    grows = [votes.get(name, {}).get("vote") for name in ("rosenstein", "kantz")]
    structure = [*(g == "positive" for g in grows), votes.get("dimension", {}).get("vote") == "ok"]
    if wanders == "chaotic" and any(structure[:2]) and sum(structure) >= 2 and lines not in ("periodic", "quasi-periodic"):
        speaks = [True, *structure, lines == "broadband"]
        return Regime.chaotic, sum(speaks) / len(speaks)
    # On a torus whole neighbourhoods shear apart for a while, so that Kantz's curve alone is no veto.
    if lines in ("periodic", "quasi-periodic") and wanders != "chaotic" and grows[0] != "positive":
        speaks = [True, wanders == "regular", grows[1] != "positive"]
        return (Regime.periodic if lines == "periodic" else Regime.quasi_periodic), sum(speaks) / len(speaks)
    return Regime.undecided, 0.0


def _sentences(label: Regime, votes: dict[str, Any], unit: str) -> str:
    """Say in plain words what the signal is, and why."""
    spectrum, zero_one = votes["spectrum"], votes["zero_one"]
    share = 100 * (1 - spectrum["broadband_fraction"])
    said = {
        Regime.chaotic: "The signal is chaotic.",
        Regime.periodic: "The signal is periodic.",
        Regime.quasi_periodic: "The signal is quasi-periodic.",
        Regime.undecided: "The indicators do not agree on what the signal is.",
    }[label]
    text = [said, f"{spectrum['lines']} spectral lines hold {share:.4g} % of its power."]
    if zero_one["value"] is not None:
        text.append(f"The 0-1 test gives {zero_one['value']:.2f} (0 regular, 1 chaotic).")
    if votes["neighbours"]["vote"] == "no-dimension":
        text.append("No embedding dimension up to 8 unfolds it: noise, or motion of many dimensions.")
    for name in ("rosenstein", "kantz"):
        if name in votes:
            v = votes[name]
            text.append(
                f"The exponent after {name.capitalize()} is {v['value']:.3g} +- {v['error']:.2g} per {unit}."
                if v["value"] is not None
                else f"After {name.capitalize()} neighbours do not part exponentially ({v['vote']})."
            )
    d = votes.get("dimension")
    if d:
        has = d["value"] is not None
        text.append(f"D2 is {d['value']:.3g} +- {d['error']:.2g}." if has else f"It has no dimension ({d['vote']}).")
    return " ".join(text)


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None
