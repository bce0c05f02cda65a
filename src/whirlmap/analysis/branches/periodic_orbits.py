"""Periodic orbits by multiple shooting: their equations, derivatives and multipliers, for many orbits in one call.

A forced orbit is a fixed point of the stroboscopic map: its phase is given, so that there is no phase condition and no
trivial multiplier. An unforced cycle begins on the declared section, and its duration is an unknown. Segments of all orbits
run side by side in lanes: one each with all tangent vectors, and two without for each free parameter, whose central
difference gives the derivative by it. That derivative only steers Newton's method and tangents: no solution depends on its
error.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import sqrt
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from sympy import diff

from whirlmap.analysis.branches.segments import Lanes, cycle
from whirlmap.analysis.branches.unknowns import Linear, Unknowns
from whirlmap.analysis.motion.ensembles import cyclic_states
from whirlmap.analysis.motion.section_crossing import surface_of
from whirlmap.analysis.periodic_orbits.newton import wrapped
from whirlmap.analysis.variational.periodic_schur import eigenvalues_of_products
from whirlmap.integrate.division import variants
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.evaluation import Evaluator
from whirlmap.integrate.scales import scales_between
from whirlmap.integrate.system import System, periods
from whirlmap.kernels.lowering.formulas import Formula, numpy_function
from whirlmap.kernels.methods import DOP853, Method
from whirlmap.kernels.running.lanes import lane_kernel
from whirlmap.results.status import Status

Array = NDArray[np.float64]

#: Difference of a free parameter on either side, over its size, by which the derivative is taken.
DIFFERENCE = 1e-6
#: Largest norm of a segment's matrix, in sizes of the states: beyond, an orbit takes more segments.
LONGEST = 1e4


@dataclass(frozen=True)
class PeriodicOrbits:
    """Orbits of one kind: a system, its free parameters, and a return.

    Attributes
    ----------
    system : System
    columns : callable
        ``columns(free)``: values of all parameters, shape (parameter, point), at free parameters, (free, point).
    allowed : callable
        ``allowed(free)``: which points the model takes, shape (point,).
    widths : array, shape (free,)
        Sizes of the free parameters.
    orders : tuple of Fraction
        Of the harmonics over the fastest.
    periods : int
        T of one return of a forced orbit; 0 of an unforced cycle.
    steps : int
        Steps per T, or in one return of a cycle.
    method : Method
    workers : int, optional
    floor : array, shape (state,), optional
        Least sizes of the states: a branch passes through an orbit at which one of them vanishes.
    """

    system: System
    columns: Callable[[Array], Array]
    allowed: Callable[[Array], NDArray[np.bool_]]
    widths: Array
    orders: tuple[Fraction, ...]
    periods: int
    steps: int
    method: Method = DOP853
    workers: int | None = None
    floor: Array | None = None

    @property
    def key(self) -> tuple[Any, ...]:
        """What tells equations whose points may be computed together from others."""
        least = b"" if self.floor is None else self.floor.tobytes()
        return self.columns, self.system.model, self.periods, self.steps, self.method.name, least

    @property
    def steps_of_return(self) -> int:
        """Steps in one return."""
        return self.steps * max(self.periods, 1)

    @cached_property
    def cyclic(self) -> dict[int, float]:
        """Periods of the states that are angles."""
        return cyclic_states(self.system)

    def linear(self, points: Sequence[Unknowns], before: Sequence[Linear | None] = ()) -> list[Linear]:
        """Equations and derivatives of many orbits, each with its own number of segments; see `Equations`."""
        runs = Lanes.of(points)
        e = self.ensemble(runs, tangents=self.system.model.dimension)
        extremes = self.extremes(e, runs)
        ends = e.x.copy()
        by_free, by_time = self._by_free(points, runs, ends, before), self._by_time(runs, ends)
        out = []
        for k, point in enumerate(points):
            mine = np.flatnonzero(runs.orbit == k)
            failed = np.flatnonzero(e.status[mine] != Status.ok)
            status = Status(int(e.status[mine[failed[0]]])) if failed.size else Status.ok
            matrices = e.vectors[:, :, mine].transpose(2, 1, 0)
            low, high = extremes["minimum"][:, mine].min(axis=1), extremes["maximum"][:, mine].max(axis=1)
            sizes = scales_between(self.system.model, e.period[mine[:1]], low[:, None], high[:, None])[:, 0]
            sizes = sizes if self.floor is None else np.maximum(sizes, self.floor)
            out.append(
                self._linear(point, ends[:, mine].T, matrices, by_free[k], by_time[:, mine], sizes, status)
            )
        return out

    def _linear(
        self, point: Unknowns, ends: Array, matrices: Array, by_free: Array, by_time: Array, sizes: Array, status: Status
    ) -> Linear:
        """One orbit: segment after segment, the section of a cycle, and the columns of duration and free parameters."""
        count, n = point.x.shape
        states, timed = count * n, point.duration is not None
        rows, width = states + timed, states + timed + point.free.size
        residual, jacobian = np.zeros(rows), np.zeros((rows, width))
        residual[:states] = self.wrapped(ends - np.roll(point.x, -1, axis=0)).ravel()
        cycle(jacobian, matrices, -1.0)
        jacobian[:states, states + timed :] = by_free
        weights = np.tile(sizes, count)
        every = np.concatenate([weights * sqrt(states), [point.duration] if timed else [], self.widths])
        if timed:
            height, slope, moved = self._section(point)
            jacobian[:states, states] = by_time.T.ravel() / count
            residual[states], jacobian[states, :n], jacobian[states, states + 1 :] = height, slope, moved
            weights = np.append(weights, max(float(np.abs(slope * sizes).max()), np.finfo(float).tiny))
        if status != Status.ok:
            residual[:], jacobian[:] = np.nan, np.nan
        return Linear(residual, jacobian, every, weights, matrices * (sizes / sizes[:, None]), status)

    def wrapped(self, difference: Array) -> Array:
        """Differences (segment, state), of angles modulo their period."""
        return wrapped(difference, self.cyclic, axis=1) if self.cyclic else difference

    def ensemble(
        self, runs: Lanes, *, tangents: int = 0, free: Array | None = None, finer: int = 1
    ) -> Ensemble:
        """Lanes ready to run their segments, with so many tangent vectors; other free parameters, or ``finer`` steps."""
        model, values = self.system.model, self.columns(runs.free if free is None else free)
        forced = self.periods > 0
        # A cycle begins where a state is zero to rounding: that tells nothing of the size at which it has diverged.
        bound = np.inf if model.bound is None else model.bound
        beyond = np.where([[s.cyclic is not None] for s in model.states], np.inf, np.full(runs.x.shape, bound))
        steps = finer * (np.full(runs.share.size, self.steps) if forced else self.steps // runs.share)
        return Ensemble(
            model, values, runs.x, orders=self.orders, steps=steps, method=self.method,
            tangents=tangents, orthonormal=False, workers=self.workers, beyond=beyond,
            turn=None if forced else runs.time,
            ahead=finer * self.steps_of_return // runs.share * runs.place if forced else None,
        )  # fmt: skip

    def run(self, e: Ensemble, runs: Lanes, *, save: bool = False) -> Array:
        """Run every segment to its end; where asked, states after every step, (step, state, lane)."""
        if not self.periods:
            return e.advance(1, save_periods=Fraction(1, e.steps) if save else 0).saved
        steps = e.steps * self.periods // int(runs.share[0])
        saved = e.advance(self.periods, parts=runs.share, save_periods=Fraction(1, e.steps) if save else 0).saved
        return saved[:steps]

    def extremes(self, e: Ensemble, runs: Lanes, *, between: bool = False) -> dict[str, Array]:
        """Run every segment to its end; extremes of states and outputs at the steps, or ``between`` them too."""
        more: Literal[True, "between"] = "between" if between else True
        segment = e.advance(self.periods or 1, parts=runs.share if self.periods else 1, extremes=more)
        assert segment.extremes is not None
        return segment.extremes

    @cached_property
    def has_surfaces(self) -> bool:
        """Whether the rates have kinks or jumps."""
        kernel = lane_kernel(self.system.plain_model(), self.method, slopes="none", kind="locked")
        return kernel.source.sizes.surfaces > 0

    def _by_free(
        self, points: Sequence[Unknowns], runs: Lanes, ends: Array, before: Sequence[Linear | None]
    ) -> list[Array]:
        """Derivatives of the ends of each orbit by the free parameters, shape (segment and state, free)."""
        count = self.widths.size
        known = [b if b is not None and b.status == Status.ok else None for b in before]
        if known and all(b is not None for b in known):
            return [b.jacobian[: p.x.size, -count:] for b, p in zip(known, points, strict=True) if b is not None]
        found = self._differences(runs, ends).transpose(2, 1, 0)
        return [found[runs.orbit == k].reshape(p.x.size, count) for k, p in enumerate(points)]

    def _differences(self, runs: Lanes, base: Array) -> Array:
        """Central differences of the ends by the free parameters, shape (free, state, lane); NaN where there is none.

        A side on which a segment does not reach its end, at contact, gives way to the segment itself.
        """
        count, both = self.widths.size, self._moved(runs.free)
        many = runs.repeated(2 * count)
        e = self.ensemble(many, free=both.transpose(2, 0, 1, 3).reshape(count, -1))
        self.run(e, many)
        ends = e.x.reshape(-1, count, 2, runs.share.size)
        there = e.running.reshape(count, 2, runs.share.size)
        ends = np.where(there, ends, base[:, None, None])
        at = np.stack([np.where(there[k], both[k, :, k], runs.free[k]) for k in range(count)])
        with np.errstate(invalid="ignore", over="ignore"):  # Newton's method refuses what is not finite
            return np.asarray((ends[:, :, 0] - ends[:, :, 1]).transpose(1, 0, 2) / (at[:, 0] - at[:, 1])[:, None, :])

    def _moved(self, free: Array) -> Array:
        """Free parameters (free, lane) with each of them moved to either side, as far as the model takes it.

        Shape (moved, side, free, lane).
        """
        sizes = np.maximum(np.abs(free), self.widths[:, None]) * DIFFERENCE
        both = np.empty((len(free), 2, *free.shape))
        for k in range(len(free)):
            for side, sign in enumerate((1, -1)):
                moved = free.copy()
                moved[k] += sign * sizes[k]
                inside = self.allowed(moved)
                moved[k, ~inside] = free[k, ~inside]
                both[k, side] = moved
        return both

    def _by_time(self, runs: Lanes, ends: Array) -> Array:
        """Rates at the ends of the segments of cycles, shape (state, lane)."""
        if self.periods:
            return np.zeros_like(ends)
        return self.rates(ends, self.columns(runs.free))

    def rates(self, x: Array, values: Array) -> Array:
        """Rates of unforced systems at some states (state, point)."""
        out = np.empty_like(x)
        for form, at in variants(self.system.model, values):
            out[:, at] = Evaluator.of(form, values[:, at], jacobian=False).rates(0.0, x[:, at], np.arange(at.size))
        return out

    def _section(self, point: Unknowns) -> tuple[float, Array, Array]:
        """Height of a cycle's first state over the section, its gradient, and its derivatives by the free parameters."""
        model, x = self.system.model, point.x[0]
        values = self.columns(point.free[:, None])[:, 0]
        place = model.section
        assert place is not None
        gradient = numpy_function(
            model, "gradient of the section",
            lambda: Formula([model.states, model.parameters], [diff(place.surface, s) for s in model.states]),
        )  # fmt: skip
        sign = 1.0 if place.direction == "rising" else -1.0
        slope = sign * np.array([float(g) for g in gradient(list(x), list(values))])
        # Moved parameters lie on either side, one after the other: shape (free, side, free).
        moved = self._moved(point.free[:, None])[..., 0]
        heights = [[float(surface_of(model)(x, self.columns(f[:, None])[:, 0])) for f in pair] for pair in moved]
        apart = [pair[0][k] - pair[1][k] for k, pair in enumerate(moved)]
        return float(surface_of(model)(x, values)), slope, np.array([a - b for a, b in heights]) / apart

    def exponents(self, linear: Linear) -> tuple[Array, Array]:
        """Multipliers of one orbit: logarithms of moduli, largest first, and arguments, without that of a cycle's time.

        Those near the unit circle are good to rounding; small ones may drown in it (`sweep.branches.measured_branches`).
        """
        matrices = linear.matrices
        if not np.isfinite(matrices).all():
            return np.full(matrices.shape[1], np.nan), np.full(matrices.shape[1], np.nan)
        if not self.periods:
            matrices = self.across(linear)
        product = np.linalg.multi_dot([*matrices[::-1], np.eye(matrices.shape[1])])
        if np.linalg.norm(product) <= LONGEST:
            values = np.linalg.eigvals(product)
            with np.errstate(divide="ignore"):
                logs, angles = np.log(np.abs(values)), np.angle(values)
            order = np.lexsort((-angles, -logs))
            logs, angles = logs[order], angles[order]
        else:
            (logs,), (angles,) = eigenvalues_of_products(matrices[None])
        return (logs, angles) if self.periods else (logs[:-1], angles[:-1])

    def across(self, linear: Linear) -> Array:
        """Matrices of a cycle's segments, the last followed by the projection along the flow onto the section.

        What is left of the time direction is a multiplier of zero, the smallest of all.
        """
        count, n, _ = linear.matrices.shape
        states = count * n
        sizes = linear.weights[:n]
        flow = linear.jacobian[states - n : states, states] * count / sizes
        slope = linear.jacobian[states, :n] * sizes
        return np.concatenate(
            [linear.matrices[:-1], (np.eye(n) - np.outer(flow, slope) / (slope @ flow))[None] @ linear.matrices[-1:]]
        )

    def durations(self, points: Sequence[Unknowns]) -> Array:
        """Time of one return of each orbit."""
        if not self.periods:
            return np.array([p.duration for p in points], dtype=float)
        return self.periods * periods(self.system.model, self.columns(np.stack([p.free for p in points], axis=1)))
