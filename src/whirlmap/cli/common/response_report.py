"""``whirlmap linear --response``: the response to unbalance, its critical speeds, and the nonlinear motion beside it."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import typer

from whirlmap.analysis.linear.amplification import Critical
from whirlmap.analysis.linear.unbalance_response import unbalance_response
from whirlmap.cli.common import pictures, report
from whirlmap.cli.common.messages import say
from whirlmap.cli.common.outputs import Destination
from whirlmap.cli.common.progress import Progress
from whirlmap.cli.common.violated import say_assumptions
from whirlmap.errors import InputError
from whirlmap.integrate.dimensions import Dimensions
from whirlmap.integrate.in_units import shown_in
from whirlmap.integrate.own_units import in_parameters
from whirlmap.integrate.ranges import Range
from whirlmap.options.computed import LABELLING
from whirlmap.options.execution import EXECUTION
from whirlmap.results.files import read
from whirlmap.results.schema import variable
from whirlmap.results.status import Status
from whirlmap.sweep.diagrams.diagram import bifurcation_diagram
from whirlmap.sweep.diagrams.in_batches import expected_periods
from whirlmap.sweep.parameters.engineering import given

if TYPE_CHECKING:
    import xarray as xr

    from whirlmap.integrate.system import System

#: Ends of the range over the highest speed, where none is given, and its points.
FROM, TO, POINTS = 0.05, 1.25, 200


@dataclass(frozen=True)
class Asked:
    """Options of the response, as the command line gives them."""

    vary: str | None
    probe: list[str] | None
    nonlinear: int | None
    over: Path | None
    dimensionless: bool
    json: bool
    quiet: bool

    def refuse_without_response(self, out: Path | None) -> None:
        """Refuse options that only count with --response."""
        options = {"vary": self.vary, "probe": self.probe, "nonlinear": self.nonlinear, "over": self.over, "out": out}
        found = [f"--{name}" for name, value in options.items() if value is not None]
        if found:
            raise InputError(f"{found[0]}: found it without --response, expected both")


def show_response(system: "System", asked: Asked, destination: Destination) -> None:
    """Compute, print and write the response."""
    slowest, fastest = operating_range(system)
    swept = Range(system.speed, FROM * fastest, TO * fastest, POINTS) if system.speed else None
    if asked.vary is not None:
        swept = in_parameters(system, Range.parse(asked.vary))
    if swept is None:
        raise InputError(f"--response: {system.model.name} declares no speed, expected a model that does")
    if asked.nonlinear is not None and asked.over is not None:
        raise InputError("--over: found it with --nonlinear, expected one of them")
    ds = unbalance_response(system, swept.name, swept.values, stations=asked.probe)
    diagram = _diagram(system, swept, asked)
    if diagram is not None:
        ds = ds.assign(_beside(system, ds, diagram))
    shown = shown_in(Dimensions(system, own=asked.dimensionless), ds)
    files = destination.write(ds, lambda _: pictures.response(system, shown))
    missing = int((ds["status"] != Status.ok).sum())
    if missing:
        say(f"no static equilibrium was found at {missing} of {swept.count} speeds: they are left out")
    assumptions = say_assumptions(system, {swept.name: (swept.start, swept.stop)})
    of_range = slowest * _size(ds, shown), fastest * _size(ds, shown)
    if asked.json:
        facts = {"case": system.case, "model": system.model.name, "parameters": system.values,
                 **_facts(ds, (slowest, fastest)), "note": None, "assumptions": assumptions}  # fmt: skip
        if shown is not ds:
            facts["dimensional"] = {**_facts(shown, of_range), "units": _units(shown)}
        report.print_json({**facts, "files": files})
        return
    _print(system, shown, of_range)
    report.print_written(files)


def operating_range(system: "System") -> tuple[float, float]:
    """Ends of the range of operation in the speed parameter: the case's own, else the speed that it is at."""
    own, scale = float(system.values.get(system.speed, np.nan)), float(Dimensions(system).worth("rotation"))
    ends = [given(system, name) for name in ("speed_min", "speed_max")]
    low, high = (own if end is None or not np.isfinite(scale) else end / scale for end in ends)
    return min(low, high), max(low, high)


