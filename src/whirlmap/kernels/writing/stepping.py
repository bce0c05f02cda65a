"""One step of an explicit Runge-Kutta method, for the state and for tangent vectors beside it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple

from whirlmap.kernels.methods import Method
from whirlmap.kernels.writing.routine import INTS, Routine, Value, integer, integers, number


class Run(NamedTuple):
    """Consecutive states that are integrals of others: positions, and their velocities in the same order."""

    position: int
    velocity: int
    rows: int


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
    stages, slope_slots : int
        Stages of the method, and storage slots for their derivatives.
    along : bool
        Whether the slopes of the one tangent vector are computed with those of the state.
    runs : tuple of Run
        Positions whose rows of a tangent vector follow from its velocities' slopes; none where there are no vectors.
    surfaces : int
        Surfaces at which the rates have a kink or a jump; the side of each is a row behind the tangent vectors.
    """

    states: int
    outputs: int
    inputs: int
    tables: int
    harmonics: int
    slots: int
    scratch: int
    stages: int
    slope_slots: int
    along: bool
    runs: tuple[Run, ...]
    surfaces: int

    @property
    def others(self) -> list[range]:
        """Maximal ranges of states that are neither positions nor velocities of a `Run`."""
        taken = {row + i for run in self.runs for row in (run.position, run.velocity) for i in range(run.rows)}
        edges = [i for i in range(self.states + 1) if (i in taken or i == self.states) != (i - 1 in taken or i == 0)]
        return [range(*pair) for pair in zip(edges[::2], edges[1::2], strict=True)]

    def rows(self, b: Any, count: Value) -> Value:
        """Rows of ``y``, with so many tangent vectors."""
        return b.add(b.mul(b.add(count, integer(1)), integer(self.states)), integer(self.surfaces))

    @property
    def work(self) -> int:
        """Rows of working memory."""
        tracks = self.states * (3 + self.slope_slots) * (2 if self.along else 1)
        return tracks + self.slots * self.stages + self.scratch + 2 * self.harmonics + self.outputs


class Track(NamedTuple):
    """Working arrays of the state or a tangent vector: its value at the stage, part of the next one, stage derivatives."""

    z: Value
    ahead: Value
    k: Value


