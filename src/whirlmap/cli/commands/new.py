"""``whirlmap new``: a commented case file to start a machine of one's own from."""

from pathlib import Path
from typing import Annotated

import typer

from whirlmap.cli.common import options, report
from whirlmap.errors import InputError

EXAMPLES = (
    "whirlmap new my_gearbox.toml",
    "whirlmap new rig.toml --like machines/jeffcott-rig",
    "whirlmap new my_gearbox.toml && whirlmap show my_gearbox.toml",
)


def new(
    file: Annotated[Path, typer.Argument(metavar="NAME.toml", help="File to write.")],
    like: Annotated[
        str,
        typer.Option("--like", metavar="CASE", help="Machine whose numbers it begins with.", rich_help_panel=options.SYSTEM),
    ] = "gear-psfd/machine",
    force: Annotated[
        bool, typer.Option("--force", help="Replace the file.", rich_help_panel=options.OUTPUT)
    ] = False,
    json: options.Json = False,
) -> None:
    """Write a template of a machine: every input with its unit and meaning, filled with the numbers of another one.

    The file loads as it is. Values that the machine does not give stand as comments.
    """
    if file.suffix != ".toml":
        raise InputError(f"{file}: found the suffix {file.suffix!r}, expected .toml for a case file")
    from whirlmap.results.files import check_writable, replace_file

    check_writable(file, force=force)
    from whirlmap.cases.case import read
    from whirlmap.cases.template import template

    text = template(read(like))
    replace_file(file, lambda place: place.write_text(text, encoding="utf-8"), force=force)
    if json:
        report.print_json({"file": file, "like": like})
    else:
        report.print_written([file])
        typer.echo(f"to see what follows from it:  whirlmap show {file}")
