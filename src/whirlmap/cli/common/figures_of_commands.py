"""The figure of each command, composed of panels of `whirlmap.plot`; nothing is drawn here."""

from collections.abc import Sequence
from math import isfinite, pi
from pathlib import Path

import xarray as xr
from matplotlib.figure import Figure

from whirlmap.analysis.motion.record_length import turns_per_T
from whirlmap.cli.common.outputs import Looks
from whirlmap.cli.common.speed_report import sizes_of
from whirlmap.cli.common.states_shown import partner_of, swing_of
from whirlmap.integrate.dimensions import Dimensions
from whirlmap.integrate.in_units import shown_in
from whirlmap.integrate.system import System
from whirlmap.plot.common.diagnosis_parts import journal_of, marked_shaft
from whirlmap.plot.common.style import WIDE, new_figure, styled
from whirlmap.plot.figures.animation import animate_orbit
from whirlmap.plot.figures.basins import attractors_figure, basins_figure
from whirlmap.plot.figures.branches import branches_figure, event_curves_figure
from whirlmap.plot.figures.campbell import campbell_figure
from whirlmap.plot.figures.diagnosis_figure import diagnosis_figure, diagram_figure
from whirlmap.plot.figures.improve import improve_figure
from whirlmap.plot.figures.regime_map import regime_line_figure, regime_map_figure
from whirlmap.plot.figures.response import response_figure
from whirlmap.plot.figures.run_up import run_up_figure
from whirlmap.plot.figures.signal_figure import series_figure
from whirlmap.plot.figures.speeds import speeds_figure
from whirlmap.plot.panels.phase_portrait import draw_phase_portrait
from whirlmap.plot.panels.time_series import draw_time_series

#: Periods T of a time series that its picture shows, the last ones.
SHOWN = 40


@styled
def simulation(system: System, ds: xr.Dataset) -> Figure:
    """Time series of the states that swing, and the phase portrait of the first."""
    states, in_T = swing_of(system), ds["time"].attrs["units"] == "time"  # seconds, where the case says what they are
    fig = new_figure(WIDE, 1.2 + 1.1 * max(len(states), 2))
    grid = fig.add_gridspec(len(states), 2, width_ratios=[3, 2])
    for row, state in enumerate(states):
        draw_time_series(ds, state, ax=fig.add_subplot(grid[row, 0]), turns=SHOWN, in_T=in_T)
    draw_phase_portrait(ds, states[0], partner_of(system, states[0]), ax=fig.add_subplot(grid[:, 1]), turns=10 * SHOWN)
    fig.suptitle(system.case)
    return fig


def run_up(system: System, ds: xr.Dataset, diagram: xr.Dataset | None) -> Figure:
    """Draw a run-up of the state that swings first, over a labelled diagram where there is one."""
    return run_up_figure(ds, swing_of(system)[0], diagram=diagram, title=system.case)


def animation(
    units: Dimensions, ds: xr.Dataset, place: Path, *, looks: Looks, turns: float | None, force: bool
) -> Path:
    """Write the orbit of the first journal, or of the states that swing, as it moves.

    Where ``turns`` is absent, the last 4 T, or two turns of the shaft that is marked in other pictures where that is more.
    """
    system = units.system
    first = swing_of(system)[0]
    journal = journal_of(ds)
    _, order = marked_shaft(turns_per_T(system))
    return animate_orbit(
        ds, place, *(journal or (first, partner_of(system, first))), clearance=units.of("length").size if journal else None,
        marks=system.model.forced, turns=max(4.0, 2 / abs(float(order))) if turns is None else turns,
        size=looks.size, dpi=looks.dpi, title=operating_point(system) if looks.title is None else looks.title,
        force=force,
    )  # fmt: skip


#: Parameters of a model without dimensions all of which stand in a title.
FEW = 6


