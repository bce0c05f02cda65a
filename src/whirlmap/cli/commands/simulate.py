"""``whirlmap simulate``: the time series of one operating point."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from whirlmap.cli.common import figures_of_commands as pictures
from whirlmap.cli.common import options, report
from whirlmap.cli.common.messages import say
from whirlmap.cli.common.outputs import claim, write_all
from whirlmap.cli.common.progress import Progress
from whirlmap.errors import InputError
from whirlmap.options.computed import INTEGRATION, Integration
from whirlmap.options.execution import EXECUTION, Execution

if TYPE_CHECKING:
    import xarray as xr

    from whirlmap.integrate.dimensions import Dimensions

#: Keys of the numbers of a motion, and of times, that have a unit.
MOTION, TIMES = ("minimum", "maximum", "mean", "rms", "last"), ("end_time", "period", "common_period", "time")

EXAMPLES = (
    "whirlmap simulate duffing",
    "whirlmap simulate duffing --set gamma=0.29 --start x=0.5 --transient 100 --out run.png",
    "whirlmap simulate machines/jeffcott-rig --transient 100 --animate orbit.gif",
    'whirlmap simulate gear-psfd/machine --set "speed=1500 rpm" --periods 10 --every 5 --out run.nc',
)


@options.computing(*options.INTEGRATION, "workers")
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
    integration: Integration = INTEGRATION,
    execution: Execution = EXECUTION,
    animate: Annotated[
        Path | None,
        typer.Option(
            "--animate", metavar="NAME.gif", rich_help_panel=options.OUTPUT,
            help="Write two seconds of the orbit as it moves: the last 4 T, or two turns of a slower shaft; with --periods"
            " all that is recorded.",
        ),
    ] = None,
    dimensionless: options.Dimensionless = False,
    out: options.Out = None,
    size: options.Size = None,
    dpi: options.Dpi = None,
    title: options.Title = None,
    force: options.Force = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> None:  # fmt: skip
    """Integrate one operating point of CASE and report the range of each state and output.

    T is the period of the fastest forcing; `whirlmap show` says how many of them a turn of each clock takes. Ctrl-C keeps
    what was recorded until then. --out NAME.csv writes time, states and outputs as a table. A case with dimensions is shown
    in um, mm/s, N and s.
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
    from whirlmap.integrate.dimensions import Dimensions
    from whirlmap.integrate.in_units import shown_in
    from whirlmap.sweep.diagrams.in_batches import simulation_in_stretches

    with Progress("simulate", None, quiet=quiet) as progress:
        work = simulation_in_stretches(
            system, periods=periods, transient=transient, every=every, integration=integration,
            execution=replace(execution, progress=progress),
        ).run()  # fmt: skip
    if work.dataset is None:
        raise KeyboardInterrupt
    units = Dimensions(system, own=dimensionless)
    shown = shown_in(units, work.dataset)
    files = destination.write(work.dataset, lambda _: pictures.simulation(system, shown))
    if table is not None:
        files += write_all([(table, lambda place: write_series(shown, place, force=force))])
    if animate is not None:
        files += write_all(
            [(animate, lambda place: pictures.animation(
                units, shown, place, looks=destination.looks, turns=periods, force=force))]
        )  # fmt: skip
    report.say_doubts(work.dataset.attrs)
    facts = summary(units, shown)
    if json:
        own = summary(Dimensions(system, own=True), work.dataset)
        report.print_json({**report.beside(own, facts, (*TIMES, "motion", "units"), units), "files": files})
    else:
        _print(facts)
        report.print_written(files)
    if not work.complete:
        rest = f"--transient {transient + work.done} --periods {work.total - work.done}"
        report.interrupted(facts["incomplete"], files, f"the same command with {rest} gives what is missing")
    clock = facts["units"]["time"]
    if facts["status"] not in ("ok", "contact", "diverged"):
        say(f"the run was not finished: {facts['status']} at time {facts['end_time']:.9g}{report.unit_behind(clock)}")
        raise typer.Exit(1)  # those three are motions of the machine; anything else is a run that could not go on


def summary(units: "Dimensions", ds: "xr.Dataset") -> dict[str, Any]:
    """Say what a time series holds, which is in these units."""
    from whirlmap.results.status import Status

    system, clock = units.system, units.of("time")
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
        "period": system.period * clock.size,
        "common_period": system.common_period * clock.size if system.repeats else None,
        "samples": ds.sizes["time"],
        "time": [float(ds["time"][0]), float(ds["time"][-1])],
        "motion": {
            name: {
                "minimum": float(v.min()), "maximum": float(v.max()), "mean": float(v.mean()),
                "rms": float(v.std()), "last": float(v[-1]), "units": dict.fromkeys(MOTION, units.quantity(name).unit),
            }
            for name, v in series.items()
        },
        "units": dict.fromkeys(TIMES, clock.unit),
        "incomplete": ds.attrs.get("incomplete"),
    }  # fmt: skip


def _print(facts: dict[str, Any]) -> None:
    from whirlmap.results.status import Status

    begin, end = facts["time"]
    unit = report.unit_behind(facts["units"]["time"])
    typer.echo(f"{facts['case']}: {facts['samples']} samples from time {begin:.6g} to {end:.6g}{unit}")
    common = facts["common_period"]
    repeats = f"{common:.7g}{unit}" if common is not None else "-"
    typer.echo(f"period T = {facts['period']:.7g}{unit}, common period = {repeats}")
    status = Status[facts["status"]]
    if facts["incomplete"]:
        typer.echo(f"incomplete: {facts['incomplete']}")
    elif status == Status.ok:
        typer.echo("status: ok, ran to its end")
    else:
        typer.echo(f"status: {status.name} at time {facts['end_time']:.9g}{unit}: {status.sentence}")
    if not facts["start_found"]:
        typer.echo("note: there is no static equilibrium; the run began beside the clearance centre")
    columns = ("", "minimum", "maximum", "mean", "rms about mean", "last")
    rows = [(report.with_unit(name, m["units"]["mean"]), *(m[key] for key in MOTION)) for name, m in facts["motion"].items()]
    report.show(report.table("Motion", columns, rows, numbers=range(1, 6)))
