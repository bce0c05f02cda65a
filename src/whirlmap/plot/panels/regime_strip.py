"""Panels under a bifurcation diagram: the strip of regimes, the exponents, the legend."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from whirlmap.plot.common.labels import axis_label, unit_of, unit_text
from whirlmap.plot.common.limits import cell_edges, is_log, limits, runs
from whirlmap.plot.common.style import DIRECTIONS, HYSTERESIS, INK, Look, axes_or_new, look_of, styled, text_size
from whirlmap.plot.common.sweep_axes import directions, parameter_axis, shade_ended, shade_hysteresis, share, sweeps, varied


@styled
def draw_regime_strip(ds: xr.Dataset, *, ax: Axes | None = None, log: bool | None = None, label: bool = True) -> Axes:
    """Colour strip of the regime at every value of the varied parameter, one row per direction of sweep.

    Reads ``regime``, ``status`` and, where present, ``period_T``: the number of T is written into stretches
    that are wide enough for it.

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.bifurcation_diagram`.
    ax : Axes, optional
        Drawn into; those of a new figure where absent.
    log : bool, optional
        Logarithmic parameter axis; where absent, if the values are spaced by a constant factor.
    label : bool
        Whether the parameter's axis gets its label.

    Returns
    -------
    Axes
        Those that were drawn into; ``.figure`` is the figure.

    Raises
    ------
    RangeError
        The Dataset varies no parameter, or more than one.
    """
    ax = axes_or_new(ax, height=0.8)
    parameter = varied(ds)
    at = ds[parameter].values.astype(float)
    log = is_log(at) if log is None else log
    edges = cell_edges(at, log=log)
    ax.set_xscale("log" if log else "linear")
    rows = directions(ds)
    for row, direction in enumerate(rows):
        part = ds if direction is None else ds.sel(direction=direction)
        period = part["period_T"].values if "period_T" in part else np.zeros(at.size, dtype=int)
        looks = [look_of(r, s) for r, s in zip(part["regime"].values, part["status"].values, strict=True)]
        bottom = len(rows) - 1 - row
        for first, last in runs(list(looks)):
            _bar(ax, edges[first], edges[last + 1], bottom, looks[first])
        stretches = runs([(one.label, int(n)) for one, n in zip(looks, period, strict=True)])
        for first, last in stretches:
            if len(stretches) < 60 and first > 0 and looks[first] == looks[first - 1]:
                ax.vlines(edges[first], bottom + 0.06, bottom + 0.94, color="white", lw=0.7, zorder=1.5)
            if period[first] > 0:
                _write_period(ax, edges, first, last, bottom, f"{int(period[first])}T", looks[first])
    ax.set(xlim=(edges[0], edges[-1]), ylim=(0, len(rows)))
    ax.set_yticks(np.arange(len(rows)) + 0.5, [d or "regime" for d in reversed(rows)])
    ax.tick_params(axis="y", length=0)
    ax.spines["left"].set_visible(False)
    if label:
        ax.set_xlabel(axis_label(ds, parameter, meaning=True))
    return ax


@styled
def draw_exponents(ds: xr.Dataset, *, ax: Axes | None = None, log: bool | None = None) -> Axes:
    """Largest Lyapunov exponent, with one standard error, of the points where it was measured.

    Reads ``lyapunov``, ``lyapunov_error`` and ``regime``; colours and markers are those of the regimes.

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.bifurcation_diagram`.
    ax : Axes, optional
        Drawn into; those of a new figure where absent.
    log : bool, optional
        Logarithmic parameter axis; where absent, if the values are spaced by a constant factor.

    Returns
    -------
    Axes
        Those that were drawn into; ``.figure`` is the figure.

    Raises
    ------
    RangeError
        The Dataset varies no parameter, or more than one.
    """
    ax = axes_or_new(ax, height=2.0)
    parameter = varied(ds)
    at = ds[parameter].values.astype(float)
    log = is_log(at) if log is None else log
    ax.axhline(0.0, color=INK, lw=0.7)
    if not np.isfinite(ds["lyapunov"].values).any():
        ax.text(
            0.5,
            0.75,
            "no exponent measured",
            transform=ax.transAxes,
            ha="center",
            va="center",
            color="#555555",
        )
    for sweep, _ in sweeps(ds):
        value, error = sweep["lyapunov"].values, sweep["lyapunov_error"].values
        for regime in np.unique(sweep["regime"].values):
            chosen = (sweep["regime"].values == regime) & np.isfinite(value)
            look = look_of(int(regime))
            if chosen.any():
                ax.errorbar(
                    at[chosen],
                    value[chosen],
                    np.nan_to_num(error[chosen]),
                    fmt=look.marker,
                    ms=2.6,
                    lw=0.6,
                    color=look.colour,
                    ecolor=look.colour,
                    mec="#555555",
                    mew=0.3,
                )
    parameter_axis(ax, ds, at, log)
    shade_ended(ax, ds, at, log, words=False)
    shade_hysteresis(ax, ds, at, log)
    ax.set_ylim(limits(np.append(ds["lyapunov"].values.ravel(), 0.0)))
    ax.set_ylabel(rf"$\lambda_1$ {unit_text(unit_of(ds, 'lyapunov'))}")
    return ax


def legend_handles(ds: xr.Dataset) -> list[Patch | Line2D]:
    """Patches of the regimes that a diagram holds, and lines of its directions of sweep."""
    pairs = np.stack([ds["regime"].values.ravel(), ds["status"].values.ravel()], axis=1)
    looks = {look_of(int(r), int(s)).label: look_of(int(r), int(s)) for r, s in np.unique(pairs, axis=0)}
    handles: list[Patch | Line2D] = [_patch(one) for one in looks.values()]
    for direction in directions(ds):
        if direction is not None:
            one = DIRECTIONS[direction]
            handles.append(Line2D([], [], ls="", marker=".", ms=5, color=one.colour, label=f"sweep {direction}"))
    if "hysteresis" in ds and (ds["hysteresis"] == 1).any():
        handles.append(Patch(facecolor=HYSTERESIS, edgecolor="#555555", lw=0.4, label="up and down differ"))
    return handles


def _patch(look: Look) -> Patch:
    return Patch(facecolor=look.colour, hatch=look.hatch, edgecolor="#555555", lw=0.4, label=look.label)


def _bar(ax: Axes, left: float, right: float, bottom: float, look: Look) -> None:
    options: dict[str, Any] = {"facecolor": look.colour, "edgecolor": "#555555" if look.hatch else "none"}
    ax.broken_barh(
        [(left, right - left)],
        (bottom + 0.06, 0.88),
        hatch=look.hatch or None,
        lw=0,
        zorder=1.0,
        gid=f"regime-{look.label}",
        **options,
    )


def _write_period(ax: Axes, edges: NDArray[np.float64], first: int, last: int, bottom: float, text: str, look: Look) -> None:
    """Write the number of T into a stretch that takes up enough of the axis for its text."""
    inches = share(ax, edges, first, last) * ax.get_position().width * ax.figure.get_figure(root=True).get_size_inches()[0]
    if inches >= 0.075 * len(text):
        middle = np.sqrt(edges[first] * edges[last + 1]) if ax.get_xscale() == "log" else edges[[first, last + 1]].mean()
        ax.text(
            float(middle),
            bottom + 0.47,
            text,
            ha="center",
            va="center",
            fontsize=text_size(6.5),
            color=look.text,
            clip_on=True,
        )
