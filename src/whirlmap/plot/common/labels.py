"""Symbols and axis labels: the ASCII names of a Dataset in mathematical type."""

import json
import re
from typing import Any

import numpy as np
import xarray as xr

from whirlmap.errors import RangeError, nearest

_GREEK = [
    "alpha",
    "beta",
    "gamma",
    "delta",
    "epsilon",
    "zeta",
    "eta",
    "theta",
    "iota",
    "kappa",
    "lambda",
    "mu",
    "nu",
    "xi",
    "rho",
    "sigma",
    "tau",
    "upsilon",
    "phi",
    "chi",
    "psi",
    "omega",
]
_LATEX = {name: "\\" + name for name in _GREEK} | {
    name.title(): "\\" + name.title() for name in ("gamma", "delta", "theta", "lambda", "xi", "sigma", "phi", "psi", "omega")
}
_LATEX |= {"eps": r"\varepsilon", "varepsilon": r"\varepsilon"}


def roles_of(ds: xr.Dataset) -> dict[str, Any]:
    """`Model.roles` of the model that a Dataset is of; empty where it does not say them."""
    found: dict[str, Any] = json.loads(str(ds.attrs.get("roles", "{}")))
    return found


def symbol(name: str, ds: xr.Dataset | None = None) -> str:
    """Give a name in mathematical type: ``yp`` as y_p, ``eps_1`` as epsilon_1, ``vx1`` as v_x1.

    Where the model of a Dataset declares a symbol, it is that. Else the first part is the letter, what follows it or stands
    behind an underscore is the index; longer words stay words.
    """
    if ds is not None and (declared := roles_of(ds).get("symbols", {}).get(name)):
        return f"${declared}$"
    head, _, index = name.partition("_")
    if not index and head not in _LATEX and 1 < len(head) <= 3:
        head, index = head[0], head[1:]
    index = re.sub("_", ",", index)
    letter = _LATEX.get(head, head if len(head) == 1 else rf"\mathrm{{{head}}}")
    return f"${letter}_{{{index}}}$" if index else f"${letter}$"


def speed_of(ds: xr.Dataset) -> str:
    """Name of the parameter that is the speed: the last dimension of its verdicts."""
    return str(ds["verdict"].dims[-1])


def unit_text(unit: str) -> str:
    """Give a unit as it stands behind a symbol: ``[m/s]``, and a dash for a pure number."""
    return "[–]" if unit in ("1", "") else f"[{unit}]"


def unit_of(ds: xr.Dataset, name: str) -> str:
    """Look up the unit of a state, an output or a coordinate, from what the Dataset says."""
    for variable, dim in (("x", "state"), ("section", "state"), ("outputs", "output"), ("peak_to_peak", "quantity")):
        if variable in ds and dim in ds.coords and name in ds[dim].values:
            each = str(ds[variable].attrs.get("unit_of_each", "")).split()
            position = ds[dim].values.tolist().index(name)
            return each[position] if position < len(each) else str(ds[variable].attrs.get("units", "1"))
    return str(ds[name].attrs.get("units", "1")) if name in ds else "1"


def within_period(ds: xr.Dataset, name: str, values: np.ndarray) -> np.ndarray:
    """Bring an angle into (-P/2, P/2], where the Dataset's attribute ``cyclic`` gives the state a period P.

    The attribute is JSON text, ``{"x": 6.283185307179586}``; other states are left as they are.
    """
    period = json.loads(str(ds.attrs.get("cyclic", "{}"))).get(name)
    if not period:
        return values
    return np.asarray(period / 2 - np.mod(period / 2 - values, period))


def with_breaks(ds: xr.Dataset, name: str, values: np.ndarray) -> np.ndarray:
    """Break the line of an angle where it leaves one side of its period and comes back on the other."""
    period = json.loads(str(ds.attrs.get("cyclic", "{}"))).get(name)
    if not period:
        return values
    jump = np.abs(np.diff(values, prepend=values[0])) > period / 2
    return np.where(jump, np.nan, values)


def axis_label(ds: xr.Dataset, name: str, *, meaning: bool = False) -> str:
    """Symbol and unit of a state, output or coordinate, after its meaning where there is room for it."""
    text = f"{symbol(name, ds)} {unit_text(unit_of(ds, name))}"
    words = str(ds[name].attrs.get("long_name", "")) if meaning and name in ds else ""
    words = re.split(r"[:;,]|\s\(", words)[0].strip()  # what follows is a definition: too long for an axis
    return f"{words}, {text}" if words and words != name else text


def check_name(name: str, known: list[str], what: str) -> str:
    """Return the name where the Dataset knows it, else raise `RangeError` with the nearest one."""
    if name not in known:
        raise RangeError(f"there is no {what} {name!r}.{nearest(name, known)}\n  {what}s: {' '.join(known)}")
    return name


def velocity_of(ds: xr.Dataset, coordinate: str) -> str:
    """Find the state that is a coordinate's velocity by the model's equations, ``vyp`` of ``yp``; else the next."""
    known = [str(s) for s in ds["state"].values]
    if (name := roles_of(ds).get("velocities", {}).get(coordinate)) in known:
        return str(name)
    return known[(known.index(check_name(coordinate, known, "state")) + 1) % len(known)]
