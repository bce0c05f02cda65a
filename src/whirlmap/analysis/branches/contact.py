"""Where a branch ends because its orbits or equilibria reach a stop: the first whose smallest gap is zero.

Equations go on behind the stop. The branch is followed there, without the stop (`unstopped`) and for one step, and the place
is found between both points as that of a grazing orbit is (`whirlmap.analysis.branches.grazing`).
"""

from collections.abc import Callable, Generator, Mapping
from dataclasses import replace
from functools import lru_cache
from typing import Any

from sympy import sympify

from whirlmap.analysis.branches.bracketing import located
from whirlmap.analysis.branches.corrector import Ask, Corrected, Lost
from whirlmap.analysis.branches.equilibria import Equilibria
from whirlmap.analysis.branches.grazing import SAMPLES, extremes_of, heights
from whirlmap.analysis.branches.periodic_orbits import PeriodicOrbits
from whirlmap.equations.model import Model
from whirlmap.kernels.lowering.formulas import Formula, numpy_function
from whirlmap.results.status import Status

#: Asks for the next point from one: that point, what stopped it where there is none, and whether it lies at an end.
Stepped = Callable[[Corrected], Generator[Ask, Corrected | Lost, tuple[Corrected | None, Status, str]]]


@lru_cache(maxsize=8)
def unstopped(model: Model) -> Model:
    """The same model whose stops end no run; it reads the same parameters."""
    open_ones = {name: replace(stop, gap=1 + sympify(stop.gap) ** 2) for name, stop in model.stops.items()}
    return replace(model, stops=open_ones)


def without_stops(a: Corrected) -> Corrected:
    """The same point, whose orbits go on behind stops; equilibria do so already."""
    orbits = a.equations
    if not isinstance(orbits, PeriodicOrbits):
        return a
    return replace(a, equations=replace(orbits, system=replace(orbits.system, model=unstopped(orbits.system.model))))


def up_to_contact(a: Corrected, stepped: Stepped) -> Generator[Ask, Corrected | Lost, tuple[Corrected | None, Status, str]]:
    """The next point of a branch, or the contact where that lies before it.

    Parameters
    ----------
    a : Corrected
    stepped : Stepped
        Its answer is returned where no contact lies before that point.
    """
    gaps = reachable_gaps(a)
    b, lost, ended = yield from stepped(a)
    if not gaps or (b is None and lost != Status.contact):
        return b, lost, ended
    beyond = without_stops(a)
    if b is None:
        b = (yield from stepped(beyond))[0]
        if b is None or smallest_gap(b, gaps, 0) > 0:
            return None, lost, ""
    elif smallest_gap(b, gaps, 0) > 0:
        return b, lost, ended
    at = yield from located(beyond, b, lambda c: smallest_gap(c, gaps, SAMPLES))
    return at, Status.contact, "contact"


def smallest_gap(c: Corrected, gaps: Mapping[str, Any], samples: int) -> float:
    """Smallest of these gaps; along an orbit between its steps too, with so many samples in each T at least."""
    role, equations = f"gaps {' '.join(gaps)}", c.equations
    if isinstance(equations, Equilibria):
        model, values = equations.system.model, equations.columns(c.point.free[:, None])[:, 0]
        of = numpy_function(model, role, lambda: Formula([model.states, model.parameters], list(gaps.values())))
        return float(min(of(list(c.point.x[0]), list(values))))
    rows = heights(c, samples, role, list(gaps.values()))
    return min(min([float(row.min()), *(e.value for e in extremes_of(row) if not e.maximum)]) for row in rows)


def reachable_gaps(c: Corrected) -> dict[str, Any]:
    """Gaps of the stops that the motion can reach with these parameters."""
    equations = c.equations
    if not isinstance(equations, PeriodicOrbits | Equilibria) or not equations.system.model.stops:
        return {}
    model, values = equations.system.model, list(equations.columns(c.point.free[:, None])[:, 0])
    stops = model.stops
    of = numpy_function(model, "reachable", lambda: Formula([model.parameters], [s.reachable for s in stops.values()]))
    return {name: stop.gap for (name, stop), real in zip(stops.items(), of(values), strict=True) if real > 0}
