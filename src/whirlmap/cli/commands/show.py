"""``whirlmap show``: all parameters, switches and assumptions of a case."""

import re
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer
from rich.columns import Columns
from sympy import sympify

from whirlmap.analysis.linear.linearisation import standing
from whirlmap.analysis.linear.stations import stations_of
from whirlmap.analysis.linear.truncation import machine_of
from whirlmap.assumptions.oil_heat import oil_heat, why_none
from whirlmap.assumptions.violation import Facts
from whirlmap.assumptions.violations import judged, repeated
from whirlmap.cli.common import report
from whirlmap.cli.common.machine_parts import describe_parts, print_parts, warnings_of
from whirlmap.cli.common.machine_picture import draw, refuse_picture
from whirlmap.cli.common.opening import open_system
from whirlmap.cli.common.outputs import Looks
from whirlmap.cli.common.series_texts import options_given
from whirlmap.errors import InputError
from whirlmap.integrate.dimensions import Dimensions
from whirlmap.integrate.equilibrium import start_states
from whirlmap.references import references
from whirlmap.results.listing import brackets
from whirlmap.units import convert

if TYPE_CHECKING:
    from whirlmap.cases import Resolved
    from whirlmap.integrate.system import System


#: Columns of a terminal in which inputs and groups stand side by side; below, one under the other.
SIDE_BY_SIDE = 220


def show(
    *, case: str | None, changes: list[str] | None, start: list[str] | None, equations: bool, series: Path | None,
    time: str | None, separator: str | None, decimal: str | None, skip: int, out: Path | None,
    size: str | None, dpi: int | None, title: str | None, force: bool, json: bool,
) -> None:  # fmt: skip
    """Do what `whirlmap.cli.declared.show` says."""
    if series is not None:
        for name, value in {
            "CASE": case, "--set": changes, "--start": start, "--equations": equations, "--out": out
        }.items():  # fmt: skip
            if value:
                raise InputError(f"{name}: found it beside --series, which shows a file without equations")
        from whirlmap.cli.commands.show_file import show_file

        show_file(series, time=time, separator=separator, decimal=decimal, skip=skip, json=json)
        return
    for name in options_given(time=time, separator=separator, decimal=decimal, skip=skip):
        raise InputError(f"{name}: found it without --series FILE, which it belongs to")
    if case is None:
        raise InputError("missing CASE: name of a stock case, or the path of a case file; or --series FILE\n"
                         "  try: whirlmap show --help")  # fmt: skip
    system = open_system(case, changes, start)
    looks = Looks.read(size, dpi, title, picture="" if out else "--out NAME.png, .svg or .pdf")
    if out is not None:
        refuse_picture(system, out, force=force)
    facts = describe(system, equations=equations)
    written = [draw(facts, out, looks, force=force)] if out is not None else []
    if json:
        report.print_json(facts | ({"written": written} if written else {}))
    else:
        _print(facts)
        report.print_written(written)


def describe(system: "System", *, equations: bool = False) -> dict[str, Any]:
    """All there is to say about a system, as plain data."""
    model, settled, units = system.model, system.machine, Dimensions(system)
    assert settled is not None  # a case was opened
    x, found = start_states(model, system.vector[:, None])
    begin = {s.name: system.start.get(s.name, float(v)) for s, v in zip(model.states, x[:, 0], strict=True)}
    used = {p.name for p in model.read()}
    facts: dict[str, Any] = {
        "case": system.case,
        "file": settled.case.path,
        "description": settled.case.description,
        "model": model.name,
        "changed": [name for name, mark in settled.marks.items() if mark.instead_of],
        "switches": _switches(settled.case.family, model),
        "inputs": {
            name: {
                "value": given.value, "unit": given.parameter.unit, "written": given.written,
                "meaning": given.parameter.meaning, "source": given.note, **_mark(settled, name),
            }
            for name, given in settled.inputs.items()
        },
        "parameters": {
            p.name: {
                "value": system.values[p.name], "exact": exact(system.values[p.name]), "unit": p.unit,
                "meaning": p.meaning, "source": system.notes.get(p.name, ""), "read": p.name in used,
                **_mark(settled, p.name),
            }
            for p in model.parameters
        },
        "quantities": {
            name: {"value": v, "unit": o.unit, "meaning": o.meaning, "rpm": _rpm(v, o.unit)}
            for name, (v, o) in settled.quantities.items()
        },
        "outputs": {name: {"unit": o.unit, "meaning": o.meaning} for name, o in model.outputs.items()},
        "stations": {name: list(pair) for name, pair in stations_of(model).items()},
        "stops": {name: stop.meaning for name, stop in model.stops.items()},
        "states": {
            s.name: {
                "start": begin[s.name], "unit": s.unit, "meaning": s.meaning, "cyclic": s.cyclic,
                "given": s.name in system.start, "dimensional": _sized(units, s.name, begin[s.name]),
            }
            for s in model.states
        },
        "start": "static equilibrium" if model.start == "equilibrium" else "the model's own",
        "start_found": bool(found[0]),
        "not_declared": model.not_declared(),
        "forced": model.forced,
        "period": system.period,
        "common_multiple": system.common_multiple if system.repeats else None,
        "common_period": system.common_period if system.repeats else None,
        "speed": system.speed,
        "clocks": _clocks(system),
        "period_s": system.period * units.of("time").size if units.known else None,
        "sources": {key: references()[key].text for key in model.sources if key in references()},
    }  # fmt: skip
    facts["oil_not_judged"] = _oil(system, facts)
    facts["warnings"] = warnings(system, facts)
    if machine := machine_of(system):
        rest = {s.name: float(v) for s, v in zip(model.states, x[:, 0], strict=True)} if found[0] else None
        facts["parts"] = describe_parts(system, machine, rest)
        facts["warnings"] += warnings_of(facts["parts"])
    if equations:
        facts["equations"] = {s.name: str(model.equations[s]) for s in model.states}
    return facts


