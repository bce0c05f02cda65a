"""Executors of a sweep's chunks: threads of this process, or the workers of a Dask cluster. The task is the same for both.

A task computes one chunk and writes it into the store; only a small outcome comes back.
"""

from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, wait
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from functools import cached_property
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from whirlmap.analysis.labels.labelling import measure
from whirlmap.analysis.labels.measured import Measured
from whirlmap.errors import OutputError
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.system import System
from whirlmap.integrate.workers import Workers
from whirlmap.kernels.running.root_choice import RootChoice, using
from whirlmap.options.computed import Labelling
from whirlmap.options.execution import Execution
from whirlmap.results.files import DISK
from whirlmap.sweep.maps.refine import refine
from whirlmap.sweep.parameters.space import Space
from whirlmap.sweep.points.point_variables import points_dataset
from whirlmap.sweep.store.fingerprint import kernel_hash
from whirlmap.sweep.store.store_folder import EVALUATION
from whirlmap.sweep.store.zarr_store import Evaluation, Store, counts_of

#: How often a chunk is tried.
ATTEMPTS = 3
#: Tasks that wait at the scheduler for each thread of the cluster: enough to keep them busy, few for its memory.
AHEAD = 4
#: Seconds in which a scheduler must answer.
CONNECT = 10
#: What a message about a lost cluster ends with.
GO_ON = "\n  the chunks that are done are kept; --resume (resume=True) goes on"


@dataclass(frozen=True)
class Outcome:
    """What became of one chunk.

    Attributes
    ----------
    number : int
    counts : mapping of int to int
        Points of each regime.
    verdicts : mapping of int to int
        Points by whether their steps meet the accuracy.
    evaluated : int
        Points that were computed, not inferred.
    fault : str
        Why it failed; empty where it is done.
    stop : bool
        Whether the fault is none of the chunk: the sweep must stop.
    """

    number: int
    counts: Mapping[int, int] = field(default_factory=dict)
    verdicts: Mapping[int, int] = field(default_factory=dict)
    evaluated: int = 0
    fault: str = ""
    stop: bool = False


@dataclass(frozen=True)
class Job:
    """What all tasks of a sweep share; goes to every worker once.

    Attributes
    ----------
    folder : Path
        The store.
    coarse : int
        Spacing of the first lattice of `refine`; 0: every point is computed.
    kernel : str
        `kernel_hash` of the process that began; a worker with another one refuses.
    roots : RootChoice
        How kernels take roots and reciprocals: the store's choice, whatever a worker's own would be.
    kept : tuple of str
        States whose section is kept.
    """

    folder: Path
    system: System
    space: Space
    labelling: Labelling
    coarse: int
    kernel: str
    roots: RootChoice
    kept: tuple[str, ...] = ()

    @cached_property
    def store(self) -> Store:
        """The store, opened once in each process."""
        return Store(self.folder)

    def __getstate__(self) -> dict[str, Any]:
        """What is sent to workers: not the open store."""
        return {name: value for name, value in self.__dict__.items() if name != "store"}

    def compute(self, number: int) -> dict[str, NDArray[Any]]:
        """Label the points of a chunk: every array of the store over its box."""
        chunks = self.store.chunks
        index = chunks.index(number)
        box = tuple(s.stop - s.start for s in chunks.box(number))
        if not self.coarse:
            ds = self._label(index)
            where = np.arange(index[0].size)
            labels = None
        else:
            rows, columns = (s.start for s in chunks.box(number))
            parts: list[tuple[NDArray[np.intp], xr.Dataset]] = []

            def evaluate(at: tuple[NDArray[np.intp], NDArray[np.intp]]) -> NDArray[np.int64]:
                part = self._label((at[0] + rows, at[1] + columns))
                parts.append((at[0] * box[1] + at[1], part))
                return label_codes(part)

            labels, _ = refine((box[0], box[1]), evaluate, coarse=self.coarse)
            where = np.concatenate([at for at, _ in parts])
            ds = xr.concat(
                [part for _, part in parts], "point", data_vars="minimal", coords="minimal", join="exact",
                combine_attrs="override",
            )  # fmt: skip
        out: dict[str, NDArray[Any]] = {}
        for name, array in self.store.arrays.items():
            full = np.full((index[0].size, *array.shape[len(box) :]), array.fill_value, dtype=array.dtype)
            if name == EVALUATION:
                full[:] = Evaluation.inferred
                full[where] = Evaluation.computed
            else:
                full[where] = ds[name].values
            out[name] = full
        if labels is not None:
            _infer(out, labels.ravel())
        return {name: full.reshape(*box, *full.shape[1:]) for name, full in out.items()}

    def _label(self, index: tuple[NDArray[np.intp], ...]) -> xr.Dataset:
        columns = self.space.columns(index)
        measured, _ = self.measure(columns)
        return points_dataset(self.system, columns, measured, kept=self.kept)

    def measure(self, columns: Mapping[str, NDArray[np.float64]]) -> tuple[Measured, Ensemble]:
        """Measure points in one thread: each of the workers has a chunk of its own."""
        return measure(self.system, columns, self.labelling, Execution(workers=1), kept=self.kept)


