"""Identification of the paper's machine: its claims are judged for every plausible set of the numbers that it does not give.

1. A space-filling design (`ranges.design`) in nested blocks of `BLOCK` sets, scrambled anew for every variant (`variants`),
   so that the verdicts of an edition's variants are independent and tell together more than those of one.
2. For every set a coarse labelled diagram (`coarse_diagrams`): the four permeabilities times speeds that lie inside the
   windows that the claims name. The claims judge it (`claims`).
3. A variant has enough sets where the 95 % interval (Wilson) of every claim's share is within `PRECISION`.

Everything is kept in pieces (`blocks`), each a function of the settings and its name alone.
"""

import re
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from math import lcm
from typing import Any

import xarray as xr

from whirlmap.analysis.steady.settling import Settling
from whirlmap.errors import RangeError
from whirlmap.results.wilson import wilson_interval
from whirlmap.studies.gear_psfd.search.blocks import Blocks
from whirlmap.studies.gear_psfd.search.coarse_diagrams import Judged, Progress, Settings, diagrams, judge_sets, sets_of
from whirlmap.studies.gear_psfd.search.tasks import Task, computed
from whirlmap.studies.gear_psfd.search.variants import Variant

#: Sets in one block.
BLOCK = 512
#: Half of the widest interval that is good enough.
PRECISION = 0.02
#: Sets by which the cost is measured before the start.
PILOT = 8


def precise(judged: Judged) -> bool:
    """Whether the share of every claim that a diagram decides is known to `PRECISION`."""
    holds = judged.holds[judged.diagram_claims]
    low, high = wilson_interval(holds.sum(axis=1), holds.shape[1])
    return bool(((high - low) / 2 <= PRECISION).all())


def piece(variant: Variant, first: int, count: int) -> str:
    """Name of a block."""
    return f"{variant.name}.{first:06d}-{first + count:06d}"


def plan(sets: int) -> list[tuple[int, int]]:
    """First set and number of sets of every block."""
    return [(first, min(BLOCK, sets - first)) for first in range(0, sets, BLOCK)]


def spans_of(blocks: Blocks, variant: Variant) -> dict[int, int]:
    """First set of every finished block of a variant, and the set behind its last; of two that begin alike the longer."""
    spans: dict[int, int] = {}
    for name in blocks.names(f"{variant.name}."):
        if numbers := re.fullmatch(r"(\d{6,})-(\d{6,})", name.rpartition(".")[2]):  # and no copy that somebody made by hand
            first, last = int(numbers[1]), int(numbers[2])
            spans[first] = max(spans.get(first, 0), last)
    return spans


def finished(blocks: Blocks, variant: Variant) -> list[str]:
    """Finished blocks of a variant that follow each other from set 0 on."""
    spans, out, at = spans_of(blocks, variant), [], 0
    while at in spans:
        out.append(piece(variant, at, spans[at] - at))
        at = spans[at]
    return out


def sets_finished(blocks: Blocks, variant: Variant) -> int:
    """Sets of a variant in `finished` blocks."""
    names = finished(blocks, variant)
    return int(names[-1].rpartition("-")[2]) if names else 0


def judged_so_far(blocks: Blocks, variant: Variant, settings: Settings) -> Judged | None:
    """Judge all finished sets of a variant; None where there are none."""
    names = finished(blocks, variant)
    if not names:
        return None
    parts = [blocks[name] for name in names]
    ds = parts[0] if len(parts) == 1 else xr.concat(parts, "set", data_vars="minimal", coords="minimal", compat="override")
    return judge_sets(variant, ds, settings)


@dataclass(frozen=True)
class Cost:
    """What one set of each variant costs, from a pilot."""

    seconds: dict[str, float]

    def of(self, variant: Variant, sets: int) -> float:
        """Seconds that many sets take."""
        return self.seconds[variant.name] * sets

    def shared(self, among: int) -> "Cost":
        """The same where so many do the work side by side."""
        return Cost({name: seconds / among for name, seconds in self.seconds.items()})


def pilot(variants: tuple[Variant, ...], settings: Settings, *, workers: int | None = None) -> Cost:
    """Measure what a set costs, compiled kernels in hand: the last `PILOT` sets of the first block, thrown away.

    Few sets fill their lanes less well than a block does, so this is on the high side.
    """
    seconds = {}
    for v in variants:
        sets = sets_of(v, settings, BLOCK - PILOT, PILOT)
        brief = replace(settings, settling=Settling(transient=0, most=1, first_window=2, keep=1), exponent_periods=16)
        diagrams(v, sets[:, :1], brief, workers=workers)
        begun = time.monotonic()
        diagrams(v, sets, settings, workers=workers)
        seconds[v.name] = (time.monotonic() - begun) / PILOT
    return Cost(seconds)


def search(
    variants: tuple[Variant, ...],
    settings: Settings,
    blocks: Blocks,
    *,
    sets: int,
    cost: Cost | None = None,
    deadline: float | None = None,
    share: tuple[int, int] = (1, 1),
    client: Any = None,
    workers: int | None = None,
    progress: Progress | None = None,
    told: Callable[[str], None] = lambda _text: None,
) -> Iterator[str]:
    """Compute blocks, round by round over the variants, and yield the name of each that is new.

    Parameters
    ----------
    sets : int
        Most sets of each variant; fewer where `precise` already.
    cost, deadline : Cost, float, optional
        No block is begun that would end after ``time.monotonic() == deadline`` at this cost; without one, none after it.
    share : (int, int)
        Compute only every n-th block, from the i-th on: several processes share one store.
    client : distributed.Client, optional
        Of a Dask cluster, which takes a round at once; threads of this process where absent.
    told : callable
        Takes a sentence about what was left out, and why.
    """
    i, n = share
    if not 1 <= i <= n:
        raise RangeError(f"share: found {i}/{n}, expected i/n with i from 1 to n")
    over: set[str] = set()

    def wanted(number: int, first: int, count: int) -> Iterator[Task]:
        for at, v in enumerate(variants, number):
            name = piece(v, first, count)
            done = name in blocks or sets_finished(blocks, v) >= first + count
            if done or v.name in over or at % n != i - 1:
                continue
            if first and (so_far := judged_so_far(blocks, v, settings)) is not None and precise(so_far):
                over.add(v.name)
                told(f"{v.name}: {so_far.word.shape[1]} sets are enough")
            elif deadline is not None and time.monotonic() + (cost.of(v, count) if cost else 0.0) > deadline:
                over.add(v.name)  # a later block, which may be shorter, would wait for this one
                told(f"{v.name}: sets from {first} on left out, the time is over")
            else:
                yield Task(name, v, sets_of(v, settings, first, count))

    for k, (first, count) in enumerate(plan(sets)):
        before = k * len(variants)
        turn = before // lcm(len(variants), n)  # else a share would come back to the same variants for ever
        tasks = wanted(before + turn, first, count)
        for name, ds in computed(tasks, settings, client=client, workers=workers, progress=progress):
            blocks.put(name, ds)
            yield name
