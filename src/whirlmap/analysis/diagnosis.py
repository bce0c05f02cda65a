"""Everything there is to know about one operating point, from one set of runs.

1. A swarm of start states settles; each is tested for a return (`returns`).
2. Tangent vectors run along until the error of the largest exponent is small enough.
3. Where the motion does not return, section points of the whole swarm, once per common period, give the correlation
   dimension, and a time series gives the spectral lines.
4. The label is periodic(n), contact or diverged where all evidence agrees; else `undecided`, with the numbers.
"""

import json
from collections.abc import Callable
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from sympy import sympify

from whirlmap.analysis.dimension import correlation_dimension
from whirlmap.analysis.kaplan_yorke import kaplan_yorke
from whirlmap.analysis.lyapunov import BLOCKS, exponents, mean_and_error
from whirlmap.analysis.points import cyclic_states, make_ensemble, run_attributes
from whirlmap.analysis.returns import Returns, Settling, settle_and_record
from whirlmap.analysis.spectrum import power_spectrum, spectral_lines
from whirlmap.analysis.trajectory import outputs_of
from whirlmap.errors import RangeError
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.system import System
from whirlmap.kernels.source import LANES
from whirlmap.results.regime import Regime
from whirlmap.results.schema import names_coordinate, regime_variable, status_variable, variable, with_attributes
from whirlmap.results.status import Status

Array = NDArray[np.float64]

#: Relative and absolute error of the largest exponent at which its run stops.
ENOUGH = (0.02, 0.002)
#: T in the first stretch of its run; the run doubles until the error is small enough.
FIRST_STRETCH = 512


def diagnose(
    system: System,
    *,
    settling: Settling | None = None,
    exponent_count: int | None = None,
    max_periods: int = 3200,
    points: int = 5000,
    record: int = 512,
    steps: int | None = None,
    method: str = "rk4",
    workers: int | None = None,
    progress: Callable[[int], None] | None = None,
) -> xr.Dataset:
    """Measure one operating point.

    Parameters
    ----------
    settling : Settling, optional
        Transient, windows and tolerance.
    exponent_count : int, optional
        Number of exponents, largest first; where absent 4, or as many as there are states.
    max_periods : int
        Common periods after which the exponents stop, whatever their error.
    points : int
        Section points of the correlation dimension, over the whole swarm.
    record : int
        Least T of the recorded time series, rounded up to whole common periods.

    Returns
    -------
    xr.Dataset
        Label and numbers as scalars; ``x(time, state)``, ``outputs(time, output)``, ``section(run, period, state)``,
        ``running(block, exponent)``, spectra and, where measured, the correlation sum. ``attrs["indicators"]`` is a JSON
        object of every vote.
    """
    settling = settling or Settling()
    n = system.model.dimension
    count = min(4, n) if exponent_count is None else exponent_count
    if not 1 <= count <= n:
        raise RangeError(f"{system.model.name} has {n} exponents; {count} were asked for")
    for name, given, least in (("max_periods", max_periods, 16), ("points", points, 1), ("record", record, 1)):
        if given < least:
            raise RangeError(f"{name} must be at least {least}, not {given}")
    swarm = {system.parameters[0]: np.full(LANES, system.vector[0])}
    ensemble, found = make_ensemble(system, swarm, steps=steps, method=method, workers=workers, swarm=True)
    returns = settle_and_record(ensemble, settling, cyclic=cyclic_states(system), progress=progress)
    data = _label_data(ensemble, returns, found)
    votes: dict[str, Any] = {"return": _return_vote(returns)}
    alive = np.flatnonzero(ensemble.running)
    coords: dict[str, Any] = {
        "state": names_coordinate("state", system.states, "state"),
        "output": names_coordinate("output", list(system.model.outputs), "output"),
        "quantity": names_coordinate("quantity", [*system.states, *system.model.outputs], "state or output"),
    }
    if alive.size:
        part = ensemble.subset(alive)
        votes["lyapunov"] = _exponents(system, part, count, max_periods, steps, method, workers, progress, data)
        _record(system, part, record, data, coords, votes)
        open_motion = votes["return"]["vote"] != "periodic"
        _section(part, points if open_motion else 2 * LANES, data, votes, measure=open_motion, progress=progress)
    label, confidence = _decide(returns, votes)
    data["regime"] = regime_variable((), label)
    data["confidence"] = variable((), confidence, "1", "fraction of the start states that carry the label")
    ds = xr.Dataset(data, coords=coords)
    facts = {
        "indicators": json.dumps(votes), "common_multiple": ensemble.common_multiple,
        "period_T_time": float(ensemble.period[0]), "transient": settling.transient,
        "clocks": json.dumps(turns_per_T(system)),
    }  # fmt: skip
    return with_attributes(ds, run_attributes(system, ensemble, **facts))


