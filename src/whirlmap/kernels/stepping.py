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
    stages : int
        Of the method.
    """

    states: int
    outputs: int
    inputs: int
    tables: int
    harmonics: int
    slots: int
    scratch: int
    stages: int

    def work(self, count: int) -> int:
        """Rows of working memory for so many tangent vectors."""
        return self.vectors + (1 + count) * self.states * (1 + self.stages)

    @property
    def vectors(self) -> int:
        """Rows of working memory before those of the vectors: stage point, Jacobian, scratch, harmonics, outputs."""
        return self.states + self.slots + self.scratch + 2 * self.harmonics + self.outputs


class Stepper:
    """Writes single steps of a method into a routine; the state and the tangent vectors go through a stage together.

    A stage's Jacobian is used where it was computed and then forgotten, so that what the vectors need of it is still in the
    first level of cache.
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

        self.z, self.jac, self.scratch = take(sizes.states), take(sizes.slots), take(sizes.scratch)
        self.c, self.o = take(2 * sizes.harmonics), take(sizes.outputs)
        self.vectors = take(0)

    def parts(self, count: Value) -> tuple[Value, Value]:
        """Places of the end of a step and of the slopes, for the state and so many tangent vectors."""
        r, n = self.r, self.sizes.states
        rows = r.b.mul(r.b.add(count, integer(1)), integer(n))
        return self.vectors, r.row(self.vectors, rows)

    def clear(self) -> None:
        """Forget the cells of tables: another block's lanes begin."""
        with self.r.loop(self.sizes.scratch) as i:
            self.r.store(number(0.0), self.scratch, i)

    def step(
        self, y: Value, h: Value, inputs: dict[str, Value], count: Value, at_stage: Callable[[int, Value], None]
    ) -> Value:
        """Write one step of ``h`` from ``y``; ``at_stage`` writes a stage's harmonics; returns the place of its end."""
        r, n, stages = self.r, self.sizes.states, self.method.stages
        x, k = self.parts(count)
        c = r.b.bitcast(self.c, self.rates.at["c"].type)
        for stage in range(stages):
            at_stage(stage, c)
            point = self._point(stage, y, k, h)
            r.call(self.rates, y=point, c=c, scratch=self.scratch, dy=r.row(k, stage * n), jac=self.jac, **inputs)
            if self.tangent:
                with r.loop(count) as v:
                    before, slopes = self._vector(v, y, k)
                    point = self._point(stage, before, slopes, h)
                    r.call(self.tangent, y=point, jac=self.jac, p=inputs["p"], dy=r.row(slopes, stage * n))
        self._combine(y, k, self.method.b, h, x)
        if self.tangent:
            with r.loop(count) as v:
                before, slopes = self._vector(v, y, k)
                end = r.row(x, r.b.mul(r.b.add(v, integer(1)), integer(n)))
                self._combine(before, slopes, self.method.b, h, end)
        return x

    def _vector(self, v: Value, y: Value, k: Value) -> tuple[Value, Value]:
        b, n = self.r.b, self.sizes.states
        number_of = b.add(v, integer(1))
        return (
            self.r.row(y, b.mul(number_of, integer(n))),
            self.r.row(k, b.mul(number_of, integer(n * self.method.stages))),
        )

    def _point(self, stage: int, y: Value, k: Value, h: Value) -> Value:
        weights = self.method.a[stage]
        if not any(weights):
            return y
        self._combine(y, k, weights, h, self.z)
        return self.z

    def _combine(self, y: Value, k: Value, weights: tuple, h: Value, out: Value) -> None:
        r, n = self.r, self.sizes.states
        with r.loop(n) as i:
            total = None
            for j, w in enumerate(weights):
                if w != 0:
                    slope = r.load(r.row(k, j * n), i)
                    term = r.mul(number(float(w)), slope)
                    total = term if total is None else r.add(total, term)
            value = r.load(y, i)
            r.store(value if total is None else r.add(value, r.mul(h, total)), out, i)

