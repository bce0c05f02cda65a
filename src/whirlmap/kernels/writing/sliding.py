"""Rates of lanes that slide on a surface towards which the rates point from both sides (Filippov 1988)."""

from collections.abc import Sequence

from llvmlite import ir

from whirlmap.kernels.writing.routine import LANE, Kind, Routine, Value, integer, number
from whirlmap.kernels.writing.stepping import Sizes


def sliding_rates(
    module: ir.Module, sizes: Sizes, jumps: Sequence[bool], rates: Routine, guards: Routine, kinds: dict[str, Kind]
) -> Routine:
    """Write ``motion``: ``rates`` where no side is zero; where one is, the mean of both sides that stays on the surface.

    Arguments are those of ``rates``, and ``pull``, two rows: how fast the rates of the positive and of the negative side
    bring a sliding lane back to the surface. It slides as long as both are positive. Derivatives along a vector that lies in
    the surface keep it there, where the surface's gradient is constant; a Jacobian is that of one side.

    ``shift`` is written where any lane slides: the move along the jump of the rates that puts a sliding lane back on the
    surface, by one step of Newton's method.
    """
    r = Routine(module, "motion", {**kinds, "pull": "rows", "shift": "rows"})
    b, a = r.b, r.at
    zero = number(0.0)
    slides = [
        b.fcmp_ordered("==", r.load(a["modes"], k), zero) if jump else None for k, jump in enumerate(jumps)
    ]
    upper, lower = r.local(LANE, sizes.surfaces), r.local(LANE, sizes.surfaces)
    anywhere = b.fcmp_ordered("!=", zero, zero)  # in no lane
    for k, mask in enumerate(slides):
        m = r.load(a["modes"], k)
        for rows, side in ((upper, 1.0), (lower, -1.0)):
            r.store(m if mask is None else b.select(mask, number(side), m), rows, k)
        anywhere = anywhere if mask is None else b.or_(anywhere, mask)
    given = {name: value for name, value in a.items() if name not in ("pull", "shift")}
    r.call(rates, **{**given, "modes": upper})
    with b.if_then(r.any(anywhere), likely=False):
        other, spare = r.local(LANE, sizes.states), r.local(LANE, max(sizes.slots, sizes.states))
        r.call(rates, **{**given, "modes": lower, "dy": other, "more": spare})
        value, above, below, clock = (r.local(LANE, size) for size in (sizes.surfaces,) * 3 + (1,))
        r.store(number(1.0), clock)
        for modes, slope, rate in ((upper, a["dy"], above), (lower, other, below)):
            r.call(guards, y=a["y"], c=a["c"], p=a["p"], modes=modes, v=slope, clock=clock, g=value, rate=rate)
        up, down, off = number(-1.0), number(1.0), zero
        for k, mask in enumerate(slides):
            if mask is not None:
                up, down = b.select(mask, r.load(above, k), up), b.select(mask, r.load(below, k), down)
                off = b.select(mask, r.load(value, k), off)
        share = r.div(down, r.sub(down, up))
        r.store(r.sub(zero, up), a["pull"])
        r.store(down, a["pull"], 1)
        apart = r.local(LANE, sizes.states)

        def mean(one: Value, two: Value) -> Value:
            return r.add(two, r.mul(share, r.sub(one, two)))

        with r.loop(sizes.states) as i:
            one, two = r.load(a["dy"], i), r.load(other, i)
            r.store(r.sub(one, two), apart, i)
            r.store(r.mul(r.div(off, r.sub(down, up)), r.sub(one, two)), a["shift"], i)
            r.store(b.select(anywhere, mean(one, two), one), a["dy"], i)

        def kept(rates: Value, out: Value) -> None:
            """Write rates, or a vector's, less what would leave the surface along the jump of the rates."""
            r.call(guards, y=a["y"], c=a["c"], p=a["p"], modes=upper, v=rates, clock=clock, g=value, rate=above)
            leaves = zero
            for k, mask in enumerate(slides):
                leaves = leaves if mask is None else b.select(mask, r.load(above, k), leaves)
            back = r.div(leaves, r.sub(up, down))
            with r.loop(sizes.states) as i:
                stays = r.sub(r.load(rates, i), r.mul(back, r.load(apart, i)))
                r.store(b.select(anywhere, stays, r.load(out, i)), out, i)

        kept(a["dy"], a["dy"])  # the mean has the rounding error of one side: a mass that sticks would creep
        if sizes.along:
            for run in sizes.runs:  # their rows are not written: they are the vector's velocities
                with r.loop(run.rows) as i:
                    velocity = r.load(a["v"], b.add(i, integer(run.velocity)))
                    for rows in (a["more"], spare):
                        r.store(velocity, rows, b.add(i, integer(run.position)))
            both = r.local(LANE, sizes.states)
            with r.loop(sizes.states) as i:
                r.store(mean(r.load(a["more"], i), r.load(spare, i)), both, i)
            r.store(zero, clock)
            kept(both, a["more"])
    r.done()
    return r