def turns_per_T(system: System) -> dict[str, float]:
    """Turns that each named clock makes in one T."""
    numbers = {p: float(system.values[p.name]) for p in system.model.parameters}
    return {
        name: float(sympify(rate).subs(numbers)) * system.period / (2 * np.pi)
        for name, rate in system.model.clocks.items()
    }


def _label_data(ensemble: Ensemble, r: Returns, found: NDArray[np.bool_]) -> dict[str, Any]:
    data: dict[str, Any] = {
        "status": status_variable((), ensemble.status[0]),
        "run_status": status_variable("run", ensemble.status),
        "run_regime": regime_variable("run", r.regime),
        "end_time": variable((), ensemble.end_time[0], "time", "time at which the first run ended early"),
        "period_T": variable((), r.period[0], "T", "smallest return, 0 where none was found"),
        "period_common": variable((), r.multiple[0], "1", "smallest return in common periods, 0 where none"),
        "return_distance": variable((), r.distance[0], "1", "return distance over the range of each state"),
        "start_found": variable((), int(found[0]), "1", "whether the default start exists"),
    }
    pp = (r.extremes["maximum"] - r.extremes["minimum"])[:, 0]
    data["peak_to_peak"] = variable("quantity", pp, "1", "peak-to-peak over the record")
    data["rms"] = variable("quantity", r.extremes["rms"][:, 0], "1", "rms about the mean over the record")
    data["maximum"] = variable("quantity", r.extremes["maximum"][:, 0], "1", "largest value over the record")
    return data


def _return_vote(r: Returns) -> dict[str, Any]:
    same = bool((r.regime == r.regime[0]).all() and (r.period == r.period[0]).all())
    vote = Regime(int(r.regime[0])).label if same else "undecided"
    return {
        "vote": vote, "period": int(r.period[0]) or None, "period_common": int(r.multiple[0]) or None,
        "distance": _number(r.distance[0]), "starts_agree": same,
    }  # fmt: skip


