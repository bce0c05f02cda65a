"""Sweeps into a store: started or resumed, chunk by chunk, by any executor."""

import shutil
import time
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from whirlmap.analysis.motion.ensembles import run_attributes
from whirlmap.errors import OutputError, RangeError, counted
from whirlmap.integrate.division import cores
from whirlmap.integrate.orders import orders_vary
from whirlmap.integrate.system import System
from whirlmap.kernels.running.root_choice import own_choice, using
from whirlmap.options.computed import Labelling
from whirlmap.options.execution import EXECUTION, Execution
from whirlmap.options.storage import STORAGE, Storage
from whirlmap.results.files import reason
from whirlmap.sweep.maps.executors import Job, Outcome, connected, in_dask, in_threads
from whirlmap.sweep.maps.manifest import claim, manifest_of, refuse_other, stored_roots
from whirlmap.sweep.maps.refine import COARSE
from whirlmap.sweep.parameters.space import Chunks, Space, chunk_size, pilot_points
from whirlmap.sweep.points.point_variables import kept_states, points_dataset, shared_common_multiple
from whirlmap.sweep.store.creating import create
from whirlmap.sweep.store.fingerprint import kernel_hash
from whirlmap.sweep.store.restoring import lost_parts, put_back
from whirlmap.sweep.store.store_folder import (
    EVALUATION,
    at_work,
    clear_trials,
    exists,
    half_made,
    passing,
    remove,
    restore_manifest,
)
from whirlmap.sweep.store.zarr_store import Evaluation

#: Points of the pilot that the chunks' size follows from, and the seconds that a chunk should take.
PILOT, SECONDS = 64, 3.0
#: Share of the points that refinement is taken to evaluate when the size of its chunks is chosen.
REFINED = 0.25


@dataclass
class ChunkReport:
    """How far a sweep is, handed to its callback after every chunk.

    Attributes
    ----------
    done, failed, total : int
        Chunks.
    points : int
        Points of the chunks done in this run.
    computed : int
        Points so far that were computed, not inferred, earlier runs included.
    points_total, points_done : int
        Points of the sweep (of this share of it), and those that are done, earlier runs included.
    regimes : Counter
        Points of each regime so far, earlier runs included.
    verdicts : Counter
        Points by whether their steps meet the accuracy (`whirlmap.integrate.accuracy.StepVerdict`).
    messages : list of str
        Notes of the run: damaged chunks, failures.
    """

    total: int
    points_total: int
    done: int = 0
    failed: int = 0
    points: int = 0
    computed: int = 0
    points_done: int = 0
    regimes: Counter[int] = field(default_factory=Counter)
    verdicts: Counter[int] = field(default_factory=Counter)
    messages: list[str] = field(default_factory=list)


OnChunk = Callable[[ChunkReport], None]


def run_sweep(
    system: System,
    space: Space,
    labelling: Labelling,
    execution: Execution = EXECUTION,
    storage: Storage = STORAGE,
    *,
    refine: bool = False,
    sections: bool = False,
    on_chunk: OnChunk | None = None,
) -> xr.Dataset:
    """Label the points of a space; the options are those of `regime_map`."""
    space.check(system)
    if refine and (len(space.axes) != 2 or space.tolerances):
        raise RangeError("refine needs exactly two varied parameters, and no random draws")
    if storage.store is None:
        if execution.cluster is not None:
            raise RangeError("a cluster writes into a store: give one")
        with TemporaryDirectory(prefix="whirlmap-") as passing:
            here = replace(storage, store=Path(passing) / "map")
            return run_sweep(
                system, space, labelling, execution, here, refine=refine, sections=sections, on_chunk=on_chunk
            ).load()  # fmt: skip
    if sections and orders_vary(system.model, space.names):
        raise RangeError(
            f"sections cannot be kept with {' and '.join(space.names)} varied: the common period of the forcing changes, and"
            " with it their length; expected none, or a bifurcation diagram"
        )
    folder, own = Path(storage.store).expanduser().absolute(), own_choice()
    restored = storage.goes_on and restore_manifest(folder)
    roots = (stored_roots(folder) if storage.goes_on else None) or own
    with connected(execution.cluster) as client, using(roots):  # before anything is made or computed
        job = Job(
            folder, system, space, labelling, coarse=COARSE if refine else 0, roots=roots,
            kernel=kernel_hash(system, labelling.integration.method),
            kept=tuple(kept_states(system, None)) if sections else (),
        )  # fmt: skip
        notes = ["the manifest of the store was lost, and put back from its copy"] if restored else []
        if roots != own:
            notes.append(f"roots and reciprocals as the store was begun: {roots}; a new store would have {own}")
        return _run(job, storage, (execution.workers or cores()) if client is None else client, notes, on_chunk)


