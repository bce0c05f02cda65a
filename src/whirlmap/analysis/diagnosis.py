"""Everything there is to know about one operating point, from one set of runs.

1. A swarm of start states settles; each is tested for a return (`returns`).
2. Tangent vectors run along until the error of the largest exponent is small enough (`tangent_run`). Where nothing
   returned though the motion contracts, it is given the time that this takes, and tested once more.
3. Periodic motion gets its Floquet multipliers; other motion the 0-1 test, Birkhoff averages and rotation number of its
   section points, their recurrence, and the correlation dimension. A time series gives the spectral lines.
4. `regime` combines the votes; where start states or indicators disagree the label is `undecided`, with the numbers.
"""

import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from sympy import sympify

from whirlmap.analysis.kaplan_yorke import kaplan_yorke, kaplan_yorke_error
from whirlmap.analysis.lyapunov import BLOCKS
from whirlmap.analysis.measures import judge_section, multipliers, number, record_series, section_and_dimension
from whirlmap.analysis.points import cyclic_states, make_ensemble, run_attributes, tangent_steps
from whirlmap.analysis.returns import Returns, first_drift, settle_and_record
from whirlmap.analysis.settling import Settling
from whirlmap.analysis.tangent_run import TangentRun, exponents_to_error
from whirlmap.analysis.unbounded import Trends, label_trends
from whirlmap.errors import RangeError
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.rescue import end_named
from whirlmap.integrate.system import System
from whirlmap.results.findings import Findings, gives_dataset
from whirlmap.results.regime import Regime
from whirlmap.results.schema import names_coordinate, plain_attributes, regime_variable, status_variable, variable
from whirlmap.results.status import Status

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]

#: Start states that run side by side; how much they scatter is the error of an exponent.
RUNS = 32
#: Motions without an attractor other than a place of rest.
ENDLESS = (Regime.at_rest, Regime.drifting, Regime.growing, Regime.not_settled)
#: Section points, in common periods, that the indicators of open motion are given.
SECTION = 2048
#: A motion that contracts is given the time to shrink by this, and at most so many common periods, to return.
SHRINK, LONGEST = 1e-9, 50_000


@gives_dataset
def diagnose(
    system: System,
    *,
    settling: Settling | None = None,
    exponent_count: int | None = None,
    max_periods: int = 3200,
    points: int = 5000,
    record: int = 512,
    steps: int | None = None,
    accuracy: float | None = None,
    method: str | None = None,
    workers: int | None = None,
    progress: Callable[[int], None] | None = None,
) -> Findings:
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
    steps, accuracy, method, workers
        As in `make_ensemble`.

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
    swarm = {system.parameters[0]: np.full(RUNS, system.vector[0])}
    ensemble, found = make_ensemble(
        system, swarm, steps=steps, accuracy=accuracy, method=method, workers=workers, swarm=True,
    )  # fmt: skip
    look = _Look(system, count, max_periods, progress)
    returns = settle_and_record(ensemble, settling, cyclic=cyclic_states(system), progress=progress)
    run = look.exponents(ensemble, int(returns.multiple[0]) if _all_return(returns) else 0)
    slowest = run.contraction(forced=system.model.forced) if run is not None else None
    if slowest is not None and not _all_return(returns):
        common = ensemble.common_multiple * float(ensemble.period[0])
        extra = min(int(np.log(SHRINK) / (slowest * common)) + 1, LONGEST)
        later = replace(settling, transient=extra)
        returns = settle_and_record(ensemble, later, cyclic=cyclic_states(system), progress=progress)
    data = _label_data(ensemble, returns, found)
    votes: dict[str, Any] = {"return": _return_vote(returns)}
    coords: dict[str, Any] = {
        "state": names_coordinate("state", system.states, "state"),
        "output": names_coordinate("output", list(system.model.outputs), "output"),
        "quantity": names_coordinate("quantity", [*system.states, *system.model.outputs], "state or output"),
    }
    alive = np.flatnonzero(ensemble.running)
    label, confidence = Regime.undecided, 0.0
    if alive.size and run is not None:
        part = ensemble.subset(alive)
        votes["lyapunov"] = _exponent_data(system, run, data)
        periodic, endless = _all_return(returns), returns.regime[alive[0]] in ENDLESS
        if endless:
            label, confidence = Regime(int(returns.regime[alive[0]])), 1.0
        elif periodic:
            votes["floquet"] = multipliers(system, part, int(returns.multiple[0]), int(returns.period[0]), data)
        else:
            exponent = float(run.value[0]), float(run.error[0])
            duration = run.periods * ensemble.common_multiple * float(ensemble.period[0])
            label, confidence, more = judge_section(
                run.alive, run.section, exponent, duration, cyclic_states(system)
            )
            votes |= more
            label, confidence = _trend(
                part, run, exponent, duration, cyclic_states(system), returns, (label, confidence)
            )
        spectrum = record_series(system, part, record, data, coords, turns_per_T(system))
        if spectrum is not None:
            votes["spectrum"] = spectrum
        torus = run.section[:, :, int(np.flatnonzero(run.alive)[0])] if label == Regime.quasi_periodic else None
        dimension = section_and_dimension(
            part, 2 * RUNS if periodic else points, data, members=alive, runs=ensemble.points,
            measure=not periodic and label not in ENDLESS,
            torus=torus, progress=progress,
        )  # fmt: skip
        if dimension is not None:
            votes["dimension"] = dimension
    label, confidence = _decide(returns, votes, label, confidence, forced=system.model.forced)
    state, speed = first_drift(returns.drift[:, :1])
    data["growth_rate"] = variable((), returns.growth[0], "1/time", "rate of the amplitude: what grows, or comes to rest")
    data["drift_rate"] = variable((), speed[0], "1/time", "speed of the first state that drifts, in its unit")
    data["drift_state"] = variable((), state[0], "1", "index of that state, -1: none")
    data["thinning"] = variable((), returns.thinning[0], "1", "power of time with which the narrowest gap falls")
    data["winding"] = variable((), returns.turning[0], "1", "rotation number of a motion whose film thins")
    data["regime"] = regime_variable((), label)
    data["confidence"] = variable(
        (), confidence, "1", "share of the start states, times that of the indicators asked, that speak for the label"
    )
    facts = {
        "indicators": json.dumps(votes), "common_multiple": ensemble.common_multiple,
        "period_T_time": float(ensemble.period[0]), "transient": settling.transient,
        "clocks": json.dumps(turns_per_T(system)), "end_reason": end_named(system.model, int(ensemble.end_stop[0])),
    }  # fmt: skip
    return Findings(data, coords, plain_attributes(run_attributes(system, ensemble, **facts)))


