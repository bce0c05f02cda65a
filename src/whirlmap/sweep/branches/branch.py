"""One branch: its points along arclength, its events, and how it ends."""

from dataclasses import dataclass, field
from itertools import pairwise
from math import sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.branches.corrector import Corrected
from whirlmap.analysis.branches.equilibria import Equilibria
from whirlmap.analysis.branches.event_curves import EventCurve
from whirlmap.analysis.branches.events import Event, along
from whirlmap.analysis.branches.periodic_orbits import PeriodicOrbits
from whirlmap.analysis.branches.tracing import Trace
from whirlmap.integrate.system import System
from whirlmap.sweep.branches.seeds import Seed

Array = NDArray[np.float64]

#: How a branch may end, in this order as flags of a Dataset.
ENDS = ("range", "closed", "contact", "kink", "steps", "start", "interrupted", "vertical")
#: What its points are.
KINDS = ("orbit", "cycle", "equilibrium")


@dataclass(eq=False)  # two are the same where they are one object
class Branch:
    """A branch that is followed from a seed, in one direction or both.

    Attributes
    ----------
    seed : Seed
    down, up : Trace, optional
        The parts on either side of the seed, each with the seed first.
    begins : str
        How it ends at the seed where it is followed in one direction only.
    halves : array, shape (state,), optional
        Of doubled orbits: direction in which their halves differ.
    upwards : float, optional
        Sign with which the seed's tangent goes to ``up``; along the parameter where absent.
    """

    seed: Seed
    down: Trace | None = None
    up: Trace | None = None
    begins: str = "start"
    halves: Array | None = None
    upwards: float | None = None
    parts: list[Trace] = field(init=False)

    def __post_init__(self) -> None:
        """The parts that there are."""
        self.parts = [part for part in (self.down, self.up) if part is not None]

    @property
    def kind(self) -> str:
        """One of `KINDS`."""
        return "equilibrium" if isinstance(self.seed.at.equations, Equilibria) else "orbit" if self.forced else "cycle"

    @property
    def system(self) -> System:
        """The system whose branch it is."""
        equations: Any = self.seed.at.equations
        found: System = (equations.orbits if isinstance(equations, EventCurve) else equations).system
        return found

    @property
    def forced(self) -> bool:
        """Whether it is one of forced orbits."""
        return self.system.model.forced

    def kinked(self) -> bool:
        """Whether the rates of its orbits have kinks or jumps."""
        equations = self.seed.at.equations
        return isinstance(equations, PeriodicOrbits) and equations.has_surfaces

    def closed(self) -> bool:
        """Whether it comes back to its first point."""
        return any(part.end == "closed" and part.why == "its first point" for part in self.parts)

    def points(self) -> list[Corrected]:
        """All points along the branch."""
        down, up = self._sides()
        return [*(down.points[:0:-1] if down else []), self.seed.at, *(up.points[1:] if up else [])]

    def measured_points(self) -> list[Corrected]:
        """Its points, then its events."""
        return [*self.points(), *(e.at for _, e in self.events())]

    def events(self) -> list[tuple[int, Event]]:
        """Its events along the branch, each with the index of the point before it."""
        down, up = self._sides()
        before = len(down.points) - 1 if down else 0
        found = [(before - 1 - k, e) for k, e in reversed(down.events)] if down else []
        return found + ([(before + k, e) for k, e in up.events] if up else [])

    def ends(self) -> tuple[str, str]:
        """How it ends on either side."""
        down, up = self._sides()
        if self.closed():
            return "closed", "closed"
        return (down.end if down else self.begins) or "interrupted", (up.end if up else self.begins) or "interrupted"

    def reasons(self) -> tuple[str, str]:
        """The same in words."""
        down, up = self._sides()
        first = "the orbit that it doubled from" if self.halves is not None else "its first point"
        return down.why if down else first, up.why if up else first

    def doubts(self) -> set[str]:
        """What could not be made sure."""
        return set().union(*(part.doubts for part in self._sides() if part))

    def _sides(self) -> tuple[Trace | None, Trace | None]:
        """The parts that count: a closed branch is whole with one of them."""
        if self.up and self.up.end == "closed" and self.closed():
            return None, self.up
        if self.down and self.closed():
            return self.down, None
        return self.down, self.up


def arclengths(points: list[Corrected]) -> Array:
    """Length of the branch up to each point: root mean square of the states in their sizes, and widths of the ranges."""
    out = [0.0]
    for a, b in pairwise(points):
        n, before, after = a.point.x.shape[1], a.point.x.size, b.point.x.size
        states = (b.point.x[0] - a.point.x[0]) / a.linear.sizes[:n] * sqrt(len(a.point.x))  # sizes count the segments
        rest = (b.point.vector[after:] - a.point.vector[before:]) / a.linear.sizes[before:]
        out.append(out[-1] + float(np.linalg.norm([*states, *rest])))
    return np.array(out)


def rises(seed: Corrected) -> float:
    """Sign with which a seed's tangent goes up along the parameter."""
    return 1.0 if along(seed) >= 0 else -1.0
