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

    Parameters
    ----------
    observed : Routine
        Outputs and their rates along a vector.
    """

    def __init__(self, module: ir.Module, sizes: Sizes, observed: Routine) -> None:
        self.sizes, self.observed = sizes, observed
        self.peaks = _peaks(module, sizes.states + sizes.outputs)

    def write(
        self, r: Routine, y: Value, f0: Value, x: Value, f1: Value, h: Value, p: Value, sums: Value, active: Value
    ) -> None:
        """Take the extremes of a step from ``y`` with rates ``f0`` to ``x`` with ``f1`` into ``sums``."""
        n, m = self.sizes.states, self.sizes.outputs
        r.call(self.peaks, v0=y, d0=f0, v1=x, d1=f1, h=h, sums=sums, rows=integer(n), active=active)
        if m:
            o0, e0, o1, e1 = (r.local(LANE, m) for _ in range(4))
            r.call(self.observed, y=y, p=p, v=f0, o=o0, rate=e0)
            r.call(self.observed, y=x, p=p, v=f1, o=o1, rate=e1)
            r.call(self.peaks, v0=o0, d0=e0, v1=o1, d1=e1, h=h, sums=r.row(sums, n), rows=integer(m), active=active)


def _peaks(module: ir.Module, rows: int) -> Routine:
    """Write ``peaks``: the turning points of each row's cubic into the running minimum and maximum of active lanes."""
    kinds: dict[str, Kind] = dict.fromkeys(("v0", "d0", "v1", "d1", "h", "sums"), "rows")
    r = Routine(module, "peaks", {**kinds, "rows": "int", "active": "flags"})
    b, a = r.b, r.at
    runs = b.icmp_signed("!=", r.load(a["active"]), integers(0))
    h = r.load(a["h"])
    with r.loop(a["rows"]) as i:
        v0, v1 = r.load(a["v0"], i), r.load(a["v1"], i)
        s0, s1 = r.mul(h, r.load(a["d0"], i)), r.mul(h, r.load(a["d1"], i))
        rise = r.sub(v1, v0)
        for u in turning_points(r, rise, s0, s1):
            inside = b.and_(runs, b.and_(r.less(number(0.0), u), r.less(u, number(1.0))))
            value = hermite(r, u, v0, rise, s0, s1)
            for k, smaller in ((1, True), (2, False)):
                place = b.add(i, integer(k * rows))
                old = r.load(a["sums"], place)
                beyond = r.less(value, old) if smaller else r.less(old, value)
                r.store(b.select(b.and_(inside, beyond), value, old), a["sums"], place)
    r.done()
    return r
