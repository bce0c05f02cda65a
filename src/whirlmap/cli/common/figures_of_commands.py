"""The figure of each command, composed of panels of `whirlmap.plot`; nothing is drawn here."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    import xarray as xr
    from matplotlib.figure import Figure

    from whirlmap.cli.common.outputs import Looks
    from whirlmap.integrate.dimensions import Dimensions
    from whirlmap.integrate.system import System

#: Periods T of a time series that its picture shows, the last ones.
SHOWN = 40


def swing_of(system: "System") -> list[str]:
    """States that a picture of this system shows first."""
    return [s.name for s in system.model.swing] or [system.states[0]]


def partner_of(system: "System", state: str) -> str:
    """State against which another is drawn: the one that its rate equals, else the next one."""
    names = system.states
    return system.model.velocities.get(state, names[(names.index(state) + 1) % len(names)])


def simulation(system: "System", ds: "xr.Dataset") -> "Figure":
    """Time series of the states that swing, and the phase portrait of the first."""
    from whirlmap.plot.common.style import styled

    return styled(_simulation)(system, ds)


def _simulation(system: "System", ds: "xr.Dataset") -> "Figure":
    from whirlmap.plot.common.style import WIDE, new_figure
    from whirlmap.plot.panels.phase_portrait import draw_phase_portrait
    from whirlmap.plot.panels.time_series import draw_time_series

    states, in_T = swing_of(system), ds["time"].attrs["units"] == "time"  # seconds, where the case says what they are
    fig = new_figure(WIDE, 1.2 + 1.1 * max(len(states), 2))
    grid = fig.add_gridspec(len(states), 2, width_ratios=[3, 2])
    for row, state in enumerate(states):
        draw_time_series(ds, state, ax=fig.add_subplot(grid[row, 0]), turns=SHOWN, in_T=in_T)
    draw_phase_portrait(ds, states[0], partner_of(system, states[0]), ax=fig.add_subplot(grid[:, 1]), turns=10 * SHOWN)
    fig.suptitle(system.case)
    return fig


def animation(
    units: "Dimensions", ds: "xr.Dataset", place: "Path", *, looks: "Looks", turns: float | None, force: bool
) -> "Path":
    """Write the orbit of the first journal, or of the states that swing, as it moves.

    Where ``turns`` is absent, the last 4 T, or two turns of the shaft that is marked in other pictures where that is more.
    """
    from whirlmap.analysis.motion.record_length import turns_per_T
    from whirlmap.plot.common.diagnosis_parts import journal_of, marked_shaft
    from whirlmap.plot.figures.animation import animate_orbit

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


def operating_point(system: "System") -> str:
    """The case with the values that say which motion it is: all of a small model, else the speed and what the user set."""
    from math import pi

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


def diagnosis(units: "Dimensions", ds: "xr.Dataset") -> "Figure":
    """Draw the sheet of a diagnosis in these units."""
    from whirlmap.integrate.in_units import shown_in
    from whirlmap.plot.figures.diagnosis_figure import diagnosis_figure

    system = units.system
    state = swing_of(system)[0]
    return diagnosis_figure(
        shown_in(units, ds), state, velocity=partner_of(system, state), clearance=units.of("length").size, title=system.case
    )


def series(ds: "xr.Dataset", name: str) -> "Figure":
    """Draw the sheet of a recorded signal."""
    from whirlmap.plot.figures.signal_figure import series_figure

    return series_figure(ds, title=name)


def diagram(units: "Dimensions", ds: "xr.Dataset", states: Sequence[str]) -> "Figure":
    """Bifurcation diagrams of some states over their regimes, in these units."""
    from whirlmap.integrate.in_units import shown_in
    from whirlmap.plot.figures.diagnosis_figure import diagram_figure

    return diagram_figure(shown_in(units, ds), list(states), columns=2 if len(states) > 3 else 1, title=units.system.case)


def regime_map(units: "Dimensions", ds: "xr.Dataset", quantity: str) -> "Figure":
    """Draw a map of regimes in these units; a line of points as its amplitude over its regimes."""
    from whirlmap.integrate.in_units import shown_in
    from whirlmap.plot.figures.regime_map import regime_line_figure, regime_map_figure

    if len(ds["regime"].dims) == 1:
        return regime_line_figure(shown_in(units, ds), quantity, title=units.system.case)
    small = ds.drop_vars("section", errors="ignore")  # which may be larger than the memory
    return regime_map_figure(shown_in(units, small), quantity, title=units.system.case)


def campbell(system: "System", ds: "xr.Dataset") -> "Figure":
    """Draw frequencies, order lines and damping against speed."""
    from whirlmap.plot.figures.campbell import campbell_figure

    return campbell_figure(ds, title=system.case)


def attractors(units: "Dimensions", ds: "xr.Dataset") -> "Figure":
    """Draw the start states of a search by their attractor, in these units."""
    from whirlmap.integrate.in_units import shown_in
    from whirlmap.plot.figures.basins import attractors_figure

    system = units.system
    state = swing_of(system)[0]
    return attractors_figure(shown_in(units, ds), state, partner_of(system, state), title=system.case)


def basins(units: "Dimensions", ds: "xr.Dataset") -> "Figure":
    """Draw a slice of basins in these units."""
    from whirlmap.integrate.in_units import shown_in
    from whirlmap.plot.figures.basins import basins_figure

    return basins_figure(shown_in(units, ds), title=units.system.case)
