"""Recorded signals on the command line: the output of ``diagnose --series``."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from whirlmap.analysis.signals.diagnose_series import diagnose_series, series_json
from whirlmap.analysis.signals.order_names import order_name
from whirlmap.analysis.signals.sliding import sliding_verdict
from whirlmap.cli.common import pictures, report
from whirlmap.cli.common.messages import say
from whirlmap.cli.common.outputs import claim
from whirlmap.cli.common.progress import Progress
from whirlmap.cli.common.series_texts import mark, samples_per_second, turns_per_second, window_of
from whirlmap.errors import InputError, RangeError
from whirlmap.recordings.signal import read_signal
from whirlmap.results.regime import Regime

if TYPE_CHECKING:
    from whirlmap.recordings.signal import Signal


def diagnose_file(
    file: Path,
    *,
    column: str | None,
    time: str | None,
    rate: str | None,
    separator: str | None,
    decimal: str | None,
    skip: int,
    missing: list[str] | None,
    window: str | None,
    speed: str | None,
    teeth: int | None,
    out: Path | None,
    size: str | None,
    dpi: int | None,
    title: str | None,
    force: bool,
    json: bool,
    quiet: bool,
) -> None:
    """Do what ``whirlmap diagnose --series`` does."""
    destination = claim(out, "diagnose", force=force, size=size, dpi=dpi, title=title)
    part, length = window_of(window)
    turns, tacho = turns_per_second(speed)
    if teeth is not None and speed is None:
        raise InputError("--teeth: found it without --speed, which it belongs to")

    signal = read_signal(
        file,
        column=column,
        time=time,
        rate=None if rate is None else samples_per_second(rate),
        separator=mark(separator),
        decimal=mark(decimal),
        skip=skip,
        missing=missing or (),
        window=part,
        speed=tacho,
    )
    if signal.rate is None:
        raise InputError(
            f"--rate: missing beside --series; {file} has no times, expected samples per second, as in --rate 25600"
        )
    for notice in signal.notices:
        say(f"warning: {' '.join(notice.split())}")

    try:
        ds = diagnose_series(signal.values, rate=signal.rate)
        slid = _sliding(signal, length, quiet=quiet) if length else None
    except RangeError as fault:
        raise RangeError(f"{signal.source}: {fault}") from None
    verdict = series_json(ds)
    verdict["lines"] = _lines(verdict, signal.rate, turns or signal.speed, teeth)
    files = destination.write(
        ds if slid is None else ds.merge(slid).assign_attrs(**ds.attrs, **slid.attrs),
        lambda made: pictures.series(made, file.name),
    )
    windows = _windows(slid)
    if json:
        more = {
            "file": str(file),
            "column": signal.column,
            "column_unit": signal.unit,
            "start": signal.start,
            "speed": turns or signal.speed,
            "windows": windows,
        }
        report.print_json({**verdict, **more, "warnings": list(signal.notices), "files": files})
        return
    _print(verdict, signal, windows, "standard input" if str(file) == "-" else file.name)
    report.print_written(files)


def _sliding(signal: "Signal", length: float, *, quiet: bool) -> Any:
    rate = signal.rate or 1.0
    count = max(int(2 * (signal.values.size / rate / length - 1)) + 1, 1)
    with Progress("windows", count, quiet=quiet, unit="windows", rate_unit="windows/s") as progress:
        return sliding_verdict(signal.values, rate=rate, length=length, start=signal.start, progress=progress)


def _windows(slid: Any) -> list[dict[str, Any]]:
    if slid is None:
        return []

    rows = zip(
        *(slid[n].values.tolist() for n in ("window_start", "window_regime", "window_rms", "window_frequency")), strict=True
    )
    length = slid.attrs["window_length"]
    return [
        {"start": s, "end": s + length, "regime": Regime(r).label, "rms": v, "frequency": None if f != f else f}
        for s, r, v, f in rows
    ]


def _lines(verdict: dict[str, Any], rate: float, turns: float | None, teeth: int | None) -> list[dict[str, Any]]:
    out = []
    for line in verdict["indicators"]["spectrum"]["named"]:
        f = line["frequency"]
        order = (
            {"order": f / turns, "order_name": order_name(f, turns, teeth, rate / verdict["samples"]) or None}
            if turns
            else {}
        )
        out.append({**line, "per_sample": f / rate, **order})
    return out


def _print(verdict: dict[str, Any], signal: "Signal", windows: list[dict[str, Any]], name: str) -> None:
    unit = f" [{signal.unit}]" if signal.unit and f"[{signal.unit}]" not in signal.column else ""
    typer.echo(f"{name}: {verdict['regime']} (confidence {verdict['confidence']:.2g})")
    typer.echo(
        f"  {signal.column}{unit}: {verdict['samples']} samples at {verdict['rate']:.7g} Hz, "
        f"{verdict['samples'] / verdict['rate']:.6g} s"
        f" from {signal.start:.6g} s ({signal.form})."
    )
    for sentence in str(verdict["verdict"]).split(". "):
        typer.echo(f"  {sentence.rstrip('.')}.")
    parts = []
    if verdict["lines"]:
        ordered = "order" in verdict["lines"][0]
        columns = ("line", "frequency [Hz]", "per sample", "power [%]", *(("order", "of the shaft") if ordered else ()))
        rows = [
            (
                line["name"] or "",
                f"{line['frequency']:.7g}",
                f"{line['per_sample']:.6g}",
                f"{100 * line['share']:.3g}",
                *((f"{line['order']:.4f}", line["order_name"] or "") if ordered else ()),
            )
            for line in verdict["lines"]
        ]
        parts.append(report.table("Strongest lines", columns, rows, numbers=(1, 2, 3, 4)))
    rows = [(name, evidence(vote)) for name, vote in verdict["indicators"].items()]
    parts.append(report.table("Evidence", ("indicator", "says"), rows))
    if windows:
        rows = [
            (f"{w['start']:.6g} to {w['end']:.6g}", w["regime"], f"{w['rms']:.4g}", report.number(w["frequency"]))
            for w in windows
        ]
        parts.append(report.table("Windows", ("time [s]", "regime", "rms", "frequency [Hz]"), rows, numbers=(2, 3)))
    report.show(*parts)


def evidence(vote: dict[str, Any]) -> str:
    """Vote of one indicator of a signal on one line."""
    shown = [str(vote["vote"])] if vote.get("vote") is not None else []
    for key, value in vote.items():
        if key in ("vote", "named", "statistics", "multiples") or value is None or value == []:
            continue
        text = report.number(value) if isinstance(value, float) else value
        if isinstance(value, list):
            text = " ".join(report.number(v) if isinstance(v, float) else str(v) for v in value)
        shown.append(f"{key.replace('_', ' ')} {text}")
    return ", ".join(shown)
