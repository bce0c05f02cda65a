"""Bifurcation points at the edges of windows: where a motion that decides an edge begins or is lost, to many digits."""

from collections.abc import Generator, Mapping, Sequence
from dataclasses import replace

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from whirlmap.analysis.branches.corrector import Ask, Corrected, Lost
from whirlmap.analysis.branches.limits import Limits
from whirlmap.analysis.branches.tracing import Trace, stepping, trace
from whirlmap.errors import RangeError
from whirlmap.results.regime import Regime
from whirlmap.results.status import Status
from whirlmap.sweep.branches.branch import rises
from whirlmap.sweep.branches.continue_orbit import ACCURACY
from whirlmap.sweep.branches.free_parameters import FreeParameters, Varied
from whirlmap.sweep.branches.seeds import Beginning, Seed
from whirlmap.sweep.speeds.run_up_and_down import SAME
from whirlmap.sweep.speeds.verdicts import Judge, Verdict
from whirlmap.sweep.speeds.windows import Edge

Array = NDArray[np.float64]

#: Events at which a motion that is met by running up or down is lost.
LOSSES = ("fold", "period-doubling", "neimark-sacker")
#: Longest step, in units of the cell of an edge, and most steps.
LONGEST, POINTS = 0.1, 200


def with_events(judge: Judge, at: Array, edges: Mapping[int, Edge], ends: tuple[xr.Dataset, xr.Dataset]) -> dict[int, Edge]:
    """The same edges, each that a periodic motion's loss makes moved to the bifurcation point where it is lost.

    Parameters
    ----------
    edges : mapping of int to Edge
        By the cell of the speeds ``at`` that holds it.
    ends : tuple of xr.Dataset
        Motions met at the safe end of each edge, and at the other; ``place`` counts the edges.

    Notes
    -----
    A motion that is not safe is followed from the end beyond the edge into the window, as far as the cell goes: the window
    ends where it is lost, which may be farther in than a run-up with steps can carry it. A safe motion is followed from the
    last safe speed to the first that is not. The innermost loss counts (`moved`). Where the
    motions at both ends have the same amplitude the edge is where it crosses the limit, and no event is sought. Not sought
    either are those of models whose speed changes the ratio of two frequencies of the forcing, and of unforced ones.
    """
    if not edges or not judge.system.model.forced:
        return dict(edges)
    sought = []
    for place, (cell, edge) in enumerate(edges.items()):
        sides = [side.isel(point=np.flatnonzero(side["place"].values == place)) for side in ends]
        safe_end = float(at[cell] if edge.safe < edge.beyond else at[cell + 1])
        for side, begin, end in ((1, edge.beyond, safe_end), (0, edge.safe, edge.beyond)):
            for k in _lost(sides[side], sides[1 - side], unsafe=side == 1):
                seeds = _seeds(judge, begin, end, sides[side].isel(point=k))
                sought += [(cell, side, _towards(seed, begin, end)) for seed in seeds]
    for _ in stepping([run for _, _, (_, run) in sought]):
        pass
    lost = [(cell, side, next(iter(_losses(part)), None)) for cell, side, (part, _) in sought]
    return {cell: moved(edge, [(side, at) for of, side, at in lost if of == cell]) for cell, edge in edges.items()}


def moved(edge: Edge, lost: Sequence[tuple[int, tuple[float, str] | None]]) -> Edge:
    """The edge at the innermost speed at which a motion is lost.

    Parameters
    ----------
    lost : sequence of (side, (speed, kind) or None)
        Of each motion that was followed, side 0 from the last safe speed and side 1 from beyond: where it is lost; None
        where it is not.

    Returns
    -------
    Edge
        As it was where a motion that is not safe goes on into the window, and where none is lost.
    """
    outwards = np.sign(edge.beyond - edge.safe)
    if any(side == 1 and found is None for side, found in lost):
        return edge
    reached = [found for side, found in lost if found and (side == 1 or (found[0] - edge.safe) * outwards >= 0)]
    if not reached:
        return edge
    value, kind = min(reached, key=lambda found: found[0] * outwards)
    return replace(edge, safe=value, event=kind)


def _lost(here: xr.Dataset, there: xr.Dataset, *, unsafe: bool) -> NDArray[np.intp]:
    """Periodic motions at one end of an edge that are not met at the other."""
    returns = (here["regime"].values == Regime.periodic) & (here["status"].values == Status.ok)
    kind = (here["verdict"].values != Verdict.safe) == unsafe
    size, others = here["amplitude"].values, there["amplitude"].values
    met = (np.abs(size[:, None] - others) <= SAME * np.abs(size)[:, None]).any(axis=1)
    return np.flatnonzero(returns & kind & ~met)


def _seeds(judge: Judge, begin: float, end: float, motion: xr.Dataset) -> list[Seed]:
    """The orbit of a motion, to be followed from one speed to another; none where Newton's method does not find it."""
    system = judge.system
    try:
        free = FreeParameters(system, (Varied.of(system, system.speed, sorted((begin, end))),))
        first = Beginning(free, (begin,), judge.labelling, judge.execution, ACCURACY)
        return first.orbits([motion["end_state"].values], int(motion["period_T"]))
    except RangeError:  # the speed changes the ratio of two frequencies, or the orbit does not close
        return []


def _towards(seed: Seed, begin: float, end: float) -> tuple[Trace, Generator[Ask, Corrected | Lost, None]]:
    """A branch from an end of an edge to a speed, until a motion on it is lost."""
    low, high = sorted((begin, end))
    limits = Limits(np.array([low]), np.array([high]), LONGEST, POINTS, ACCURACY)
    part = Trace([seed.at])
    return part, _until_lost(part, trace(part, np.sign(end - begin) * rises(seed.at), limits))


def _losses(part: Trace) -> list[tuple[float, str]]:
    """Speeds at which a motion is lost, and how."""
    return [(e.at.value, e.kind) for _, e in part.events if e.kind in LOSSES]


def _until_lost(part: Trace, run: Generator[Ask, Corrected | Lost, None]) -> Generator[Ask, Corrected | Lost, None]:
    answer: Corrected | Lost | None = None
    while not _losses(part):
        try:
            answer = yield run.send(answer)  # type: ignore[arg-type]  # a generator begins with None
        except StopIteration:
            return