def _diagram(system: "System", swept: Range, asked: Asked) -> "xr.Dataset | None":
    """The nonlinear motion that is asked for: computed, or of a file."""
    if asked.nonlinear is not None:
        at = np.linspace(swept.start, swept.stop, asked.nonlinear)
        work = expected_periods(system, at.size, LABELLING.settling)
        with Progress("nonlinear motion", work, quiet=asked.quiet, points=at.size) as progress:
            return bifurcation_diagram(system, swept.name, at, execution=replace(EXECUTION, progress=progress))
    if asked.over is None:
        return None
    found = read(asked.over)
    if "peak_to_peak" not in found or swept.name not in found.coords or found[swept.name].ndim != 1:
        raise InputError(f"--over: {asked.over} holds no diagram against the speed, expected one of"
                         f" `whirlmap bifurcation --vary {swept.name}=... --out NAME.nc`")  # fmt: skip
    return found


def _beside(system: "System", ds: "xr.Dataset", diagram: "xr.Dataset") -> dict[str, Any]:
    """Peak to peak of the nonlinear motions at the probed places, those that ran to their end."""
    name, quantities = system.speed, diagram["quantity"].values.tolist()
    along = diagram["peak_to_peak"].dims[-2]
    ways = [diagram.sel(direction=d) for d in diagram["direction"].values] if "direction" in diagram.dims else [diagram]
    speeds, swings = [], []
    for one in ways:
        ended = one["status"].values == Status.ok
        speeds.append(one[name].values[ended])
        swings.append(one["peak_to_peak"].transpose(along, "quantity").values[ended])
    missing = [q for q in ds["probe"].values.ravel().tolist() if q not in quantities]
    if missing:
        raise InputError(f"--over: the diagram has no {missing[0]}, expected one of {system.case}")
    columns = [[quantities.index(q) for q in pair] for pair in ds["probe"].values.tolist()]
    swing = np.concatenate(swings)[:, columns].transpose(1, 2, 0)
    measure = {"measure": system.model.parameter(name).measure}
    return {
        "nonlinear_speed": variable("motion", np.concatenate(speeds), "1", "speed of the nonlinear motion", **measure),
        "nonlinear": variable(
            ("station", "axis", "motion"), swing, "1", "peak to peak of the nonlinear motion", measure="length"
        ),
    }


def _size(ds: "xr.Dataset", shown: "xr.Dataset") -> float:
    """How many of the shown unit the speed's own unit is."""
    name = str(ds.attrs["varied"])
    return float(shown[name].values[-1] / ds[name].values[-1])


def _criticals(ds: "xr.Dataset", operating: tuple[float, float]) -> list[dict[str, Any]]:
    slowest, fastest = operating
    rows = []
    for k in range(ds.sizes["peak"]):
        one = ds.isel(peak=k)
        low, high = (v if np.isfinite(v) else None for v in (float(one["critical_low"]), float(one["critical_high"])))
        peak = Critical(float(one["critical"]), float(one["critical_amplitude"]), low, high)
        margin, required = peak.margin(slowest, fastest), peak.required(slowest)
        rows.append({
            "rotor": str(one["critical_rotor"].values), "station": str(one["critical_station"].values),
            "speed": peak.speed, "amplitude": peak.amplitude, "amplification": peak.factor, "one_sided": peak.one_sided,
            "half_power": [low, high], "margin": margin, "required_margin": required,
            "enough": None if required is None else margin >= required,
        })  # fmt: skip
    return rows


def _facts(ds: "xr.Dataset", operating: tuple[float, float]) -> dict[str, Any]:
    name = str(ds.attrs["varied"])
    beside = None
    if "nonlinear" in ds:
        beside = {"values": ds["nonlinear_speed"].values, "peak_to_peak": ds["nonlinear"].values}
    return {
        "varied": name, "values": ds[name].values, "rotors": ds["rotor"].values, "stations": ds["station"].values,
        "axes": ds["axis"].values, "probes": ds["probe"].values,
        **{key: ds[key].values for key in ("amplitude", "phase", "major", "total", "stable", "status")},
        "operating_range": list(operating), "critical": _criticals(ds, operating), "nonlinear": beside,
    }  # fmt: skip


