"""Event location: one step through discontinuity surfaces, with every crossing located inside the step.

A step is taken with the sides of all surfaces held constant, so that its rates are smooth. Where it ends behind a surface,
the crossing is located in between: first guess by inverse cubic Hermite interpolation of the surface, then Newton's method
with bisection as its safeguard. Each iteration is a step of the method from the same start, so that the state at the
crossing is as accurate as any other. The side is changed there, and the rest of the step is taken from there.

Where the rates jump, tangent vectors are multiplied by the saltation matrix (Aizerman and Gantmakher 1958). Where they point
at the surface from both sides the motion slides on it: its rates are the mean of both sides that stays on the surface
(Filippov 1988), until one side pulls away; a single tangent vector slides with it, where the surface's gradient is constant.
A lane that slides on two surfaces at once, or with other tangent vectors, ends with `STICKS`; one that needs more than
`MOST` crossings in a step ends with `CHATTERS`.

A short contact begins and ends within one step, or at the phase at which all runs begin. Steps of any number per T would
take it in one piece, with one and the same error, which no comparison of steps could see. So what a step takes before,
behind and between crossings is divided into ``pieces``, whose number differs between neighbouring rungs of the ladder.

Between its ends a step may dip behind a surface and come back. Where the cubic through values and rates of the surface comes
near to zero, the step is cut at its lowest point, which then is a common end of a step.

Lanes that have finished the step wait for those that still locate a crossing: that costs time and changes no bit.
"""

import numpy as np
from llvmlite import ir
from numpy.typing import NDArray

from whirlmap.kernels.methods import Method
from whirlmap.kernels.writing.hermite import hermite, lowest_point
from whirlmap.kernels.writing.routine import INTS, LANE, Kind, Routine, Value, integer, integers, number
from whirlmap.kernels.writing.saltation import CHATTERS, LIMITS, MOST, Surfaces, SurfaceStep
from whirlmap.kernels.writing.stepping import Sizes

#: Iterations of event location for each of the most crossings of a step (`saltation.MOST`).
TRIALS = 8
#: Pieces beside a crossing by the odd part of the number of steps per T; else, and without such a number, `PIECES`.
BY_STEPS, PIECES = {1: 2, 3: 1, 5: 3}, 2
#: Part of the step to which a crossing is located.
LOCATED = 1e-13
#: Pieces where a contact must be seen in itself: extremes between steps, multipliers.
FINE = 8
#: Part of the step below which nothing is divided.
SHORT = 1e-9
#: A dip to below this part of the larger of the surface's values at both ends is checked, at most so many times in a step.
NEAR, DIPS = 0.05, 2

THROUGH: dict[str, Kind] = {
    "count": "int", "y": "rows", "h": "rows", "c": "rows", "turn": "rows", "p": "rows", "tables": "doubles",
    "offsets": "flags", "active": "flags", "cause": "flags", "reached": "rows", "tally": "rows", "folded": "int",
    "sums": "rows", "pieces": "flags", "work": "rows",
}  # fmt: skip


def pieces(steps: NDArray[np.int64]) -> NDArray[np.int64]:
    """Number of pieces for so many steps per T: another one for each two neighbours of 6, 8, 10, 12, 16, 20, 24, 32, ..."""
    out, odd = np.full_like(steps, PIECES), steps // (steps & -steps)
    for part, count in BY_STEPS.items():
        out[odd == part] = count
    return out


def through(module: ir.Module, sizes: Sizes, method: Method, surfaces: Surfaces) -> Routine:
    """Write ``through``: one step of ``h`` in the lanes of ``active``, in place.

    Arguments, rows of `LANES` numbers:

    ==============  =====================================================================================
    count, y        number of tangent vectors; state, tangent vectors and sides (`Sizes.rows`)
    h, c, turn      step; cosine and sine of each harmonic at its begin; angle of each harmonic in the step
    cause           out: 0 where the step was taken, else why the lane was lost
    reached         out: part of the step that was taken; ``y`` stands there
    tally           counts of crossings, and of grazing ones, in place
    folded, sums    2: extremes between the ends of all parts of the step go to ``sums`` (`advancing.advance`)
    pieces          (1) number of pieces into which what lies beside a crossing is divided
    ==============  =====================================================================================
    """
    r = Routine(module, "through", THROUGH)
    _Locator(r, sizes, method, surfaces).write()
    r.done()
    return r


