"""Regime maps: every point of a grid, or of random draws, labelled into a store that can be interrupted and continued."""

import json
import time
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from whirlmap.analysis.points import run_attributes
from whirlmap.analysis.settling import Settling
from whirlmap.errors import OutputError, RangeError
from whirlmap.integrate.ensemble import cores
from whirlmap.integrate.loading import pieces
from whirlmap.integrate.system import System
from whirlmap.results.files import check_writable
from whirlmap.results.provenance import as_json
from whirlmap.sweep.executors import Job, Outcome, in_dask, in_threads
from whirlmap.sweep.identity import kernel_hash
from whirlmap.sweep.points import Labelling, points_dataset
from whirlmap.sweep.refine import COARSE
from whirlmap.sweep.space import Chunks, Space, chunk_size
from whirlmap.sweep.store import EVALUATION, Evaluation, clear_trials, create, exists, half_made, remove
from whirlmap.sweep.tolerances import Tolerance
from whirlmap.version import __version__

#: Points of the pilot that the chunks' size follows from, and the seconds that a chunk should take.
PILOT, SECONDS = 64, 3.0
#: Share of the points that refinement is taken to evaluate when the size of its chunks is chosen.
REFINED = 0.25
#: Format of the manifest.
FORMAT = 1


@dataclass
class Progress:
    """How far a sweep is, handed to its callback after every chunk.

    Attributes
    ----------
    done, failed, total : int
        Chunks.
    points : int
        Points of the chunks done in this run.
    evaluated, evaluated_all : int
        Points that were computed, not inferred: of these, and with earlier runs.
    points_total, points_done : int
        Points of the sweep (of this share of it), and those that are done, earlier runs included.
    regimes : Counter
        Points of each regime so far, earlier runs included.
    messages : list of str
        What was found on the way: damaged chunks, failures.
    """

    total: int
    points_total: int
    done: int = 0
    failed: int = 0
    points: int = 0
    evaluated: int = 0
    evaluated_all: int = 0
    points_done: int = 0
    regimes: Counter[int] = field(default_factory=Counter)
    messages: list[str] = field(default_factory=list)


OnChunk = Callable[[Progress], None]


def regime_map(
    system: System,
    vary: Mapping[str, ArrayLike],
    *,
    store: str | Path | None = None,
    resume: bool = False,
    force: bool = False,
    share: tuple[int, int] | None = None,
    cluster: Any = None,
    refine: bool = False,
    settling: Settling | None = None,
    lyapunov: int = 256,
    steps: int | None = None,
    accuracy: float | None = None,
    method: str | None = None,
    workers: int | None = None,
    chunk: int | None = None,
    on_chunk: OnChunk | None = None,
) -> xr.Dataset:
    """Label every point of a grid over one or more parameters.

    Parameters
    ----------
    vary : mapping of str to array
        Ascending values of each varied parameter; they become the dimensions, in this order.
    store : path, optional
        Folder of the Zarr store, which `xarray.open_zarr` opens; its parent exists. Where absent nothing is kept on disk.
    resume : bool
        Go on with what the store holds; begin it where it is absent, empty or half-made.
    force : bool
        Replace an existing store; with ``resume`` it has no meaning.
    share : (i, n), optional
        Work on share i of n of the chunks only, i from 1: the jobs of an array each take one, on one store.
    cluster : str, dask cluster or client, optional
        Where the chunks are computed: the address of a Dask scheduler, or an object; threads of this process where absent.
    refine : bool
        Compute a coarse lattice, then only the points near differing labels; the others take the label of their
        surroundings, and ``evaluation`` says so. Wants two parameters.
    settling, lyapunov, steps, accuracy, method
        As in `label_points`.
    workers : int, optional
        Threads, each of which computes one chunk; all cores where absent.
    chunk : int, optional
        Points of a chunk; where absent such that one takes about 3 seconds.
    on_chunk : callable, optional
        Called with `Progress` after every chunk.

    Returns
    -------
    xr.Dataset
        The variables of `label_points` over the varied parameters, and ``evaluation``: absent, computed, inferred or
        failed. Of a store, its arrays stay on the disk until they are read.

    Raises
    ------
    OutputError
        The store exists and neither resume nor force was asked for, belongs to another sweep, program or processor, or
        cannot be written.
    RangeError
        Names or values are not the model's.

    Notes
    -----
    Bits do not depend on workers, chunks, order, shares, the executor, or on where the run was interrupted.
    """
    axes = {name: np.atleast_1d(np.asarray(values, dtype=float)) for name, values in vary.items()}
    labelling = Labelling(settling or Settling(), lyapunov, steps, accuracy, method, workers=1)
    return run_sweep(
        system, Space(axes), labelling, store=store, resume=resume, force=force, share=share, cluster=cluster,
        refine=refine, workers=workers, chunk=chunk, on_chunk=on_chunk,
    )  # fmt: skip


