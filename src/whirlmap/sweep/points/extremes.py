"""Extremes over the record as variables of Datasets: of every state and output, and of the films of every bearing."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sympy import lambdify, sympify

from whirlmap.equations.parts import OfBearing
from whirlmap.integrate.system import System
from whirlmap.results.schema import names_coordinate, variable

Array = NDArray[np.float64]

#: What the extremes over the record are called in Datasets, and what they are.
EXTREMES = {
    "minimum": "smallest value", "maximum": "largest value", "mean": "mean", "rms": "rms about the mean",
}  # fmt: skip


def extreme_variables(
    dim: str, system: System, extremes: Mapping[str, Array], columns: Mapping[str, Array]
) -> dict[str, Any]:
    """Variables with one number for each state and output of each point, or for each bearing.

    Parameters
    ----------
    extremes : mapping of str to array, shape (state and output, point)
        Those of `EXTREMES`.
    columns : mapping of str to array, shape (point,)
        Parameters that differ from point to point: a clearance may follow them.
    """
    data = {
        name: variable((dim, "quantity"), extremes[name].T, "1", f"{meaning} over the record")
        for name, meaning in EXTREMES.items()
    }
    swing = (extremes["maximum"] - extremes["minimum"]).T
    data["peak_to_peak"] = variable((dim, "quantity"), swing, "1", "largest less smallest value over the record")
    over, bearings = (dim, "bearing"), _bearings(system, "eccentricity")
    if bearings:
        largest = extremes["maximum"][list(bearings.values())].T
        data["max_eccentricity"] = variable(over, largest, "1", "largest eccentricity over the record, in clearances")
        thickness = clearances(system, list(bearings), columns) * (1 - largest)
        data["min_film"] = variable(over, thickness, "1", "smallest film thickness over the record, in the model's length")
    loads = _bearings(system, "load")
    if bearings and bearings.keys() <= loads.keys():
        largest = extremes["maximum"][[loads[name] for name in bearings]].T
        data["max_load"] = variable(over, largest, "1", "largest force of a film over the record, in the model's unit")
    return data


def clearances(system: System, bearings: Sequence[str], columns: Mapping[str, Array]) -> Array:
    """Clearance of each bearing in the model's length, shape (point or 1, bearing): 1 but where bearings differ in it."""
    found = []
    for bearing in bearings:
        journal = system.model.journals.get(bearing)
        size = sympify(journal.clearance if journal else 1)
        names = sorted(q.name for q in size.free_symbols)
        known = [np.asarray(columns.get(name, float(system.values[name])), dtype=float) for name in names]
        symbols = sorted(size.free_symbols, key=lambda q: str(q.name))
        found.append(np.atleast_1d(np.asarray(lambdify(symbols, size, "numpy")(*known), dtype=float)))
    return np.stack(np.broadcast_arrays(*found), axis=-1)


def extreme_coordinates(system: System) -> dict[str, Any]:
    """Names of the states and outputs, and of the bearings, that `extreme_variables` are over."""
    coords = {"quantity": names_coordinate("quantity", [*system.states, *system.model.outputs], "state or output")}
    if bearings := _bearings(system, "eccentricity"):
        coords["bearing"] = names_coordinate("bearing", list(bearings), "bearing")
    return coords


def _bearings(system: System, role: OfBearing) -> dict[str, int]:
    """Rows of the extremes that hold a quantity of the bearings, by the name of the bearing."""
    rows = [*system.states, *system.model.outputs]
    return {bearing: rows.index(name) for bearing, name in system.model.outputs_of(role).items()}
