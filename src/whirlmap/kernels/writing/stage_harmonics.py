"""Cosines and sines of the harmonics at the stage times of a step; each lane has its own phase and its own steps per T.

Where all lanes that run in a block take the same steps from the same phase, each stage reads its numbers once and spreads
them over the lanes. Where they do not, a step first writes rows for all of its stages; lanes that read the same row of a
table are served together. Both give the rates the same rows: the bits of a lane do not depend on its block. Which of the two
is taken is decided for each block in each call (`StageHarmonics.own`).
"""

from math import pi

from llvmlite import ir

from whirlmap.kernels.writing.routine import DOUBLE, INT, INTS, LANE, Kind, Routine, Value, integer, integers, number
from whirlmap.kernels.writing.stepping import Sizes

#: Arguments of ``own_harmonics``: rows for each harmonic (`advancing.advance`), and their phases in place.
ARGUMENTS: dict[str, Kind] = {
    "waves": "doubles", "starts": "flags", "lengths": "flags", "strides": "flags", "far": "flags", "phase": "flags",
    "active": "flags", "out": "rows",
}  # fmt: skip
TABLES = ("starts", "lengths", "strides", "far")


class StageHarmonics:
    """Writes the reading of harmonics into a routine that has the arguments of ``advance``.

    Parameters
    ----------
    r : Routine
    sizes : Sizes
    nodes : int
        Distinct stage times.
    asked : Value
        Lanes that run; where there are none, nothing that is read is used.
    only_begin : bool
        Whether harmonics are asked only at the begin of a step.

    Attributes
    ----------
    own : Value
        Whether lanes have harmonics of their own: take other steps than the first one that runs, or from another phase.
    """

    def __init__(self, r: Routine, sizes: Sizes, nodes: int, asked: Value, *, only_begin: bool) -> None:
        b, a, count = r.b, r.at, sizes.harmonics
        self.r, self.count, self.nodes = r, count, nodes
        rows = 2 * count * (1 if only_begin else nodes + 1)
        self.stage, self.out = r.local(LANE, 2 * count), r.local(LANE, rows)
        self.routine = _own_harmonics(r.module, count, nodes, only_begin=only_begin) if count else None
        self.turned = r.local(DOUBLE, 2 * (nodes + 1) * count)
        self.counters, self.phase = r.local(INT, count), r.local(INTS, count)
        lane, own = r.first(asked), b.icmp_signed("<", integer(1), integer(0))
        self.of_all = []  # tables of the lanes where they share them
        for j in range(count):
            _, same = r.alike(asked, r.load(a["starts"], j), r.load(a["begin"], j))
            own = b.or_(own, r.any(b.and_(asked, b.not_(same))))
            self.of_all.append({name: b.load(r.lane(a[name], j, lane), align=8) for name in TABLES})
            r.store(b.load(r.lane(a["begin"], j, lane), align=8), self.counters, j)
            r.store(r.load(a["begin"], j), self.phase, j)
        self.own = own
        # Lanes that never run have their rates worked out too. What lies in memory by chance may be subnormal numbers, with
        # which every operation takes a hundred times as long.
        with b.if_then(own, likely=False), r.loop(rows) as i:
            r.store(number(0.0), self.out, i)

    def begin_step(self, active: Value) -> None:
        """Write what is needed at the begin of a step of active lanes, at least one."""
        r, b, a = self.r, self.r.b, self.r.at
        if self.routine is None:
            return
        with b.if_then(self.own, likely=False):
            tables = {name: a[name] for name in ("waves", *TABLES)}
            r.call(self.routine, **tables, phase=self.phase, active=active, out=self.out)
        for j, of in enumerate(self.of_all):
            with b.if_then(b.icmp_signed("!=", of["far"], integer(0)), likely=False):
                phase, table = r.load(self.counters, j), r.row(a["waves"], of["starts"])
                turn_on(r, phase, of["lengths"], table, self._turned(j, 0), self.nodes + 1)

    def at(self, node: int) -> Value:
        """Write the rows of a stage time, and give their place. Behind the last stage time is the end of the step."""
        r, b = self.r, self.r.b
        for j in range(self.count):
            for part in range(2):
                r.store(r.spread(r.load(self._of_all(j, node), part)), self.stage, 2 * j + part)
        return b.select(self.own, r.row(self.out, 2 * self.count * node), self.stage)

    def end_step(self) -> None:
        """Go on to the next step, where lanes share their harmonics."""
        r = self.r
        for j, of in enumerate(self.of_all):
            r.store(moved(r, r.load(self.counters, j), of["strides"], of["lengths"]), self.counters, j)

    def _turned(self, j: int, node: int) -> Value:
        return self.r.row(self.turned, 2 * (j * (self.nodes + 1) + node))

    def _of_all(self, j: int, node: int) -> Value:
        """Cosine and sine of a harmonic at a stage time, of all lanes."""
        r, b, of = self.r, self.r.b, self.of_all[j]
        cell = b.add(b.mul(r.load(self.counters, j), integer(self.nodes)), integer(node))
        near = r.row(r.at["waves"], b.add(of["starts"], b.mul(cell, integer(2))))
        return b.select(b.icmp_signed("!=", of["far"], integer(0)), self._turned(j, node), near)


def _own_harmonics(module: ir.Module, count: int, nodes: int, *, only_begin: bool) -> Routine:
    """Write ``own_harmonics``: rows of all stage times of a step and of its end, or of its begin alone; phases move on."""
    r = Routine(module, "own_harmonics", ARGUMENTS)
    b, a = r.b, r.at
    turned = r.local(DOUBLE, 2 * (nodes + 1))
    active = b.icmp_signed("!=", r.load(a["active"]), integers(0))
    written = range(1 if only_begin else nodes + 1)
    with r.loop(count) as j:
        starts, lengths, strides, far, phase = (r.load(a[name], j) for name in (*TABLES, "phase"))
        with r.together(active, starts, lengths, far, phase) as ((start, length, is_far, now), lanes):
            table, counted = r.row(a["waves"], start), b.icmp_signed("!=", is_far, integer(0))
            with b.if_then(counted, likely=False):
                turn_on(r, now, length, table, turned, nodes + 1)
            at = b.select(counted, turned, r.row(table, b.mul(now, integer(2 * nodes))))
            for node in written:
                for part in range(2):
                    place = b.add(b.mul(j, integer(2)), integer(2 * node * count + part))
                    value = r.spread(r.load(at, 2 * node + part))
                    r.store(b.select(lanes, value, r.load(a["out"], place)), a["out"], place)
        r.store(moved(r, phase, strides, lengths), a["phase"], j)
    r.done()
    return r


def moved(r: Routine, phase: Value, stride: Value, whole: Value) -> Value:
    """Phase of a cycle one step later."""
    following = r.b.add(phase, stride)
    return r.b.select(r.b.icmp_signed(">=", following, whole), r.b.sub(following, whole), following)


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
