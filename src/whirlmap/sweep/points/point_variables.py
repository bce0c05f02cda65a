"""Measured numbers of operating points as variables of a Dataset, and attributes that warn of doubtful ones."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from whirlmap.analysis.labels.measured import NUMBERS, Measured
from whirlmap.equations.model import Model
from whirlmap.errors import RangeError, nearest
from whirlmap.integrate.accuracy import doubtful
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.harmonics import common_multiple_attribute
from whirlmap.integrate.orders import orders_vary
from whirlmap.integrate.system import System
from whirlmap.results.schema import names_coordinate, variable
from whirlmap.sweep.points.extremes import extreme_coordinates, extreme_variables

Array = NDArray[np.float64]


def points_dataset(
    system: System, columns: Mapping[str, Array], measured: Measured, *, kept: Sequence[str] = ()
) -> xr.Dataset:
    """Dataset of measured points over ``point``, without attributes; ``kept`` are the states whose section was kept."""
    model = system.model
    data = point_variables("point", measured) | extreme_variables("point", system, measured.returns.extremes, columns)
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
    return {number.name: number.variable(dim, measured) for number in NUMBERS}


def doubts(ds: xr.Dataset, model: Model) -> dict[str, str]:
    """Attributes that say of how many points the accuracy is not met, and how many graze a surface; none where none does."""
    grazing, points = int((ds["grazings"].values > 0).sum()), ds["grazings"].size
    said = {
        "accuracy_not_met": doubtful(ds["step_verdict"].values, model),
        "grazing": f"{grazing} of {points} points touch a surface at which their rates change without crossing it plainly:"
        " exponents and multipliers may be wrong there, and a neighbouring point may move otherwise" if grazing else "",
    }  # fmt: skip
    return {name: text for name, text in said.items() if text}
