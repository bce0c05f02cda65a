"""``whirlmap attractors``: coexisting attractors at one operating point, and the share of starts that lead to each."""

from dataclasses import replace
from json import loads
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from whirlmap.analysis.labels.votes import Vote
from whirlmap.cli.common import pictures, report
from whirlmap.cli.common.assignments import ranges
from whirlmap.cli.common.opening import open_system
from whirlmap.cli.common.outputs import claim
from whirlmap.cli.common.progress import Progress
from whirlmap.errors import counted
from whirlmap.integrate.dimensions import Dimensions
from whirlmap.integrate.in_units import shown_in
from whirlmap.integrate.own_units import in_states
from whirlmap.options.computed import Labelling
from whirlmap.options.execution import Execution
from whirlmap.results.memory import refuse_points
from whirlmap.results.regime import Regime
from whirlmap.sweep.attractors.attractors import attractors as find
from whirlmap.sweep.diagrams.in_batches import expected_periods

if TYPE_CHECKING:
    import xarray as xr


#: Keys of the numbers of an attractor that have a unit.
MEASURED = ("lyapunov", "lyapunov_error", "peak_to_peak", "units")


def attractors(
    *, case: str, starts: int, box: list[str] | None, seed: int, changes: list[str] | None, start: list[str] | None,
    labelling: Labelling, execution: Execution, dimensionless: bool, out: Path | None, size: str | None, dpi: int | None,
    title: str | None, force: bool, json: bool, quiet: bool,
) -> None:  # fmt: skip
    """Do what `whirlmap.cli.declared.attractors` says."""
    boxed = ranges(box, "--box")
    destination = claim(out, "attractors", force=force, size=size, dpi=dpi, title=title)
    system = open_system(case, changes, start)

    boxes = {one.name: (one.start, one.stop) for one in (in_states(system, one, "--box") for one in boxed.values())}
    refuse_points([starts])
    expected = expected_periods(system, starts, labelling.settling)
    with Progress("attractors", expected, quiet=quiet, points=starts) as progress:
        work = find.parts(
            system, starts=starts, box=boxes or None, seed=seed, labelling=labelling,
            execution=replace(execution, progress=progress),
        ).run()  # fmt: skip
    if work.dataset is None:
        raise KeyboardInterrupt
    ds, units = work.dataset, Dimensions(system, own=dimensionless)
    files = destination.write(ds, lambda done: pictures.attractors(units, done))
    report.say_doubts(ds.attrs)
    facts, box_drawn = summary(units, ds), loads(ds.attrs["box"])
    if json:
        report.print_json({**facts, "box": box_drawn, "seed": seed, "files": files})
    else:
        say_attractors(facts)
        say_box(units, box_drawn)
        report.print_written(files)
    if not work.complete:
        report.interrupted(facts["incomplete"], files, "the same command integrates all starts again")


def summary(units: "Dimensions", ds: "xr.Dataset") -> dict[str, Any]:
    """Say what a search found, attractor by attractor; in ``dimensional`` in these units, where they are others."""
    own, shown = _summary(Dimensions(units.system, own=True), ds), _summary(units, shown_in(units, ds))
    there = {"attractors": [{key: one[key] for key in MEASURED} for one in shown["attractors"]]}
    return report.beside(own, there, ("attractors",), units)


def _summary(units: "Dimensions", ds: "xr.Dataset") -> dict[str, Any]:
    system, rate = units.system, units.of("rate").unit
    names_of = [str(q) for q in ds["quantity"].values] if "quantity" in ds.coords else []
    said: dict[str, Any] = dict.fromkeys(("lyapunov", "lyapunov_error"), rate)
    said["peak_to_peak"] = {q: units.quantity(q).unit for q in names_of}

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
                "votes": {str(i): _vote(v) for i, v in _votes(one)},
                "peak_to_peak": {q: float(one["peak_to_peak"].sel(quantity=q)) for q in names_of},
                "units": said,
            }
            for number, one in ((n, ds.sel(attractor=n)) for n in made)
        ],
        "outcomes": {
            str(o): {
                name: float(ds[f"outcome_{name}"].sel(outcome=o)) for name in ("starts", "share", "share_error")
            }
            for o in ds["outcome"].values
        },
        "incomplete": ds.attrs.get("incomplete"),
    }  # fmt: skip


def _votes(one: "xr.Dataset") -> Any:
    """Indicators with their votes; none where a search was interrupted before they were asked."""
    return zip(one["indicator"].values, one["vote"].values, strict=True) if "vote" in one else ()


def _vote(vote: Any) -> str:
    return Vote(int(vote)).name


def _exponent(numbers: dict[str, Any], unit: str) -> str:
    value = numbers["lyapunov"]
    return report.with_error(value, numbers["lyapunov_error"]) + report.unit_behind(unit) if value == value else "-"


def say_attractors(facts: dict[str, Any]) -> None:
    """Print the table of attractors, and how the other starts ended."""
    found = facts["attractors"]
    shown = facts.get("dimensional", facts)["attractors"]
    if facts["incomplete"]:
        typer.echo(f"incomplete: {facts['incomplete']}")
    typer.echo(f"{facts['case']}: {counted(facts['starts'], 'start')}, {counted(len(found), 'attractor')}")
    rows = []
    for a, numbers in zip(found, shown, strict=True):
        label = f"periodic, {a['period']}T" if a["regime"] == "periodic" else a["regime"]
        votes = ", ".join(f"{name} {vote}" for name, vote in a["votes"].items() if vote != "none")
        name, swing = next(iter(numbers["peak_to_peak"].items()))
        units = numbers["units"]
        rows.append((
            str(a["number"]), label, _share(a, facts),
            _exponent(numbers, units["lyapunov"]),
            f"{name} {swing:.4g}{report.unit_behind(units['peak_to_peak'][name])}" if swing == swing else "-", votes,
        ))  # fmt: skip
    if rows:
        columns = ("", "regime", "share of the starts", "largest exponent", "peak to peak", "votes")
        report.show(report.table("Attractors", columns, rows[:40]))
        if len(rows) > 40:
            typer.echo(f"  and {len(rows) - 40} more: --json or --out NAME.nc has them all")
    for name, one in facts["outcomes"].items():
        if one["starts"]:
            typer.echo(f"{name}: {_share(one, facts)} of the starts, no attractor")


def _share(one: dict[str, Any], facts: dict[str, Any]) -> str:
    """A share with its error; of a search that was stopped, which has none, the starts that it is a share of."""
    share, error = one["share"], one["share_error"]
    if error == error:
        return f"{100 * share:.2f} +- {100 * error:.2f} %"
    return f"{100 * share:.2f} % of the {facts['starts']} that came to an end"


def say_box(units: "Dimensions", box: dict[str, list[float]]) -> None:
    """Print the ranges from which starts were drawn."""
    ranges = []
    for name, (low, high) in box.items():
        unit = units.quantity(name)
        ranges.append(f"{name} = {low * unit.size:.4g} to {high * unit.size:.4g}{report.unit_behind(unit.unit)}")
    typer.echo(f"starts drawn from {', '.join(ranges)}")
