"""``whirlmap continue``: branches of periodic orbits and equilibria, and curves of their bifurcations."""

from collections import Counter
from dataclasses import replace
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import typer

from whirlmap.cli.common import pictures, report
from whirlmap.cli.common.assignments import assignments
from whirlmap.cli.common.messages import choice, say
from whirlmap.cli.common.opening import open_system
from whirlmap.cli.common.outputs import claim
from whirlmap.cli.common.progress import Progress
from whirlmap.cli.common.states_shown import swing_of
from whirlmap.cli.common.violated import say_assumptions
from whirlmap.errors import InputError, RangeError, nearest
from whirlmap.integrate.dimensions import Dimensions
from whirlmap.integrate.in_units import shown_in
from whirlmap.integrate.own_units import in_state, refuse_twice
from whirlmap.integrate.ranges import Range, number_and_unit
from whirlmap.integrate.system import System
from whirlmap.options.computed import Labelling
from whirlmap.options.execution import Execution
from whirlmap.sweep.branches.branch_dataset import events_of, word
from whirlmap.sweep.branches.continue_orbit import continue_orbit as follow
from whirlmap.sweep.parameters.axis import is_input

if TYPE_CHECKING:
    import xarray as xr

WAYS = ("up", "down", "both")
#: Multipliers of an event that its table shows.
SHOWN = 3


def continue_orbit(
    *, case: str, vary: list[str], begin: str | None, period: int | None, orbit: str | None, seeds: str | None,
    coexisting: bool, starts: int, direction: str, doublings: int, event: str | None, near: str | None, points: int,
    longest: float, plot: str | None, changes: list[str] | None, start: list[str] | None, labelling: Labelling,
    execution: Execution, dimensionless: bool, out: Path | None, size: str | None, dpi: int | None, title: str | None,
    force: bool, json: bool, quiet: bool,
) -> None:  # fmt: skip
    """Do what `whirlmap.cli.declared.continue_orbit` says."""
    choice("--direction", direction, WAYS)
    if event is not None or near is not None or len(vary) > 1:
        raise InputError("--event: curves of events in two parameters are not built yet: give one --vary")
    name, ends = _range(vary[0])
    destination = claim(out, "branches", force=force, size=size, dpi=dpi, title=title)
    system = open_system(case, changes, start)
    refuse_twice(system, set(assignments(changes, "--set")), Range(name, 0.0, 1.0, 2))
    quantities = _quantities(system, plot)
    given = None if orbit is None else _state(system, orbit)
    known = None if seeds is None else _opened(seeds)

    with Progress("continue", None, quiet=quiet, unit="steps", rate_unit="steps/s") as progress:
        work = follow.parts(
            system, name, ends, begin=begin, period=period, orbit=given, seeds=known, coexisting=coexisting, starts=starts,
            direction=direction, doublings=doublings, points=points, longest=longest, labelling=labelling,  # type: ignore[arg-type]
            execution=replace(execution, progress=progress),
        ).run(lambda done, total: progress.expect(max(total, progress.done), f"{done} points"))  # fmt: skip
    if work.dataset is None:
        raise KeyboardInterrupt
    ds, units = work.dataset, Dimensions(system, own=dimensionless)
    files = destination.write(ds, lambda made: pictures.branches(units, made, quantities))
    if doubts := ds.attrs.get("doubts"):
        say(f"warning: {doubts}")
    varied = str(ds.attrs["varied"])
    inputs = {varied: str(ds[varied].attrs["units"])} if is_input(system, varied) else {}
    reached = {varied: np.array([ds[varied].values.min(), ds[varied].values.max()])}
    assumptions = say_assumptions(system, reached, inputs)
    if json:
        report.print_json({**facts_of(system, ds, units), "assumptions": assumptions, "files": files})
    else:
        _print(system, ds, units, quantities)
        report.print_written(files)
    if not work.complete:
        report.interrupted(str(ds.attrs["incomplete"]), files, "the same command follows the branches again")


