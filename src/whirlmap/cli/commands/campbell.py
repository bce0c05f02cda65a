"""``whirlmap campbell``: damped frequencies, order lines and critical speeds."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from whirlmap.analysis.linear.campbell import campbell as compute
from whirlmap.analysis.linear.linearisation import NotLinearError
from whirlmap.analysis.linear.mode_shapes import WHIRL
from whirlmap.cli.commands.linear import instead
from whirlmap.cli.common import pictures, report
from whirlmap.cli.common.assignments import assignments
from whirlmap.cli.common.messages import say
from whirlmap.cli.common.opening import open_system
from whirlmap.cli.common.outputs import claim
from whirlmap.cli.common.violated import say_assumptions
from whirlmap.integrate.dimensions import Dimensions
from whirlmap.integrate.in_units import shown_in
from whirlmap.integrate.own_units import in_parameters, refuse_twice
from whirlmap.integrate.ranges import Range

if TYPE_CHECKING:
    import xarray as xr

    from whirlmap.integrate.system import System


CURVES = ("frequency", "growth", "damping_ratio", "whirl", "line", "status")


def campbell(
    *, case: str, vary: str, changes: list[str] | None, dimensionless: bool, out: Path | None, size: str | None,
    dpi: int | None, title: str | None, force: bool, json: bool,
) -> None:  # fmt: skip
    """Do what `whirlmap.cli.declared.campbell` says."""
    swept = Range.parse(vary)
    destination = claim(out, "campbell", force=force, size=size, dpi=dpi, title=title)
    system = open_system(case, changes, None)
    refuse_twice(system, set(assignments(changes, "--set")), swept)
    swept = in_parameters(system, swept)

    try:
        ds = compute(system, swept.name, swept.values)
    except NotLinearError as error:
        if out is not None:  # who asked for a file gets none
            raise
        _say_why_none(system, swept, f"{error}. {instead(system)}", json=json)
        return
    report.say_not_declared(system, "bodies")
    shown = shown_in(Dimensions(system, own=dimensionless), ds)
    files = destination.write(ds, lambda _: pictures.campbell(system, shown))
    missing = int((ds["status"] != 0).sum())
    if missing:
        say(f"no static equilibrium was found at {missing} of {swept.count} values: they are left out")
    facts = summary(system, ds, swept.name)
    facts["assumptions"] = say_assumptions(system, {swept.name: (swept.start, swept.stop)})
    if json:
        if shown is not ds:
            facts["dimensional"] = dimensional(shown, swept.name)
        report.print_json({**facts, "files": files})
        return
    _print(system, shown, swept.name)
    report.print_written(files)


def _say_why_none(system: "System", swept: "Range", note: str, *, json: bool) -> None:
    """Answer for a machine whose small motions are not those of a linear system."""
    assumptions = say_assumptions(system, {swept.name: (swept.start, swept.stop)})
    if json:
        empty: dict[str, Any] = {key: [] for key in (*CURVES, "clocks", "modes", "bodies", "shapes", "critical", "files")}
        report.print_json({
            "case": system.case, "model": system.model.name, "varied": swept.name, "values": swept.values, **empty,
            "note": note, "assumptions": assumptions,
        })  # fmt: skip
    else:
        typer.echo(f"{system.case}: {note}")


def summary(system: "System", ds: "xr.Dataset", name: str) -> dict[str, Any]:
    """Say what a Campbell diagram holds."""
    return {
        "case": system.case, "model": system.model.name, "varied": name, "values": ds[name].values,
        **{key: ds[key].values for key in CURVES},
        "clocks": ds["clock"].values, "modes": ds["mode_name"].values, "bodies": ds["body"].values,
        "shapes": ds["shape"].values, "critical": _critical(ds), "note": None,
    }  # fmt: skip


def dimensional(ds: "xr.Dataset", name: str) -> dict[str, Any]:
    """Numbers of `summary` that have a unit, and their units."""
    keys = ("frequency", "growth", "line")
    return {
        "values": ds[name].values, **{key: ds[key].values for key in keys},
        "critical": [{key: one[key] for key in ("value", "frequency")} for one in _critical(ds)],
        "units": {
            "values": ds[name].attrs["units"], **{key: ds[key].attrs["units"] for key in keys},
            "critical": {"value": ds["critical"].attrs["units"], "frequency": ds["critical_frequency"].attrs["units"]},
        },
    }  # fmt: skip


def _critical(ds: "xr.Dataset") -> list[dict[str, Any]]:
    return [
        {
            "value": float(one["critical"]), "clock": str(one["critical_clock"].values),
            "mode": str(int(one["critical_mode"])), "whirl": WHIRL[int(one["critical_whirl"])],
            "damping_ratio": float(one["critical_damping_ratio"]), "frequency": float(one["critical_frequency"]),
            "name": str(one["critical_name"].values), "shape": _shape(one["critical_shape"]),
        }
        for one in (ds.isel(crossing=k) for k in range(ds.sizes["crossing"]))
    ]  # fmt: skip


def _shape(shape: "xr.DataArray") -> dict[str, float]:
    return dict(zip(shape["body"].values.tolist(), shape.values.tolist(), strict=True))


def _print(system: "System", ds: "xr.Dataset", name: str) -> None:
    at, head = ds[name].values, report.with_unit(name, ds[name].attrs["units"])
    frequency = report.with_unit("frequency", ds["frequency"].attrs["units"])
    typer.echo(f"{system.case}: {head} from {at[0]:.6g} to {at[-1]:.6g}, {at.size} points")
    middle = at.size // 2
    rows: list[tuple[str, ...]] = []
    for one in (ds.isel(mode=k) for k in range(ds.sizes["mode"])):
        ends, damping = one["frequency"].values[[0, -1]], one["damping_ratio"].values
        rows.append((str(int(one["mode"])), str(one["mode_name"].values), *(f"{v:.5g}" for v in ends),
                     f"{damping[damping == damping].min(initial=math.inf):.4g}",
                     _largest(_shape(one["shape"].isel({name: middle})))))  # fmt: skip
    columns: tuple[str, ...] = ("mode", "name", f"{frequency} at {at[0]:.5g}", f"at {at[-1]:.5g}", "least damping ratio",
               f"shape at {at[middle]:.5g}")  # fmt: skip
    report.show(report.table("Modes", columns, rows, numbers=(2, 3, 4)))
    rows = [
        (f"{c['value']:.7g}", f"{c['frequency']:.5g}", c["clock"], c["mode"], c["name"], c["whirl"],
         f"{c['damping_ratio']:.4g}", _largest(c["shape"]))
        for c in _critical(ds)
    ]  # fmt: skip
    columns = (head, frequency, "clock", "mode", "name", "whirl", "damping ratio", "shape")
    if rows:
        report.show(report.table("Order lines that cross a damped frequency", columns, rows, numbers=(0, 1, 6)))
    else:
        typer.echo("no order line crosses a damped frequency in this range")


def _largest(shape: dict[str, float]) -> str:
    """The bodies that move most, and how far: ``pinion 1, pinion journals 0.97``."""
    moving = sorted((item for item in shape.items() if item[1] >= 0.1), key=lambda item: -item[1])
    return ", ".join(f"{body} {size:.2g}" for body, size in moving[:3]) or "-"
