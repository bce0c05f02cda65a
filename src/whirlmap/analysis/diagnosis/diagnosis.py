"""Diagnosis of one operating point: label, exponents, multipliers, section, spectrum and dimension from one set of runs.

1. An ensemble of perturbed start states is labelled by the same rule as the points of a diagram (`labels.labelling`).
2. Tangent vectors are integrated until the error of the largest exponent is small enough (`exponents_with_section`).
3. Periodic motion gets its Floquet multipliers; other motion the 0-1 test, Birkhoff averages and rotation number of its
   section points, their recurrence, and the correlation dimension. A time series gives the spectral lines.
4. The label is that of the first start state, as in a diagram; undecided where the multipliers of a return are against it.
"""

import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Unpack

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.diagnosis.perturbed_ensemble import (
    multipliers,
    number,
    record_series,
    section_and_dimension,
    section_votes,
)
from whirlmap.analysis.labels.labelling import measure_ensemble
from whirlmap.analysis.labels.regime import Rule
from whirlmap.analysis.motion.ensembles import cyclic_states, make_ensemble, run_attributes, tangent_steps
from whirlmap.analysis.motion.record_length import turns_per_T
from whirlmap.analysis.steady.returns import Returns, first_drift
from whirlmap.analysis.variational.exponents_with_section import TangentRun, exponents_to_error
from whirlmap.errors import RangeError
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.harmonics import common_multiple_attribute
from whirlmap.integrate.step_retry import end_named
from whirlmap.integrate.system import System
from whirlmap.options.computed import BLOCKS, LABELLING, Integration, Labelling
from whirlmap.options.execution import EXECUTION, Execution
from whirlmap.options.taking import LabellingParts, takes_options
from whirlmap.results.findings import Findings, gives_dataset
from whirlmap.results.regime import Regime
from whirlmap.results.schema import names_coordinate, plain_attributes, regime_variable, status_variable, variable
from whirlmap.results.status import Status

Array = NDArray[np.float64]

#: Perturbed start states that run side by side; the scatter of their exponents is the error of an exponent.
RUNS = 32
#: Regimes without an attractor other than an equilibrium.
ENDLESS = (Regime.at_rest, Regime.drifting, Regime.growing, Regime.not_settled)
#: T of the section that the indicators of non-periodic motion are shown with.
SECTION = 2048


