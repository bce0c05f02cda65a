"""``whirlmap cache``: where compiled kernels are kept, how much they take, and clearing them."""

from typing import Annotated

import typer

from whirlmap.cli.common import options, report

EXAMPLES = (
    "whirlmap cache",
    "whirlmap cache --clear",
    "WHIRLMAP_CACHE=/tmp/kernels whirlmap cache",
    "WHIRLMAP_ROOTS=divisions whirlmap cache",
)


def cache(
    clear: Annotated[bool, typer.Option("--clear", help="Delete all that is kept.")] = False,
    json: options.Json = False,
) -> None:
    """Show the folder of compiled kernels, its size and what kernels are compiled for, or clear it.

    A model is lowered and compiled the first time that it is run, which takes some seconds to a minute; the
    expressions and the machine code are kept in this folder. The variable WHIRLMAP_CACHE chooses another one.
    Clearing is always safe.

    Kernels compute roots and reciprocals by the processor's estimates or by divisions, whichever was measured to be faster
    on its model. WHIRLMAP_ROOTS=estimates or divisions overrides that; results differ by rounding. WHIRLMAP_CPU=x86-64-v3
    compiles for a common processor.
    """
    from whirlmap.kernels import cache as kernels
    from whirlmap.kernels.running.machine import processor
    from whirlmap.kernels.running.root_choice import own_choice, reason

    deleted = kernels.clear() if clear else None
    target, roots, why = processor()[0], own_choice(), reason()
    path, size, (compiled, lowered) = kernels.folder(), kernels.size(), kernels.counts()
    if json:
        gone = {"kernels_deleted": deleted[0] if deleted else None, "lowered_deleted": deleted[1] if deleted else None}
        made_for = {"processor": target, "roots": roots._asdict(), "roots_because": why}
        report.print_json({"path": path, "bytes": size, "kernels": compiled, "lowered": lowered, **gone, **made_for})
        return
    typer.echo(f"folder: {path}")
    typer.echo(f"size:   {size / 1e6:.1f} MB, {_many(compiled, lowered)}")
    typer.echo(f"for:    {target}, roots and reciprocals by {roots} ({why})")
    if deleted is not None:
        typer.echo(f"deleted: {_many(*deleted)}")


def _many(compiled: int, lowered: int) -> str:
    return f"{compiled} kernels and {lowered} lowered expressions"
