"""Campbell diagram: damped frequencies and order lines against speed, damping below."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from whirlmap.plot.common.labels import axis_label, unit_of, unit_text
from whirlmap.plot.common.style import BLUE, GREY, INK, VERMILION, WIDE, new_figure, styled, text_size

#: Colour and words of each sense of whirl.
SENSES = {1: (BLUE, "forward"), -1: (VERMILION, "backward"), 0: (INK, "no orbit")}


@styled
def campbell_figure(ds: xr.Dataset, *, title: str = "") -> Figure:
    """Draw the Dataset of `whirlmap.campbell`: modes coloured by their whirl, order lines, critical speeds as rings.

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.campbell`; of `whirlmap.in_units`, where rpm and Hz are wanted.
    title : str
        Over the whole figure; nothing where empty.

    Returns
    -------
    Figure
        Not known to pyplot; `save` writes it.
    """
    parameter = str(ds.attrs["varied"])
    at = ds[parameter].values
    fig = new_figure(WIDE, 5.4)
    upper, lower = fig.subplots(2, 1, sharex=True, height_ratios=[2, 1])
    keys = ("frequency", "damping_ratio", "whirl")
    frequency, damping, whirl = (ds[key].transpose("mode", parameter).values for key in keys)
    for sense, (colour, words) in SENSES.items():
        # a mode changes its colour where its orbit turns, not a point later: the next point belongs to the stretch too
        here = (whirl == sense) & (frequency > 0)
        here[:, 1:] |= here[:, :-1] & (frequency[:, 1:] > 0)
        if here.any():
            upper.plot(at, np.where(here, frequency, np.nan).T, color=colour, label=words)
            lower.plot(at, np.where(here, damping, np.nan).T, color=colour)
    top = 1.15 * float(np.nanmax(frequency)) or 1.0
    for clock in ds["clock"].values:
        line = ds["line"].sel(clock=clock).values
        upper.plot(at, line, color=GREY, ls="--", zorder=0.8)
        inside = np.flatnonzero(line <= top)
        if inside.size:
            upper.annotate(
                str(clock), (at[inside[-1]], line[inside[-1]]), xytext=(-3, 3), textcoords="offset points", ha="right",
                fontsize=text_size(7), color="#666666",
            )  # fmt: skip
    critical = ds["critical"].values
    if critical.size:
        height = [
            np.interp(value, at, ds["line"].sel(clock=clock).values)
            for value, clock in zip(critical, ds["critical_clock"].values, strict=True)
        ]
        upper.plot(critical, height, "o", mfc="none", mec=INK, ms=5, ls="none", label="critical")
    upper.set_ylim(0, top)
    upper.set_ylabel(f"damped frequency {unit_text(unit_of(ds, 'frequency'))}")
    if upper.get_legend_handles_labels()[0]:
        # one entry per sense, however many modes have it
        handles = dict(zip(*reversed(upper.get_legend_handles_labels()), strict=True))
        fig.legend(handles.values(), handles.keys(), loc="outside lower center", ncols=len(handles))
    lower.axhline(0, color=GREY, lw=0.7)
    lower.set_ylabel("damping ratio [–]")
    lower.set_xlabel(axis_label(ds, parameter, meaning=True))
    lower.set_xlim(at[0], at[-1])
    fig.suptitle(title)
    return fig
