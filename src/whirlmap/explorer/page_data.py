"""All that the page is told at first, as one JSON object."""

from collections.abc import Mapping, Sequence
from typing import Any

from whirlmap.analysis.motion.record_length import turns_per_T
from whirlmap.explorer.branch_lines import lines
from whirlmap.explorer.control import Control, symbol_text
from whirlmap.explorer.exploration import Exploration
from whirlmap.explorer.overview import overview
from whirlmap.explorer.switch import Switch
from whirlmap.integrate.system import System
from whirlmap.results.regime import Regime


def page_data(exploration: Exploration) -> dict[str, Any]:
    """All that the page is told at first: one JSON object, described at the top of ``page/explorer.js``."""
    system, model = exploration.system, exploration.system.model
    journals = {tuple(str(q.name) for q in j.u): 1.0 for j in model.journals.values()}
    bodies = {body: [q.name for q in found] for body, found in model.bodies.items() if len(found) == 2}
    swing = [s.name for s in model.swing] or [system.states[0]]
    return {
        "title": exploration.title or system.case,
        "case": system.case,
        "kind": ("point", "diagram", "map")[len(exploration.axes)],
        "forced": model.forced,
        "controls": [
            *(_control(c, c.name in exploration.axes) for c in exploration.controls.values()),
            *(_switch(s) for s in exploration.switches.values()),
        ],
        "overview": overview(system, exploration.axes, exploration.overview),
        "states": [_quantity(system, s.name, s.meaning) for s in model.states],
        "outputs": [_quantity(system, name, o.meaning) for name, o in model.outputs.items()],
        "swing": swing,
        "planes": planes(system, bodies, journals, swing),
        "velocities": model.velocities,
        "clocks": {name: abs(turns) for name, turns in turns_per_T(system).items() if turns},
        "films": films(system),
        "regimes": [{"code": int(r), "name": r.name, "label": r.label} for r in Regime],
        "branches": [lines(exploration, ds) for ds in exploration.branches],
    }  # fmt: skip


def _control(c: Control, axis: bool) -> dict[str, Any]:
    return {
        "name": c.name, "symbol": c.symbol, "meaning": c.meaning, "value": c.value, "low": c.low, "high": c.high,
        "log": c.log, "unit": c.shown_unit, "size": c.shown_size, "axis": axis,
    }  # fmt: skip


def _switch(s: Switch) -> dict[str, Any]:
    return {
        "name": s.name, "symbol": s.name, "meaning": s.meaning, "value": s.value, "choices": list(s.choices), "axis": False,
    }  # fmt: skip


def _quantity(system: System, name: str, meaning: str) -> dict[str, str]:
    return {"name": name, "symbol": symbol_text(system, name), "meaning": meaning}


def planes(
    system: System, bodies: Mapping[str, Sequence[str]], journals: Mapping[tuple[str, ...], float], swing: Sequence[str]
) -> list[dict[str, Any]]:
    """Pairs of states that an orbit is drawn in: x and y of each body, else a displacement and its velocity."""
    found = []
    for body, (x, y) in bodies.items():
        found.append({"name": body, "x": x, "y": y, "equal": True, "clearance": (x, y) in journals})
    for name in swing if not found else ():
        velocity = system.model.velocities.get(name)
        other = velocity or next((s for s in system.states if s != name), name)
        found.append({"name": f"{name}, {other}", "x": name, "y": other, "equal": False, "clearance": False})
    return found


def films(system: System) -> list[dict[str, str]]:
    """Names of the outputs that are eccentricity and load of each bearing, empty where there is none."""
    eccentricity, load = (system.model.outputs_of(role) for role in ("eccentricity", "load"))
    return [{"bearing": name, "eccentricity": of, "load": load.get(name, "")} for name, of in eccentricity.items()]
