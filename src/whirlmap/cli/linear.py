"""``whirlmap linear``: the static equilibrium, the eigenvalues there, and the stability threshold."""

from typing import Annotated

import typer

from whirlmap.cli import options, report

EXAMPLES = (
    "whirlmap linear jeffcott",
    "whirlmap linear machines/jeffcott-rig --json",
    "whirlmap linear jeffcott --set Gamma=0.2 --threshold s=0.5:4",
)


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
    from whirlmap.analysis.linear import linear_analysis
    from whirlmap.analysis.ross import film_coefficients, has_si_film, load_scale
    from whirlmap.analysis.threshold import stability_threshold

    found = linear_analysis(system)
    limit = stability_threshold(system, *bracket) if bracket else None
    equilibrium = dict(zip(system.states, found.equilibrium, strict=True))
    modes = [
        {"growth": float(v.real), "frequency": float(v.imag), "damping_ratio": float(-v.real / abs(v)) if v else None}
        for v in found.eigenvalues
    ]
    film = None
    if has_si_film(system):
        (K, C), (stiffness, damping) = film_coefficients(system), load_scale(system)
        film = {"K": K, "C": C, "K_over_W_c": K / stiffness, "C_over_W_c_omega": C / damping}
    if json:
        report.print_json({
            "case": system.case, "model": system.model.name, "parameters": system.values, "equilibrium": equilibrium,
            "stable": found.stable, "eigenvalues": modes, "film": film,
            "threshold": {"parameter": bracket[0], "value": limit} if bracket else None,
        })  # fmt: skip
        return
    typer.echo(f"{system.case}: the static equilibrium is {'stable' if found.stable else 'unstable'}")
    columns = ("growth", "frequency", "damping ratio")
    report.show(
        report.table("Static equilibrium", ("state", "value"), equilibrium.items(), numbers=(1,)),
        report.table("Eigenvalues, per radian of the clock", columns, [tuple(m.values()) for m in modes], numbers=(0, 1, 2)),
    )
    if film:
        rows = [
            (name, *(float(film[key][i, j]) for key in ("K_over_W_c", "K", "C_over_W_c_omega", "C")))
            for name, i, j in (("xx", 0, 0), ("xy", 0, 1), ("yx", 1, 0), ("yy", 1, 1))
        ]
        heads = ("axes", "k [W/c]", "k [N/m]", "c [W/(c omega)]", "c [N*s/m]")
        report.show(report.table("Film of one bearing, x horizontal, y up", heads, rows, numbers=(1, 2, 3, 4)))
    if bracket:
        typer.echo(f"stability is lost at {bracket[0]} = {limit:.9g}")
