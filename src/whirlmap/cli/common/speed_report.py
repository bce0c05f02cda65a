"""Report of ``whirlmap speeds``: windows and the ranges between them, in engineering units where the case has them."""

import json as js
from collections import Counter
from math import isfinite, nan, pi
from typing import TYPE_CHECKING, Any

import typer

from whirlmap.cli.common import report
from whirlmap.sweep.speeds.verdicts import Verdict

if TYPE_CHECKING:
    import xarray as xr

    from whirlmap.integrate.dimensions import Dimensions


#: Units of the numbers in the facts, by their keys.
UNITS = {
    **dict.fromkeys(("s", "limit", "start", "end", "amplitude", "amplitude_cold", "min_film", "max_load", "margin"), "1"),
    **dict.fromkeys(("limit_um", "length_um", "amplitude_um", "min_film_um"), "um"), "rpm": "rpm", "force_N": "N",
    "max_load_N": "N",
}  # fmt: skip


def sizes_of(units: "Dimensions") -> tuple[float, float, float]:
    """What s = 1, the model's length and its force are in rpm, um and N; NaN each where that is not shown."""
    if units.own:
        return nan, nan, nan
    rotation, length, force = (float(units.worth(name)) for name in ("rotation", "length", "force"))
    return rotation * 30 / pi, length * 1e6, force


def summary(units: "Dimensions", ds: "xr.Dataset") -> dict[str, Any]:
    """Say what was found, as plain data; lengths in um, forces in N and speeds in rpm where the case has dimensions."""
    system, (rpm, um, newton) = units.system, sizes_of(units)
    rows = [_in_units(row, rpm, um, newton) for row in js.loads(ds.attrs["stretches"])]
    if "probability" in ds:
        for row in rows:
            inside = (ds[system.speed] >= row["start"]) & (ds[system.speed] <= row["end"])
            chance = ds["probability"].values[inside.values]
            row["probability"] = [float(chance.min()), float(chance.max())]
    counted = Counter(Verdict(int(v)).name for v in ds["verdict"].values)
    limit = float(ds.attrs["limit"])
    facts: dict[str, Any] = {
        "case": system.case, "limit": limit, "limit_um": limit * um if isfinite(um) else None,
        "incomplete": ds.attrs.get("incomplete"),
        "quantities": ds.attrs["quantities"].split(), "not_judged": js.loads(ds.attrs["not_judged"]),
        "followed": bool(ds.attrs["followed"]),
        "windows": [row for row in rows if row["verdict"] == "safe"], "stretches": rows,
        "unstable_rest": _unstable_rest(js.loads(ds.attrs["unstable_rest"]), rpm),
        "operation": _operation(float(system.values[system.speed]), rows, rpm),
        "force_N": newton, "length_um": um, "verdicts": dict(counted), "speed": system.speed, "s": ds[system.speed].values,
        "rpm": ds["rpm"].values if "rpm" in ds and isfinite(rpm) else None, "units": UNITS,
        "verdict": [Verdict(int(v)).name for v in ds["verdict"].values],
        "other": [Verdict(int(v)).name if v else None for v in ds["other"].values],
    }  # fmt: skip
    for name in ("amplitude", "amplitude_cold", "motions", "margin", "tooth_contact"):
        facts[name] = ds[name].values
    for name in ("min_film", "max_load"):
        if name in ds:
            facts[name] = {str(b): ds[name].sel(bearing=b).values for b in ds["bearing"].values}
    if "probability" in ds:
        facts |= {name: ds[name].values for name in ("probability", "probability_low", "probability_high")}
        facts["probability_of"] = {str(why): ds["probability_of"].sel(why=why).values for why in ds["why"].values}
    return facts


def _in_units(row: dict[str, Any], rpm: float, um: float, newton: float) -> dict[str, Any]:
    out = dict(row)
    if isfinite(rpm):
        out["rpm"] = [row["start"] * rpm, row["end"] * rpm]
    for name, unit, size in (("amplitude", "um", um), ("min_film", "um", um), ("max_load", "N", newton)):
        if isfinite(size) and row.get(name) is not None:
            out[f"{name}_{unit}"] = row[name] * size
    return out


