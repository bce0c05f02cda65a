"""Curves of bifurcation points in two parameters: `event_curve`."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, Unpack

import numpy as np
import xarray as xr

from whirlmap.analysis.branches.corrector import Ask, Corrected, Lost, along_parameter, correct
from whirlmap.analysis.branches.event_curves import EventCurve
from whirlmap.analysis.branches.events import Event
from whirlmap.analysis.branches.limits import Limits
from whirlmap.analysis.branches.periodic_orbits import PeriodicOrbits
from whirlmap.analysis.branches.tracing import Trace, stepping, trace
from whirlmap.analysis.branches.unknowns import Unknowns
from whirlmap.errors import RangeError
from whirlmap.integrate.ranges import Range
from whirlmap.integrate.system import System
from whirlmap.integrate.varied_inputs import input_of
from whirlmap.options.computed import LABELLING, Labelling
from whirlmap.options.execution import EXECUTION, Execution
from whirlmap.options.taking import LabellingParts
from whirlmap.results.schema import with_attributes
from whirlmap.sweep.branches.branch import Branch
from whirlmap.sweep.branches.branch_dataset import dataset
from whirlmap.sweep.branches.continue_orbit import ACCURACY, attributes, continue_orbit
from whirlmap.sweep.branches.following import distinct
from whirlmap.sweep.branches.free_parameters import FreeParameters, Varied
from whirlmap.sweep.branches.measured_branches import BATCH, Measuring
from whirlmap.sweep.branches.seeds import Seed
from whirlmap.sweep.interruptible import Work, in_parts
from whirlmap.units import read

#: Events whose curves can be followed.
KINDS = ("fold", "period-doubling", "neimark-sacker")


@in_parts("continue")
def event_curve(
    system: System,
    vary: Mapping[str, str | Range | Sequence[Any]],
    event: str,
    *,
    near: float | str | None = None,
    begin: float | str | None = None,
    period: int | None = None,
    orbit: Mapping[str, float] | Sequence[float] | None = None,
    points: int = 2000,
    longest: float = 0.02,
    labelling: Labelling = LABELLING,
    execution: Execution = EXECUTION,
    **_given: Unpack[LabellingParts],
) -> Work:
    """Follow the curve of a bifurcation point in two parameters.

    Parameters
    ----------
    system : System
        Its values count; that of the second parameter is where the first point is sought (the middle of its range where it
        lies outside).
    vary : mapping of str to (start, stop), or str
        Two free parameters, each a parameter of the model or a dimensional input, and their ranges.
    event : {"fold", "period-doubling", "neimark-sacker"}
    near : float or str, optional
        Value of the first parameter near which the event is; where absent all events of the kind that lie on the branch are
        followed, each curve once.
    begin : float or str, optional
        Value of the first parameter at which the branch on which the event is sought begins (`continue_orbit`); the start of
        its range where absent.
    period, orbit, points, longest
        As in `continue_orbit`.
    labelling : Labelling, optional
        How the settled motion is found; or its parts as keywords.
    execution : Execution, optional
        How it is run, which changes no number; or its parts as keywords, ``workers``, ``progress``.

    Returns
    -------
    xr.Dataset
        As that of `continue_orbit`, with both parameters over ``point``; its events are cusps (``cusp``) and strong
        resonances (``resonance-1-1`` to ``resonance-1-4``).

    Raises
    ------
    RangeError
        Not two parameters, another event, a model that is not forced, or no such event on the branch.

    Notes
    -----
    The orbit's equations and one more (`analysis.branches.event_curves`), by pseudo-arclength [kuznetsov2004]. A curve of
    Neimark-Sacker points ends where the pair of multipliers becomes real (``closed``), at 1:1 and 1:2 resonances.

    References
    ----------
    [kuznetsov2004] curves of events, their points of codimension two.
    """
    if event not in KINDS:
        raise RangeError(f"event is one of {', '.join(KINDS)}, not {event!r}")
    if len(vary) != 2:
        raise RangeError(f"a curve of events has two free parameters, found {' '.join(vary) or 'none'}")
    if not system.model.forced:
        raise RangeError(f"{system.model.name}: curves of events are followed for forced models only")
    varied = tuple(Varied.of(system, name, ends, beside=True) for name, ends in vary.items())
    free = FreeParameters(system, varied)
    second = varied[1]
    now = _present(system, second)
    if not second.low <= now <= second.high:
        now = (second.low + second.high) / 2
        there: dict[str, Any] = {n: float(c[0]) for n, c in FreeParameters(system, (second,)).at(now).items()}
        system = system.replace(**there)
    where = None if near is None else varied[0].read(near, "--near")
    low, high = (np.array([getattr(v, end) for v in varied]) for end in ("low", "high"))
    limits = Limits(low, high, longest, points, labelling.integration.accuracy or ACCURACY)
    branches, measuring = list[Branch](), Measuring()
    name, ends = next(iter(vary.items()))
    branch: Any = continue_orbit.parts(
        system, name, ends, begin=begin, period=period, orbit=orbit, points=points, longest=longest, labelling=labelling,
        execution=execution,
    )  # fmt: skip

    def parts(work: Work) -> Iterator[int]:
        for done in branch:
            work.total = done + 1
            yield done
        count = work.done
        for first in _firsts(branch.found.events(event), where, f"{name}={ends}", event):
            seed = _on_curve(first, free, event, np.array([first.at.value, now]))
            branches.append(Branch(seed, Trace([seed.at]), Trace([seed.at])))
        sides = [(part, way) for b in branches for part, way in ((b.down, -1.0), (b.up, 1.0)) if part is not None]
        for _ in stepping([trace(part, way, limits) for part, way in sides]):
            if execution.progress:
                execution.progress(1)
            if len(measuring.missing(points := [p for b in branches for p in b.measured_points()])) >= BATCH:
                measuring(points)
            count += 1
            work.total = count + 1
            yield count
        branches[:] = distinct(branches)
        work.total = max(work.done, 1)
        yield work.total

    def gather(work: Work) -> xr.Dataset | None:
        if not branches:
            return None
        ds = dataset(system, varied, branches, measuring)
        facts = {"event": event, "longest": longest, "accuracy": limits.accuracy}
        return with_attributes(ds, attributes(system, varied, branches, work, ds, limits.accuracy) | facts)

    return Work(1, parts, gather)


def _present(system: System, varied: Varied) -> float:
    """Value of a free parameter in the case."""
    if varied.name in system.parameters:
        return float(system.values[varied.name])
    declared = input_of(system, varied.name)
    assert declared is not None and system.machine is not None
    # Degrees have a zero of their own.
    one, none = (float(read(f"{n} {varied.unit}".strip(), declared.unit)) for n in (1, 0))
    return (float(system.machine.exact[declared.name]) - none) / (one - none)


def _firsts(events: Sequence[Event], near: float | None, branch: str, kind: str) -> Sequence[Event]:
    """The events at which curves begin."""
    if not events:
        raise RangeError(f"no {kind} on the branch along {branch}")
    return events if near is None else [min(events, key=lambda e: abs(e.at.value - near))]


def _on_curve(first: Event, free: FreeParameters, kind: str, values: Any) -> Seed:
    """The event as the first point of its curve, where the second parameter stays."""
    orbits = first.at.equations
    assert isinstance(orbits, PeriodicOrbits)
    both = replace(orbits, columns=free.columns, allowed=free.allowed, widths=free.widths, steps=2 * orbits.steps)
    curve = EventCurve(both, kind)  # type: ignore[arg-type]  # one of KINDS
    guess = Unknowns(first.at.point.x, values, first.at.point.duration)
    (linear,) = both.linear([guess])
    (found,) = correct([Ask(curve, guess, along_parameter(guess, 1), linear.sizes)])
    if isinstance(found, Lost):
        raise RangeError(f"the {kind} at {values[0]:g} is no first point of a curve: Newton's method lost it")
    return Seed(found, first_period(found), found.point.x[:1].T)


def first_period(c: Corrected) -> int:
    """T of one return of a curve's orbits."""
    curve = c.equations
    assert isinstance(curve, EventCurve)
    return curve.orbits.periods
