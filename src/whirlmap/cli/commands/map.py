"""``whirlmap map``: regimes over a grid of parameters, or over random draws, in a store that survives interruptions."""

import shlex
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import typer

from whirlmap.cli.commands.continue_orbit import facts_of
from whirlmap.cli.common import interrupts, pictures, report
from whirlmap.cli.common.assignments import assignments
from whirlmap.cli.common.messages import choice, say
from whirlmap.cli.common.opening import open_system
from whirlmap.cli.common.outputs import claim
from whirlmap.cli.common.progress import Progress
from whirlmap.cli.common.states_shown import swing_of
from whirlmap.cli.common.store_status import say_status
from whirlmap.cli.common.violated import say_assumptions
from whirlmap.errors import InputError, RangeError, counted, nearest
from whirlmap.integrate.accuracy import StepVerdict
from whirlmap.integrate.dimensions import Dimensions
from whirlmap.integrate.own_units import refuse_input, refuse_twice
from whirlmap.integrate.ranges import Range
from whirlmap.options.computed import Labelling
from whirlmap.options.execution import Execution
from whirlmap.options.storage import Storage
from whirlmap.results.memory import refuse_points
from whirlmap.results.regime import Regime
from whirlmap.sweep.branches.event_curve import KINDS, event_curve
from whirlmap.sweep.maps.run_sweep import run_sweep
from whirlmap.sweep.parameters.random_draws import Tolerance
from whirlmap.sweep.parameters.space import space_of
from whirlmap.sweep.store.zarr_store import Store

if TYPE_CHECKING:
    import xarray as xr

    from whirlmap.equations.model import Model
    from whirlmap.integrate.system import System
    from whirlmap.sweep.maps.run_sweep import ChunkReport
    from whirlmap.sweep.parameters.space import Space


def map(  # noqa: A001 (the command's name)
    *, case: str | None, vary: list[str] | None, draw: list[str] | None, draws: int | None, seed: int, refine: bool,
    sections: bool, curves: str | None, changes: list[str] | None, start: list[str] | None, store: Path | None, resume: bool,
    status: Path | None, share: str | None, dask: str | None, chunk: int | None, labelling: Labelling, execution: Execution,
    plot: str | None, dimensionless: bool, out: Path | None, size: str | None, dpi: int | None, title: str | None,
    force: bool, json: bool, quiet: bool,
) -> None:  # fmt: skip
    """Do what `whirlmap.cli.declared.map` says."""
    if status is not None:
        if case or vary or draw or store:
            raise InputError("--status reads a store that is there: expected nothing beside it but --json")
        say_status(status, json=json)
        return
    if case is None:
        raise InputError("found no CASE, expected the name or path of one, or --status DIR")
    part = _share(share)
    destination = claim(out, "map", force=force, size=size, dpi=dpi, title=title)
    space = None
    system = open_system(case, changes, start)
    space = _space(system, vary, draw, draws, seed, assignments(changes, "--set"))
    quantity = _quantity(system, plot)
    wanted = _events(curves, space)
    if out is not None and len(space.dims) > 2:
        raise RangeError(f"--out: found {len(space.dims)} dimensions, expected at most two for a picture; use --store")

    watch = _Watch(space.points, quiet=quiet)
    units = Dimensions(system, own=dimensionless)
    with TemporaryDirectory(prefix="whirlmap-") as passing:
        place = Path(passing) / "map" if store is None and not (resume or part or dask) else store
        try:
            with watch.bar:
                ds = run_sweep(
                    system, space, labelling, replace(execution, cluster=dask), Storage(place, resume, force, part, chunk),
                    refine=refine, sections=sections, on_chunk=watch,
                )  # fmt: skip
        except KeyboardInterrupt:
            files = []
            if store is None and (kept := watch.kept(place)) is not None:
                files = destination.write(kept, lambda done: pictures.regime_map(units, done, quantity))
            if json and watch.last is not None:
                now = f"interrupted after {watch.last.points_done} of {counted(watch.last.points_total, 'point')}"
                report.print_json({
                    "case": system.case, "model": system.model.name, "varied": list(space.varied),
                    **watch.facts(space.points, refine), "store": store, "files": files, "incomplete": now,
                })  # fmt: skip
            say(watch.interrupted(store, files))
            raise typer.Exit(interrupts.INTERRUPTED) from None
        found = _curves(system, space, wanted, labelling, execution, quiet=quiet)
        files = destination.write(ds, lambda done: pictures.regime_map(units, done, quantity, list(found.values())))
    if watch.last is not None and (doubts := doubtful(watch.last.verdicts, system.model)):
        say(f"accuracy not met: {doubts}")
    assumptions = say_assumptions(system, {name: values[[0, -1]] for name, values in space.axes.items()}, space.units)
    facts = {
        "case": system.case, "model": system.model.name, "varied": list(space.varied),
        **watch.facts(space.points, refine), "assumptions": assumptions, "store": store, "files": files,
        "incomplete": None, "curves": [c for each in found.values() for c in facts_of(system, each)["curves"]],
    }  # fmt: skip
    if json:
        report.print_json(facts)
    else:
        _print(facts)
        report.print_written(files)
    if watch.last is not None and watch.last.failed:
        say(f"{counted(watch.last.failed, 'chunk')} failed; --status says why, and --resume tries again")
        raise typer.Exit(1)