def _range(text: str) -> tuple[str, str]:
    name, equals, ends = (part.strip() for part in text.partition("="))
    if not (name and equals and ends):
        raise InputError(f"--vary: found {text!r}, expected NAME=START:STOP, as in Omega=0.5:1.6")
    return name, ends


def _quantities(system: System, plot: str | None) -> list[str]:
    if plot is None:
        return swing_of(system)[:4]
    known = [*system.states, *system.model.outputs]
    names = [name.strip() for name in plot.split(",") if name.strip()]
    for name in names or [plot]:
        if name not in known:
            raise RangeError(f"--plot: {system.model.name} has no state or output {name!r}.{nearest(name, known)}")
    return names


def _state(system: System, text: str) -> dict[str, float]:
    """A state near an orbit, as ``x=0.5,v=0``."""
    found = {}
    for name, value in assignments(text.split(","), "--orbit").items():
        number, unit = number_and_unit(value)
        found[name] = in_state(system, name, number, unit, "--orbit")
    return found


def _opened(place: str) -> "xr.Dataset":
    import xarray as xr

    path = Path(place).expanduser()
    if not path.exists():
        raise InputError(f"--seeds: there is no file or folder {place}")
    try:
        return xr.open_zarr(path) if path.is_dir() else xr.load_dataset(path)
    except (OSError, ValueError, KeyError) as error:
        raise InputError(f"--seeds: {place} is no Dataset or store that can be read: {error}") from None


def facts_of(system: System, ds: "xr.Dataset", units: Dimensions) -> dict[str, Any]:
    """Say what branches hold; the varied parameter as it was given."""
    varied, size = str(ds.attrs["varied"]), float(ds.attrs["size_given"])
    events, at = events_of(ds), ds[varied].values / size
    unit = str(ds.attrs["unit_given"]) or "1"
    of = ds["branch_of"].values
    branches = []
    for k, number in enumerate(ds["branch"].values.tolist()):
        here = of == number
        mine = np.flatnonzero(events["branch"].values == number)
        period = int(ds["period_T"].values[k]) or None
        section = ds["section"].values[here][:, 0]
        branches.append(
            {
                "kind": word(ds, "kind", ds["kind"].values[k]),
                "period": period,
                "points": [
                    {"value": value, "state": dict(zip(system.states, x, strict=True))}
                    for value, x in zip(at[here], section.tolist(), strict=True)
                ],
                "stable": [bool(s) for s in ds["stable"].values[here]],
                "unstable": ds["unstable"].values[here],
                "peak_to_peak": {
                    str(q): ds["peak_to_peak"].sel(quantity=q).values[here] for q in ds["quantity"].values
                },
                "events": [_event(system, ds, events, i, size, unit, period) for i in mine],
                "ends": [word(ds, "end", e) for e in ds["end"].values[k]],
            }
        )  # fmt: skip
    return {
        "case": system.case,
        "model": system.model.name,
        "parameters": {name: value for name, value in system.values.items() if name not in ds.coords},
        "varied": ds.attrs["given"],
        "unit": unit,
        "branches": branches,
        "units": {"peak_to_peak": {str(q): units.quantity(str(q)).unit for q in ds["quantity"].values}}
        if not units.known else {},
        "doubts": ds.attrs.get("doubts"),
        "incomplete": ds.attrs.get("incomplete"),
    }  # fmt: skip


def _event(
    system: System, ds: "xr.Dataset", events: "xr.Dataset", i: int, size: float, unit: str, period: int | None
) -> dict[str, Any]:
    varied = str(ds.attrs["varied"])
    return {
        "kind": word(ds, "event_kind", events["kind"].values[i]),
        "value": float(events[varied].values[i]) / size,
        "unit": unit,
        "state": dict(zip(system.states, events["section"].values[i].tolist(), strict=True)),
        "multipliers": [[m.real, m.imag] for m in _multipliers(events, i)],
        "period": period,
        "surface": str(events["surface"].values[i]) or None,
    }


