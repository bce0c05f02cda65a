"""``whirlmap bench``: speed against accuracy, beside other integrators on this machine."""

from pathlib import Path
from typing import Annotated

import typer

from whirlmap.cli.common import options, report
from whirlmap.cli.common.messages import say
from whirlmap.cli.common.outputs import Looks

EXAMPLES = (
    "whirlmap bench --quick",
    "whirlmap bench --json > bench.json",
    "whirlmap bench --picture bench.svg",
)


def bench(
    quick: Annotated[bool, typer.Option("--quick", help="Fewer tolerances and turns.")] = False,
    picture: Annotated[
        Path | None,
        typer.Option(
            "--picture", metavar="FILE", help="Draw error against time: .svg, .png or .pdf.", rich_help_panel=options.OUTPUT
        ),
    ] = None,
    size: options.Size = None,
    dpi: options.Dpi = None,
    title: options.Title = None,
    force: Annotated[
        bool, typer.Option("--force", help="Replace what --picture names.", rich_help_panel=options.OUTPUT)
    ] = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> None:  # fmt: skip
    """Compare the speed of whirlmap with heyoka, SciPy and plain C on the gear pair, on one core, at equal error.

    A ratio above 1 means that whirlmap is faster. Errors are those after 8T, median over 512 speeds (64 for SciPy),
    against heyoka at a tolerance of 1e-15; time is processor time, the shortest of several turns that all take in one run,
    compilation apart.
    heyoka comes with `pip install 'whirlmap[benchmarks]'`; without it the others are still compared.
    """
    looks = Looks.read(size, dpi, title, picture="" if picture else "--picture FILE")
    if picture is not None:
        from whirlmap.results.files import check_writable

        check_writable(picture, force=force)
    from whirlmap.bench.run import QUICK, Plan, benchmark

    result = benchmark(QUICK if quick else Plan(), (lambda _: None) if quiet else say)
    if picture is not None:
        from whirlmap.bench.report import figure
        from whirlmap.plot.common.save import save

        save(looks.figure(lambda: figure(result)), picture, dpi=looks.dpi)
    if json:
        report.print_json(result)
        return
    from whirlmap.bench.report import ratio_rows

    columns = ("peer", "problem", "median error", "ratio")
    report.show(report.table("Time of others over whirlmap's", columns, ratio_rows(result), numbers=(2, 3)))
    for name, reason in result["missing"].items():
        typer.echo(f"{name}: {reason}")
    if picture is not None:
        report.print_written([picture])
