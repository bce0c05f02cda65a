"""Engineering units of states, outputs and time, and the size of each at every point of a grid."""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from whirlmap.explorer.saved.grid import Grid
from whirlmap.integrate.in_units import in_units
from whirlmap.integrate.system import System
from whirlmap.results.schema import names_coordinate

Array = NDArray[np.float64]


def shown_units(system: System, grid: Grid | None = None) -> tuple[dict[str, str], Array]:
    """Units by name, that of the time under ``time``, and what the model's own numbers are multiplied by.

    Returns
    -------
    units : dict of str to str
    sizes : array, shape (states + outputs + 1, axis...)
        Of each state, each output and the time.
    """
    own = Grid(system, None, ()) if grid is None else grid
    dims, outputs = tuple(own.axes), list(system.model.outputs)
    ones, counts = np.ones(own.shape), (len(system.states), len(outputs))
    ds = xr.Dataset(
        {
            "x": ((*dims, "state"), np.ones((*own.shape, counts[0])), {"units": "1", "long_name": "state"}),
            "outputs": ((*dims, "output"), np.ones((*own.shape, counts[1])), {"units": "1", "long_name": "output"}),
            "clock": (dims, ones, {"units": "time", "long_name": "time"}),
        },
        {
            **(own.kept.coordinates(system) if own.kept else {}), "state": names_coordinate("state", system.states, "state"),
            "output": names_coordinate("output", outputs, "output"),
        },
        {"case": system.case},
    )  # fmt: skip
    made = in_units(system, ds)
    units: dict[str, str] = {"time": str(made["clock"].attrs["units"])}
    for variable, names in (("x", system.states), ("outputs", outputs)):
        said = str(made[variable].attrs.get("unit_of_each", "")).split() or ["1"] * len(names)
        units |= dict(zip(names, said, strict=True))
    rows = [np.moveaxis(np.asarray(made[name], dtype=float), -1, 0) for name in ("x", "outputs")]
    return units, np.concatenate([*rows, np.asarray(made["clock"], dtype=float)[None]])
