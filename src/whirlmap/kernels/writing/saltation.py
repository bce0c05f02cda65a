"""Sides of discontinuity surfaces at the start of a run, and their change at a crossing: sliding, or saltation at a jump."""

from collections.abc import Sequence
from dataclasses import dataclass

from whirlmap.kernels.methods import Method
from whirlmap.kernels.writing.hermite import Between
from whirlmap.kernels.writing.routine import INTS, LANE, Routine, Value, integer, integers, number
from whirlmap.kernels.writing.stepping import Sizes, Stepper

#: Causes for which a step of a lane fails.
LIMITS, STICKS, CHATTERS = 1, 2, 3
#: Most crossings of a lane in one step.
MOST = 64
#: Speed of a crossing below which a motion that is pushed back from both sides rests: part of what the pushes change it by
#: in one step.
REST = 1e-9
#: A crossing is grazing where the surface's rate is below this part of that rate's change during the step.
GRAZING = 1e-3


@dataclass(frozen=True)
class Surfaces:
    """Surfaces of a model, and the routines that a step through them calls.

    Attributes
    ----------
    jumps, flat, first : sequence of bool
        Of each surface: whether the rates jump there, whether its gradient is constant, and whether its own rate is what
        jumps (`surfaces.Sided.held`).
    holds : sequence of sequence of int
        Other surfaces that a motion which slides on each stays on.
    motion, tangent : Routine
        Rates, those of sliding lanes too (`sliding`); the product of the Jacobian with a vector, where there is one.
    guards, held, sides : Routine
        Value and rate of each surface, and of what is held while a motion slides; the sign of each surface.
    examine, harmonics : Routine
        The test of a step's end; the harmonics after a part of the step.
    between : Between
        Extremes between the ends of a step.
    same_side : Routine, optional
        As in `advancing.Parts`.
    """

    jumps: Sequence[bool]
    flat: Sequence[bool]
    first: Sequence[bool]
    holds: Sequence[Sequence[int]]
    motion: Routine
    tangent: Routine | None
    guards: Routine
    held: Routine
    sides: Routine
    examine: Routine
    harmonics: Routine
    between: Between
    same_side: Routine | None


