"""``whirlmap bench``: speed against accuracy, beside other integrators on this machine; `benchmarks/contest` measures."""

import sys
from importlib import import_module
from pathlib import Path
from types import ModuleType

from whirlmap.cli.common.checkout import BENCHMARKS, has_comparison
from whirlmap.cli.common.outputs import Looks
from whirlmap.errors import InputError
from whirlmap.results.files import check_writable


def bench(
    *, quick: bool, picture: Path | None, size: str | None, dpi: int | None, title: str | None, force: bool, json: bool,
    quiet: bool,
) -> None:  # fmt: skip
    """Do what `whirlmap.cli.declared.bench` says."""
    looks = Looks.read(size, dpi, title, picture="" if picture else "--picture FILE")
    if picture is not None:
        check_writable(picture, force=force)
    _short().compare(quick=quick, picture=picture, looks=looks, json=json, quiet=quiet)


def _short() -> ModuleType:
    """What compares, out of the checkout that this file lies in."""
    if not has_comparison():
        raise InputError("bench: the comparison is not installed with whirlmap, expected a checkout of its repository: run"
                         " `make bench` there")  # fmt: skip
    if str(BENCHMARKS) not in sys.path:
        sys.path.insert(0, str(BENCHMARKS))
    return import_module("contest.short")
