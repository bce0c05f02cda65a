"""Following one branch from a point in one direction: pseudo-arclength steps, as a generator that asks for points.

Many branches are followed at once: each is a generator, and what they ask for is corrected in one call (`stepping`).
"""

from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.branches.bracketing import located
from whirlmap.analysis.branches.contact import up_to_contact
from whirlmap.analysis.branches.corrector import Ask, Corrected, Lost, along_parameter, correct
from whirlmap.analysis.branches.event_curves import EventCurve
from whirlmap.analysis.branches.events import Event, StepTooLongError, events_between, may_cross_twice
from whirlmap.analysis.branches.grazing import grazings_between
from whirlmap.analysis.branches.limits import EDGE, Limits
from whirlmap.analysis.branches.orbit_steps import coarser, divided, fine_enough, too_long, with_more_steps
from whirlmap.analysis.branches.periodic_orbits import PeriodicOrbits
from whirlmap.analysis.branches.resonances import LAST, points_between
from whirlmap.analysis.branches.step_length import next_step
from whirlmap.results.status import Status

Array = NDArray[np.float64]
Asking = Generator[Ask, Corrected | Lost, Any]

#: First step over the longest, and shortest step over it.
FIRST, SHORTEST = 0.1, 1e-7
#: Steps below this part of the longest take what they find: two events in one may be one point.
FINE = 1e-4
#: Part of the longest below which steps take it that a multiplier that comes near the unit circle stays on its side.
SHY = 1 / 64
#: Largest angle between neighbouring tangents, and largest distance from the predicted point, over the step.
ANGLE, AWAY = 0.25, 0.5
#: Part of the longest step with which a cycle is followed to its equilibrium.
SMALL = 1e-4
#: The steps of an orbit are checked at every such point, where an event lies, and where they are fewer than before.
CHECKED = 4
#: Points after which a branch may have come back to its beginning, and distance within which it has, in sizes.
ROUND, SAME = 4, 1e-6
#: Neighbouring points over which a parameter that stands still is told from a fold, and least length of them, in sizes.
STANDING, LENGTH = 16, 1e-5
#: Ends that are no fault, in words.
ENDS = {
    "range": "the end of the range", "closed": "its first point", "contact": Status.contact.sentence,
    "vertical": "the parameter stands still while the orbit changes: here there are orbits of many sizes",
}  # fmt: skip


@dataclass
class Trace:
    """A branch in one direction.

    Attributes
    ----------
    points : list of Corrected
        The seed first.
    events : list of (int, Event)
        The event, and the index of the point before it.
    end : str
        ``range``, ``closed``, ``contact``, ``kink``, ``vertical`` or ``steps``; empty while it is followed.
    why : str
        What stopped it, in words.
    doubts : set of str
        What could not be made sure on the way.
    """

    points: list[Corrected]
    events: list[tuple[int, Event]] = field(default_factory=list)
    end: str = ""
    why: str = ""
    doubts: set[str] = field(default_factory=set)


def stepping(runs: Sequence[Asking]) -> Iterator[int]:
    """Run generators to their ends, and give how many still go on, after each round.

    The points that all of them ask for are corrected in one call.
    """
    waiting: list[tuple[Asking, Ask]] = []
    for run in runs:
        waiting += _next(run, None)
    while waiting:
        found = correct([ask for _, ask in waiting])
        waiting = [pair for (run, _), c in zip(waiting, found, strict=True) for pair in _next(run, c)]
        yield len(waiting)


def _next(run: Asking, answer: "Corrected | Lost | None") -> list[tuple[Asking, Ask]]:
    try:
        return [(run, run.send(answer))]  # type: ignore[arg-type]  # a generator begins with None
    except StopIteration:
        return []