def _multipliers(events: "xr.Dataset", i: int) -> list[complex]:
    logs, angles = events["log_modulus"].values[i], events["argument"].values[i]
    return [complex(np.exp(a) * np.cos(b), np.exp(a) * np.sin(b)) for a, b in zip(logs, angles, strict=True) if not np.isnan(a)]


def _print(system: System, ds: "xr.Dataset", units: Dimensions, quantities: list[str]) -> None:
    """Print a table of the branches, and one of their events."""
    shown, varied = shown_in(units, ds), str(ds.attrs["varied"])
    size, unit = float(ds.attrs["size_given"]), str(ds.attrs["unit_given"]) or "1"
    name, at, of = str(ds.attrs["given"]), ds[varied].values / size, ds["branch_of"].values
    typer.echo(f"{system.case}: {ds.sizes['branch']} branch{'es' if ds.sizes['branch'] != 1 else ''}, {at.size} points")
    if incomplete := ds.attrs.get("incomplete"):
        typer.echo(f"incomplete: {incomplete}")
    first = quantities[0]
    swing = shown["peak_to_peak"].sel(quantity=first).values
    said = str(shown["peak_to_peak"].attrs.get("unit_of_each", "")).split()
    swing_unit = said[[str(q) for q in ds["quantity"].values].index(first)] if said else "1"
    rows = []
    for k, number in enumerate(ds["branch"].values.tolist()):
        here = of == number
        kind, n = word(ds, "kind", ds["kind"].values[k]), int(ds["period_T"].values[k])
        label = kind if kind == "equilibrium" else f"{kind}, {n}T" if kind == "orbit" else f"cycle, {n} crossings"
        stable = int(ds["stable"].values[here].sum())
        ends = " and ".join(word(ds, "end", e) for e in ds["end"].values[k])
        rows.append((
            str(number), label, f"{at[here].min():.6g}", f"{at[here].max():.6g}", int(here.sum()), stable,
            f"{np.nanmax(swing[here]):.4g}", ends,
        ))  # fmt: skip
    columns = (
        "", "kind", report.with_unit(f"{name} from", unit), "to", "points", "stable",
        report.with_unit(f"largest peak to peak of {first}", swing_unit), "ends",
    )  # fmt: skip
    report.show(report.table("Branches", columns, rows, numbers=(2, 3, 4, 5, 6)))
    _print_events(system, ds, name, unit, size)


def _print_events(system: System, ds: "xr.Dataset", name: str, unit: str, size: float) -> None:
    events, varied = events_of(ds), str(ds.attrs["varied"])
    if not events.sizes["event"]:
        typer.echo("no bifurcation on the way")
        return
    rows = []
    for i in range(events.sizes["event"]):
        kind, surface = word(ds, "event_kind", events["kind"].values[i]), str(events["surface"].values[i])
        critical = sorted(_multipliers(events, i), key=lambda m: abs(abs(m) - 1) if abs(m) else np.inf)[:SHOWN]
        rows.append((
            str(int(events["branch"].values[i])), kind + (f" of {surface}" if surface else ""),
            f"{float(events[varied].values[i]) / size:.12g}", ", ".join(_written(m) for m in critical),
        ))  # fmt: skip
    title = "Events: " + ", ".join(f"{count} {kind}" for kind, count in Counter(r[1] for r in rows).items())
    columns = ("branch", "kind", report.with_unit(name, unit), "multipliers nearest to the circle")
    report.show(report.table(title, columns, rows[:60], numbers=(2,)))
    if len(rows) > 60:
        typer.echo(f"  and {len(rows) - 60} more: --json or --out NAME.nc has them all")


def _written(m: complex) -> str:
    """A multiplier in five digits."""
    if not isfinite(m.real):
        return "-"
    return f"{m.real:.5g}" if abs(m.imag) < 1e-9 * abs(m) else f"{m.real:.5g}{m.imag:+.5g}i"
