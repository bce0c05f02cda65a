"""``whirlmap recipes``: tasks with the exact commands, as a list, as text or as JSON."""

from dataclasses import asdict

import typer

from whirlmap.cli.common import report
from whirlmap.cli.common.recipes import recipe
from whirlmap.cli.common.recipes import recipes as known
from whirlmap.errors import InputError


def recipes(
    *, name: str | None, everything: bool, json: bool,
) -> None:  # fmt: skip
    """Do what `whirlmap.cli.declared.recipes` says."""
    if name is not None and everything:
        raise InputError(f"recipes: {name!r} and --all were given, expected one of them")
    chosen = [recipe(name)] if name is not None else list(known().values())
    if json:
        report.print_json({"recipes": [asdict(one) for one in chosen]})
    elif name is not None or everything:
        typer.echo("\n".join(one.text for one in chosen), nl=False)
    else:
        report.show(report.table("Recipes", ("name", "task"), [(one.name, one.title) for one in chosen]))
        typer.echo("the commands of one:  whirlmap recipes NAME\nof all:  whirlmap recipes --all")
