"""``whirlmap simulate``: the time series of one operating point."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from whirlmap.cli import options, pictures, report
from whirlmap.cli.messages import say
from whirlmap.cli.outputs import claim, write_all
from whirlmap.cli.progress import Progress
from whirlmap.errors import InputError

if TYPE_CHECKING:
    import xarray as xr

    from whirlmap.integrate.system import System

EXAMPLES = (
    "whirlmap simulate duffing",
    "whirlmap simulate duffing --set gamma=0.29 --start x=0.5 --transient 100 --out run.png",
    "whirlmap simulate machines/jeffcott-rig --transient 100 --animate orbit.gif",
    'whirlmap simulate gear-psfd/machine --set "speed=1500 rpm" --periods 10 --every 5 --out run.nc',
)


def simulate(
    case: options.CaseName,
    changes: options.Changes = None,
    start: options.Start = None,
    periods: Annotated[
        int | None,
        typer.Option(
            "--periods", metavar="N", rich_help_panel=options.COMPUTING,
            help="Periods T recorded (unforced models: typical times); 20 turns of the slowest clock where absent.",
        ),
    ] = None,
    transient: Annotated[
        int,
        typer.Option(
            "--transient", metavar="N", help="Periods T dropped.", rich_help_panel=options.COMPUTING
        ),
    ] = 0,
    every: Annotated[
        int,
        typer.Option(
            "--every", metavar="N", help="Steps between samples.", rich_help_panel=options.COMPUTING
        ),
    ] = 1,
    steps: options.Steps = None,
    accuracy: options.Accuracy = None,
    method: options.Method = None,
    workers: options.Workers = None,
    animate: Annotated[
        Path | None,
        typer.Option(
            "--animate", metavar="NAME.gif", rich_help_panel=options.OUTPUT,
            help="Write two seconds of the orbit as it moves: the last 4 T, or two turns of a slower shaft; with --periods"
            " all that is recorded.",
        ),
    ] = None,
    out: options.Out = None,
    size: options.Size = None,
    dpi: options.Dpi = None,
    title: options.Title = None,
    force: options.Force = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> None:  # fmt: skip
    """Integrate one operating point of CASE and report how each state and output moves.

    T is the period of the fastest forcing; `whirlmap show` says how many of them a turn of each clock takes. Ctrl-C keeps
    what was recorded until then. --out NAME.csv writes time, states and outputs as a table.
    """
    from whirlmap.results.files import check_writable
    from whirlmap.results.signals import write_series

    table = out if out is not None and out.suffix.lower() == ".csv" else None
    if table is not None:
        check_writable(table, force=force)
    if animate is not None:
        if animate.suffix.lower() != ".gif":
            raise InputError(f"--animate: found {animate}, expected a name that ends in .gif")
        check_writable(animate, force=force)
    destination = claim(
        None if table else out, "simulate", force=force, size=size, dpi=dpi, title=title, animated=animate is not None
    )
    system = options.open_system(case, changes, start)
    from whirlmap.analysis.record_length import shown_periods
    from whirlmap.analysis.trajectory import SAMPLES
    from whirlmap.sweep.run import simulation_in_stretches

    total = (shown_periods(system, max(SAMPLES // max(every, 1), 1)) if periods is None else periods) + transient
    with Progress("simulate", max(total, 1), quiet=quiet) as progress:
        work = simulation_in_stretches(
            system, periods=periods, transient=transient, every=every, steps=steps, accuracy=accuracy, method=method,
            workers=workers, progress=progress,
        )  # fmt: skip
    if work.dataset is None:
        raise KeyboardInterrupt
    files = destination.write(work.dataset, lambda ds: pictures.simulation(system, ds))
    if table is not None:
        made = work.dataset
        files += write_all([(table, lambda place: write_series(made, place, force=force))])
    if animate is not None:
        moved = work.dataset
        files += write_all(
            [(animate, lambda place: pictures.animation(
                system, moved, place, looks=destination.looks, turns=periods, force=force))]
        )  # fmt: skip
    report.say_doubts(work.dataset.attrs)
    facts = summary(system, work.dataset)
    if json:
        report.print_json({**facts, "files": files})
    else:
        _print(facts)
        report.print_written(files)
    if not work.complete:
        say(f"interrupted after {work.done} of {work.total} T; these were kept")
        raise typer.Exit(130)
    if facts["status"] not in ("ok", "contact", "diverged"):
        say(f"the run was not finished: {facts['status']} at time {facts['end_time']:.9g}")
        raise typer.Exit(1)  # those three are motions of the machine; anything else is a run that could not go on


def summary(system: "System", ds: "xr.Dataset") -> dict[str, Any]:
    """Say what a time series holds."""
    from whirlmap.results.status import Status

    series = {**{str(s): ds["x"].sel(state=s) for s in ds["state"].values},
              **{str(o): ds["outputs"].sel(output=o) for o in ds["output"].values}}  # fmt: skip
    return {
        "case": system.case,
        "model": system.model.name,
        "parameters": dict(system.values),
        "status": Status(int(ds["status"])).name,
        "end_time": float(ds["end_time"]),
        "stop": ds.attrs.get("stop"),
        "start_found": bool(ds["start_found"]),
        "period": system.period,
        "common_period": system.common_period if system.repeats else None,
        "samples": ds.sizes["time"],
        "time": [float(ds["time"][0]), float(ds["time"][-1])],
        "motion": {
            name: {
                "minimum": float(v.min()), "maximum": float(v.max()), "mean": float(v.mean()),
                "rms": float(v.std()), "last": float(v[-1]),
            }
            for name, v in series.items()
        },
        "incomplete": ds.attrs.get("incomplete"),
    }  # fmt: skip


def _print(facts: dict[str, Any]) -> None:
    from whirlmap.results.status import Status

    begin, end = facts["time"]
    typer.echo(f"{facts['case']}: {facts['samples']} samples from time {begin:.6g} to {end:.6g}")
    typer.echo(f"period T = {facts['period']:.7g}, common period = {report.number(facts['common_period'])}")
    status = Status[facts["status"]]
    if status == Status.ok:
        typer.echo("status: ok, ran to its end")
    else:
        typer.echo(f"status: {status.name} at time {facts['end_time']:.9g}: {status.sentence}")
    if not facts["start_found"]:
        typer.echo("note: there is no static equilibrium; the run began beside the clearance centre")
    columns = ("", "minimum", "maximum", "mean", "rms about mean", "last")
    rows = [(name, m["minimum"], m["maximum"], m["mean"], m["rms"], m["last"]) for name, m in facts["motion"].items()]
    report.show(report.table("Motion", columns, rows, numbers=range(1, 6)))