def tolerance_sweep(
    system: System,
    tolerances: Mapping[str, Tolerance | str],
    draws: int,
    *,
    seed: int = 0,
    vary: Mapping[str, ArrayLike] | None = None,
    settling: Settling | None = None,
    lyapunov: int = 256,
    steps: int | None = None,
    accuracy: float | None = None,
    method: str | None = None,
    **options: Any,
) -> xr.Dataset:
    """Label random draws of parameters within their tolerances, alone or at every point of a grid.

    Parameters
    ----------
    tolerances : mapping of str to Tolerance or str
        Of each drawn parameter, as ``Tolerance("uniform", 0.9, 1.1)`` or ``"normal:3%"`` about the system's value.
    draws : int
        How many; they are the dimension ``draw``, with the parameters' values as coordinates.
    seed : int
        Master seed: a draw follows from it, the parameter's name and the number of the draw alone.
    vary : mapping of str to array, optional
        Grid over further parameters; the same draws are taken at each of its points.
    **options
        Those of `regime_map`.

    Returns
    -------
    xr.Dataset
        As `regime_map`.
    """
    found = {
        name: t if isinstance(t, Tolerance) else Tolerance.parse(t, float(system.values.get(name, np.nan)))
        for name, t in tolerances.items()
    }
    if not found:
        raise RangeError("found no tolerance, expected at least one, as in {'s': 'normal:3%'}")
    axes = {name: np.atleast_1d(np.asarray(values, dtype=float)) for name, values in (vary or {}).items()}
    labelling = Labelling(settling or Settling(), lyapunov, steps, accuracy, method, workers=1)
    return run_sweep(system, Space(axes, found, draws, seed), labelling, **options)


def run_sweep(
    system: System,
    space: Space,
    labelling: Labelling,
    *,
    store: str | Path | None = None,
    resume: bool = False,
    force: bool = False,
    share: tuple[int, int] | None = None,
    cluster: Any = None,
    refine: bool = False,
    workers: int | None = None,
    chunk: int | None = None,
    on_chunk: OnChunk | None = None,
) -> xr.Dataset:
    """Label the points of a space; the options are those of `regime_map`."""
    space.check(system)
    if refine and (len(space.axes) != 2 or space.tolerances):
        raise RangeError("refine wants exactly two varied parameters, and no random draws")
    if share is not None and not 1 <= share[0] <= share[1]:
        raise RangeError(f"share {share[0]}/{share[1]}: expected i/n with i from 1 to n")
    if chunk is not None and not 1 <= chunk <= 10_000_000:
        raise RangeError(f"chunk must lie between 1 and 10000000 points, not {chunk}")
    if share is not None and (store is None or force):
        raise RangeError("a share works on a store that others share: give the store, and no force")
    if store is None:
        if cluster is not None:
            raise RangeError("a cluster writes into a store: give one")
        with TemporaryDirectory(prefix="whirlmap-") as passing:
            here = Path(passing) / "map"
            return run_sweep(system, space, labelling, store=here, refine=refine, workers=workers, chunk=chunk,
                             on_chunk=on_chunk).load()  # fmt: skip
    folder = Path(store).expanduser().absolute()
    claim(folder, resume=resume or share is not None, force=force and not resume)
    job = Job(folder, system, space, labelling, COARSE if refine else 0, kernel_hash(system, labelling.method))
    wanted = manifest_of(job)
    notes: list[str] = []
    if not exists(folder):
        if half_made(folder):
            notes.append("the store was half-made, and is begun anew")
            remove(folder)
        if share is None:
            clear_trials(folder)
        _begin(job, wanted, chunk)
    _refuse_other(folder, job.store.manifest, wanted)
    _work(job, share, cluster, workers or cores(), on_chunk, notes)
    return job.store.open()


