"""Where branches begin: points of labelled diagrams and maps."""

from dataclasses import replace

import numpy as np
import xarray as xr

from whirlmap.errors import RangeError
from whirlmap.results.regime import Regime
from whirlmap.sweep.branches.seeds import Beginning, Seed


def seeds_of_point(first: Beginning, ds: xr.Dataset) -> list[Seed]:
    """The orbit of a labelled diagram or map at the point nearest to the value.

    Raises
    ------
    RangeError
        The Dataset has no section of all states there, or its point is not periodic.
    """
    names = [v.name for v in first.free.varied]
    if "direction" in ds.dims:  # what a sweep up and a sweep down found
        return [seed for way in ds["direction"].values for seed in seeds_of_point(first, ds.sel(direction=way))]
    if any(name not in ds.coords for name in names) or "section" not in ds or "period_T" not in ds:
        raise RangeError(f"the file holds no labelled section over {' and '.join(names)}: expected a diagram or a map")
    near = {name: value for name, value in zip(names, first.value, strict=True) if name in ds.dims}
    one = ds.sel(near, method="nearest")
    there = tuple(float(one[name]) if name in near else v for name, v in zip(names, first.value, strict=True))
    if there != first.value:  # Newton's method begins at the point's own value
        return seeds_of_point(replace(first, value=there), ds)
    if extra := [str(d) for d in one["section"].dims if d not in ("period", "state")]:
        raise RangeError(f"the file is no diagram over {' and '.join(names)} alone: found also {' and '.join(extra)}")
    kept = [str(s) for s in np.atleast_1d(one["state"].values)]
    if missing := [s for s in first.system.states if s not in kept]:
        every = ",".join(first.system.states)
        raise RangeError(f"the file keeps no section of {' '.join(missing)}: make it with --plot {every}")
    points = one["section"].sel(state=list(first.system.states)).transpose("period", "state").values
    points, n = points[np.isfinite(points).all(axis=1)], int(one["period_T"])
    if not n or not points.size:
        raise RangeError(f"{first.place()}: the point of the file is {Regime(int(one['regime'])).label}, not periodic")
    last = points[-1]  # at phase zero of the common period, which a record holds a whole number of times
    seeds = first.orbits([last], n) if first.system.model.forced else first.cycles(last, n)
    if not seeds:
        raise RangeError(f"{first.place()}: Newton's method found no orbit from the point of the file")
    return seeds


def seeds_of_diagram(first: Beginning, ds: xr.Dataset) -> list[Seed]:
    """An orbit in the middle of each stretch of a diagram's points of one period.

    Raises
    ------
    RangeError
        No stretch gives one.
    """
    (varied,) = first.free.varied
    if varied.name not in ds.dims:
        raise RangeError(f"the file is no diagram over {varied.name}: its points are over {' '.join(map(str, ds.dims))}")
    seeds: list[Seed] = []
    for sweep in [ds.sel(direction=d) for d in ds["direction"].values] if "direction" in ds.dims else [ds]:
        period, at = sweep["period_T"].values, sweep[varied.name].values
        edges = np.flatnonzero(np.diff(period)) + 1
        for part in np.split(np.arange(at.size), edges):
            inside = part[(at[part] >= varied.low) & (at[part] <= varied.high)]
            if inside.size and period[inside[0]]:
                middle = (float(at[inside[inside.size // 2]]),)
                seeds += seeds_of_point(replace(first, value=middle), sweep)
    if not seeds:
        ends = f"{varied.shown(varied.low):g} to {varied.shown(varied.high):g}"
        raise RangeError(f"the diagram has no periodic point from {ends}")
    return seeds
