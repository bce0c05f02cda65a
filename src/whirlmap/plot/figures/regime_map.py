"""Regime maps: the regime against two parameters, contour lines of amplitude, and the shares of regimes along each axis."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.path import Path
from numpy.typing import NDArray

from whirlmap.errors import RangeError
from whirlmap.plot.common.labels import axis_label, check_name, symbol, unit_of, unit_text
from whirlmap.plot.common.limits import cell_edges, is_log
from whirlmap.plot.common.style import (
    BLUE,
    GREY,
    INK,
    REGIMES,
    SKY,
    UNFINISHED,
    WIDE,
    Look,
    axes_or_new,
    new_figure,
    styled,
    text_size,
)
from whirlmap.plot.panels.branches import draw_event_curves
from whirlmap.plot.panels.diagram import draw_diagram
from whirlmap.plot.panels.regime_strip import draw_regime_strip, legend_handles
from whirlmap.results.regime import Regime

Codes = NDArray[np.int64]

#: Periodic motion by its number of common periods, as the lightness of its blue; longer ones are together.
PERIODIC = (
    Look("periodic, 1", "#BFDDF2", "o", text=INK), Look("periodic, 2", "#86BFE6", "o", text=INK),
    Look("periodic, 3 to 4", SKY, "o", text=INK), Look("periodic, 5 to 8", "#2E8FC7", "o"),
    Look("periodic, longer", BLUE, "o"),
)  # fmt: skip
#: Longest period of each of these but the last.
_UP_TO = np.array([1, 2, 4, 8])
_OTHERS = (
    Regime.quasi_periodic, Regime.chaotic, Regime.undecided, Regime.contact, Regime.diverged, Regime.at_rest,
    Regime.drifting, Regime.growing, Regime.not_settled, Regime.locked,
)  # fmt: skip
#: How every kind of point looks, by its code.
LOOKS: tuple[Look, ...] = (
    *PERIODIC, *(REGIMES[r] for r in _OTHERS), *UNFINISHED.values(), Look("not reached", "#FFFFFF", "."),
)  # fmt: skip


#: Vertices of a contour line, over the points along both axes, below which it is not drawn.
LEAST_LINE = 0.06


def codes(ds: xr.Dataset) -> Codes:
    """Index into `LOOKS` of every point, in the shape of ``regime``.

    Reads ``regime``, ``status``, ``period_common`` and, where present, ``evaluation`` (0: not reached).
    """
    regime, status = ds["regime"].values, ds["status"].values
    out = np.searchsorted(_UP_TO, ds["period_common"].values).astype(np.int64)
    for k, r in enumerate(_OTHERS):
        out[regime == r] = len(PERIODIC) + k
    for k, s in enumerate(UNFINISHED):
        out[status == s] = len(PERIODIC) + len(_OTHERS) + k
    if "evaluation" in ds:
        out[ds["evaluation"].values == 0] = len(LOOKS) - 1
    return out


@styled
def draw_regime_map(
    ds: xr.Dataset, quantity: str | None = None, *, ax: Axes | None = None, levels: int = 6, label: bool = True
) -> Axes:
    """Regime of every point of a grid over two parameters: the first along the x axis, the second along y.

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.regime_map`.
    quantity : str, optional
        State or output whose ``peak_to_peak`` gives contour lines, from the points that were computed.
    ax : Axes, optional
        Drawn into; those of a new figure where absent.
    levels : int
        About how many of them.
    label : bool
        Whether the axes get their labels.

    Returns
    -------
    Axes
        Those that were drawn into; ``.figure`` is the figure.

    Raises
    ------
    RangeError
        The Dataset has not two dimensions, or no such quantity.
    """
    ax = axes_or_new(ax, width=5.2, height=4.0)
    x, y = _axes_of(ds)
    edges = [cell_edges(ds[d].values.astype(float), log=is_log(ds[d].values)) for d in (x, y)]
    code = codes(ds.transpose(x, y, ...))
    colours = ListedColormap([look.colour for look in LOOKS])
    ax.pcolormesh(*edges, code.T, cmap=colours, vmin=-0.5, vmax=len(LOOKS) - 0.5, rasterized=True, gid="regimes")
    for k in np.unique(code):  # an ended run has a hatch as well, for prints in grey
        if LOOKS[k].hatch:
            _hatch(ax, ds, x, y, code == k, LOOKS[k])
    if quantity is not None:
        _contours(ax, ds, x, y, quantity, levels)
    for set_scale, d in ((ax.set_xscale, x), (ax.set_yscale, y)):
        set_scale("log" if is_log(ds[d].values) else "linear")
    ax.set(xlim=edges[0][[0, -1]], ylim=edges[1][[0, -1]])
    if label:
        ax.set_xlabel(axis_label(ds, x, meaning=True))
        ax.set_ylabel(axis_label(ds, y, meaning=True))
    return ax


@styled
def draw_shares(ds: xr.Dataset, parameter: str, *, ax: Axes | None = None, vertical: bool = False) -> Axes:
    """Share of each regime at every value of one parameter, over all values of the other.

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.regime_map`, over two parameters.
    parameter : str
        The one along the axis.
    ax : Axes, optional
        Drawn into; those of a new figure where absent.
    vertical : bool
        Along the y axis.

    Returns
    -------
    Axes
        Those that were drawn into; ``.figure`` is the figure.

    Raises
    ------
    RangeError
        The Dataset has not two dimensions.
    """
    ax = axes_or_new(ax, height=1.2)
    (other,) = [d for d in _axes_of(ds) if d != parameter]
    at = ds[parameter].values.astype(float)
    edges = cell_edges(at, log=is_log(at))
    code = codes(ds.transpose(parameter, other, ...))
    below = np.zeros(at.size)
    options: dict[str, Any] = {"step": "post", "lw": 0, "edgecolor": "#555555"}
    for k in np.unique(code):
        share = below + (code == k).mean(axis=1)
        low, high = (np.append(v, v[-1]) for v in (below, share))
        fill = ax.fill_betweenx if vertical else ax.fill_between
        look = LOOKS[k]
        fill(edges, low, high, facecolor=look.colour, hatch=look.hatch or None, gid=look.label, **options)
        below = share
    if vertical:
        ax.set(xlim=(0, 1), ylim=edges[[0, -1]], yscale="log" if is_log(at) else "linear")
        ax.set_xlabel("share")
    else:
        ax.set(ylim=(0, 1), xlim=edges[[0, -1]], xscale="log" if is_log(at) else "linear")
        ax.set_ylabel("share")
    return ax


@styled
def regime_map_figure(
    ds: xr.Dataset, quantity: str | None = None, *, title: str | None = None, curves: Sequence[xr.Dataset] = ()
) -> Figure:
    """Map of regimes with its legend, contour lines of an amplitude, and the shares of regimes along both axes.

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.regime_map`, over two parameters.
    quantity : str, optional
        State or output whose ``peak_to_peak`` gives contour lines.
    title : str, optional
        Over the whole figure.
    curves : sequence of xr.Dataset
        Of `event_curve` over the same parameters, drawn over the map.

    Returns
    -------
    Figure
        Not known to pyplot; `save` writes it.

    Raises
    ------
    RangeError
        The Dataset has not two dimensions, or no such quantity; curves over other parameters.
    """
    x, y = _axes_of(ds)
    fig = new_figure(WIDE, 5.4)
    grid = fig.add_gridspec(2, 2, width_ratios=[5, 1], height_ratios=[1, 5])
    main = fig.add_subplot(grid[1, 0])
    draw_regime_map(ds, quantity, ax=main)
    for each in curves:
        draw_event_curves(each, ax=main, colour=INK)
    if curves:
        main.legend(loc="best")
    above = draw_shares(ds, x, ax=fig.add_subplot(grid[0, 0], sharex=main))
    beside = draw_shares(ds, y, ax=fig.add_subplot(grid[1, 1], sharey=main), vertical=True)
    above.tick_params(labelbottom=False)
    beside.tick_params(labelleft=False)
    common = int(ds.attrs.get("common_multiple", 1))
    counted = "T" if common == 1 else f"common periods of {common}T"
    if "common_multiple" in ds:
        counted = "common periods, which differ between points"
    fig.legend(handles=_legend(ds, quantity), loc="outside lower center", ncols=4, title=f"periods are counted in {counted}")
    if title:
        fig.suptitle(title)
    return fig


@styled
def regime_line_figure(ds: xr.Dataset, quantity: str, *, title: str | None = None) -> Figure:
    """Amplitude of a quantity over the strip of regimes, for a sweep of one dimension; with sections, its diagram.

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.regime_map`, over one parameter.
    quantity : str
        State or output whose ``peak_to_peak`` is drawn; a state whose section was kept gets its diagram.
    title : str, optional
        Over the whole figure.

    Returns
    -------
    Figure
        Not known to pyplot; `save` writes it.

    Raises
    ------
    RangeError
        No such quantity.
    """
    (x,) = (str(d) for d in ds["regime"].dims)
    at = ds[x].values.astype(float)
    fig = new_figure(WIDE, 3.6)
    above, below = fig.subplots(2, 1, height_ratios=[4, 1], sharex=True)
    if "section" in ds and quantity in ds["state"].values:
        draw_diagram(ds.assign_attrs(varied=x), quantity, ax=above)
        return _finished(fig, ds, x, below, title)
    height = ds["peak_to_peak"].sel(quantity=check_name(quantity, [str(q) for q in ds["quantity"].values], "quantity"))
    above.plot(at, height.values, ls="", marker="o", ms=1.8, mew=0, color=INK, rasterized=True)
    above.set_ylabel(_amplitude_words(ds, quantity))
    return _finished(fig, ds, x, below, title)


def _finished(fig: Figure, ds: xr.Dataset, x: str, below: Axes, title: str | None) -> Figure:
    draw_regime_strip(ds.assign_attrs(varied=x), ax=below)
    fig.legend(handles=legend_handles(ds), loc="outside lower center", ncols=4)
    if title:
        fig.suptitle(title)
    return fig


def _legend(ds: xr.Dataset, quantity: str | None) -> list[Any]:
    handles: list[Any] = [
        Patch(facecolor=LOOKS[k].colour, hatch=LOOKS[k].hatch or None, edgecolor="#555555", lw=0.4, label=LOOKS[k].label)
        for k in np.unique(codes(ds))
    ]
    if quantity is not None:
        handles.append(Line2D([], [], color=INK, lw=0.7, label=_amplitude_words(ds, quantity)))
    return handles


def _amplitude_words(ds: xr.Dataset, quantity: str) -> str:
    unit = unit_of(ds, quantity)
    return f"peak to peak of {symbol(quantity, ds)}" + (f" {unit_text(unit)}" if unit != "1" else "")


def _axes_of(ds: xr.Dataset) -> tuple[str, str]:
    dims = [str(d) for d in ds["regime"].dims]
    if len(dims) != 2:
        raise RangeError(f"a map has two dimensions, this Dataset has {dims}: take one value of the others with .isel")
    return dims[0], dims[1]


def _hatch(ax: Axes, ds: xr.Dataset, x: str, y: str, where: NDArray[np.bool_], look: Look) -> None:
    if min(where.shape) < 2:
        return
    drawn = ax.contourf(
        ds[x].values, ds[y].values, where.T.astype(float), levels=[0.5, 1.5], colors="none", hatches=[look.hatch[:3]]
    )
    drawn.set_edgecolor(GREY)
    drawn.set_linewidth(0)


def _contours(ax: Axes, ds: xr.Dataset, x: str, y: str, quantity: str, levels: int) -> None:
    """Contour lines through the computed points; between them, where refinement left gaps, by straight lines."""
    check_name(quantity, [str(q) for q in ds["quantity"].values], "quantity")
    height = ds["peak_to_peak"].sel(quantity=quantity).transpose(x, y).values
    known = np.isfinite(height)
    if min(height.shape) < 3 or known.sum() < 9 or np.ptp(height[known]) == 0:
        return
    if "evaluation" in ds and (ds["evaluation"].values == 2).any():
        height = _between(height, known)
    low, high = np.nanquantile(height, [0.02, 0.98])
    lines = ax.contour(
        ds[x].values, ds[y].values, np.ma.masked_invalid(height).T, levels=np.linspace(low, high, levels + 2)[1:-1],
        colors=INK, linewidths=0.45, alpha=0.75,
    )  # fmt: skip
    _drop_short(lines, LEAST_LINE * sum(height.shape))
    ax.clabel(lines, fontsize=text_size(5.5), fmt=_two_digits, inline_spacing=2, inline=min(height.shape) > 40)


def _two_digits(level: float) -> str:
    return f"{level:.0f}" if 100 <= abs(level) < 1e5 else f"{level:.2g}"


def _drop_short(lines: ContourSet, least: float) -> None:
    """Leave out contour lines round a few points: where attractors coexist, and in chaos, they would hide the map."""
    kept = []
    for path in lines.get_paths():
        parts = [Path(line) for line in path.to_polygons(closed_only=False) if len(np.asarray(line)) >= least]
        kept.append(Path.make_compound_path(*parts) if parts else Path(np.empty((0, 2))))
    lines.set_paths(kept)


def _between(height: NDArray[np.float64], known: NDArray[np.bool_]) -> NDArray[np.float64]:
    from scipy.interpolate import LinearNDInterpolator

    at = np.argwhere(known)
    return np.asarray(LinearNDInterpolator(at, height[known])(*np.indices(height.shape)))
