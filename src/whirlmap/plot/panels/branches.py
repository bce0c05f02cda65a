"""Branches against the parameter: solid where stable, dashed where not, with marks at bifurcation points."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from numpy.typing import NDArray

from whirlmap.errors import RangeError
from whirlmap.plot.common.labels import axis_label, check_name, within_period
from whirlmap.plot.common.style import BLUE, GREEN, INDIGO, INK, ORANGE, PURPLE, SKY, VERMILION, axes_or_new, styled

Array = NDArray[np.float64]

#: Mark and colour of each kind of event.
MARKS = {
    "fold": ("s", VERMILION), "branch_point": ("P", INK), "period_doubling": ("D", BLUE), "neimark_sacker": ("o", GREEN),
    "hopf": ("o", GREEN), "grazing": ("x", PURPLE), "cusp": ("*", VERMILION), "resonance_1_1": ("^", INDIGO),
    "resonance_1_2": ("v", INDIGO), "resonance_1_3": ("<", INDIGO), "resonance_1_4": (">", INDIGO),
}  # fmt: skip
#: Colours of branches, in their order.
COLOURS = (INK, BLUE, ORANGE, GREEN, PURPLE, SKY, VERMILION, INDIGO)
#: What may be drawn of a branch: extremes of a state or an output, or the section of a state.
MEASURES = ("peak_to_peak", "maximum", "minimum", "mean", "rms", "section")


@styled
def draw_branches(
    ds: xr.Dataset, quantity: str, *, measure: str = "peak_to_peak", ax: Axes | None = None, colour: str | None = None,
    legend: bool = True,
) -> Axes:  # fmt: skip
    """Branches of one quantity against the varied parameter.

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.continue_orbit`.
    quantity : str
        A state or an output; a state where ``measure`` is ``section``.
    measure : str
        One of ``peak_to_peak``, ``maximum``, ``minimum``, ``mean``, ``rms``, and ``section``, which lies over the points of
        a diagram.
    ax : Axes, optional
        Drawn into, such as those of a diagram; those of a new figure where absent.
    colour : str, optional
        Of all branches; each has its own where absent.
    legend : bool
        Whether the kinds of events are named.

    Returns
    -------
    Axes

    Raises
    ------
    RangeError
        An unknown quantity or measure.
    """
    if measure not in MEASURES:
        raise RangeError(f"measure is one of {', '.join(MEASURES)}, not {measure!r}")
    over = "state" if measure == "section" else "quantity"
    check_name(quantity, [str(q) for q in ds[over].values], over)
    fresh = ax is None
    ax = axes_or_new(ax, height=3.0)
    name = str(ds.attrs["varied"])
    at, stable = ds[name].values, ds["stable"].values.astype(bool)
    heights = ds[measure].sel({over: quantity}).values.reshape(at.size, -1)
    if measure == "section":
        heights = within_period(ds, quantity, heights)
    for k, number in enumerate(ds["branch"].values):
        here = ds["branch_of"].values == number
        ink = colour or COLOURS[k % len(COLOURS)]
        for column in heights.T[: 1 if measure != "section" else None]:
            for solid, style in ((True, "-"), (False, "--")):
                ax.plot(
                    at[here], _stretches(column[here], stable[here] == solid), ls=style, color=ink, lw=1.2, zorder=3,
                    gid=f"branch-{number}-{'stable' if solid else 'unstable'}",
                )  # fmt: skip
    _marks(ax, ds, name, heights)
    if legend and ds.sizes["event"]:
        handles = dict(zip(*reversed(ax.get_legend_handles_labels()), strict=True))  # one entry a kind, of all calls
        ax.legend(handles.values(), handles.keys(), loc="best")
    if fresh:
        ax.set_xlabel(axis_label(ds, name, meaning=True))
        words = "" if measure == "section" else f", {measure.replace('_', ' ')}"
        ax.set_ylabel(f"{axis_label(ds, quantity)}{words}")
    return ax


@styled
def draw_event_curves(ds: xr.Dataset, *, ax: Axes | None = None, colour: str | None = None) -> Axes:
    """Curves of events in the plane of their two parameters, with cusps and strong resonances.

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.event_curve`.
    ax : Axes, optional
        Drawn into, such as those of a map over the same parameters; those of a new figure where absent.
    colour : str, optional
        Of the curves; that of the event where absent.

    Returns
    -------
    Axes

    Raises
    ------
    RangeError
        A Dataset with one free parameter.
    """
    names = str(ds.attrs["varied"]).split()
    if len(names) != 2:
        raise RangeError(f"a curve of events has two free parameters; this Dataset varies {' '.join(names)}")
    fresh = ax is None
    ax = axes_or_new(ax, height=3.2)
    kind = str(ds.attrs["event"])
    ink = colour or MARKS[kind.replace("-", "_")][1]
    for k, number in enumerate(ds["branch"].values):
        here = ds["branch_of"].values == number
        x, y = (ds[name].values[here] for name in names)
        ax.plot(x, y, color=ink, lw=1.4, zorder=5, label=None if k else kind.replace("-", " "), gid=f"curve-{number}")
    words = str(ds["event_kind"].attrs["flag_meanings"]).split()
    x, y = (ds[f"event_{name}"].values for name in names)
    for code in np.unique(ds["event_kind"].values):
        here = ds["event_kind"].values == code
        mark, edge = MARKS[words[int(code)]]
        label = words[int(code)].replace("_", " ")
        ax.plot(
            x[here], y[here], ls="", marker=mark, mfc="white", mec=edge, ms=6, zorder=6, label=label,
            gid=f"event-{words[int(code)]}",
        )  # fmt: skip
    if fresh:
        ax.set_xlabel(axis_label(ds, names[0], meaning=True))
        ax.set_ylabel(axis_label(ds, names[1], meaning=True))
    return ax


def _stretches(values: Array, here: NDArray[np.bool_]) -> Array:
    """Values of the points here, and of the neighbours, so that no gap is left where stability changes."""
    shown = here.copy()
    shown[1:] |= here[:-1]
    return np.where(shown, values, np.nan)


def _marks(ax: Axes, ds: xr.Dataset, name: str, heights: Array) -> None:
    """Mark events at the height between their neighbours: what is drawn of them is measured at points only."""
    words = str(ds["event_kind"].attrs["flag_meanings"]).split()
    first = ds["first_point"].values
    named = set()
    for k in range(ds.sizes["event"]):
        kind = words[int(ds["event_kind"].values[k])]
        before = int(first[int(ds["event_branch"].values[k]) - 1] + ds["event_after"].values[k])
        value, ends = float(ds[f"event_{name}"].values[k]), ds[name].values[before : before + 2]
        part = (value - ends[0]) / (ends[1] - ends[0]) if ends.size == 2 and ends[1] != ends[0] else 0.5
        pair = heights[before : before + 2]
        height = pair[0] + np.clip(part, 0, 1) * (pair[-1] - pair[0])
        mark, colour = MARKS[kind]
        label = None if kind in named else kind.replace("_", " ")
        named.add(kind)
        shown = height[np.isfinite(height)]
        face = colour if mark == "x" else "white"
        ax.plot(
            np.full(shown.size, value), shown, ls="", marker=mark, mfc=face, mec=colour, ms=4.5, mew=1.1, zorder=4,
            label=label, gid=f"event-{kind}",
        )  # fmt: skip
