"""Kernels in which every lane has its own time: single evaluations and short runs.

They serve where the phase-locked kernel cannot: the right-hand side at a given time, shorter steps where a step failed, and
the bracketing of terminal events.
"""

from llvmlite import ir

from whirlmap.kernels.methods import Method
from whirlmap.kernels.writing.advancing import Parts
from whirlmap.kernels.writing.event_location import PIECES
from whirlmap.kernels.writing.routine import INTS, LANE, LANES, Kind, Routine, Value, integer, integers, number
from whirlmap.kernels.writing.stepping import Sizes, Stepper

#: Arguments of ``march`` and ``evaluate``, arrays of consecutive blocks.
MARCH: dict[str, Kind] = {
    "blocks": "int", "count": "int", "y": "rows", "time": "rows", "origin": "rows", "h": "rows", "p": "rows",
    "tables": "doubles", "offsets": "flags", "steps": "int", "good": "flags", "work": "rows",
}  # fmt: skip
EVALUATE: dict[str, Kind] = {
    "blocks": "int", "forced": "int", "y": "rows", "time": "rows", "p": "rows", "tables": "doubles", "offsets": "flags",
    "dy": "rows", "jac": "rows", "o": "rows", "work": "rows",
}  # fmt: skip


def march(module: ir.Module, sizes: Sizes, method: Method, parts: Parts, phases: Routine, turns: Routine | None) -> None:
    """Write ``march``: ``steps`` steps of ``h`` from ``time``, in place; ``good`` says which lanes ended every step well.

    ``origin`` holds the angle of each harmonic at time zero. A lane that ended a step badly goes on, or stays where it
    crossed a surface; its numbers mean nothing. ``turns`` writes the angles of the harmonics in one step, for a model with
    surfaces.
    """
    one = Routine(module, "march_block", {name: kind for name, kind in MARCH.items() if name != "blocks"})
    b, a = one.b, one.at
    stepper = Stepper(one, sizes, method, parts.rates, parts.tangent, a["work"], None if parts.through else parts.same_side)
    stepper.clear()
    h = one.load(a["h"])
    flag, moment = one.local(INTS), one.local(number(0.0).type)
    inputs = {name: a[name] for name in ("p", "tables", "offsets")}
    one.store(ir.Constant(INTS, [-1] * LANES), a["good"])

    def phases_at(stage: int) -> Value:
        one.store(one.add(one.load(a["time"]), one.mul(number(float(method.c[stage])), h)), moment)
        one.call(phases, time=moment, origin=a["origin"], p=a["p"], c=stepper.c)
        return stepper.c

    begin, turn = one.local(LANE, 2 * sizes.harmonics), one.local(LANE, sizes.harmonics)
    part, tally, none, parted = one.local(LANE), one.local(LANE, 2), one.local(LANE), one.local(INTS)
    one.store(integers(PIECES), parted)
    with one.loop(a["steps"]):
        if parts.through and turns:
            one.call(phases, time=a["time"], origin=a["origin"], p=a["p"], c=begin)
            one.call(turns, h=a["h"], p=a["p"], turn=turn)
            one.call(
                parts.through, count=a["count"], y=a["y"], h=a["h"], c=begin, turn=turn, active=a["good"], cause=flag,
                reached=part, tally=tally, folded=integer(0), sums=none, pieces=parted, work=a["work"], **inputs,
            )  # fmt: skip
            well = b.icmp_signed("==", one.load(flag), integers(0))
            one.store(b.and_(one.load(a["good"]), b.sext(well, INTS)), a["good"])
        else:
            x = stepper.step(a["y"], h, inputs, phases_at)
            one.call(parts.examine, y=x, p=a["p"], good=flag)
            stepper.within(flag)
            one.store(b.and_(one.load(a["good"]), one.load(flag)), a["good"])
            stepper.replace(a["y"], x, sizes.states * (2 if sizes.along else 1), None)
            stepper.vectors(a["y"], h, a["p"], a["count"])
        one.store(one.add(one.load(a["time"]), h), a["time"])
    one.done()
    r = Routine(module, "march", MARCH, public=True)
    rows = {
        "y": sizes.rows(r.b, r.at["count"]), "time": integer(1), "origin": integer(max(sizes.harmonics, 1)), "h": integer(1),
        "p": integer(sizes.inputs), "offsets": integer(max(sizes.tables, 1)), "good": integer(1),
    }  # fmt: skip
    with r.loop(r.at["blocks"]) as block:
        moved = {name: r.row(r.at[name], r.b.mul(block, size)) for name, size in rows.items()}
        r.call(one, **{name: moved.get(name, r.at[name]) for name in one.at})
    r.done()


def evaluate(module: ir.Module, sizes: Sizes, method: Method, parts: Parts, phases: Routine, sides: Routine | None) -> None:
    """Write ``evaluate``: rates, Jacobian entries (where there are any) and outputs; unforced, every harmonic is zero.

    ``sides`` writes the sides of a model with surfaces; on a surface itself ``sign`` is zero, as in the model's expressions.
    """
    r = Routine(module, "evaluate", EVALUATE, public=True)
    rows = {
        "y": sizes.states, "time": 1, "p": sizes.inputs, "offsets": max(sizes.tables, 1), "dy": sizes.states,
        "jac": sizes.slots, "o": sizes.outputs,
    }  # fmt: skip
    stepper = Stepper(r, sizes, method, parts.rates, None, r.at["work"])
    modes, origin = r.local(LANE, sizes.surfaces), r.local(LANE, sizes.harmonics)
    for j in range(sizes.harmonics):
        r.store(number(0.0), origin, j)
    with r.loop(r.at["blocks"]) as block:
        a = {name: r.row(r.at[name], r.b.mul(block, integer(size))) for name, size in rows.items()}
        stepper.clear()
        r.call(phases, time=a["time"], origin=origin, p=a["p"], c=stepper.c)
        with r.b.if_then(r.b.icmp_signed("==", r.at["forced"], integer(0))), r.loop(2 * sizes.harmonics) as i:
            r.store(number(0.0), stepper.c, i)
        more = {"more": a["jac"]}
        if sides:
            r.call(sides, y=a["y"], c=stepper.c, p=a["p"], modes=modes)
            more["modes"] = modes
        r.call(
            parts.rates, y=a["y"], c=stepper.c, p=a["p"], tables=r.at["tables"], offsets=a["offsets"],
            scratch=stepper.scratch, dy=a["dy"], **more,
        )  # fmt: skip
        r.call(parts.observed, y=a["y"], p=a["p"], o=a["o"])
    r.done()
