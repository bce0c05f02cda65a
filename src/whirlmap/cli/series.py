"""Recorded signals on the command line: options, what ``diagnose --series`` and ``show --series`` print."""

import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from whirlmap.cli import pictures, report
from whirlmap.cli.messages import say
from whirlmap.cli.outputs import claim
from whirlmap.cli.progress import Progress
from whirlmap.errors import InputError, RangeError

if TYPE_CHECKING:
    from whirlmap.recordings.signal import Signal

PANEL = "Measured signal"

File = Annotated[
    Path | None,
    typer.Option(
        "--series", metavar="FILE", rich_help_panel=PANEL,
        help="A recorded signal instead of a case: text tables of any layout, .wav, .mat, .npy, .npz, .parquet, .nc, .lvm, .tdms,"
        " .uff; - for standard input.",
    ),
]  # fmt: skip
Column = Annotated[
    str | None,
    typer.Option("--column", metavar="NAME", rich_help_panel=PANEL, help="Column of the signal, by its name or its number from 1."),
]
Time = Annotated[
    str | None,
    typer.Option(
        "--time", metavar="NAME", rich_help_panel=PANEL,
        help='Column of the times, by name or number, with its unit where the file says none or another: "t [ms]"; none for no times.',
    ),
]  # fmt: skip
Rate = Annotated[
    str | None,
    typer.Option(
        "--rate", metavar="X", rich_help_panel=PANEL,
        help='Samples per second, or "25.6 kHz"; from the times, or a line above the table, where absent.',
    ),
]  # fmt: skip
Separator = Annotated[
    str | None,
    typer.Option("--separator", metavar="C", rich_help_panel=PANEL, help="Character between fields, tab or blank; found where absent."),
]
Decimal = Annotated[
    str | None,
    typer.Option("--decimal", metavar="C", rich_help_panel=PANEL, help="Decimal mark, . or , ; found where absent."),
]
Skip = Annotated[
    int, typer.Option("--skip", metavar="N", min=0, rich_help_panel=PANEL, help="Lines at the top that are not looked at.")
]
Missing = Annotated[
    list[str] | None,
    typer.Option(
        "--missing", metavar="X", rich_help_panel=PANEL,
        help="A value that means that there is none: -999; nan for what is no number. Up to three in a row are filled, else the longest"
        " part without is read. May be repeated.",
    ),
]  # fmt: skip
Window = Annotated[
    str | None,
    typer.Option(
        "--window", metavar="A:B", rich_help_panel=PANEL,
        help="Part of the record that is judged, in seconds; one number L judges windows of that length too, half a window apart.",
    ),
]  # fmt: skip
Speed = Annotated[
    str | None,
    typer.Option(
        "--speed", metavar="X", rich_help_panel=PANEL,
        help='Speed of the shaft, "1480 rpm", or a column with it or with one pulse per turn: lines are named as orders.',
    ),
]  # fmt: skip
Teeth = Annotated[
    int | None,
    typer.Option("--teeth", metavar="N", min=2, rich_help_panel=PANEL, help="Teeth of the gear on that shaft: mesh and sidebands are named."),
]

_MARKS = {"tab": "\t", "\\t": "\t", "comma": ",", "semicolon": ";", "space": "blank", " ": "blank", "bar": "|", "point": ".", "dot": "."}


def mark(text: str | None) -> str | None:
    """Separator or decimal mark, from a character or its name."""
    return None if text is None else _MARKS.get(text.lower(), text)


