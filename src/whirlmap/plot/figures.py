"""Composed figures: diagrams with their regimes, the paper's Figures 2 to 7, and the sheet of a diagnosis."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from whirlmap.plot.convergence import draw_convergence
from whirlmap.plot.diagram import draw_diagram, draw_exponents, draw_regime_strip, legend_handles
from whirlmap.plot.dimension import draw_correlation_sum, draw_local_slope
from whirlmap.plot.orbit import draw_orbit
from whirlmap.plot.parts import clock_name, journal_of, marked_shaft, parts_of
from whirlmap.plot.phase_portrait import draw_phase_portrait
from whirlmap.plot.section import draw_section
from whirlmap.plot.spectrum import Orders, draw_power_spectrum
from whirlmap.plot.style import WIDE, new_figure, styled, write_reason
from whirlmap.plot.time_series import draw_time_series

Reasons = Mapping[str, str]

#: What stands in a panel for which nothing was given, and no reason either.
ABSENT = "not computed"

#: Periods T of a time series that a sheet shows.
SHOWN = 40


@styled
def diagram_figure(
    ds: xr.Dataset,
    states: Sequence[str],
    *,
    columns: int = 1,
    exponents: bool | None = None,
    names: Mapping[str, str] | None = None,
    title: str = "",
    log: bool | None = None,
) -> Figure:
    """Bifurcation diagrams of several states over one regime strip per column.

    Parameters
    ----------
    ds : xr.Dataset
        From `bifurcation_diagram`; what is read of it, `draw_diagram` says.
    exponents : bool, optional
        Whether a panel of largest exponents stands at the bottom; where absent, if any was measured.
    names : mapping of state to str, optional
        Titles of the panels: ``{"yp": "pinion"}``.
    log : bool, optional
        Logarithmic parameter axis; where absent, if the values are spaced by a constant factor.
    """
    columns = min(columns, len(states))
    rows = -(-len(states) // columns)
    if exponents is None:
        exponents = "lyapunov" in ds and bool(np.isfinite(ds["lyapunov"].values).any())
    heights = [1.0] * rows + [0.09 * ds.sizes.get("direction", 1)] + [0.5] * exponents
    fig = new_figure(WIDE, 0.8 + (1.75 if columns > 1 else 2.0) * sum(heights))
    grid = fig.add_gridspec(len(heights), columns, height_ratios=heights)
    for column in range(columns):
        top: Axes | None = None
        for row, state in enumerate(states[column::columns]):
            ax = fig.add_subplot(grid[row, column], sharex=top)
            top = top or ax
            draw_diagram(ds, state, ax=ax, log=log)
            ax.set_title((names or {}).get(state, ""))
            _bare(ax)
        strip = fig.add_subplot(grid[rows, column], sharex=top)
        draw_regime_strip(ds, ax=strip, log=log, label=not exponents)
        if exponents:
            _bare(strip)
            draw_exponents(ds, ax=fig.add_subplot(grid[rows + 1, column], sharex=top), log=log)
    fig.align_ylabels()
    fig.legend(handles=legend_handles(ds), loc="outside lower center", ncols=6)
    if title:
        fig.suptitle(title)
    return fig


def paper_diagram_figure(
    ds: xr.Dataset,
    states: Sequence[str] = ("yp", "yg", "y1", "y2"),
    *,
    names: Mapping[str, str] | None = None,
    exponents: bool | None = False,
    title: str = "",
) -> Figure:
    """Figures 2 to 5 of the paper: four centres against the speed ratio, for one permeability.

    Options as in `diagram_figure`, in two columns.
    """
    return diagram_figure(ds, states, columns=2, exponents=exponents, names=names, title=title)


@styled
def paper_orbit_figure(
    coordinate: str,
    *,
    series: xr.Dataset | None = None,
    spectrum: xr.Dataset | None = None,
    lines: xr.Dataset | None = None,
    section: xr.Dataset | None = None,
    lyapunov: xr.Dataset | None = None,
    dimension: xr.Dataset | None = None,
    velocity: str | None = None,
    orders: Orders | None = None,
    clock: str = "mesh",
    turns: float | None = None,
    highest: float | None = 3.0,
    reasons: Reasons | None = None,
    title: str = "",
) -> Figure:
    """Figures 6 and 7 of the paper, for one coordinate of one operating point.

    Phase portrait, power spectrum, Poincaré map, convergence of the exponent, correlation sum and its slopes.

    Parameters
    ----------
    series, spectrum, lines, section, lyapunov, dimension : xr.Dataset, optional
        From `simulate`, `power_spectrum`, `spectral_lines`, `section`, `lyapunov_spectrum`, `correlation_dimension`.
        A panel whose Dataset is absent says why.
    reasons : mapping of str to str, optional
        Why a part is absent, by the names above: ``{"dimension": "periodic: a finite set of points"}``.
    velocity : str, optional
        The other state of phase portrait and section; the coordinate's velocity where absent.
    """
    fig = new_figure(WIDE, 7.6)
    axes = fig.subplots(3, 2).ravel()
    why = dict(reasons or {})
    _panel(axes[0], series, "series", why, lambda ds, ax: draw_phase_portrait(
        ds, coordinate, velocity, ax=ax, turns=turns))  # fmt: skip
    _panel(axes[1], spectrum, "spectrum", why, lambda ds, ax: draw_power_spectrum(
        ds, ax=ax, lines=lines, orders=orders, highest=highest, clock=clock, name=coordinate))  # fmt: skip
    _panel(axes[2], section, "section", why, lambda ds, ax: draw_section(
        ds, coordinate, velocity, ax=ax, orbit=series))  # fmt: skip
    _panel(axes[3], lyapunov, "lyapunov", why, lambda ds, ax: draw_convergence(ds, ax=ax))
    _panel(axes[4], dimension, "dimension", why, lambda ds, ax: draw_correlation_sum(ds, ax=ax))
    _panel(axes[5], dimension, "dimension", why, lambda ds, ax: draw_local_slope(ds, ax=ax))
    for ax, letter in zip(axes, "abcdef", strict=True):
        _letter(ax, letter)
    if title:
        fig.suptitle(title)
    return fig


@styled
def diagnosis_figure(
    ds: xr.Dataset,
    coordinate: str,
    *,
    velocity: str | None = None,
    orbit: tuple[str, str] | None = None,
    clearance: float | None = 1.0,
    order: Fraction | float | None = None,
    shaft: str = "",
    orders: Orders | None = None,
    clock: str = "",
    turns: float | None = None,
    highest: float | None = 3.0,
    title: str = "",
    **given: xr.Dataset,
) -> Figure:
    """Six panels on one operating point, what a rotordynamicist looks at first.

    Orbit of a journal in its clearance circle (or, for a system without one, the time series), phase portrait, section,
    power spectrum with named orders, convergence of the exponents, correlation sum with the fitted range. What the
    Dataset lacks is said in the panel.

    Parameters
    ----------
    ds : xr.Dataset
        From `diagnose`, which holds all parts; or from `simulate`, with the other parts given one by one.
    coordinate, velocity : str
        States of phase portrait and section, and of the spectrum.
    orbit : tuple of str, optional
        States of the orbit panel, horizontal and vertical; the first journal where absent.
    clearance : float, optional
        Radius of the clearance circle, None where the orbit has none.
    order, shaft : number, str
        Turns in one T and name of the shaft whose turns are marked; the second clock of the Dataset where absent.
    orders : mapping of str to number
        Named orders; the Dataset's clocks where absent.
    clock : str
        What 1/T is called; the clock that turns once in T where absent.
    **given : xr.Dataset
        ``spectrum``, ``lines``, ``section``, ``lyapunov``, ``dimension``: parts that ``ds`` does not hold.
    """
    parts = replace(parts_of(ds, coordinate), **given)
    orders = parts.orders if orders is None else orders
    clock = clock or clock_name(orders)
    if order is None:
        shaft, order = marked_shaft(orders) if not shaft else (shaft, orders.get(shaft, 1))
    path = journal_of(ds) if orbit is None else orbit

    def first(ds: xr.Dataset, ax: Axes) -> Axes:
        if path is None:
            return draw_time_series(ds, coordinate, ax=ax, turns=turns or SHOWN)
        return draw_orbit(ds, *path, ax=ax, clearance=clearance, order=abs(order), shaft=shaft, turns=turns)

    fig = new_figure(1.35 * WIDE, 6.2)
    axes = fig.subplots(2, 3).ravel()
    sizes = {name: abs(value) for name, value in orders.items()}
    why = parts.reasons
    _panel(axes[0], parts.series, "series", why, first)
    _panel(axes[1], parts.series, "series", why, lambda ds, ax: draw_phase_portrait(
        ds, coordinate, velocity, ax=ax, turns=turns))  # fmt: skip
    _panel(axes[2], parts.section, "section", why, lambda ds, ax: draw_section(
        ds, coordinate, velocity, ax=ax, orbit=parts.series))  # fmt: skip
    _panel(axes[3], parts.spectrum, "spectrum", why, lambda ds, ax: draw_power_spectrum(
        ds, ax=ax, lines=parts.lines, orders=sizes, highest=highest, clock=clock, name=coordinate))  # fmt: skip
    _panel(axes[4], parts.lyapunov, "lyapunov", why, lambda ds, ax: draw_convergence(ds, ax=ax, count=2))
    _panel(axes[5], parts.dimension, "dimension", why, lambda ds, ax: draw_correlation_sum(ds, ax=ax))
    for ax, letter in zip(axes, "abcdef", strict=True):
        _letter(ax, letter)
    if title:
        fig.suptitle(title)
    return fig


def _panel(
    ax: Axes, ds: xr.Dataset | None, part: str, reasons: dict[str, str], draw: Callable[[xr.Dataset, Axes], Axes]
) -> None:
    """Draw a part into its panel, or write there why it is absent."""
    if ds is None:
        write_reason(ax, f"{part}:\n{reasons.get(part, ABSENT)}")
    else:
        draw(ds, ax)


def _letter(ax: Axes, letter: str) -> None:
    """Put the letter that a caption refers to into the upper right corner."""
    ax.text(0.985, 0.975, letter, transform=ax.transAxes, ha="right", va="top", fontweight="bold", fontsize=9, zorder=1e5,
            bbox={"fc": "white", "ec": "none", "pad": 1.0, "alpha": 0.8})  # fmt: skip


def _bare(ax: Axes) -> None:
    """Take the label and the numbers off a parameter axis that a panel further down carries."""
    ax.set_xlabel("")
    ax.tick_params(axis="x", labelbottom=False)
