"""Options and help of ``whirlmap new``."""

from pathlib import Path
from typing import Annotated

import typer

from whirlmap.cli.common import options

EXAMPLES = (
    "whirlmap new my_gearbox.toml",
    "whirlmap new rig.toml --like machines/jeffcott-rig",
    "whirlmap new my_train.toml --parts",
    "whirlmap new my_rotor.toml --from-ross rotor.toml",
    "whirlmap new my_gearbox.toml && whirlmap show my_gearbox.toml",
)


def new(
    file: Annotated[Path, typer.Argument(metavar="NAME.toml", help="File to write.")],
    like: Annotated[
        str,
        typer.Option("--like", metavar="CASE", help="Machine whose numbers it begins with.", rich_help_panel=options.SYSTEM),
    ] = "gear-psfd/machine",
    parts: Annotated[
        bool,
        typer.Option(
            "--parts", rich_help_panel=options.SYSTEM,
            help="A machine from parts: shafts, bearings, supports, meshes, each in a table of its own.",
        ),
    ] = False,
    from_ross: Annotated[
        Path | None,
        typer.Option(
            "--from-ross", metavar="ROTOR.toml", rich_help_panel=options.SYSTEM,
            help="A machine from parts with the shaft, disks, bearings and supports of a rotor that ROSS saved.",
        ),
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Replace the file.", rich_help_panel=options.OUTPUT)
    ] = False,
    json: options.Json = False,
) -> None:
    """Write a template of a machine: every input with its unit and meaning, filled with the numbers of another one.

    The file loads as it is. Values that the machine does not give stand as comments. With --parts it is a machine from
    parts, that of machines/two-shaft-gearbox.
    """
