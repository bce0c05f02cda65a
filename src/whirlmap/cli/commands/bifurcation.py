"""``whirlmap bifurcation``: the section of a system against one parameter."""

from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from whirlmap.cli.commands.continue_orbit import facts_of, say_branches
from whirlmap.cli.common import pictures, report
from whirlmap.cli.common.assignments import assignments
from whirlmap.cli.common.messages import choice
from whirlmap.cli.common.opening import open_system
from whirlmap.cli.common.outputs import claim
from whirlmap.cli.common.progress import Progress
from whirlmap.cli.common.states_shown import swing_of
from whirlmap.cli.common.violated import say_assumptions
from whirlmap.errors import RangeError, counted, nearest
from whirlmap.integrate.dimensions import Dimensions
from whirlmap.integrate.in_units import shown_in
from whirlmap.integrate.own_units import in_parameters, refuse_twice
from whirlmap.integrate.ranges import Range
from whirlmap.options.computed import Labelling
from whirlmap.options.execution import Execution
from whirlmap.results.memory import refuse_memory
from whirlmap.results.regime import Regime
from whirlmap.results.status import Status
from whirlmap.sweep.branches.continue_orbit import continue_orbit
from whirlmap.sweep.diagrams.hysteresis import intervals
from whirlmap.sweep.diagrams.in_batches import diagram_in_batches, expected_periods
from whirlmap.sweep.parameters.axis import Axis, is_input

if TYPE_CHECKING:
    import xarray as xr

    from whirlmap.integrate.system import System


#: Keys of the numbers of a sweep that have a unit.
MEASURED = ("lyapunov", "lyapunov_error", "end_time", "peak_to_peak", "units")
WAYS = ("up", "down", "both")


def bifurcation(
    *, case: str, vary: str, follow: str | None, branches: bool, changes: list[str] | None, start: list[str] | None,
    labelling: Labelling, execution: Execution, plot: str | None, dimensionless: bool, out: Path | None, size: str | None,
    dpi: int | None, title: str | None, force: bool, json: bool, quiet: bool,
) -> None:  # fmt: skip
    """Do what `whirlmap.cli.declared.bifurcation` says."""
    swept = Range.parse(vary)
    if follow is not None:
        choice("--follow", follow, WAYS)
    destination = claim(out, "bifurcation", force=force, size=size, dpi=dpi, title=title)
    system = open_system(case, changes, start)
    refuse_twice(system, set(assignments(changes, "--set")), swept)
    axis = Axis.of(system, swept.name, swept, "--vary")
    name, units_of_inputs = axis.name, {axis.name: axis.unit} if is_input(system, swept.name) else {}
    states = _states(system, plot)
    kept = list(system.states) if branches else states  # an orbit needs all of them
    beside = claim(out, "branches", force=force) if branches and destination.places and destination.places.folder else None

    total = swept.count * (2 if follow == "both" else 1)
    refuse_memory("the diagram", 2 * total * labelling.settling.keep * len(kept))  # at least, and before it is made
    expected = expected_periods(system, total, labelling.settling, axis.columns)
    with Progress("bifurcation", expected, quiet=quiet, points=total) as progress:
        work = diagram_in_batches(
            system, name, axis, follow=follow,  # type: ignore[arg-type]  # one of WAYS
            states=kept, labelling=labelling, execution=replace(execution, progress=progress),
        ).run(lambda done, points: progress.expect(progress.done * points / done, f"{done} of {points} points"))  # fmt: skip
    if work.dataset is None:
        raise KeyboardInterrupt
    units = Dimensions(system, own=dimensionless)
    found = _branches(system, name, axis, work.dataset, labelling, execution, quiet=quiet) if branches else None
    files = destination.write(work.dataset, lambda ds: pictures.diagram(units, ds, states, found))
    if found is not None and beside is not None:
        files += beside.write(found, lambda ds: pictures.branches(units, ds, states))
    report.say_doubts(work.dataset.attrs)
    report.say_doubts_of_branches({} if found is None else found.attrs)
    small = work.dataset.drop_vars("section")  # which would be in memory twice
    facts = summary(units, shown_in(units, small), name)
    assumptions = say_assumptions(system, {name: axis.values[[0, -1]]}, units_of_inputs)
    if json:
        own = {**summary(Dimensions(system, own=True), work.dataset, name), "assumptions": assumptions}
        there = {**facts, "sweeps": [{key: sweep[key] for key in MEASURED} for sweep in facts["sweeps"]]}
        if found is not None:
            of_branches = facts_of(system, found)
            own |= {key: of_branches[key] for key in ("branches", "doubts")}
        report.print_json({**report.beside(own, there, ("values", "sweeps", "hysteresis", "units"), units), "files": files})
    else:
        _print(facts, states[0])
        if found is not None:
            say_branches(system, found, units, states)
        report.print_written(files)
    if not work.complete:
        go_on = "the same command computes all points again"
        if follow is None and work.dataset.sizes[name] < swept.count:
            swept = swept if units_of_inputs else in_parameters(system, swept)
            go_on = f"the rest is given by --vary {swept.rest(work.done)}, and the other options as here"
        report.interrupted(facts["incomplete"], files, go_on)


def _branches(
    system: "System", name: str, axis: Axis, ds: "xr.Dataset", labelling: Labelling, execution: Execution, *, quiet: bool
) -> "xr.Dataset | None":
    """Branches of the periodic points of a diagram."""
    unit = axis.unit if is_input(system, name) else ""
    ends = [f"{end!r} {unit}".strip() for end in axis.values[[0, -1]].tolist()]
    with Progress("continue", None, quiet=quiet, unit="steps", rate_unit="steps/s") as progress:
        return continue_orbit.parts(
            system, name, ends, seeds=ds, labelling=labelling, execution=replace(execution, progress=progress)
        ).run().dataset  # fmt: skip


