"""``advance``: many steps of many blocks, locked to the forcing's phase. All long runs are made of it."""

from dataclasses import dataclass
from math import pi

from llvmlite import ir

from whirlmap.kernels.methods import Method
from whirlmap.kernels.writing.hermite import Between
from whirlmap.kernels.writing.routine import DOUBLE, INT, INTS, LANE, Kind, Routine, Value, integer, integers, number
from whirlmap.kernels.writing.stepping import Sizes, Stepper

#: Arguments of ``advance``, arrays of consecutive blocks: see `advance`.
ARGUMENTS: dict[str, Kind] = {
    "blocks": "int", "count": "int", "y": "rows", "h": "rows", "p": "rows", "tables": "doubles", "offsets": "flags",
    "waves": "doubles", "starts": "ints", "lengths": "ints", "strides": "ints", "far": "ints", "begin": "ints",
    "steps": "int", "first": "flags",
    "active": "flags", "failed": "flags", "save_every": "int", "saves": "int", "saved": "rows", "orth_every": "int",
    "events": "int", "growth": "rows", "folded": "int", "sums": "rows", "turns": "doubles", "cause": "flags",
    "reached": "rows", "tally": "rows", "pieces": "int", "work": "rows",
}  # fmt: skip


@dataclass(frozen=True)
class Parts:
    """Routines of a model that ``advance`` calls.

    Attributes
    ----------
    rates, tangent : Routine
        Rates, and the product of the Jacobian with a vector (absent where vectors go along, or there are none).
    observed, examine : Routine
        Outputs; the test of a step's end.
    between : Between
        Extremes between the ends of a step.
    through : Routine, optional
        A step through surfaces (`event_location`), of a model that has some.
    same_side : Routine, optional
        Whether a place is on the side of the poles on which the step began, of a model that has some (`poles`).
    """

    rates: Routine
    tangent: Routine | None
    observed: Routine
    examine: Routine
    between: Between
    through: Routine | None
    same_side: Routine | None


def advance(module: ir.Module, sizes: Sizes, method: Method, nodes: tuple[float, ...], parts: Parts) -> None:
    """Write ``advance``.

    A lane stops, and keeps its last good state, before the step that ends at a closed gap, beyond the bound, behind a pole
    or at something that is not a number; ``failed`` then holds that step's index. Lane ``l`` starts at step ``first[l]``.

    Arguments of the kernel, rows of `LANES` numbers, one block after the other:

    ====================  =========================================================================================
    blocks, count         number of blocks, and of tangent vectors
    y                     (states * (1 + count) + surfaces) state, tangent vectors and sides, in place
    h                     (1) step of each lane
    p                     (inputs) hoisted parameters, reciprocal limits, weights of tangent vectors
    tables, offsets       table entries, and where each lane's begin: (tables) integers
    waves, starts,        cosine and sine of each harmonic at each stage time of its cycle of ``lengths`` steps; where
    lengths, strides,     each harmonic's begin, and the step of its cycle at which the run begins: plain arrays. Of a
    begin, far            harmonic with ``far``, whose cycle is too long for that, the table holds the turns from a step's
                          begin to its stage times and to its end; its phase is a whole number of ``lengths``-th parts of a
                          turn, and moves on by ``strides`` of them in a step (`Waves`)
    first, active,        (1) integers each
    failed
    save_every, saves,    state after every so many steps: (saves * states)
    saved
    orth_every, events,   logarithmic growth between two orthonormalisations: (events * count)
    growth
    folded, sums          (5 * (states + outputs)) reference, minimum, maximum, sum and sum of squares less reference;
                          with ``folded`` = 2 extremes between steps count too
    turns                 angle of each harmonic in one step: a plain array
    cause, reached        (1) each: why a lane failed in a step through surfaces, and the part of it that was taken
    pieces                pieces into which what a step takes beside a crossing is divided
    tally                 (2) crossings of surfaces, and grazing ones, added to what stands there
    work                  `Sizes.work` rows, used by all blocks
    ====================  =========================================================================================
    """
    one = _block(module, sizes, method, nodes, parts)
    r = Routine(module, "advance", ARGUMENTS, public=True)
    b, a = r.b, r.at
    folds = b.icmp_signed(">", a["folded"], integer(0))
    rows = {
        "y": sizes.rows(b, a["count"]), "h": integer(1), "p": integer(sizes.inputs),
        "offsets": integer(max(sizes.tables, 1)), "first": integer(1), "active": integer(1), "failed": integer(1),
        "cause": integer(1), "reached": integer(1), "tally": integer(2),
        "saved": b.mul(a["saves"], integer(sizes.states)), "growth": b.mul(a["events"], a["count"]),
        "sums": b.select(folds, integer(5 * (sizes.states + sizes.outputs)), integer(0)),
    }  # fmt: skip
    with r.loop(a["blocks"]) as block:
        moved = {name: r.row(a[name], b.mul(block, size)) for name, size in rows.items()}
        r.call(one, **{name: moved.get(name, a[name]) for name in one.at})
    r.done()


