"""``advance``: many steps of many blocks, locked to the forcing's phase. All long runs are made of it.

Lanes of a block share nothing but the instructions: each has its own steps per T, its own phase, its own run, and saves and
orthonormalises after its own numbers of steps. A block takes as long as its longest run.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from llvmlite import ir

from whirlmap.kernels.methods import Method
from whirlmap.kernels.writing.hermite import Between
from whirlmap.kernels.writing.routine import INTS, LANE, Kind, Routine, Value, integer, integers, number
from whirlmap.kernels.writing.stage_harmonics import StageHarmonics
from whirlmap.kernels.writing.stepping import Sizes, Stepper

#: Arguments of ``advance``, arrays of consecutive blocks: see `advance`.
ARGUMENTS: dict[str, Kind] = {
    "blocks": "int", "count": "int", "y": "rows", "h": "rows", "p": "rows", "tables": "doubles", "offsets": "flags",
    "waves": "doubles", "starts": "flags", "lengths": "flags", "strides": "flags", "far": "flags", "turns": "rows",
    "begin": "flags", "first": "flags", "last": "flags", "active": "flags", "failed": "flags", "save_every": "flags",
    "saves": "int", "saved": "rows", "orth_every": "flags", "events": "int", "growth": "rows", "folded": "int",
    "sums": "rows", "cause": "flags", "reached": "rows", "tally": "rows", "pieces": "flags", "work": "rows",
}  # fmt: skip

#: Steps of one call at most; no run reaches them.
MOST_STEPS = 1 << 62


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
    or at something that is not a number; ``failed`` then holds that step's index. Lane ``l`` takes the steps of its run from
    ``first[l]`` to before ``last[l]``.

    Arguments of the kernel, rows of `LANES` numbers, one block after the other:

    ====================  =========================================================================================
    blocks, count         number of blocks, and of tangent vectors
    y                     (states * (1 + count) + surfaces) state, tangent vectors and sides, in place
    h                     (1) step of each lane
    p                     (inputs) hoisted parameters, reciprocal limits, weights of tangent vectors
    tables, offsets       table entries, and where each lane's begin: (tables) integers
    waves                 cosine and sine of harmonics at each stage time of their cycles: a plain array
    starts, lengths,      (harmonics) integers each: where the table of each harmonic begins, steps of its cycle, and the
    strides, begin, far   step of it at ``first``. Of a harmonic with ``far``, whose cycle is too long for that, the table
                          holds the turns from a step's begin to its stage times and to its end; its phase is a whole number
                          of ``lengths``-th parts of a turn, and moves on by ``strides`` of them in a step (`HarmonicTables`)
    turns                 (harmonics) angle of each harmonic in one step
    first, last,          (1) integers each
    active, failed
    save_every, saves,    state after every ``save_every`` (1) steps of the run: (saves * states)
    saved
    orth_every, events,   logarithmic growth between two orthonormalisations, ``orth_every`` (1) steps apart:
    growth                (events * count)
    folded, sums          (5 * (states + outputs)) reference, minimum, maximum, sum and sum of squares less reference;
                          with ``folded`` = 2 extremes between steps count too
    cause, reached        (1) each: why a lane failed in a step through surfaces, and the part of it that was taken
    pieces                (1) pieces into which what a step takes beside a crossing is divided
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
        "offsets": integer(max(sizes.tables, 1)), "tally": integer(2),
        **dict.fromkeys(("starts", "lengths", "strides", "far", "turns", "begin"), integer(sizes.harmonics)),
        **dict.fromkeys(("first", "last", "active", "failed", "save_every", "orth_every"), integer(1)),
        **dict.fromkeys(("cause", "reached", "pieces"), integer(1)),
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
    same_side = None if parts.through else parts.same_side
    stepper = Stepper(r, sizes, method, parts.rates, parts.tangent, a["work"], same_side)
    stepper.clear()
    count = a["count"] if vectors else integer(0)
    h, first, last = r.load(a["h"]), r.load(a["first"]), r.load(a["last"])
    asked = b.icmp_signed("!=", r.load(a["active"]), integers(0))
    waves = StageHarmonics(r, sizes, len(nodes), asked, only_begin=parts.through is not None)
    on, good, cause = (r.local(INTS) for _ in range(3))
    part = r.local(LANE)
    r.store(b.sext(asked, INTS), on)
    inputs = {name: a[name] for name in ("p", "tables", "offsets")}
    saving, turning = (Every(r, first, r.load(a[name])) for name in ("save_every", "orth_every"))
    growth = r.local(LANE, sizes.states)

    rows = sizes.states * (2 if sizes.along else 1)
    if not parts.through:
        ends = [r.local(LANE, sizes.states) for _ in range(2)]
        spare = r.local(LANE, max(sizes.slots, sizes.states))

    def rates_at(y: Value, out: Value, node: int) -> None:
        """Rates at one end of a step, for the extremes between its ends."""
        more = {"v": y, "more": spare} if sizes.along else {"more": spare}
        r.call(parts.rates, y=y, c=waves.at(node), scratch=stepper.scratch, dy=out, **more, **inputs)

    def running(n: Value) -> Value:
        going = b.icmp_signed("<", b.add(first, r.spread(n)), last)
        return b.and_(going, b.icmp_signed("!=", r.load(on), integers(0)))

    with r.loop(MOST_STEPS, going=lambda n: r.any(running(n))) as n:
        here = b.add(first, r.spread(n))
        runs = running(n)
        r.store(b.sext(runs, INTS), on)
        waves.begin_step(on)
        if parts.through:
            step = {name: a[name] for name in ("count", "y", "h", "tally", "folded", "sums", "pieces", "work")}
            r.call(parts.through, c=waves.at(0), turn=a["turns"], active=on, cause=cause, reached=part, **step, **inputs)
            well = b.icmp_signed("==", r.load(cause), integers(0))
        else:
            x = stepper.step(a["y"], h, inputs, lambda stage: waves.at(nodes.index(float(method.c[stage]))))
            r.call(parts.examine, y=x, p=a["p"], good=good)
            stepper.within(good)
            well = b.icmp_signed("!=", r.load(good), integers(0))
        truth = b.and_(runs, b.not_(well))
        r.store(b.select(truth, here, r.load(a["failed"])), a["failed"])
        if parts.through:
            r.store(b.select(truth, r.load(cause), r.load(a["cause"])), a["cause"])
            r.store(b.select(truth, r.load(part), r.load(a["reached"])), a["reached"])
        runs = b.and_(runs, well)
        r.store(b.sext(runs, INTS), on)
        if not parts.through:
            with b.if_then(b.icmp_signed("==", a["folded"], integer(2)), likely=False):
                rates_at(a["y"], ends[0], 0)
                rates_at(x, ends[1], len(nodes))
                parts.between.write(r, a["y"], ends[0], x, ends[1], a["h"], a["p"], a["sums"], on)
            stepper.replace(a["y"], x, rows, runs)
            stepper.vectors(a["y"], h, a["p"], count, runs)
        done = b.add(here, integers(1))
        if turn:
            with turning.due(done, runs) as (due, index):
                r.store(b.sext(due, INTS), good)
                r.call(turn, y=a["y"], p=a["p"], count=count, growth=growth, active=good)
                with r.together(due, index) as ((event,), same):
                    place = r.row(a["growth"], b.mul(event, count))
                    with r.loop(count) as v:
                        r.store(b.select(same, r.load(growth, v), r.load(place, v)), place, v)
        with b.if_then(b.icmp_signed("!=", a["folded"], integer(0))):
            r.call(parts.observed, y=a["y"], p=a["p"], o=stepper.o)
            for values, before, size in ((a["y"], 0, sizes.states), (stepper.o, sizes.states, sizes.outputs)):
                r.call(fold, v=values, sums=r.row(a["sums"], before), rows=integer(size), active=on)
        with saving.due(done, runs) as (due, index), r.together(due, index) as ((at,), same):
            place = r.row(a["saved"], b.mul(at, integer(sizes.states)))
            with r.loop(sizes.states) as i:
                r.store(b.select(same, r.load(a["y"], i), r.load(place, i)), place, i)
        waves.end_step()
    r.done()
    return r


class Every:
    """What each lane does after every so many of its own steps.

    Parameters
    ----------
    r : Routine
    first : Value
        Steps that each lane has taken before.
    every : Value
        Steps between two times.
    """

    def __init__(self, r: Routine, first: Value, every: Value) -> None:
        self.r, self.every = r, every
        self.index, self.next = r.local(INTS), r.local(INTS)
        index = r.b.sdiv(first, every)
        r.store(index, self.index)
        r.store(r.b.mul(r.b.add(index, integers(1)), every), self.next)

    @contextmanager
    def due(self, done: Value, runs: Value) -> Iterator[tuple[Value, Value]]:
        """Where any lane has come to a time: those of ``runs`` that have, and how many times each has come before."""
        r, b = self.r, self.r.b
        now = b.icmp_signed("==", done, r.load(self.next))
        with b.if_then(r.any(now)):
            index = r.load(self.index)
            yield b.and_(now, runs), index
            r.store(b.select(now, b.add(index, integers(1)), index), self.index)
            r.store(b.select(now, b.add(done, self.every), r.load(self.next)), self.next)


def orthonormalise(module: ir.Module, sizes: Sizes) -> Routine:
    """Write modified Gram-Schmidt on the tangent vectors of active lanes; their lengths' logarithms go to ``growth``.

    Other lanes keep theirs.
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
        r.store(r.per_lane("log", length), a["growth"], v)
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