def trace(out: Trace, sign: float, limits: Limits, *, halves: Array | None = None) -> Asking:
    """Follow a branch from its first point.

    Parameters
    ----------
    out : Trace
        With the first point; the others are added, so that who stops keeps them.
    sign : float
        Side to which the first step goes, of the tangent as it is; of a branch with more points, away from them.
    halves : array, shape (state,), optional
        Of a doubled orbit: direction in which its two halves differ; where they come to differ no more it has closed on the
        orbit that it doubled from.
    """
    seed = out.points[0]
    first = a = turned(seed, sign)
    if len(out.points) > 1:  # it was interrupted, and goes on
        first, a = turned(seed, towards(seed, out.points[1])), out.points[-1]
        a = turned(a, -towards(a, out.points[-2]))
    step, lost = FIRST * limits.longest, Status.ok
    before: tuple[float, Corrected] | None = None
    which, _, edge = limits.left(a)
    if abs(a.point.free[which] - edge) <= EDGE * (limits.high - limits.low)[which]:
        out.end, out.why = "range", ENDS["range"]
    while not out.end:
        if len(out.points) > limits.points:
            out.end, out.why = "steps", f"{limits.points} points"
            break
        if step < SHORTEST * limits.longest:
            out.end, out.why = _ending(lost, a)
            break
        b, lost, ended = yield from up_to_contact(a, partial(_stepped, step=step, limits=limits))
        if b is not None and _overturned(b):
            if step <= SMALL * limits.longest:
                out.end, out.why = "closed", "the cycle shrinks to an equilibrium"
                break
            b = None
        if b is None:
            step /= 2
            continue
        try:
            if halves is not None and (closed := (yield from _collapsed(a, b, halves))) is not None:
                out.points.append(closed)
                out.end, out.why = "closed", "meets the orbit that it doubled from"
                break
            events = yield from _between(a, b, alone=step > FINE * limits.longest)
            if not events and before and step > SHY * limits.longest and may_cross_twice(before[1], a, b, before[0], step):
                raise StepTooLongError
            if events:  # which may be errors of the steps, as where a fast state is hardly stable with them
                finer, _ = yield from fine_enough(b, limits.accuracy)
                if (again := (yield from with_more_steps(a, finer))) is not None:
                    a = again
                    continue
        except StepTooLongError:
            if step > 2 * FINE * limits.longest:
                step /= 2
                continue
            events = []
            out.doubts.add("a bifurcation or a grazing orbit lies between two points where it was not located")
        if isinstance(a.equations, EventCurve) and a.equations.kind == "neimark-sacker":
            for k, event in enumerate(events):
                if event.kind in LAST:
                    events, b, ended = events[: k + 1], event.at, "closed"
                    out.why = "the pair of multipliers becomes real"
                    break
        if (closed := (yield from _came_back(first, a, b, len(out.points)))) is not None:
            b, ended = closed, "closed"
        out.events += [(len(out.points) - 1, e) for e in events]
        if len(out.points) % CHECKED == 0 or events or b.equations is not out.points[-1].equations:
            b, doubt = yield from fine_enough(b, limits.accuracy)
            out.doubts |= doubt
        elif too_long(b):
            b = yield from divided(b)
        out.points.append(b)
        if not ended and _stands_still(out.points[-STANDING:], limits):
            ended = "vertical"
        out.end, out.why = ended, out.why or ENDS.get(ended, "")
        before = step, a
        step, a = next_step(a, b, step, limits), coarser(b, limits.accuracy)


def turned(c: Corrected, sign: float) -> Corrected:
    """The same point with its tangent to the other side where the sign is negative."""
    return replace(c, tangent=sign * c.tangent, turned=sign * c.turned)


def towards(a: Corrected, b: Corrected) -> float:
    """Sign with which the tangent of a point shows to a neighbour."""
    n, rest = a.point.x.shape[1], a.tangent.size - a.point.x.size
    ends = np.concatenate([b.point.x[0] - a.point.x[0], b.point.vector[-rest:] - a.point.vector[-rest:]])
    own = np.concatenate([a.tangent[:n], a.tangent[-rest:]])
    sizes = np.concatenate([a.linear.sizes[:n], a.linear.sizes[-rest:]])
    return 1.0 if (own / sizes) @ (ends / sizes) >= 0 else -1.0


def _stepped(a: Corrected, step: float, limits: Limits) -> Generator[Ask, Corrected | Lost, tuple[Any, Status, str]]:
    """The next point; None where it was not found, or is not the next. And whether it lies at the end of the range."""
    sizes = a.linear.sizes
    ahead = a.tangent / sizes
    guess, normal, ended = a.point.vector + step * a.tangent, ahead, ""
    which, left, _ = limits.left(a)
    if left <= step:
        guess, normal, ended = a.point.vector + left * a.tangent, along_parameter(a.point, which), "range"
        step = max(left, 1e-12)
    b = yield Ask(a.equations, a.point.of(guess), normal, sizes, exact=isinstance(a.equations, EventCurve))
    if isinstance(b, Lost):
        return None, b.status, ""
    if ended and b.tangent / sizes @ ahead < 0:
        b = turned(b, -1.0)
    apart = np.linalg.norm((b.point.vector - guess) / sizes)
    there = b.tangent / sizes
    turn = np.arccos(min(1.0, float(there @ ahead / np.linalg.norm(there))))
    if apart > AWAY * step or (turn > ANGLE and step > FINE * limits.longest):
        return None, Status.ok, ""
    if (beyond := limits.outside(b.point)).size:
        return (yield from _stepped_onto(a, b, limits, int(beyond[0])))
    return _on_edge(b, limits, which) if ended else b, Status.ok, ended