def _units(ds: "xr.Dataset") -> dict[str, str]:
    speed = ds[str(ds.attrs["varied"])].attrs["units"]
    return {"values": speed, "amplitude": ds["amplitude"].attrs["units"], "phase": ds["phase"].attrs["units"]}


def _print(system: "System", ds: "xr.Dataset", operating: tuple[float, float]) -> None:
    name = str(ds.attrs["varied"])
    at, unit, length = ds[name].values, ds[name].attrs["units"], ds["amplitude"].attrs["units"]
    head = report.with_unit(name, unit)
    typer.echo(f"{system.case}: response to unbalance, {head} from {at[0]:.6g} to {at[-1]:.6g}, {at.size} points")
    slowest, fastest = operating
    span = f"{slowest:.6g}" if slowest == fastest else f"{slowest:.6g} to {fastest:.6g}"
    typer.echo(f"range of operation: {span}{report.unit_behind(unit)}")
    near = int(np.nanargmin(np.abs(at - fastest)))
    rows = [
        (rotor, station, axis, *(f"{v:.4g}" for v in (
            2 * float(one.max()), at[int(np.nan_to_num(one.values, nan=-1.0).argmax())], 2 * float(one[near]),
            np.degrees(float(ds["phase"].sel(rotor=rotor, station=station, axis=axis)[near])) % 360,
        )))
        for rotor in ds["rotor"].values for station in ds["station"].values for axis in ds["axis"].values
        for one in [ds["amplitude"].sel(rotor=rotor, station=station, axis=axis)]
    ]  # fmt: skip
    swing = report.with_unit("peak to peak", length)
    columns: tuple[str, ...] = ("unbalance of", "station", "axis", f"largest {swing}", f"at {head}", f"at {at[near]:.5g}",
                                "phase lag [deg]")  # fmt: skip
    report.show(report.table("Response to unbalance", columns, rows, numbers=(3, 4, 5, 6)))
    criticals = _criticals(ds, operating)
    if criticals:
        columns = (head, "unbalance of", "station", report.with_unit("semi-major axis", length), "amplification factor",
                   "separation margin", "required by API 617")  # fmt: skip
        found = [
            (f"{c['speed']:.6g}", c["rotor"], c["station"], f"{c['amplitude']:.4g}", _factor(c), report.percent(c["margin"]),
             _required(c)) for c in criticals
        ]  # fmt: skip
        report.show(report.table("Critical speeds", columns, found, numbers=(0, 3, 4, 5, 6)))
    else:
        typer.echo("no response has a peak in this range")
    unstable = at[(ds["stable"].values == 0) & (ds["status"].values == Status.ok)]
    if unstable.size:
        typer.echo(f"the static equilibrium is unstable at {unstable.size} of {at.size} speeds, from {unstable[0]:.6g} on:"
                   " there the machine does not move as this response says")  # fmt: skip
    if "nonlinear" in ds:
        _print_nonlinear(ds, head, swing)


def _factor(one: dict[str, Any]) -> str:
    if one["amplification"] is None:
        return "-"
    return f"{one['amplification']:.3g}{' (one side)' if one['one_sided'] else ''}"


def _required(one: dict[str, Any]) -> str:
    if one["required_margin"] is None:
        return "-"
    if one["required_margin"] == 0.0:
        return "none"
    return f"{report.percent(one['required_margin'])}{'' if one['enough'] else ', not kept'}"


def _print_nonlinear(ds: "xr.Dataset", head: str, swing: str) -> None:
    name, rows = str(ds.attrs["varied"]), []
    for k, speed in enumerate(ds["nonlinear_speed"].values.tolist()):
        for station in ds["station"].values:
            for axis in ds["axis"].values:
                one = ds["total"].sel(station=station, axis=axis)
                linear = float(np.interp(speed, ds[name].values, one.values))
                rows.append((f"{speed:.6g}", station, axis, f"{linear:.4g}",
                             f"{float(ds['nonlinear'].sel(station=station, axis=axis)[k]):.4g}"))  # fmt: skip
    columns = (head, "station", "axis", f"linear {swing}", "nonlinear")
    report.show(report.table("Beside the nonlinear motion", columns, rows, numbers=(0, 3, 4)))