def _block(module: ir.Module, sizes: Sizes, method: Method, nodes: tuple[float, ...], parts: Parts) -> Routine:
    vectors = parts.tangent is not None or sizes.along
    turn = orthonormalise(module, sizes) if vectors else None
    fold = folding(module, sizes.states + sizes.outputs)
    r = Routine(module, "advance_block", {name: kind for name, kind in ARGUMENTS.items() if name != "blocks"})
    b, a = r.b, r.at
    stepper = Stepper(r, sizes, method, parts.rates, parts.tangent, a["work"], None if parts.through else parts.same_side)
    stepper.clear()
    count = a["count"] if vectors else integer(0)
    h = r.load(a["h"])
    counters = r.local(INT, sizes.harmonics)
    with r.loop(sizes.harmonics) as j:
        r.store(r.load(a["begin"], j), counters, j)
    on, good, now, cause = (r.local(INTS) for _ in range(4))
    part = r.local(LANE)
    asked = b.icmp_signed("!=", r.load(a["active"]), integers(0))
    later = b.and_(asked, b.icmp_signed(">", r.load(a["first"]), integers(0)))
    entry = b.select(later, r.load(a["first"]), integers(-1))
    r.store(b.sext(b.and_(asked, b.not_(later)), INTS), on)
    inputs = {name: a[name] for name in ("p", "tables", "offsets")}

    turned = r.local(DOUBLE, 2 * (len(nodes) + 1) * sizes.harmonics)  # waves of one step of far harmonics

    def waves_at(stage: int, c: Value, *, following: bool = False) -> None:
        node = nodes.index(float(method.c[stage]))
        for j in range(sizes.harmonics):
            step = r.load(counters, j)
            if following:
                step = b.add(step, integer(1))
                step = b.select(b.icmp_signed("==", step, r.load(a["lengths"], j)), integer(0), step)
            cell = b.add(b.mul(step, integer(len(nodes))), integer(node))
            near = r.row(a["waves"], b.add(r.load(a["starts"], j), b.mul(cell, integer(2))))
            own = r.row(turned, 2 * (j * (len(nodes) + 1) + (len(nodes) if following else node)))
            at = b.select(b.icmp_signed("!=", r.load(a["far"], j), integer(0)), own, near)
            for part in range(2):
                value = r.load(at, part)
                r.store(r.spread(value) if parts.through else value, c, 2 * j + part)

    rows = sizes.states * (2 if sizes.along else 1)
    if parts.through:
        angles, begin = r.local(LANE, sizes.harmonics), r.local(LANE, 2 * sizes.harmonics)
        for j in range(sizes.harmonics):
            r.store(r.spread(r.load(a["turns"], j)), angles, j)
    else:
        ends = [r.local(LANE, sizes.states) for _ in range(2)]
        spare = r.local(LANE, max(sizes.slots, sizes.states))

    def rates_at(y: Value, out: Value, *, following: bool) -> None:
        """Rates at one end of a step, for the extremes between its ends."""
        c = b.bitcast(stepper.c, parts.rates.at["c"].type)
        waves_at(0, c, following=following)
        more = {"v": y, "more": spare} if sizes.along else {"more": spare}
        r.call(parts.rates, y=y, c=c, scratch=stepper.scratch, dy=out, **more, **inputs)

    def going(n: Value) -> Value:
        waiting = b.icmp_signed(">=", entry, r.spread(n))
        return r.any(b.or_(b.icmp_signed("!=", r.load(on), integers(0)), waiting))

    with r.loop(a["steps"], going=going) as n:
        here = r.spread(n)
        running = b.or_(r.load(on), b.sext(b.icmp_signed("==", entry, here), INTS))
        with b.if_then(r.any(b.icmp_signed("!=", running, integers(0)))):  # no step where all lanes wait
            for j in range(sizes.harmonics):
                with b.if_then(b.icmp_signed("!=", r.load(a["far"], j), integer(0)), likely=False):
                    steps_on = r.row(a["waves"], r.load(a["starts"], j))
                    phase, whole = r.load(counters, j), r.load(a["lengths"], j)
                    turn_on(r, phase, whole, steps_on, r.row(turned, 2 * j * (len(nodes) + 1)), len(nodes) + 1)
            if parts.through:
                waves_at(0, begin)
                r.store(running, now)
                step = {name: a[name] for name in ("count", "y", "h", "tally", "folded", "sums", "pieces", "work")}
                r.call(parts.through, c=begin, turn=angles, active=now, cause=cause, reached=part, **step, **inputs)
                well = b.icmp_signed("==", r.load(cause), integers(0))
            else:
                x = stepper.step(a["y"], h, inputs, waves_at)
                r.call(parts.examine, y=x, p=a["p"], good=good)
                stepper.within(good)
                well = b.icmp_signed("!=", r.load(good), integers(0))
            truth = b.and_(b.icmp_signed("!=", running, integers(0)), b.not_(well))
            r.store(b.select(truth, here, r.load(a["failed"])), a["failed"])
            if parts.through:
                r.store(b.select(truth, r.load(cause), r.load(a["cause"])), a["cause"])
                r.store(b.select(truth, r.load(part), r.load(a["reached"])), a["reached"])
            running = b.and_(running, b.sext(well, INTS))
            r.store(running, on)
            runs = b.icmp_signed("!=", running, integers(0))
            if not parts.through:
                with b.if_then(b.icmp_signed("==", a["folded"], integer(2)), likely=False):
                    rates_at(a["y"], ends[0], following=False)
                    rates_at(x, ends[1], following=True)
                    parts.between.write(r, a["y"], ends[0], x, ends[1], a["h"], a["p"], a["sums"], on)
                stepper.replace(a["y"], x, rows, runs)
                stepper.vectors(a["y"], h, a["p"], count, runs)
            done = b.add(n, integer(1))
            if turn:
                due = b.icmp_signed("==", b.srem(done, a["orth_every"]), integer(0))
                with b.if_then(b.and_(due, b.icmp_signed(">", count, integer(0)))):
                    event = b.sub(b.sdiv(done, a["orth_every"]), integer(1))
                    with b.if_then(b.icmp_signed("<", event, a["events"])):
                        growth = r.row(a["growth"], b.mul(event, count))
                        r.call(turn, y=a["y"], p=a["p"], count=count, growth=growth, active=on)
            with b.if_then(b.icmp_signed("!=", a["folded"], integer(0))):
                r.call(parts.observed, y=a["y"], p=a["p"], o=stepper.o)
                for values, before, size in ((a["y"], 0, sizes.states), (stepper.o, sizes.states, sizes.outputs)):
                    r.call(fold, v=values, sums=r.row(a["sums"], before), rows=integer(size), active=on)
            with b.if_then(b.icmp_signed("==", b.srem(done, a["save_every"]), integer(0))):
                at = b.sub(b.sdiv(done, a["save_every"]), integer(1))
                with b.if_then(b.icmp_signed("<", at, a["saves"])):
                    place = r.row(a["saved"], b.mul(at, integer(sizes.states)))
                    with r.loop(sizes.states) as i:
                        r.store(b.select(runs, r.load(a["y"], i), r.load(place, i)), place, i)
        with r.loop(sizes.harmonics) as j:
            following = b.add(r.load(counters, j), r.load(a["strides"], j))
            whole = r.load(a["lengths"], j)
            r.store(b.select(b.icmp_signed(">=", following, whole), b.sub(following, whole), following), counters, j)
    r.done()
    return r


