"""Status of a store, running or stopped, from the files on disk alone."""

import time
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from whirlmap.results.regime import Regime
from whirlmap.sweep.store.restoring import WHOLE, lost_parts
from whirlmap.sweep.store.store_folder import CHUNKS, EVALUATION, workers_at
from whirlmap.sweep.store.zarr_store import Evaluation, Standing, Store

#: Seconds before the last commit over which the rate is taken, and after it while a store counts as running where a process
#: has not said that it ended: one that is killed cannot.
WINDOW, QUIET = 600.0, 120.0


def store_standing(folder: str | Path) -> dict[str, Any]:
    """Say how far a store is, from every file of it.

    Returns
    -------
    dict
        ``chunks``, ``chunks_done``, ``chunks_failed``, ``chunks_damaged`` (with files that are missing or do not fit their
        checksum), ``damaged`` (their numbers), ``lost`` (axes and descriptions of arrays, see `lost_parts`), ``points``,
        ``points_done``, ``points_computed``, ``regimes`` (label to points), ``reasons`` (chunk to why it failed), ``rate``
        (points per second over the last ten minutes of work, or None), ``seconds_left`` (or None), ``seconds_since`` (the
        last chunk, or None), ``running``.

    Raises
    ------
    OutputError
        Where the folder is no store.
    """
    store = Store(Path(folder).expanduser().absolute())
    lost = lost_parts(store)
    known = not {WHOLE, f"{CHUNKS}/receipt", f"{CHUNKS}/reason"} & set(lost)
    standing = store.standing() if known else Standing(*(np.empty(0, dtype=np.int64) for _ in range(3)))
    done, damaged = standing.done.tolist(), standing.damaged.tolist()
    reasons = {k: why for k, why in store.reasons().items() if k not in {*done, *damaged}} if known else {}
    evaluated, regimes = (
        store.tally(done, name) if known and name not in lost else Counter[int]() for name in (EVALUATION, "regime")
    )
    points = int(np.prod(store.chunks.shape))
    points_done = sum(map(store.chunks.points, done))
    times = _commits(store, done)
    since = time.time() - times[-1][0] if times else None
    working = since is not None and since < QUIET and bool(workers_at(store.folder))
    recent = [(at, n) for at, n in times if at >= times[-1][0] - WINDOW]
    span = recent[-1][0] - recent[0][0] if recent else 0.0
    rate = sum(n for _, n in recent[1:]) / span if span > 0 else None
    return {
        "store": store.folder, "chunks": store.chunks.count, "chunks_done": len(done), "chunks_failed": len(reasons),
        "chunks_damaged": len(damaged), "damaged": damaged, "lost": lost,
        "points": points, "points_done": points_done, "points_computed": evaluated[Evaluation.computed],
        "regimes": {Regime(k).label: n for k, n in regimes.most_common()},
        "reasons": reasons, "rate": rate,
        "seconds_left": (points - points_done) / rate if rate and points > points_done else None,
        "seconds_since": since, "running": working and len(done) < store.chunks.count,
    }  # fmt: skip


def _commits(store: Store, done: list[int]) -> list[tuple[float, int]]:
    """When each chunk was committed, and its points, in the order of time."""
    folder = store.folder / CHUNKS / "receipt" / "c"
    found = []
    for number in done:
        path = folder.joinpath(*map(str, store.chunks.cell(number)))
        found.append((path.stat().st_mtime, store.chunks.points(number)))
    return sorted(found)
