"""Recorded signals on the command line: the output of ``diagnose --series``."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from whirlmap.analysis.signals.diagnose_series import diagnose_series, series_json
from whirlmap.cli.common import pictures, report
from whirlmap.cli.common.messages import say
from whirlmap.cli.common.outputs import claim
from whirlmap.cli.common.progress import Progress
from whirlmap.cli.common.series_texts import mark, turns_per_second, window_of
from whirlmap.errors import InputError, RangeError
from whirlmap.recordings.column_names import split_unit
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
        rate=rate,
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
    try:
        ds = _judged(signal, turns, teeth, length, quiet=quiet)
    except RangeError as fault:
        raise RangeError(f"{signal.source}: {fault}") from None
    said = ds.attrs["warnings"].split("\n") if ds.attrs["warnings"] else []
    for notice in said:
        say(f"warning: {' '.join(notice.split())}")
    verdict = series_json(ds)
    verdict["lines"] = [
        {**line, "per_sample": line["frequency"] / signal.rate} for line in verdict["indicators"]["spectrum"]["named"]
    ]
    files = destination.write(ds, lambda made: pictures.series(made, file.name))
    windows = _windows(ds)
    if json:
        more = {
            "file": str(file),
            "column": signal.column,
            "column_unit": signal.unit,
            "start": signal.start,
            "speed": ds.attrs.get("speed"),
            "windows": windows,
        }
        report.print_json({**verdict, **more, "warnings": said, "files": files})
        return
    _print(verdict, signal, windows, "standard input" if str(file) == "-" else file.name)
    report.print_written(files)


def _judged(signal: "Signal", turns: float | None, teeth: int | None, length: float | None, *, quiet: bool) -> Any:
    if length is None:
        return diagnose_series(signal, speed=turns, teeth=teeth)
    count = max(int(2 * (signal.values.size / (signal.rate or 1.0) / length - 1)) + 1, 1)
    with Progress("windows", count, quiet=quiet, unit="windows", rate_unit="windows/s") as progress:
        return diagnose_series(signal, speed=turns, teeth=teeth, window=length, progress=progress)


def _windows(ds: Any) -> list[dict[str, Any]]:
    """Windows as plain data, unknown numbers as None."""
    if "window_regime" not in ds:
        return []
    length = ds.attrs["window_length"]
    names = [n for n in ("rms", "frequency", "speed", "order", "order_name") if f"window_{n}" in ds]
    out = []
    for k, start in enumerate(ds["window_start"].values.tolist()):
        each = {name: ds[f"window_{name}"].values[k].item() for name in names}
        out.append(
            {
                "start": start,
                "end": start + length,
                "regime": Regime(int(ds["window_regime"][k])).label,
                "reason": str(ds["window_reason"].values[k]) or None,
                **{name: None if value in ("", None) or value != value else value for name, value in each.items()},
            }
        )
    return out


def _print(verdict: dict[str, Any], signal: "Signal", windows: list[dict[str, Any]], name: str) -> None:
    unit = f" [{signal.unit}]" if signal.unit not in ("", "1") and split_unit(signal.column)[1] != signal.unit else ""
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
        parts.append(_window_table(windows, signal.unit))
    report.show(*parts)


def _window_table(windows: list[dict[str, Any]], unit: str) -> Any:
    turning = "speed" in windows[0]
    rows = [
        (
            f"{w['start']:.6g} to {w['end']:.6g}",
            w["regime"],
            f"{w['rms']:.4g}",
            report.number(w["frequency"]),
            *(_order(w) if turning else ()),
            w["reason"] or "",
        )
        for w in windows
    ]
    beside = ("speed [Hz]", "order", "of the shaft") if turning else ()
    columns = ("time [s]", "regime", f"rms [{unit}]" if unit not in ("", "1") else "rms", "frequency [Hz]", *beside, "why")
    return report.table("Windows", columns, rows, numbers=(2, 3, 4, 5) if turning else (2, 3))


def _order(w: dict[str, Any]) -> tuple[str, str, str]:
    return report.number(w["speed"]), "" if w["order"] is None else f"{w['order']:.4f}", w["order_name"] or ""


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
