"""``whirlmap bench``: speed against accuracy, beside other integrators on this machine; `benchmarks/contest` measures."""

import sys
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Annotated

import typer

from whirlmap.cli.common import options
from whirlmap.cli.common.outputs import Looks
from whirlmap.errors import InputError
from whirlmap.results.files import check_writable

#: Where the comparison is in a checkout.
CHECKOUT = Path(__file__).parents[4] / "benchmarks"

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
    heyoka comes with `pip install 'whirlmap[benchmarks]'`; without it the others are still compared. The comparison is no
    part of an installed whirlmap: it runs in a checkout of the repository.
    """
    looks = Looks.read(size, dpi, title, picture="" if picture else "--picture FILE")
    if picture is not None:
        check_writable(picture, force=force)
    _short().compare(quick=quick, picture=picture, looks=looks, json=json, quiet=quiet)


def _short() -> ModuleType:
    """What compares, out of the checkout that this file lies in."""
    if not (CHECKOUT / "contest").is_dir():
        raise InputError("bench: the comparison is not installed with whirlmap, expected a checkout of its repository: run"
                         " `make bench` there")  # fmt: skip
    if str(CHECKOUT) not in sys.path:
        sys.path.insert(0, str(CHECKOUT))
    return import_module("contest.short")
