"""``whirlmap linear``: the static equilibrium, the eigenvalues there, and the stability threshold."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import typer

from whirlmap.analysis.linear.film_coefficients import film_coefficients
from whirlmap.analysis.linear.linearisation import NotLinearError, linear_analysis
from whirlmap.analysis.linear.mode_shapes import WHIRL, shapes_of, whirl_of
from whirlmap.analysis.linear.stability_threshold import NoThresholdError, stability_threshold
from whirlmap.cli.common import report
from whirlmap.cli.common.assignments import ranges
from whirlmap.cli.common.opening import open_system
from whirlmap.cli.common.outputs import Destination, claim
from whirlmap.cli.common.response_report import Asked, show_response
from whirlmap.cli.common.violated import say_assumptions
from whirlmap.errors import InputError
from whirlmap.integrate.dimensions import Dimensions
from whirlmap.integrate.equilibrium import rest_state
from whirlmap.integrate.own_units import in_parameters

if TYPE_CHECKING:
    from whirlmap.analysis.linear.film_coefficients import FilmCoefficients
    from whirlmap.analysis.linear.linearisation import LinearAnalysis
    from whirlmap.integrate.system import System


#: Coefficients in units of the load W that the film carries, and of the journal's speed omega; and in SI.
HEADS = {"K_over_W_c": "k [W/c]", "K": "k [N/m]", "C_over_W_c_omega": "c [W/(c omega)]", "C": "c [N*s/m]"}

STABLE = {True: "stable", False: "unstable"}


def linear(
    *, case: str, changes: list[str] | None, threshold: str | None, response: bool, vary: str | None,
    probe: list[str] | None, nonlinear: int | None, over: Path | None, dimensionless: bool, out: Path | None,
    size: str | None, dpi: int | None, title: str | None, force: bool, json: bool, quiet: bool,
) -> None:  # fmt: skip
    """Do what `whirlmap.cli.declared.linear` says."""
    brackets = ranges([threshold] if threshold else None, "--threshold")
    asked = Asked(vary, probe, nonlinear, over, dimensionless, json, quiet)
    if response and threshold:
        raise InputError("--threshold: found it with --response, expected one of them")
    destination = claim(out, "response", force=force, size=size, dpi=dpi, title=title)
    if response:
        _respond(open_system(case, changes, None), asked, destination)
        return
    asked.refuse_without_response(out)
    system = open_system(case, changes, None)

    bracket = None
    for read in brackets.values():
        swept = in_parameters(system, read, option="--threshold")
        bracket = swept.name, (swept.start, swept.stop)

    found, films = None, dict[str, dict[str, Any]]()
    limit, note, unstable = None, None, None
    try:
        found = linear_analysis(system)
    except NotLinearError as error:  # what there is of an answer is the equilibrium, and why there is no more
        note = f"{error}. {instead(system)}"
    else:
        report.say_not_declared(system, "bodies")
        films = {name: _film(one) for name, one in film_coefficients(system).items()}
        try:
            limit = stability_threshold(system, *bracket) if bracket else None
        except NoThresholdError as error:  # that nothing is lost there is an answer
            unstable = str(error)
    assumptions = say_assumptions(system, {bracket[0]: bracket[1]} if bracket else {})
    lost = {"parameter": bracket[0], "value": limit, "note": unstable or note} if bracket else None
    units, rest = Dimensions(system, own=dimensionless), rest_state(system) or {}
    facts = _in_units(units, rest, found, films, lost)
    if json:
        own = _in_units(Dimensions(system, own=True), rest, found, films, lost)
        kept = ("equilibrium", "eigenvalues", "loads", "threshold", "units")
        report.print_json({
            "case": system.case, "model": system.model.name, "parameters": system.values,
            "stable": found.stable if found else None, "films": films, "note": note, "assumptions": assumptions,
            **report.beside(own, facts, kept, units),
        })  # fmt: skip
        return
    typer.echo(f"{system.case}: {note or f'the static equilibrium is {STABLE[bool(found and found.stable)]}'}")
    said = facts["units"]
    still = [(report.with_unit(name, said["equilibrium"][name]), value) for name, value in facts["equilibrium"].items()]
    report.show(report.table("Static equilibrium", ("state", "value"), still, numbers=(1,)))
    if found:
        title = "Eigenvalues" if units.known else "Eigenvalues, per radian of the clock"
        growth, frequency = (report.with_unit(key, said[key]) for key in ("growth", "frequency"))
        modes = [(m["growth"], m["frequency"], m["damping_ratio"], m["name"]) for m in facts["eigenvalues"]]
        report.show(report.table(title, (growth, frequency, "damping ratio", "mode"), modes, numbers=(0, 1, 2)))
    for name, one in films.items():
        keys = [key for key in one if key[0] in "KC" and one[key] is not None and (units.known or "_over_" in key)]
        rows = [
            (axes, *(float(one[key][i][j]) for key in keys))
            for axes, i, j in (("xx", 0, 0), ("xy", 0, 1), ("yx", 1, 0), ("yy", 1, 1))
        ]
        title = f"Bearing {name}, eccentricity {one['eccentricity']:.4g}"
        title += f", load {facts['loads'][name]:.4g}{report.unit_behind(said['loads'])}" if units.known else ""
        report.show(report.table(title, ("axes", *(HEADS[key] for key in keys)), rows, numbers=range(1, len(keys) + 1)))
    if unstable:
        typer.echo(unstable)
    elif bracket and limit is not None:
        unit = report.unit_behind(said["threshold"])
        beside = f", {facts['threshold']['value']:.9g}{unit}" if unit else ""
        typer.echo(f"stability is lost at {bracket[0]} = {limit:.9g}{beside}")


def _respond(system: "System", asked: Asked, destination: Destination) -> None:
    """Show the response to unbalance; that small motions have no linear system is an answer."""
    try:
        show_response(system, asked, destination)
    except NotLinearError as error:
        if destination.places is not None:  # who asked for a file gets none
            raise
        note = f"{error}. {instead(system)}"
        if asked.json:
            report.print_json({"case": system.case, "model": system.model.name, "critical": [], "note": note})
        else:
            typer.echo(f"{system.case}: {note}")


def _in_units(
    units: "Dimensions", still: Mapping[str, float], found: "LinearAnalysis | None", films: dict[str, Any],
    threshold: dict[str, Any] | None,
) -> dict[str, Any]:  # fmt: skip
    """What was found, in these units, which stand beside."""
    rate, cycles, force = units.of("rate"), units.of("speed"), units.of("force")
    rest = {name: units.quantity(name) for name in still}
    critical = units.quantity(threshold["parameter"]) if threshold else None
    return {
        "equilibrium": {name: float(value * rest[name].size) for name, value in still.items()},
        "eigenvalues": _modes(units, found) if found else [],
        "loads": {name: one["load"] * force.size for name, one in films.items()},
        "threshold": threshold if not threshold or not critical or threshold["value"] is None
        else {**threshold, "value": threshold["value"] * critical.size},
        "units": {
            "equilibrium": {name: one.unit for name, one in rest.items()}, "growth": rate.unit, "frequency": cycles.unit,
            "loads": force.unit, "threshold": critical.unit if critical else "1",
        },
    }  # fmt: skip


def _modes(units: "Dimensions", found: "LinearAnalysis") -> list[dict[str, Any]]:
    """Eigenvalues in these units, with the names of their modes."""
    system, values, vectors = units.system, found.eigenvalues[None], found.eigenvectors[None]
    whirl = whirl_of(system, values, vectors)[0]
    names = shapes_of(system, vectors[0].T[:, :, None], np.abs(values.imag).T, whirl[:, None]).names[:, 0]
    rate, cycles = units.of("rate").size, units.of("speed").size
    return [
        {
            "growth": float(v.real * rate), "frequency": float(v.imag * cycles),
            "damping_ratio": float(-v.real / abs(v)) if v else None, "name": str(name), "whirl": WHIRL[int(sense)],
        }
        for v, name, sense in zip(found.eigenvalues, names, whirl, strict=True)
    ]  # fmt: skip


def instead(system: "System") -> str:
    """Say which commands answer where there is no linear system."""
    case = system.case
    known = system.machine and system.machine.results("natural_frequency")
    free = f"Natural frequencies without the film and with its rings held: `whirlmap show {case}`. "
    return (
        f"{free if known else ''}How it moves: `whirlmap diagnose {case}`; how far along the speed:"
        f" `whirlmap speeds {case}` or `whirlmap bifurcation {case} --vary {system.speed or 'NAME'}=...`"
    )


def _film(film: "FilmCoefficients") -> dict[str, Any]:
    """Plain data of one film; None in place of what needs dimensions."""
    si = math.isfinite(film.W_c_omega)
    return {
        "eccentricity": film.eccentricity, "load": film.load, "K_over_W_c": film.K, "K": film.W_c * film.K if si else None,
        "C_over_W_c_omega": film.C, "C": film.W_c_omega * film.C if si else None,
    }  # fmt: skip