def operating_point(system: System) -> str:
    """The case with the values that say which motion it is: all of a small model, else the speed and what the user set."""
    settled, names = system.machine, system.parameters
    every = len(names) <= FEW and not (settled and settled.inputs)
    shown = {name: f"{float(system.values[name]):.4g}" for name in names if every or _by_user(system.notes.get(name, ""))}
    if settled:
        shown |= {name: one.written for name, one in settled.inputs.items() if _by_user(one.note)}
        speeds = list(settled.results("shaft_speed").values())
        if speeds and settled.speed_input not in shown:
            shown["speed"] = f"{abs(speeds[0]) * 30 / pi:.4g} rpm"
    return f"{system.case}: {', '.join(f'{name} = {value}' for name, value in shown.items())}" if shown else system.case


def _by_user(note: str) -> bool:
    return note == "set by the user"


def diagnosis(units: Dimensions, ds: xr.Dataset) -> Figure:
    """Draw the sheet of a diagnosis in these units."""
    system = units.system
    state = swing_of(system)[0]
    return diagnosis_figure(
        shown_in(units, ds), state, velocity=partner_of(system, state), clearance=units.of("length").size, title=system.case
    )


def series(ds: xr.Dataset, name: str) -> Figure:
    """Draw the sheet of a recorded signal."""
    return series_figure(ds, title=name)


def diagram(units: Dimensions, ds: xr.Dataset, states: Sequence[str], branches: xr.Dataset | None = None) -> Figure:
    """Bifurcation diagrams of some states over their regimes, in these units, and branches over them."""
    return diagram_figure(
        shown_in(units, ds), list(states), columns=2 if len(states) > 3 else 1, title=units.system.case,
        branches=None if branches is None else shown_in(units, branches),
    )  # fmt: skip


def regime_map(units: Dimensions, ds: xr.Dataset, quantity: str, curves: Sequence[xr.Dataset] = ()) -> Figure:
    """Draw a map of regimes in these units; a line of points as its amplitude over its regimes."""
    if len(ds["regime"].dims) == 1:
        return regime_line_figure(shown_in(units, ds), quantity, title=units.system.case)
    small = ds.drop_vars("section", errors="ignore")  # which may be larger than the memory
    shown = [shown_in(units, each) for each in curves]
    return regime_map_figure(shown_in(units, small), quantity, title=units.system.case, curves=shown)


def response(system: System, ds: xr.Dataset) -> Figure:
    """Bode plots of the response to unbalance."""
    return response_figure(ds, title=system.case)


def campbell(system: System, ds: xr.Dataset) -> Figure:
    """Draw frequencies, order lines and damping against speed."""
    return campbell_figure(ds, title=system.case)


def branches(units: Dimensions, ds: xr.Dataset, quantities: Sequence[str]) -> Figure:
    """Branches of some states or outputs in these units, or curves of events in the plane of their parameters."""
    if "event" in ds.attrs:
        return event_curves_figure(shown_in(units, ds), title=units.system.case)
    return branches_figure(shown_in(units, ds), quantities, title=units.system.case)


def attractors(units: Dimensions, ds: xr.Dataset) -> Figure:
    """Draw the start states of a search by their attractor, in these units."""
    system = units.system
    state = swing_of(system)[0]
    return attractors_figure(shown_in(units, ds), state, partner_of(system, state), title=system.case)


def basins(units: Dimensions, ds: xr.Dataset) -> Figure:
    """Draw a slice of basins in these units."""
    return basins_figure(shown_in(units, ds), title=units.system.case)


def speeds(units: Dimensions, ds: xr.Dataset) -> Figure:
    """Draw windows of safe speeds."""
    rpm, um, newton = sizes_of(units)
    shown = ds if isfinite(rpm) else ds.drop_vars("rpm", errors="ignore")
    return speeds_figure(
        shown, unit=um if isfinite(um) else 1.0, length="um" if isfinite(um) else "1",
        force=newton if isfinite(newton) else 1.0, force_unit="N" if isfinite(newton) else "1", title=units.system.case,
    )  # fmt: skip


def improve(units: Dimensions, ds: xr.Dataset) -> Figure:
    """Draw what other designs gain."""
    rpm, um, _ = sizes_of(units)
    shown = ds if isfinite(rpm) else ds.drop_vars("rpm", errors="ignore")
    known = isfinite(um)
    return improve_figure(shown, unit=um if known else 1.0, length="um" if known else "1", title=units.system.case)
