"""``whirlmap speeds``: where may this machine run, within a limit of vibration, and why not elsewhere."""

import json as js
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any

import typer

from whirlmap.cli import options, report
from whirlmap.cli.outputs import claim
from whirlmap.cli.progress import Progress
from whirlmap.errors import CaseError, InputError, RangeError, nearest

if TYPE_CHECKING:
    import xarray as xr

    from whirlmap.integrate.system import System

SPEEDS = "Speeds"

EXAMPLES = (
    'whirlmap speeds machines/turbo-gearbox --limit "25 um"',
    'whirlmap speeds gear-psfd/machine --limit "40 um" --range "1500 rpm:9000 rpm" --out speeds.png',
    'whirlmap speeds machines/jeffcott-rig --tolerance c=5% --tolerance M=10% --draws 64',
    "whirlmap speeds gear-psfd/intended --limit 0.6 --range 0.5:4 --points 200 --follow",
)

Limit = Annotated[
    str | None,
    typer.Option(
        "--limit", metavar="LENGTH", rich_help_panel=SPEEDS,
        help='Largest peak-to-peak displacement that is allowed: "20 um", or a number of clearances. The limit in the'
        " case's table [operation] where absent.",
    ),
]  # fmt: skip
Span = Annotated[
    str | None,
    typer.Option(
        "--range", metavar="LOW:HIGH", rich_help_panel=SPEEDS,
        help='Speeds of the first shaft, "500 rpm:6000 rpm", or values of s. The range in the table [operation] where'
        " absent.",
    ),
]  # fmt: skip
Quantity = Annotated[
    str | None,
    typer.Option(
        "--quantity", metavar="NAME", rich_help_panel=SPEEDS,
        help="State or output whose peak-to-peak counts; where absent the largest of the displacements.",
    ),
]  # fmt: skip


