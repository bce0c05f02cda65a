"""What `show` says of a machine from parts: shafts, bearings at rest, meshes, kept modes and what their truncation costs."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import typer

from whirlmap.analysis.linear.truncation import FAST, truncation
from whirlmap.cli.common import report
from whirlmap.errors import RangeError
from whirlmap.integrate.dimensions import Dimensions
from whirlmap.machines.assembly import Machine
from whirlmap.machines.parts.part import Coupled
from whirlmap.machines.parts.teeth import Teeth
from whirlmap.machines.reduction import mode_names
from whirlmap.units import convert

if TYPE_CHECKING:
    from whirlmap.integrate.system import System


#: Difference of the tooth force at rest from the transmitted load, over the latter, from which `show` warns.
CARRIED = 0.05
#: Diameter of a journal over that of its shaft there, or its inverse, from which `show` warns: a radius that is a diameter
#: makes it 2.
WIDER = 1.5


def describe_parts(system: "System", machine: Machine, rest: dict[str, float] | None) -> dict[str, Any]:
    """Parts of a machine as plain data in SI; ``rest`` is its static equilibrium, None where there is none."""
    settled = system.machine
    assert settled is not None
    c_0 = float(Dimensions(system).worth("length"))
    given, values = settled.given, {name: float(value) for name, value in system.values.items()}
    numbers = {p: values[p.name] for p in system.model.parameters}
    if rest is not None:
        numbers |= {state: rest[state.name] for state in system.model.states}
    force, results = settled.quantities["force_unit"][0], settled.quantities

    def output(name: str, size: float = 1.0) -> float | None:
        return None if rest is None else size * float(system.model.outputs[name].expression.subs(numbers))

    shafts, places = [], dict[tuple[str, int], float]()
    for rotor in machine.rotors:
        shaft, modes = rotor.shaft, rotor.shaft.reduced
        places |= {(shaft.name, i): float(z) for i, z in enumerate(shaft.positions)}
        unit = 1.0 if not shaft.lumped else float(np.sqrt(given[f"shaft.{shaft.name}.K"] / given[f"shaft.{shaft.name}.m"]))
        shafts.append({
            "name": shaft.name, "speed": results[f"speed_{shaft.name}"][0], "mass": given[f"shaft.{shaft.name}.m"],
            "centre": shaft.centre, "stiffness": given[f"shaft.{shaft.name}.K"], "lumped": shaft.lumped,
            "elements": [
                {"z": float(z), "L": e.L, "d": e.d, "d_i": e.d_i}
                for z, e in zip(shaft.positions, shaft.elements, strict=False)
            ],
            "disks": [{"name": d.name, "z": places[shaft.name, d.station], "m": d.m, "I_p": d.I_p} for d in shaft.disks],
            "modes": [
                {"name": name, "frequency": unit * float(w)}
                for name, w in zip(mode_names(modes), modes.frequency, strict=True)
            ],
            "twisting": 0 if rotor.base is None else shaft.twisting.count,
        })  # fmt: skip
    bearings = list[dict[str, Any]]()
    for b in machine.bearings:
        ux, uy = (numbers.get(q) for q in b.u)
        at_rest, spring = output(f"load_{b.name}", force), None
        if "k_c" in b.given and ux is not None and uy is not None:
            spring = given[f"bearing.{b.name}.k_c"] * c_0 * float(np.hypot(ux, uy))
            # A film that does not turn carries nothing at rest; what is left there is rounding.
            at_rest = 0.0 if b.kind == "damper" else at_rest
        bearings.append({
            "name": b.name, "shaft": b.shaft, "z": places[b.shaft, b.station], "kind": b.kind, "film": b.film, "arc": b.arc,
            "support": b.support, "alike": b.alike, **{key: given[f"bearing.{b.name}.{key}"] for key in ("R", "L", "c")},
            "load": at_rest, "spring_load": spring, "eccentricity": output(f"eps_{b.name}"),
            "shaft_diameter": _diameter(machine, b.shaft, b.station),
            "direction": None if ux is None or uy is None else float(np.degrees(np.arctan2(uy, ux))),
        })  # fmt: skip
    for by_table in machine.coefficients:
        bearings.append({
            "name": by_table.name, "shaft": by_table.shaft, "z": places[by_table.shaft, by_table.station],
            "kind": "coefficients", "support": by_table.support, "alike": by_table.alike,
            "load": output(f"load_{by_table.name}", force), "shaft_diameter": None,
            "speeds": [min(by_table.speeds), max(by_table.speeds)] if by_table.speeds else None,
        })  # fmt: skip
    meshes = [
        {
            "name": m.name, "driver": m.driver.shaft, "driven": m.driven.shaft,
            "frequency": results[f"frequency_{m.name}"][0],
            "z": [places[w.shaft, w.station] for w in (m.driver, m.driven)],
            "teeth": [int(given[f"mesh.{m.name}.{key}"]) for key in ("z_driver", "z_driven")],
            "module": given.get(f"mesh.{m.name}.module"), "kind": m.kind, "theta": values.get(m.theta.name, 0.0),
            **transmitted(system, m),
            "load": None if m.kind != "line" else force * values[f"F_0_{m.name}"],
            "rest": None if m.kind != "line" or rest is None else force * _tooth_force(machine, m, numbers),
        }
        for m in machine.meshes
    ]  # fmt: skip
    return {
        "reference": machine.reference, "shafts": shafts, "bearings": bearings, "meshes": meshes,
        "supports": [
            {"name": s.name, "bearings": list(s.bearings), "mass": given[f"support.{s.name}.m"]} for s in machine.supports
        ],
        "unbalances": [{"name": u.name, "shaft": u.shaft, "z": places[u.shaft, u.station]} for u in machine.unbalances],
        "couplings": [{"name": c.name, "shaft": c.shaft, "z": places[c.shaft, c.station]} for c in machine.couplings],
        "rubs": [
            {"name": c.name, "shaft": c.shaft, "z": places[c.shaft, c.station], "gap": output(f"gap_{c.name}", c_0)}
            for c in machine.rubs
        ],
        "truncation": _truncation(system),
        "left_out": _left_out(system),
    }  # fmt: skip


def _left_out(system: "System") -> list[str]:
    """Dotted names of numbers that the case does not give and that count as zero."""
    parts = system.machine.case.parts if system.machine else None
    return [".".join(one) for one in parts.left_out] if parts else []


def transmitted(system: "System", mesh: Teeth) -> dict[str, float | None]:
    """Torque of the driver [N m], and the power [W] and speed of the reference shaft [rad/s] from which it follows."""
    settled = system.machine
    assert settled is not None
    own = {key: one.name for key, one in mesh.inputs().items()}
    found: dict[str, float | None] = {"torque": settled.given.get(own["T"]), "power": None, "speed_of_power": None}
    if how := settled.followed.get(own["T"]):
        power, at, *_ = how.reads
        found |= {"power": settled.given[power], "speed_of_power": float(how.held.get(at, settled.given[at]))}
    return found


def _diameter(machine: Machine, name: str, station: int) -> float | None:
    """Diameter of the thicker element at a station [m]; None of a shaft without any, or one given by its matrices."""
    shaft = next(rotor.shaft for rotor in machine.rotors if rotor.name == name)
    beside = shaft.elements[max(station - 1, 0) : station + 1]
    return max(e.d for e in beside) if beside and shaft.given is None else None


def _tooth_force(machine: Machine, mesh: Teeth, numbers: Mapping[Any, float]) -> float:
    """Force of the teeth at rest with their mean stiffness, over K_0 c_0."""
    coupled = Coupled()
    for rotor in machine.rotors:
        rotor.couple(coupled)
    delta = mesh.deflection(coupled)[0].subs({**numbers, mesh.E: 0.0})
    return max(float(delta), 0.0) * numbers[mesh.Lambda]


def _truncation(system: "System") -> dict[str, Any]:
    try:
        found = truncation(system)
    except RangeError as error:
        return {"why_not": str(error)}
    assert found is not None
    worst = int(np.argmax(found.error / found.allowed)) if found.error.size else None
    return {
        "why_not": "", "holds": found.holds, "modes": int(found.error.size), "fastest": found.fastest,
        "largest_error": 0.0 if worst is None else float(found.error[worst]),
        "frequency": None if worst is None else float(abs(found.eigenvalues[worst])),
        "allowed": None if worst is None else float(found.allowed[worst]),
    }  # fmt: skip


def warnings_of(parts: dict[str, Any]) -> list[str]:
    """What strains the reduction."""
    found, made = parts["truncation"], list[str]()
    for m in parts["meshes"]:
        if m["rest"] is not None and abs(m["rest"] - m["load"]) > CARRIED * m["load"]:
            made.append(
                f"tooth_load: mesh {m['name']} carries {m['rest']:.4g} N at rest, not the transmitted {m['load']:.4g} N,"
                ' for its shafts turn uniformly and their centres part; torsion = "free" with couplings lets them turn'
            )
    for b in parts["bearings"]:
        journal, shaft = 2 * b.get("R", 0.0), b["shaft_diameter"]
        if b["kind"] == "journal" and shaft and not 1 / WIDER <= journal / shaft <= WIDER:
            made.append(
                f"journal_diameter: bearing {b['name']} has R = {b['R'] * 1e3:.4g} mm, which is a journal of"
                f" {journal * 1e3:.4g} mm, and its shaft there is {shaft * 1e3:.4g} mm thick; R is half of the diameter"
            )
    if found["why_not"]:
        return [*made, f"truncation: what the omitted modes cost was not computed: {found['why_not']}"]
    if not found["holds"]:
        at, error, allowed = found["frequency"], found["largest_error"], found["allowed"]
        made.append(
            f"truncation: the mode at {at:.3g} times the clock's speed is off by {error:.2%}, above {allowed:.0%};"
            f" keep more elastic modes, {_modes_options(parts['shafts'])}"
        )
    if found["fastest"] > FAST:
        fewer = [s for s in parts["shafts"] if _elastic(s)]
        slower = f"; fewer elastic modes make it slower, {_modes_options(fewer)}" if fewer else ""
        made.append(
            f"truncation: the fastest motion (of a journal, or the highest kept mode) is {found['fastest']:.3g} times as"
            " fast as the fastest shaft turns, and steps follow it" + slower
        )
    return made


def _elastic(shaft: dict[str, Any]) -> int:
    """Number of elastic modes of a plane that its key ``modes`` says."""
    return sum(mode["name"].startswith("bending") for mode in shaft["modes"])


def _modes_options(shafts: list[dict[str, Any]]) -> str:
    """How to keep another number of modes of these shafts, and how many are kept now."""
    return ", ".join(f"--set shaft.{s['name']}.modes=N (now {_elastic(s)})" for s in shafts if not s["lumped"])


def _said(left_out: list[str]) -> str:
    """What was left out, by keys and parts: ``I_d, I_p of disk fan; C_m of mesh teeth``."""
    of_part = dict[tuple[str, str], list[str]]()
    for dotted in left_out:
        kind, name, key = dotted.split(".")
        of_part.setdefault((kind, name), []).append(key)
    alike = dict[tuple[str, str], list[str]]()
    for (kind, name), keys in of_part.items():
        alike.setdefault((", ".join(keys), kind), []).append(name)
    return "; ".join(f"{keys} of {kind} {', '.join(names)}" for (keys, kind), names in alike.items())


def print_parts(parts: dict[str, Any]) -> None:
    """Tables of shafts, bearings and meshes."""
    rows: list[tuple[str, ...]] = [
        (s["name"], _rpm(s["speed"]), _number(s["mass"], "kg"), _number(s["stiffness"] / 1e6, "N/um"), _modes(s))
        for s in parts["shafts"]
    ]
    columns = ("shaft", "speed", "mass", "m omega^2 on rigid bearings", "kept modes of a plane, Hz, free and at standstill")
    tables = [report.table("Shafts", columns, rows, numbers=(1, 2, 3))]
    springs = any(b.get("spring_load") is not None for b in parts["bearings"])
    of_bearing = ("bearing", "shaft", "film", "on", "clearance", "load at rest", "eccentricity", "direction")
    held = ("in its spring",) if springs else ()
    rows = [_bearing(b, springs) for b in parts["bearings"]]
    tables.append(report.table("Bearings", (*of_bearing, *held), rows, numbers=(4, 5, 6, 7, 8)))
    if parts["meshes"]:
        of_mesh = ("mesh", "teeth", "tooth passing", "power", "torque of the driver", "tooth load", "at rest", "phase")
        tables.append(report.table("Meshes", of_mesh, [_mesh(m) for m in parts["meshes"]], numbers=(2, 3, 4, 5, 6, 7)))
    report.show(*tables)
    if parts["left_out"]:
        typer.echo(f"left out, and zero: {_said(parts['left_out'])}")
    found = parts["truncation"]
    if not found["why_not"]:
        typer.echo(
            f"truncation: {found['modes']} modes below 2.5 times the highest shaft speed, against all matrices of the"
            f" shafts: largest error {found['largest_error']:.2g}; fastest rate {found['fastest']:.3g} times that speed"
        )


def _bearing(b: dict[str, Any], springs: bool) -> tuple[str, ...]:
    """A row of the table of bearings, with the load of its centring spring where ``springs``."""
    name = b["name"] + (f" (x{b['alike']})" if b["alike"] > 1 else "")
    held = () if not springs else ("",) if b.get("spring_load") is None else (_number(b["spring_load"], "N"),)
    if b["kind"] == "coefficients":
        law = f"table, {_rpm(b['speeds'][0])} to {_rpm(b['speeds'][1])}" if b["speeds"] else "coefficients"
        return (name, b["shaft"], law, b["support"] or "ground", "", _number(b["load"], "N"), "", "", *held)
    numbers = (_number(b["c"] * 1e6, "um"), _number(b["load"], "N"), _number(b["eccentricity"], ""))
    law, direction = f"{b['film']}, {b['arc']}", _number(b["direction"], "deg")
    return (name, b["shaft"], law, b["support"] or "ground", *numbers, direction, *held)


def _mesh(m: dict[str, Any]) -> tuple[str, ...]:
    teeth = f"{m['driver']} {m['teeth'][0]} : {m['teeth'][1]} {m['driven']}"
    passing, phase = m["frequency"] / (2 * np.pi), float(np.degrees(m["theta"])) % 360
    loads = (_number(m["load"], "N"), _number(m["rest"], "N"))
    power = "" if m["power"] is None else f"{m['power'] / 1e3:.4g} kW at {_rpm(m['speed_of_power'])}"
    torque = _number(m["torque"], "N*m")
    return (m["name"], teeth, _number(passing, "Hz"), power, torque, *loads, _number(phase, "deg"))


def _modes(shaft: dict[str, Any]) -> str:
    elastic = [f"{m['frequency'] / (2 * np.pi):.4g}" for m in shaft["modes"] if m["frequency"] > 0]
    rigid = len(shaft["modes"]) - len(elastic)
    twisting = f"; {shaft['twisting']} of rotation" if shaft["twisting"] else ""
    return f"{rigid} rigid{', ' + ', '.join(elastic) if elastic else ''}{twisting}"


def _rpm(speed: float) -> str:
    return f"{convert(speed, 'rad/s', 'rpm'):.5g} rpm"


def _number(value: float | None, unit: str) -> str:
    return "" if value is None else f"{value:.4g} {unit}".strip()