class SurfaceStep:
    """Memory of a step through surfaces, the rates in it, and what happens at a crossing.

    Attributes
    ----------
    f0, f1, f2 : Value
        Rows of rates: at the begin and at the end of a part of the step, and at its end behind a surface.
    g0, d0, ... : Value
        Rows of values and rates of the surfaces at these places.
    done, to : Value
        Parts of the step that are taken, and the end of the next iterate.
    pending, seeking, fresh : Value
        Lanes that have not ended their step, those that seek a crossing, and those that come from one in this step.
    most : Value
        Longest part of the step that an iterate may take.
    """

    def __init__(self, r: Routine, sizes: Sizes, method: Method, surfaces: Surfaces) -> None:
        self.r, self.sizes, self.method, self.of = r, sizes, method, surfaces
        self.jumps, self.flat = surfaces.jumps, surfaces.flat
        n, k, waves = sizes.states, sizes.surfaces, 2 * sizes.harmonics
        self.stepper = Stepper(r, sizes, method, surfaces.motion, surfaces.tangent, r.at["work"], surfaces.same_side)
        self.f0, self.f1, self.f2 = (r.local(LANE, n) for _ in range(3))
        self.g0, self.d0, self.g1, self.d1, self.g2, self.d2, self.change = (r.local(LANE, k) for _ in range(7))
        self.c0, self.c1 = r.local(LANE, waves), r.local(LANE, waves)
        self.moment, self.span, self.clock, self.pull = (r.local(LANE, size) for size in (1, 1, 1, 2))
        self.done, self.to, self.low, self.high, self.at_low, self.at_high = (r.local(LANE) for _ in range(6))
        self.crossed, self.dips, self.most = r.local(LANE), r.local(LANE), r.local(LANE)
        self.pending, self.seeking, self.fresh, self.flag = (r.local(INTS) for _ in range(4))
        self.shift = r.local(LANE, n)
        self.spare = r.local(LANE, max(sizes.slots, n))  # derivatives that are not used
        vectors = surfaces.tangent is not None or sizes.along
        self.count = r.at["count"] if vectors else integer(0)
        self.modes = r.row(r.at["y"], r.b.mul(r.b.add(self.count, integer(1)), integer(n)))
        self.inputs = {name: r.at[name] for name in ("p", "tables", "offsets")} | {"modes": self.modes}
        if any(self.jumps):
            self.inputs |= {"pull": self.pull, "shift": self.shift}

    def _moves(self, y: Value, c: Value, out: Value) -> None:
        """Write the rates at a state; they replace neither slopes nor Jacobians of the stages."""
        more = {"more": self.spare} if not self.sizes.along else {"v": y, "more": self.spare}
        self.r.call(self.of.motion, y=y, c=c, scratch=self.stepper.scratch, dy=out, **more, **self.inputs)

    def _at(self, part: Value, c: Value) -> None:
        """Write the harmonics after a part of the step."""
        self.r.store(part, self.moment)
        self.r.call(self.of.harmonics, c=self.r.at["c"], turn=self.r.at["turn"], part=self.moment, out=c)

    def _slides(self, k: int) -> Value:
        """Lanes that slide on a surface."""
        return self.r.b.fcmp_ordered("==", self.r.load(self.modes, k), number(0.0))

    def _first_sides(self) -> None:
        """Set unknown sides of lanes: by the value of the surface, or by its rate where the value is zero."""
        r, b, a = self.r, self.r.b, self.r.at
        unknown = [r.less(number(1.5), r.load(self.modes, k)) for k in range(self.sizes.surfaces)]
        asked = unknown[0]
        for mask in unknown[1:]:
            asked = b.or_(asked, mask)
        with b.if_then(r.any(asked), likely=False):
            found, on = r.local(LANE, self.sizes.surfaces), b.fcmp_ordered("!=", number(0.0), number(0.0))
            r.call(self.of.sides, y=a["y"], c=a["c"], p=a["p"], modes=found)
            for k, mask in enumerate(unknown):
                here = r.load(found, k)
                zero = b.and_(mask, b.fcmp_ordered("==", here, number(0.0)))
                on = b.or_(on, zero)
                r.store(b.select(mask, b.select(zero, number(1.0), here), r.load(self.modes, k)), self.modes, k)
            with b.if_then(r.any(on), likely=False):
                held = r.local(LANE, self.sizes.surfaces)
                self._rates_here(self.g0, self.d0)
                for k, mask in enumerate(unknown):
                    zero = b.and_(mask, b.fcmp_ordered("==", r.load(found, k), number(0.0)))
                    away = b.and_(zero, r.less(r.load(self.d0, k), number(0.0)))
                    r.store(b.select(away, number(1.0), number(0.0)), held, k)
                    r.store(b.select(away, number(-1.0), r.load(self.modes, k)), self.modes, k)
                if any(self.jumps):
                    self._begin_on_it(held)

    def _rates_here(self, g: Value, rate: Value) -> None:
        """Write rates at the begin of the step, and value and rate of each surface there."""
        r, a = self.r, self.r.at
        self._moves(a["y"], a["c"], self.f1)
        r.call(
            self.of.guards, y=a["y"], c=a["c"], p=a["p"], modes=self.modes, v=self.f1, clock=self.clock, g=g, rate=rate
        )

    def _begin_on_it(self, back: Value) -> None:
        """Cross at once where a lane begins on a surface and both sides point at it.

        Its rates on one side would bring it to the other, and may bring it back before the step ends, where nothing of
        that is seen. ``back`` is one where those of the positive side point at the surface.
        """
        r, b = self.r, self.r.b
        self._rates_here(self.g1, self.d1)
        self.stepper.replace(self.c1, r.at["c"], 2 * self.sizes.harmonics, None)
        which, slope = integers(-1), number(0.0)
        for k in reversed(range(self.sizes.surfaces)):  # the first of them is left
            r.store(number(0.0), self.change, k)  # none of them is grazing
            if self.jumps[k]:
                rate = r.load(self.d1, k)
                held = b.and_(r.less(number(0.0), r.load(back, k)), r.less(number(0.0), rate))
                which, slope = b.select(held, integers(k), which), b.select(held, rate, slope)
        found = b.and_(b.icmp_signed(">=", which, integers(0)), b.icmp_signed("!=", r.load(self.pending), integers(0)))
        with b.if_then(r.any(found)):
            self._cross(found, which, slope)

    def _return(self, x: Value) -> None:
        """Project sliding lanes back on their surface: errors of rounding and location would otherwise stay for ever.

        A mass that sticks would creep on at that speed for ever.
        """
        r, b = self.r, self.r.b
        slides = b.fcmp_ordered("!=", number(0.0), number(0.0))
        for k, jump in enumerate(self.jumps):
            slides = b.or_(slides, self._slides(k)) if jump else slides
        with b.if_then(r.any(slides), likely=False), r.loop(self.sizes.states) as i:
            moved = r.add(r.load(x, i), r.load(self.shift, i))
            r.store(b.select(slides, moved, r.load(x, i)), x, i)

    def _cross(self, found: Value, which: Value, slope: Value) -> None:
        """Change sides at a crossing."""
        r, b, a = self.r, self.r.b, self.r.at
        one, zero = number(1.0), number(0.0)
        r.store(r.add(r.load(self.crossed), b.select(found, one, zero)), self.crossed)
        r.store(r.add(r.load(a["tally"]), b.select(found, one, zero)), a["tally"])
        usual = zero
        for k in range(self.sizes.surfaces):
            usual = b.select(b.icmp_signed("==", which, integers(k)), r.load(self.change, k), usual)
        graze = b.and_(found, r.less(r.absolute(slope), r.mul(number(GRAZING), usual)))
        graze = b.and_(graze, b.fcmp_ordered("!=", slope, zero))  # a lane that slides has none
        r.store(r.add(r.load(a["tally"], 1), b.select(graze, one, zero)), a["tally"], 1)
        here = [b.and_(found, b.icmp_signed("==", which, integers(k))) for k in range(self.sizes.surfaces)]
        old = [r.load(self.modes, k) for k in range(self.sizes.surfaces)]
        for k, mask in enumerate(here):
            new = r.sub(zero, old[k])
            if self.jumps[k]:
                leaves = b.select(r.less(r.load(self.pull), r.load(self.pull, 1)), one, number(-1.0))
                new = b.select(self._slides(k), leaves, new)
            r.store(b.select(mask, new, old[k]), self.modes, k)
        stuck = b.and_(found, b.not_(found))
        if any(self.jumps):
            stuck = self._jump(here, old)
        lost = b.and_(found, r.less(number(float(MOST)), r.load(self.crossed)))
        cause = b.select(lost, integers(CHATTERS), r.load(a["cause"]))
        r.store(b.select(stuck, integers(STICKS), cause), a["cause"])
        pending = b.icmp_signed("!=", r.load(self.pending), integers(0))
        r.store(b.sext(b.and_(pending, b.not_(b.or_(lost, stuck))), INTS), self.pending)

    def _jump(self, here: list[Value], old: list[Value]) -> Value:
        """Slide where both sides point at the surface, else apply the saltation matrix; returns the lanes that stick."""
        r, b, a = self.r, self.r.b, self.r.at
        zero = number(0.0)
        self._moves(a["y"], self.c1, self.f2)
        guarded = {"y": a["y"], "c": self.c1, "p": a["p"], "modes": self.modes}
        before, at_rest = r.local(LANE, self.sizes.surfaces), r.local(LANE, self.sizes.surfaces)
        r.call(self.of.held, v=self.f1, clock=self.clock, g=at_rest, rate=before, **guarded)
        r.call(self.of.held, v=self.f2, clock=self.clock, g=at_rest, rate=self.d2, **guarded)
        sliding = b.fcmp_ordered("!=", zero, zero)  # in no lane
        for k, jump in enumerate(self.jumps):
            if jump:
                sliding = b.or_(sliding, b.and_(b.not_(here[k]), self._slides(k)))
        stuck = b.fcmp_ordered("!=", zero, zero)
        vectors = r.spread(b.icmp_signed(">", self.count, integer(0)))
        speed, jumped, slid = number(1.0), stuck, stuck
        for k, jump in enumerate(self.jumps):
            if not jump:
                continue
            crossing = b.and_(here[k], b.fcmp_ordered("!=", old[k], zero))
            back = b.and_(crossing, b.not_(r.less(r.mul(old[k], r.load(self.d2, k)), zero)))
            if not self.of.first[k]:  # both sides push, and there is no speed left
                push = r.mul(r.load(a["h"]), r.add(r.absolute(r.load(before, k)), r.absolute(r.load(self.d2, k))))
                slow = r.less(r.absolute(r.load(at_rest, k)), r.mul(number(REST), push))
                back = b.and_(b.and_(back, slow), r.less(r.mul(old[k], r.load(before, k)), zero))
            r.store(b.select(back, zero, r.load(self.modes, k)), self.modes, k)
            with_it = self.sizes.along and self.flat[k]
            stuck = b.or_(stuck, b.and_(back, sliding if with_it else b.or_(sliding, vectors)))
            slid = b.or_(slid, back)
            speed = b.select(crossing, r.load(self.d1, k), speed)
            jumped = b.or_(jumped, crossing)
        with b.if_then(r.any(slid)):
            self._moves(a["y"], self.c1, self.f2)
        n = self.sizes.states
        still = r.local(LANE)
        r.store(zero, still)
        with r.loop(self.count) as v:
            vector = r.row(a["y"], b.mul(b.add(v, integer(1)), integer(n)))
            r.call(self.of.guards, v=vector, clock=still, g=self.g2, rate=self.d2, **guarded)
            across = zero
            for k, jump in enumerate(self.jumps):
                if jump:
                    across = b.select(here[k], r.load(self.d2, k), across)
            # A slide that is left may be crossed again at once, at no speed: its vectors lie in the surface, and stay.
            moves = b.and_(jumped, b.fcmp_ordered("!=", speed, zero))
            factor = b.select(moves, r.div(across, speed), zero)
            with r.loop(n) as i:
                change = r.mul(factor, r.sub(r.load(self.f2, i), r.load(self.f1, i)))
                r.store(b.select(jumped, r.add(r.load(vector, i), change), r.load(vector, i)), vector, i)
        return stuck