def _mark(settled: "Resolved", name: str) -> dict[str, Any]:
    """What a number was before it was changed by hand, and which numbers its reason was written for."""
    mark = settled.marks.get(name)
    return {"instead_of": mark.instead_of or None, "written_for": dict(mark.written_for)} if mark else {}


def _switches(family: Any, model: Any) -> dict[str, Any]:
    return {
        name: {
            "value": model.switches.get(name, choices[0]), "choices": list(choices),
            "meaning": family.meanings.get(name, ""),
        }
        for name, choices in family.switches.items()
    }  # fmt: skip


def _clocks(system: "System") -> dict[str, Any]:
    """Angular frequency of each clock, and its speed ratio where the model counts one."""
    numbers = {p: float(system.values[p.name]) for p in system.model.parameters}
    rates = {name: float(sympify(rate).subs(numbers)) for name, rate in system.model.clocks.items()}
    s = float(system.values[system.speed]) if system.speed else None
    hertz = Dimensions(system).of("speed")
    return {
        n: {"frequency": w, "s": None if s is None else s * abs(w), "Hz": w * hertz.size if hertz.unit == "Hz" else None}
        for n, w in rates.items()
    }


def _sized(units: "Dimensions", name: str, value: float) -> dict[str, Any] | None:
    """A value of a state in its engineering unit; None where the case has no dimensions."""
    found = units.quantity(name)
    return {"start": value * found.size, "units": {"start": found.unit}} if units.known else None


def _rpm(value: float, unit: str) -> float | None:
    return convert(value, "rad/s", "rpm") if unit == "rad/s" else None


def warnings(system: "System", facts: dict[str, Any]) -> list[str]:
    """List what a reader should know before trusting a result."""
    made = []
    if not facts["start_found"]:
        why = "; a film that carries nothing at rest has no derivative there" if standing(system) else ""
        made.append(f"no static equilibrium was found: a run begins beside the clearance centre instead{why}")
    if facts["common_multiple"] is None:
        made.append(
            "the forcing has no common period (an order of a harmonic is no ratio p/q with q up to 10000): no return is"
            " sought, and motion that has no frequency but the forcing's is called locked"
        )
    return made + repeated([system])


def _oil(system: "System", facts: dict[str, Any]) -> str:
    """Add the heat balance of every film to the dimensional results; return why there is none, where one is expected."""
    if not judged(system):
        return ""
    numbers = Facts.of(system, [])
    for name, heat in oil_heat(numbers).items():
        at = f"at {_rpm(heat.omega, 'rad/s'):.5g} rpm"
        for key, value, unit, meaning in (
            (f"film_power{name}", heat.power, "W", f"power loss of one film {at}, plain short bearing"),
            (f"side_flow{name}", heat.flow, "m^3/s", f"oil that leaves one bearing at its ends {at}"),
            (f"oil_rise{name}", heat.rise, "K", f"rise of the oil's temperature {at} if all heat goes with the side flow"),
            (f"oil_thinning{name}", heat.thinning, "1", f"part of its viscosity that the oil loses so; {heat.law}"),
        ):
            facts["quantities"][key] = {"value": value, "unit": unit, "meaning": meaning, "rpm": None}
    return why_none(numbers)


