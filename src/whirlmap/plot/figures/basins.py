"""Basins of attraction: a slice of start states, coloured by the attractor that each leads to."""

from collections.abc import Callable
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap, to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from whirlmap.plot.common.labels import axis_label, within_period
from whirlmap.plot.common.limits import cell_edges
from whirlmap.plot.common.style import (
    BLUE,
    GREEN,
    INDIGO,
    ORANGE,
    PURPLE,
    REGIMES,
    SKY,
    VERMILION,
    axes_or_new,
    new_figure,
    styled,
)
from whirlmap.results.regime import Regime

#: Colours of attractors by falling share; more than these are together in the last.
COLOURS = (BLUE, ORANGE, GREEN, PURPLE, SKY, VERMILION, INDIGO, "#F0E442", "#8C6D31", "#5A5A5A")
#: Starts that reach no attractor, in the order in which they are drawn.
ENDED = (Regime.contact, Regime.diverged, Regime.drifting, Regime.growing, Regime.not_settled, Regime.undecided)


def attractor_name(ds: xr.Dataset, number: int) -> str:
    """What an attractor is called in legends and tables: ``1: periodic, 2T``."""
    one = ds.sel(attractor=number)
    regime, period = Regime(int(one["regime"])), int(one["period_T"])
    return f"{number}: {regime.label}" + (f", {period}T" if regime == Regime.periodic and period else "")


@styled
def draw_basins(ds: xr.Dataset, *, ax: Axes | None = None) -> Axes:
    """Colour every start state of a slice by its attractor; contact, divergence and undecided are drawn as such.

    Reads ``attractor_of`` and ``start_regime`` over two states, and ``section(attractor, member, state)``: the points of the
    attractors, which lie in the slice only where the other states agree.

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.basins`.
    ax : Axes, optional
        Drawn into; those of a new figure where absent.

    Returns
    -------
    Axes
        Those that were drawn into; ``.figure`` is the figure.
    """
    ax = axes_or_new(ax, width=5.2, height=4.4)
    x, y = (str(d) for d in ds["attractor_of"].dims)
    of, regime = (ds[name].transpose(x, y).values for name in ("attractor_of", "start_regime"))
    edges = [cell_edges(ds[d].values.astype(float), log=False) for d in (x, y)]
    code = np.minimum(of, len(COLOURS))
    colours: list[Any] = ["#FFFFFF", *(_pale(c) for c in COLOURS)]
    ax.pcolormesh(
        *edges, code.T, cmap=ListedColormap(colours), vmin=-0.5, vmax=len(colours) - 0.5, rasterized=True, gid="basins"
    )
    for kind in ENDED:
        chosen = (of == 0) & (regime == kind)
        if chosen.any():
            look = REGIMES[kind]
            shown = np.ma.masked_where(~chosen.T, np.ones(chosen.T.shape))
            ax.pcolormesh(*edges, shown, cmap=ListedColormap([look.colour]), rasterized=True, gid=f"ended-{look.label}")
            if look.hatch:
                ax.contourf(
                    ds[x].values, ds[y].values, chosen.T.astype(float), levels=[0.5, 1.5], colors="none",
                    hatches=[look.hatch],
                )  # fmt: skip
    ax.set(xlim=edges[0][[0, -1]], ylim=edges[1][[0, -1]])
    _mark_attractors(ax, ds, x, y)
    ax.set_xlabel(axis_label(ds, x, meaning=True))
    ax.set_ylabel(axis_label(ds, y, meaning=True))
    return ax