@dataclass(frozen=True)
class _Look:
    """What the exponents' run of one operating point needs."""

    system: System
    count: int
    most: int
    progress: Callable[[int], None] | None

    def exponents(self, ensemble: Ensemble, multiple: int) -> TangentRun | None:
        """Exponents of the runs that go on, from their present states; None where all have ended.

        ``multiple`` is the return of all of them in common periods, 0 where they do not all return alike.
        """
        alive = np.flatnonzero(ensemble.running)
        if not alive.size:
            return None
        least = BLOCKS if multiple else SECTION

        def measured(count: int) -> tuple[TangentRun, bool]:
            repeat = {self.system.parameters[0]: np.full(alive.size, self.system.vector[0])}
            tangent, _ = make_ensemble(
                self.system, repeat, starts=ensemble.x[:, alive], steps=tangent_steps(ensemble)[alive],
                method=ensemble.method.name, tangents=count, workers=ensemble.workers, turn=ensemble.period[alive],
            )  # fmt: skip
            run = exponents_to_error(tangent, least=least, most=self.most, multiple=multiple, progress=self.progress)
            return run, bool((run.status == Status.sticks).any())

        run, sticks = measured(self.count)
        if sticks and self.count > 1:  # a single tangent vector slides with the motion
            run, _ = measured(1)
            run = replace(run, stopped=f"{run.stopped}; the motion sticks, so that only the largest exponent is had")
        return run


def _trend(
    part: Ensemble, run: TangentRun, exponent: tuple[float, float], duration: float, cyclic: dict[int, float],
    returns: Returns, judged: tuple[Regime, float],
) -> tuple[Regime, float]:  # fmt: skip
    """Label of open motion that dies away, grows or drifts for ever, with its rates into ``returns``; else the one given."""
    if not (run.alive.any() and len(run.section)):
        return judged
    first = int(np.flatnonzero(run.alive)[0])
    section = run.section[:, :, [first]]
    time, value, error = (np.array([v]) for v in (duration / len(section), *exponent))
    trends = Trends.of(part.model, part.period[:1], section, time, value, error, cyclic)
    ranges = (returns.extremes["maximum"] - returns.extremes["minimum"])[: part.model.dimension, [first]]
    endless = label_trends(part, np.array([first]), trends, ranges)
    label = Regime(int(endless.regime[0]))
    if label == Regime.undecided:  # a torus does not change its size steadily
        return (label, 0.0) if judged[0] == Regime.quasi_periodic and np.isfinite(trends.growth[0]) else judged
    returns.growth[:], returns.drift[:] = endless.growth, endless.drift
    return label, 1.0


def _all_return(r: Returns) -> bool:
    """Whether all start states came to the same periodic motion."""
    return bool((r.regime == Regime.periodic).all() and (r.period == r.period[0]).all())


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
        "steps": variable("run", ensemble.point_steps, "1/T", "steps per T"),
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
        "distance": number(r.distance[0]), "starts_agree": same,
    }  # fmt: skip


