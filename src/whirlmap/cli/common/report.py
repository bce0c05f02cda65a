"""Results on standard output: tables for people, one JSON object for programs."""

import json
import math
import os
import sys
from collections.abc import Iterable, Mapping, Sequence
from enum import Enum
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import typer

from whirlmap.cli.common.interrupts import INTERRUPTED
from whirlmap.cli.common.messages import say

if TYPE_CHECKING:
    from rich.console import Console, RenderableType

    from whirlmap.integrate.dimensions import Dimensions
    from whirlmap.integrate.system import System

#: Columns of a table that is piped into a file, where neither a terminal nor COLUMNS says how wide it is.
WIDE = 160


def console() -> "Console":
    """Return the console for standard output."""
    from rich.console import Console  # where JSON is printed it would be imported for nothing

    columns = os.environ.get("COLUMNS", "")
    width = None if sys.stdout.isatty() else int(columns) if columns.isdecimal() and int(columns) else WIDE
    return Console(width=width, highlight=False, soft_wrap=False, markup=False)


def table(title: str, columns: Sequence[str], rows: Iterable[Sequence[object]], *, numbers: Sequence[int] = ()) -> Any:
    """Make a plain table; ``numbers`` are the columns that are set flush right."""
    from rich import box, table, text

    made = table.Table(title=text.Text(title, style="bold"), title_justify="left", box=box.SIMPLE_HEAD, pad_edge=False)
    for i, column in enumerate(columns):
        made.add_column(column, justify="right" if i in numbers else "left", overflow="fold", no_wrap=i == 0)
    for row in rows:
        made.add_row(*(text.Text(cell if isinstance(cell, str) else number(cell)) for cell in row))
    return made


def regimes_table(regimes: Mapping[str, int]) -> Any:
    """Table of how many points each regime has."""
    total = max(sum(regimes.values()), 1)
    rows = [(label, str(n), f"{100 * n / total:.3g} %") for label, n in regimes.items()]
    return table("Regimes", ("regime", "points", "share"), rows, numbers=(1, 2))


def show(*parts: "RenderableType") -> None:
    """Print parts one below the other."""
    to = console()
    for part in parts:
        to.print(part)


def with_unit(name: str, unit: str) -> str:
    """A name with its unit, where it has one: ``yp [um]``; a speed ratio in rpm is a speed."""
    return name if unit == "1" else f"{'speed' if unit == 'rpm' else name} [{unit}]"


def unit_behind(unit: str) -> str:
    """A unit as it stands behind a number, and nothing for a pure number."""
    return "" if unit == "1" else f" {unit}"


def beside(own: Mapping[str, Any], shown: Mapping[str, Any], keys: Iterable[str], units: "Dimensions") -> dict[str, Any]:
    """Facts for JSON: all in the model's own units, and in ``dimensional`` those of these keys in engineering units."""
    return {**own, "dimensional": {key: shown[key] for key in keys}} if units.known else dict(own)


def number(value: Any) -> str:
    """Write a number in at most seven digits; a ratio as it is written; a dash where there is none."""
    if isinstance(value, Fraction):
        return str(value)
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "-"
    return f"{float(value):.7g}"


def percent(share: float) -> str:
    """Write a share in two digits, and never as a power of ten from 0.01 % on: ``100 %``, ``4.1 %``, ``0.024 %``."""
    value = 100 * float(share)
    if not value or not math.isfinite(value):
        return f"{value:g} %"
    digits = max(1 - math.floor(math.log10(abs(value))), 0)
    return f"{value:.{digits}f} %" if abs(value) >= 0.01 else f"{value:.2g} %"


def with_error(value: Any, error: Any) -> str:
    """Write a measured number with its error."""
    if value is None:
        return "-"
    return f"{float(value):.5g}" if error is None else f"{float(value):.5g} +- {float(error):.2g}"


def print_json(content: Mapping[str, Any]) -> None:
    """Print one JSON object, and nothing else, on standard output; what is not finite is null."""
    unicode = (sys.stdout.encoding or "").lower().startswith("utf")  # elsewhere letters are escaped, not replaced
    sys.stdout.write(json.dumps(jsonable(content), ensure_ascii=not unicode, allow_nan=False) + "\n")


def jsonable(value: Any) -> Any:
    """Plain data for JSON: NaN and infinity as None, paths as text, NumPy values as Python's own."""
    if isinstance(value, Mapping):
        return {str(k): jsonable(v) for k, v in value.items()}
    if hasattr(value, "tolist"):
        return jsonable(value.tolist())
    if isinstance(value, list | tuple | set | frozenset):
        return [jsonable(v) for v in value]
    if isinstance(value, Enum):
        return jsonable(value.value)
    if isinstance(value, Path):
        return str(value)
    if isinstance(value, float | Fraction):
        return float(value) if math.isfinite(value) else None
    return value if value is None or isinstance(value, str | int | bool) else str(value)


def say_doubts(attributes: Mapping[Any, Any]) -> None:
    """Say on standard error where the asked accuracy is not met, and what to try, and where motion grazes a surface."""
    if doubts := attributes.get("accuracy_not_met"):
        say(f"accuracy not met: {doubts}")
    if grazing := attributes.get("grazing"):
        say(f"grazing: {grazing}")


def say_doubts_of_branches(attributes: Mapping[Any, Any]) -> None:
    """Say on standard error what could not be made sure on branches, and which events were not looked for."""
    if doubts := attributes.get("doubts"):
        say(f"warning: {doubts}")
    if missing := attributes.get("not_sought"):
        say(f"note: {missing}")


def say_not_declared(system: "System", role: str) -> None:
    """Say on standard error what an answer lacks because the model does not declare a role."""
    if words := system.model.not_declared().get(role):
        say(f"{system.model.name} declares no {role}: {words}")


def print_written(files: Sequence[Path]) -> None:
    """Say which files were written."""
    for file in files:
        sys.stdout.write(f"written: {file}\n")


def interrupted(incomplete: str, files: Sequence[Path], go_on: str) -> NoReturn:
    """Say what was kept and where, and how to go on; ends with the exit code of Ctrl-C.

    Parameters
    ----------
    incomplete : str
        The attribute of that name: ``interrupted after 64 of 200 points``.
    files : sequence of Path
        Those written.
    go_on : str
        How to get the rest, as a sentence.
    """
    where = f"in {' '.join(map(str, files))}" if files else "in what is printed alone, for --out named no place"
    say(f"{incomplete}; the results so far were kept {where}\n  {go_on}")
    raise typer.Exit(INTERRUPTED)
