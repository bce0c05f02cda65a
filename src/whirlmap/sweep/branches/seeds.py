"""Where branches begin: settled motions, given states and attractors; for points of files see `seeds_of_files`."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.branches.contact import reachable_gaps, smallest_gap
from whirlmap.analysis.branches.corrector import Ask, Corrected, Lost, along_parameter, correct
from whirlmap.analysis.branches.equilibria import Equilibria
from whirlmap.analysis.branches.orbit_steps import ROUNDED, STEPS, finished
from whirlmap.analysis.branches.periodic_orbits import PeriodicOrbits
from whirlmap.analysis.branches.segments import Lanes
from whirlmap.analysis.branches.unknowns import Equations, Unknowns
from whirlmap.analysis.labels.labelling import measure
from whirlmap.analysis.motion.ensembles import cyclic_states
from whirlmap.analysis.periodic_orbits.newton import wrapped
from whirlmap.analysis.simulation.poincare_section import section
from whirlmap.errors import RangeError, nearest
from whirlmap.integrate.harmonics import LONGEST as LONGEST_COMMON
from whirlmap.integrate.system import System
from whirlmap.options.computed import Labelling
from whirlmap.options.execution import Execution
from whirlmap.results.regime import Regime
from whirlmap.results.status import Status
from whirlmap.sweep.attractors.attractors import attractors
from whirlmap.sweep.attractors.repeat_time import repeat_of_forcing
from whirlmap.sweep.branches.free_parameters import FreeParameters

Array = NDArray[np.float64]

#: Section points from which Newton's method is tried where no settled orbit is at hand.
TRIED = 64
#: Distance over the sizes of the states within which two orbits are one, and motion of an equilibrium over its size.
SAME = 1e-5
#: T (typical times) over which crossings of a settled cycle are collected at first, and at most.
CROSSINGS, MOST_CROSSINGS = 64, 65536


def divisors(count: int) -> list[int]:
    """Divisors of a number that are smaller than it."""
    return [d for d in range(1, count) if count % d == 0]


@dataclass(frozen=True)
class Seed:
    """A first point.

    Attributes
    ----------
    at : Corrected
    period : int
        T of one return; crossings of the section of an unforced cycle; 0 of an equilibrium.
    phases : array, shape (state, phase)
        The orbit at all phases at which the equations are the same.
    """

    at: Corrected
    period: int
    phases: Array


@dataclass(frozen=True)
class Beginning:
    """What all first points share.

    Attributes
    ----------
    free : FreeParameters
    value : tuple of float
        Of the free parameters.
    labelling : Labelling
    execution : Execution
    accuracy : float
        Of the segments of orbits.
    """

    free: FreeParameters
    value: tuple[float, ...]
    labelling: Labelling
    execution: Execution
    accuracy: float

    @cached_property
    def system(self) -> System:
        """The system at that value."""
        columns: dict[str, Any] = {name: float(column[0]) for name, column in self.free.at(*self.value).items()}
        return self.free.system.replace(**columns)

    def settled(self, period: int | None) -> list[Seed]:
        """The settled motion, or the orbits of a given period that Newton's method finds from its section.

        Raises
        ------
        RangeError
            No periodic motion, and no period that says what to look for.
        """
        measured, ensemble = measure(
            self.free.system, self.free.at(*self.value), self.labelling, self.execution, kept=self.system.states
        )
        found = Regime(int(measured.returns.regime[0]))
        x, n = measured.end_state[:, 0], int(measured.returns.period[0])
        ran = Status(int(measured.status[0])) == Status.ok
        if found == Regime.at_rest and not self.system.model.forced:
            return self.equilibrium(x)
        if ran and found == Regime.at_rest:
            return self.orbits([x], period or ensemble.strobe)
        if ran and found == Regime.periodic and period in (None, n):
            return self.orbits([x], n) if self.system.model.forced else self.cycles(x, n)
        if period is not None and ran and self.system.model.forced:
            points = measured.returns.section[:, :, 0]
            points = points[np.isfinite(points).all(axis=1)][:: -ensemble.strobe][:TRIED]  # the last is at phase zero
            if seeds := self.orbits(list(points), period):
                return seeds
            raise RangeError(
                f"{self.place()}: Newton's method found no orbit of period {period} T from {len(points)} section points of"
                f" the settled motion, which is {found.label}"
            )
        raise RangeError(
            f"{self.place()}: the settled motion is {found.label}, no orbit to begin with; begin where it is periodic"
            " (--from VALUE), give a state near an orbit (--orbit NAME=VALUE,...), or a period (--period N)"
        )

    def given(self, state: Mapping[str, float] | Sequence[float], period: int | None) -> list[Seed]:
        """The orbit, or the equilibrium, that Newton's method finds from a state.

        Raises
        ------
        RangeError
            An unknown state, or no solution.
        """
        system = self.system
        if isinstance(state, Mapping):
            for name in state:
                if name not in system.states:
                    raise RangeError(f"orbit: {system.model.name} has no state {name!r}.{nearest(name, system.states)}")
            missing = [name for name in system.states if name not in state]
            if missing:
                raise RangeError(f"orbit: found no value for {' '.join(missing)}, expected one for every state")
            state = [float(state[name]) for name in system.states]
        x = np.array(state, dtype=float)
        if x.shape != (system.model.dimension,):
            raise RangeError(f"orbit: found {x.size} numbers, expected {system.model.dimension}, one for each state")
        if not np.isfinite(x).all():
            raise RangeError("orbit: found a number that is not finite")
        if system.model.forced:
            seeds = self.orbits([x], period or system.strobe)
        else:
            seeds = self.equilibrium(x) if period in (None, 0) else self.cycles(x, period or 1)
        if not seeds:
            raise RangeError(f"{self.place()}: Newton's method found no solution from the given state")
        return seeds

    def coexisting(self, starts: int) -> list[Seed]:
        """The periodic attractors, and the equilibria, that many starts come to.

        Raises
        ------
        RangeError
            None of the attractors is periodic.
        """
        found = attractors(self.system, starts=starts, labelling=self.labelling, execution=self.execution)
        seeds: list[Seed] = []
        for k in range(found.sizes["attractor"]):
            one = found.isel(attractor=k)
            x, n = one["section"].values[0], int(one["period_T"])
            label = Regime(int(one["regime"]))
            if label == Regime.at_rest:
                seeds += self.equilibrium(x) if not self.system.model.forced else self.orbits([x], self.system.strobe)
            elif label == Regime.periodic:
                seeds += self.orbits([x], n) if self.system.model.forced else self.cycles(x, n)
        if not seeds:
            raise RangeError(f"{self.place()}: none of {found.sizes['attractor']} attractors is periodic")
        return seeds

    def equations(self, periods: int, steps: int) -> PeriodicOrbits:
        """Equations of orbits of so many T; 0 of an unforced cycle."""
        free = self.free
        return PeriodicOrbits(
            self.system, free.columns, free.allowed, free.widths, self.system.orders, periods, steps,
            workers=self.execution.workers,
        )  # fmt: skip

    def orbits(self, guesses: Sequence[Array], periods: int) -> list[Seed]:
        """Distinct forced orbits that Newton's method finds from some states, with steps that hold the accuracy.

        An orbit that returns sooner than it was asked to has the smallest number of T after which it does.

        Raises
        ------
        RangeError
            A period that is no multiple of the forcing's, or a forcing that does not repeat.
        """
        system = self.system
        if not system.repeats or system.strobe != system.common_multiple:
            limit = f"{system.model.name}: the forcing has no common period of {LONGEST_COMMON} T or less"
            raise RangeError(f"{limit}: no orbit can be closed")
        repeats = repeat_of_forcing(system, np.stack(guesses, axis=1))
        if periods % repeats:
            raise RangeError(f"period: found {periods} T, expected a multiple of {repeats} T, in which the forcing repeats")
        value = np.array(self.value)
        seeds: list[Seed] = []
        for c in self._found(periods, STEPS[1::3], [Unknowns(g[None], value) for g in guesses]):
            phases = self._phases(c)
            known = [s.phases for s in seeds]
            scale = c.linear.weights[: system.model.dimension, None]
            cyclic = cyclic_states(system)
            if any((np.abs(wrapped(p - c.point.x[0][:, None], cyclic) / scale).max(axis=0) < SAME).any() for p in known):
                continue
            back = np.abs(wrapped(phases - phases[:, :1], cyclic) / scale).max(axis=0) < SAME
            sooner = [d for d in divisors(back.size) if back[::d].all()]
            shorter = self.orbits([c.point.x[0]], sooner[0] * repeats) if sooner else []
            seeds += shorter or [Seed(c, periods, phases)]
        return seeds

    def _phases(self, c: Corrected) -> Array:
        orbits = c.equations
        assert isinstance(orbits, PeriodicOrbits)
        repeats = repeat_of_forcing(self.system, c.point.x.T)
        every = repeats if orbits.periods % repeats == 0 else orbits.periods
        runs = Lanes.of([Unknowns(c.point.x[:1], c.point.free)])
        e = orbits.ensemble(runs)
        saved = e.advance(orbits.periods, save_periods=every).saved[:, :, 0]
        return np.concatenate([c.point.x[:1], saved[:-1]]).T

    def cycles(self, x: Array, returns: int) -> list[Seed]:
        """The unforced cycle that a settled run is on, from its crossings of the section."""
        begin = self.system.replace(start=dict(zip(self.system.states, map(float, x), strict=True)))
        wait = CROSSINGS
        while True:
            crossed = section(begin, transient=0, points=wait, accuracy=1e-10, execution=self.execution).isel(run=0)
            times = crossed["crossing_time"].values
            times = times[np.isfinite(times)]
            if times.size > returns or wait >= MOST_CROSSINGS:
                break
            wait *= 8
        if times.size <= returns:
            raise RangeError(f"{self.place()}: the motion crosses its section {times.size} times in {wait} typical times")
        first = crossed["section"].values[times.size - 1 - returns]
        duration = float(times[-1] - times[-1 - returns])
        guess = Unknowns(first[None], np.array(self.value), duration)
        return [self._shortest(c, returns) for c in self._found(0, [returns * s for s in STEPS[4::3]], [guess])]

    def _shortest(self, c: Corrected, returns: int) -> Seed:
        """A cycle, with the smallest number of crossings after which it returns."""
        n, duration = c.point.x.shape[1], c.point.duration
        assert duration is not None
        for d in divisors(returns):
            time = duration * d / returns
            guess = Unknowns(c.point.x[:1], c.point.free, time)
            for shorter in self._found(0, [d * s for s in STEPS[4::3]], [guess]):
                apart = wrapped(shorter.point.x[0] - c.point.x[0], cyclic_states(self.system)) / c.linear.weights[:n]
                if np.abs(apart).max() < SAME and abs((shorter.point.duration or 0.0) / time - 1) < SAME:
                    return Seed(shorter, d, shorter.point.x[:1].T)
        return Seed(c, returns, c.point.x[:1].T)

    def equilibrium(self, x: Array) -> list[Seed]:
        """The equilibrium near a state."""
        found = self._corrected(self.equilibria(x), [Unknowns(x[None], np.array(self.value))])
        return [Seed(c, 0, c.point.x.T) for c in found]

    def equilibria(self, x: Array) -> Equilibria:
        """Equations of equilibria near a state."""
        free = self.free
        sizes = np.maximum(np.abs(x), np.abs([s.start for s in self.system.model.states]))
        return Equilibria(self.system, free.columns, free.allowed, free.widths, sizes)

    def _found(self, periods: int, steps: Sequence[int], guesses: Sequence[Unknowns]) -> list[Corrected]:
        """Orbits from some guesses, with the first of these steps that find orbits which more steps hardly change.

        With too few steps a stiff machine diverges, or closes an orbit that is none of its own.
        """
        found: list[Corrected] = []
        for count in steps:
            found = self._corrected(self.equations(periods, count), guesses) or found
            if found and all((c.step_error or 0.0) < ROUNDED for c in found):
                break
        return found

    def _corrected(self, equations: Equations, guesses: Sequence[Unknowns]) -> list[Corrected]:
        """Solutions at that value, with steps and segments that hold their accuracy."""
        sizes = [linear.sizes for linear in equations.linear(guesses)]
        asks = [
            Ask(equations, g, along_parameter(g), np.where(np.isfinite(s) & (s > 0), s, 1.0))
            for g, s in zip(guesses, sizes, strict=True)
        ]
        out = []
        for c in correct(asks):
            if isinstance(c, Lost) or not self.free.allowed(c.point.free[:, None])[0]:
                continue
            if (gaps := reachable_gaps(c)) and smallest_gap(c, gaps, 0) < 0:
                continue  # behind a stop
            c, _ = finished(c, self.accuracy)  # its error stands in the Dataset
            out.append(replace(c, point=c.point.at(*self.value)))  # without the rounding of Newton's method
        return out

    def place(self) -> str:
        """The values of the free parameters, in words."""
        values = zip(self.free.varied, self.value, strict=True)
        return ", ".join(f"{v.given} = {v.shown(value):g}{' ' + v.unit if v.unit != '1' else ''}" for v, value in values)