def _on_edge(b: Corrected, limits: Limits, which: int) -> Corrected:
    """The same point with the free parameter at the end of its range, to which rounding brought it."""
    free = b.point.free.copy()
    free[which] = (limits.low if free[which] - limits.low[which] < limits.high[which] - free[which] else limits.high)[which]
    return replace(b, point=b.point.at(*free))


def _stepped_onto(
    a: Corrected, b: Corrected, limits: Limits, which: int
) -> Generator[Ask, Corrected | Lost, tuple[Any, Status, str]]:
    """The point at the end of the range, where a step has gone beyond it."""
    before, after = a.point.free[which], b.point.free[which]
    edge = limits.high[which] if after > limits.high[which] else limits.low[which]
    part = (edge - before) / (after - before)
    guess = a.point.of(a.point.vector + part * (b.point.vector - a.point.vector))
    found = yield Ask(a.equations, guess, along_parameter(a.point, which), a.linear.sizes)
    if isinstance(found, Lost) or limits.outside(found.point).size:
        return None, found.status if isinstance(found, Lost) else Status.ok, ""
    if found.tangent / a.linear.sizes @ (a.tangent / a.linear.sizes) < 0:
        found = turned(found, -1.0)
    return _on_edge(found, limits, which), Status.ok, "range"


def _between(a: Corrected, b: Corrected, *, alone: bool) -> Generator[Ask, Corrected | Lost, list[Event]]:
    """Events between two points of a branch, or of a curve of events."""
    if isinstance(a.equations, EventCurve):
        return (yield from points_between(a, b))
    events = yield from events_between(a, b, alone=alone)
    return events + (yield from grazings_between(a, b))


def _came_back(first: Corrected, a: Corrected, b: Corrected, points: int) -> Generator[Ask, Corrected | Lost, Any]:
    """The first point, where the branch has come back to it between two points; else None."""
    if points < ROUND or first.point.x.shape != a.point.x.shape:
        return None
    sizes = a.linear.sizes
    chord = (b.point.vector - a.point.vector) / sizes
    length = np.linalg.norm(chord)
    to = (first.point.vector - a.point.vector) / sizes
    part = to @ chord / length**2
    if not (0 < part <= 1 and np.linalg.norm(to - part * chord) <= 0.5 * length):
        return None
    if first.tangent / sizes @ (a.tangent / sizes) <= 0:
        return None
    found = yield Ask(a.equations, first.point, chord / length, sizes)
    if isinstance(found, Lost) or np.abs((found.point.vector - first.point.vector) / sizes).max() > SAME:
        return None
    return found


def _collapsed(a: Corrected, b: Corrected, halves: Array) -> Generator[Ask, Corrected | Lost, Any]:
    """Where a doubled orbit becomes the orbit that it doubled from; None where it does not."""
    if apart_in_halves(a) @ halves * (apart_in_halves(b) @ halves) > 0:
        return None
    return (yield from located(a, b, lambda c: float(apart_in_halves(c) @ halves)))


def apart_in_halves(c: Corrected) -> Array:
    """By how much the two halves of an orbit begin apart, in sizes of the states."""
    count, n = c.point.x.shape
    return np.asarray((c.point.x[0] - c.point.x[count // 2]) / c.linear.weights[:n])


def _overturned(c: Corrected) -> bool:
    """Whether a cycle crosses its section against the declared direction: it has passed through its equilibrium."""
    orbits, (count, n) = c.equations, c.point.x.shape
    if not isinstance(orbits, PeriodicOrbits) or orbits.periods:
        return False
    jacobian, states = c.linear.jacobian, count * n
    return bool(jacobian[states, :n] @ jacobian[states - n : states, states] < 0)


def _stands_still(last: Sequence[Corrected], limits: Limits) -> bool:
    """Whether the only free parameter is the same at all of the last points, as where a linear motion is in resonance.

    Events on such a stretch are rounding, and the branch would creep along it.
    """
    values = [c.value for c in last]
    if len(last) < STANDING or last[0].point.free.size > 1 or max(values) - min(values) > EDGE * limits.width:
        return False
    n = last[0].point.x.shape[1]
    moved = (last[-1].point.x[0] - last[0].point.x[0]) / last[-1].linear.weights[:n]
    return bool(np.abs(moved).max() >= LENGTH)


def _ending(lost: Status, a: Corrected) -> tuple[str, str]:
    """Word and reason for a branch whose steps have become too short."""
    if lost == Status.contact:
        return "contact", lost.sentence
    kinked = isinstance(a.equations, PeriodicOrbits) and a.equations.has_surfaces
    if lost in (Status.sticks, Status.chatters) or (lost == Status.ok and kinked):
        return "kink", lost.sentence if lost != Status.ok else "the orbit meets a surface at which the rates change"
    return "steps", lost.sentence if lost != Status.ok else "no next point was found with the shortest step"