@styled
def draw_starts(ds: xr.Dataset, x: str, y: str, *, ax: Axes | None = None) -> Axes:
    """Start states of a search, in the plane of two states, coloured by their attractor; those without one by their end.

    Reads ``start_state(state, start)``, ``attractor_of`` and ``start_regime`` over the starts, and ``section``.

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.attractors`.
    x, y : str
        States along the axes.
    ax : Axes, optional
        Drawn into; those of a new figure where absent.

    Returns
    -------
    Axes
        Those that were drawn into; ``.figure`` is the figure.
    """
    ax = axes_or_new(ax, width=5.2, height=4.4)
    at = [within_period(ds, d, ds["start_state"].sel(state=d).values) for d in (x, y)]
    of, regime = ds["attractor_of"].values, ds["start_regime"].values
    for number in np.unique(of[of > 0]):
        colour = _pale(COLOURS[min(int(number), len(COLOURS)) - 1])
        here = [values[of == number] for values in at]
        ax.plot(*here, ls="", marker="o", ms=3, mew=0, color=colour, gid=f"starts-{number}")
    for kind in ENDED:
        chosen, look = (of == 0) & (regime == kind), REGIMES[kind]
        if chosen.any():
            ax.plot(
                at[0][chosen], at[1][chosen], ls="", marker=look.marker, ms=3.5, mfc=look.colour, mec="#555555", mew=0.4,
                gid=f"ended-{look.label}",
            )  # fmt: skip
    _mark_attractors(ax, ds, x, y)
    ax.set_xlabel(axis_label(ds, x, meaning=True))
    ax.set_ylabel(axis_label(ds, y, meaning=True))
    return ax


def _mark_attractors(ax: Axes, ds: xr.Dataset, x: str, y: str) -> None:
    """Mark the section points of the attractors, rimmed; many of them are dots in ink, which no basin hides."""
    for number in ds["attractor"].values if "attractor" in ds else ():
        points = ds["section"].sel(attractor=number)
        at = [within_period(ds, d, points.sel(state=d).values) for d in (x, y)]
        colour = COLOURS[min(int(number), len(COLOURS)) - 1]
        if int(np.isfinite(at[0]).sum()) > 64:
            look: dict[str, Any] = {"ms": 1.2, "mew": 0, "color": "black"}
        else:
            look = {"ms": 4.5, "mew": 0.7, "mfc": colour, "mec": "black"}
        ax.plot(*at, ls="", marker="o", gid=f"attractor-{number}", **look)


@styled
def attractors_figure(ds: xr.Dataset, x: str, y: str, *, title: str = "") -> Figure:
    """Start states by their attractor, with the legend of `basins_figure`.

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.attractors`.
    x, y : str
        States along the axes.
    title : str
        Over the whole figure; nothing where empty.

    Returns
    -------
    Figure
        Not known to pyplot; `save` writes it.
    """
    return _with_legend(ds, lambda ax: draw_starts(ds, x, y, ax=ax), title)


@styled
def basins_figure(ds: xr.Dataset, *, title: str = "") -> Figure:
    """Basins with their legend: attractors with their shares, and what starts without one come to.

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.basins`.
    title : str
        Over the whole figure; nothing where empty.

    Returns
    -------
    Figure
        Not known to pyplot; `save` writes it.
    """
    return _with_legend(ds, lambda ax: draw_basins(ds, ax=ax), title)


def _with_legend(ds: xr.Dataset, draw: Callable[[Axes], Axes], title: str) -> Figure:
    fig = new_figure(6.2, 5.6)
    draw(fig.add_subplot())
    handles: list[Patch | Line2D] = []
    numbers = ds["attractor"].values.tolist() if "attractor" in ds else []
    for number in numbers[: len(COLOURS)]:
        share = float(ds["share"].sel(attractor=number))
        name = attractor_name(ds, number)
        if number == len(COLOURS) and len(numbers) > len(COLOURS):
            name, share = f"{number} and {len(numbers) - number} more", float(ds["share"].values[number - 1 :].sum())
        colour = _pale(COLOURS[number - 1])
        handles.append(Patch(facecolor=colour, edgecolor="#555555", lw=0.4, label=f"{name} ({share:.1%})"))
    for kind in ENDED:
        if kind.label not in ds["outcome"].values:  # a file of an earlier version
            continue
        share = float(ds["outcome_share"].sel(outcome=kind.label))
        if share > 0:
            look = REGIMES[kind]
            label = f"{look.label} ({share:.1%})"
            handles.append(Patch(facecolor=look.colour, hatch=look.hatch, edgecolor="#555555", lw=0.4, label=label))
    fig.legend(handles=handles, loc="outside lower center", ncols=3)
    if title:
        fig.suptitle(title)
    return fig


def _pale(colour: str) -> tuple[float, float, float]:
    """A lighter shade of a colour, on which points of the attractor can be seen."""
    red, green, blue = (0.45 + 0.55 * c for c in to_rgb(colour))
    return red, green, blue
