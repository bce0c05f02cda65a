"""The map or diagram as the page draws it: regimes and numbers of all points, and sections of a diagram."""

from collections.abc import Mapping, Sequence
from math import prod
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from whirlmap.explorer.control import symbol_text
from whirlmap.explorer.encoding import encoded
from whirlmap.explorer.exploration import DIRECTION, shown
from whirlmap.integrate.system import System
from whirlmap.results.status import Status
from whirlmap.sweep.store.zarr_store import Evaluation

#: Codes of points that have no regime, beyond those of regimes.
NOT_COMPUTED = 255
#: Numbers of every point that can colour a map.
COLOURED = ("lyapunov", "rotation_number", "confidence")


def overview(system: System, axes: Mapping[str, tuple[Sequence[float], str]], ds: xr.Dataset | None) -> dict[str, Any]:
    """Points over their axes.

    Parameters
    ----------
    axes : mapping of str to (values, unit)
    ds : xr.Dataset, optional
        Labelled points in the model's own units; absent where nothing is computed yet.

    Returns
    -------
    dict
        ``axes``: name and values of each. ``regime``, ``period`` over them (first axis slowest), regime `NOT_COMPUTED`
        where a point has none; ``numbers``: more of each point, by name, with ``label``, ``unit`` and ``values``;
        ``section``, of diagrams: by direction ("" where there is none) and state, over the points and T; ``units`` of the
        states; ``incomplete``, how many points are computed, "" where all are.
    """
    out: dict[str, Any] = {
        "axes": [{"name": name, "values": encoded(np.asarray(values, dtype=float))} for name, (values, _) in axes.items()],
        "regime": None, "period": None, "numbers": {}, "section": {}, "units": {},
        "incomplete": _incomplete(axes, ds),
    }  # fmt: skip
    if ds is None:
        return out
    dims = tuple(axes)
    first = ds.isel({DIRECTION: 0}) if DIRECTION in ds.dims else ds
    out["regime"] = encoded(_codes(first))
    out["period"] = encoded(np.asarray(first["period_T"]).astype(np.int32))
    units = shown(system, first)
    out["numbers"] = _numbers(system, units, dims)
    if "section" in ds and len(dims) == 1:
        of = shown(system, ds)["section"]
        each = str(of.attrs.get("unit_of_each", "")).split()
        states = [str(s) for s in np.asarray(ds["state"])]
        out["units"] = dict(zip(states, each or ["1"] * len(states), strict=True))
        only = "up" if ds.attrs.get("follow") == "both" else ""  # of a sweep both ways that has not come to its way down
        ways = [str(w) for w in np.asarray(ds[DIRECTION])] if DIRECTION in ds.dims else [only]
        for way in ways:
            part = of.sel({DIRECTION: way}) if DIRECTION in of.dims else of
            values = np.asarray(part.transpose("state", dims[0], "period"), dtype=np.float32)
            out["section"][way] = {state: encoded(values[k]) for k, state in enumerate(states)}
    return out


def _incomplete(axes: Mapping[str, tuple[Sequence[float], str]], ds: xr.Dataset | None) -> str:
    if ds is None:
        total = prod(len(values) for values, _ in axes.values())
        return f"0 of {total} points computed" if axes else ""
    if "incomplete" in ds.attrs:  # "interrupted after 3 of 8 points"
        return f"{str(ds.attrs['incomplete']).removeprefix('interrupted after ')} computed"
    done = np.asarray(ds["evaluation"]) != Evaluation.absent if "evaluation" in ds else np.ones(1, dtype=bool)
    return "" if done.all() else f"{done.sum()} of {done.size} points computed"


def _codes(ds: xr.Dataset) -> NDArray[np.uint8]:
    regime, status = np.asarray(ds["regime"]).astype(np.uint8), np.asarray(ds["status"])
    absent = np.isin(status, [Status.failed, Status.unresolved])
    if "evaluation" in ds:
        absent |= np.asarray(ds["evaluation"]) == Evaluation.absent
    return np.where(absent, NOT_COMPUTED, regime).astype(np.uint8)


def _numbers(system: System, ds: xr.Dataset, dims: tuple[str, ...]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name in COLOURED:
        if name in ds:
            found[name] = _number(ds[name], dims, str(ds[name].attrs.get("long_name", name)))
    if "peak_to_peak" in ds:
        each = str(ds["peak_to_peak"].attrs.get("unit_of_each", "")).split()
        names = [str(q) for q in np.asarray(ds["quantity"])]
        for state in (s.name for s in system.model.swing or system.model.states[:1]):
            one = ds["peak_to_peak"].sel(quantity=state)
            unit = each[names.index(state)] if each else "1"
            found[f"peak_to_peak {state}"] = _number(one, dims, f"peak to peak of {symbol_text(system, state)}", unit)
    for name, largest in (("max_eccentricity", True), ("min_film", False)):
        if name in ds:
            over = ds[name].max("bearing") if largest else ds[name].min("bearing")
            unit = str(ds[name].attrs.get("units", "1"))
            found[name] = _number(over, dims, "largest eccentricity" if largest else "thinnest film", unit)
    return found


def _number(values: xr.DataArray, dims: tuple[str, ...], label: str, unit: str = "") -> dict[str, Any]:
    array = np.asarray(values.transpose(*dims), dtype=np.float32)
    return {"label": label, "unit": unit or str(values.attrs.get("units", "1")), "values": encoded(array)}
