"""Votes of the indicators of a signal that are asked of its embedding: lag, dimension, 0-1 test, exponents, D2."""

from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.indicators.correlation_dimension import correlation_dimension
from whirlmap.analysis.indicators.recurrence import recurrence
from whirlmap.analysis.indicators.zero_one import STATUS as ZERO_ONE_STATUS
from whirlmap.analysis.indicators.zero_one import zero_one_test
from whirlmap.analysis.signals.embedding import delay_embedding, false_neighbours, mutual_information
from whirlmap.analysis.signals.signal_exponents import signal_exponents
from whirlmap.results.schema import variable

Array = NDArray[np.float64]

#: Samples used for false neighbours, vectors used for distances, and points used for recurrences.
NEIGHBOURS, VECTORS, RECURRENT = 12_000, 8_000, 1_500
#: Points below which recurrences are not counted.
FEWEST_RECURRENT = 50
#: Damping of the 0-1 test, for noise.
DAMPING = 1.0
#: K of the 0-1 test above and below which it has a say; clean sections allow tighter ones (`regime`).
WANDERS, BOUNDED = 0.8, 0.3


def lag_of(x: Array, swing: int, votes: dict[str, Any], data: dict[str, Any], coords: dict[str, Any]) -> int:
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


def embedding_of(
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


def zero_one_vote(x: Array, lag: int) -> dict[str, Any]:
    """Vote of the 0-1 test on samples one lag apart."""
    thinned = x[::lag][:4000]
    if thinned.size < 300:
        return {"vote": "none", "value": None, "reason": f"{thinned.size} samples {lag} apart are too few"}
    found = zero_one_test(thinned, damping=DAMPING)
    K, low = float(found["K"][0]), float(found["K_low"][0])
    status = ZERO_ONE_STATUS[int(found["status"][0])]
    vote = "chaotic" if K > WANDERS and low > 0.3 else "regular" if K < BOUNDED and status == "ok" else "none"
    return {"vote": vote, "value": K, "lower_quartile": low, "points": thinned.size, "status": status}


def add_embedded(
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
    points, theiler = vectors[:: max(lag, 1)][:RECURRENT], max(ceil(swing / max(lag, 1)), 1)
    if len(points) < max(FEWEST_RECURRENT, 2 * theiler + 2):
        votes["recurrence"] = {"vote": None, "reason": f"{len(points)} vectors {lag} samples apart are too few"}
        return
    r = recurrence(points, theiler=theiler)
    votes["recurrence"] = {"vote": None, "rate": float(r["recurrence_rate"]), "determinism": float(r["determinism"])}


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None