class Stepper:
    """Writes single steps of a method into a routine.

    A single tangent vector is advanced together with the state (`Sizes.along`). With more vectors, the state is advanced
    first and stores the Jacobian of each stage; each vector is then advanced with these, in place and with stage derivatives
    of one vector's size, so that the working set stays in the first level of cache whatever the number of vectors.

    The positions of a tangent vector need no stage derivatives of their own: those are its velocities at the stages, which
    are sums of the velocities' stage derivatives. So these are read once and serve both, and those of the positions are
    never written (Nystroem).

    Combining stage derivatives is bound by loads as much as by products. So those that two successive stages share are read
    once: with each odd stage the next one is written too, but for the term whose derivative is not known yet.
    """

    def __init__(
        self, r: Routine, sizes: Sizes, method: Method, rates: Routine, tangent: Routine | None, work: Value,
        same_side: Routine | None = None,
    ) -> None:  # fmt: skip
        self.r, self.sizes, self.method, self.rates, self.tangent = r, sizes, method, rates, tangent
        self.slope_slots, self.same_side = method.slope_slots(nystroem=bool(sizes.runs)), same_side
        self.side = r.local(INTS) if same_side else None
        at = 0

        def take(rows: int) -> Value:
            nonlocal at
            place = r.row(work, at)
            at += rows
            return place

        def track() -> Track:
            return Track(take(sizes.states), take(sizes.states), take(sizes.states * sizes.slope_slots))

        self.track = track()
        if sizes.along:
            self.track_along = track()
        self.jac, self.scratch = take(sizes.slots * sizes.stages), take(sizes.scratch)
        self.c, self.o = take(2 * sizes.harmonics), take(sizes.outputs)
        self.x = take(sizes.states * (2 if sizes.along else 1))

    def clear(self) -> None:
        """Forget the cells of tables, before the lanes of another block."""
        with self.r.loop(self.sizes.scratch) as i:
            self.r.store(number(0.0), self.scratch, i)

    def step(
        self, y: Value, h: Value, inputs: dict[str, Value], at_stage: Callable[[int], Value],
        first: Value | None = None,
    ) -> Value:  # fmt: skip
        """Write one step of ``h`` from ``y``; ``at_stage`` gives a stage's harmonics; returns the place of its end.

        That is the end of the state, and of the one tangent vector that goes with it. The rates at ``y`` are kept in
        ``first``, where it is given.
        """
        r, n = self.r, self.sizes.states
        if self.same_side:
            r.store(integers(-1), self.side)
        along, end = r.row(y, n), self.method.stages
        for stage in range(end):
            c = at_stage(stage)
            point = self._place(stage, y, self.track, h)
            if stage:
                self._stay(y, point, inputs["p"])
            where: dict[str, Value] = {"more": self._jacobian(stage)}
            if self.sizes.along:
                direction = self._place_along(stage, along, self.track_along, h)
                where = {"v": direction, "more": self._slopes(self.track_along, stage)}
            slopes = self._slopes(self.track, stage)
            r.call(self.rates, y=point, c=c, scratch=self.scratch, dy=slopes, **where, **inputs)
            if stage == 0 and first is not None:
                self.replace(first, slopes, n, None)
        self._place(end, y, self.track, h, self.x)
        self._stay(y, self.x, inputs["p"])
        if self.sizes.along:
            self._place_along(end, along, self.track_along, h, r.row(self.x, n))
        return self.x

    def within(self, good: Value) -> None:
        """Clear the flag of every lane whose last step crossed a pole, in a stage or at its end."""
        if self.same_side:
            self.r.store(self.r.b.and_(self.r.load(good), self.r.load(self.side)), good)

    def _stay(self, y: Value, place: Value, p: Value) -> None:
        if self.same_side:
            self.r.call(self.same_side, before=y, y=place, p=p, good=self.side)

    def vectors(self, y: Value, h: Value, p: Value, count: Value, runs: Value | None = None) -> None:
        """Advance the tangent vectors behind ``y`` over the last step, in place, in the lanes of ``runs`` (absent: all)."""
        r, n = self.r, self.sizes.states
        if self.tangent is None:
            return
        with r.loop(count) as v:
            vector = r.row(y, r.b.mul(r.b.add(v, integer(1)), integer(n)))
            for stage in range(self.method.stages):
                point, slopes = self._place_along(stage, vector, self.track, h), self._slopes(self.track, stage)
                r.call(self.tangent, y=point, jac=self._jacobian(stage), p=p, dy=slopes)
            end = self._place_along(self.method.stages, vector, self.track, h)
            self.replace(vector, end, n, runs)

    def replace(self, old: Value, new: Value, rows: int, runs: Value | None) -> None:
        """Replace old rows by new ones, in the lanes of ``runs`` (absent: all)."""
        r = self.r
        with r.loop(rows) as i:
            value = r.load(new, i)
            r.store(value if runs is None else r.b.select(runs, value, r.load(old, i)), old, i)

    def _slopes(self, track: Track, stage: int) -> Value:
        return self.r.row(track.k, self.slope_slots[stage] * self.sizes.states)

    def _jacobian(self, stage: int) -> Value:
        return self.r.row(self.jac, stage * self.sizes.slots)

    def _place(self, stage: int, y: Value, track: Track, h: Value, out: Value | None = None) -> Value:
        """Write the state at a stage, or at the step's end behind the last one, to ``out`` (absent: the track's own row)."""
        out = track.z if out is None else out
        if stage == 0:
            return y
        self._combine(stage, y, track, h, out, range(self.sizes.states))
        return out

    def _place_along(self, stage: int, vector: Value, track: Track, h: Value, out: Value | None = None) -> Value:
        """Write the tangent vector at a stage, as `_place` does for the state."""
        out = track.z if out is None else out
        if stage == 0:
            return vector
        for rows in self.sizes.others:
            self._combine(stage, vector, track, h, out, rows)
        for run in self.sizes.runs:
            self._integrate(stage, vector, track, h, out, run)
        return out

    def _combine(self, stage: int, y: Value, track: Track, h: Value, out: Value, rows: range) -> None:
        """Write ``y + h (weighted slopes)`` in some rows; with an odd stage, a part of the next one too."""
        r, tables = self.r, (*self.method.a, self.method.b)
        sums = [(tables[stage], out)]
        if stage % 2 == 0:
            y, sums = track.ahead, [((0,) * (stage - 1) + tables[stage][stage - 1 :], out)]
        elif stage + 1 < len(tables):
            sums.append((tables[stage + 1][:stage], track.ahead))
        scaled = [(self._scaled(h, weights), out) for weights, out in sums]
        used = sorted({j for weights, _ in scaled for j in weights})

        def write(rows: Sequence[Value]) -> None:
            totals = {(i, s): r.load(y, row) for i, row in enumerate(rows) for s in range(len(scaled))}
            for j in used:
                for i, row in enumerate(rows):
                    slope = r.load(self._slopes(track, j), row)
                    for s, (weights, _) in enumerate(scaled):
                        if j in weights:
                            totals[i, s] = r.increased(totals[i, s], weights[j], slope)
            for (i, s), total in totals.items():
                r.store(total, scaled[s][1], rows[i])

        self._by_two(rows, write)

    def _integrate(self, stage: int, y: Value, track: Track, h: Value, out: Value, run: Run) -> None:
        """Write the velocities of a run, and its positions as integrals of them."""
        r, weights = self.r, (*self.method.a, self.method.b)[stage]
        once, nystroem = self._scaled(h, weights), self._scaled(r.mul(h, h), self.method.nystroem[stage])
        time = r.mul(h, number(float(sum(weights))))

        def write(rows: Sequence[Value]) -> None:
            places = [(row, r.b.add(row, integer(run.position - run.velocity))) for row in rows]
            totals = []
            for velocity, position in places:
                begin = r.load(y, velocity)
                totals.append([begin, r.increased(r.load(y, position), time, begin)])
            for j in sorted({*once, *nystroem}):
                for total, row in zip(totals, rows, strict=True):
                    slope = r.load(self._slopes(track, j), row)
                    for i, part in enumerate((once, nystroem)):
                        if j in part:
                            total[i] = r.increased(total[i], part[j], slope)
            for total, place in zip(totals, places, strict=True):
                for value, row in zip(total, place, strict=True):
                    r.store(value, out, row)

        self._by_two(range(run.velocity, run.velocity + run.rows), write)

    def _scaled(self, factor: Value, weights: Sequence[float | Fraction]) -> dict[int, Value]:
        """Weights other than zero times a factor, by the stage."""
        return {j: self.r.mul(factor, number(float(w))) for j, w in enumerate(weights) if w != 0}

    def _by_two(self, rows: range, write: Callable[[Sequence[Value]], None]) -> None:
        """Write something for rows, two at a time: that hides the latency of loads."""
        r = self.r
        with r.loop(len(rows) // 2) as pair:
            first = r.b.add(r.b.mul(pair, integer(2)), integer(rows.start))
            write([first, r.b.add(first, integer(1))])
        if len(rows) % 2:
            write([integer(rows[-1])])