def _exponent_data(system: System, run: TangentRun, data: dict[str, Any]) -> dict[str, Any]:
    per_time = "1/time"
    data["lyapunov"] = variable("exponent", run.value, per_time, "Lyapunov exponent, largest first")
    data["lyapunov_error"] = variable("exponent", run.error, per_time, "one standard error of the exponent")
    data["divergence"] = variable((), run.divergence, per_time, "mean divergence, which all exponents add up to")
    data["divergence_error"] = variable((), run.divergence_error, per_time, "one standard error of it")
    data["running"] = variable(("block", "exponent"), run.running, per_time, "mean exponent up to each common period")
    data["phase_exponent"] = variable(
        (), 0.0 if system.model.forced else np.nan, per_time, "exponent of the forcing's phase, left out of the list"
    )
    value, error = float(run.value[0]), float(run.error[0])
    sign = "positive" if value > 3 * error else "negative" if value < -3 * error else "zero"
    vote = sign if np.isfinite(value) else "none"
    return {
        "vote": vote, "value": number(value), "error": number(error), "periods": run.periods, "stopped": run.stopped,
    }  # fmt: skip


def _decide(
    r: Returns, votes: dict[str, Any], label: Regime, confidence: float, *, forced: bool
) -> tuple[Regime, float]:
    """Label from the returns of all start states and, where none returned, from what the section said."""
    first = Regime(int(r.regime[0]))
    share = float(np.mean((r.regime == r.regime[0]) & (r.period == r.period[0])))
    if not votes["return"]["starts_agree"]:
        return Regime.undecided, 0.0
    if first in (Regime.contact, Regime.diverged, *ENDLESS):
        return first, share
    if first == Regime.periodic:
        against = (votes["lyapunov"]["vote"] == "positive", votes["floquet"]["vote"] == "unstable")
        if any(against):
            return Regime.undecided, 0.0
        expected = "negative" if forced else "zero"  # the time direction of an unforced cycle
        asked = [votes["lyapunov"]["vote"] == expected, votes["floquet"]["vote"] == "stable"]
        return first, share * (1 + sum(asked)) / (1 + len(asked))
    return label, share * confidence


def verdict_json(ds: "Findings | xr.Dataset") -> dict[str, Any]:
    """What ``diagnose --json`` prints: label, evidence and amplitudes as plain numbers, unknown ones as None."""
    votes = json.loads(ds.attrs["indicators"])
    exponent, error = (
        np.asarray(ds[name]) if name in ds else np.zeros(0) for name in ("lyapunov", "lyapunov_error")
    )
    common_time = ds.attrs["period_T_time"] * ds.attrs["common_multiple"]
    n = int(ds["period_T"])
    names = [str(q) for q in np.asarray(ds["quantity"])]
    swing, rms, largest = (map(number, np.asarray(ds[name])) for name in ("peak_to_peak", "rms", "maximum"))
    amplitude = {q: {"peak_to_peak": a, "rms": b} for q, a, b in zip(names, swing, rms, strict=True)}
    eccentricity = {q: e for q, e in zip(names, largest, strict=True) if q.startswith("eps")}
    dimension = votes.get("dimension", {})
    periodic = Regime(int(ds["regime"])) == Regime.periodic
    return {
        "regime": Regime(int(ds["regime"])).label,
        "period": n if periodic else None,
        "period_common": int(ds["period_common"]) if periodic else None,
        "period_turns": {k: abs(v) * n for k, v in json.loads(ds.attrs["clocks"]).items()} if periodic else None,
        "confidence": number(ds["confidence"]),
        "growth_rate": number(ds["growth_rate"]),
        "thinning": number(ds["thinning"]),
        "winding": number(ds["winding"]),
        "drift_rate": number(ds["drift_rate"]),
        "drift_state": str(np.asarray(ds["state"])[int(ds["drift_state"])]) if int(ds["drift_state"]) >= 0 else None,
        "lyapunov": [number(v) for v in exponent],
        "lyapunov_error": [number(v) for v in error],
        "lyapunov_per_common_period": [number(v * common_time) for v in exponent],
        "divergence": number(ds["divergence"]) if "divergence" in ds else None,
        "divergence_error": number(ds["divergence_error"]) if "divergence_error" in ds else None,
        "phase_exponent": number(ds["phase_exponent"]) if "phase_exponent" in ds else None,
        "kaplan_yorke": kaplan_yorke(exponent),
        "kaplan_yorke_error": kaplan_yorke_error(exponent, error) if exponent.size else None,
        "correlation_dimension": dimension.get("value"),
        "correlation_dimension_error": dimension.get("error"),
        "indicators": votes,
        "amplitude": amplitude,
        "max_eccentricity": eccentricity,
        "min_film": {k: None if v is None else 1 - v for k, v in eccentricity.items()},
        "status": Status(int(ds["status"])).name,
        "end_time": number(ds["end_time"]),
        "end_reason": ds.attrs.get("end_reason"),
    }