def claim(folder: Path, *, resume: bool, force: bool) -> None:
    """Refuse a place for a store before anything is computed, and clear it where it is to be replaced."""
    if exists(folder) and not (resume or force):
        raise OutputError(
            f"{folder}: holds a store already; --resume (resume=True) goes on with it, --force (force=True) replaces it"
        )
    if folder.is_dir() and any(folder.iterdir()) and not exists(folder) and not half_made(folder):
        raise OutputError(f"{folder}: holds files that are no store of a sweep; choose another name")
    check_writable(folder, force=True)
    if force and folder.is_dir() and any(folder.iterdir()):
        remove(folder)


def manifest_of(job: Job) -> dict[str, Any]:
    """What a store was made of: whatever decides its numbers, in words that can be compared and read."""
    own = pieces(job.system)
    s, labelling = asdict(job.labelling.settling), job.labelling
    parameters = {name: entry["value"] for name, entry in own.parameters.items() if name not in job.space.names}
    return {
        "format": FORMAT,
        "whirlmap_version": __version__,
        "kernel": job.kernel,
        "model": own.model,
        "model_hash": own.model_hash,
        "parameters": json.loads(as_json(parameters)),
        "switches": dict(own.switches),
        "start": dict(own.start),
        **job.space.described(),
        **{f"settling {name}": value for name, value in s.items()},
        "lyapunov": labelling.lyapunov,
        "steps": labelling.steps,
        "accuracy": labelling.accuracy,
        "method": labelling.method,
        "refined from": job.coarse,
    }


def _refuse_other(folder: Path, found: Mapping[str, Any], wanted: Mapping[str, Any]) -> None:
    """Refuse a store that was made of something else, saying what differs."""
    differ = []
    for name, value in wanted.items():
        other = found.get(name)
        if isinstance(value, dict) and isinstance(other, dict):
            differ += [(k, other.get(k), value.get(k)) for k in {**other, **value} if other.get(k) != value.get(k)]
        elif other != value:
            differ.append((name, other, value))
    differ += [(name, value, None) for name, value in found.items()
               if name.startswith(("values of ", "tolerance of ", "draws")) and name not in wanted]  # fmt: skip
    if differ:
        lines = "".join(f"\n  {name}: the store has {_short(a)}, this run {_short(b)}" for name, a, b in differ[:8])
        more = f"\n  and {len(differ) - 8} more" if len(differ) > 8 else ""
        raise OutputError(f"{folder}: holds another sweep; --force replaces it, or choose another name{lines}{more}")


def _short(value: Any) -> str:
    text = "nothing" if value is None else str(value)
    return text if len(text) < 64 else f"{text[:12]}..."


