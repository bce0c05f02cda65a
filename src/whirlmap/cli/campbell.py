"""``whirlmap campbell``: damped frequencies, order lines and critical speeds."""

from typing import TYPE_CHECKING, Annotated, Any

import typer

from whirlmap.cli import options, pictures, report
from whirlmap.cli.bifurcation import refuse_input
from whirlmap.cli.messages import say
from whirlmap.cli.outputs import claim
from whirlmap.errors import RangeError

if TYPE_CHECKING:
    import xarray as xr

    from whirlmap.integrate.system import System

EXAMPLES = (
    "whirlmap campbell jeffcott --vary s=0.3:5:100 --out campbell.png",
    "whirlmap campbell machines/turbo-gearbox --vary s=0.1:2:200 --json",
)

WHIRL = {1: "forward", -1: "backward", 0: "none"}


def campbell(
    case: options.CaseName,
    vary: Annotated[
        str,
        typer.Option(
            "--vary", metavar="NAME=START:STOP:COUNT[:log]", rich_help_panel="Sweep",
            help="Parameter and range, ascending, as a rule the speed: s=0.3:5:100.",
        ),
    ],
    changes: options.Changes = None,
    out: options.Out = None,
    size: options.Size = None,
    dpi: options.Dpi = None,
    title: options.Title = None,
    force: options.Force = False,
    json: options.Json = False,
) -> None:  # fmt: skip
    """Follow the damped frequencies of CASE about its static equilibrium, and say where order lines cross them."""
    from whirlmap.sweep.grid import Range

    swept = Range.parse(vary)
    if swept.name in options.assignments(changes, "--set"):
        raise RangeError(f"{swept.name}: found it in --set and in --vary, expected it in one of them")
    destination = claim(out, "campbell", force=force, size=size, dpi=dpi, title=title)
    system = options.open_system(case, changes, None)
    refuse_input(system, swept.name, "--vary")
    from whirlmap.analysis.campbell import campbell as compute

    ds = compute(system, swept.name, swept.values)
    files = destination.write(ds, lambda made: pictures.campbell(system, made))
    missing = int((ds["status"] != 0).sum())
    if missing:
        say(f"no static equilibrium was found at {missing} of {swept.count} values: they are left out")
    facts = summary(system, ds, swept.name)
    if json:
        report.print_json({**facts, "files": files})
        return
    typer.echo(f"{system.case}: {swept.name} from {swept.start:.6g} to {swept.stop:.6g}, {swept.count} points")
    rows = [
        (c["value"], c["clock"], c["mode"], c["whirl"], f"{c['damping_ratio']:.4g}") for c in facts["critical"]
    ]
    columns = (swept.name, "clock", "mode", "whirl", "damping ratio")
    if rows:
        report.show(report.table("Order lines that cross a damped frequency", columns, rows, numbers=(0, 4)))
    else:
        typer.echo("no order line crosses a damped frequency in this range")
    report.print_written(files)


def summary(system: "System", ds: "xr.Dataset", name: str) -> dict[str, Any]:
    """Say what a Campbell diagram holds."""
    keys = ("critical", "critical_clock", "critical_mode", "critical_whirl", "critical_damping_ratio")
    found = [
        {"value": float(v), "clock": str(c), "mode": str(int(m)), "whirl": WHIRL[int(w)], "damping_ratio": float(d)}
        for v, c, m, w, d in zip(*(ds[key].values for key in keys), strict=True)
    ]
    return {
        "case": system.case, "model": system.model.name, "varied": name, "values": ds[name].values,
        **{key: ds[key].values for key in ("frequency", "growth", "damping_ratio", "whirl", "line", "status")},
        "clocks": [str(c) for c in ds["clock"].values], "critical": found,
    }  # fmt: skip
