"""``whirlmap linear``: the static equilibrium, the eigenvalues there, and the stability threshold."""

import math
from typing import TYPE_CHECKING, Annotated, Any

import typer

from whirlmap.cli import options, report
from whirlmap.cli.ranges import in_parameters, read_brackets

if TYPE_CHECKING:
    from whirlmap.analysis.film_coefficients import FilmCoefficients
    from whirlmap.analysis.linear import LinearAnalysis
    from whirlmap.integrate.dimensions import Dimensions

EXAMPLES = (
    "whirlmap linear jeffcott",
    "whirlmap linear machines/jeffcott-rig --json",
    "whirlmap linear jeffcott --set Gamma=0.2 --threshold s=0.5:4",
)

#: Coefficients in units of the load W that the film carries, and of the journal's speed omega; and in SI.
HEADS = {"K_over_W_c": "k [W/c]", "K": "k [N/m]", "C_over_W_c_omega": "c [W/(c omega)]", "C": "c [N*s/m]"}


def linear(
    case: options.CaseName,
    changes: options.Changes = None,
    threshold: Annotated[
        str | None,
        typer.Option(
            "--threshold", metavar="NAME=LOW:HIGH", rich_help_panel=options.COMPUTING,
            help="Also find the lowest value in this bracket at which the equilibrium loses its stability; of a case with"
            ' dimensions also "speed=1000 rpm:9000 rpm".',
        ),
    ] = None,
    dimensionless: options.Dimensionless = False,
    json: options.Json = False,
) -> None:  # fmt: skip
    """Linearise CASE about its static equilibrium, with all forcing off.

    A case with dimensions is shown in um, Hz, 1/s and N.
    """
    brackets = read_brackets([threshold] if threshold else None, "--threshold")
    system = options.open_system(case, changes, None)
    bracket = None
    for read in brackets.values():
        swept = in_parameters(system, *read, option="--threshold")
        bracket = swept.name, (swept.start, swept.stop)
    from whirlmap.analysis.film_coefficients import film_coefficients
    from whirlmap.analysis.linear import linear_analysis
    from whirlmap.analysis.threshold import NoThresholdError, stability_threshold
    from whirlmap.integrate.dimensions import Dimensions

    found = linear_analysis(system)
    limit, note = None, None
    if bracket:
        try:
            limit = stability_threshold(system, *bracket)
        except NoThresholdError as error:  # that nothing is lost there is an answer
            note = str(error)
    films = {name: _film(one) for name, one in film_coefficients(system).items()}
    lost = {"parameter": bracket[0], "value": limit, "note": note} if bracket else None
    units = Dimensions(system, own=dimensionless)
    facts = _in_units(units, found, films, lost)
    if json:
        own = _in_units(Dimensions(system, own=True), found, films, lost)
        kept = ("equilibrium", "eigenvalues", "loads", "threshold", "units")
        report.print_json({
            "case": system.case, "model": system.model.name, "parameters": system.values, "stable": found.stable,
            "films": films, **report.beside(own, facts, kept, units),
        })  # fmt: skip
        return
    typer.echo(f"{system.case}: the static equilibrium is {'stable' if found.stable else 'unstable'}")
    said = facts["units"]
    rest = [(report.with_unit(name, said["equilibrium"][name]), value) for name, value in facts["equilibrium"].items()]
    title = "Eigenvalues" if units.known else "Eigenvalues, per radian of the clock"
    growth, frequency = (report.with_unit(key, said[key]) for key in ("growth", "frequency"))
    modes = [(m["growth"], m["frequency"], m["damping_ratio"], m["name"]) for m in facts["eigenvalues"]]
    report.show(
        report.table("Static equilibrium", ("state", "value"), rest, numbers=(1,)),
        report.table(title, (growth, frequency, "damping ratio", "mode"), modes, numbers=(0, 1, 2)),
    )
    for name, one in films.items():
        keys = [key for key in one if key[0] in "KC" and one[key] is not None]
        rows = [
            (axes, *(float(one[key][i][j]) for key in keys))
            for axes, i, j in (("xx", 0, 0), ("xy", 0, 1), ("yx", 1, 0), ("yy", 1, 1))
        ]
        title = f"Bearing {name}, eccentricity {one['eccentricity']:.4g}"
        title += f", load {facts['loads'][name]:.4g}{report.unit_behind(said['loads'])}" if units.known else ""
        report.show(report.table(title, ("axes", *(HEADS[key] for key in keys)), rows, numbers=range(1, len(keys) + 1)))
    if note:
        typer.echo(note)
    elif bracket:
        unit = report.unit_behind(said["threshold"])
        beside = f", {facts['threshold']['value']:.9g}{unit}" if unit else ""
        typer.echo(f"stability is lost at {bracket[0]} = {limit:.9g}{beside}")


def _in_units(
    units: "Dimensions", found: "LinearAnalysis", films: dict[str, Any], threshold: dict[str, Any] | None
) -> dict[str, Any]:
    """What was found, in these units, which stand beside."""
    import numpy as np

    from whirlmap.analysis.mode_shapes import WHIRL, shapes_of, whirl_of

    system, values, vectors = units.system, found.eigenvalues[None], found.eigenvectors[None]
    whirl = whirl_of(system, values, vectors)[0]
    names = shapes_of(system, vectors[0].T[:, :, None], np.abs(values.imag).T, whirl[:, None]).names[:, 0]
    rate, cycles, force = units.of("rate"), units.of("speed"), units.of("force")
    rest = {name: units.quantity(name) for name in system.states}
    critical = units.quantity(threshold["parameter"]) if threshold else None
    return {
        "equilibrium": {
            name: float(value * rest[name].size) for name, value in zip(system.states, found.equilibrium, strict=True)
        },
        "eigenvalues": [
            {
                "growth": float(v.real * rate.size), "frequency": float(v.imag * cycles.size),
                "damping_ratio": float(-v.real / abs(v)) if v else None, "name": str(name), "whirl": WHIRL[int(sense)],
            }
            for v, name, sense in zip(found.eigenvalues, names, whirl, strict=True)
        ],
        "loads": {name: one["load"] * force.size for name, one in films.items()},
        "threshold": threshold if not threshold or not critical or threshold["value"] is None
        else {**threshold, "value": threshold["value"] * critical.size},
        "units": {
            "equilibrium": {name: one.unit for name, one in rest.items()}, "growth": rate.unit, "frequency": cycles.unit,
            "loads": force.unit, "threshold": critical.unit if critical else "1",
        },
    }  # fmt: skip


def _film(film: "FilmCoefficients") -> dict[str, Any]:
    """Plain data of one film; None in place of what needs dimensions."""
    si = math.isfinite(film.W_c_omega)
    return {
        "eccentricity": film.eccentricity, "load": film.load, "K_over_W_c": film.K, "K": film.W_c * film.K if si else None,
        "C_over_W_c_omega": film.C, "C": film.W_c_omega * film.C if si else None,
    }  # fmt: skip
