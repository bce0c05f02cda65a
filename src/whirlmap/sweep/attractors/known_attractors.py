"""The attractors that a search has found, and the assignment of states, orbits and traces to them."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.labels.same_attractor import same_set
from whirlmap.analysis.motion.ensembles import cyclic_states
from whirlmap.analysis.periodic_orbits.closed_orbit import ClosedOrbit, flows_into
from whirlmap.integrate.scales import scales_between
from whirlmap.integrate.system import System

Array = NDArray[np.float64]


@dataclass
class Found:
    """What a search holds; arrays over the starts."""

    status: NDArray[np.int8]
    of: NDArray[np.int64]  # number of the attractor from 0, -1 none
    representative: list[Array]  # a state on each attractor, at phase zero
    multiple: list[int]  # its return in common periods, 0 where none
    outcome: NDArray[np.int8]  # drifting, growing or not settled, else undecided
    settled: int = 0  # starts that have settled, the first ones


class KnownAttractors:
    """Attractors of one operating point by number.

    Attributes
    ----------
    orbits : dict of int to ClosedOrbit
        Those that return.
    traces : dict of int to (array, bool)
        Section points (time, state) of those that do not, and whether they are smooth.
    """

    def __init__(self, system: System) -> None:
        self.model, self.period, self.cyclic = system.model, system.period, cyclic_states(system)
        self.orbits: dict[int, ClosedOrbit] = {}
        self.traces: dict[int, tuple[Array, bool]] = {}

    def orbit_at(self, x: Array) -> NDArray[np.int64]:
        """Number of the orbit on which each of some settled states (state, run) lies; -1 where on none."""
        out = np.full(x.shape[1], -1)
        for number, orbit in self.orbits.items():
            out[(out < 0) & (orbit.distance(x, self.cyclic)[0] <= orbit.within)] = number
        return out

    def same_orbit(self, orbit: ClosedOrbit) -> int | None:
        """Number of the orbit that this one is, of those with a point in common; None where it is new."""
        for number, other in self.orbits.items():
            if other.distance(orbit.points[0][:, None], self.cyclic)[0][0] <= max(orbit.within, other.within):
                return number
        return None

    def comes_to(
        self, trace: Array, smooth: bool, sets: Mapping[int, tuple[Array, bool]] | None = None
    ) -> int | None:
        """Number of the orbit that a trace (time, state) converges to, or of the first set that it traces as well.

        ``sets`` are compared instead of the known ones.
        """
        for number, orbit in self.orbits.items():
            if flows_into(trace[:, :, None], orbit, self.cyclic)[0]:
                return number
        for number, (known, kind) in (self.traces if sets is None else sets).items():
            whole = np.isfinite(trace).all() and np.isfinite(known).all()
            if whole and same_set(trace, known, self.scale_of(known), self.cyclic, smooth=smooth and kind):
                return number
        return None

    def scale_of(self, trace: Array) -> Array:
        """What differences of each state are divided by, from a trace (time, state)."""
        low, high = trace.min(axis=0)[:, None], trace.max(axis=0)[:, None]
        return scales_between(self.model, np.array([self.period]), low, high)[:, 0]

    def renumber(self, new: Mapping[int, int]) -> None:
        """Give attractors new numbers, and forget those that have none."""
        self.orbits = {new[n]: orbit for n, orbit in self.orbits.items() if n in new}
        self.traces = {new[n]: trace for n, trace in self.traces.items() if n in new}
