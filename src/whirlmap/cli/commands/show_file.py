"""Recorded signals on the command line: the output of ``show --series``."""

from pathlib import Path

import typer

from whirlmap.cli.common import report
from whirlmap.cli.common.messages import say
from whirlmap.cli.common.series_texts import mark
from whirlmap.errors import counted
from whirlmap.recordings.description import describe_file


def show_file(file: Path, *, time: str | None, separator: str | None, decimal: str | None, skip: int, json: bool) -> None:
    """Do what ``whirlmap show --series`` does."""
    facts = describe_file(file, time=time, separator=mark(separator), decimal=mark(decimal), skip=skip)
    for notice in facts["warnings"]:
        say(f"warning: {' '.join(notice.split())}")
    if json:
        report.print_json(facts)
        return
    typer.echo(f"{facts['file']}: {facts['form']}, {counted(facts['rows'], 'row')}")
    told = f"times in {facts['time']}" if facts["time"] else "no times"
    unknown = "rate unknown: give it to diagnose, as --rate"
    typer.echo(f"{told}; " + (f"{facts['rate']:.7g} samples per second" if facts["rate"] else unknown))
    rows = [
        (
            str(c["position"]),
            c["name"] or "",
            c["unit"] or "",
            c["kind"],
            c["minimum"],
            c["maximum"],
            f"{c['missing']}, first on {c['first_missing']}" if c["missing"] else "",
        )
        for c in facts["columns"]
    ]
    columns = ("", "column", "unit", "kind", "minimum", "maximum", "missing")
    report.show(report.table("Columns", columns, rows, numbers=(4, 5)))