def _run(job: Job, storage: Storage, computing: Any, notes: list[str], on_chunk: OnChunk | None) -> xr.Dataset:
    """Run a job on a number of threads, or on a Dask client."""
    folder, share, chunk = job.folder, storage.share, storage.chunk
    claim(folder, resume=storage.goes_on, force=storage.force and not storage.resume)
    wanted = manifest_of(job)
    if not exists(folder):
        if half_made(folder):
            notes.append("the store was half-made, and is begun anew")
            remove(folder)
        if share is None:
            clear_trials(folder)
        _begin(job, wanted, chunk)
    refuse_other(folder, job.store.manifest, wanted, job.space.shape)
    if lost := lost_parts(job.store):
        _restore(job, lost, wanted, notes)
        job = replace(job)  # with a store that is opened anew
    if chunk is not None and (size := _chunk_size(job, chunk)) != job.store.chunks.size:
        raise OutputError(
            f"{folder}: has chunks of {job.store.chunks.size} points, and --chunk {chunk} would make them {size}:"
            " leave it out to go on with this store"
        )
    _work(job, share, computing, on_chunk, notes)
    return job.store.open()


def _begin(job: Job, manifest: Mapping[str, Any], chunk: int | None) -> None:
    """Run the pilot, choose the chunks, and make the store."""
    space, model = job.space, job.system.model
    index = pilot_points(space, model, PILOT if chunk is None else 1)
    columns, count = space.columns(index), index[0].size
    if chunk is None:
        job.measure({name: c[:1] for name, c in columns.items()})  # compiling is not counted
    begun = time.perf_counter()
    pilot = job.measure(columns)
    each = max((time.perf_counter() - begun) / count, 1e-6)
    size = _chunk_size(job, chunk) if chunk else _chunk_size(job, int(SECONDS / each / (REFINED if job.coarse else 1)), 4)
    _make(job, job.folder, manifest, size, columns, pilot)


def _restore(job: Job, lost: list[str], manifest: Mapping[str, Any], notes: list[str]) -> None:
    """Put back axes and descriptions that a store has lost, from an empty store that is made beside it."""
    columns = job.space.columns(pilot_points(job.space, job.system.model, 1))
    beside = passing(job.folder.with_name(f".{job.folder.name}"))
    try:
        _make(job, beside, manifest, job.store.chunks.size, columns, job.measure(columns))
        put_back(job.store, lost, beside)
    except OSError as error:
        raise OutputError(f"{job.folder}: {', '.join(lost)} cannot be put back ({reason(error)})") from error
    finally:
        shutil.rmtree(beside, ignore_errors=True)
    notes.append(f"lost parts of the store were put back: {', '.join(lost)}")


def _make(
    job: Job, folder: Path, manifest: Mapping[str, Any], size: tuple[int, ...], columns: Mapping[str, Any], pilot: Any
) -> None:
    """Make an empty store after some labelled points."""
    space, (measured, ensemble) = job.space, pilot
    template = points_dataset(job.system, columns, measured, kept=job.kept).isel(point=slice(0, 1))
    s = job.labelling.settling
    attributes = run_attributes(
        job.system, ensemble, varied=" ".join(space.varied), transient=s.transient, most=s.most, tolerance=s.tolerance,
        lyapunov_periods=job.labelling.longest(ensemble.strobe), kernel_hash=job.kernel,
        **shared_common_multiple(job.system, space.names, ensemble),
        seed=space.seed if space.tolerances else None,
        coordinates=" ".join([*space.tolerances, *(space.inputs.sizes if space.inputs else ())]) or None,
    )  # fmt: skip
    attributes.pop("accuracy_not_met", None)  # of the pilot; the arrays say it of every point
    try:
        create(
            folder, template.drop_vars(space.names), space.coordinates(job.system), space.dims,
            Chunks(space.shape, size), manifest, {k: v for k, v in attributes.items() if v is not None},
        )  # fmt: skip
    except OSError as error:
        raise OutputError(f"{folder}: the store cannot be made ({reason(error)})") from error