def turn_on(r: Routine, phase: Value, whole: Value, by: Value, out: Value, count: int) -> None:
    """Write cosines and sines of a phase, ``phase`` parts of ``whole`` in a turn, turned on by ``count`` known angles.

    ``by`` holds the cosine and the sine of each angle. The phase is exact, so that nothing is lost however long a run is.
    """
    b = r.b
    angle = b.fmul(b.fdiv(b.sitofp(phase, DOUBLE), b.sitofp(whole, DOUBLE)), DOUBLE(2 * pi))
    c, s = (b.call(r.library(name), [angle]) for name in ("cos", "sin"))
    with r.loop(count) as k:
        at = b.mul(k, integer(2))
        u, v = r.load(by, at), r.load(by, b.add(at, integer(1)))
        r.store(b.fsub(b.fmul(c, u), b.fmul(s, v)), out, at)
        r.store(b.fadd(b.fmul(s, u), b.fmul(c, v)), out, b.add(at, integer(1)))


def orthonormalise(module: ir.Module, sizes: Sizes) -> Routine:
    """Write modified Gram-Schmidt on the tangent vectors of active lanes; their lengths' logarithms go to ``growth``.

    A lane that waits for its step to be redone keeps its vectors, and with them the growth since they were of length one.
    Products of vectors are sums over states in units of their sizes, whose reciprocal squares are the last rows of ``p``.
    """
    arguments: dict[str, Kind] = {"y": "rows", "p": "rows", "count": "int", "growth": "rows", "active": "flags"}
    r = Routine(module, "orthonormalise", arguments)
    states = sizes.states
    b, a = r.b, r.at
    total, weights = r.local(number(0.0).type), r.row(a["p"], integer(sizes.inputs - states))
    runs = b.icmp_signed("!=", r.load(a["active"]), integers(0))

    def vector(index: Value) -> Value:
        return r.row(a["y"], b.mul(b.add(index, integer(1)), integer(states)))

    def product(one: Value, other: Value) -> Value:
        r.store(number(0.0), total)
        with r.loop(states) as i:
            weighted = r.mul(r.load(weights, i), r.load(one, i))
            r.store(r.add(r.load(total), r.mul(weighted, r.load(other, i))), total)
        return r.load(total)

    with r.loop(a["count"]) as v:
        this = vector(v)
        length = b.select(runs, r.root(product(this, this)), number(1.0))
        r.store(r.add(r.load(a["growth"], v), r.per_lane("log", length)), a["growth"], v)
        shrink = r.div(number(1.0), length)
        with r.loop(states) as i:
            r.store(r.mul(r.load(this, i), shrink), this, i)
        with r.loop(b.sub(b.sub(a["count"], v), integer(1))) as later:  # they do not wait for each other
            other = vector(b.add(b.add(v, integer(1)), later))
            along = product(other, this)
            with r.loop(states) as i:
                less = r.sub(r.load(other, i), r.mul(along, r.load(this, i)))
                r.store(b.select(runs, less, r.load(other, i)), other, i)
    r.done()
    return r


def folding(module: ir.Module, rows: int) -> Routine:
    """Write ``fold``: rows of one step into the running minimum, maximum, sum and sum of squares of active lanes."""
    r = Routine(module, "fold", {"v": "rows", "sums": "rows", "rows": "int", "active": "flags"})
    b, a = r.b, r.at
    runs = b.icmp_signed("!=", r.load(a["active"]), integers(0))
    with r.loop(a["rows"]) as i:
        value = r.load(a["v"], i)
        away = b.select(runs, r.sub(value, r.load(a["sums"], i)), number(0.0))

        def part(k: int, i: Value = i) -> Value:
            return b.add(i, integer(k * rows))

        for k, smaller in ((1, True), (2, False)):
            old = r.load(a["sums"], part(k))
            beyond = r.less(value, old) if smaller else r.less(old, value)
            r.store(b.select(b.and_(runs, beyond), value, old), a["sums"], part(k))
        r.store(r.add(r.load(a["sums"], part(3)), away), a["sums"], part(3))
        r.store(r.add(r.load(a["sums"], part(4)), r.mul(away, away)), a["sums"], part(4))
    r.done()
    return r
