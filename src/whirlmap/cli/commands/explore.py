"""``whirlmap explore``: a map or a diagram in the browser, served on this computer until Ctrl-C."""

import re
import sys
import webbrowser
from dataclasses import replace
from pathlib import Path

import typer

from whirlmap.cli.common import report
from whirlmap.cli.common.assignments import assignments
from whirlmap.cli.common.messages import choice, say
from whirlmap.cli.common.opening import open_system
from whirlmap.cli.common.progress import Progress
from whirlmap.errors import InputError, RangeError
from whirlmap.explorer.exploration import Exploration, explored_case, opened
from whirlmap.explorer.saved.saved_page import completed, saved_page
from whirlmap.explorer.server import Server
from whirlmap.explorer.session import Session
from whirlmap.explorer.with_branches import with_branches
from whirlmap.integrate.own_units import refuse_twice
from whirlmap.integrate.ranges import Range
from whirlmap.options.computed import Labelling
from whirlmap.options.execution import Execution
from whirlmap.results.files import check_writable, replace_file


def explore(
    *, source: str, vary: list[str] | None, follow: str | None, store: Path | None, branches: list[Path] | None,
    case: str | None, changes: list[str] | None, start: list[str] | None, labelling: Labelling, execution: Execution,
    port: int, token: str | None, browser: bool, save: Path | None, force: bool, json: bool, quiet: bool,
) -> None:  # fmt: skip
    """Do what `whirlmap.cli.declared.explore` says."""
    if token is not None and not re.fullmatch(r"[A-Za-z0-9_-]{16,64}", token):
        raise InputError("--token: expected 16 to 64 letters, digits, - and _")
    if save is not None:
        check_writable(save, force=force, as_file=True)
    found = opened(source, case)
    if found is None:
        if case is not None:
            raise InputError(f"--case: {source} is a case itself; expected a store or a file.nc beside it")
        found = _computed(source, vary, follow, store, changes, start, labelling)
    elif beside := [o for o, v in (("--vary", vary), ("--follow", follow), ("--store", store), ("--set", changes),
                                   ("--start", start)) if v]:  # fmt: skip
        raise InputError(f"{', '.join(beside)}: {source} is computed already; expected a CASE beside it")
    found = with_branches(found, branches or [])
    if save is not None:
        _write(found, save, store, execution, force=force, json=json, quiet=quiet)
        return
    with Session(found, workers=execution.workers, store=store) as session:
        try:
            server = Server(session, port, token)
        except OSError as error:
            raise InputError(f"--port {port}: cannot be used ({error.strerror}); 0 takes one that is free") from None
        with server:
            if json:
                report.print_json({"case": found.system.case, "varied": list(found.axes), "address": server.address})
            else:
                typer.echo(server.address)
            sys.stdout.flush()  # who reads the address from a pipe waits for it
            if not quiet:
                say("Ctrl-C ends the page")
            if browser:
                webbrowser.open(server.address)
            try:
                server.serve_forever(poll_interval=0.2)
            except KeyboardInterrupt:
                say("ended")


def _write(
    found: Exploration, place: Path, store: Path | None, execution: Execution, *, force: bool, json: bool, quiet: bool
) -> None:
    """Write the page as a file, after its points where they are still to be computed."""
    if found.axes and found.overview is None:
        with Progress("explore", None, quiet=quiet) as progress:
            found = completed(found, replace(execution, progress=progress), store)
    html = saved_page(found)
    replace_file(place, lambda trial: trial.write_text(html, encoding="utf-8"), force=force)
    if json:
        report.print_json({"case": found.system.case, "varied": list(found.axes), "files": [place]})
    else:
        typer.echo(f"written: {place}")


def _computed(
    source: str, vary: list[str] | None, follow: str | None, store: Path | None, changes: list[str] | None,
    start: list[str] | None, labelling: Labelling,
) -> Exploration:  # fmt: skip
    """A case whose map or diagram is computed while the page looks on."""
    if follow is not None:
        choice("--follow", follow, ("up", "down", "both"))
    system, ranges = open_system(source, changes, start), dict[str, Range]()
    for text in vary or ():
        swept = Range.parse(text)
        refuse_twice(system, set(assignments(changes, "--set")), swept)
        if swept.name in ranges:
            raise RangeError(f"--vary: {swept.name} is given twice: expected each parameter once")
        ranges[swept.name] = swept
    if len(ranges) > 2:
        raise RangeError(f"--vary: found {len(ranges)} parameters, expected one for a diagram or two for a map")
    if (follow is not None and len(ranges) != 1) or (store is not None and len(ranges) != 2):
        raise InputError("--follow goes with one --vary, and --store with two")
    return explored_case(system, ranges, labelling, follow)
