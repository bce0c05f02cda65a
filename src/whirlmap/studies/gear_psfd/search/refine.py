"""Refinement of the best sets of the design: differential evolution on the mean score of the claims."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr
from scipy.optimize import differential_evolution

from whirlmap.errors import RangeError
from whirlmap.studies.gear_psfd.claims.labelled import Array
from whirlmap.studies.gear_psfd.search.blocks import Blocks
from whirlmap.studies.gear_psfd.search.coarse_diagrams import Judged, Progress, Settings, judge_sets
from whirlmap.studies.gear_psfd.search.tasks import Task, computed
from whirlmap.studies.gear_psfd.search.variants import Variant

#: Sets in one generation.
POPULATION = 64
#: Fewest sets that a refinement can start from.
LEAST = 5


def refine(
    start: Judged,
    settings: Settings,
    blocks: Blocks,
    *,
    generations: int,
    prefix: str = "refined",
    score: Callable[[Judged], Array] = lambda judged: judged.total,
    client: Any = None,
    workers: int | None = None,
    progress: Progress | None = None,
    more: Callable[[], bool] = lambda: True,
) -> Judged:
    """Refine the best sets of one variant.

    Parameters
    ----------
    start : Judged
        Sets that were looked at already. `POPULATION` of them are the first generation: the best by the claims that hold
        and the best by the score, in turn.
    generations : int
        Most generations after that.
    score : callable
        What is made larger, one number for each set; the mean over the claims that a diagram decides where absent.
    client : distributed.Client, optional
        Of a Dask cluster; threads of this process where absent.
    more : callable
        Asked before every generation that has to be computed; the search ends where it says no.

    Returns
    -------
    Judged
        All sets of all new generations; ``start`` where there is none.

    Notes
    -----
    SciPy's ``differential_evolution`` (best1bin), one call of the diagrams for each generation, in the unit cube of the
    ranges. A generation is a piece of the store, named also by the number of sets that it started from. A resumed run goes
    through the same generations, because nothing in it is random but the seed, and takes the finished ones from the store.
    """
    if start.values.shape[1] < LEAST:
        raise RangeError(f"refinement needs at least {LEAST} sets, not {start.values.shape[1]}")
    variant = start.variant
    known = score(start)
    both = np.stack([start.order, np.argsort(-known, kind="stable")], axis=1).ravel()
    order = both[np.sort(np.unique(both, return_index=True)[1])][:POPULATION]
    first = np.stack([r.place(start.values[k, order]) for k, r in enumerate(settings.ranges)])
    generation = 0

    class Enough(Exception):  # noqa: N818 (no error: the way out of a library's loop)
        pass

    def objective(places: Array) -> Array:
        nonlocal generation
        if generation == 0:
            generation = 1
            return 1.0 - known[order]
        values = np.stack([r.at(places[k]) for k, r in enumerate(settings.ranges)])
        name = f"{prefix}.{variant.name}.{start.values.shape[1]:06d}-{generation:04d}"
        generation += 1
        if name not in blocks:
            if not more():
                raise Enough
            task = [Task(name, variant, values)]
            blocks.put(*next(computed(task, settings, client=client, workers=workers, progress=progress)))
        ds = blocks[name]
        if not np.array_equal(ds["value"].values, values):
            raise RangeError(f"{name} in the store belongs to another refinement: choose another --store")
        return 1.0 - score(judge_sets(variant, ds, settings))

    with suppress(Enough):
        differential_evolution(
            objective, [(0.0, 1.0)] * len(settings.ranges), init=np.clip(first.T, 0.0, 1.0), maxiter=generations, tol=0.0,
            atol=0.0, polish=False, updating="deferred", vectorized=True, rng=np.random.default_rng(settings.seed),
            mutation=(0.4, 0.9), recombination=0.7,
        )  # fmt: skip
    return refined(variant, settings, blocks, prefix=prefix) or start


def best_starts(judged: Sequence[Judged]) -> list[Judged]:
    """Return the variant of each edition whose best set comes closest to the claims."""
    best: dict[str, tuple[tuple[int, float], Judged]] = {}
    for j in judged:
        k = j.order[0]
        rank = (int(j.holds[j.diagram_claims, k].sum()), float(j.total[k]))
        if j.variant.edition not in best or rank > best[j.variant.edition][0]:
            best[j.variant.edition] = (rank, j)
    return [j for _, j in best.values()]


def refined(variant: Variant, settings: Settings, blocks: Blocks, *, prefix: str = "refined") -> Judged | None:
    """Judge all generations of a variant that are in the store."""
    parts = [blocks[name] for name in blocks.names(f"{prefix}.{variant.name}.")]
    if not parts:
        return None
    ds = parts[0] if len(parts) == 1 else xr.concat(parts, "set", data_vars="minimal", coords="minimal", compat="override")
    return judge_sets(variant, ds, settings)


def all_sets(design: Judged, refined: Judged | None) -> Judged:
    """Sets of the design and of the refinement together: for the best of all, never for shares."""
    if refined is None:
        return design
    names = ("values", "word", "score")
    joined: dict[str, Any] = {n: np.concatenate([getattr(design, n), getattr(refined, n)], axis=1) for n in names}
    return replace(design, **joined)