#: What must agree for a cell to be left alone, and below which number each stays: they are packed into one integer.
PACKED = (("regime", 100), ("status", 100), ("period_common", 10**5), ("period_T", 10**9))


def label_codes(ds: xr.Dataset) -> NDArray[np.int64]:
    """Labels of cells as integers (`PACKED`): regime, how the run ended, and the period, in T and in common periods."""
    numbers, below = [ds[name].values.astype(np.int64) for name, _ in PACKED], [most for _, most in PACKED]
    return np.asarray(np.ravel_multi_index(tuple(numbers[::-1]), tuple(below[::-1])))


def _infer(out: dict[str, NDArray[Any]], labels: NDArray[np.int64]) -> None:
    inferred = out[EVALUATION] == Evaluation.inferred
    numbers = np.unravel_index(labels[inferred], tuple(most for _, most in PACKED[::-1]))
    for (name, _), number in zip(PACKED[::-1], numbers, strict=True):
        out[name][inferred] = number


def attempt(job: Job, number: int) -> Outcome:
    """Compute and commit one chunk, up to `ATTEMPTS` times; the outcome says what became of it."""
    with using(job.roots):
        return _attempt(job, number)


def _attempt(job: Job, number: int) -> Outcome:
    own = kernel_hash(job.system, job.labelling.integration.method)
    if own != job.kernel:
        return Outcome(number, fault=f"this worker's kernels are {own[:12]}, the store's {job.kernel[:12]}: another version"
                       " of whirlmap or its libraries, or another processor or WHIRLMAP_CPU", stop=True)  # fmt: skip
    fault = ""
    for _ in range(ATTEMPTS):
        try:
            data = job.compute(number)
            job.store.commit(number, data)
        except OSError as error:
            if error.errno in DISK:
                return Outcome(number, fault=f"{DISK[error.errno]} ({job.folder})", stop=True)
            fault = f"{type(error).__name__}: {error}"
        except Exception as error:
            fault = f"{type(error).__name__}: {error}"
        else:
            regimes, verdicts, origins = (counts_of(data[name]) for name in ("regime", "step_verdict", EVALUATION))
            return Outcome(number, regimes, verdicts, origins.get(Evaluation.computed, 0))
    return Outcome(number, fault=fault)


def in_threads(job: Job, numbers: Iterable[int], workers: int) -> Iterator[Outcome]:
    """Compute chunks in threads of this process, one in each; closing the iterator stops those that run, uncommitted."""
    left = iter(numbers)
    running: set[Future[Outcome]] = set()
    with Workers(workers) as pool:
        while True:
            for number in islice(left, workers + 1 - len(running)):
                running.add(pool.submit(attempt, job, number))
            if not running:
                return
            done, running = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                yield future.result()


@contextmanager
def connected(cluster: Any) -> Iterator[Any]:
    """A client of a Dask cluster; None where there is none.

    Parameters
    ----------
    cluster : str, Cluster, Client or None
        Address of a scheduler, a cluster object (of dask-jobqueue, for example), or a client, which stays open.
    """
    if cluster is None:
        yield None
        return
    try:
        from distributed import Client
    except ImportError:
        raise OutputError("Dask is not installed: pip install 'whirlmap[dask]'") from None
    if isinstance(cluster, Client):
        yield cluster
        return
    try:
        client = Client(cluster, timeout=CONNECT)
    except (OSError, ValueError) as error:
        with suppress(ValueError):  # none was made
            Client.current().close()  # else everything that Dask computes in this process would ask the one that failed
        raise OutputError(f"no Dask scheduler answers at {cluster}: {error}") from None
    try:
        yield client
    finally:
        client.close()


def in_dask(job: Job, numbers: Iterable[int], client: Any) -> Iterator[Outcome]:
    """Compute chunks on the workers of a Dask client; those of workers that die are computed by others.

    Notes
    -----
    The job goes out as the result of a task, which the scheduler makes again should the workers that hold it die. A chunk
    whose workers died more often than ``distributed.scheduler.allowed-failures`` (3) has failed.
    """
    from distributed import KilledWorker, as_completed

    left = iter(numbers)
    try:
        shared = client.submit(_same, job, pure=False)
        waiting = as_completed()
        names: dict[Any, int] = {}
        while True:
            room = AHEAD * max(sum(client.nthreads().values()), 1) - len(names)
            for number in islice(left, max(room, 0)):
                future = client.submit(attempt, shared, number, pure=False)
                names[future.key] = number
                waiting.add(future)
            if not names:
                return
            future = next(waiting)
            number = names.pop(future.key)
            if future.status in ("cancelled", "lost"):
                raise OutputError(f"the Dask scheduler is gone, and with it chunk {number}{GO_ON}")
            try:
                yield future.result()
            except KilledWorker as error:
                yield Outcome(number, fault=f"its workers died, again and again: {error}")
    except (OSError, TimeoutError) as error:
        raise OutputError(f"the Dask scheduler is gone ({type(error).__name__}){GO_ON}") from None


def _same(job: Job) -> Job:
    return job
