"""Shared parts of the panels of a diagram: the varied parameter, its sweeps, the values without a complete run."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from numpy.typing import NDArray

from whirlmap.errors import RangeError
from whirlmap.plot.common.labels import axis_label
from whirlmap.plot.common.limits import cell_edges, runs
from whirlmap.plot.common.style import DIRECTIONS, HYSTERESIS, INK, look_of, text_size


def varied(ds: xr.Dataset) -> str:
    """Name of the parameter that a diagram varies."""
    name = ds.attrs.get("varied")
    if name is None:
        dims = [str(d) for d in ds["regime"].dims if d != "direction"]
        if len(dims) != 1:
            raise RangeError(f"a diagram varies one parameter; this Dataset varies {dims or 'none'}")
        name = dims[0]
    return str(name)


def directions(ds: xr.Dataset) -> list[str | None]:
    """Name the sweeps of a Dataset; one without a name where the points are independent."""
    return [str(d) for d in ds["direction"].values] if "direction" in ds.dims else [None]


def sweeps(ds: xr.Dataset) -> list[tuple[xr.Dataset, str]]:
    """Each sweep of a Dataset with the colour of its points."""
    if "direction" in ds.dims:
        return [(ds.sel(direction=d), DIRECTIONS[str(d)].colour) for d in ds["direction"].values]
    return [(ds, INK)]


def shade_ended(ax: Axes, ds: xr.Dataset, at: NDArray[np.float64], log: bool, *, words: bool = True) -> None:
    """Hatch the values at which no sweep came to its end."""
    parameter = varied(ds)
    status = ds["status"]
    ended = (status != 0).all("direction") if "direction" in ds.dims else status != 0
    first = ds.isel(direction=0) if "direction" in ds.dims else ds
    edges = cell_edges(at, log=log)
    looks = [
        look_of(r, s) if e else None
        for r, s, e in zip(first["regime"].values, first["status"].values, ended.transpose(parameter).values, strict=True)
    ]
    for begin, last in runs(list(looks)):
        look = looks[begin]
        if look is not None:
            ax.axvspan(
                edges[begin],
                edges[last + 1],
                facecolor="none",
                hatch=look.hatch[:3],
                edgecolor="#A8A8A8",
                lw=0,
                zorder=0.5,
                label=f"_{look.label}",
                gid=f"ended-{look.label}",
            )
            if words and share(ax, edges, begin, last) > 0.08:
                middle = np.sqrt(edges[begin] * edges[last + 1]) if log else (edges[begin] + edges[last + 1]) / 2
                ax.text(
                    middle,
                    0.5,
                    look.label,
                    transform=ax.get_xaxis_transform(),
                    ha="center",
                    va="center",
                    fontsize=text_size(7),
                    bbox={"fc": "white", "ec": "none", "pad": 1.5},
                    clip_on=True,
                )


def shade_hysteresis(ax: Axes, ds: xr.Dataset, at: NDArray[np.float64], log: bool) -> None:
    """Shade the stretches in which the sweeps up and down differ, where the Dataset says so."""
    if "hysteresis" not in ds:
        return
    edges = cell_edges(at, log=log)
    differs = (ds["hysteresis"] == 1).values
    for first, last in runs(list(differs)):
        if differs[first]:
            ax.axvspan(edges[first], edges[last + 1], facecolor=HYSTERESIS, edgecolor="none", zorder=0.3, gid="hysteresis")


def parameter_axis(ax: Axes, ds: xr.Dataset, at: NDArray[np.float64], log: bool) -> None:
    """Give an axis the limits, the scale and the label of the varied parameter."""
    edges = cell_edges(at, log=log)
    ax.set_xscale("log" if log else "linear")
    ax.set_xlim(edges[0], edges[-1])
    ax.set_xlabel(axis_label(ds, varied(ds), meaning=True))


def share(ax: Axes, edges: NDArray[np.float64], first: int, last: int) -> float:
    """Share of the axis that a stretch of cells takes up."""
    ends = np.array([edges[first], edges[last + 1], edges[0], edges[-1]])
    left, right, begin, end = np.log(ends) if ax.get_xscale() == "log" else ends
    return float((right - left) / (end - begin))
