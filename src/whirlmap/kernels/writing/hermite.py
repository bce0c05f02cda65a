"""Extremes between the ends of a step: the turning points of cubics through values and rates (Hermite interpolation)."""

from llvmlite import ir

from whirlmap.kernels.writing.routine import LANE, Kind, Routine, Value, integer, integers, number
from whirlmap.kernels.writing.stepping import Sizes

#: Values by which the turn of an output in a step is narrowed.
TRIALS = 8


def hermite(r: Routine, u: Value, v0: Value, rise: Value, s0: Value, s1: Value) -> Value:
    """Value of the cubic with value ``v0`` and slopes ``s0``, ``s1`` at the ends 0, 1, between which it rises, at ``u``."""
    w = r.sub(number(1.0), u)
    bend = r.sub(r.mul(s0, w), r.mul(s1, u))
    up = r.mul(r.mul(u, u), r.mul(rise, r.sub(number(3.0), r.mul(number(2.0), u))))
    return r.add(v0, r.add(up, r.mul(r.mul(u, w), bend)))


def turning_points(r: Routine, rise: Value, s0: Value, s1: Value) -> tuple[Value, Value]:
    """Both places at which that cubic's slope is zero; not a number where there are none."""
    b = r.b
    total = r.add(s0, s1)
    a = r.mul(number(3.0), r.sub(total, r.add(rise, rise)))
    half = r.sub(r.mul(number(3.0), rise), r.add(total, s0))
    root = r.root(r.sub(r.mul(half, half), r.mul(a, s0)))
    q = r.sub(number(0.0), r.add(half, b.select(r.less(half, number(0.0)), r.sub(number(0.0), root), root)))
    return r.div(q, a), r.div(s0, q)


def lowest_point(r: Routine, rise: Value, s0: Value, s1: Value) -> Value:
    """Where the cubic is lowest between ends at which it falls and rises."""
    b = r.b
    one, other = turning_points(r, rise, s0, s1)
    inside = b.and_(r.less(number(0.0), one), r.less(one, number(1.0)))
    return b.select(inside, one, other)


class Between:
    """Extremes of states and outputs between the ends of a step: those of cubics through values and rates.

    Outputs are read at the states between the ends of a step, which their own cubics give: an output may swing several
    times as fast as they do, or turn sharply (the radius of an orbit that passes near the centre). Where it does so is the
    zero of its rate, narrowed by `TRIALS` values.

    Parameters
    ----------
    along : Routine
        Outputs, and their rates along a vector.
    """

    def __init__(self, module: ir.Module, sizes: Sizes, along: Routine) -> None:
        self.sizes, self.along = sizes, along
        self.states = _of_states(module, sizes)
        self.outputs = _of_outputs(module, sizes, along)

    def write(
        self, r: Routine, y: Value, f0: Value, x: Value, f1: Value, h: Value, p: Value, sums: Value, active: Value
    ) -> None:
        """Take the extremes of a step from ``y`` with rates ``f0`` to ``x`` with ``f1``, its end too, into ``sums``."""
        m = self.sizes.outputs
        path = {"v0": y, "d0": f0, "v1": x, "d1": f1, "h": h, "sums": sums, "active": active}
        r.call(self.states, **path)
        if m:
            o0, e0, o1, e1 = (r.local(LANE, m) for _ in range(4))
            r.call(self.along, y=y, p=p, v=f0, o=o0, rate=e0)
            r.call(self.along, y=x, p=p, v=f1, o=o1, rate=e1)
            r.call(self.outputs, **path, p=p, o0=o0, e0=e0, o1=o1, e1=e1)


class _Cubic:
    """Cubic of one row of a step: ``v0`` and rates ``d0`` at its begin, ``v1`` and ``d1`` at its end."""

    def __init__(self, r: Routine, v0: Value, d0: Value, v1: Value, d1: Value, h: Value) -> None:
        self.r, self.v0, self.v1 = r, v0, v1
        self.s0, self.s1, self.rise = r.mul(h, d0), r.mul(h, d1), r.sub(v1, v0)

    @classmethod
    def of(cls, r: Routine, a: dict[str, Value], row: Value) -> "_Cubic":
        """Cubic of a state, from the arguments of a routine."""
        v0, d0, v1, d1 = (r.load(a[name], row) for name in ("v0", "d0", "v1", "d1"))
        return cls(r, v0, d0, v1, d1, r.load(a["h"]))

    def at(self, u: Value) -> Value:
        """Value after a part of the step."""
        return hermite(self.r, u, self.v0, self.rise, self.s0, self.s1)

    def slope(self, u: Value) -> Value:
        """Its slope there, for each part of the step."""
        r, w = self.r, self.r.sub(number(1.0), u)
        up = r.mul(number(6.0), r.mul(r.mul(u, w), self.rise))
        ends = r.sub(r.mul(self.s0, w), r.mul(self.s1, u))
        return r.add(up, r.sub(r.mul(ends, r.sub(w, u)), r.mul(r.mul(u, w), r.add(self.s0, self.s1))))

    def turns(self) -> tuple[Value, Value]:
        """Parts of the step after which it turns."""
        return turning_points(self.r, self.rise, self.s0, self.s1)