def _begin(job: Job, manifest: Mapping[str, Any], chunk: int | None) -> None:
    """Run the pilot, choose the chunks, and make the store."""
    space, model = job.space, job.system.model
    count = min(PILOT if chunk is None else 1, space.points)
    spread = np.unravel_index(np.linspace(0, space.points - 1, count).astype(np.int64), space.shape)
    index = tuple(np.asarray(i, dtype=np.intp) for i in spread)
    columns = space.columns(index)
    if chunk is None:
        job.labelling.measure(job.system, {name: c[:1] for name, c in columns.items()})  # compiling is not counted
    begun = time.perf_counter()
    measured, ensemble = job.labelling.measure(job.system, columns)
    each = max((time.perf_counter() - begun) / count, 1e-6)
    points = chunk or max(int(SECONDS / each / (REFINED if job.coarse else 1.0)), 1)
    if job.coarse:  # square, so that boundaries cross few of the borders between chunks
        side = max(int(np.sqrt(points)), 1) if chunk else int(np.clip(np.sqrt(points) // COARSE, 4, 16)) * COARSE
        size = tuple(min(side, n) for n in space.shape)
    else:
        size = chunk_size(space, model, points)
    template = points_dataset(job.system, columns, measured).isel(point=slice(0, 1))
    s = job.labelling.settling
    attributes = run_attributes(
        job.system, ensemble, varied=" ".join(space.names), transient=s.transient, most=s.most, tolerance=s.tolerance,
        common_multiple=ensemble.common_multiple, lyapunov_periods=job.labelling.lyapunov, kernel_hash=job.kernel,
        seed=space.seed if space.tolerances else None, coordinates=" ".join(space.tolerances) or None,
    )  # fmt: skip
    attributes.pop("accuracy_not_met", None)  # of the pilot; the arrays say it of every point
    try:
        create(
            job.folder, template.drop_vars(space.names), space.coordinates(job.system), space.dims,
            Chunks(space.shape, size), manifest, {k: v for k, v in attributes.items() if v is not None},
        )  # fmt: skip
    except OSError as error:
        raise OutputError(f"{job.folder}: the store cannot be made ({error.strerror or error})") from error


def _work(
    job: Job, share: tuple[int, int] | None, cluster: Any, workers: int, on_chunk: OnChunk | None, notes: list[str]
) -> None:
    """Compute what is missing."""
    store = job.store
    numbers = list(store.chunks.share(*(share or (1, 1))))
    standing = store.standing(numbers)
    progress = Progress(len(numbers), sum(map(store.chunks.points, numbers)) if share else job.space.points)
    progress.messages += notes
    if share is None:
        swept = store.sweep_away()
        progress.messages += [f"{swept} half-written files of an interrupted run were deleted"] if swept else []
    if standing.damaged.size:
        progress.messages.append(f"{standing.damaged.size} damaged chunks are computed again: {_some(standing.damaged)}")
    if standing.failed.size:
        progress.messages.append(f"{standing.failed.size} chunks that failed are tried again: {_some(standing.failed)}")
    progress.done = standing.done.size
    progress.points_done = sum(map(store.chunks.points, standing.done.tolist()))
    progress.regimes.update(store.tally(standing.done.tolist(), "regime"))
    progress.evaluated_all = store.tally(standing.done.tolist(), EVALUATION)[Evaluation.computed]
    if on_chunk:
        on_chunk(progress)
    left = np.setdiff1d(np.array(numbers, dtype=np.int64), standing.done).tolist()
    outcomes = in_dask(job, left, cluster) if cluster is not None else in_threads(job, left, workers)
    try:
        for outcome in outcomes:
            _take(job, outcome, progress)
            if on_chunk:
                on_chunk(progress)
    finally:
        outcomes.close()  # type: ignore[attr-defined]  # a generator: it waits for the chunks that are being computed


def _take(job: Job, outcome: Outcome, progress: Progress) -> None:
    if outcome.stop:
        raise OutputError(
            f"{outcome.fault}\n  {progress.done} of {progress.total} chunks are done and kept;"
            " --resume (resume=True) goes on once this is mended"
        )
    points = job.store.chunks.points(outcome.number)
    if outcome.fault:
        progress.failed += 1
        progress.messages.append(f"chunk {outcome.number} failed: {outcome.fault}")
        try:
            job.store.fail(outcome.number, outcome.fault)
        except OSError as error:
            raise OutputError(f"{job.folder}: cannot be written ({error.strerror or error}); chunk {outcome.number} had"
                              f" failed: {outcome.fault}") from error  # fmt: skip
        return
    progress.done += 1
    progress.points += points
    progress.points_done += points
    progress.evaluated += outcome.evaluated
    progress.evaluated_all += outcome.evaluated
    progress.regimes.update(outcome.counts)


def _some(numbers: NDArray[np.int64]) -> str:
    shown = ", ".join(map(str, numbers[:6].tolist()))
    return shown + (", ..." if numbers.size > 6 else "")