def speeds(
    case: options.CaseName,
    limit: Limit = None,
    span: Span = None,
    points: Annotated[
        int, typer.Option("--points", metavar="N", min=2, rich_help_panel=SPEEDS, help="Speeds judged.")
    ] = 100,
    quantity: Quantity = None,
    follow: Annotated[
        bool,
        typer.Option(
            "--follow", rich_help_panel=SPEEDS, help="Run up and down as well, which shows coexisting motions; slower."
        ),
    ] = False,
    tolerance: Annotated[
        list[str] | None,
        typer.Option(
            "--tolerance", metavar="NAME=PERCENT", rich_help_panel=SPEEDS,
            help="Half width of the range from which a parameter or a dimensional input is drawn; may be repeated.",
        ),
    ] = None,
    draws: Annotated[int, typer.Option("--draws", metavar="N", min=1, rich_help_panel=SPEEDS, help="Machines drawn.")] = 64,
    seed: Annotated[int, typer.Option("--seed", metavar="N", min=0, rich_help_panel=SPEEDS, help="Of the draws.")] = 0,
    changes: options.Changes = None,
    start: options.Start = None,
    transient: options.Transient = 100,
    accuracy: options.Accuracy = None,
    method: options.Method = None,
    workers: options.Workers = None,
    out: options.Out = None,
    force: options.Force = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> None:  # fmt: skip
    """Find the windows of speed in which CASE runs periodically and within a limit of vibration.

    Each speed is judged from a cold start, and with --follow on a run up and a run down too. What forbids the speeds
    between the windows is said, and how far the windows reach.
    """
    tolerances = _tolerances(tolerance)
    destination = claim(out, "speeds", force=force)
    system = options.open_system(case, changes, start)
    import numpy as np

    from whirlmap.analysis.settling import Settling
    from whirlmap.sweep.run import expected_periods
    from whirlmap.sweep.speeds import safe_probability, safe_speeds

    allowed = limit_of(system, limit)
    low, high = range_of(system, span)
    at, settling = np.linspace(low, high, points), Settling(transient=transient)
    judged = points * ((3 if follow else 1) + (draws if tolerances else 0))
    with Progress("speeds", expected_periods(system, judged, settling), quiet=quiet) as progress:
        ds = safe_speeds(
            system, at, allowed, quantity=quantity, follow=follow, settling=settling, accuracy=accuracy, method=method,
            workers=workers, progress=progress,
        )  # fmt: skip
        if tolerances:
            drawn, limits = _drawn(system, case, options.assignments(changes, "--set"), tolerances, draws, seed, allowed)
            chance = safe_probability(
                system, drawn, at, limits, quantity=quantity, settling=settling, accuracy=accuracy, method=method,
                workers=workers, progress=progress,
            )  # fmt: skip
            report.say_doubts(chance.attrs)
            ds = ds.merge(chance, combine_attrs="override")
            ds = ds.assign_attrs(seed=seed, draws=draws, tolerances=js.dumps(tolerances))
    files = destination.write(ds, lambda made: _picture(system, made))
    report.say_doubts(ds.attrs)
    facts = summary(system, ds)
    if json:
        report.print_json({**facts, "files": files})
    else:
        _print(facts)
        report.print_written(files)


def _given(system: "System", name: str) -> float | None:
    found = (getattr(system.details, "inputs", None) or {}).get(name)
    return None if found is None else float(found.value)


def _read(text: str, unit: str, option: str) -> float:
    from whirlmap.units import read

    try:
        return float(read(text, unit))
    except CaseError as error:
        raise InputError(f"{option}: {error}") from None


def limit_of(system: "System", text: str | None) -> float:
    """The limit in the model's length."""
    clearance = _given(system, "c")
    if text is None:
        limit = _given(system, "limit")
        if limit is None or clearance is None:
            raise InputError(f'--limit: {system.case} has none of its own; expected one, as in --limit "20 um"')
        return limit / clearance
    try:
        plain = float(text)
    except ValueError:
        if clearance is None:
            raise InputError(
                f"--limit: found {text!r}, but {system.case} has no dimensions; expected a number of its lengths"
            ) from None
        return _read(text, "m", "--limit") / clearance
    if clearance is not None and plain > 100:
        raise InputError(f'--limit: found {text} clearances, expected a length with its unit, as in "20 um", or fewer')
    return plain


def range_of(system: "System", text: str | None) -> tuple[float, float]:
    """The range in values of s."""
    from whirlmap.sweep.speeds import shaft_speed

    scale = shaft_speed(system)
    if text is None:
        low, high = _given(system, "speed_min"), _given(system, "speed_max")
        if low is None or high is None:
            raise InputError(f'--range: {system.case} has none of its own; expected one, as in --range "500 rpm:6000 rpm"')
        return low / scale, high / scale
    parts = [part.strip() for part in text.split(":")]
    if len(parts) != 2:
        raise InputError(f'--range: found {text!r}, expected LOW:HIGH, as in "500 rpm:6000 rpm" or 0.5:4')
    ends = []
    for part in parts:
        try:
            ends.append(float(part))
        except ValueError:
            if not scale == scale:
                raise InputError(
                    f"--range: found {part!r}, but {system.case} has no dimensions; expected values of s"
                ) from None
            ends.append(_read(part, "rad/s", "--range") / scale)
    if not 0 < ends[0] < ends[1]:
        raise RangeError(f"--range: found {text!r}, expected two positive speeds, the lower one first")
    return ends[0], ends[1]


def _tolerances(texts: Sequence[str] | None) -> dict[str, float]:
    found = {}
    for name, text in options.assignments(texts, "--tolerance").items():
        try:
            half = float(text.removesuffix("%")) / (100 if text.endswith("%") else 1)
        except ValueError:
            half = -1.0
        if not 0 < half < 1:
            raise InputError(f"--tolerance: found {name}={text}, expected a share between 0 and 100 %, as in c=5%")
        found[name] = half
    return found


def _drawn(
    system: "System", case: str, changes: dict[str, str], tolerances: dict[str, float], count: int, seed: int, limit: float
) -> tuple[list["System"], list[float]]:  # fmt: skip
    """Machines drawn evenly from the ranges of their inputs, and the limit of each in its own clearances."""
    import numpy as np

    from whirlmap.integrate.loading import load

    inputs = getattr(system.details, "inputs", None) or {}
    for name in tolerances:
        if name not in inputs and name not in system.parameters:
            raise InputError(
                f"--tolerance: {system.case} is not given {name!r}.{nearest(name, [*inputs, *system.parameters])}"
                f"\n  inputs: {' '.join(inputs)}\n  parameters: {' '.join(system.parameters)}"
            )
    random, clearance = np.random.default_rng(seed), _given(system, "c")
    machines, limits = [], []
    for _ in range(count):
        changed: dict[str, Any] = dict(changes)
        for name, half in tolerances.items():
            factor = 1 + half * random.uniform(-1, 1)
            if name in inputs:
                changed[name] = f"{inputs[name].value * factor!r} {inputs[name].parameter.unit}"
            else:
                changed[name] = float(system.values[name]) * factor
        machine = load(case, start=dict(system.start), **changed)
        machines.append(machine)
        own = _given(machine, "c")
        limits.append(limit * clearance / own if clearance and own else limit)
    return machines, limits


def summary(system: "System", ds: "xr.Dataset") -> dict[str, Any]:
    """Say what was found, as plain data."""
    from collections import Counter

    from whirlmap.sweep.speeds import Verdict, shaft_speed

    scale = shaft_speed(system) * 30 / 3.141592653589793
    clearance = _given(system, "c")
    windows = js.loads(ds.attrs["windows"])
    for window in windows:
        if scale == scale:
            window["rpm"] = [window["window_start"] * scale, window["window_end"] * scale]
        if clearance:
            window["amplitude_um"] = window["window_amplitude"] * clearance * 1e6
    counted = Counter(Verdict(int(v)).name for v in ds["verdict"].values)
    limit = float(ds.attrs["limit"])
    facts: dict[str, Any] = {
        "case": system.case, "limit": limit, "limit_um": limit * clearance * 1e6 if clearance else None,
        "quantities": ds.attrs["quantities"].split(), "followed": bool(ds.attrs["followed"]), "windows": windows,
        "verdicts": dict(counted), "s": ds["s"].values.tolist(),
        "verdict": [Verdict(int(v)).name for v in ds["verdict"].values],
        "amplitude": ds["amplitude"].values.tolist(), "rpm": ds["rpm"].values.tolist() if "rpm" in ds else None,
    }  # fmt: skip
    if "probability" in ds:
        facts |= {name: ds[name].values.tolist() for name in ("probability", "probability_low", "probability_high")}
    return facts


def _print(facts: dict[str, Any]) -> None:
    um = facts["limit_um"]
    limit = f"{facts['limit']:.4g} clearances" + (f", {um:.4g} um" if um else "")
    typer.echo(f"{facts['case']}: peak to peak of {', '.join(facts['quantities'])} at most {limit}")
    rows = []
    for w in facts["windows"]:
        span = f"{w['window_start']:.4f} .. {w['window_end']:.4f}"
        rpm = f"{w['rpm'][0]:.0f} .. {w['rpm'][1]:.0f}" if "rpm" in w else "-"
        swing = f"{w['window_amplitude']:.3g}" + (f" ({w['amplitude_um']:.1f} um)" if "amplitude_um" in w else "")
        rows.append((span, rpm, swing, w["below"].replace("_", "-"), w["above"].replace("_", "-")))
    if rows:
        report.show(report.table("Safe windows", ("s", "rpm", "amplitude", "below", "above"), rows))
    else:
        typer.echo("no safe speed")
    counted = ", ".join(f"{n} {name.replace('_', '-')}" for name, n in facts["verdicts"].items())
    typer.echo(f"{len(facts['s'])} speeds: {counted}")
    if "probability" in facts:
        least, most = min(facts["probability"]), max(facts["probability"])
        typer.echo(f"share of the drawn machines that are safe: {least:.2f} to {most:.2f} over the speeds")


def _picture(system: "System", ds: "xr.Dataset") -> Any:
    from whirlmap.plot.speeds import speeds_figure

    clearance = _given(system, "c")
    return speeds_figure(
        ds, unit=clearance * 1e6 if clearance else 1.0, length="um" if clearance else "1", title=system.case
    )
