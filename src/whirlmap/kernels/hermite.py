"""Extremes between the ends of a step: the turning points of cubics through values and rates (Hermite interpolation)."""

from llvmlite import ir

from whirlmap.kernels.routine import LANE, Kind, Routine, Value, integer, integers, number
from whirlmap.kernels.stepping import Sizes


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

    A cubic says when an output turns; its value there is that at the states, by their own cubics: an output may swing
    several times as fast as they do.

    Parameters
    ----------
    observed, along : Routine
        Outputs; and outputs with their rates along a vector.
    """

    def __init__(self, module: ir.Module, sizes: Sizes, observed: Routine, along: Routine) -> None:
        self.sizes, self.along = sizes, along
        self.states = _of_states(module, sizes)
        self.outputs = _of_outputs(module, sizes, observed)

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

    def at(self, u: Value) -> Value:
        """Value after a part of the step."""
        return hermite(self.r, u, self.v0, self.rise, self.s0, self.s1)

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
    runs, h = b.icmp_signed("!=", r.load(a["active"]), integers(0)), r.load(a["h"])
    with r.loop(sizes.states) as i:
        cubic = _Cubic(r, *(r.load(a[name], i) for name in ("v0", "d0", "v1", "d1")), h)
        for u in cubic.turns():
            _keep(r, cubic.at(u), a["sums"], i, sizes.states + sizes.outputs, b.and_(runs, inside(r, u)))
        _keep(r, cubic.v1, a["sums"], i, sizes.states + sizes.outputs, runs)
    r.done()
    return r


def _of_outputs(module: ir.Module, sizes: Sizes, observed: Routine) -> Routine:
    """Write ``output_peaks``: outputs at the ends of the step and where the cubic of each one turns."""
    more: dict[str, Kind] = dict.fromkeys(("p", "o0", "e0", "o1", "e1"), "rows")
    r = Routine(module, "output_peaks", {**_PATH, "active": "flags", **more})
    b, a, rows = r.b, r.at, sizes.states + sizes.outputs
    runs, h = b.icmp_signed("!=", r.load(a["active"]), integers(0)), r.load(a["h"])
    state, found = r.local(LANE, sizes.states), r.local(LANE, sizes.outputs)
    with r.loop(sizes.outputs) as i:
        row = b.add(i, integer(sizes.states))
        output = _Cubic(r, *(r.load(a[name], i) for name in ("o0", "e0", "o1", "e1")), h)
        for u in output.turns():
            there = b.and_(runs, inside(r, u))
            with b.if_then(r.any(there)):
                with r.loop(sizes.states) as j:
                    path = _Cubic(r, *(r.load(a[name], j) for name in ("v0", "d0", "v1", "d1")), h)
                    r.store(path.at(u), state, j)
                r.call(observed, y=state, p=a["p"], o=found)
                _keep(r, r.load(found, i), a["sums"], row, rows, there)
        _keep(r, output.v1, a["sums"], row, rows, runs)
    r.done()
    return r


def inside(r: Routine, u: Value) -> Value:
    """Lanes in which a part of the step lies between its ends."""
    return r.b.and_(r.less(number(0.0), u), r.less(u, number(1.0)))