def _chunk_size(job: Job, points: int, least: int = 0) -> tuple[int, ...]:
    """Shape of chunks of about so many points; of refined ones at least so many cells of the first lattice a side."""
    if not job.coarse:
        return chunk_size(job.space, job.system.model, points)
    side = max(int(np.sqrt(points)), 1)  # square, so that boundaries cross few of the borders between chunks
    if least:
        side = int(np.clip(side // COARSE, least, 4 * least)) * COARSE
    return tuple(min(side, n) for n in job.space.shape)


def _work(job: Job, share: tuple[int, int] | None, computing: Any, on_chunk: OnChunk | None, notes: list[str]) -> None:
    """Compute what is missing."""
    store = job.store
    numbers = list(store.chunks.share(*(share or (1, 1))))
    standing = store.standing(numbers)
    progress = ChunkReport(len(numbers), sum(map(store.chunks.points, numbers)) if share else job.space.points)
    progress.messages += notes
    if swept := store.sweep_away(set(numbers) if share else None):  # other shares may be writing
        progress.messages.append(f"{counted(swept, 'half-written file')} of an interrupted run deleted")
    if standing.damaged.size:
        damaged = counted(standing.damaged.size, "damaged chunk")
        progress.messages.append(f"{damaged} computed again: {_some(standing.damaged)}")
    if standing.failed.size:
        progress.messages.append(f"{counted(standing.failed.size, 'failed chunk')} tried again: {_some(standing.failed)}")
    progress.done = standing.done.size
    progress.points_done = sum(map(store.chunks.points, standing.done.tolist()))
    progress.regimes.update(store.tally(standing.done.tolist(), "regime"))
    progress.verdicts.update(store.tally(standing.done.tolist(), "step_verdict"))
    progress.computed = store.tally(standing.done.tolist(), EVALUATION)[Evaluation.computed]
    threads = isinstance(computing, int)
    if not threads and not computing.nthreads():
        progress.messages.append("the Dask scheduler has no workers: waiting for the first")
    if on_chunk:
        on_chunk(progress)
    left = spread(np.setdiff1d(np.array(numbers, dtype=np.int64), standing.done)).tolist()
    outcomes = in_threads(job, left, computing) if threads else in_dask(job, left, computing)
    with at_work(job.folder):
        try:
            for outcome in outcomes:
                _take(job, outcome, progress)
                if on_chunk:
                    on_chunk(progress)
        finally:
            outcomes.close()  # type: ignore[attr-defined]  # a generator: it waits for the chunks that are being computed


def spread(numbers: NDArray[np.int64]) -> NDArray[np.int64]:
    """Put numbers into an order whose beginnings are spread over all of them: what comes first then speaks for the rest.

    Chunks side by side hold motions that are alike, and chaos takes fifty times as long as what returns.
    """
    golden = (np.sqrt(5) - 1) / 2
    return np.asarray(numbers[np.argsort(np.arange(numbers.size) * golden % 1.0, kind="stable")])


def _take(job: Job, outcome: Outcome, progress: ChunkReport) -> None:
    if outcome.stop:
        raise OutputError(
            f"{outcome.fault}\n  {progress.done} of {counted(progress.total, 'chunk')} done and kept;"
            " --resume (resume=True) continues once this is repaired"
        )
    points = job.store.chunks.points(outcome.number)
    if outcome.fault:
        progress.failed += 1
        progress.messages.append(f"chunk {outcome.number} failed: {outcome.fault}")
        try:
            job.store.fail(outcome.number, outcome.fault)
        except OSError as error:
            raise OutputError(f"{job.folder}: cannot be written ({reason(error)}); chunk {outcome.number} had"
                              f" failed: {outcome.fault}") from error  # fmt: skip
        return
    progress.done += 1
    progress.points += points
    progress.points_done += points
    progress.computed += outcome.evaluated
    progress.regimes.update(outcome.counts)
    progress.verdicts.update(outcome.verdicts)


def _some(numbers: NDArray[np.int64]) -> str:
    shown = ", ".join(map(str, numbers[:6].tolist()))
    return shown + (", ..." if numbers.size > 6 else "")
