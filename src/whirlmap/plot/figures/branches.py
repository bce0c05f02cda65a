"""Branches of several quantities, one above the other."""

from collections.abc import Sequence

import xarray as xr
from matplotlib.figure import Figure

from whirlmap.plot.common.labels import axis_label
from whirlmap.plot.common.style import WIDE, new_figure, styled
from whirlmap.plot.panels.branches import draw_branches, draw_event_curves


@styled
def branches_figure(
    ds: xr.Dataset, quantities: Sequence[str], *, measure: str = "peak_to_peak", title: str = ""
) -> Figure:
    """Draw the Dataset of `whirlmap.continue_orbit`: solid where stable, dashed where not, events marked.

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.continue_orbit`; of `whirlmap.in_units`, where engineering units are wanted.
    quantities : sequence of str
        States or outputs, one panel each.
    measure : str
        As of `draw_branches`.
    title : str
        Over the whole figure; nothing where empty.

    Returns
    -------
    Figure

    Raises
    ------
    RangeError
        An unknown quantity or measure.
    """
    fig = new_figure(WIDE, 1.0 + 2.4 * len(quantities))
    panels = fig.subplots(len(quantities), 1, sharex=True, squeeze=False)[:, 0]
    for k, (quantity, ax) in enumerate(zip(quantities, panels, strict=True)):
        draw_branches(ds, quantity, measure=measure, ax=ax, legend=k == 0)
        words = "" if measure == "section" else f", {measure.replace('_', ' ')}"
        ax.set_ylabel(f"{axis_label(ds, quantity)}{words}")
    panels[-1].set_xlabel(axis_label(ds, str(ds.attrs["varied"]), meaning=True))
    if title:
        fig.suptitle(title)
    return fig


@styled
def event_curves_figure(ds: xr.Dataset, *, title: str = "") -> Figure:
    """Draw the Dataset of `whirlmap.event_curve` in the plane of its two parameters.

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.event_curve`.
    title : str
        Over the figure; nothing where empty.

    Returns
    -------
    Figure

    Raises
    ------
    RangeError
        A Dataset with one free parameter.
    """
    fig = new_figure(WIDE, 4.5)
    ax = draw_event_curves(ds, ax=fig.add_subplot())
    across, upwards = str(ds.attrs["varied"]).split()
    ax.set_xlabel(axis_label(ds, across, meaning=True))
    ax.set_ylabel(axis_label(ds, upwards, meaning=True))
    ax.legend(loc="best")
    if title:
        fig.suptitle(title)
    return fig
