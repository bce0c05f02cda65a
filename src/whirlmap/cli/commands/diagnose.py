"""``whirlmap diagnose``: the regime of one operating point, with all indicators."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import typer

from whirlmap.analysis.diagnosis.diagnosis import RUNS
from whirlmap.analysis.diagnosis.diagnosis import diagnose as measure
from whirlmap.analysis.diagnosis.diagnosis_json import verdict_json
from whirlmap.cli.common import pictures, report
from whirlmap.cli.common.opening import open_system
from whirlmap.cli.common.options import INTEGRATION
from whirlmap.cli.common.outputs import claim
from whirlmap.cli.common.progress import Progress
from whirlmap.cli.common.series_texts import options_given
from whirlmap.cli.common.violated import say_assumptions
from whirlmap.errors import InputError
from whirlmap.integrate.dimensions import Dimensions
from whirlmap.integrate.harmonics import LONGEST
from whirlmap.integrate.in_units import shown_in
from whirlmap.options.computed import Labelling
from whirlmap.options.execution import Execution

#: Keys of the numbers per unit of time.
RATES = ("lyapunov", "lyapunov_error", "divergence", "divergence_error", "phase_exponent", "growth_rate")


def diagnose(
    *, case: str | None, changes: list[str] | None, start: list[str] | None, labelling: Labelling, execution: Execution,
    exponents: int | None, max_periods: int, points: int, series: Path | None, column: str | None, time: str | None,
    rate: str | None, separator: str | None, decimal: str | None, skip: int, missing: list[str] | None, window: str | None,
    speed: str | None, teeth: int | None, dimensionless: bool, out: Path | None, size: str | None, dpi: int | None,
    title: str | None, force: bool, json: bool, quiet: bool,
) -> None:  # fmt: skip
    """Do what `whirlmap.cli.declared.diagnose` says."""
    if series is not None:
        given = {"CASE": case, "--set": changes, "--start": start, "--exponents": exponents,
                 **{f"--{name}": getattr(labelling.integration, name) for name in INTEGRATION}}  # fmt: skip
        for name, value in given.items():
            if value:
                raise InputError(f"{name}: found it beside --series, which diagnoses a signal without equations")
        from whirlmap.cli.commands.diagnose_file import diagnose_file  # SciPy and xarray, which no diagnosis of a case needs

        diagnose_file(
            series, column=column, time=time, rate=rate, separator=separator, decimal=decimal, skip=skip, missing=missing,
            window=window, speed=speed, teeth=teeth, out=out, size=size, dpi=dpi, title=title, force=force,
            json=json, quiet=quiet,
        )  # fmt: skip
        return
    for name in options_given(
        column=column, time=time, rate=rate, separator=separator, decimal=decimal, skip=skip, missing=missing, window=window,
        speed=speed, teeth=teeth,
    ):  # fmt: skip
        raise InputError(f"{name}: found it without --series FILE, which it belongs to")
    if case is None:
        raise InputError("missing CASE: name of a stock case, or the path of a case file; or --series FILE\n"
                         "  try: whirlmap diagnose --help")  # fmt: skip
    destination = claim(out, "diagnose", force=force, size=size, dpi=dpi, title=title)
    system = open_system(case, changes, start)

    settling = labelling.settling
    longest = RUNS * (system.strobe * (settling.transient + 4 * settling.most + points // RUNS) + max_periods)
    with Progress("diagnose", max(longest, 1), quiet=quiet, most=True) as progress:
        found = measure.find(
            system, exponent_count=exponents, max_periods=max_periods, points=points, labelling=labelling,
            execution=replace(execution, progress=progress),
        )  # fmt: skip
    report.say_doubts(found.attrs)
    assumptions = say_assumptions(system)
    plain, units = verdict_json(found), Dimensions(system, own=dimensionless)
    own = _in_units(plain, plain, Dimensions(system, own=True))
    verdict = _in_units(plain, verdict_json(shown_in(units, found)), units)
    files = destination.write(found, lambda made: pictures.diagnosis(units, made))
    if json:
        facts = report.beside(own, verdict, (*RATES, "drift_rate", "end_time", "amplitude", "min_film", "units"), units)
        report.print_json({**facts, "case": system.case, "assumptions": assumptions, "files": files})
    else:
        typer.echo(f"{system.case}: {headline(verdict)}")
        _print(verdict)
        report.print_written(files)


def _in_units(own: dict[str, Any], found: dict[str, Any], units: "Dimensions") -> dict[str, Any]:
    """A verdict whose numbers are in these units, with the units beside them; ``own`` is in the model's."""
    rate, time, length = (units.of(measure) for measure in ("rate", "time", "length"))
    amplitude = {
        name: {**sizes, "units": dict.fromkeys(sizes, units.quantity(name).unit)}
        for name, sizes in found["amplitude"].items()
    }
    drift, drifts = own["drift_rate"], units.quantity(own["drift_state"] or "")
    votes = dict(own["indicators"])
    if "lyapunov" in votes:
        sizes = {key: votes["lyapunov"][key] for key in ("value", "error")}
        votes["lyapunov"] = votes["lyapunov"] | {k: None if v is None else v * rate.size for k, v in sizes.items()}
    return {
        **own, **{key: found[key] for key in (*RATES, "end_time")}, "amplitude": amplitude, "indicators": votes,
        "drift_rate": None if drift is None else drift * drifts.size * rate.size,
        "min_film": {name: None if film is None else film * length.size for name, film in own["min_film"].items()},
        "units": {
            **dict.fromkeys(RATES, rate.unit), "end_time": time.unit, "min_film": length.unit,
            "drift_rate": drifts.unit if rate.unit == "1" else f"{drifts.unit}/s",
        },
    }  # fmt: skip