def _states(system: "System", plot: str | None) -> list[str]:
    if plot is None:
        return swing_of(system)
    states = [name.strip() for name in plot.split(",") if name.strip()]
    for name in states or [plot]:
        if name not in system.states:
            raise RangeError(
                f"--plot: {system.model.name} has no state {name!r}.{nearest(name, system.states)}"
                f"\n  states: {' '.join(system.states)}"
            )
    return states


def summary(units: "Dimensions", ds: "xr.Dataset", parameter: str) -> dict[str, Any]:
    """Say what a diagram holds, which is in these units, every sweep point by point."""
    system, unit = units.system, ds[parameter].attrs["units"]
    sweeps = [ds.sel(direction=d) for d in ds["direction"].values] if "direction" in ds.dims else [ds]
    return {
        "case": system.case,
        "model": system.model.name,
        "parameters": {name: value for name, value in system.values.items() if name not in ds.coords},
        "varied": parameter,
        "follow": ds.attrs["follow"],
        "values": ds[parameter].values,
        "sweeps": [_sweep(units, sweep) for sweep in sweeps],
        "hysteresis": intervals(ds, parameter) if "hysteresis" in ds else None,
        "units": {"values": unit, "hysteresis": unit},
        "incomplete": ds.attrs.get("incomplete"),
    }


def _sweep(units: "Dimensions", ds: "xr.Dataset") -> dict[str, Any]:
    return {
        "direction": str(ds["direction"].values) if "direction" in ds.coords else None,
        "regime": [Regime(int(r)).label for r in ds["regime"].values],
        "period": [int(n) or None for n in ds["period_T"].values],
        "period_common": [int(m) or None for m in ds["period_common"].values],
        "status": [Status(int(k)).name for k in ds["status"].values],
        "lyapunov": ds["lyapunov"].values,
        "lyapunov_error": ds["lyapunov_error"].values,
        "end_time": ds["end_time"].values,
        "peak_to_peak": {
            str(q): ds["peak_to_peak"].sel(quantity=q).values for q in ds["quantity"].values
        },
        "units": {
            **dict.fromkeys(("lyapunov", "lyapunov_error"), units.of("rate").unit), "end_time": units.of("time").unit,
            "peak_to_peak": {str(q): units.quantity(str(q)).unit for q in ds["quantity"].values},
        },
    }  # fmt: skip


def _print(facts: dict[str, Any], state: str) -> None:
    name, values = report.with_unit(facts["varied"], facts["units"]["values"]), facts["values"]
    typer.echo(f"{facts['case']}: {name} from {values[0]:.6g} to {values[-1]:.6g}, {counted(len(values), 'point')}")
    if facts["incomplete"]:
        typer.echo(f"incomplete: {facts['incomplete']}")
    for sweep in facts["sweeps"]:
        labels = list(map(_label, sweep["regime"], sweep["period"], sweep["status"]))
        regimes = ", ".join(f"{count} {label}" for label, count in Counter(labels).most_common(8))
        where = f"sweep {sweep['direction']}" if sweep["direction"] else "points"
        typer.echo(f"{where}: {regimes}")
        rows = [
            (f"{values[a]:.6g}", f"{values[b]:.6g}", b - a + 1, labels[a], _largest(sweep, a, b), _swing(sweep, state, a, b))
            for a, b in _stretches(labels)
        ]
        title = f"Regimes, {where}" if sweep["direction"] else "Regimes"
        units = sweep["units"]
        exponent = report.with_unit("largest exponent", units["lyapunov"])
        swing = report.with_unit(f"largest peak to peak of {state}", units["peak_to_peak"][state])
        columns = (f"{name} from", "to", "points", "regime", exponent, swing)
        report.show(report.table(title, columns, rows[:60], numbers=(0, 1, 2, 5)))
        if len(rows) > 60:
            typer.echo(f"  and {len(rows) - 60} more stretches: --json or --out NAME.nc has them all")
    if facts["hysteresis"] is not None:
        found = [f"{a:.6g} to {b:.6g}" if b > a else f"{a:.6g}" for a, b in facts["hysteresis"]]
        typer.echo(f"hysteresis: up and down differ at {name} = {', '.join(found)}" if found else "hysteresis: none seen")


def _label(regime: str, period: int | None, status: str) -> str:
    if status in ("unresolved", "failed"):
        return status
    return f"periodic, {period}T" if regime == "periodic" else regime


def _largest(sweep: dict[str, Any], first: int, last: int) -> str:
    measured = [v for v in sweep["lyapunov"][first : last + 1] if v == v]
    some = f" of {counted(len(measured), 'point')}" if len(measured) < last - first + 1 else ""
    return f"{min(measured):.3g} to {max(measured):.3g}{some}" if measured else "-"


def _swing(sweep: dict[str, Any], state: str, first: int, last: int) -> str:
    measured = [v for v in sweep["peak_to_peak"][state][first : last + 1] if v == v]
    return f"{max(measured):.4g}" if measured else "-"


def _stretches(labels: list[str]) -> list[tuple[int, int]]:
    starts = [i for i in range(len(labels)) if i == 0 or labels[i] != labels[i - 1]]
    return list(zip(starts, [s - 1 for s in starts[1:]] + [len(labels) - 1], strict=True))
