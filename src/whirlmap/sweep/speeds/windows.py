"""Windows of safe speeds with refined edges, the ranges between them, and one table row for each."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from whirlmap.progress import tell
from whirlmap.sweep.speeds.arriving import arriving
from whirlmap.sweep.speeds.run_up_and_down import carried, cold_motions, joined, outcome, unseen
from whirlmap.sweep.speeds.verdicts import Judge, Verdict

Array = NDArray[np.float64]

#: Speeds between the two ends of an edge of a window, and how often they are drawn closer.
PARTS, ROUNDS = 7, 3


@dataclass(frozen=True)
class Edge:
    """One end of a window: the last safe speed, the first that was judged and is not, and why not.

    ``event`` is the kind of the bifurcation point that the last safe speed is, where it is one.
    """

    safe: float
    beyond: float
    why: Verdict
    event: str = ""


def refined_edges(
    judge: Judge, at: Array, met: xr.Dataset, limit: float, *, follow: bool, rounds: int = ROUNDS
) -> tuple[dict[int, Edge], tuple[xr.Dataset, xr.Dataset]]:
    """Edges between the speeds i and i + 1, one of them safe and the other not; and the motions met at both ends of each.

    Parameters
    ----------
    met : xr.Dataset
        Motions met at the speeds `at`, those of the cold starts first.
    follow : bool
        Whether speeds in between start from the motions met at both ends as well as cold.
    rounds : int
        How often the ends are drawn closer; 0: they are those of the cells.
    """
    speed, verdict = judge.system.speed, outcome(met, at.size)["verdict"].values
    safe = verdict == Verdict.safe
    cells = np.flatnonzero(safe[1:] != safe[:-1])
    places = np.where(safe[cells], [cells, cells + 1], [cells + 1, cells])  # the safe end, the other
    ends, why = at[places], verdict[places[1]]
    known = [_at(met, side) for side in places]
    shares, every = np.arange(1, PARTS + 1) / (PARTS + 1), np.arange(cells.size)
    tell(judge.execution.progress, "more_points", cells.size * edge_points(follow=follow, rounds=rounds))
    for _ in range(rounds if cells.size else 0):
        whole = ends[0][:, None] + (ends[1] - ends[0])[:, None] * np.concatenate([[0], shares, [1]])
        whole[:, -1] = ends[1]
        trial = whole[:, 1:-1].ravel()
        found = cold_motions(judge, {speed: trial}, np.full(trial.size, limit))
        for motions in known if follow else ():
            found = joined(found, _carried_into(judge, trial, motions, limit))
        if follow:
            flows = arriving(judge, {speed: trial}, found, np.ones(found.sizes["point"], dtype=bool))
            flows[: trial.size] = False  # a cold start is a verdict of its own
            found = found.isel(point=np.flatnonzero(~flows))
        result = outcome(found, trial.size)["verdict"].values.reshape(-1, PARTS)
        unsafe = result != Verdict.safe
        first = np.where(unsafe.any(axis=1), unsafe.argmax(axis=1), PARTS)
        why = np.where(first < PARTS, result[every, np.minimum(first, PARTS - 1)], why)
        ends = np.stack([whole[every, first], whole[every, first + 1]])
        if follow:
            found = found.isel(point=unseen(judge, {speed: trial}, found))
            known = [
                joined(_among(old, np.flatnonzero(stays)), _at(found, np.where(stays, -1, every * PARTS + new)))
                for old, stays, new in ((known[0], first == 0, first - 1), (known[1], first == PARTS, first))
            ]
    return {
        int(c): Edge(float(g), float(b), Verdict(int(w))) for c, g, b, w in zip(cells, ends[0], ends[1], why, strict=True)
    }, (known[0], known[1])


def edge_points(*, follow: bool, rounds: int = ROUNDS) -> int:
    """Points that one edge takes, about: cold starts, and those from the motions at both ends."""
    return rounds * PARTS * (3 if follow else 1)


def _carried_into(judge: Judge, trial: Array, motions: xr.Dataset, limit: float) -> xr.Dataset:
    """Judge all speeds within each edge from the motions at one of its ends; ``place`` of these counts the edges."""
    ran = np.flatnonzero(np.isfinite(motions["end_state"].values).all(axis=1))
    if not ran.size:
        return motions.isel(point=ran)
    place = (motions["place"].values[ran, None] * PARTS + np.arange(PARTS)).ravel()
    values = {judge.system.speed: trial[place]}
    return carried(judge, values, np.full(place.size, limit), motions, np.repeat(ran, PARTS), place)


def _at(motions: xr.Dataset, places: NDArray[np.intp]) -> xr.Dataset:
    """Motions at these places, each place by its number among them."""
    which, number = np.nonzero(motions["place"].values[:, None] == places)
    return motions.isel(point=which).assign_coords(place=("point", number))


def _among(motions: xr.Dataset, places: NDArray[np.intp]) -> xr.Dataset:
    """Motions at these places, which keep their numbers."""
    return motions.isel(point=np.flatnonzero(np.isin(motions["place"].values, places)))


def stretches(ds: xr.Dataset, edges: Mapping[int, Edge], *, whole: bool = True) -> list[dict[str, Any]]:
    """One row for each run of speeds with one verdict, in order: together they cover the range.

    Parameters
    ----------
    ds : xr.Dataset
        Outcome over the speeds: ``verdict(s)``, ``amplitude(s)``, and what else is known of them.
    whole : bool
        Whether the last of them is the end of the range; else those beyond it were not judged.

    Returns
    -------
    list of dict
        ``verdict``; ``start`` and ``end`` (a safe stretch to its last safe speed, another up to there, two that are not safe
        to the middle between their speeds); ``gap_start``, ``gap_end`` of a safe one, the distance to the first speed that
        was judged and is not safe; ``below``, ``above``, why it ends there, and ``below_event``, ``above_event``, at which
        bifurcation; and the largest ``amplitude`` and ``max_load``,
        the least ``min_film`` and ``tooth_contact``, of its speeds (None where none is known), with the bearing of each.
    """
    speed = str(ds["verdict"].dims[0])
    at, verdict = ds[speed].values, ds["verdict"].values
    cuts = np.flatnonzero(verdict[1:] != verdict[:-1])
    rows = []
    for a, b in zip([0, *(cuts + 1)], [*cuts, at.size - 1], strict=True):
        kind = Verdict(int(verdict[a]))
        row: dict[str, Any] = {"verdict": kind.name, "speeds": int(b - a + 1)}
        for end, place, cell in (("start", a, a - 1), ("end", b, b)):
            edge, middle = edges.get(int(cell)), 0 <= cell < at.size - 1
            row[end] = edge.safe if edge else float(at[cell : cell + 2].mean()) if middle else float(at[place])
            if kind == Verdict.safe:
                row[f"gap_{end}"] = abs(edge.beyond - edge.safe) if edge else 0.0
                side = "below" if end == "start" else "above"
                last = "end of the range" if whole or side == "below" else "not judged"
                row[side] = edge.why.name if edge else last
                row[f"{side}_event"] = edge.event if edge else ""
        rows.append(row | _worst(ds.isel({speed: slice(int(a), int(b) + 1)})))
    return rows


def _worst(ds: xr.Dataset) -> dict[str, Any]:
    out: dict[str, Any] = {}
    for name, pick in (("amplitude", np.nanargmax), ("max_load", np.nanargmax), ("min_film", np.nanargmin)):
        if name in ds:
            values = ds[name].values
            known = np.isfinite(values).any()
            where = np.unravel_index(pick(values), values.shape) if known else None
            out[name] = float(values[where]) if where else None
            if name != "amplitude":
                out[f"{name}_bearing"] = str(ds["bearing"].values[where[-1]]) if where else None
    touching = ds["tooth_contact"].values
    out["tooth_contact"] = float(np.nanmin(touching)) if np.isfinite(touching).any() else None
    others = [Verdict(int(v)).name for v in ds["other"].values if v]
    return out | ({"other": sorted(set(others))} if others else {})


def widest_window(at: Array, swing: Array, verdict: NDArray[np.int8], limit: float) -> tuple[float, float]:
    """Ends of the widest run of safe speeds, each drawn out to where the amplitude crosses the limit; NaN without any."""
    safe = np.concatenate([[False], verdict == Verdict.safe, [False]])
    best = (np.nan, np.nan)
    for a, b in zip(np.flatnonzero(safe[1:] & ~safe[:-1]), np.flatnonzero(safe[:-1] & ~safe[1:]) - 1, strict=True):
        low, high = (crossing(at, swing, verdict, limit, int(i), step) for i, step in ((a, -1), (b, 1)))
        if not high - low <= best[1] - best[0]:
            best = (low, high)
    return best


def crossing(at: Array, swing: Array, verdict: NDArray[np.int8], limit: float, last: int, step: int) -> float:
    """Where the amplitude crosses the limit beyond the last safe speed, or that speed where the next has another reason."""
    beyond = last + step
    if not 0 <= beyond < at.size or verdict[beyond] != Verdict.amplitude:
        return float(at[last])
    return float(at[last] + (at[beyond] - at[last]) * (limit - swing[last]) / (swing[beyond] - swing[last]))