def _unstable_rest(found: dict[str, Any] | None, rpm: float) -> dict[str, Any] | None:
    """Where the static equilibrium is unstable, of the speeds that are not safe; None where that is not known."""
    if found is None or not isfinite(rpm):
        return found
    return found | {"looked_at_rpm": [s * rpm for s in found["looked_at"]], "rpm": [s * rpm for s in found["unstable"]]}


def _operation(s: float, rows: list[dict[str, Any]], rpm: float) -> dict[str, Any] | None:
    """Where the case's own speed lies, and how far it is from the boundaries of a safe window; None beyond the range."""
    rounding = 1e-9 * s  # the ends of the range were read from text
    inside = [row for row in rows if row["start"] - rounding <= s <= row["end"] + rounding]
    if not inside:
        return None
    row = next((r for r in inside if r["verdict"] == "safe"), inside[0])
    found: dict[str, Any] = {"s": s, "verdict": row["verdict"]}
    if row["verdict"] == "safe":
        sides = {"below": s - row["start"], "above": row["end"] - s}
        found["margins"] = {
            side: {"to": row[side], "s": distance} | ({"rpm": distance * rpm} if isfinite(rpm) else {})
            for side, distance in sides.items() if row[f"gap_{'start' if side == 'below' else 'end'}"]
        }  # fmt: skip
    return found | ({"rpm": s * rpm} if isfinite(rpm) else {})


def show(facts: dict[str, Any]) -> None:
    """Print the tables."""
    um = facts["limit_um"]
    limit = f"{facts['limit']:.4g} clearances" + (f", {um:.4g} um" if um else "")
    typer.echo(f"{facts['case']}: peak to peak of {', '.join(facts['quantities'])} at most {limit}")
    if facts["not_judged"]:
        typer.echo(
            f"not judged: {', '.join(facts['not_judged'])} (--quantity NAME judges another station;"
            " linear --response shows all of them)"
        )
    if facts["incomplete"]:
        typer.echo(f"incomplete: {facts['incomplete']}")
    speed = "speed [rpm]" if facts["rpm"] is not None else facts["speed"]
    heads, cells = _quantities(facts["stretches"])
    safe, other = [], []
    for row, values in zip(facts["stretches"], cells, strict=True):
        if row["verdict"] == "safe":
            safe.append((_span(row), *_span_s(row), *values, _end(row, "below"), _end(row, "above")))
        else:
            beside = f" ({', '.join(map(words, row['other']))})" if row["verdict"] == "coexisting" else ""
            other.append((_span(row), *_span_s(row), *values, words(row["verdict"]) + beside))
    columns = (speed, *([facts["speed"]] if facts["rpm"] is not None else []), *heads)
    if safe:
        report.show(report.table("Safe windows", (*columns, "below", "above"), safe))
    else:
        typer.echo("no safe speed")
    if other:
        report.show(report.table("Elsewhere", (*columns, "why"), other))
    counted = ", ".join(f"{n} {words(name)}" for name, n in facts["verdicts"].items())
    how = "cold starts, run-up and run-down" if facts["followed"] else "cold starts alone"
    typer.echo(f"{len(facts['s'])} speeds, {how}: {counted}")
    if facts["unstable_rest"] and facts["unstable_rest"]["unstable"]:
        typer.echo(_self_excited(facts["unstable_rest"], facts["speed"]))
    if facts["operation"]:
        every = "are all speeds that were judged" if facts["incomplete"] else "is the whole range"
        typer.echo(_of_operation(facts["operation"], facts["speed"], every))
    if "probability" in facts:
        means = {why: float(p.mean()) for why, p in facts["probability_of"].items() if p.any()}
        shares = ", ".join(f"{100 * p:.1f} % {words(why)}" for why, p in means.items())
        typer.echo(f"drawn machines, over all speeds: {shares}")


