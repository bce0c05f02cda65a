"""``whirlmap continue``: branches of periodic orbits and equilibria, and curves of their bifurcations."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import cos, exp, sin
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import typer

from whirlmap.analysis.branches.tracing import ENDS
from whirlmap.cli.common import pictures, report
from whirlmap.cli.common.assignments import assignments
from whirlmap.cli.common.messages import choice
from whirlmap.cli.common.opening import open_system
from whirlmap.cli.common.outputs import claim
from whirlmap.cli.common.progress import Progress
from whirlmap.cli.common.states_shown import swing_of
from whirlmap.cli.common.violated import say_assumptions
from whirlmap.errors import InputError, RangeError, counted, nearest
from whirlmap.integrate.dimensions import Dimensions
from whirlmap.integrate.in_units import shown_in
from whirlmap.integrate.own_units import in_state, refuse_twice
from whirlmap.integrate.ranges import Range, number_and_unit
from whirlmap.integrate.system import System
from whirlmap.options.computed import Labelling
from whirlmap.options.execution import Execution
from whirlmap.sweep.branches.branch_dataset import events_of, word
from whirlmap.sweep.branches.continue_orbit import continue_orbit as follow
from whirlmap.sweep.branches.event_curve import KINDS, event_curve
from whirlmap.sweep.parameters.axis import is_input

if TYPE_CHECKING:
    import xarray as xr

WAYS = ("up", "down", "both")
#: Multipliers of an event that its table shows.
SHOWN = 3


def continue_orbit(
    *, case: str, vary: list[str], begin: str | None, period: int | None, orbit: str | None, seeds: str | None,
    coexisting: bool, starts: int, direction: str, doublings: int, event: str | None, near: str | None, points: int,
    longest: float, resume: bool, plot: str | None, changes: list[str] | None, start: list[str] | None, labelling: Labelling,
    execution: Execution, dimensionless: bool, out: Path | None, size: str | None, dpi: int | None, title: str | None,
    force: bool, json: bool, quiet: bool,
) -> None:  # fmt: skip
    """Do what `whirlmap.cli.declared.continue_orbit` says."""
    choice("--direction", direction, WAYS)
    free = dict(map(_range, vary))
    if event is not None:
        choice("--event", event, KINDS)
        beside = {"--all": coexisting, "--seeds": seeds, "--doublings": doublings, "--plot": plot}
        _refuse("--event", {**beside, "--direction": direction != "both"})
    elif near is not None or len(vary) > 1:
        found = "--near" if near is not None else "two --vary"
        raise InputError(f"{found}: expected --event beside it, for the curve of an event in two parameters")
    if len(free) != len(vary) or len(vary) != (2 if event else 1):
        raise InputError(f"--vary: found {' '.join(vary)}, expected {'two parameters' if event else 'one parameter'}")
    before = _before(out, event) if resume else None
    destination = claim(out, "curves" if event else "branches", force=force or resume, size=size, dpi=dpi, title=title)
    system = open_system(case, changes, start)
    if event is None:
        refuse_twice(system, set(assignments(changes, "--set")), Range(next(iter(free)), 0.0, 1.0, 2))
    quantities = _quantities(system, plot)
    given = None if orbit is None else _state(system, orbit)
    shared: dict[str, Any] = {
        "begin": begin, "period": period, "orbit": given, "points": points, "longest": longest, "labelling": labelling,
    }  # fmt: skip
    with Progress("continue", None, quiet=quiet, unit="steps", rate_unit="steps/s") as progress:
        shared["execution"] = replace(execution, progress=progress)
        if event is not None:
            work = event_curve.parts(system, free, event, near=near, **shared)
        else:
            (name, ends), known = next(iter(free.items())), None if seeds is None else _opened(seeds, "--seeds")
            work = follow.parts(
                system, name, ends, seeds=known, coexisting=coexisting, starts=starts, direction=direction,  # type: ignore[arg-type]
                doublings=doublings, resume=before, **shared,
            )  # fmt: skip
        work.run(lambda done, _: progress.open_ended(counted(done, "point")))  # how long a branch is nobody knows
    if work.dataset is None:
        raise KeyboardInterrupt
    ds, units = work.dataset, Dimensions(system, own=dimensionless)
    files = destination.write(ds, lambda made: pictures.branches(units, made, quantities))
    report.say_doubts_of_branches(ds.attrs)
    varied = str(ds.attrs["varied"]).split()
    inputs = {name: str(ds[name].attrs["units"]) for name in varied if is_input(system, name, beside=len(varied) > 1)}
    reached = {name: np.array([ds[name].values.min(), ds[name].values.max()]) for name in varied}
    assumptions = say_assumptions(system, reached, inputs)
    if json:
        report.print_json({**facts_of(system, ds), "assumptions": assumptions, "files": files})
    else:
        say_branches(system, ds, units, quantities)
        report.print_written(files)
    if not work.complete:
        go_on = "the same command follows the branches again"
        kept = event is None and any(file.suffix == ".nc" for file in files)
        report.interrupted(str(ds.attrs["incomplete"]), files, "the same command with --resume goes on" if kept else go_on)


def _before(out: Path | None, event: str | None) -> "xr.Dataset":
    """What an interrupted command has left in the place of --out."""
    if event is not None:
        raise InputError("--resume: found it beside --event, where it has no meaning")
    place = None if out is None else out if out.suffix == ".nc" else out / "branches.nc"
    if place is None or out is None or out.suffix not in ("", ".nc"):
        raise InputError("--resume: expected --out beside it, the data file or the folder of the interrupted command")
    return _opened(str(place), "--resume")


def _refuse(beside: str, given: Mapping[str, Any]) -> None:
    for name, value in given.items():
        if value:
            raise InputError(f"{name}: found it beside {beside}, where it has no meaning")


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


def _opened(place: str, option: str) -> "xr.Dataset":
    import xarray as xr

    path = Path(place).expanduser()
    if not path.exists():
        raise InputError(f"{option}: there is no file or folder {place}")
    try:
        return xr.open_zarr(path) if path.is_dir() else xr.load_dataset(path)
    except (OSError, ValueError, KeyError) as error:
        raise InputError(f"{option}: {place} is no Dataset or store that can be read: {error}") from None


@dataclass(frozen=True)
class _Varied:
    """What was varied, as it was given."""

    name: str
    given: str
    unit: str
    size: float

    @classmethod
    def of(cls, ds: "xr.Dataset") -> "list[_Varied]":
        """Read what branches were followed against."""
        names, given, units = (str(ds.attrs[key]).split() for key in ("varied", "given", "unit_given"))
        sizes = np.atleast_1d(ds.attrs["size_given"]).tolist()
        return [cls(*each) for each in zip(names, given, units, sizes, strict=True)]

    def shown(self, ds: "xr.Dataset") -> Any:
        """Its values over the points, or events, of a Dataset."""
        return ds[self.name].values / self.size


def facts_of(system: System, ds: "xr.Dataset") -> dict[str, Any]:
    """Say what branches, or curves, hold; the varied parameters as they were given."""
    varied, events, of = _Varied.of(ds), events_of(ds), ds["branch_of"].values
    branches = []
    for k, number in enumerate(ds["branch"].values.tolist()):
        here, mine = of == number, np.flatnonzero(events["branch"].values == number).tolist()
        period = int(ds["period_T"].values[k]) or None
        branches.append(
            {
                "kind": word(ds, "kind", ds["kind"].values[k]),
                "period": period,
                "points": [
                    {**_place(varied, ds, i), "state": _state_of(system, ds["section"].values[i, 0])}
                    for i in np.flatnonzero(here).tolist()
                ],
                "stable": [bool(s) for s in ds["stable"].values[here]],
                "unstable": ds["unstable"].values[here],
                "peak_to_peak": {str(q): ds["peak_to_peak"].sel(quantity=q).values[here] for q in ds["quantity"].values},
                "events": [_event(system, ds, events, i, period) for i in mine],
                "ends": [word(ds, "end", e) for e in ds["end"].values[k]],
            }
        )
    of_curves = len(varied) > 1
    return {
        "case": system.case,
        "model": system.model.name,
        "parameters": {name: value for name, value in system.values.items() if name not in ds.coords},
        "varied": [v.given for v in varied] if of_curves else varied[0].given,
        "unit": [v.unit for v in varied] if of_curves else varied[0].unit,
        "event": ds.attrs.get("event"),
        "curves" if of_curves else "branches": branches,
        "doubts": ds.attrs.get("doubts"),
        "incomplete": ds.attrs.get("incomplete"),
    }


def _place(varied: "list[_Varied]", ds: "xr.Dataset", i: int) -> dict[str, Any]:
    """Value of the parameter at a point or an event, of both on a curve."""
    values = {v.given: float(v.shown(ds)[i]) for v in varied}
    return {"value": values[varied[0].given]} | ({"values": values} if len(varied) > 1 else {})


def _state_of(system: System, x: Any) -> dict[str, float]:
    return dict(zip(system.states, x.tolist(), strict=True))


def _event(system: System, ds: "xr.Dataset", events: "xr.Dataset", i: int, period: int | None) -> dict[str, Any]:
    varied = _Varied.of(ds)
    return {
        "kind": word(ds, "event_kind", events["kind"].values[i]),
        **_place(varied, events, i),
        "unit": varied[0].unit if len(varied) == 1 else [v.unit for v in varied],
        "state": _state_of(system, events["section"].values[i]),
        "multipliers": [[m.real, m.imag] for m in _multipliers(events, i)],
        "period": period,
        "surface": str(events["surface"].values[i]) or None,
        "contacts": int(events["contacts"].values[i]) if str(events["surface"].values[i]) else None,
    }


def _multipliers(events: "xr.Dataset", i: int) -> list[complex]:
    logs, angles = events["log_modulus"].values[i], events["argument"].values[i]
    pairs = [(a, b) for a, b in zip(logs.tolist(), angles.tolist(), strict=True) if a == a]
    return [complex(exp(a) * cos(b), exp(a) * sin(b)) for a, b in pairs]


def say_branches(system: System, ds: "xr.Dataset", units: Dimensions, quantities: list[str]) -> None:
    """Print a table of the branches, and one of their events."""
    shown, varied, of = shown_in(units, ds), _Varied.of(ds), ds["branch_of"].values
    count = ds.sizes["branch"]
    one, several = ("curve of events", "curves of events") if len(varied) > 1 else ("branch", "branches")
    typer.echo(f"{system.case}: {count} {one if count == 1 else several}, {of.size} points")
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
        ends = " and ".join(word(ds, "end", e) for e in ds["end"].values[k])
        ranges = [f"{end:.6g}" for v in varied for end in (v.shown(ds)[here].min(), v.shown(ds)[here].max())]
        stable = int(ds["stable"].values[here].sum())
        rows.append((str(number), label, *ranges, int(here.sum()), stable, f"{np.nanmax(swing[here]):.4g}", ends))
    heads = [head for v in varied for head in (report.with_unit(f"{v.given} from", v.unit), "to")]
    last = report.with_unit(f"largest peak to peak of {first}", swing_unit)
    columns = ("", "kind", *heads, "points", "stable", last, "ends")
    report.show(report.table("Branches", columns, rows, numbers=range(2, 5 + len(heads))))
    if "vertical" in {word(ds, "end", e) for e in ds["end"].values.ravel()}:
        typer.echo(f"vertical: {ENDS['vertical']}")
    _print_events(ds, varied)


def _print_events(ds: "xr.Dataset", varied: "list[_Varied]") -> None:
    events = events_of(ds)
    if not events.sizes["event"]:
        typer.echo("no bifurcation on the way")
        return
    rows = []
    for i in range(events.sizes["event"]):
        kind, surface = word(ds, "event_kind", events["kind"].values[i]), str(events["surface"].values[i])
        critical = sorted(_multipliers(events, i), key=lambda m: abs(abs(m) - 1) if abs(m) else np.inf)[:SHOWN]
        contacts = int(events["contacts"].values[i])
        touched = f" of {surface}" + (f", {contacts} contacts" if contacts > 1 else "") if surface else ""
        rows.append((
            str(int(events["branch"].values[i])), kind + touched,
            *(f"{float(v.shown(events)[i]):.12g}" for v in varied), ", ".join(map(_written, critical)),
        ))  # fmt: skip
    counts = Counter(row[1].partition(",")[0] for row in rows)
    title = "Events: " + ", ".join(f"{count} {kind}" for kind, count in counts.items())
    heads = [report.with_unit(v.given, v.unit) for v in varied]
    columns = ("branch", "kind", *heads, "multipliers nearest to the circle")
    report.show(report.table(title, columns, rows[:60], numbers=range(2, 2 + len(heads))))
    if len(rows) > 60:
        typer.echo(f"  and {len(rows) - 60} more: --json or --out NAME.nc has them all")


def _written(m: complex) -> str:
    """A multiplier in five digits."""
    return f"{m.real:.5g}" if abs(m.imag) < 1e-9 * abs(m) else f"{m.real:.5g}{m.imag:+.5g}i"