def _print(facts: dict[str, Any]) -> None:
    typer.echo(f"{facts['case']}: model {facts['model']}")
    if facts["description"]:
        report.show(facts["description"])
    if facts["changed"]:
        what = ", ".join(facts["changed"])
        typer.echo(f"changed: {what}; what the case says in words was written for its own numbers")
    for text in facts["warnings"]:
        typer.echo(f"warning: {text}")
    if "parts" in facts:
        print_parts(facts["parts"])
    tables = []
    if facts["inputs"]:
        rows = [(n, _small_e(i["written"]), i["meaning"], _origin(i)) for n, i in facts["inputs"].items()]
        tables.append(report.table("Dimensional inputs", ("symbol", "value", "meaning", "from"), rows, numbers=(1,)))
    rows = [
        (n, (p["exact"] or report.number(p["value"])) + _unit(p["unit"]), p["meaning"], _origin(p))
        for n, p in facts["parameters"].items()
    ]  # fmt: skip
    title = "Dimensionless groups" if facts["inputs"] else "Parameters"
    tables.append(report.table(title, ("symbol", "value", "meaning", "from"), rows, numbers=(1,)))
    wide = report.console().width >= SIDE_BY_SIDE
    report.show(*([Columns(tables, padding=(0, 3))] if wide else tables))
    rest = []
    if facts["switches"]:
        rows = [(n, s["value"], " | ".join(s["choices"]), s["meaning"]) for n, s in facts["switches"].items()]
        rest.append(report.table("Switches", ("switch", "value", "choices", "chooses"), rows))
    if facts["quantities"]:
        rows = [
            (n, report.number(q["value"]) + _unit(q["unit"]), _in_rpm(q["rpm"]), q["meaning"])
            for n, q in facts["quantities"].items()
        ]  # fmt: skip
        rest.append(report.table("Dimensional results", ("quantity", "value", "", "meaning"), rows, numbers=(1, 2)))
    if facts["clocks"]:
        hertz = any(c["Hz"] is not None for c in facts["clocks"].values())
        clocks = [(n, c["frequency"], c["s"], *([c["Hz"]] if hertz else [])) for n, c in facts["clocks"].items()]
        ratio = f"speed ratio {facts['speed'] or 's'}"
        columns = ("clock", "frequency, per unit of the model's time", ratio, *(["Hz"] if hertz else []))
        rest.append(report.table("Clocks", columns, clocks, numbers=range(1, len(columns))))
    begin = [
        (n, report.number(s["start"]) + _unit(s["unit"]), _in_unit(s["dimensional"]), s["meaning"],
         "given" if s["given"] else "")
        for n, s in facts["states"].items()
    ]  # fmt: skip
    columns = ("state", "value", "", "meaning", "")
    rest.append(report.table(f"Start state ({facts['start']})", columns, begin, numbers=(1, 2)))
    report.show(*rest)
    if facts["oil_not_judged"]:
        typer.echo(f"temperature of the oil: not judged, for {facts['oil_not_judged']}")
    _print_periods(facts)
    if facts["not_declared"]:
        typer.echo(f"not declared: {brackets(facts['not_declared'])}")
    if facts["stations"]:
        places = ", ".join(f"{name} ({x}, {y})" for name, (x, y) in facts["stations"].items())
        typer.echo(f"stations, for speeds --quantity and linear --response: {places}")
    for name, text in facts["stops"].items():
        typer.echo(f"a run ends with {name}: {text}")
    for state, rate in facts.get("equations", {}).items():
        typer.echo(f"d {state}/dt = {rate}")
    for key, text in facts["sources"].items():
        typer.echo(f"[{key}] {text}")


def _print_periods(facts: dict[str, Any]) -> None:
    if not facts["forced"]:
        typer.echo(f"unforced: cut by its section; typical time {facts['period']:.7g}")
        return
    common = facts["common_multiple"]
    beside = "no common period" if common is None else f"common period {facts['common_period']:.7g} = {common} T"
    seconds = "" if facts["period_s"] is None else f" ({facts['period_s']:.7g} s)"
    typer.echo(f"period T = {facts['period']:.7g}{seconds}, {beside}")


def _in_unit(found: dict[str, Any] | None) -> str:
    return "" if found is None or found["units"]["start"] == "1" else f"{found['start']:.5g} {found['units']['start']}"


def _in_rpm(rpm: float | None) -> str:
    return "" if rpm is None else f"{rpm:.5g} rpm"


def exact(value: Any) -> str | None:
    """Write a ratio of integers as text; None for a float."""
    return str(value) if isinstance(value, Fraction) else None


def _small_e(text: str) -> str:
    """``4E+6 N/m`` as ``4e6 N/m``."""
    return re.sub(r"(?<=\d)E\+?(?=-?\d)", "e", text)


def _unit(unit: str) -> str:
    return "" if unit == "1" else f" {unit}"


def _origin(parameter: dict[str, Any]) -> str:
    said = str(parameter["source"])
    if parameter.get("instead_of"):
        said += f"; the case has {_small_e(parameter['instead_of'])}"
    if parameter.get("written_for"):
        then = ", ".join(f"{name} = {_small_e(value)}" for name, value in parameter["written_for"].items())
        said += f" [written for {then}]"
    return said + ("" if parameter.get("read", True) else " (not read)")
