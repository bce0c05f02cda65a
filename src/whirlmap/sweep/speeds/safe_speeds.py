"""Safe speed windows: where a machine runs periodically and within a limit of vibration, and why it does not elsewhere.

1. Every speed of a grid is judged from a cold start, and in a run-up and a run-down through the grid (`motions_met`).
2. A speed is safe where all motions that were met are periodic, their largest peak-to-peak displacement is within the
   limit, and the teeth stay in contact. Where the cold start alone is all of that, motions coexist.
3. The edges of the windows are refined: `PARTS` speeds between a safe one and its neighbour that is not, `ROUNDS` times;
   those where a motion begins or is lost are put on the bifurcation point (`edge_events`).
"""

import json
from collections.abc import Iterator, Mapping
from typing import Any, Unpack

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from whirlmap.analysis.steady.pool import POOL
from whirlmap.errors import RangeError
from whirlmap.integrate.division import cores
from whirlmap.integrate.own_units import in_own_units
from whirlmap.integrate.system import System
from whirlmap.kernels.writing.routine import LANES
from whirlmap.options.computed import LABELLING, Labelling
from whirlmap.options.execution import EXECUTION, Execution
from whirlmap.options.taking import LabellingParts
from whirlmap.progress import tell
from whirlmap.results.schema import variable
from whirlmap.sweep.diagrams.in_batches import FIRST
from whirlmap.sweep.interruptible import Work, batches, in_parts
from whirlmap.sweep.parameters.engineering import number_of_limit
from whirlmap.sweep.points.label_points import POOLS
from whirlmap.sweep.speeds.edge_events import with_events
from whirlmap.sweep.speeds.run_up_and_down import cold_at, cold_motions, outcome, rounds_met
from whirlmap.sweep.speeds.unstable_rest import unstable_rest
from whirlmap.sweep.speeds.verdicts import Judge, Verdict, shaft_speed, speed_of
from whirlmap.sweep.speeds.windows import Edge, edge_points, refined_edges, stretches

Array = NDArray[np.float64]

#: Variables of the outcome that are kept.
KEPT = (
    "verdict", "other", "motions", "amplitude", "amplitude_cold", "tooth_contact", "min_film", "max_load", "regime",
    "status", "period_T", "lyapunov", "lyapunov_error",
)  # fmt: skip


@in_parts("speeds")
def safe_speeds(
    system: System,
    speeds: ArrayLike,
    limit: float | str,
    *,
    quantity: str | None = None,
    follow: bool = True,
    labelling: Labelling = LABELLING,
    execution: Execution = EXECUTION,
    **_given: Unpack[LabellingParts],
) -> Work:
    """Judge the speeds of a machine.

    Parameters
    ----------
    system : System
        Its values and start states count.
    speeds : array_like, shape (s,)
        Values of the model's speed parameter, ``s`` of the stock machines, positive and ascending, two or more; texts
        with a unit, or the text of a range, ``"500 rpm:6000 rpm:50"``.
    limit : float or str
        Largest peak-to-peak displacement that is allowed, in the model's length (clearances, for the machines), or with its
        unit, ``"20 um"``.
    quantity : str, optional
        State or output whose peak-to-peak counts, or the name of a station (a disk, a bearing, a wheel of a machine from
        parts), whose x and y both count; where absent the largest of the model's displacements.
    follow : bool
        Whether to run up and down through the speeds as well, which shows coexisting motions; about three times the work.
    labelling : Labelling, optional
        How points are measured; or its parts as keywords, ``settling``, ``lyapunov``, ``method``, ``steps``, ``accuracy``.
    execution : Execution, optional
        How it is run, which changes no number; or its parts as keywords, ``workers``, ``progress``.

    Returns
    -------
    xr.Dataset
        Over ``s``: ``verdict`` with CF flags; ``other``, why not, of the motions that a cold start does not meet;
        ``motions``, how many different ones were met; ``margin``, the distance of a safe speed to the nearer end of its
        window, infinite where it ends with the range on both sides. Of the worst motion met: ``amplitude`` (NaN where one
        ended early), ``tooth_contact`` (share of the time in which the teeth touch, NaN without teeth), and over ``bearing``
        ``min_film`` [c] and ``max_load`` [the model's force] of a film. Of the cold start: ``amplitude_cold``, ``regime``,
        ``status``, ``period_T``, ``lyapunov``. Where the case has dimensions, ``rpm(s)``. Over ``window``:
        ``window_start``, ``window_end``, ``gap_start``, ``gap_end`` (zero at an end of the range), ``window_amplitude``.
        ``attrs["stretches"]`` is a list of runs of speeds with one verdict as JSON (`windows.stretches`);
        ``attrs["windows"]`` those of them that are safe; ``attrs["unstable_rest"]`` says at which of the others the
        static equilibrium is unstable (`unstable_rest.unstable_rest`; "null" where that is not known).

    Raises
    ------
    RangeError
        The model declares no speed; speeds that do not ascend or are not positive; a limit that is not positive.
    InputError
        A unit where the case has no dimensions, or none where it needs one.

    Notes
    -----
    Speeds are judged from cold starts, all at once; with ``follow`` the settled motion of each is carried to both
    neighbours, until no new motion is met (`run_up_and_down`). Edges of windows are refined between a safe speed and its
    neighbour that is not; with ``follow``, an edge that a periodic motion's loss makes is the fold, period doubling or
    Neimark-Sacker point at which its branch loses it. What is narrower than the spacing of the speeds is not seen, nor a
    coexisting motion that neither cold start nor run-up meets.

    ``safe_speeds.parts`` gives the `Work`: the cold starts in batches of speeds, from the lowest on; each round of run-up
    and run-down; the edges of the windows. It counts the speeds, and one for each of the other two. Who stops keeps what
    is finished.
    """
    speed = speed_of(system)
    _, at = in_own_units(system, speed, speeds, "speeds")
    limit = number_of_limit(system, limit)
    refuse_speeds(at, limit)
    judge, progress = Judge(system, quantity, labelling, execution), execution.progress
    block, limits = LANES * (execution.workers or cores()), np.full(at.size, float(limit))
    cold: list[xr.Dataset] = []
    met: xr.Dataset | None = None
    edges: dict[int, Edge] | None = None
    followed, missing, rest = False, "the edges of the windows", None

    def parts(_: Work) -> Iterator[int]:
        nonlocal met, edges, followed, missing, rest
        for part in batches(at.size, first=FIRST * block, most=POOLS * POOL * block):
            cold.append(cold_motions(judge, {speed: at[part]}, limits[part]))
            yield part.stop
        met = cold_at(cold, system.model)
        safe = met["verdict"].values == Verdict.safe
        at_edges = int((safe[1:] != safe[:-1]).sum()) * edge_points(follow=follow)
        tell(progress, "more_points", at_edges + (2 * at.size if follow else 0))
        if follow:
            missing = "run-up and run-down"
            for met in rounds_met(judge, {speed: at}, limits, at.size, met):  # noqa: B007, B020 (the last one counts)
                tell(progress, "more_points", at_edges)
                yield at.size
            followed = True
            missing = "the edges of the windows"
            yield at.size + 1
        edges, ends = refined_edges(judge, at, met, limit, follow=follow)
        if follow:
            edges = with_events(judge, at, edges, ends)
        rest = unstable_rest(system, at[outcome(met, at.size)["verdict"].values != Verdict.safe])
        missing = ""
        yield at.size + 1 + follow

    def gather(work: Work) -> xr.Dataset | None:
        found = met
        speeds = at if met is not None else at[: sum(part.sizes["point"] for part in cold)]
        if found is None:
            if speeds.size < 2:
                work.done = 0
                return None
            found = cold_at(cold, system.model)
        ends = edges
        if ends is None:  # windows end with their last safe speed
            ends, _ = refined_edges(judge, speeds, found, limit, follow=False, rounds=0)
        ds = _dataset(system, judge, speeds, found, ends, limit, follow=followed, to_the_end=speeds.size == at.size)
        ds.attrs["unstable_rest"] = json.dumps(rest)
        if missing:
            fewer = speeds.size < at.size
            where = f"after {speeds.size} of {at.size} speeds" if fewer else f"before {missing} were finished"
            ds.attrs["incomplete"] = f"interrupted {where}"
        return ds

    return Work(at.size + 1 + follow, parts, gather)


