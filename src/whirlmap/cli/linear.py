"""``whirlmap linear``: the static equilibrium, the eigenvalues there, and the stability threshold."""

import math
from typing import TYPE_CHECKING, Annotated, Any

import typer

from whirlmap.cli import options, report
from whirlmap.cli.bifurcation import refuse_input

if TYPE_CHECKING:
    from whirlmap.analysis.film_coefficients import FilmCoefficients
    from whirlmap.integrate.system import System

EXAMPLES = (
    "whirlmap linear jeffcott",
    "whirlmap linear machines/jeffcott-rig --json",
    "whirlmap linear jeffcott --set Gamma=0.2 --threshold s=0.5:4",
)

#: Coefficients in units of the load W that the film carries, and of the journal's speed omega; and in SI.
HEADS = {"K_over_W_c": "k [W/c]", "K": "k [N/m]", "C_over_W_c_omega": "c [W/(c omega)]", "C": "c [N*s/m]"}

STABLE = {True: "stable", False: "unstable"}


def linear(
    case: options.CaseName,
    changes: options.Changes = None,
    threshold: Annotated[
        str | None,
        typer.Option(
            "--threshold", metavar="NAME=LOW:HIGH", rich_help_panel=options.COMPUTING,
            help="Also find the lowest value in this bracket at which the equilibrium loses its stability.",
        ),
    ] = None,
    json: options.Json = False,
) -> None:  # fmt: skip
    """Linearise CASE about its static equilibrium, with all forcing off."""
    bracket = next(iter(options.brackets([threshold], "--threshold").items())) if threshold else None
    system = options.open_system(case, changes, None)
    if bracket:
        refuse_input(system, bracket[0], "--threshold")
    from whirlmap.analysis.film_coefficients import film_coefficients
    from whirlmap.analysis.linear import NotLinearError, linear_analysis
    from whirlmap.analysis.threshold import NoThresholdError, stability_threshold
    from whirlmap.integrate.equilibrium import rest_state

    modes: list[dict[str, Any]] = []
    films: dict[str, dict[str, Any]] = {}
    limit, stable, note, unstable = None, None, None, None
    try:
        found = linear_analysis(system)
    except NotLinearError as error:  # what there is of an answer is the equilibrium, and why there is no more
        note = f"{error}. {instead(system)}"
    else:
        stable = found.stable
        modes = [
            {"growth": float(v.real), "frequency": float(v.imag), "damping_ratio": float(-v.real / abs(v)) if v else None}
            for v in found.eigenvalues
        ]
        films = {name: _film(one) for name, one in film_coefficients(system).items()}
        try:
            limit = stability_threshold(system, *bracket) if bracket else None
        except NoThresholdError as error:  # that nothing is lost there is an answer
            unstable = str(error)
    equilibrium = rest_state(system) or {}
    assumptions = report.say_assumptions(system, {bracket[0]: bracket[1]} if bracket else {})
    if json:
        report.print_json({
            "case": system.case, "model": system.model.name, "parameters": system.values, "equilibrium": equilibrium,
            "stable": stable, "eigenvalues": modes, "films": films, "note": note, "assumptions": assumptions,
            "threshold": {"parameter": bracket[0], "value": limit, "note": unstable or note} if bracket else None,
        })  # fmt: skip
        return
    typer.echo(f"{system.case}: {note or f'the static equilibrium is {STABLE[bool(stable)]}'}")
    columns = ("growth", "frequency", "damping ratio")
    report.show(report.table("Static equilibrium", ("state", "value"), equilibrium.items(), numbers=(1,)))
    if modes:
        rows = [tuple(m.values()) for m in modes]
        report.show(report.table("Eigenvalues, per radian of the clock", columns, rows, numbers=(0, 1, 2)))
    for name, one in films.items():
        keys = [key for key in one if key[0] in "KC" and one[key] is not None]
        rows = [
            (axes, *(float(one[key][i][j]) for key in keys))
            for axes, i, j in (("xx", 0, 0), ("xy", 0, 1), ("yx", 1, 0), ("yy", 1, 1))
        ]
        title = f"Bearing {name}, eccentricity {one['eccentricity']:.4g}"
        report.show(report.table(title, ("axes", *(HEADS[key] for key in keys)), rows, numbers=range(1, len(keys) + 1)))
    if unstable:
        typer.echo(unstable)
    elif bracket and limit is not None:
        typer.echo(f"stability is lost at {bracket[0]} = {limit:.9g}")


def instead(system: "System") -> str:
    """Say which commands answer where there is no linear system."""
    case = system.case
    known = "omega_cage" in getattr(system.details, "quantities", {})
    free = f"Natural frequencies without the film and with its rings held: `whirlmap show {case}`. "
    return (
        f"{free if known else ''}How it moves: `whirlmap diagnose {case}`; how far along the speed:"
        f" `whirlmap speeds {case}` or `whirlmap bifurcation {case} --vary s=...`"
    )


def _film(film: "FilmCoefficients") -> dict[str, Any]:
    """Plain data of one film; None in place of what needs dimensions."""
    si = math.isfinite(film.W_c_omega)
    return {
        "eccentricity": film.eccentricity, "load": film.load, "K_over_W_c": film.K, "K": film.W_c * film.K if si else None,
        "C_over_W_c_omega": film.C, "C": film.W_c_omega * film.C if si else None,
    }  # fmt: skip
