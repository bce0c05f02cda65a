"""Safe speed windows as a picture: amplitude against speed, with what forbids the speeds between the windows."""

import json

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from whirlmap.plot.style import WIDE, new_figure, styled

#: Colours of what forbids a speed, by the name of the verdict.
COLOURS = {
    "amplitude": "#E69F00", "coexisting": "#CC79A7", "quasi_periodic": "#56B4E9", "chaotic": "#D55E00",
    "contact": "#555555", "diverged": "#222222", "undecided": "#BBBBBB",
}  # fmt: skip
SAFE = "#009E73"


@styled
def speeds_figure(ds: xr.Dataset, *, unit: float, length: str, title: str) -> Figure:
    """Draw the Dataset of `safe_speeds`.

    Parameters
    ----------
    unit : float
        Size of the model's length in ``length``.
    length : str
        Unit of the vertical axis.
    """
    heights = [3, 1] if "probability" in ds else [3]
    fig = new_figure(WIDE, 3.4 * sum(heights) / 3)
    panels = fig.subplots(len(heights), 1, sharex=True, squeeze=False, height_ratios=heights)
    ax = panels[0, 0]
    along = "rpm" if "rpm" in ds else "s"
    at, swing = ds[along].values, ds["amplitude"].values * unit
    scale = at[-1] / ds["s"].values[-1]
    names = ds["verdict"].attrs["flag_meanings"].split()
    kinds = np.array([names[v] for v in ds["verdict"].values])
    edges = np.concatenate([[at[0]], (at[1:] + at[:-1]) / 2, [at[-1]]])
    for name in dict.fromkeys(kinds):
        if name != "safe":
            for i in np.flatnonzero(kinds == name):
                ax.axvspan(edges[i], edges[i + 1], color=COLOURS[name], alpha=0.35, lw=0)
    for window in json.loads(ds.attrs["windows"]):
        ax.axvspan(window["window_start"] * scale, window["window_end"] * scale, color=SAFE, alpha=0.18, lw=0)
    ax.plot(at, swing, ".-", color="black", ms=3, lw=0.8)
    ax.axhline(ds.attrs["limit"] * unit, color=COLOURS["chaotic"], lw=1, ls="--")
    finite = swing[np.isfinite(swing)]
    ax.set(xlim=(at[0], at[-1]), ylim=(0, 1.2 * max([ds.attrs["limit"] * unit, *finite])))
    ax.set_ylabel(f"peak to peak [{length}]")
    handles = [Patch(color=SAFE, alpha=0.3, label="safe")]
    handles += [Patch(color=COLOURS[n], alpha=0.5, label=n.replace("_", "-")) for n in dict.fromkeys(kinds) if n != "safe"]
    ax.legend(handles=handles, fontsize="small", ncols=4, loc="upper left")
    ax.set_title(title)
    last = panels[-1, 0]
    if "probability" in ds:
        last.fill_between(at, ds["probability_low"], ds["probability_high"], color=SAFE, alpha=0.3, lw=0)
        last.plot(at, ds["probability"], color=SAFE, lw=1)
        last.set(ylim=(0, 1), ylabel="probability\nof safe")
    last.set_xlabel("speed of the first shaft [rpm]" if along == "rpm" else "speed ratio s")
    return fig
