"""Run-up in time: extremes against speed over a labelled diagram, amplitude and phase at the clocks, waterfall."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from whirlmap.errors import RangeError
from whirlmap.plot.common.labels import axis_label, symbol, unit_text
from whirlmap.plot.common.limits import cell_edges
from whirlmap.plot.common.style import BLUE, GREY, INK, VERMILION, WIDE, Look, look_of, new_figure, styled

#: Decades of amplitude shown in the waterfall below the largest.
DECADES = 4
COLOURS = (BLUE, VERMILION, INK, GREY)


@styled
def run_up_figure(ds: xr.Dataset, quantity: str, *, diagram: xr.Dataset | None = None, title: str = "") -> Figure:
    """Draw a run-up or coast-down of `whirlmap.run_up`.

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.run_up`; of `whirlmap.in_units`, where rpm and um are wanted.
    quantity : str
        State or output.
    diagram : xr.Dataset, optional
        Of `whirlmap.bifurcation_diagram` over the same speed and in the same units: its extremes, coloured by their regime,
        stand behind those of the run.
    title : str
        Over the whole figure; nothing where empty.

    Returns
    -------
    Figure
        Not known to pyplot; `save` writes it.

    Raises
    ------
    RangeError
        A quantity that the run or the diagram does not hold, a diagram over something else.
    """
    speed = str(ds.attrs["varied"])
    if quantity not in ds["quantity"].values:
        raise RangeError(f"found no {quantity!r} in the run, expected one of {', '.join(ds['quantity'].values)}")
    fig = new_figure(WIDE, 6.6)
    upper, middle, lower = fig.subplots(3, 1, sharex=True, height_ratios=[2, 1.4, 2])
    at, of = ds[speed].values, ds.sel(quantity=quantity)
    if diagram is not None:
        _diagram(diagram, speed, quantity, upper)
    upper.plot(at, of["maximum"], color=INK, label="run")
    upper.plot(at, of["minimum"], color=INK)
    unit = _unit(ds, "maximum", quantity)
    upper.set_ylabel(f"{symbol(quantity, ds)} {unit_text(unit)}")
    turn = middle.twinx()
    for clock, colour in zip(ds["clock"].values, COLOURS, strict=False):
        middle.plot(at, of["clock_amplitude"].sel(clock=clock), color=colour, label=f"{clock}, amplitude")
        phase = np.degrees(np.unwrap(np.nan_to_num(of["clock_phase"].sel(clock=clock).values)))
        turn.plot(at, np.where(np.isfinite(of["maximum"].values), phase, np.nan), color=colour, ls=":", lw=1)
    middle.set_ylabel(f"amplitude {unit_text(unit)}")
    turn.set_ylabel("phase [deg], dotted")
    middle.legend(loc="upper left", fontsize="x-small")
    order = ds["phase_order"].values
    level = 20 * np.log10(np.maximum(of["spectrum"].transpose("phase_order", speed).values, 1e-300))
    top = float(np.nanmax(level))
    mesh = lower.pcolormesh(cell_edges(at), cell_edges(order), level, vmin=top - 20 * DECADES, vmax=top, cmap="magma")
    fig.colorbar(mesh, ax=[upper, middle, lower], label="amplitude [dB]", shrink=0.5, anchor=(0, 0))
    lower.set_ylabel("order of the phase")
    lower.set_xlabel(axis_label(ds, speed, meaning=True))
    lower.set_xlim(min(at[0], at[-1]), max(at[0], at[-1]))
    fig.suptitle(title)
    return fig


def _unit(ds: xr.Dataset, variable: str, quantity: str) -> str:
    each = str(ds[variable].attrs.get("unit_of_each", "")).split()
    place = ds["quantity"].values.tolist().index(quantity)
    return each[place] if place < len(each) else str(ds[variable].attrs.get("units", "1"))


def _diagram(diagram: xr.Dataset, speed: str, quantity: str, ax: Axes) -> None:
    """Extremes of a labelled diagram, a colour for each regime."""
    if str(diagram["regime"].dims[-1]) != speed:
        raise RangeError(f"found a diagram over {diagram['regime'].dims[-1]}, expected one over {speed}")
    if "quantity" not in diagram.coords or quantity not in diagram["quantity"].values:
        raise RangeError(f"found no {quantity!r} in the diagram")
    looks: dict[str, Look] = {}
    ways = diagram["direction"].values if "direction" in diagram.dims else [None]
    for way in ways:
        part = diagram if way is None else diagram.sel(direction=way)
        at, regimes, status = part[speed].values, part["regime"].values, part["status"].values
        high, low = (part[key].sel(quantity=quantity).values for key in ("maximum", "minimum"))
        for regime in np.unique(regimes):
            here = regimes == regime
            look = look_of(int(regime), int(status[here][0]))
            looks[look.label] = look
            for values in (high, low):
                ax.plot(at[here], values[here], ls="none", marker=look.marker, ms=3, color=look.colour, mec=INK, mew=0.2)
    handles = [
        Line2D([], [], ls="none", marker=look.marker, color=look.colour, mec=INK, mew=0.2, label=name)
        for name, look in looks.items()
    ]
    ax.legend(handles=handles, loc="upper left", fontsize="x-small")