class _Locator(SurfaceStep):
    """Writes the routine; methods are its parts."""

    def write(self) -> None:
        """Write the whole routine."""
        r, b, a = self.r, self.r.b, self.r.at
        for place, value in (
            (self.done, 0.0), (self.to, 1.0), (self.crossed, 0.0), (self.dips, 0.0), (self.low, 0.0), (self.high, 1.0),
            (self.at_low, 0.0), (self.at_high, 0.0), (self.clock, 1.0), (self.pull, 1.0), (r.row(self.pull, 1), 1.0),
            (self.most, 1.0),
        ):  # fmt: skip
            r.store(number(value), place)
        r.store(integers(-1), self.fresh)
        r.store(integers(0), a["cause"])
        r.store(integers(0), self.seeking)
        r.store(r.load(a["active"]), self.pending)
        self._first_sides()

        def going(_: Value) -> Value:
            return r.any(b.icmp_signed("!=", r.load(self.pending), integers(0)))

        with r.loop(MOST * TRIALS, going=going) as trial:
            self._trial(trial)
        left = b.icmp_signed("!=", r.load(self.pending), integers(0))
        r.store(b.select(left, integers(CHATTERS), r.load(a["cause"])), a["cause"])
        r.store(r.load(self.done), a["reached"])

    # --- parts -------------------------------------------------------------------------------------------------

    def _trial(self, trial: Value) -> None:
        """Write one iteration: a step of every pending lane to its estimated crossing or to the end, and its evaluation."""
        r, b, a = self.r, self.r.b, self.r.at
        done, to = r.load(self.done), r.load(self.to)
        h = r.mul(r.load(a["h"]), r.sub(to, done))
        r.store(h, self.span)

        def at_stage(stage: int) -> Value:
            self._at(r.add(done, r.mul(number(float(self.method.c[stage])), r.sub(to, done))), self.stepper.c)
            return self.stepper.c

        x = self.stepper.step(a["y"], h, self.inputs, at_stage, first=self.f0)
        r.call(self.of.examine, y=x, p=a["p"], good=self.flag)
        self.stepper.within(self.flag)
        self._at(done, self.c0)
        guarded = {"p": a["p"], "modes": self.modes, "clock": self.clock}
        r.call(self.of.guards, y=a["y"], c=self.c0, v=self.f0, g=self.g0, rate=self.d0, **guarded)
        self._at(to, self.c1)
        self._moves(x, self.c1, self.f1)
        r.call(self.of.guards, y=x, c=self.c1, v=self.f1, g=self.g1, rate=self.d1, **guarded)
        with b.if_then(b.icmp_signed("==", trial, integer(0))):  # of all lanes, over the whole step
            for k in range(self.sizes.surfaces):
                r.store(r.absolute(r.sub(r.load(self.d1, k), r.load(self.d0, k))), self.change, k)
        pending = b.icmp_signed("!=", r.load(self.pending), integers(0))
        good = b.icmp_signed("!=", r.load(self.flag), integers(0))
        lost = b.and_(pending, b.not_(good))
        r.store(b.select(lost, integers(LIMITS), r.load(a["cause"])), a["cause"])
        alive = b.and_(pending, good)
        value, slope, which, before, slope_before = self._nearest()
        hit = b.and_(alive, r.less(value, number(0.0)))
        seeking = b.icmp_signed("!=", r.load(self.seeking), integers(0))
        sought = b.and_(alive, b.or_(seeking, hit))
        found = self._narrow(sought, hit, seeking, trial, value, slope, before, slope_before, h)
        parted = self._part(found, done, to)
        found = b.and_(found, b.not_(parted))
        dips = self._dip(b.and_(alive, b.not_(sought)), done, to, h)
        plain = b.and_(alive, b.not_(b.or_(sought, dips)))
        taken = b.or_(plain, found)
        with b.if_then(r.any(taken)):
            if any(self.jumps):
                self._return(x)
            self._take(x, taken, h)
            r.store(b.select(taken, to, r.load(self.done)), self.done)
            rest = r.div(r.sub(number(1.0), to), self._pieces())
            r.store(b.select(found, rest, r.load(self.most)), self.most)
            r.store(b.select(found, integers(-1), b.select(taken, integers(0), r.load(self.fresh))), self.fresh)
            further = r.add(to, r.load(self.most))
            further = b.select(r.less(further, number(1.0 - LOCATED)), further, number(1.0))
            r.store(b.select(taken, further, r.load(self.to)), self.to)
            ended = b.and_(taken, b.not_(r.less(to, number(1.0))))
            left = b.and_(pending, b.not_(b.or_(ended, lost)))
            r.store(b.sext(left, INTS), self.pending)
            with b.if_then(r.any(found), likely=False):
                self._cross(found, which, slope)
        with b.if_then(r.any(lost), likely=False):
            left = b.and_(b.icmp_signed("!=", r.load(self.pending), integers(0)), b.not_(lost))
            r.store(b.sext(left, INTS), self.pending)

    def _nearest(self) -> tuple[Value, Value, Value, Value, Value]:
        """The lowest guard at the end of the step: its value, rate, index, and value and rate at the begin.

        A guard is the surface's value times its side, or while a lane slides how strongly the weaker side holds it, which
        has no rate. A surface that a slide stays on is not crossed: which side of it rounding shows means nothing.
        """
        r, b = self.r, self.r.b
        lowest, slope, before, slope_before = number(float("inf")), number(0.0), number(0.0), number(0.0)
        which = integers(-1)
        for k in range(self.sizes.surfaces):
            m = r.load(self.modes, k)
            value, rate, first, first_rate = (
                r.mul(m, r.load(rows, k)) for rows in (self.g1, self.d1, self.g0, self.d0)
            )
            if self.jumps[k]:
                one, other = r.load(self.pull), r.load(self.pull, 1)
                held = b.select(r.less(one, other), one, other)
                value = b.select(self._slides(k), held, value)
            for j, stays in enumerate(self.of.holds):
                if self.jumps[j] and k in stays:
                    value = b.select(self._slides(j), number(float("inf")), value)
            less = r.less(value, lowest)
            lowest, slope = b.select(less, value, lowest), b.select(less, rate, slope)
            before, slope_before = b.select(less, first, before), b.select(less, first_rate, slope_before)
            which = b.select(less, integers(k), which)
        return lowest, slope, which, before, slope_before

    def _narrow(
        self, sought: Value, hit: Value, seeking: Value, trial: Value, value: Value, slope: Value, before: Value,
        slope_before: Value, h: Value,
    ) -> Value:  # fmt: skip
        """Narrow the bracket of lanes that seek a crossing, and set their next iterate; returns those that converged."""
        r, b = self.r, self.r.b
        done, to = r.load(self.done), r.load(self.to)
        whole = r.load(self.r.at["h"])
        new = b.and_(hit, b.not_(seeking))
        zero = number(0.0)
        low, high = b.select(new, done, r.load(self.low)), b.select(b.or_(new, hit), to, r.load(self.high))
        at_high = b.select(hit, value, r.load(self.at_high))
        at_low = b.select(new, before, r.load(self.at_low))
        short = b.and_(seeking, b.not_(hit))
        low, at_low = b.select(short, to, low), b.select(short, value, at_low)
        move = r.div(r.sub(zero, value), r.mul(slope, whole))
        near = b.fcmp_ordered("<=", r.absolute(move), number(LOCATED))
        tight = b.fcmp_ordered("<=", r.sub(high, low), number(LOCATED))
        found = b.and_(sought, b.or_(near, tight))
        # The next iterate: Newton's point where it lies inside, else the secant's or the middle, in turns.
        middle = r.mul(number(0.5), r.add(low, high))
        newton = r.add(to, move)
        inside = b.and_(r.less(low, newton), r.less(newton, high))
        chord = r.add(low, r.mul(r.sub(high, low), r.div(at_low, r.sub(at_low, at_high))))
        even = b.icmp_signed("==", b.and_(trial, integer(1)), integer(0))
        chorded = b.and_(b.and_(r.less(low, chord), r.less(chord, high)), r.spread(even))
        following = b.select(inside, newton, b.select(chorded, chord, middle))
        # The first guess: inverse cubic interpolation between the ends of the step.
        fall = r.sub(at_high, before)
        part = r.div(r.sub(zero, before), fall)
        rest = r.sub(number(1.0), part)
        one, other = r.div(fall, r.mul(slope_before, h)), r.div(fall, r.mul(slope, h))
        guess = r.add(
            r.mul(r.mul(part, part), r.sub(number(3.0), r.mul(number(2.0), part))),
            r.sub(r.mul(one, r.mul(part, r.mul(rest, rest))), r.mul(other, r.mul(r.mul(part, part), rest))),
        )
        falls = b.and_(b.and_(r.less(zero, one), r.less(zero, other)), r.less(zero, before))
        good = b.and_(falls, b.and_(r.less(zero, guess), r.less(guess, number(1.0))))
        first = b.select(good, r.add(low, r.mul(guess, r.sub(high, low))), middle)
        behind = b.and_(b.fcmp_ordered("<=", before, zero), r.less(slope_before, zero))  # it starts on the surface
        first = b.select(behind, done, first)
        following = b.select(new, first, following)
        on = b.and_(sought, b.not_(found))
        r.store(b.select(on, following, to), self.to)
        for place, value in ((self.low, low), (self.high, high), (self.at_low, at_low), (self.at_high, at_high)):
            r.store(b.select(sought, value, r.load(place)), place)
        r.store(b.sext(on, INTS), self.seeking)
        return found

    def _pieces(self) -> Value:
        """Number of pieces of each lane."""
        return self.r.b.sitofp(self.r.load(self.r.at["pieces"]), LANE)

    def _part(self, found: Value, done: Value, to: Value) -> Value:
        """Find lanes that came to a crossing in one piece, and let them begin again in several."""
        r, b = self.r, self.r.b
        way = r.sub(to, done)
        whole = b.and_(b.icmp_signed("!=", r.load(self.fresh), integers(0)), r.less(number(SHORT), way))
        several = b.icmp_signed(">", r.load(r.at["pieces"]), integers(1))
        parted = b.and_(found, b.and_(whole, several))
        piece = r.div(r.mul(way, number(1.0 + SHORT)), self._pieces())  # the last one ends just behind the crossing
        r.store(b.select(parted, piece, r.load(self.most)), self.most)
        r.store(b.select(parted, r.add(done, piece), r.load(self.to)), self.to)
        for place in (self.fresh, self.seeking):
            r.store(b.select(parted, integers(0), r.load(place)), place)
        return parted

    def _dip(self, lanes: Value, done: Value, to: Value, h: Value) -> Value:
        """Find lanes whose step may dip behind a surface between its ends, and cut it there."""
        r, b = self.r, self.r.b
        best, where = number(NEAR), to
        zero, one = number(0.0), number(1.0)
        for k in range(self.sizes.surfaces):
            m = r.load(self.modes, k)
            v0, v1 = r.mul(m, r.load(self.g0, k)), r.mul(m, r.load(self.g1, k))
            s0, s1 = r.mul(r.mul(m, h), r.load(self.d0, k)), r.mul(r.mul(m, h), r.load(self.d1, k))
            bend = b.and_(b.and_(r.less(zero, v0), r.less(zero, v1)), b.and_(r.less(s0, zero), r.less(zero, s1)))
            rise = r.sub(v1, v0)
            u = lowest_point(r, rise, s0, s1)
            size = b.select(r.less(v0, v1), v1, v0)
            low = r.div(hermite(r, u, v0, rise, s0, s1), size)
            deeper = b.and_(bend, r.less(low, best))
            deeper = b.and_(deeper, b.and_(r.less(zero, u), r.less(u, one)))
            best = b.select(deeper, low, best)
            where = b.select(deeper, r.add(done, r.mul(u, r.sub(to, done))), where)
        allowed = r.less(r.load(self.dips), number(float(DIPS)))
        dips = b.and_(b.and_(lanes, allowed), r.less(best, number(NEAR)))
        r.store(b.select(dips, where, r.load(self.to)), self.to)
        r.store(r.add(r.load(self.dips), b.select(dips, one, zero)), self.dips)
        return dips

    def _take(self, x: Value, lanes: Value, h: Value) -> None:
        """Take over the end of a part of the step, and tangent vectors with it."""
        r, b, a = self.r, self.r.b, self.r.at
        with b.if_then(b.icmp_signed("==", a["folded"], integer(2))):
            r.store(b.sext(lanes, INTS), self.flag)
            self.of.between.write(r, a["y"], self.f0, x, self.f1, self.span, a["p"], a["sums"], self.flag)
        self.stepper.replace(a["y"], x, self.sizes.states * (2 if self.sizes.along else 1), lanes)
        self.stepper.vectors(a["y"], h, a["p"], self.count, lanes)
