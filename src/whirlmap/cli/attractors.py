"""``whirlmap attractors``: what motions coexist at one operating point, and how many starts lead to each."""

from typing import TYPE_CHECKING, Annotated, Any

import typer

from whirlmap.cli import options, pictures, report
from whirlmap.cli.outputs import claim
from whirlmap.cli.progress import Progress

if TYPE_CHECKING:
    import xarray as xr

    from whirlmap.integrate.system import System

STARTS = "Start states"

EXAMPLES = (
    "whirlmap attractors duffing --set gamma=0.2",
    "whirlmap attractors duffing --set gamma=0.2 --starts 2000 --box x=-2:2 --box v=-2:2 --out duffing.png",
    "whirlmap attractors gear_backlash --set Omega=1.0 --set F_ah=0.2 --set zeta=0.05 --box x=-3:3 --box v=-2:2",
)


def attractors(
    case: options.CaseName,
    starts: Annotated[
        int,
        typer.Option("--starts", metavar="N", min=1, rich_help_panel=STARTS, help="Start states drawn at random."),
    ] = 256,
    box: Annotated[
        list[str] | None,
        typer.Option(
            "--box", metavar="STATE=LOW:HIGH", rich_help_panel=STARTS,
            help="Range from which a state's starts are drawn; may be repeated, and the other states keep their start"
            " value. Without it all states are drawn from twice the range of the motion from the default start.",
        ),
    ] = None,
    seed: Annotated[int, typer.Option("--seed", metavar="N", min=0, rich_help_panel=STARTS, help="Of the drawing.")] = 0,
    changes: options.Changes = None,
    start: options.Start = None,
    transient: options.Transient = 100,
    most: options.Most = 64,
    tolerance: options.Tolerance = 1e-6,
    lyapunov: options.MeasuredLyapunov = None,
    steps: options.Steps = None,
    accuracy: options.Accuracy = None,
    method: options.Method = None,
    workers: options.Workers = None,
    out: options.Out = None,
    size: options.Size = None,
    dpi: options.Dpi = None,
    title: options.Title = None,
    force: options.Force = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> None:  # fmt: skip
    """Find the attractors that coexist at one operating point of CASE, and the share of the starts that lead to each.

    Starts that end in contact, diverge, or stay undecided are counted as such, and belong to no attractor. The picture
    shows the start states in the colour of their attractor, with its section points.
    """
    boxes = options.brackets(box, "--box")
    destination = claim(out, "attractors", force=force, size=size, dpi=dpi, title=title)
    system = options.open_system(case, changes, start)
    from whirlmap.analysis.settling import Settling
    from whirlmap.sweep.attractors import attractors as find
    from whirlmap.sweep.memory import refuse_points
    from whirlmap.sweep.run import expected_periods

    settling = Settling(transient=transient, most=most, tolerance=tolerance)
    refuse_points([starts])
    with Progress("attractors", expected_periods(system, starts, settling), quiet=quiet) as progress:
        ds = find(
            system, starts=starts, box=boxes or None, seed=seed, settling=settling, lyapunov=lyapunov, steps=steps,
            accuracy=accuracy, method=method, workers=workers, progress=progress,
        )  # fmt: skip
    files = destination.write(ds, lambda done: pictures.attractors(system, done))
    report.say_doubts(ds.attrs)
    facts = summary(system, ds)
    if json:
        report.print_json({**facts, "seed": seed, "files": files})
    else:
        say_attractors(facts)
        report.print_written(files)


def summary(system: "System", ds: "xr.Dataset") -> dict[str, Any]:
    """Say what a search found, attractor by attractor."""
    from whirlmap.results.regime import Regime

    made = ds["attractor"].values.tolist() if "attractor" in ds.coords else []
    counted = int(ds["starts"].sum()) + int(ds["outcome_starts"].sum())
    names = ("share", "share_error", "confidence", "lyapunov", "lyapunov_error", "return_distance")
    return {
        "case": system.case,
        "model": system.model.name,
        "parameters": system.values,
        "starts": counted,
        "attractors": [
            {
                "number": number,
                "regime": Regime(int(one["regime"])).label,
                "period": int(one["period_T"]) or None,
                "period_common": int(one["period_common"]) or None,
                "starts": int(one["starts"]),
                **{name: float(one[name]) for name in names},
                "votes": {str(i): _vote(v) for i, v in zip(one["indicator"].values, one["vote"].values, strict=True)},
                "peak_to_peak": {str(q): float(one["peak_to_peak"].sel(quantity=q)) for q in ds["quantity"].values},
            }
            for number, one in ((n, ds.sel(attractor=n)) for n in made)
        ],
        "outcomes": {
            str(o): {
                name: float(ds[f"outcome_{name}"].sel(outcome=o)) for name in ("starts", "share", "share_error")
            }
            for o in ds["outcome"].values
        },
    }  # fmt: skip


def _vote(vote: Any) -> str:
    from whirlmap.analysis.labels.votes import Vote

    return Vote(int(vote)).name


def say_attractors(facts: dict[str, Any]) -> None:
    """Print the table of attractors, and how the other starts ended."""
    found = facts["attractors"]
    typer.echo(f"{facts['case']}: {facts['starts']} starts, {len(found)} attractor{'s' if len(found) != 1 else ''}")
    rows = []
    for a in found:
        label = f"periodic, {a['period']}T" if a["regime"] == "periodic" else a["regime"]
        votes = ", ".join(f"{name} {vote}" for name, vote in a["votes"].items() if vote != "none")
        swing = next(iter(a["peak_to_peak"].items()))
        rows.append((
            str(a["number"]), label, f"{100 * a['share']:.2f} +- {100 * a['share_error']:.2f} %",
            report.with_error(a["lyapunov"], a["lyapunov_error"]), f"{swing[0]} {swing[1]:.4g}", votes,
        ))  # fmt: skip
    if rows:
        columns = ("", "regime", "share of the starts", "largest exponent", "peak to peak", "votes")
        report.show(report.table("Attractors", columns, rows[:40]))
        if len(rows) > 40:
            typer.echo(f"  and {len(rows) - 40} more: --json or --out NAME.nc has them all")
    for name, one in facts["outcomes"].items():
        if one["starts"]:
            typer.echo(f"{name}: {100 * one['share']:.2f} +- {100 * one['share_error']:.2f} % of the starts, no attractor")
