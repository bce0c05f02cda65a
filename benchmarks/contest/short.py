"""What ``whirlmap bench`` does in a checkout."""

from pathlib import Path

import typer

from contest.report import figure, ratio_rows
from contest.run import QUICK, Plan, benchmark
from whirlmap.cli.common import report
from whirlmap.cli.common.messages import say
from whirlmap.cli.common.outputs import Looks
from whirlmap.plot.common.save import save


def compare(*, quick: bool, picture: Path | None, looks: Looks, json: bool, quiet: bool) -> None:
    """Measure, draw where a picture is named, and print."""
    result = benchmark(QUICK if quick else Plan(), (lambda _: None) if quiet else say)
    if picture is not None:
        save(looks.figure(lambda: figure(result)), picture, dpi=looks.dpi)
    if json:
        report.print_json(result)
        return
    columns = ("peer", "problem", "median error", "ratio")
    report.show(report.table("Time of others over whirlmap's", columns, ratio_rows(result), numbers=(2, 3)))
    for name, reason in result["missing"].items():
        typer.echo(f"{name}: {reason}")
    if picture is not None:
        report.print_written([picture])
