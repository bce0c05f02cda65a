"""``whirlmap new``: a commented case file to start a machine of one's own from."""

from pathlib import Path

import typer

from whirlmap.cases.case import read
from whirlmap.cases.from_ross import from_ross as rotor_of_ross
from whirlmap.cases.template import template
from whirlmap.cli.common import report
from whirlmap.errors import InputError
from whirlmap.results.files import check_writable, replace_file

#: Machines that templates begin with.
DEFAULT, FROM_PARTS = "gear-psfd/machine", "machines/two-shaft-gearbox"


def new(
    *, file: Path, like: str, parts: bool, from_ross: Path | None, force: bool, json: bool,
) -> None:  # fmt: skip
    """Do what `whirlmap.cli.declared.new` says."""
    if file.suffix != ".toml":
        raise InputError(f"{file}: found the suffix {file.suffix!r}, expected .toml for a case file")

    check_writable(file, force=force)

    if parts:
        if like != DEFAULT:
            raise InputError(f"--like: found {like!r} beside --parts, which begins with {FROM_PARTS}; expected one of them")
        like = FROM_PARTS
    if from_ross is not None and (parts or like != DEFAULT):
        raise InputError("--from-ross: found it beside --like or --parts, expected one of them")
    text = template(read(like)) if from_ross is None else rotor_of_ross(from_ross)
    replace_file(file, lambda place: place.write_text(text, encoding="utf-8"), force=force)
    if json:
        report.print_json({"file": file, "like": like if from_ross is None else str(from_ross)})
    else:
        report.print_written([file])
        typer.echo(f"to see what follows from it:  whirlmap show {file}")
