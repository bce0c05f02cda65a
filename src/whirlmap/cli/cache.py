"""``whirlmap cache``: where compiled kernels are kept, how much they take, and clearing them."""

from typing import Annotated

import typer

from whirlmap.cli import options, report

EXAMPLES = (
    "whirlmap cache",
    "whirlmap cache --clear",
    "WHIRLMAP_CACHE=/tmp/kernels whirlmap cache",
)


def cache(
    clear: Annotated[bool, typer.Option("--clear", help="Delete every compiled kernel.")] = False,
    json: options.Json = False,
) -> None:
    """Show the folder of compiled kernels and its size, or clear it.

    A model is compiled the first time that it is run, which takes some seconds to a minute; the machine code
    is kept in this folder. The variable WHIRLMAP_CACHE chooses another one. Clearing is always safe.
    """
    from whirlmap.kernels import cache as kernels

    deleted = kernels.clear() if clear else None
    path, size = kernels.folder(), kernels.size()
    if json:
        report.print_json({"path": path, "bytes": size, "kernels_deleted": deleted})
        return
    typer.echo(f"folder: {path}")
    typer.echo(f"size:   {size / 1e6:.1f} MB")
    if deleted is not None:
        typer.echo(f"deleted: {deleted} kernels")
