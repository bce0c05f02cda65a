"""Bode plots of the unbalance response: peak to peak with the nonlinear motion above, phase below."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from whirlmap.plot.common.labels import axis_label, unit_of, unit_text
from whirlmap.plot.common.style import BLUE, GREEN, GREY, INK, ORANGE, PURPLE, SKY, VERMILION, WIDE, new_figure, styled

#: Colours of the stations, and the line of each axis.
COLOURS = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, INK)
LINES = {"x": "-", "y": "--"}
#: Steps of the ruled phases: 45, 90, 180, 360, 900 degrees.
DEGREES = (1.8, 3.6, 4.5, 9.0, 10)


@styled
def response_figure(ds: xr.Dataset, *, title: str = "") -> Figure:
    """Draw the Dataset of `whirlmap.unbalance_response`.

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.unbalance_response`; of `whirlmap.in_units`, where um and rpm are wanted. Where it has ``nonlinear``,
        that is drawn as dots, filled along x and open along y.
    title : str
        Over the whole figure; nothing where empty.

    Returns
    -------
    Figure
        Not known to pyplot; `save` writes it.
    """
    parameter = str(ds.attrs["varied"])
    at, rotors = ds[parameter].values, ds["rotor"].values.tolist()
    fig = new_figure(WIDE, 3.4 + 1.7 * len(rotors))
    upper, *lower = fig.subplots(1 + len(rotors), 1, sharex=True, height_ratios=[2, *[1] * len(rotors)])
    for k, station in enumerate(ds["station"].values.tolist()):
        colour = COLOURS[k % len(COLOURS)]
        for axis, line in LINES.items():
            here = ds.sel(station=station, axis=axis)
            upper.plot(at, here["total"].values, line, color=colour, label=f"{station} {axis}")
            if "nonlinear" in ds:
                fill = colour if axis == "x" else "none"
                upper.plot(here["nonlinear_speed"], here["nonlinear"], "o", ms=4, mec=colour, mfc=fill, ls="none")
            for ax, rotor in zip(lower, rotors, strict=True):
                ax.plot(at, np.degrees(here["phase"].sel(rotor=rotor).values), line, color=colour)
    for speed in ds["critical"].values.tolist():
        upper.axvline(speed, color=GREY, lw=0.7, ls=":", zorder=0.8)
    unstable = (ds["stable"].values == 0) & (ds["status"].values == 0)
    for ax in (upper, *lower):
        ax.fill_between(at, 0, 1, where=unstable, transform=ax.get_xaxis_transform(), color=GREY, alpha=0.25, lw=0)
    upper.set_ylim(bottom=0)
    upper.set_ylabel(f"peak to peak {unit_text(unit_of(ds, 'total'))}")
    for ax, rotor in zip(lower, rotors, strict=True):
        ax.yaxis.set_major_locator(MaxNLocator(nbins=5, steps=DEGREES))
        ax.set_ylabel(f"lag, {rotor} [deg]")
        ax.invert_yaxis()
    fig.legend(*upper.get_legend_handles_labels(), loc="outside lower center", ncols=4)
    lower[-1].set_xlabel(axis_label(ds, parameter, meaning=True))
    lower[-1].set_xlim(at[0], at[-1])
    fig.align_ylabels()
    fig.suptitle(title)
    return fig