def _dataset(
    system: System, judge: Judge, at: Array, met: xr.Dataset, edges: Mapping[int, Edge], limit: float, *, follow: bool,
    to_the_end: bool,
) -> xr.Dataset:
    speed = system.speed
    whole = outcome(met, at.size).swap_dims(point=speed)
    ds = whole[[name for name in KEPT if name in whole]]
    rows = stretches(ds, edges, whole=to_the_end)
    windows = [row for row in rows if row["verdict"] == Verdict.safe.name]
    ds["margin"] = variable(speed, _margins(at, windows), "1", "distance to the nearer end of the window of safe speeds",
                            measure="rotation")  # fmt: skip
    for name, key, meaning in (
        ("window_start", "start", "first safe speed ratio"), ("window_end", "end", "last safe speed ratio"),
        ("gap_start", "gap_start", "distance to the first speed below that was judged and is not safe"),
        ("gap_end", "gap_end", "distance to the first speed above that was judged and is not safe"),
        ("window_amplitude", "amplitude", "largest peak to peak in the window"),
    ):  # fmt: skip
        measure = "length" if key == "amplitude" else "rotation"
        ds[name] = variable("window", [w[key] for w in windows], "1", meaning, measure=measure)
    scale = shaft_speed(system) * 30 / np.pi
    if np.isfinite(scale):
        ds["rpm"] = variable(speed, at * scale, "rpm", "speed of the first shaft")
    return ds.assign_attrs(
        met.attrs, limit=limit, quantities=" ".join(judge.rows), not_judged=json.dumps(judge.not_judged),
        followed=int(follow), windows=json.dumps(windows), stretches=json.dumps(rows),
    )  # fmt: skip


def refuse_speeds(at: Array, limit: float) -> None:
    """Refuse speeds and limits that say nothing."""
    if at.ndim != 1 or at.size < 2 or not np.isfinite(at).all() or at[0] <= 0 or np.any(np.diff(at) <= 0):
        raise RangeError("speeds must be positive and ascend, and be two or more")
    if not 0 < limit < np.inf:
        raise RangeError(f"the limit must be a positive length, not {limit:g}")


def _margins(at: Array, windows: list[dict[str, Any]]) -> Array:
    """Distances to the ends of windows; an end of the range is none, what lies behind it is not known."""
    out = np.full(at.size, np.nan)
    for window in windows:
        inside = at[(at >= window["start"]) & (at <= window["end"])]
        below = inside - window["start"] if window["gap_start"] else np.inf
        above = window["end"] - inside if window["gap_end"] else np.inf
        out[np.isin(at, inside)] = np.minimum(below, above)
    return out
