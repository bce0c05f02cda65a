"""Branches of an interrupted Dataset, ready to go on."""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from whirlmap.analysis.branches.corrector import Ask, Corrected, Lost, correct
from whirlmap.analysis.branches.equilibria import Equilibria
from whirlmap.analysis.branches.events import Event
from whirlmap.analysis.branches.orbit_steps import in_segments
from whirlmap.analysis.branches.periodic_orbits import PeriodicOrbits
from whirlmap.analysis.branches.tracing import Trace, apart_in_halves, towards
from whirlmap.analysis.branches.unknowns import Unknowns
from whirlmap.errors import RangeError
from whirlmap.sweep.branches.branch import Branch
from whirlmap.sweep.branches.branch_dataset import events_of, word
from whirlmap.sweep.branches.seeds import Beginning, Seed

Array = NDArray[np.float64]

#: Attributes in which an interrupted Dataset must be what goes on with it.
SAME = ("model_hash", "case_hash", "parameters", "varied", "range", "longest", "accuracy", "doublings", "direction")


def refuse_other(ds: xr.Dataset, facts: dict[str, object]) -> None:
    """Refuse to go on with a Dataset of something else.

    Raises
    ------
    RangeError
        Naming what differs.
    """
    differ = [name for name in SAME if not np.array_equal(np.asarray(ds.attrs.get(name)), np.asarray(facts[name]))]
    if differ:
        raise RangeError(f"resume: the file holds branches of another run: {', '.join(differ)} differ")


def resumed(first: Beginning, ds: xr.Dataset) -> list[Branch]:
    """Branches as they were, each open where it was interrupted.

    Every point is corrected again from what the file keeps of it, all of them in one call.

    Raises
    ------
    RangeError
        A point that Newton's method does not find again.
    """
    asks, places = [], []
    of, events = ds["branch_of"].values, events_of(ds)
    for number in ds["branch"].values.tolist():
        here = np.flatnonzero(of == number)
        mine = np.flatnonzero(events["branch"].values == number)
        states = np.concatenate([ds["section"].values[here, 0], events["section"].values[mine]])
        name = str(ds.attrs["varied"])
        values = np.concatenate([ds[name].values[here], events[name].values[mine]])
        after = events["after"].values[mine]
        neighbours = [(max(k - 1, 0), min(k + 1, here.size - 1)) for k in range(here.size)]
        neighbours += [(int(k), min(int(k) + 1, here.size - 1)) for k in after]
        at = np.concatenate([here, here[after]])  # an event has the steps and segments of the point before it
        for k, (a, b) in enumerate(neighbours):
            chord = states[b] - states[a], values[b] - values[a]
            asks.append(_ask(first, ds, number - 1, int(at[k]), states[k], float(values[k]), chord))
        places.append((here.size, mine))
    found = [c for c in correct(asks) if not isinstance(c, Lost)]
    if len(found) < len(asks):
        raise RangeError("resume: Newton's method does not find all points of the file again")
    out, begin = [], 0
    for k, (count, mine) in enumerate(places):
        points, located = found[begin : begin + count], found[begin + count : begin + count + mine.size]
        begin += count + mine.size
        words = [word(ds, "event_kind", code) for code in events["kind"].values[mine]]
        where, *rest = (events[name].values[mine].tolist() for name in ("after", "surface", "contacts"))
        made = list(zip(where, map(Event, words, located, *rest), strict=True))
        out.append(_branch(ds, k, points, made))
    return out


def _ask(
    first: Beginning, ds: xr.Dataset, branch: int, at: int, state: Array, value: float, chord: tuple[Array, float]
) -> Ask:
    """A point of the file, to be corrected in the hyperplane across the branch, in which the duration of a cycle is free."""
    kind, period = word(ds, "kind", ds["kind"].values[branch]), int(ds["period_T"].values[branch])
    equations: PeriodicOrbits | Equilibria
    point = Unknowns(state[None], np.array([value]))
    if kind == "equilibrium":
        equations = first.equilibria(state)
    else:
        equations = first.equations(period if kind == "orbit" else 0, int(ds["steps"].values[at]))
        if kind == "cycle":
            point = Unknowns(point.x, point.free, float(ds["duration"].values[at]))
        (point,) = in_segments(equations, [point], int(ds["segments"].values[at]))
    (linear,) = equations.linear([point])
    normal = np.zeros(point.vector.size)
    normal[: state.size] = chord[0] / linear.sizes[: state.size]
    normal[-1] = chord[1] / linear.sizes[-1]
    return Ask(equations, point, normal / np.linalg.norm(normal), linear.sizes)


def _branch(ds: xr.Dataset, k: int, points: list[Corrected], events: list[tuple[int, Event]]) -> Branch:
    """One branch, turned so that an open end is the last."""
    ends = [word(ds, "end", e) for e in ds["end"].values[k]]
    if ends[0] == "interrupted" and ends[1] != "interrupted":
        last = len(points) - 2
        points, ends, events = points[::-1], ends[::-1], [(last - i, e) for i, e in reversed(events)]
    up = Trace(points, events, "" if ends[1] == "interrupted" else ends[1])
    down = Trace(points[:1]) if ends[0] == "interrupted" else None
    halves = None
    if ends[0] == "closed" and ends[1] != "closed":
        halves = apart_in_halves(points[0]) / np.linalg.norm(apart_in_halves(points[0]))
    seed = Seed(points[0], int(ds["period_T"].values[k]), points[0].point.x[:1].T)
    upwards = towards(points[0], points[1]) if len(points) > 1 else 1.0
    return Branch(seed, down, up, ends[0], halves, upwards)
