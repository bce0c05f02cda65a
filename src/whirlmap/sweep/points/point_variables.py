"""Measured numbers of operating points as variables of a Dataset, and attributes that warn of doubtful ones."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from whirlmap.analysis.labels.measured import Measured
from whirlmap.analysis.labels.regime import Rule
from whirlmap.analysis.steady.returns import first_drift
from whirlmap.equations.model import Model
from whirlmap.errors import RangeError, nearest
from whirlmap.integrate.accuracy import StepVerdict, doubtful
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.orders import orders_vary
from whirlmap.integrate.system import System, common_multiple_attribute
from whirlmap.results.schema import names_coordinate, regime_variable, status_variable, variable
from whirlmap.results.status import flags
from whirlmap.sweep.points.extremes import extreme_coordinates, extreme_variables

Array = NDArray[np.float64]


def points_dataset(
    system: System, columns: Mapping[str, Array], measured: Measured, *, kept: Sequence[str] = ()
) -> xr.Dataset:
    """Dataset of measured points over ``point``, without attributes; ``kept`` are the states whose section was kept."""
    model = system.model
    data = point_variables("point", measured) | extreme_variables("point", system, measured.returns.extremes)
    data |= common_multiple_variable("point", system, columns, measured)
    coords: dict[str, Any] = {
        name: variable("point", column, model.parameter(name).unit, model.parameter(name).meaning)
        for name, column in columns.items()
    }
    if kept:
        data["section"] = section_variable("point", system, measured, kept)
        coords["period"] = ("period", np.arange(1, measured.returns.section.shape[0] + 1), {"long_name": "T"})
        coords["state"] = names_coordinate("state", kept, "state")
    return xr.Dataset(data, coords | extreme_coordinates(system))


def kept_states(system: System, states: Sequence[str] | None) -> list[str]:
    """States whose section a diagram keeps: those asked for, else the model's displacements, else its first state.

    Raises
    ------
    RangeError
        Where a name is not a state of the model.
    """
    if states is None:
        return [s.name for s in system.model.swing] or [system.states[0]]
    for name in states:
        if name not in system.states:
            raise RangeError(
                f"states: {system.model.name} has no state {name!r}.{nearest(name, system.states)}"
                f"\n  states: {' '.join(system.states)}"
            )
    return list(states)


def section_variable(dim: str, system: System, measured: Measured, kept: Sequence[str]) -> Any:
    """Section of every point, of the states that it was measured with."""
    rows = [system.states.index(name) for name in kept]
    return variable(
        (dim, "period", "state"), measured.returns.section.transpose(2, 0, 1), "1", "section point, once per T",
        unit_of_each=" ".join(system.model.states[k].unit for k in rows),
    )  # fmt: skip


def shared_common_multiple(system: System, varied: Iterable[str], ensemble: Ensemble) -> dict[str, int]:
    """Attribute that says how many T the common period is, where there is one, the same for all points."""
    return {} if orders_vary(system.model, varied) else common_multiple_attribute(ensemble.orders)


def common_multiple_variable(dim: str, system: System, varied: Iterable[str], measured: Measured) -> dict[str, Any]:
    """Variable that says so for each point, where it may differ."""
    if not orders_vary(system.model, varied):
        return {}
    return {"common_multiple": variable(dim, measured.common, "T", "common period of all harmonics")}


def point_variables(dim: str, measured: Measured) -> dict[str, Any]:
    """Variables with one number for each point."""
    m, r = measured, measured.returns
    drifts, speed = first_drift(r.drift)
    return {
        "status": status_variable(dim, m.status),
        "regime": regime_variable(dim, r.regime),
        "period_T": variable(dim, r.period, "T", "smallest return, 0 where none was found; of locked motion n"),
        "period_common": variable(dim, r.multiple, "1", "smallest return in common periods, 0 where none"),
        "return_distance": variable(dim, r.distance, "1", "return distance over the range of each state"),
        "lyapunov": variable(dim, m.exponent, "1/time", "largest Lyapunov exponent of points that do not return"),
        "lyapunov_error": variable(dim, m.exponent_error, "1/time", "one standard error of it, from block means"),
        "lyapunov_periods": variable(dim, m.exponent_periods, "T", "T over which it was measured, 0: not"),
        "confidence": variable(dim, m.confidence, "1", "share of the indicators asked that speak for the regime"),
        "rule": variable(dim, m.rule, "1", "rule that decided the regime, or what is known without one", **flags(Rule)),
        "rotation_number": variable(dim, m.winding, "1", "rotation number of the section of points that do not return"),
        "winding": variable(dim, m.winding, "1", "former name of rotation_number, for one release"),
        "growth_rate": variable(dim, r.growth, "1/time", "rate of the amplitude: what grows, or comes to rest"),
        "drift_rate": variable(dim, speed, "1/time", "speed of the first state that drifts, in its unit"),
        "thinning": variable(dim, r.thinning, "1", "power of time with which the narrowest gap of a film falls"),
        "drift_state": variable(dim, drifts, "1", "index of that state, -1: none"),
        "end_time": variable(dim, m.end_time, "time", "time at which the run ended early"),
        "start_found": variable(dim, m.start_found.astype(np.int8), "1", "whether the default start exists"),
        "settled_after": variable(dim, r.waited, "1", "common periods run before the record"),
        "accelerated": variable(dim, r.accelerated.astype(np.int8), "1", "whether convergence was accelerated"),
        "steps": variable(dim, m.steps, "1/T", "steps per T"),
        "step_error": variable(dim, m.step_error, "1", "measured error over one common period"),
        "step_verdict": variable(
            dim, m.step_verdict, "1", "whether the steps meet the accuracy",
            flag_values=[int(v) for v in StepVerdict], flag_meanings=" ".join(v.name for v in StepVerdict),
        ),
        "grazings": variable(dim, m.grazings, "1", "grazing contacts with surfaces at which rates change, in the record"),
    }  # fmt: skip


def doubts(ds: xr.Dataset, model: Model) -> dict[str, str]:
    """Attributes that say of how many points the accuracy is not met, and how many graze a surface; none where none does."""
    grazing, points = int((ds["grazings"].values > 0).sum()), ds["grazings"].size
    said = {
        "accuracy_not_met": doubtful(ds["step_verdict"].values, model),
        "grazing": f"{grazing} of {points} points touch a surface at which their rates change without crossing it plainly:"
        " exponents and multipliers may be wrong there, and a neighbouring point may move otherwise" if grazing else "",
    }  # fmt: skip
    return {name: text for name, text in said.items() if text}
