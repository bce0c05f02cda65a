"""Bifurcation diagrams: section values against a parameter, the regimes beneath, exponents of what does not return."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from whirlmap.errors import RangeError
from whirlmap.plot.labels import axis_label, check_name, unit_of, unit_text
from whirlmap.plot.limits import cell_edges, is_log, limits, runs
from whirlmap.plot.style import DIRECTIONS, INK, Look, axes_or_new, look_of, styled


def varied(ds: xr.Dataset) -> str:
    """Name of the parameter that a diagram varies."""
    name = ds.attrs.get("varied")
    if name is None:
        dims = [str(d) for d in ds["regime"].dims if d != "direction"]
        if len(dims) != 1:
            raise RangeError(f"a diagram varies one parameter; this Dataset varies {dims or 'none'}")
        name = dims[0]
    return str(name)


@styled
def draw_diagram(
    ds: xr.Dataset,
    state: str,
    *,
    ax: Axes | None = None,
    colour_by_regime: bool = False,
    markersize: float | None = None,
    log: bool | None = None,
) -> Axes:
    """Section values of one state against the varied parameter.

    Reads ``section(parameter, period, state)``, ``regime``, ``status`` and, for the shortest axis, ``minimum`` and
    ``maximum``; with a dimension ``direction`` the two sweeps get a colour each. Values at which no run came to its
    end are hatched: contact, divergence and unresolved steps are results, not gaps.

    Parameters
    ----------
    colour_by_regime : bool
        Colour points by their regime instead of in ink (single sweeps only).
    markersize : float, optional
        In points; by the number of section points where absent.
    log : bool, optional
        Logarithmic parameter axis; where absent, if the values are spaced by a constant factor.
    """
    ax = axes_or_new(ax, height=3.0)
    parameter = varied(ds)
    check_name(state, [str(s) for s in ds["state"].values], "state")
    at = ds[parameter].values.astype(float)
    log = is_log(at) if log is None else log
    cloud = ds["section"].sel(state=state)
    size = _markersize(at.size, ds.sizes["period"]) if markersize is None else markersize
    for order, (sweep, colour) in enumerate(_sweeps(ds)):
        values = sweep["section"].sel(state=state).transpose(parameter, "period").values
        if colour_by_regime and "direction" not in ds.dims:
            for regime in np.unique(sweep["regime"].values):
                chosen = sweep["regime"].values == regime
                _points(ax, at[chosen], values[chosen], look_of(int(regime)).colour, size)
        else:
            # Where two sweeps agree, the later is drawn within the earlier, so that both are seen.
            _points(ax, at, values, colour, size * 1.8 if "direction" in ds.dims and order == 0 else size)
    _parameter_axis(ax, ds, at, log)
    _shade_ended(ax, ds, at, log)
    swing = _swing(ds, state)
    ax.set_ylim(limits(cloud.values, amplitude=swing, others=_largest(ds)))
    ax.set_ylabel(axis_label(ds, state))
    return ax


@styled
def draw_regime_strip(ds: xr.Dataset, *, ax: Axes | None = None, log: bool | None = None, label: bool = True) -> Axes:
    """Colour strip of the regime at every value of the varied parameter, one row per direction of sweep.

    Reads ``regime``, ``status`` and, where present, ``period_T``: the number of T is written into stretches that are
    wide enough for it.
    """
    ax = axes_or_new(ax, height=0.8)
    parameter = varied(ds)
    at = ds[parameter].values.astype(float)
    log = is_log(at) if log is None else log
    edges = cell_edges(at, log=log)
    ax.set_xscale("log" if log else "linear")
    directions = _directions(ds)
    for row, direction in enumerate(directions):
        part = ds if direction is None else ds.sel(direction=direction)
        period = part["period_T"].values if "period_T" in part else np.zeros(at.size, dtype=int)
        looks = [look_of(r, s) for r, s in zip(part["regime"].values, part["status"].values, strict=True)]
        bottom = len(directions) - 1 - row
        for first, last in runs(list(looks)):
            _bar(ax, edges[first], edges[last + 1], bottom, looks[first])
        for first, last in runs([(one.label, int(n)) for one, n in zip(looks, period, strict=True)]):
            if period[first] > 0:
                _write_period(ax, edges, first, last, bottom, f"{int(period[first])}T", looks[first])
    ax.set(xlim=(edges[0], edges[-1]), ylim=(0, len(directions)))
    ax.set_yticks(np.arange(len(directions)) + 0.5, [d or "regime" for d in reversed(directions)])
    ax.tick_params(axis="y", length=0)
    ax.spines["left"].set_visible(False)
    if label:
        ax.set_xlabel(axis_label(ds, parameter, meaning=True))
    return ax


@styled
def draw_exponents(ds: xr.Dataset, *, ax: Axes | None = None, log: bool | None = None) -> Axes:
    """Largest Lyapunov exponent, with one standard error, of the points where it was measured.

    Reads ``lyapunov``, ``lyapunov_error`` and ``regime``; colours and markers are those of the regimes.
    """
    ax = axes_or_new(ax, height=2.0)
    parameter = varied(ds)
    at = ds[parameter].values.astype(float)
    log = is_log(at) if log is None else log
    ax.axhline(0.0, color=INK, lw=0.7)
    if not np.isfinite(ds["lyapunov"].values).any():
        ax.text(0.5, 0.75, "no exponent measured", transform=ax.transAxes, ha="center", va="center", color="#555555")
    for sweep, _ in _sweeps(ds):
        value, error = sweep["lyapunov"].values, sweep["lyapunov_error"].values
        for regime in np.unique(sweep["regime"].values):
            chosen = (sweep["regime"].values == regime) & np.isfinite(value)
            look = look_of(int(regime))
            if chosen.any():
                ax.errorbar(at[chosen], value[chosen], np.nan_to_num(error[chosen]), fmt=look.marker, ms=2.6, lw=0.6,
                            color=look.colour, ecolor=look.colour, mec="#555555", mew=0.3)  # fmt: skip
    _parameter_axis(ax, ds, at, log)
    _shade_ended(ax, ds, at, log)
    ax.set_ylim(limits(np.append(ds["lyapunov"].values.ravel(), 0.0)))
    ax.set_ylabel(rf"$\lambda_1$ {unit_text(unit_of(ds, 'lyapunov'))}")
    return ax


def legend_handles(ds: xr.Dataset) -> list[Patch | Line2D]:
    """Patches of the regimes that a diagram holds, and lines of its directions of sweep."""
    pairs = np.stack([ds["regime"].values.ravel(), ds["status"].values.ravel()], axis=1)
    looks = {look_of(int(r), int(s)).label: look_of(int(r), int(s)) for r, s in np.unique(pairs, axis=0)}
    handles: list[Patch | Line2D] = [_patch(one) for one in looks.values()]
    for direction in _directions(ds):
        if direction is not None:
            one = DIRECTIONS[direction]
            handles.append(Line2D([], [], ls="", marker=".", ms=5, color=one.colour, label=f"sweep {direction}"))
    return handles


def _patch(look: Look) -> Patch:
    return Patch(facecolor=look.colour, hatch=look.hatch, edgecolor="#555555", lw=0.4, label=look.label)


def _directions(ds: xr.Dataset) -> list[str | None]:
    return [str(d) for d in ds["direction"].values] if "direction" in ds.dims else [None]


def _sweeps(ds: xr.Dataset) -> list[tuple[xr.Dataset, str]]:
    """Each sweep of a Dataset with the colour of its points."""
    if "direction" in ds.dims:
        return [(ds.sel(direction=d), DIRECTIONS[str(d)].colour) for d in ds["direction"].values]
    return [(ds, INK)]


def _markersize(values: int, periods: int) -> float:
    return float(np.clip(32.0 / np.sqrt(values) / periods**0.15, 0.8, 2.6))


def _points(ax: Axes, at: NDArray[np.float64], values: NDArray[np.float64], colour: str, size: float) -> None:
    x = np.repeat(at, values.shape[1])
    ax.plot(x, values.ravel(), ls="", marker="o", ms=size, mew=0, color=colour, rasterized=True)


def _shade_ended(ax: Axes, ds: xr.Dataset, at: NDArray[np.float64], log: bool) -> None:
    """Hatch the values at which no sweep came to its end."""
    parameter = varied(ds)
    status = ds["status"]
    ended = (status != 0).all("direction") if "direction" in ds.dims else status != 0
    first = ds.isel(direction=0) if "direction" in ds.dims else ds
    edges = cell_edges(at, log=log)
    looks = [
        look_of(r, s) if e else None
        for r, s, e in zip(first["regime"].values, first["status"].values, ended.transpose(parameter).values, strict=True)
    ]
    for begin, last in runs(list(looks)):
        look = looks[begin]
        if look is not None:
            ax.axvspan(edges[begin], edges[last + 1], facecolor="none", hatch=look.hatch[:3], edgecolor="#A8A8A8", lw=0,
                       zorder=0.5, label=f"_{look.label}", gid=f"ended-{look.label}")  # fmt: skip
            if _share(ax, edges, begin, last) > 0.08:
                middle = np.sqrt(edges[begin] * edges[last + 1]) if log else (edges[begin] + edges[last + 1]) / 2
                ax.text(middle, 0.5, look.label, transform=ax.get_xaxis_transform(), ha="center", va="center", fontsize=7,
                        bbox={"fc": "white", "ec": "none", "pad": 1.5}, clip_on=True)  # fmt: skip


def _parameter_axis(ax: Axes, ds: xr.Dataset, at: NDArray[np.float64], log: bool) -> None:
    edges = cell_edges(at, log=log)
    ax.set_xscale("log" if log else "linear")
    ax.set_xlim(edges[0], edges[-1])
    ax.set_xlabel(axis_label(ds, varied(ds), meaning=True))


def _swing(ds: xr.Dataset, state: str) -> float:
    """Largest peak-to-peak range of the state at any one value, from the whole record; zero where it is not given."""
    if "maximum" not in ds or state not in ds["quantity"].values:
        return 0.0
    size = (ds["maximum"] - ds["minimum"]).sel(quantity=state).values
    return float(np.nanmax(size)) if np.isfinite(size).any() else 0.0


def _largest(ds: xr.Dataset) -> float:
    values = np.abs(ds["section"].values)
    return float(np.nanmax(values)) if np.isfinite(values).any() else 0.0


def _bar(ax: Axes, left: float, right: float, bottom: float, look: Look) -> None:
    options: dict[str, Any] = {"facecolor": look.colour, "edgecolor": "#555555" if look.hatch else "none"}
    ax.broken_barh([(left, right - left)], (bottom + 0.06, 0.88), hatch=look.hatch or None, lw=0, zorder=1.0,
                   gid=f"regime-{look.label}", **options)  # fmt: skip


def _write_period(
    ax: Axes, edges: NDArray[np.float64], first: int, last: int, bottom: float, text: str, look: Look
) -> None:
    """Write the number of T into a stretch that takes up enough of the axis for its text."""
    inches = _share(ax, edges, first, last) * ax.get_position().width * ax.figure.get_figure(root=True).get_size_inches()[0]
    if inches >= 0.075 * len(text):
        middle = np.sqrt(edges[first] * edges[last + 1]) if ax.get_xscale() == "log" else edges[[first, last + 1]].mean()
        ax.text(float(middle), bottom + 0.47, text, ha="center", va="center", fontsize=6.5, color=look.text, clip_on=True)


def _share(ax: Axes, edges: NDArray[np.float64], first: int, last: int) -> float:
    """Share of the axis that a stretch of cells takes up."""
    ends = np.array([edges[first], edges[last + 1], edges[0], edges[-1]])
    left, right, begin, end = np.log(ends) if ax.get_xscale() == "log" else ends
    return float((right - left) / (end - begin))