def _keep(r: Routine, value: Value, sums: Value, row: Value, rows: int, where: Value) -> None:
    """Take a value into the running minimum and maximum of one of ``rows`` rows, in the lanes of ``where``."""
    for k, smaller in ((1, True), (2, False)):
        place = r.b.add(row, integer(k * rows))
        old = r.load(sums, place)
        beyond = r.less(value, old) if smaller else r.less(old, value)
        r.store(r.b.select(r.b.and_(where, beyond), value, old), sums, place)


_PATH: dict[str, Kind] = dict.fromkeys(("v0", "d0", "v1", "d1", "h", "sums"), "rows")


def _of_states(module: ir.Module, sizes: Sizes) -> Routine:
    """Write ``state_peaks``: the turning points and the ends of each state's cubic."""
    r = Routine(module, "state_peaks", {**_PATH, "active": "flags"})
    b, a = r.b, r.at
    runs = b.icmp_signed("!=", r.load(a["active"]), integers(0))
    with r.loop(sizes.states) as i:
        cubic = _Cubic.of(r, a, i)
        for u in cubic.turns():
            _keep(r, cubic.at(u), a["sums"], i, sizes.states + sizes.outputs, b.and_(runs, inside(r, u)))
        _keep(r, cubic.v1, a["sums"], i, sizes.states + sizes.outputs, runs)
    r.done()
    return r


def _of_outputs(module: ir.Module, sizes: Sizes, along: Routine) -> Routine:
    """Write ``output_peaks``: outputs at the ends of the step, and between them where they turn."""
    more: dict[str, Kind] = dict.fromkeys(("p", "o0", "e0", "o1", "e1"), "rows")
    r = Routine(module, "output_peaks", {**_PATH, "active": "flags", **more})
    b, a, rows = r.b, r.at, sizes.states + sizes.outputs
    runs, h = b.icmp_signed("!=", r.load(a["active"]), integers(0)), r.load(a["h"])
    state, speed = r.local(LANE, sizes.states), r.local(LANE, sizes.states)
    found, rates = r.local(LANE, sizes.outputs), r.local(LANE, sizes.outputs)
    low, high, at_low, at_high, part = (r.local(LANE) for _ in range(5))
    zero, half = number(0.0), number(0.5)

    def read(u: Value) -> None:
        with r.loop(sizes.states) as j:
            path = _Cubic.of(r, a, j)
            r.store(path.at(u), state, j)
            r.store(path.slope(u), speed, j)
        r.call(along, y=state, p=a["p"], v=speed, o=found, rate=rates)

    with r.loop(sizes.outputs) as i:
        row = b.add(i, integer(sizes.states))
        e0, e1 = r.load(a["e0"], i), r.load(a["e1"], i)
        output = _Cubic(r, r.load(a["o0"], i), e0, r.load(a["o1"], i), e1, h)
        once = b.and_(runs, r.less(r.mul(e0, e1), zero))
        turns = output.turns()
        for u in turns:  # a pair of turns, or the first guess of one
            there = b.and_(runs, b.and_(inside(r, u), b.not_(once)))
            with b.if_then(r.any(there)):
                read(u)
                _keep(r, r.load(found, i), a["sums"], row, rows, there)
        with b.if_then(r.any(once)):
            for place, value in ((low, zero), (high, number(1.0)), (at_low, e0), (at_high, e1)):
                r.store(value, place)
            guess = b.select(inside(r, turns[0]), turns[0], b.select(inside(r, turns[1]), turns[1], half))
            r.store(guess, part)
            with r.loop(TRIALS) as trial:
                u = r.load(part)
                read(u)
                _keep(r, r.load(found, i), a["sums"], row, rows, once)
                rate = r.load(rates, i)
                before = r.less(zero, r.mul(rate, e0))
                for place, value, where in ((low, u, before), (at_low, rate, before)):
                    r.store(b.select(where, value, r.load(place)), place)
                for place, value in ((high, u), (at_high, rate)):
                    r.store(b.select(before, r.load(place), value), place)
                width, fall = r.sub(r.load(high), r.load(low)), r.sub(r.load(at_low), r.load(at_high))
                chord = r.add(r.load(low), r.mul(width, r.div(r.load(at_low), fall)))
                middle = r.add(r.load(low), r.mul(half, width))
                plain = b.icmp_signed("==", b.and_(trial, integer(1)), integer(0))
                good = b.and_(r.spread(plain), b.and_(r.less(r.load(low), chord), r.less(chord, r.load(high))))
                r.store(b.select(good, chord, middle), part)
        _keep(r, output.v1, a["sums"], row, rows, runs)
    r.done()
    return r


def inside(r: Routine, u: Value) -> Value:
    """Lanes in which a part of the step lies between its ends."""
    return r.b.and_(r.less(number(0.0), u), r.less(u, number(1.0)))