def _events(curves: str | None, space: "Space") -> list[str]:
    """Events whose curves are asked for."""
    if curves is None:
        return []
    if list(space.dims) != list(space.axes) or len(space.axes) != 2:
        raise InputError("--curves: expected a map over two parameters, each with --vary")
    wanted = [name.strip() for name in curves.split(",")]
    for name in wanted:
        choice("--curves", name, KINDS)
    return wanted


def _curves(
    system: "System", space: "Space", wanted: Sequence[str], labelling: Labelling, execution: Execution, *, quiet: bool
) -> "dict[str, xr.Dataset]":
    """Curves of these events in the plane of a map; what is not found is said."""
    out: dict[str, xr.Dataset] = {}
    for event in wanted:
        ends = {
            name: [f"{end!r} {space.units.get(name, '')}".strip() for end in values[[0, -1]].tolist()]
            for name, values in space.axes.items()
        }
        with Progress("continue", None, quiet=quiet, unit="steps", rate_unit="steps/s") as progress:
            try:
                ds = event_curve.parts(
                    system, ends, event, labelling=labelling, execution=replace(execution, progress=progress)
                ).run().dataset  # fmt: skip
            except RangeError as error:
                say(f"--curves {event}: {error}")
                continue
        if ds is not None:
            out[event] = ds
    return out


def doubtful(verdicts: Mapping[int, int], model: "Model") -> str:
    """Say how many points do not meet the accuracy, and what to try."""
    doubtful = {v: n for v, n in sorted(verdicts.items()) if v != StepVerdict.met}
    return "; ".join(f"{counted(n, 'point')}: {StepVerdict(v).advice(model)}" for v, n in doubtful.items())


class _Watch:
    """Shows the progress of a sweep, and remembers how far it came."""

    def __init__(self, points: int, *, quiet: bool) -> None:
        self.bar = Progress("map", points, quiet=quiet, unit="points", rate_unit="points/s")
        self.last: ChunkReport | None = None
        self.told = 0

    def __call__(self, now: "ChunkReport") -> None:
        """Take over what a chunk has added."""
        for message in now.messages[self.told :]:
            say(message)
        self.told = len(now.messages)
        self.last = now
        done, total = now.points_done, now.points_total
        self.bar.expect(total - done + now.points, f"{done} of {counted(total, 'point')}: {_shares(now.regimes)}")
        self.bar(now.points - self.bar.done)

    def kept(self, place: Path | None) -> "xr.Dataset | None":
        """What is finished of a sweep whose store does not stay; None where nothing is."""
        if place is None or self.last is None or not self.last.points_done:
            return None
        now = self.last
        return Store(place).open().load().assign_attrs(
            incomplete=f"interrupted after {now.points_done} of {counted(now.points_total, 'point')}"
        )  # fmt: skip
    def interrupted(self, store: Path | None, files: Sequence[Path]) -> str:
        """Say what is kept and how to go on."""
        if self.last is None or not (store or self.last.done):
            return "interrupted: nothing was finished, so nothing was kept"
        done = f"interrupted: {self.last.done} of {counted(self.last.total, 'chunk')} done and"
        if store is None:
            names = " ".join(str(file) for file in files)
            where = f"were kept in {names}" if files else "lost, for neither --out nor --store was given"
            return f"{done} {where}\n  with --store DIR the next run can be gone on with"
        again = [Path(sys.argv[0]).name, *(word for word in sys.argv[1:] if word not in ("--resume", "--force")), "--resume"]
        return f"{done} kept in {store}; continue with\n  {shlex.join(again)}"

    def facts(self, points: int, refine: bool) -> dict[str, Any]:
        """What the sweep came to."""
        assert self.last is not None
        now = self.last
        found = {
            "points": now.points_total, "chunks": now.total, "chunks_failed": now.failed,
            "regimes": {Regime(k).label: n for k, n in now.regimes.most_common()},
        }  # fmt: skip
        if refine:
            found |= {"computed": now.computed, "uniform_grid": points}
        return found