@gives_dataset
@takes_options("diagnose")
def diagnose(
    system: System,
    *,
    exponent_count: int | None = None,
    max_periods: int = 16384,
    points: int = 5000,
    record: int = 512,
    labelling: Labelling = LABELLING,
    execution: Execution = EXECUTION,
    **_given: Unpack[LabellingParts],
) -> Findings:
    """Measure one operating point.

    Parameters
    ----------
    system : System
        Its values and start states count.
    exponent_count : int, optional
        Number of exponents, largest first; where absent 4, or as many as there are states.
    max_periods : int
        T after which the exponents stop, whatever their error.
    points : int
        Section points of the correlation dimension, over the whole perturbed ensemble.
    record : int
        Least T of the recorded time series, rounded up to whole common periods.
    labelling : Labelling, optional
        How points are measured; or its parts as keywords, ``settling``, ``lyapunov``, ``method``, ``steps``, ``accuracy``.
    execution : Execution, optional
        How it is run, which changes no number; or its parts as keywords, ``workers``, ``progress``.

    Returns
    -------
    xr.Dataset
        Label and numbers as scalars; ``x(time, state)``, ``outputs(time, output)``, ``section(run, period, state)``,
        ``running(block, exponent)``, spectra and, where measured, the correlation sum. ``attrs["indicators"]`` is a JSON
        object of every vote.

    Raises
    ------
    RangeError
        More exponents than states, an unknown method, steps and an accuracy together, or a count that makes no sense.

    Notes
    -----
    1. 32 runs from starts that differ by 1e-6 settle together; a return within the tolerance makes the motion periodic,
       with multipliers from its orbit (`floquet_multipliers`).
    2. What does not return runs with tangent vectors, in doubling stretches, until the error of the largest exponent is
       below 2 % of it or below 0.002, or until ``max_periods``; the error is the scatter between the runs and within
       them.
    3. Exponent, 0-1 test, weighted Birkhoff averages, spectrum and correlation dimension each have a vote; the label is
       what they agree on, and ``undecided`` where they do not.

    An attractor is that of the one start; `attractors` looks for others. A chaotic transient longer than the run is taken
    for chaos.

    References
    ----------
    [benettin1980] exponents; [kaplan1979] their dimension; [grassberger1983] correlation dimension.
    [gottwald2009] 0-1 test; [das2017] weighted Birkhoff averages; [lust2001] multipliers.
    """
    n = system.model.dimension
    count = min(4, n) if exponent_count is None else exponent_count
    if not 1 <= count <= n:
        raise RangeError(f"{system.model.name} has {n} exponents; {count} were asked for")
    for name, given, least in (("max_periods", max_periods, 16), ("points", points, 1), ("record", record, 1)):
        if given < least:
            raise RangeError(f"{name} must be at least {least}, not {given}")
    many = {system.parameters[0]: np.full(RUNS, system.vector[0])}
    ensemble, found = make_ensemble(
        system, many, perturbed=True, integration=labelling.integration, execution=execution
    )  # fmt: skip
    cyclic = cyclic_states(system)
    progress = execution.progress
    measured = measure_ensemble(system, many, labelling, ensemble, found, progress)
    returns, label = measured.returns, Regime(int(measured.returns.regime[0]))
    same = (returns.regime == returns.regime[0]) & (returns.period == returns.period[0])
    alive = np.flatnonzero(same & ensemble.running)
    periodic = label == Regime.periodic
    look = _Look(system, count, max_periods, progress)
    run = look.exponents(ensemble, alive, int(returns.multiple[0]) if periodic else 0)
    data = _label_data(ensemble, returns, found)
    votes: dict[str, Any] = {
        "rule": {"vote": None, "says": Rule(int(measured.rule[0])).meaning}, "return": _return_vote(returns),
    }  # fmt: skip
    coords: dict[str, Any] = {
        "state": names_coordinate("state", system.states, "state"),
        "output": names_coordinate("output", list(system.model.outputs), "output"),
        "quantity": names_coordinate("quantity", [*system.states, *system.model.outputs], "state or output"),
    }
    if alive.size and run is not None:
        part = ensemble.subset(alive)
        votes["lyapunov"] = _exponent_data(system, run, data)
        if periodic:
            votes["floquet"] = multipliers(system, part, int(returns.multiple[0]), int(returns.period[0]), data)
        elif label not in ENDLESS:
            exponent = float(run.value[0]), float(run.error[0])
            votes |= section_votes(part, run.alive, run.section, exponent, run.periods * float(ensemble.period[0]), cyclic)
        spectrum = record_series(system, part, record, data, coords, turns_per_T(system))
        if spectrum is not None:
            votes["spectrum"] = spectrum
        torus = None
        if label == Regime.quasi_periodic:
            torus = run.section[part.strobe - 1 :: part.strobe, :, int(np.flatnonzero(run.alive)[0])]
        dimension = section_and_dimension(
            part, 2 * RUNS if periodic else points, data, members=alive, runs=ensemble.points,
            measure=not periodic and label not in (*ENDLESS, Regime.locked), torus=torus, progress=progress,
        )  # fmt: skip
        if dimension is not None:
            votes["dimension"] = dimension
    confidence = float(measured.confidence[0] * same.mean())
    if periodic:
        label, confidence = _of_orbit(votes, float(same.mean()), forced=system.model.forced)
    state, speed = first_drift(returns.drift[:, :1])
    data["growth_rate"] = variable((), returns.growth[0], "1/time", "rate of the amplitude: what grows, or comes to rest")
    data["drift_rate"] = variable((), speed[0], "1/time", "speed of the first state that drifts, in its unit")
    data["drift_state"] = variable((), state[0], "1", "index of that state, -1: none")
    data["thinning"] = variable((), returns.thinning[0], "1", "power of time with which the narrowest gap falls")
    turned = measured.winding[0]
    data["rotation_number"] = variable((), turned, "1", "rotation number of the section of motion that does not return")
    data["winding"] = variable((), turned, "1", "former name of rotation_number, for one release")
    data["regime"] = regime_variable((), label)
    data["confidence"] = variable(
        (), confidence, "1", "share of the start states, times that of the indicators asked, that speak for the label"
    )
    data["starts"] = variable((), RUNS, "1", "start states, side by side")
    data["starts_agree"] = variable((), int(same.sum()), "1", "those that came to what the first one came to")
    facts = {
        "indicators": json.dumps(votes),
        **common_multiple_attribute(ensemble.orders),
        "period_T_time": float(ensemble.period[0]), "transient": labelling.settling.transient,
        "clocks": json.dumps(turns_per_T(system)), "end_reason": end_named(system.model, int(ensemble.end_stop[0])),
    }  # fmt: skip
    return Findings(data, coords, plain_attributes(run_attributes(system, ensemble, **facts)))


