"""Report of ``whirlmap map --status`` about a store."""

from pathlib import Path

import typer

from whirlmap.cli.common import report
from whirlmap.cli.common.progress import clock
from whirlmap.errors import counted
from whirlmap.sweep.store.store_status import store_standing


def say_status(folder: Path, *, json: bool) -> None:
    """Print how far a store is, and what it has lost."""
    s = store_standing(folder)
    if json:
        report.print_json(s)
        return
    damaged = s["chunks_damaged"] or s["lost"]
    whole = s["chunks_done"] == s["chunks"] and not damaged
    state = "complete" if whole else "running" if s["running"] else "damaged" if damaged else "not running"
    typer.echo(f"{s['store']}: {state}")
    chunks = counted(s["chunks"], "chunk")
    typer.echo(f"{s['chunks_done']} of {chunks}, {s['points_done']} of {counted(s['points'], 'point')}")
    if s["lost"]:
        typer.echo(f"lost: {', '.join(s['lost'])}; the same command with --resume puts them back")
    if s["chunks_damaged"]:
        numbers = ", ".join([*(str(n) for n in s["damaged"][:6]), *(["..."] if len(s["damaged"]) > 6 else [])])
        typer.echo(f"{counted(s['chunks_damaged'], 'damaged chunk')} ({numbers}): --resume computes again")
    if 0 < s["points_computed"] < s["points_done"]:
        typer.echo(f"computed {s['points_computed']} of them, the others are inferred")
    if s["seconds_since"] is not None:
        rate = f", {s['rate']:.3g} points/s" if s["rate"] else ""
        left = f", {clock(s['seconds_left'])} left" if s["running"] and s["seconds_left"] else ""
        typer.echo(f"last chunk {clock(s['seconds_since'])} ago{rate}{left}")
    if s["regimes"]:
        report.show(report.regimes_table(s["regimes"]))
    for number, reason in s["reasons"].items():
        typer.echo(f"chunk {number} failed: {reason}")
