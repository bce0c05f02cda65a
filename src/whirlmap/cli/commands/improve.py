"""``whirlmap improve``: which values of one or two design parameters give the widest safe window."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import typer

from whirlmap.cli.common import pictures, report
from whirlmap.cli.common.assignments import assignments
from whirlmap.cli.common.opening import open_system
from whirlmap.cli.common.outputs import claim
from whirlmap.cli.common.progress import Progress
from whirlmap.cli.common.speed_report import sizes_of
from whirlmap.cli.common.violated import say_violations
from whirlmap.equations import hints
from whirlmap.errors import InputError, RangeError, counted
from whirlmap.integrate.dimensions import Dimensions
from whirlmap.integrate.loading import load
from whirlmap.integrate.ranges import Range
from whirlmap.options.computed import Labelling
from whirlmap.options.execution import Execution
from whirlmap.results.memory import refuse_points
from whirlmap.sweep.diagrams.in_batches import expected_periods
from whirlmap.sweep.parameters.engineering import limit_of, speeds_of
from whirlmap.sweep.speeds.improve import improve as find
from whirlmap.units import such_as

if TYPE_CHECKING:
    import xarray as xr

    from whirlmap.integrate.system import System


def improve(
    *, case: str, vary: list[str], limit: str | None, span: str | None, points: int, quantity: str | None, coarse: bool,
    follow: bool, changes: list[str] | None, start: list[str] | None, labelling: Labelling, execution: Execution,
    dimensionless: bool, out: Path | None, size: str | None, dpi: int | None, title: str | None, force: bool, json: bool,
    quiet: bool,
) -> None:  # fmt: skip
    """Do what `whirlmap.cli.declared.improve` says."""
    ranges, units = _ranges(vary)
    settings = assignments(changes, "--set")
    for name in ranges.keys() & settings.keys():
        raise RangeError(f"{name}: found it in --set and in --vary, expected it in one of them")
    destination = claim(out, "improve", force=force, size=size, dpi=dpi, title=title)
    system = open_system(case, changes, start)
    _refuse_unknown(system, ranges, units)

    refuse_points([*(r.count for r in ranges.values()), points])
    allowed = limit_of(system, limit, "--limit")
    low, high = speeds_of(system, span, "--range")
    at = np.linspace(low, high, points)
    make = partial(load, case, start=dict(system.start), **settings)
    judged = points * int(np.prod([r.count for r in ranges.values()]))
    with Progress("improve", expected_periods(system, judged, labelling.settling), quiet=quiet, points=judged) as progress:
        work = find.parts(
            make, {n: r.values for n, r in ranges.items()}, at, allowed,
            units=units, refine=not coarse, follow=follow, quantity=quantity, labelling=labelling,
            execution=replace(execution, progress=progress),
        ).run(lambda done, total: progress.expect(progress.done * total / done, f"{done} of {total} designs"))  # fmt: skip
    if work.dataset is None:
        raise KeyboardInterrupt
    ds = work.dataset
    scales = Dimensions(system, own=dimensionless)
    files = destination.write(ds, lambda made: pictures.improve(scales, made))
    report.say_doubts(ds.attrs)
    facts, own = summary(scales, ds), float(system.values[system.speed])
    facts["assumptions"] = say_violations(_ends(make, ranges, units, (low / own, high / own)))
    if json:
        report.print_json({**facts, "files": files})
    else:
        _print(facts)
        report.print_written(files)
    if not work.complete:
        report.interrupted(facts["incomplete"], files, "the same command computes all designs again")


def _ranges(texts: Sequence[str]) -> tuple[dict[str, "Range"], dict[str, str]]:
    """Ranges of the varied names, and the units of those that have one."""
    ranges: dict[str, Range] = {}
    units: dict[str, str] = {}
    for text in texts:
        found = Range.parse(text)
        if found.unit:
            units[found.name] = found.unit
        if ranges.setdefault(found.name, found) != found or len(ranges) > 2:
            raise InputError("--vary: expected one or two different design parameters, each given once")
    return ranges, units


def _refuse_unknown(system: "System", names: Sequence[str] | dict[str, Any], units: dict[str, str]) -> None:
    """Refuse what is no parameter or input; numbers of teeth and orders change the common period."""
    settled = system.machine
    assert settled is not None  # a case was opened
    groups = settled.groups
    inputs = {q.name: q for q in groups.inputs} if groups else {}
    shared = groups.shared if groups else {}
    for name in names:
        if name not in inputs and name not in shared and name not in system.parameters:
            said = hints.of_symbol(settled.case.family, system.model, name, [*system.model.parameters, *inputs.values()])
            raise InputError(
                f"--vary: {system.case} has no {name!r}.{said}\n  parameters: {' '.join(system.parameters)}"
                + (f"\n  dimensional inputs: {' '.join(settled.inputs)}" if settled.inputs else "")
            )
        if groups and name in groups.operation:
            raise InputError(f"--vary: {name} says how the machine is run, the same for all designs: see --range, --limit")
        declared = inputs.get(name) or inputs.get(shared.get(name, ("",))[0]) or system.model.parameter(name)
        if declared.order:
            raise RangeError(f"--vary: {name} is a whole number or an order ({declared.meaning}): it cannot be a range")
        if declared.unit == "1" and name in units:
            raise InputError(f"--vary: {name} has no dimension, found the unit {units[name]!r}")
        if name not in system.parameters and declared.unit != "1" and name not in units:
            unit = such_as(declared.unit)
            raise InputError(f"--vary: {name} has a dimension; expected its unit, such as {unit}, on both ends")


def _ends(
    make: Callable[..., "System"], ranges: "dict[str, Range]", units: dict[str, str], speeds: tuple[float, float]
) -> Iterator["System"]:
    """The designs at the ends of their ranges, each at both ends of the range of speeds, over the machine's own speed."""
    for values in product(*((r.start, r.stop) for r in ranges.values())):
        changed = {n: f"{v!r} {units.get(n, '')}".strip() for n, v in zip(ranges, values, strict=True)}
        design = make(**changed)
        yield from (design.at_speed(share * float(design.values[design.speed])) for share in speeds)


