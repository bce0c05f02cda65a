"""``whirlmap cache``: where compiled kernels are kept, how much they take, and clearing them."""

import typer

from whirlmap.cli.common import report
from whirlmap.errors import counted
from whirlmap.kernels import cache as kernels
from whirlmap.kernels.running.machine import processor
from whirlmap.kernels.running.root_choice import own_choice, reason


def cache(
    *, clear: bool, json: bool,
) -> None:  # fmt: skip
    """Do what `whirlmap.cli.declared.cache` says."""
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
    return f"{counted(compiled, 'kernel')} and {counted(lowered, 'lowered expression')}"
