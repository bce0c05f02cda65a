"""``whirlmap simulate --vary``: a run-up or coast-down in time."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import typer
import xarray as xr

from whirlmap.analysis.simulation.ramp import ramp_of
from whirlmap.analysis.simulation.run_up import Running
from whirlmap.cli.common import pictures, report
from whirlmap.cli.common.outputs import Destination
from whirlmap.cli.common.progress import Progress
from whirlmap.cli.common.states_shown import swing_of
from whirlmap.errors import InputError
from whirlmap.integrate.dimensions import Dimensions
from whirlmap.integrate.in_units import shown_in
from whirlmap.integrate.system import System
from whirlmap.options.computed import Integration
from whirlmap.options.execution import Execution
from whirlmap.results.status import Status
from whirlmap.sweep.diagrams.runs_in_parts import run_up_in_windows

#: Windows that the table shows.
ROWS = 20


def ends_of(vary: str) -> tuple[str, str, str]:
    """Name and both speeds of ``name=begin:end``."""
    name, equals, rest = (part.strip() for part in vary.partition("="))
    ends = [part.strip() for part in rest.split(":")]
    if not (name and equals) or len(ends) != 2 or not all(ends):
        raise InputError(f'--vary: found {vary!r}, expected name=begin:end, as in "speed=3000 rpm:9000 rpm"')
    return name, ends[0], ends[1]


def run_up(
    system: System, *, vary: str, time: str, transient: int, integration: Integration, execution: Execution,
    diagram: Path | None, dimensionless: bool, destination: Destination, json: bool, quiet: bool,
) -> None:  # fmt: skip
    """Compute, print and write a run-up."""
    name, begin, end = ends_of(vary)
    behind = None if diagram is None else _read(diagram)
    with Progress("simulate", None, quiet=quiet) as progress:
        ramp, execution = ramp_of(system, name, begin, end, time), replace(execution, progress=progress)
        work = run_up_in_windows(Running(system, ramp, transient, None, integration, execution)).run()
    if work.dataset is None:
        raise KeyboardInterrupt
    ds = work.dataset
    units = Dimensions(system, own=dimensionless)
    shown = shown_in(units, ds)
    beside = None if behind is None else shown_in(units, behind)
    files = destination.write(ds, lambda _: pictures.run_up(system, shown, beside))
    facts = summary(system, shown)
    if json:
        report.print_json({**facts, "files": files})
    else:
        _print(system, shown, facts)
        report.print_written(files)
    if not work.complete:
        report.interrupted(facts["incomplete"], files, "the same command runs the machine up again from the first speed")
    if facts["status"] not in ("ok", "contact", "diverged"):
        raise typer.Exit(1)


def _read(path: Path) -> xr.Dataset:
    if not path.is_file():
        raise InputError(f"--diagram: found no file {path}, expected a Dataset that bifurcation wrote")
    ds = xr.load_dataset(path)
    if "regime" not in ds:
        raise InputError(f"--diagram: found no regimes in {path}, expected a Dataset that bifurcation wrote")
    return ds


def summary(system: System, ds: xr.Dataset) -> dict[str, Any]:
    """Say what a run-up holds, in the units of the Dataset."""
    speed, quantity = str(ds.attrs["varied"]), swing_of(system)[0]
    of = ds.sel(quantity=quantity)
    highest = of["maximum"] - of["minimum"]
    known = bool(np.isfinite(highest).any())
    return {
        "case": system.case, "model": system.model.name, "varied": speed, "status": Status(int(ds["status"])).name,
        "speeds": [float(ds[speed][0]), float(ds[speed][-1])], "speed_unit": ds[speed].attrs["units"],
        "windows": ds.sizes[speed], "elapsed": float(ds["elapsed"][-1]), "elapsed_unit": ds["elapsed"].attrs["units"],
        "end_speed": float(ds["end_speed"]), "stop": ds.attrs.get("stop"), "quantity": quantity,
        "largest": float(np.nanmax(highest.values)) if known else None,
        "largest_at": float(ds[speed][int(np.nanargmax(highest.values))]) if known else None,
        "start_found": bool(ds["start_found"]), "incomplete": ds.attrs.get("incomplete"),
    }  # fmt: skip


def _print(system: System, ds: xr.Dataset, facts: dict[str, Any]) -> None:
    speed, quantity = facts["varied"], facts["quantity"]
    of, clocks = ds.sel(quantity=quantity), [str(c) for c in ds["clock"].values]
    each = str(ds["maximum"].attrs.get("unit_of_each", "")).split()
    unit = each[ds["quantity"].values.tolist().index(quantity)] if each else "1"
    behind = report.unit_behind(facts["elapsed_unit"])
    begin, end = facts["speeds"]
    rpm = report.unit_behind(facts["speed_unit"])
    length = f"{facts['elapsed']:.4g}{behind}"
    typer.echo(f"{system.case}: {facts['windows']} windows from {begin:.5g} to {end:.5g}{rpm} in {length}")
    status = Status[facts["status"]]
    if facts["incomplete"]:
        typer.echo(f"incomplete: {facts['incomplete']}")
    elif status == Status.ok:
        typer.echo("status: ok, ran to its end")
    else:
        typer.echo(f"status: {status.name} at {facts['end_speed']:.6g}{rpm}: {status.sentence}")
    if facts["largest"] is not None:
        of_what, at = report.with_unit(quantity, unit), f"{facts['largest_at']:.5g}{rpm}"
        typer.echo(f"largest peak to peak of {of_what}: {facts['largest']:.5g} at {at}")
    columns = (report.with_unit(speed, facts["speed_unit"]), "minimum", "maximum", *(f"{c}, amplitude" for c in clocks),
               *(f"{c}, phase [deg]" for c in clocks))  # fmt: skip
    chosen = np.unique(np.linspace(0, ds.sizes[speed] - 1, min(ROWS, ds.sizes[speed])).round().astype(int))
    rows = [
        (
            float(ds[speed][i]), float(of["minimum"][i]), float(of["maximum"][i]),
            *(float(of["clock_amplitude"][i].sel(clock=c)) for c in clocks),
            *(float(np.degrees(of["clock_phase"][i].sel(clock=c))) for c in clocks),
        )
        for i in chosen
    ]  # fmt: skip
    report.show(report.table(f"Run of {report.with_unit(quantity, unit)}", columns, rows, numbers=range(len(columns))))