def words(name: str) -> str:
    """A verdict as people write it."""
    return {"separation": "teeth part"}.get(name, name.replace("_", "-"))


def _end(row: dict[str, Any], side: str) -> str:
    """Why a window ends, and at which bifurcation."""
    event = row[f"{side}_event"]
    return words(row[side]) + (f" ({event})" if event else "")


def _span(row: dict[str, Any]) -> str:
    return f"{row['rpm'][0]:.0f} .. {row['rpm'][1]:.0f}" if "rpm" in row else f"{row['start']:.4f} .. {row['end']:.4f}"


def _span_s(row: dict[str, Any]) -> list[str]:
    return [f"{row['start']:.4f} .. {row['end']:.4f}"] if "rpm" in row else []


def _quantities(rows: list[dict[str, Any]]) -> tuple[list[str], list[list[str]]]:
    """Heads of the columns that any stretch has a number for, and the cells of each stretch."""
    columns = []
    for name, head, unit in (
        ("amplitude", "peak to peak", "um"), ("min_film", "thinnest film", "um"), ("max_load", "largest load", "N"),
    ):  # fmt: skip
        known = f"{name}_{unit}" if any(f"{name}_{unit}" in row for row in rows) else name
        if any(row.get(known) is not None for row in rows):
            columns.append((f"{head} [{unit if known != name else 1}]", known, f"{name}_bearing"))
    if any(row["tooth_contact"] is not None for row in rows):
        columns.append(("teeth touch", "tooth_contact", ""))
    if any("probability" in row for row in rows):
        columns.append(("probability of safe", "probability", ""))
    cells = [[_cell(row, name, bearing) for _, name, bearing in columns] for row in rows]
    return [head for head, _, _ in columns], cells


def _cell(row: dict[str, Any], name: str, bearing: str) -> str:
    if row.get(name) is None:
        return "-"
    if name == "tooth_contact":
        return f"{100 * row[name]:.0f} %"
    if name == "probability":
        return f"{row[name][0]:.2f} .. {row[name][1]:.2f}"
    which = row.get(bearing)
    return f"{row[name]:.4g}" + (f" ({which})" if which and which != "all" else "")


def _self_excited(found: dict[str, Any], speed: str) -> str:
    """That some of the speeds that are not safe have an unstable equilibrium, and how the journals whirl there."""
    at = found.get("rpm", found["unstable"])
    ends = [f"{v:.0f}" if "rpm" in found else f"{v:.4f}" for v in (min(at), max(at))]
    place = f"{' .. '.join(dict.fromkeys(ends))} rpm" if "rpm" in found else f"{speed} = {' .. '.join(dict.fromkeys(ends))}"
    names = ", ".join(dict.fromkeys(found["journal"]))
    ratios = [f"{r:.2f}" for r in (min(found["ratio"]), max(found["ratio"])) if isfinite(r)]
    times = f" at {' to '.join(dict.fromkeys(ratios))} times the speed of the journal" if ratios else ""
    return (
        f"unstable static equilibrium: at {len(at)} of the {len(found['looked_at'])} speeds looked at that are not safe,"
        f" {place}; bearing {names} excites a whirl{times}, which a better balance does not cure (see whirlmap linear)"
    )


def _of_operation(at: dict[str, Any], speed: str, every: str) -> str:
    place = f"{at['rpm']:.0f} rpm" if "rpm" in at else f"{speed} = {at['s']:.4f}"
    if at["verdict"] != "safe":
        return f"the machine's own speed, {place}: not safe, {words(at['verdict'])}"
    ends = [
        (f"{m['rpm']:.0f} rpm" if "rpm" in m else f"{m['s']:.4f}") + f" {side} ({words(m['to'])})"
        for side, m in at["margins"].items()
    ]
    return f"the machine's own speed, {place}: safe, {'margin ' + ' and '.join(ends) if ends else f'as {every}'}"
