"""Design parameters compared as a picture: width of the safe window, worst amplitude, and their Pareto front."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator

from whirlmap.plot.common.labels import speed_of, symbol, unit_text
from whirlmap.plot.common.limits import cell_edges, is_log
from whirlmap.plot.common.style import BLUE, GREEN, GREY, INK, VERMILION, WIDE, new_figure, styled, text_size, write_reason

#: Markers and colours of the two best designs, by the attribute that holds their number.
BEST = {"widest": ("widest window", "*", GREEN), "calmest": ("lowest amplitude", "D", BLUE)}


@styled
def improve_figure(ds: xr.Dataset, *, unit: float = 1.0, length: str = "1", title: str = "") -> Figure:
    """Draw the Dataset of `improve`: both aims against the design, and against each other.

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.improve`, over one or two parameters.
    unit : float
        Size of the model's length in ``length``.
    length : str
        Unit of amplitudes.
    title : str
        Over the whole figure; nothing where empty.

    Returns
    -------
    Figure
        Not known to pyplot; `save` writes it.
    """
    names = str(ds.attrs["varied"]).split()
    scale, speed = (float(ds["rpm"][-1] / ds[speed_of(ds)][-1]), "rpm") if "rpm" in ds.coords else (1.0, "1")
    aims = (
        (ds["window_width"].values * scale, f"widest safe window {unit_text(speed)}"),
        (ds["worst_amplitude"].values * unit, f"worst peak to peak {unit_text(length)}"),
    )
    fig = new_figure(WIDE, 2.9)
    left, middle, right = fig.subplots(1, 3)
    for ax, (values, label) in zip((left, middle), aims, strict=True):
        if len(names) == 1:
            _line(ax, ds, names[0], values, label)
        else:
            _map(fig, ax, ds, names, values, label)
    middle_limit = ds.attrs["limit"] * unit
    if len(names) == 1 and np.isfinite(aims[1][0]).any():
        middle.axhline(middle_limit, color=VERMILION, lw=1, ls="--")
    _trade(right, ds, *aims)
    fig.suptitle(title)
    return fig


def _label(ds: xr.Dataset, name: str) -> str:
    return f"{symbol(name, ds)} {unit_text(str(ds[name].attrs['units']))}"


def _line(ax: Axes, ds: xr.Dataset, name: str, values: np.ndarray, label: str) -> None:
    at, order = ds[name].values, np.argsort(ds[name].values)
    if not np.isfinite(values).any():
        write_reason(ax, "no design ran at all speeds")
        return
    ax.plot(at[order], values[order], ".-", color=INK, ms=4, lw=0.8)
    ended = at[~np.isfinite(values)]
    if ended.size:
        foot: dict[str, Any] = {"transform": ax.get_xaxis_transform(), "color": VERMILION}
        ax.plot(ended, np.full(ended.size, 0.03), "x", ms=4, **foot)
        ax.text(ended.max(), 0.06, "runs end early", ha="right", fontsize=text_size(7), **foot)
    _mark(ax, ds, at, values)
    coarse = at[ds["refined"].values == 0]
    ax.set_xscale("log" if is_log(coarse) else "linear")
    ax.set(
        xlabel=_label(ds, name), ylabel=label, xlim=cell_edges(coarse, log=is_log(coarse))[[0, -1]],
        ylim=(0, 1.12 * max(np.nanmax(values), np.finfo(float).tiny)),
    )  # fmt: skip


def _map(fig: Figure, ax: Axes, ds: xr.Dataset, names: list[str], values: np.ndarray, label: str) -> None:
    """Cells of the grid, grey where a run ended early or was not made; designs of the refinement as dots upon it."""
    coarse = ds["refined"].values == 0
    (x, column), (y, row) = (np.unique(ds[n].values[coarse], return_inverse=True) for n in names)
    grid = np.full((y.size, x.size), np.nan)
    grid[row, column] = values[coarse]
    ends = (np.nanmin(values), np.nanmax(values)) if np.isfinite(values).any() else (0, 1)
    span = LogNorm(*ends) if _wide(values) else Normalize(*ends)
    edges = [cell_edges(v, log=is_log(v)) for v in (x, y)]
    ax.set_facecolor(GREY)
    mesh = ax.pcolormesh(*edges, grid, cmap="viridis", norm=span)
    fine = ~coarse & np.isfinite(values)
    ax.scatter(ds[names[0]][fine], ds[names[1]][fine], c=values[fine], s=18, ec="white", lw=0.5, cmap="viridis", norm=span)
    bar = fig.colorbar(mesh, ax=ax, location="top", label=label)
    if _wide(values):
        bar.ax.xaxis.set(major_locator=LogLocator(subs=(1, 2, 5)), major_formatter="{x:g}", minor_locator=NullLocator())
    _mark(ax, ds, ds[names[0]].values, ds[names[1]].values)
    ax.set(
        xscale="log" if is_log(x) else "linear", yscale="log" if is_log(y) else "linear",
        xlim=edges[0][[0, -1]], ylim=edges[1][[0, -1]], xlabel=_label(ds, names[0]), ylabel=_label(ds, names[1]),
    )  # fmt: skip


def _trade(ax: Axes, ds: xr.Dataset, width: tuple[np.ndarray, str], worst: tuple[np.ndarray, str]) -> None:
    """Both aims against each other, with the designs that nothing betters in both joined by a line."""
    if not np.isfinite(worst[0]).any():
        write_reason(ax, "no design ran at all speeds: no worst amplitude to trade")
        return
    ax.plot(width[0], worst[0], "o", color=GREY, ms=3.5)
    front = np.flatnonzero((ds["front"].values == 1) & np.isfinite(worst[0]))
    front = front[np.argsort(width[0][front])]
    ax.plot(width[0][front], worst[0][front], ".-", color=INK, ms=5, lw=0.8)
    _mark(ax, ds, width[0], worst[0])
    ax.set(xlabel=width[1], ylabel=worst[1], yscale="log" if _wide(worst[0]) else "linear")
    if _wide(worst[0]):
        ax.yaxis.set(major_locator=LogLocator(subs=(1, 2, 5)), major_formatter="{x:g}", minor_locator=NullLocator())
    left_out = int((~np.isfinite(worst[0])).sum())
    if left_out:
        ax.set_title(f"without {left_out} whose runs end early", fontsize=text_size(7), color=VERMILION)
    ax.legend(fontsize="small")


def _wide(values: np.ndarray) -> bool:
    """Whether values need a logarithmic axis for the small ones to be told apart."""
    good = values[np.isfinite(values)]
    return bool(good.size and good.min() > 0 and good.max() > 5 * good.min())


def _mark(ax: Axes, ds: xr.Dataset, x: np.ndarray, y: np.ndarray) -> None:
    for name, (label, marker, colour) in BEST.items():
        i = int(ds.attrs[name])
        if i >= 0 and np.isfinite(y[i]):
            ax.plot(x[i], y[i], marker, color=colour, ms=9 if marker == "*" else 5, mec="white", mew=0.5, label=label)