def samples_per_second(text: str) -> float:
    """Read ``--rate``: a number, with a unit of frequency or none."""
    found = re.fullmatch(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*([kMG]?)(?:Hz|S/s|Sa/s|sps|/s|1/s)?\s*", text)
    if not found:
        raise InputError(f"--rate: found {text!r}, expected a number of samples per second, or such as '25.6 kHz'")
    return float(found[1]) * {"": 1.0, "k": 1e3, "M": 1e6, "G": 1e9}[found[2]]


def turns_per_second(text: str | None) -> tuple[float | None, str | None]:
    """Read ``--speed``: turns per second, or the name of a column."""
    from whirlmap.recordings.signal import turns_per

    found = re.fullmatch(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*([a-zA-Z/]\S*)\s*", text or "")
    if not found:
        return None, text
    speed = abs(float(found[1])) * turns_per(found[2], f"--speed {text}")
    if speed == 0:
        raise RangeError(f"--speed: found {text!r}, expected a speed that is not zero")
    return speed, None


def window_of(text: str | None) -> tuple[tuple[float, float] | None, float | None]:
    """Read ``--window``: a part, or the length of windows that slide."""
    if text is None:
        return None, None
    try:
        ends = [float(part) if part.strip() else fill for part, fill in zip(text.split(":"), (0.0, float("inf")), strict=False)]
    except ValueError:
        ends = []
    if text.count(":") == 1 and len(ends) == 2 and ends[0] < ends[1]:
        return (ends[0], ends[1]), None
    if ":" not in text and len(ends) == 1 and 0 < ends[0] < float("inf"):
        return None, ends[0]
    raise InputError(f"--window: found {text!r}, expected first and last second, as in 0.5:2.5, or the length of windows, as in 0.5")


def diagnose_file(
    file: Path, *, column: str | None, time: str | None, rate: str | None, separator: str | None, decimal: str | None, skip: int,
    missing: list[str] | None, window: str | None, speed: str | None, teeth: int | None, out: Path | None, force: bool, json: bool,
    quiet: bool,
) -> None:  # fmt: skip
    """Do what ``whirlmap diagnose --series`` does."""
    destination = claim(out, "diagnose", force=force)
    part, length = window_of(window)
    turns, tacho = turns_per_second(speed)
    if teeth is not None and speed is None:
        raise InputError("--teeth: found it without --speed, which it belongs to")
    from whirlmap.recordings.signal import read_signal

    signal = read_signal(
        file, column=column, time=time, rate=None if rate is None else samples_per_second(rate), separator=mark(separator),
        decimal=mark(decimal), skip=skip, missing=missing or (), window=part, speed=tacho,
    )  # fmt: skip
    if signal.rate is None:
        raise InputError(f"--rate: missing beside --series; {file} has no times, expected samples per second, as in --rate 25600")
    for notice in signal.notices:
        say(f"warning: {' '.join(notice.split())}")
    from whirlmap.analysis.series import diagnose_series, series_json

    try:
        ds = diagnose_series(signal.values, rate=signal.rate)
        slid = _sliding(signal, length, quiet=quiet) if length else None
    except RangeError as fault:
        raise RangeError(f"{signal.source}: {fault}") from None
    verdict = series_json(ds)
    verdict["lines"] = _lines(verdict, signal.rate, turns or signal.speed, teeth)
    files = destination.write(ds if slid is None else ds.merge(slid).assign_attrs(**ds.attrs, **slid.attrs), lambda made: pictures.series(made, file.name))
    windows = _windows(slid)
    if json:
        more = {"file": str(file), "column": signal.column, "column_unit": signal.unit, "start": signal.start,
                "speed": turns or signal.speed, "windows": windows}  # fmt: skip
        report.print_json({**verdict, **more, "warnings": list(signal.notices), "files": files})
        return
    _print(verdict, signal, windows, "standard input" if str(file) == "-" else file.name)
    report.print_written(files)


def _sliding(signal: "Signal", length: float, *, quiet: bool) -> Any:
    from whirlmap.analysis.signals.sliding import sliding_verdict

    rate = signal.rate or 1.0
    count = max(int(2 * (signal.values.size / rate / length - 1)) + 1, 1)
    with Progress("windows", count, quiet=quiet, unit="windows", rate_unit="windows/s") as progress:
        return sliding_verdict(signal.values, rate=rate, length=length, start=signal.start, progress=progress)


def _windows(slid: Any) -> list[dict[str, Any]]:
    if slid is None:
        return []
    from whirlmap.results.regime import Regime

    rows = zip(*(slid[n].values.tolist() for n in ("window_start", "window_regime", "window_rms", "window_frequency")), strict=True)
    length = slid.attrs["window_length"]
    return [
        {"start": s, "end": s + length, "regime": Regime(r).label, "rms": v, "frequency": None if f != f else f} for s, r, v, f in rows  # noqa: PLR0124
    ]


def _lines(verdict: dict[str, Any], rate: float, turns: float | None, teeth: int | None) -> list[dict[str, Any]]:
    from whirlmap.analysis.signals.order_names import order_name

    out = []
    for line in verdict["indicators"]["spectrum"]["named"]:
        f = line["frequency"]
        order = {"order": f / turns, "order_name": order_name(f, turns, teeth, rate / verdict["samples"]) or None} if turns else {}
        out.append({**line, "per_sample": f / rate, **order})
    return out


def _print(verdict: dict[str, Any], signal: "Signal", windows: list[dict[str, Any]], name: str) -> None:
    unit = f" [{signal.unit}]" if signal.unit else ""
    typer.echo(f"{name}: {verdict['regime']}")
    typer.echo(f"  {signal.column}{unit}: {verdict['samples']} samples at {verdict['rate']:.7g} Hz, {verdict['samples'] / verdict['rate']:.6g} s"
               f" from {signal.start:.6g} s ({signal.form}).")  # fmt: skip
    for sentence in str(verdict["verdict"]).split(". "):
        typer.echo(f"  {sentence.rstrip('.')}.")
    parts = []
    if verdict["lines"]:
        ordered = "order" in verdict["lines"][0]
        columns = ("line", "frequency [Hz]", "per sample", "power [%]", *(("order", "of the shaft") if ordered else ()))
        rows = [
            (line["name"] or "", f"{line['frequency']:.7g}", f"{line['per_sample']:.6g}", f"{100 * line['share']:.3g}",
             *((f"{line['order']:.4f}", line["order_name"] or "") if ordered else ()))
            for line in verdict["lines"]
        ]  # fmt: skip
        parts.append(report.table("Strongest lines", columns, rows, numbers=(1, 2, 3, 4)))
    rows = [(name, evidence(vote)) for name, vote in verdict["indicators"].items()]
    parts.append(report.table("Evidence", ("indicator", "says"), rows))
    if windows:
        rows = [(f"{w['start']:.6g} to {w['end']:.6g}", w["regime"], f"{w['rms']:.4g}", report.number(w["frequency"])) for w in windows]
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


def show_file(
    file: Path, *, time: str | None, separator: str | None, decimal: str | None, skip: int, json: bool
) -> None:
    """Do what ``whirlmap show --series`` does."""
    from whirlmap.recordings.description import describe_file

    facts = describe_file(file, time=time, separator=mark(separator), decimal=mark(decimal), skip=skip)
    for notice in facts["warnings"]:
        say(f"warning: {' '.join(notice.split())}")
    if json:
        report.print_json(facts)
        return
    typer.echo(f"{facts['file']}: {facts['form']}, {facts['rows']} rows")
    told = f"times in {facts['time']}" if facts["time"] else "no times"
    typer.echo(f"{told}; " + (f"{facts['rate']:.7g} samples per second" if facts["rate"] else "rate unknown: --rate says it"))
    rows = [
        (str(c["position"]), c["name"] or "", c["unit"] or "", c["kind"], c["minimum"], c["maximum"],
         f"{c['missing']}, first on {c['first_missing']}" if c["missing"] else "")
        for c in facts["columns"]
    ]  # fmt: skip
    columns = ("", "column", "unit", "kind", "minimum", "maximum", "missing")
    report.show(report.table("Columns", columns, rows, numbers=(4, 5)))


def options_given(**given: Any) -> list[str]:
    """Names of the options of signals that were given, for refusing them without ``--series``."""
    return [f"--{name}" for name, value in given.items() if value not in (None, 0, [])]