def _exponents(
    system: System, part: Ensemble, count: int, most: int, steps: int | None, method: str, workers: int | None,
    progress: Callable[[int], None] | None, data: dict[str, Any],
) -> dict[str, Any]:  # fmt: skip
    repeat = {system.parameters[0]: np.full(part.points, system.vector[0])}
    tangent, _ = make_ensemble(
        system, repeat, starts=part.x, steps=steps, method=method, tangents=count, workers=workers
    )
    pieces: list[Array] = []
    done, stretch = 0, min(max(FIRST_STRETCH // part.common_multiple, BLOCKS), most)
    while True:
        pieces.append(exponents(tangent, stretch, align=16 if not pieces else 0, progress=progress))
        done += stretch
        rates = np.concatenate(pieces)
        good = tangent.running
        value, error = _swarm_mean(rates[:, :, good])
        if not good.any() or error[0] <= max(ENOUGH[0] * abs(value[0]), ENOUGH[1]):
            reason = "error small enough"
            break
        if done >= most:
            reason = f"stopped at {done} common periods"
            break
        stretch = min(done, most - done)
    order = np.argsort(-value)  # nearly equal exponents may come out of the kernel in either order
    value, error = value[order], error[order]
    running = np.cumsum(rates[:, order][:, :, good].mean(axis=2), axis=0) / np.arange(1, done + 1)[:, None]
    per_time = "1/time"
    data["lyapunov"] = variable("exponent", value, per_time, "Lyapunov exponent, largest first")
    data["lyapunov_error"] = variable("exponent", error, per_time, "one standard error of the exponent")
    data["running"] = variable(("block", "exponent"), running, per_time, "mean exponent up to each common period")
    data["phase_exponent"] = variable(
        (), 0.0 if system.model.forced else np.nan, per_time, "exponent of the forcing's phase, left out of the list"
    )
    vote = "positive" if value[0] > 3 * error[0] else "negative" if value[0] < -3 * error[0] else "zero"
    return {"vote": vote, "value": _number(value[0]), "error": _number(error[0]), "periods": done, "stopped": reason}


def _swarm_mean(rates: Array) -> tuple[Array, Array]:
    """Mean over runs, and its error.

    The error is the largest of the scatter between runs, the block error within them, and a quarter of the difference
    between the halves of the record, which shows tangent vectors that still turn into place.
    """
    if rates.shape[2] == 0:
        return np.full(rates.shape[1], np.nan), np.full(rates.shape[1], np.nan)
    means, errors = mean_and_error(rates)
    runs = means.shape[1]
    within = np.sqrt((errors**2).sum(axis=1)) / runs
    between = means.std(axis=1, ddof=1) / np.sqrt(runs) if runs > 1 else within
    half = rates.shape[0] // 2
    drift = np.abs(rates[:half].mean(axis=(0, 2)) - rates[half:].mean(axis=(0, 2))) / 4
    return means.mean(axis=1), np.maximum(np.maximum(within, between), drift)


def _record(
    system: System, part: Ensemble, record: int, data: dict[str, Any], coords: dict[str, Any], votes: dict[str, Any]
) -> None:
    """Time series of the first run, its spectrum and lines."""
    first = part.subset(np.array([0]))
    common = first.common_multiple
    kept = -(-record // common) * common
    total = kept * first.steps
    every = max(first.steps // 32, 1)
    while total % every:
        every -= 1
    x = first.advance(kept, save_every=every).saved[:, :, 0]
    turn = np.arange(1, x.shape[0] + 1) * every / first.steps
    coords["time"] = variable("time", turn * float(first.period[0]), "time", "time since the record began")
    coords["turn"] = variable("time", turn, "T", "time since the record began, in periods T")
    data["x"] = variable(("time", "state"), x, "1", "state")
    data["outputs"] = variable(("time", "output"), outputs_of(system.model, system.vector, x.T).T, "1", "output")
    if first.running[0] and system.model.swing:
        row = system.states.index(system.model.swing[0].name)
        spectrum = power_spectrum(x[:, row], rate=first.steps / every, unit="T")
        lines = spectral_lines(spectrum)
        votes["spectrum"] = {
            "state": system.states[row], "lines": int(lines["count"]),
            "broadband_fraction": _number(lines["broadband_fraction"]), "vote": None,
        }  # fmt: skip


def _section(
    part: Ensemble, points: int, data: dict[str, Any], votes: dict[str, Any], *, measure: bool,
    progress: Callable[[int], None] | None,
) -> None:  # fmt: skip
    common = part.common_multiple
    each = max(-(-points // part.points), 8)
    saved = part.advance(each * common, save_every=common * part.steps, progress=progress).saved
    section = np.moveaxis(saved, 2, 0)
    data["section"] = variable(("run", "period", "state"), section, "1", "section point, once per common period")
    good = section[part.running]
    if not measure or not good.size:
        return
    flat = good.reshape(-1, good.shape[2])
    runs = np.repeat(np.arange(good.shape[0]), good.shape[1])
    d = correlation_dimension(flat, theiler=10, trajectories=runs)
    status = str(d["status"].attrs["flag_meanings"]).split()[int(d["status"])]
    votes["dimension"] = {"vote": status, "value": _number(d["D2"]), "error": _number(d["D2_error"])}
    for name, v in d.data_vars.items():
        data[f"dimension_{name}"] = v
    data |= {str(name): c.variable for name, c in d.coords.items() if name not in data}


def _decide(r: Returns, votes: dict[str, Any]) -> tuple[Regime, float]:
    label = Regime(int(r.regime[0]))
    confidence = float(np.mean((r.regime == r.regime[0]) & (r.period == r.period[0])))
    if not votes["return"]["starts_agree"]:
        return Regime.undecided, confidence
    if label == Regime.periodic and votes.get("lyapunov", {}).get("vote") == "positive":
        return Regime.undecided, confidence
    return label, confidence


def verdict_json(ds: xr.Dataset) -> dict[str, Any]:
    """What ``diagnose --json`` prints: label, evidence and amplitudes as plain numbers, unknown ones as None."""
    votes = json.loads(ds.attrs["indicators"])
    exponent = ds["lyapunov"].values if "lyapunov" in ds else np.zeros(0)
    common_time = ds.attrs["period_T_time"] * ds.attrs["common_multiple"]
    n = int(ds["period_T"])
    amplitude = {
        str(q): {"peak_to_peak": _number(ds["peak_to_peak"].sel(quantity=q)), "rms": _number(ds["rms"].sel(quantity=q))}
        for q in ds["quantity"].values
    }
    eccentricity = {
        str(q): _number(ds["maximum"].sel(quantity=q)) for q in ds["quantity"].values if str(q).startswith("eps")
    }
    dimension = votes.get("dimension", {})
    periodic = Regime(int(ds["regime"])) == Regime.periodic
    return {
        "regime": Regime(int(ds["regime"])).label,
        "period": n if periodic else None,
        "period_common": int(ds["period_common"]) if periodic else None,
        "period_turns": {k: abs(v) * n for k, v in json.loads(ds.attrs["clocks"]).items()} if periodic else None,
        "confidence": _number(ds["confidence"]),
        "lyapunov": [_number(v) for v in exponent],
        "lyapunov_error": [_number(v) for v in ds["lyapunov_error"].values] if "lyapunov" in ds else [],
        "lyapunov_per_common_period": [_number(v * common_time) for v in exponent],
        "phase_exponent": _number(ds["phase_exponent"]) if "phase_exponent" in ds else None,
        "kaplan_yorke": kaplan_yorke(exponent),
        "correlation_dimension": dimension.get("value"),
        "correlation_dimension_error": dimension.get("error"),
        "indicators": votes,
        "amplitude": amplitude,
        "max_eccentricity": eccentricity,
        "min_film": {k: None if v is None else 1 - v for k, v in eccentricity.items()},
        "status": Status(int(ds["status"])).name,
        "end_time": _number(ds["end_time"]),
    }


def _number(value: Any) -> float | None:
    number = float(value)
    return number if np.isfinite(number) else None
