"""Branches of periodic orbits as lines over a diagram, and curves of bifurcations as lines over a map."""

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from whirlmap.explorer.encoding import encoded
from whirlmap.explorer.exploration import Exploration, shown
from whirlmap.units import read

Array = NDArray[np.float64]


def lines(e: Exploration, ds: xr.Dataset) -> dict[str, Any]:
    """Lines of a Dataset of `continue_orbit` over a diagram, or of `event_curve` over a map.

    Returns
    -------
    dict
        ``kind``: the event whose curve it is, "" of branches. ``values`` by name of the axis, and ``branch`` of each point.
        ``events``: kind of each, with its ``values``. Of branches also ``stable`` of each point, ``section`` by state, over
        points and T, and the ``section`` of each event.
    """
    names = list(e.axes)
    found: dict[str, Any] = {
        "kind": str(ds.attrs.get("event", "")), "branch": encoded(np.asarray(ds["branch_of"])),
        "values": {name: encoded(_in_unit(e, name, ds[name])) for name in names}, "events": _events(e, ds),
    }  # fmt: skip
    if len(names) > 1:
        return found
    states = [str(s) for s in np.asarray(ds["state"])]
    units = shown(e.system, ds)
    section = np.asarray(units["section"].transpose("state", "point", "period"), dtype=np.float32)
    found["stable"] = encoded(np.asarray(ds["stable"]).astype(np.int8))
    found["section"] = {state: encoded(section[k]) for k, state in enumerate(states)}
    if found["events"]:
        at = np.asarray(units["event_section"].transpose("event", ...), dtype=float)
        for k, event in enumerate(found["events"]):
            event["section"] = dict(zip(states, at[k].reshape(-1, len(states))[0].tolist(), strict=True))
    return found


def _events(e: Exploration, ds: xr.Dataset) -> list[dict[str, Any]]:
    if "event_kind" not in ds:
        return []
    words = [w.replace("_", "-") for w in str(ds["event_kind"].attrs["flag_meanings"]).split()]
    at = {name: _in_unit(e, name, ds[f"event_{name}"]).tolist() for name in e.axes}
    codes = np.asarray(ds["event_kind"]).tolist()
    return [{"kind": words[code], "values": {n: v[k] for n, v in at.items()}} for k, code in enumerate(codes)]


def _in_unit(e: Exploration, name: str, values: xr.DataArray) -> Array:
    """Values of an axis in the unit that they have in the diagram or map."""
    numbers, unit, given = np.asarray(values, dtype=float), e.axes[name][1], str(values.attrs.get("units", "1"))
    if name in e.system.parameters or unit == given:
        return numbers
    zero, one = (float(read(f"{number} {given}", unit)) for number in (0, 1))
    return zero + (one - zero) * numbers
