"""``whirlmap map``: regimes over a grid of parameters, or over random draws, in a store that survives interruptions."""

import shlex
import signal
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from whirlmap.cli import options, pictures, report
from whirlmap.cli.messages import say
from whirlmap.cli.outputs import claim
from whirlmap.cli.progress import Progress, clock
from whirlmap.errors import InputError, RangeError, nearest

if TYPE_CHECKING:

    from whirlmap.integrate.system import System
    from whirlmap.sweep.space import Space
    from whirlmap.sweep.stored import Progress as Chunks

SWEEP, STORE = "Sweep", "Store and machines"

EXAMPLES = (
    "whirlmap map duffing --vary gamma=0.1:0.7:200 --vary omega=0.6:1.6:150 --store duffing.map --out duffing.png",
    "whirlmap map gear-psfd/machine --vary s=0.3:5:400 --vary psi=1e-5:1:300:log --store machine.map --refine",
    "whirlmap map gear-psfd/machine --vary s=0.3:5:400 --vary psi=1e-5:1:300:log --store machine.map --share 3/8",
    "whirlmap map gear-psfd/machine --draw psi=uniform:20% --draw xi_m=normal:5% --draws 1000 --store draws.map",
    "whirlmap map --status machine.map",
)


def map(  # noqa: A001 (the command's name)
    case: Annotated[str | None, typer.Argument(metavar="CASE", help="Name or path of a case, as of every command.")] = None,
    vary: Annotated[
        list[str] | None,
        typer.Option(
            "--vary", metavar="NAME=START:STOP:COUNT[:log]", rich_help_panel=SWEEP,
            help="Parameter and range, ascending; given twice for a map, once for a line.",
        ),
    ] = None,
    draw: Annotated[
        list[str] | None,
        typer.Option(
            "--draw", metavar="NAME=TOLERANCE", rich_help_panel=SWEEP,
            help="Parameter that is drawn at random: uniform:LOW:HIGH, normal:MEAN:SPREAD, or uniform:10% and normal:3%"
            " of the case's value. May be repeated.",
        ),
    ] = None,
    draws: Annotated[
        int | None, typer.Option("--draws", metavar="N", min=1, rich_help_panel=SWEEP, help="Number of random draws.")
    ] = None,
    seed: Annotated[
        int, typer.Option("--seed", metavar="N", min=0, rich_help_panel=SWEEP, help="Master seed of the random draws.")
    ] = 0,
    refine: Annotated[
        bool,
        typer.Option(
            "--refine", rich_help_panel=SWEEP,
            help="Compute every eighth point along both parameters, then only points near differing labels, down to the"
            " grid; the others get the label of their surroundings and are marked as inferred.",
        ),
    ] = False,
    sections: Annotated[
        bool,
        typer.Option(
            "--sections", rich_help_panel=SWEEP,
            help="Keep the section of every point, once per T: with one --vary the store holds a bifurcation diagram.",
        ),
    ] = False,
    changes: options.Changes = None,
    start: options.Start = None,
    store: Annotated[
        Path | None,
        typer.Option(
            "--store", metavar="DIR", rich_help_panel=STORE,
            help="Folder of the Zarr store; xarray.open_zarr opens it. Without it nothing is kept but --out.",
        ),
    ] = None,
    resume: Annotated[
        bool,
        typer.Option(
            "--resume", rich_help_panel=STORE,
            help="Go on with what the store holds; begin it where it is absent, empty or half-made.",
        ),
    ] = False,
    status: Annotated[
        Path | None,
        typer.Option("--status", metavar="DIR", rich_help_panel=STORE, help="Say how far a store is, running or dead."),
    ] = None,
    share: Annotated[
        str | None,
        typer.Option(
            "--share", metavar="I/N", rich_help_panel=STORE,
            help="Work on share I of N of the chunks (I from 1): the jobs of a Slurm array work on one store with"
            " --share $SLURM_ARRAY_TASK_ID/N. Run again, a share goes on where it was.",
        ),
    ] = None,
    dask: Annotated[
        str | None,
        typer.Option(
            "--dask", metavar="ADDRESS", rich_help_panel=STORE,
            help="Compute on the workers of the Dask scheduler at this address, tcp://host:8786; they need the store's"
            " folder under the same path.",
        ),
    ] = None,
    chunk: Annotated[
        int | None,
        typer.Option(
            "--chunk", metavar="N", min=1, rich_help_panel=STORE,
            help="Points in one task; chosen by a pilot where absent, so that a task takes about 3 s.",
        ),
    ] = None,
    workers: options.Workers = None,
    transient: options.Transient = 100,
    most: options.Most = 64,
    tolerance: options.Tolerance = 1e-6,
    lyapunov: options.Lyapunov = None,
    steps: options.Steps = None,
    accuracy: options.Accuracy = None,
    method: options.Method = None,
    plot: Annotated[
        str | None,
        typer.Option(
            "--plot", metavar="QUANTITY", rich_help_panel=options.OUTPUT,
            help="State or output whose amplitude (peak to peak) gives the contour lines; the first displacement"
            " where absent.",
        ),
    ] = None,
    out: options.Out = None,
    size: options.Size = None,
    dpi: options.Dpi = None,
    title: options.Title = None,
    force: Annotated[
        bool,
        typer.Option(
            "--force", rich_help_panel=options.OUTPUT,
            help="Replace what --out names, and, without --resume, what --store names.",
        ),
    ] = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> None:  # fmt: skip
    """Label the regime of every point of a grid over parameters of CASE.

    Every point says its regime, exponent, amplitudes, largest eccentricity and thinnest film, and how its run ended. Chunks
    of points are committed one by one: after a crash, a kill or Ctrl-C the same command with --resume goes on, and the
    result is the same to the bit.
    """
    if status is not None:
        if case or vary or draw or store:
            raise InputError("--status reads a store that is there: expected nothing beside it but --json")
        _say_status(status, json=json)
        return
    if case is None:
        raise InputError("found no CASE, expected the name or path of one, or --status DIR")
    part = _share(share)
    destination = claim(out, "map", force=force, size=size, dpi=dpi, title=title)
    space = None
    system = options.open_system(case, changes, start)
    space = _space(system, vary, draw, draws, seed, options.assignments(changes, "--set"))
    quantity = _quantity(system, plot)
    if out is not None and len(space.dims) > 2:
        raise RangeError(f"--out: found {len(space.dims)} dimensions, expected at most two for a picture; use --store")
    from whirlmap.analysis.labels.labelling import Labelling
    from whirlmap.analysis.settling import Settling
    from whirlmap.sweep.stored import run_sweep

    settling = Settling(transient=transient, most=most, tolerance=tolerance)
    labelling = Labelling(settling, lyapunov, steps, accuracy, method, workers=1)
    watch = _Watch(space.points, quiet=quiet)
    before = signal.signal(signal.SIGTERM, _interrupt)  # Slurm ends a job with it
    try:
        with watch.bar:
            ds = run_sweep(
                system, space, labelling, store=store, resume=resume, force=force, share=part, cluster=dask, refine=refine,
                sections=sections, workers=workers, chunk=chunk, on_chunk=watch,
            )  # fmt: skip
    except KeyboardInterrupt:
        say(watch.interrupted(store))
        raise typer.Exit(130) from None
    finally:
        signal.signal(signal.SIGTERM, before)
    files = destination.write(ds, lambda done: pictures.regime_map(system, done, quantity))
    if watch.last is not None and (doubts := doubtful(watch.last.verdicts)):
        say(f"accuracy not met: {doubts}")
    facts = {
        "case": system.case, "model": system.model.name, "varied": list(space.names),
        **watch.facts(space.points, refine), "store": store, "files": files,
    }  # fmt: skip
    if json:
        report.print_json(facts)
    else:
        _print(facts)
        report.print_written(files)
    if watch.last is not None and watch.last.failed:
        say(f"{watch.last.failed} chunks failed; --status says why, and --resume tries them again")
        raise typer.Exit(1)


def doubtful(verdicts: Mapping[int, int]) -> str:
    """Say how many points do not meet the accuracy, and what to try."""
    from whirlmap.integrate.accuracy import Verdict

    return "; ".join(f"{n} points: {Verdict(v).advice}" for v, n in sorted(verdicts.items()) if v != Verdict.met)


def _interrupt(signum: int, frame: object) -> None:  # noqa: ARG001 (a signal's handler)
    raise KeyboardInterrupt


class _Watch:
    """Shows the progress of a sweep, and remembers how far it came."""

    def __init__(self, points: int, *, quiet: bool) -> None:
        self.bar = Progress("map", points, quiet=quiet, unit="points", rate_unit="points/s")
        self.last: Chunks | None = None
        self.told = 0

    def __call__(self, now: "Chunks") -> None:
        """Take over what a chunk has added."""
        for message in now.messages[self.told :]:
            say(message)
        self.told = len(now.messages)
        self.last = now
        done, total = now.points_done, now.points_total
        self.bar.expect(total - done + now.points, f"{done} of {total} points: {_shares(now.regimes)}")
        self.bar(now.points - self.bar.done)

    def interrupted(self, store: Path | None) -> str:
        """Say what is kept and how to go on."""
        if self.last is None or store is None:
            return "interrupted: nothing was finished, so nothing was kept"
        again = [Path(sys.argv[0]).name, *(word for word in sys.argv[1:] if word not in ("--resume", "--force")), "--resume"]
        return (
            f"interrupted: {self.last.done} of {self.last.total} chunks are done and kept in {store}; go on with\n"
            f"  {shlex.join(again)}"
        )

    def facts(self, points: int, refine: bool) -> dict[str, Any]:
        """What the sweep came to."""
        from whirlmap.results.regime import Regime

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
    from whirlmap.results.regime import Regime

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
    from whirlmap.cli.bifurcation import refuse_input
    from whirlmap.sweep.grid import Range
    from whirlmap.sweep.memory import refuse_points
    from whirlmap.sweep.space import Space
    from whirlmap.sweep.tolerances import Tolerance

    ranges: dict[str, Range] = {}
    for text in vary or ():
        swept = Range.parse(text)
        if swept.name in ranges:
            raise RangeError(f"--vary: {swept.name} is given twice: expected each parameter once")
        ranges[swept.name] = swept
    refuse_points([*(swept.count for swept in ranges.values()), *([draws] if draws else [])])
    axes = {name: swept.values for name, swept in ranges.items()}
    texts = options.assignments(draw, "--draw")
    if bool(texts) != (draws is not None):
        raise InputError("--draw and --draws go together: which parameters, and how many draws")
    if seed and not texts:
        raise InputError("--seed: expected --draw beside it, for nothing else is random")
    if not axes and not texts:
        raise InputError("found neither --vary nor --draw, expected one: --vary s=0.3:5:400 --vary psi=1e-5:1:300:log")
    for name in (*axes, *texts):
        option = "--vary" if name in axes else "--draw"
        if name in changed:
            raise RangeError(f"{name}: found it in --set and in {option}, expected it in one of them")
        refuse_input(system, name, option)
        if name not in system.parameters:
            raise RangeError(
                f"{option}: {system.model.name} has no parameter {name!r}.{nearest(name, system.parameters)}"
                f"\n  parameters: {' '.join(system.parameters)}"
            )
    tolerances = {name: Tolerance.parse(text, float(system.values[name])) for name, text in texts.items()}
    return Space(axes, tolerances, draws or 0, seed)


def _quantity(system: "System", plot: str | None) -> str:
    known = [*system.states, *system.model.outputs]
    if plot is None:
        return pictures.swing_of(system)[0]
    if plot not in known:
        raise RangeError(f"--plot: {system.model.name} has no state or output {plot!r}.{nearest(plot, known)}"
                         f"\n  states and outputs: {' '.join(known)}")  # fmt: skip
    return plot


def _print(facts: dict[str, Any]) -> None:
    typer.echo(f"{facts['case']}: {' and '.join(facts['varied'])}, {facts['points']} points in {facts['chunks']} chunks")
    if "computed" in facts:
        whole = facts["uniform_grid"]
        typer.echo(
            f"computed {facts['computed']} points; a uniform grid of this resolution takes {whole},"
            f" {whole / max(facts['computed'], 1):.3g} times as many"
        )
    _table(facts["regimes"])
    if facts["store"]:
        typer.echo(f"store: {facts['store']}")


def _table(regimes: dict[str, int]) -> None:
    total = max(sum(regimes.values()), 1)
    rows = [(label, str(n), f"{100 * n / total:.3g} %") for label, n in regimes.items()]
    report.show(report.table("Regimes", ("regime", "points", "share"), rows, numbers=(1, 2)))


def _say_status(folder: Path, *, json: bool) -> None:
    from whirlmap.sweep.standing import store_standing

    s = store_standing(folder)
    if json:
        report.print_json(s)
        return
    damaged = s["chunks_damaged"] or s["lost"]
    whole = s["chunks_done"] == s["chunks"] and not damaged
    state = "complete" if whole else "running" if s["running"] else "damaged" if damaged else "not running"
    typer.echo(f"{s['store']}: {state}")
    typer.echo(f"{s['chunks_done']} of {s['chunks']} chunks, {s['points_done']} of {s['points']} points")
    if s["lost"]:
        typer.echo(f"lost: {', '.join(s['lost'])}; the same command with --resume puts them back")
    if s["chunks_damaged"]:
        numbers = ", ".join([*(str(n) for n in s["damaged"][:6]), *(["..."] if len(s["damaged"]) > 6 else [])])
        typer.echo(f"{s['chunks_damaged']} damaged chunks ({numbers}): --resume computes them again")
    if 0 < s["points_computed"] < s["points_done"]:
        typer.echo(f"computed {s['points_computed']} of them, the others are inferred")
    if s["seconds_since"] is not None:
        rate = f", {s['rate']:.3g} points/s" if s["rate"] else ""
        left = f", {clock(s['seconds_left'])} left" if s["running"] and s["seconds_left"] else ""
        typer.echo(f"last chunk {clock(s['seconds_since'])} ago{rate}{left}")
    if s["regimes"]:
        _table(s["regimes"])
    for number, reason in s["reasons"].items():
        typer.echo(f"chunk {number} failed: {reason}")