def headline(verdict: dict[str, Any]) -> str:
    """Say the regime in a few words: ``periodic, 4T, 1 common period, 4 turns of forcing``."""
    units = {key: report.unit_behind(unit) for key, unit in verdict["units"].items()}
    per_time = units["growth_rate"] or " per unit of time"
    words = [str(verdict["regime"])]
    if verdict["regime"] == "periodic":
        words.append(f"{verdict['period']}T")
        many = verdict["period_common"]
        words.append(f"{many} common period{'s' if many != 1 else ''}")
        words += [f"{turns:.6g} of {clock}" for clock, turns in (verdict["period_turns"] or {}).items()]
    elif verdict["regime"] == "locked":
        n = verdict["period"]
        words.append(f"{'' if n is None else f'{n}-fold '}to a forcing that does not repeat within {LONGEST} T")
    elif verdict["regime"] in ("contact", "diverged"):
        words.append(f"at time {report.number(verdict.get('end_time'))}{units['end_time']}")
        words += [str(verdict["end_reason"])] if verdict.get("end_reason") else []
    elif verdict["regime"] == "not-settled":
        turns, power = (report.number(verdict[name]) for name in ("rotation_number", "thinning"))
        film = f"{turns} turns per T, a film thins as time to the power {power}"
        words.append("contracts to an orbit that was not reached" if verdict["thinning"] is None else film)
    elif verdict["regime"] == "drifting":
        per = units["drift_rate"] if units["growth_rate"] else f"{units['drift_rate']} per unit of time"
        words.append(f"{verdict['drift_state']} by {report.number(verdict['drift_rate'])}{per}")
    elif verdict["regime"] in ("growing", "at-rest") and verdict["growth_rate"] is not None:
        words.append(f"small motions change at the rate {report.number(verdict['growth_rate'])}{per_time}")
    return ", ".join(words)


def _print(verdict: dict[str, Any]) -> None:
    agree = f"{verdict['starts_agree']} of {verdict['starts']} start states agree"
    typer.echo(f"status: {verdict['status']}; {agree}; confidence {report.percent(verdict['confidence'] or 0.0)}")
    columns_of = (verdict[key] for key in ("lyapunov", "lyapunov_error", "lyapunov_per_common_period"))
    rows: list[tuple[Any, ...]] = [
        (str(i), report.with_error(v, e), c) for i, (v, e, c) in enumerate(zip(*columns_of, strict=True), 1)
    ]
    units = verdict["units"]
    per_time = "per unit of time" if units["lyapunov"] == "1" else f"[{units['lyapunov']}]"
    columns: tuple[str, ...] = ("", per_time, "per common period")
    if rows:
        rows.append(("mean divergence", report.with_error(verdict["divergence"], verdict["divergence_error"]), None))
    parts = [report.table("Lyapunov exponents", columns, rows, numbers=(0, 1, 2))] if rows else []
    rows = [
        ("Kaplan-Yorke dimension", report.number(verdict["kaplan_yorke"])),
        (
            "correlation dimension",
            report.with_error(verdict["correlation_dimension"], verdict["correlation_dimension_error"]),
        ),
    ]
    parts.append(report.table("Dimensions", ("", "value"), rows, numbers=(1,)))
    rows = [(name, _evidence(vote)) for name, vote in verdict["indicators"].items()]
    parts.append(report.table("Evidence", ("indicator", "says"), rows))
    rows = [
        (report.with_unit(name, a["units"]["rms"]), a["peak_to_peak"], a["rms"]) for name, a in verdict["amplitude"].items()
    ]
    parts.append(report.table("Amplitude", ("", "peak to peak", "rms about mean"), rows, numbers=(1, 2)))
    if verdict["max_eccentricity"]:
        rows = [(name, e, verdict["min_film"][name]) for name, e in verdict["max_eccentricity"].items()]
        film = "thinnest film over c" if units["min_film"] == "1" else f"thinnest film [{units['min_film']}]"
        columns = ("", "largest eccentricity", film)
        parts.append(report.table("Films", columns, rows, numbers=(1, 2)))
    report.show(*parts)


def _evidence(vote: dict[str, Any]) -> str:
    vote = dict(vote)
    lines = vote.pop("named", None)
    shown = [str(vote["vote"])] if vote.get("vote") is not None else []
    shown += [
        f"{key.replace('_', ' ')} {report.number(v) if isinstance(v, float) else v}"
        for key, v in vote.items()
        if key != "vote" and v is not None
    ]
    if lines:
        shown.append("lines at " + ", ".join(_line(line) for line in lines[:5]))
    return ", ".join(shown)


def _line(line: dict[str, Any]) -> str:
    """Name of a line, else its frequency, and its share of the power."""
    return f"{line['name'] or format(line['frequency'], '.5g')} ({report.percent(line['share'])})"