@dataclass(frozen=True)
class _Look:
    """Arguments of the exponents' run of one operating point."""

    system: System
    count: int
    most: int
    progress: Callable[[int], None] | None

    def exponents(self, ensemble: Ensemble, alive: NDArray[np.intp], multiple: int) -> TangentRun | None:
        """Exponents of runs, from their present states; None where there is none.

        ``multiple`` is the return of all of them in common periods, 0 where they do not return.
        """
        if not alive.size:
            return None

        def measured(count: int) -> tuple[TangentRun, bool]:
            repeat = {self.system.parameters[0]: np.full(alive.size, self.system.vector[0])}
            tangent, _ = make_ensemble(
                self.system, repeat, starts=ensemble.x[:, alive], tangents=count, turn=ensemble.period[alive],
                integration=Integration(ensemble.method.name, tangent_steps(ensemble)[alive]),
                execution=Execution(ensemble.workers),
            )  # fmt: skip
            tangent.turns[:] = ensemble.turns[alive]
            least = BLOCKS if multiple else SECTION
            run = exponents_to_error(tangent, least=least, most=self.most, multiple=multiple, progress=self.progress)
            return run, bool((run.status == Status.sticks).any())

        run, sticks = measured(self.count)
        if sticks and self.count > 1:  # a single tangent vector slides with the motion
            run, _ = measured(1)
            run = replace(run, stopped=f"{run.stopped}; the motion sticks, so that only the largest exponent is had")
        return run


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
    data["running"] = variable(("block", "exponent"), run.running, per_time, "mean exponent up to each T")
    data["phase_exponent"] = variable(
        (), 0.0 if system.model.forced else np.nan, per_time, "exponent of the forcing's phase, left out of the list"
    )
    value, error = float(run.value[0]), float(run.error[0])
    sign = "positive" if value > 3 * error else "negative" if value < -3 * error else "zero"
    vote = sign if np.isfinite(value) else "none"
    return {
        "vote": vote, "value": number(value), "error": number(error), "periods": run.periods, "stopped": run.stopped,
    }  # fmt: skip


def _of_orbit(votes: dict[str, Any], share: float, *, forced: bool) -> tuple[Regime, float]:
    """Label of motion that returns, by what its exponent and multipliers say; with the share of starts that came to it."""
    if votes["lyapunov"]["vote"] == "positive" or votes["floquet"]["vote"] == "unstable":
        return Regime.undecided, 0.0
    expected = "negative" if forced else "zero"  # the time direction of an unforced cycle
    held = votes["floquet"]["vote"] == "neutral" and votes["lyapunov"]["vote"] == "zero"  # friction holds a body anywhere
    asked = [votes["lyapunov"]["vote"] == expected or held, votes["floquet"]["vote"] == "stable" or held]
    return Regime.periodic, share * (1 + sum(asked)) / (1 + len(asked))
