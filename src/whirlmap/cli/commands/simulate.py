"""``whirlmap simulate``: the time series of one operating point."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import typer

from whirlmap.cli.commands.run_up import run_up
from whirlmap.cli.common import pictures, report
from whirlmap.cli.common.messages import say
from whirlmap.cli.common.opening import open_system
from whirlmap.cli.common.outputs import claim, write_all
from whirlmap.cli.common.progress import Progress
from whirlmap.errors import InputError, counted
from whirlmap.integrate.dimensions import Dimensions
from whirlmap.integrate.in_units import shown_in
from whirlmap.options.computed import Integration
from whirlmap.options.execution import Execution
from whirlmap.results.files import check_writable
from whirlmap.results.signals import write_series
from whirlmap.results.status import Status
from whirlmap.sweep.diagrams.runs_in_parts import simulation_in_stretches

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray


#: Keys of the numbers of a motion, and of times, that have a unit.
MOTION, TIMES = ("minimum", "maximum", "mean", "rms", "last"), ("end_time", "period", "common_period", "time")


def simulate(
    *, case: str, changes: list[str] | None, start: list[str] | None, periods: int | None, transient: int, every: int,
    vary: str | None, time: str | None, diagram: Path | None,
    integration: Integration, execution: Execution, animate: Path | None, dimensionless: bool, out: Path | None,
    size: str | None, dpi: int | None, title: str | None, force: bool, json: bool, quiet: bool,
) -> None:  # fmt: skip
    """Do what `whirlmap.cli.declared.simulate` says."""
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
    system = open_system(case, changes, start)
    if vary is not None:
        often = None if every == 1 else every
        given = {"--periods": periods, "--animate": animate, "--every": often, "--out NAME.csv": table}
        for name, value in given.items():
            if value is not None:
                raise InputError(f"{name}: found it with --vary, expected one of them")
        if time is None:
            raise InputError('--vary: found it without --time, expected how long the run takes, as in --time "20 s"')
        run_up(
            system, vary=vary, time=time, transient=transient, integration=integration, execution=execution,
            diagram=diagram, dimensionless=dimensionless, destination=destination, json=json, quiet=quiet,
        )  # fmt: skip
        return
    for name, only in {"--time": time, "--diagram": diagram}.items():
        if only is not None:
            raise InputError(f"{name}: found it without --vary, expected both, as in --vary speed=BEGIN:END --time TIME")

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
    system, clock = units.system, units.of("time")
    series = {**dict(zip(ds["state"].values.tolist(), ds["x"].values.T, strict=True)),
              **dict(zip(ds["output"].values.tolist(), ds["outputs"].values.T, strict=True))}  # fmt: skip
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
            name: {**_numbers(v), "units": dict.fromkeys(MOTION, units.quantity(name).unit)}
            for name, v in series.items()
        },
        "units": dict.fromkeys(TIMES, clock.unit),
        "incomplete": ds.attrs.get("incomplete"),
    }  # fmt: skip


def _numbers(samples: "NDArray[np.float64]") -> dict[str, float]:
    """Numbers of one quantity's samples; those behind the end of a run are NaN, and count as the last one only."""
    ran = samples[np.isfinite(samples)]  # contiguous too, where a column of the record is not: it is read faster
    found = (ran.min(), ran.max(), ran.mean(), ran.std()) if ran.size else (np.nan,) * 4
    return dict(zip(MOTION, map(float, (*found, samples[-1])), strict=True))


def _print(facts: dict[str, Any]) -> None:
    begin, end = facts["time"]
    unit = report.unit_behind(facts["units"]["time"])
    typer.echo(f"{facts['case']}: {counted(facts['samples'], 'sample')} from time {begin:.6g} to {end:.6g}{unit}")
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