def _shares(regimes: Any) -> str:
    total = max(sum(regimes.values()), 1)
    return ", ".join(f"{Regime(k).label} {100 * n / total:.3g} %" for k, n in regimes.most_common())


def _share(text: str | None) -> tuple[int, int] | None:
    if text is None:
        return None
    try:
        i, n = (int(word) for word in text.split("/"))
    except ValueError:
        raise InputError(f"--share: found {text!r}, expected I/N, as in 3/8") from None
    if not 1 <= i <= n:
        raise InputError(f"--share: found {text!r}, expected I/N with I from 1 to N")
    return i, n


def _space(
    system: "System", vary: Sequence[str] | None, draw: Sequence[str] | None, draws: int | None, seed: int,
    changed: dict[str, str],
) -> "Space":  # fmt: skip
    ranges: dict[str, Range] = {}
    for text in vary or ():
        swept = Range.parse(text)
        refuse_twice(system, set(changed), swept)
        if swept.name in ranges:
            raise RangeError(f"--vary: {swept.name} is given twice: expected each parameter once")
        ranges[swept.name] = swept
    refuse_points([*(swept.count for swept in ranges.values()), *([draws] if draws else [])])
    texts = assignments(draw, "--draw")
    if bool(texts) != (draws is not None):
        raise InputError("--draw and --draws go together: which parameters, and how many draws")
    if seed and not texts:
        raise InputError("--seed: expected --draw beside it, for nothing else is random")
    if not ranges and not texts:
        raise InputError("found neither --vary nor --draw, expected one: --vary s=0.3:5:400 --vary psi=1e-5:1:300:log")
    for name in texts:
        if name in changed:
            raise RangeError(f"{name}: found it in --set and in --draw, expected it in one of them")
        refuse_input(system, name, "--draw")
        if name not in system.parameters:
            raise RangeError(
                f"--draw: {system.model.name} has no parameter {name!r}.{nearest(name, system.parameters)}"
                f"\n  parameters: {' '.join(system.parameters)}"
            )
    tolerances = {name: Tolerance.parse(text, float(system.values[name])) for name, text in texts.items()}
    return space_of(system, ranges, tolerances, draws or 0, seed, "--vary")


def _quantity(system: "System", plot: str | None) -> str:
    known = [*system.states, *system.model.outputs]
    if plot is None:
        return swing_of(system)[0]
    if plot not in known:
        raise RangeError(f"--plot: {system.model.name} has no state or output {plot!r}.{nearest(plot, known)}"
                         f"\n  states and outputs: {' '.join(known)}")  # fmt: skip
    return plot


def _print(facts: dict[str, Any]) -> None:
    points = counted(facts["points"], "point")
    typer.echo(f"{facts['case']}: {' and '.join(facts['varied'])}, {points} in {counted(facts['chunks'], 'chunk')}")
    if "computed" in facts:
        whole = facts["uniform_grid"]
        typer.echo(
            f"computed {counted(facts['computed'], 'point')}; a uniform grid of this resolution takes {whole},"
            f" {whole / max(facts['computed'], 1):.3g} times as many"
        )
    report.show(report.regimes_table(facts["regimes"]))
    if facts["store"]:
        typer.echo(f"store: {facts['store']}")