def summary(units: "Dimensions", ds: "xr.Dataset") -> dict[str, Any]:
    """Say what was found, as plain data."""
    names, system = ds.attrs["varied"].split(), units.system
    scale, um, _ = (None if size != size else size for size in sizes_of(units))
    rows = []
    for i in range(ds.sizes["design"]):
        one = ds.isel(design=i)
        row: dict[str, Any] = {name: float(one[name]) for name in names}
        row |= {
            key: float(one[key])
            for key in ("window_start", "window_end", "window_width", "safe_share", "worst_amplitude")
        }
        row |= {"ended": int(one["ended"])} | {name: bool(one[name]) for name in ("refined", "followed", "front")}
        if scale:
            row["rpm"] = [row["window_start"] * scale, row["window_end"] * scale]
            row["rpm_width"] = row["window_width"] * scale
        if um:
            row["worst_amplitude_um"] = row["worst_amplitude"] * um
        rows.append(row)
    limit = float(ds.attrs["limit"])
    return {
        "case": system.case, "varied": names, "units": {n: ds[n].attrs["units"] for n in names}, "limit": limit,
        "limit_um": limit * um if um else None, "speed": system.speed, "s": ds[system.speed].values, "designs": rows,
        "widest": int(ds.attrs["widest"]), "calmest": int(ds.attrs["calmest"]), "incomplete": ds.attrs.get("incomplete"),
    }  # fmt: skip


def _print(facts: dict[str, Any]) -> None:
    names, um, designs = facts["varied"], facts["limit_um"], facts["designs"]
    limit = f"{facts['limit']:.4g} clearances" + (f", {um:.4g} um" if um else "")
    tried = counted(len(designs), "design")
    typer.echo(f"{facts['case']}: {tried} at {counted(len(facts['s']), 'speed')}, peak to peak at most {limit}")
    if facts["incomplete"]:
        typer.echo(f"incomplete: {facts['incomplete']}")
    heads = [n if facts["units"][n] == "1" else f"{n} [{facts['units'][n]}]" for n in names]
    rows, so_far = [], " so far" if facts["incomplete"] else ""
    for i in sorted(range(len(designs)), key=lambda i: [designs[i][n] for n in names]):
        d = designs[i]
        low, high = d.get("rpm", [d["window_start"], d["window_end"]])
        place = "-" if not d["safe_share"] else f"{low:.0f} .. {high:.0f}" if "rpm" in d else f"{low:.4f} .. {high:.4f}"
        width = f"{d['rpm_width']:.0f}" if "rpm" in d else f"{d['window_width']:.4f}"
        worst = d.get("worst_amplitude_um", d["worst_amplitude"])
        swing = f"{counted(d['ended'], 'run')} ended early" if d["ended"] else f"{worst:.4g}"
        judged = "up and down" if d["followed"] else "cold"
        best_of = (("widest window", "widest"), ("lowest amplitude", "calmest"))
        notes = [w + so_far for w, key in best_of if facts[key] == i]
        share = f"{100 * d['safe_share']:.0f} %"
        rows.append((*(f"{d[n]:.5g}" for n in names), place, width, share, swing, judged, ", ".join(notes)))
    speed, length = ("rpm", "um") if "rpm" in designs[0] else (facts["speed"], "clearances")
    columns = (*heads, f"widest window [{speed}]", "width", "safe", f"worst amplitude [{length}]", "judged", "")
    report.show(report.table("Designs", columns, rows, numbers=(*range(len(names)), len(names) + 1, len(names) + 2)))
    best = designs[facts["widest"]]
    if best["safe_share"]:
        units = facts["units"]
        chosen = " ".join(f'--set "{n}={best[n]:.6g}{"" if units[n] == "1" else " " + units[n]}"' for n in names)
        which = ", for the best so far" if so_far else ""
        typer.echo(f"next{which}: whirlmap speeds {facts['case']} {chosen}, the other options as here")
    else:
        typer.echo("no design has a safe speed")
