"""Options and help of ``whirlmap recipes``."""

from typing import Annotated

import typer

from whirlmap.cli.common import options

EXAMPLES = (
    "whirlmap recipes",
    "whirlmap recipes safe-speeds",
    "whirlmap recipes --all",
    "whirlmap recipes --json",
)


def recipes(
    name: Annotated[
        str | None, typer.Argument(metavar="NAME", help="Recipe to print; without it they are listed.", show_default=False)
    ] = None,
    everything: Annotated[
        bool, typer.Option("--all", help="Print every recipe, as text.", rich_help_panel=options.OUTPUT)
    ] = False,
    json: options.Json = False,
) -> None:
    """Print ten tasks with the exact commands that answer them.

    The commands of a recipe are typed in their order, in an empty folder. They are those that the tests of whirlmap run.
    """
