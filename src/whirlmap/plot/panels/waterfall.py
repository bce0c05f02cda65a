"""Waterfall diagrams: amplitude spectra against speed, with order lines of the machine."""

from typing import Literal

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from numpy.typing import NDArray

from whirlmap.errors import RangeError
from whirlmap.plot.common.labels import axis_label, symbol, unit_of, unit_text
from whirlmap.plot.common.limits import cell_edges
from whirlmap.plot.common.style import BLUE, VERMILION, axes_or_new, styled, text_size
from whirlmap.plot.panels.spectrum import Orders

Array = NDArray[np.float64]


@styled
def draw_waterfall(
    ds: xr.Dataset,
    speed: str | None = None,
    *,
    ax: Axes | None = None,
    kind: Literal["lines", "map"] = "lines",
    orders: Orders | None = None,
    highest: float = 1.5,
    clock: float = 1.0,
    height: float = 6.0,
    name: str = "",
) -> Axes:
    """Amplitude spectra at many speeds, one above the other, over frequency in the unit of the speed.

    Reads ``power(frequency, speed)`` of `power_spectrum` taken with the samples per T as rate, its lanes
    renamed: ``power_spectrum(...).rename(lane="s").assign_coords(s=...)``. Amplitudes are sqrt(2 power).
    Spectra that hold numbers that are not finite (ended runs) are left out, and said in the title.

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.waterfall`, or of `whirlmap.power_spectrum` with a dimension of speeds.
    speed : str
        Dimension along which the speed varies; the one beside the frequency where absent.
    ax : Axes, optional
        Drawn into; those of a new figure where absent.
    kind : {"lines", "map"}
        Spectra as lines in a row, or as a map of colours in decibels.
    orders : mapping of str to number
        Named orders in multiples of 1/T; each is a straight line through the origin.
    highest : float
        Highest frequency shown, in multiples of 1/T at the highest speed.
    clock : float
        1/T over the speed: 1 where the speed is that of the mesh, 20 where it is a pinion's with 20 teeth.
    height : float
        Height of the largest line, in gaps between the spectra (kind "lines").
    name : str
        The quantity, for the labels: ``yp``.

    Returns
    -------
    Axes
        Those that were drawn into; ``.figure`` is the figure.

    Raises
    ------
    RangeError
        An unknown ``kind``.
    """
    if kind not in ("lines", "map"):
        raise RangeError(f"kind is 'lines' or 'map', not {kind!r}")
    ax = axes_or_new(ax, 5.4, 4.4)
    speed = speed or str(next(dim for dim in ds["power"].dims if dim != "frequency"))
    at = ds[speed].values.astype(float)
    amplitude = np.sqrt(2 * ds["power"].transpose(speed, "frequency").values)
    order = ds["frequency"].values
    whole = np.isfinite(amplitude).all(axis=1)
    edges = cell_edges(at)
    top = highest * clock * float(at.max())
    if kind == "lines":
        _rows(ax, at, order, clock, amplitude, whole, top, height)
        ax.set_ylim(edges[0], edges[-1] + height * float(np.median(np.diff(edges))))
    else:
        _colours(ax, edges, order, clock, amplitude, top)
        ax.set_ylim(edges[0], edges[-1])
    ax.set_xlim(0, top)
    ends = np.array(ax.get_ylim())
    colour = VERMILION if kind == "lines" else "white"
    for label, value in (orders or {}).items():
        across = abs(float(value)) * clock * ends
        ax.plot(across, ends, color=colour, lw=0.7, ls=(0, (4, 2)), alpha=0.55, gid=f"order-{label}", zorder=1e4)
        end = min(ends[1], top / max(abs(float(value)) * clock, 1e-300))
        if end > ends[0]:
            ax.annotate(
                label,
                (abs(float(value)) * clock * end, end),
                (1, 3),
                textcoords="offset points",
                fontsize=text_size(6.5),
                rotation=40,
                color="#444444",
                annotation_clip=False,
                zorder=1e4,
            )
    ax.set_xlabel(f"frequency, in units of {symbol(speed, ds)} {unit_text(unit_of(ds, speed))}")
    ax.set_ylabel(axis_label(ds, speed))
    missing = int((~whole).sum())
    title = f"amplitude spectra{' of ' + symbol(name, ds) if name else ''}" + (
        f", {missing} ended run{'s' * (missing > 1)} left out" if missing else ""
    )
    largest = float(np.nanmax(amplitude[:, order > 0])) if whole.any() else np.nan
    ax.set_title(f"{title}; largest {largest:.3g}", pad=28 if orders else 5)
    return ax


def _rows(
    ax: Axes,
    at: Array,
    order: Array,
    clock: float,
    amplitude: Array,
    whole: NDArray[np.bool_],
    top: float,
    height: float,
) -> None:
    """Draw spectra as filled lines, the one of the lowest speed in front."""
    step = float(np.median(np.diff(at))) if at.size > 1 else 1.0
    largest = float(amplitude[whole][:, order > 0].max()) if whole.any() else 1.0
    scale = height * step / largest if largest > 0 else 0.0
    for k in np.flatnonzero(whole):
        frequency = order * clock * at[k]
        seen = (frequency <= top) & (order > 0)
        line = at[k] + scale * amplitude[k, seen]
        depth = 10 + (at.size - k)
        ax.fill_between(frequency[seen], at[k], line, color="white", lw=0, zorder=depth, rasterized=True)
        ax.plot(
            frequency[seen],
            line,
            color=BLUE,
            lw=0.6,
            zorder=depth,
            gid="spectrum",
            rasterized=seen.sum() > 3000,
        )


def _colours(ax: Axes, edges: Array, order: Array, clock: float, amplitude: Array, top: float) -> None:
    """Draw spectra as a map in decibels below the largest amplitude, on a common frequency axis."""
    finite = amplitude[np.isfinite(amplitude)]
    largest = float(finite.max()) if finite.size and finite.max() > 0 else 1.0
    at = (edges[1:] + edges[:-1]) / 2
    common = np.linspace(0, top, 600)
    step = float(order[1] - order[0])
    rows = []
    for k, value in enumerate(at):
        # The largest amplitude within each cell, so that no thin line is lost between the cells.
        cell = np.clip((order * clock * value / common[1] + 0.5).astype(int), 0, common.size)
        row = np.full(common.size + 1, 0.0)
        np.maximum.at(row, cell, np.nan_to_num(amplitude[k]))
        if step * clock * value > common[1]:
            row[:-1] = np.interp(common, order * clock * value, np.nan_to_num(amplitude[k]), right=0.0)
        rows.append(row[:-1] if np.isfinite(amplitude[k]).all() else np.full(common.size, np.nan))
    level = 20 * np.log10(np.maximum(np.array(rows), 1e-8 * largest) / largest)
    mesh = ax.pcolormesh(cell_edges(common), edges, level, cmap="cividis", vmin=-80, vmax=0, rasterized=True)
    mesh.set_gid("map")
    ax.figure.colorbar(mesh, ax=ax, label="amplitude below the largest [dB]", pad=0.02)
