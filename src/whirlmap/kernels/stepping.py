"""One step of an explicit Runge-Kutta method, for the state and for tangent vectors beside it."""

from collections.abc import Callable
from dataclasses import dataclass

from whirlmap.kernels.methods import Method
from whirlmap.kernels.routine import Routine, Value, integer, number


@dataclass(frozen=True)
class Sizes:
    """Rows of a kernel's arrays.

    Attributes
    ----------
    states, outputs, inputs, tables, harmonics : int
        Of the model.
    slots : int
        Entries of the Jacobian that are computed at every state.
    scratch : int
        Rows that stay from one stage to the next.
    stages, homes : int
        Of the method, and places for their slopes.
    along : bool
        Whether the slopes of the one tangent vector are computed with those of the state.
    """

    states: int
    outputs: int
    inputs: int
    tables: int
    harmonics: int
    slots: int
    scratch: int
    stages: int
    homes: int
    along: bool

    def work(self, count: int) -> int:
        """Rows of working memory for so many tangent vectors."""
        before = self.states * (1 + self.homes) * (2 if self.along else 1) + self.slots * self.stages
        return before + self.scratch + 2 * self.harmonics + self.outputs + (1 + count) * self.states


class Stepper:
    """Writes single steps of a method into a routine.

    A single tangent vector goes through the stages side by side with the state (`Sizes.along`). Where there may be more, the
    state goes first and leaves the stages' Jacobians; each vector then goes through them with slopes of one vector's size,
    so that all stays in the first level of cache whatever the number of vectors.
    """

    def __init__(
        self, r: Routine, sizes: Sizes, method: Method, rates: Routine, tangent: Routine | None, work: Value
    ) -> None:
        self.r, self.sizes, self.method, self.rates, self.tangent = r, sizes, method, rates, tangent
        at = 0

        def take(rows: int) -> Value:
            nonlocal at
            place = r.row(work, at)
            at += rows
            return place

        self.z, self.k = take(sizes.states), take(sizes.states * sizes.homes)
        if sizes.along:
            self.z_along, self.k_along = take(sizes.states), take(sizes.states * sizes.homes)
        self.jac, self.scratch = take(sizes.slots * sizes.stages), take(sizes.scratch)
        self.c, self.o = take(2 * sizes.harmonics), take(sizes.outputs)
        self.x = take(0)

    def clear(self) -> None:
        """Forget the cells of tables: another block's lanes begin."""
        with self.r.loop(self.sizes.scratch) as i:
            self.r.store(number(0.0), self.scratch, i)

    def step(
        self, y: Value, h: Value, inputs: dict[str, Value], count: Value, at_stage: Callable[[int, Value], None]
    ) -> Value:
        """Write one step of ``h`` from ``y``; ``at_stage`` writes a stage's harmonics; returns the place of its end."""
        r, b, n = self.r, self.r.b, self.sizes.states
        c = b.bitcast(self.c, self.rates.at["c"].type)
        along = r.row(y, n)
        for stage in range(self.method.stages):
            at_stage(stage, c)
            point = self._point(stage, y, self.k, h, self.z)
            where: dict[str, Value] = {"more": self._jacobian(stage)}
            if self.sizes.along:
                direction = self._point(stage, along, self.k_along, h, self.z_along)
                where = {"v": direction, "more": r.row(self.k_along, self._home(stage))}
            r.call(self.rates, y=point, c=c, scratch=self.scratch, dy=r.row(self.k, self._home(stage)), **where, **inputs)
        self._combine(y, self.k, self.method.b, h, self.x)
        if self.sizes.along:
            self._combine(along, self.k_along, self.method.b, h, r.row(self.x, n))
        if self.tangent:
            with r.loop(count) as v:
                at = b.mul(b.add(v, integer(1)), integer(n))
                before = r.row(y, at)
                for stage in range(self.method.stages):
                    point = self._point(stage, before, self.k, h, self.z)
                    slopes = r.row(self.k, self._home(stage))
                    r.call(self.tangent, y=point, jac=self._jacobian(stage), p=inputs["p"], dy=slopes)
                self._combine(before, self.k, self.method.b, h, r.row(self.x, at))
        return self.x

    def _home(self, stage: int) -> int:
        return self.method.homes[stage] * self.sizes.states

    def _jacobian(self, stage: int) -> Value:
        return self.r.row(self.jac, stage * self.sizes.slots)

    def _point(self, stage: int, y: Value, k: Value, h: Value, z: Value) -> Value:
        weights = self.method.a[stage]
        if not any(weights):
            return y
        self._combine(y, k, weights, h, z)
        return z

    def _combine(self, y: Value, k: Value, weights: tuple, h: Value, out: Value) -> None:
        r, n = self.r, self.sizes.states
        with r.loop(n) as i:
            total = None
            for j, w in enumerate(weights):
                if w != 0:
                    term = r.mul(number(float(w)), r.load(r.row(k, self._home(j)), i))
                    total = term if total is None else r.add(total, term)
            value = r.load(y, i)
            r.store(value if total is None else r.add(value, r.mul(h, total)), out, i)
