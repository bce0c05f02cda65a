"""Composed figures: diagrams with their regimes, the paper's Figures 2 to 7, and the sheet of a diagnosis."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from whirlmap.plot.common.diagnosis_parts import clock_name, journal_of, marked_shaft, parts_of
from whirlmap.plot.common.style import VERMILION, WIDE, new_figure, styled, text_size, write_reason
from whirlmap.plot.panels.branches import draw_branches
from whirlmap.plot.panels.convergence import draw_convergence
from whirlmap.plot.panels.diagram import draw_diagram
from whirlmap.plot.panels.dimension import draw_correlation_sum, draw_local_slope
from whirlmap.plot.panels.orbit import draw_orbit
from whirlmap.plot.panels.phase_portrait import draw_phase_portrait
from whirlmap.plot.panels.regime_strip import draw_exponents, draw_regime_strip, legend_handles
from whirlmap.plot.panels.section import draw_section
from whirlmap.plot.panels.spectrum import Orders, draw_power_spectrum
from whirlmap.plot.panels.time_series import draw_time_series

Reasons = Mapping[str, str]
Draw = Callable[[xr.Dataset, Axes], Axes]

#: What stands in a panel for which nothing was given, and no reason either.
ABSENT = "not computed"

#: What the parts are called in a panel that has to say why it is empty.
WORDS = {
    "series": "time series",
    "spectrum": "power spectrum",
    "section": "section",
    "lyapunov": "Lyapunov exponents",
    "dimension": "correlation dimension",
}

#: Periods T of a time series that a sheet shows.
SHOWN = 40


@styled
def diagram_figure(
    ds: xr.Dataset,
    states: Sequence[str] | None = None,
    *,
    columns: int = 1,
    exponents: bool | None = None,
    names: Mapping[str, str] | None = None,
    title: str = "",
    log: bool | None = None,
    branches: xr.Dataset | None = None,
) -> Figure:
    """Bifurcation diagrams of several states over one regime strip per column.

    Parameters
    ----------
    ds : xr.Dataset
        From `bifurcation_diagram`; what is read of it, `draw_diagram` says.
    states : sequence of str, optional
        One panel for each, from the upper left along the rows; where absent, all states whose section the Dataset holds.
    columns : int
        Of panels; each has a strip of its own.
    exponents : bool, optional
        Whether a panel of largest exponents stands at the bottom; where absent, if any was measured.
    names : mapping of state to str, optional
        Titles of the panels: ``{"yp": "pinion"}``.
    title : str
        Over the whole figure; nothing where empty.
    log : bool, optional
        Logarithmic parameter axis; where absent, if the values are spaced by a constant factor.
    branches : xr.Dataset, optional
        Of `continue_orbit` over the same parameter, drawn over the points: solid where stable, dashed where not.

    Returns
    -------
    Figure
        Not known to pyplot; `save` writes it.

    Raises
    ------
    RangeError
        A state whose section the Dataset does not hold; no or several varied parameters.
    """
    states = [str(s) for s in np.atleast_1d(ds["state"].values)] if states is None else states
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
            if branches is not None:
                draw_branches(branches, state, measure="section", ax=ax, colour=VERMILION, legend=row == column == 0)
                _show_all(ax, branches["section"].sel(state=state).values)
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


def _show_all(ax: Axes, values: NDArray[np.float64]) -> None:
    """Let an axis reach as far as these values, with the margin that it has."""
    low, high = ax.get_ylim()
    margin = 0.03 * (np.nanmax(values) - np.nanmin(values))
    ax.set_ylim(min(low, np.nanmin(values) - margin), max(high, np.nanmax(values) + margin))


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

    Parameters
    ----------
    ds : xr.Dataset
        Of `whirlmap.bifurcation_diagram`, with the sections of these states.
    states : sequence of str
        One panel for each; those of the paper where absent.
    names : mapping of state to str, optional
        Titles of the panels: ``{"yp": "pinion"}``; those of the paper where absent.
    exponents : bool, optional
        Whether a panel of largest exponents stands at the bottom; None: if any was measured.
    title : str
        Over the whole figure; nothing where empty.

    Returns
    -------
    Figure
        Not known to pyplot; `save` writes it.

    Raises
    ------
    RangeError
        As `diagram_figure`.
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
    coordinate : str
        State along the horizontal axes of phase portrait and section.
    series, spectrum, lines, section, lyapunov, dimension : xr.Dataset, optional
        From `simulate`, `power_spectrum`, `spectral_lines`, `section`, `lyapunov_spectrum`,
        `correlation_dimension`. A panel whose Dataset is absent says why.
    velocity : str, optional
        The other state of phase portrait and section; the coordinate's velocity where absent.
    orders : mapping of str to number, optional
        Named orders of the spectrum, in multiples of 1/T.
    clock : str
        What 1/T is called.
    turns : float, optional
        Show the last so many T of the phase portrait; all where absent.
    highest : float, optional
        Highest frequency of the spectrum, in multiples of 1/T; all where None.
    reasons : mapping of str to str, optional
        Why a part is absent, by the names above: ``{"dimension": "periodic: a finite set of points"}``.
    title : str
        Over the whole figure; nothing where empty.

    Returns
    -------
    Figure
        Not known to pyplot; `save` writes it.

    Raises
    ------
    RangeError
        A state that a part does not hold.
    """
    panels: list[tuple[str, xr.Dataset | None, Draw]] = [
        ("series", series, lambda ds, ax: draw_phase_portrait(ds, coordinate, velocity, ax=ax, turns=turns)),
        ("spectrum", spectrum, lambda ds, ax: draw_power_spectrum(
            ds, ax=ax, lines=lines, orders=orders, highest=highest, clock=clock, name=coordinate)),
        ("section", section, lambda ds, ax: draw_section(ds, coordinate, velocity, ax=ax, orbit=series)),
        ("lyapunov", lyapunov, lambda ds, ax: draw_convergence(ds, ax=ax)),
        ("dimension", dimension, lambda ds, ax: draw_correlation_sum(ds, ax=ax)),
        ("dimension", dimension, lambda ds, ax: draw_local_slope(ds, ax=ax)),
    ]  # fmt: skip
    return _sheet(panels, (3, 2), (WIDE, 7.6), reasons or {}, title)


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
    **given: Any,
) -> Figure:
    """Six panels on one operating point, what a rotordynamicist looks at first.

    Orbit of a journal in its clearance circle (or, for a system without one, the time series), phase
    portrait, section, power spectrum with named orders, convergence of the exponents, correlation sum with
    the fitted range. What the Dataset lacks is said in the panel.

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
        Turns in one T and name of the shaft whose turns are marked; the fastest slower than 1/T where absent.
    orders : mapping of str to number
        Named orders; the Dataset's clocks where absent.
    clock : str
        What 1/T is called; the clock that turns once in T where absent.
    turns : float, optional
        Show the last so many T of orbit, portrait and series; all where absent.
    highest : float, optional
        Highest frequency of the spectrum, in multiples of 1/T; all where None.
    title : str
        Over the whole figure; nothing where empty.
    **given : xr.Dataset
        ``spectrum``, ``lines``, ``section``, ``lyapunov``, ``dimension``: parts that ``ds`` does not hold.

    Returns
    -------
    Figure
        Not known to pyplot; `save` writes it.

    Raises
    ------
    RangeError
        A state that the Dataset does not hold.
    """
    parts = replace(parts_of(ds, coordinate), **given)
    named: Orders = parts.orders if orders is None else orders
    clock = clock or clock_name(named)
    if order is None:
        shaft, order = marked_shaft(named) if not shaft else (shaft, named.get(shaft, 1))
    turned = abs(float(order))
    path = journal_of(ds) if orbit is None else orbit

    sizes: Orders = {name: abs(float(value)) for name, value in named.items()}

    def first(ds: xr.Dataset, ax: Axes) -> Axes:
        if path is None:
            return draw_time_series(ds, coordinate, ax=ax, turns=turns or SHOWN)
        return draw_orbit(ds, *path, ax=ax, clearance=clearance, order=turned, shaft=shaft, turns=turns)

    def portrait(ds: xr.Dataset, ax: Axes) -> Axes:
        return draw_phase_portrait(ds, coordinate, velocity, ax=ax, turns=turns, section=bool(named))

    panels: list[tuple[str, xr.Dataset | None, Draw]] = [
        ("series", parts.series, first),
        ("series", parts.series, portrait),
        ("section", parts.section, lambda ds, ax: draw_section(
            ds, coordinate, velocity, ax=ax, orbit=parts.series)),
        ("spectrum", parts.spectrum, lambda ds, ax: draw_power_spectrum(
            ds, ax=ax, lines=parts.lines, orders=sizes, highest=highest, clock=clock, name=coordinate)),
        ("lyapunov", parts.lyapunov, lambda ds, ax: draw_convergence(ds, ax=ax, count=2)),
        ("dimension", parts.dimension, lambda ds, ax: draw_correlation_sum(ds, ax=ax)),
    ]  # fmt: skip
    return _sheet(panels, (2, 3), (1.35 * WIDE, 6.2), parts.reasons, title)


def _sheet(
    panels: list[tuple[str, xr.Dataset | None, Draw]],
    shape: tuple[int, int],
    size: tuple[float, float],
    reasons: Reasons,
    title: str,
) -> Figure:
    """Draw each part into its panel, or write there why it is absent."""
    fig = new_figure(*size)
    for ax, (part, ds, draw), letter in zip(fig.subplots(*shape).ravel(), panels, "abcdef", strict=True):
        if ds is None:
            write_reason(ax, f"{WORDS[part]}:\n{reasons.get(part, ABSENT)}")
        else:
            draw(ds, ax)
        # In the corner, as titles stand above: what a caption refers to.
        ax.text(0.985, 0.975, letter, transform=ax.transAxes, ha="right", va="top", weight="bold", size=text_size(9),
                zorder=1e5, bbox={"fc": "white", "ec": "none", "pad": 1.0, "alpha": 0.8})  # fmt: skip
    if title:
        fig.suptitle(title)
    return fig


def _bare(ax: Axes) -> None:
    """Take the label and the numbers off a parameter axis that a panel further down carries."""
    ax.set_xlabel("")
    ax.tick_params(axis="x", labelbottom=False)
