"""The parts of a kernel that a model decides: rates with their Jacobian, outputs, the test of a step's end, harmonics."""

from collections.abc import Collection, Iterable, Sequence
from functools import reduce
from typing import Literal

from llvmlite import ir
from sympy import Expr, Symbol

from whirlmap.equations.model import Model
from whirlmap.equations.quantities import State
from whirlmap.kernels.lowering.differentiate import Entries, Forms
from whirlmap.kernels.lowering.lower import Hoisted, Read, Straight, local_name
from whirlmap.kernels.lowering.surfaces import side_name
from whirlmap.kernels.writing.roots import Roots
from whirlmap.kernels.writing.routine import Kind, Routine, Value, integers, number
from whirlmap.kernels.writing.sines import Sines
from whirlmap.kernels.writing.table_cells import TableReadings, fetch
from whirlmap.kernels.writing.vector import VectorCode

#: How time is known: by the steps since phase zero, whole parts of T, or as a number.
Time = Literal["locked", "free"]
#: Which derivatives a kernel computes beside the rates: none, a Jacobian-vector product, or the Jacobian.
Slopes = Literal["none", "along", "jacobian"]


def direction_name(state: State) -> str:
    """Name of the component of a tangent vector that belongs to a state."""
    return f"{state.name}_t"


class ModelRoutines:
    """Writes the routines of one model into a module.

    Parameters
    ----------
    module : ir.Module
    model : Model
    hoisted : Hoisted
        Inputs of the kernel; their order is that of its rows ``p``.
    roots, sines : Roots, Sines
        How these functions are computed.
    """

    def __init__(self, module: ir.Module, model: Model, hoisted: Hoisted, roots: Roots, sines: Sines) -> None:
        self.module, self.model, self.hoisted = module, model, hoisted
        self.roots, self.sines = roots, sines
        self.readings = TableReadings(model.tables)
        self.fetch = fetch(module) if model.tables else None
        self.surfaces = 0

    def rates(
        self, lines: Straight, rows: Sequence[int] = (), *, along: bool = False, unwanted: Collection[int] = ()
    ) -> Routine:
        """Write ``rates``: the results of straight-line code, those of the states, then ``more``.

        These are the Jacobian's moving entries, or with ``along`` the derivatives along the vector ``v``, but for those of
        the ``unwanted`` states; ``rows`` says of which state each of them is. What is of one state is written together, and
        all that it needs not before: LLVM keeps the order, and finds registers for half of what went to the stack.
        """
        n = self.model.dimension
        kinds: dict[str, Kind] = {"y": "rows", "c": "rows", "p": "rows", "tables": "doubles", "offsets": "flags"}
        kinds |= {"scratch": "rows", "dy": "rows", "more": "rows"}
        kinds |= {"v": "rows"} if along else {}
        kinds |= {"modes": "rows"} if self.surfaces else {}
        self.kinds = kinds
        r = Routine(self.module, "rates", kinds)
        code = self._code(r, lines.names())
        reads = [step for step in lines.steps if isinstance(step, Read)]
        before, after = split(lines)
        for symbol, e in before:
            code.names[symbol.name] = code.value(e)
        assert not reads or self.fetch
        for read in reads:
            place = self.readings.of(read)
            place.examine(r, [code.names[z.name] for z in read.coordinates], self.fetch)  # type: ignore[arg-type]
        if reads:
            code.names |= self._inputs(r, lines.names())
        pending: dict[Symbol, Expr | Read] = {output[2]: read for read in reads for output in read.outputs}
        pending |= dict(after)

        def value(e: Expr) -> Value:
            for symbol in sorted(e.free_symbols & pending.keys(), key=str):
                if symbol in pending:  # else it came with another output of its table
                    source = pending.pop(symbol)
                    if isinstance(source, Read):
                        code.names |= self.readings.of(source).polynomials(r, source)
                        for output in source.outputs:
                            pending.pop(output[2], None)
                    else:
                        code.names[symbol.name] = value(source)
            return code.value(e)

        for symbol in [] if rows else list(pending):
            value(symbol)
        for i in sorted(range(len(lines.results)), key=lambda i: (*range(n), *rows)[i]):
            if not (along and i - n in unwanted):
                r.store(value(lines.results[i]), r.at["dy"] if i < n else r.at["more"], i if i < n else i - n)
        r.done()
        return r

    def tangent(
        self, entries: Entries, slots: dict[tuple[int, Symbol], int], forms: Forms, unwanted: Collection[int]
    ) -> Routine:
        """Write ``tangent``: the Jacobian but for ``unwanted`` rows, times one vector.

        Entries without a slot are inputs or numbers.

        It is copied into the steps, where the next stage takes the slopes from registers.
        """
        r = Routine(self.module, "tangent", {"y": "rows", "jac": "rows", "p": "rows", "dy": "rows"}, copied=True)
        inputs = {q: i for i, q in enumerate(self.hoisted.symbols)}
        names = [Symbol(local_name(s), real=True) for s in self.model.states]
        vector = {name: r.load(r.at["y"], j) for j, name in enumerate(names)}

        def weighted(terms: Iterable[tuple[Value, Value]]) -> Value:
            products = [r.mul(factor, value) for factor, value in terms]
            return reduce(r.add, products) if products else number(0.0)

        def fixed(e: Expr) -> Value:
            return r.load(r.at["p"], inputs[e]) if e in inputs else number(float(e))

        for seed, weights in forms.items():
            vector[seed] = weighted((fixed(weights[name]), vector[name]) for name in names if name in weights)
        for i in set(range(self.model.dimension)) - set(unwanted):
            terms = []
            for (row, seed), e in entries.items():
                if row == i:
                    factor = r.load(r.at["jac"], slots[row, seed]) if (row, seed) in slots else fixed(e)
                    terms.append((factor, vector[seed]))
            r.store(weighted(terms), r.at["dy"], i)
        r.done()
        return r

    def observed(self, lines: Straight) -> Routine:
        """Write ``observed``: the model's outputs."""
        r = Routine(self.module, "observed", {"y": "rows", "p": "rows", "o": "rows"})
        for i, value in enumerate(self._results(r, lines)):
            r.store(value, r.at["o"], i)
        r.done()
        return r

    def examine(self, lines: Straight) -> Routine:
        """Write ``examine``: whether every gap is open, every state finite and (but for angles) in bounds, as -1 or 0.

        States are summed in units of their limits, whose reciprocals stand behind the parameters.
        """
        r = Routine(self.module, "examine", {"y": "rows", "p": "rows", "good": "flags"})
        size, cyclic = number(0.0), []
        for i, s in enumerate(self.model.states):
            value = r.absolute(r.load(r.at["y"], i))
            if s.cyclic is None:
                size = r.add(size, r.mul(value, r.load(r.at["p"], len(self.hoisted.symbols) + i)))
            else:
                cyclic.append(r.less(value, number(float("inf"))))
        good = r.less(size, number(1.0))
        for finite in cyclic:
            good = r.b.and_(good, finite)
        for gap in self._results(r, lines):
            good = r.b.and_(good, r.less(number(0.0), gap))
        r.store(r.b.sext(good, r.at["good"].type.pointee), r.at["good"])
        r.done()
        return r

    def same_side(self, lines: Straight) -> Routine:
        """Write ``same_side``: clear ``good`` in every lane in which one of these expressions (`poles`) changes sign."""
        r = Routine(self.module, "same_side", {"before": "rows", "y": "rows", "p": "rows", "good": "flags"})
        begin, end = self._results(r, lines, states="before"), self._results(r, lines)
        good = r.b.icmp_signed("!=", r.load(r.at["good"]), integers(0))
        for old, new in zip(begin, end, strict=True):
            # Signs, not their product: that of two small numbers is zero.
            for one, other in ((old, new), (new, old)):
                wrong = r.b.and_(r.less(one, number(0.0)), r.b.not_(r.less(other, number(0.0))))
                good = r.b.and_(good, r.b.not_(wrong))
            good = r.b.and_(good, r.b.fcmp_ordered("!=", new, number(0.0)))
        r.store(r.b.sext(good, r.at["good"].type.pointee), r.at["good"])
        r.done()
        return r

    def phases(self, frequencies: Straight) -> Routine:
        """Write ``phases``: cosine and sine of every harmonic, each lane at its own time since its ``origin`` of angles."""
        r = Routine(self.module, "phases", {"time": "rows", "origin": "rows", "p": "rows", "c": "rows"})
        for i, frequency in enumerate(self._results(r, frequencies)):
            angle = r.add(r.load(r.at["origin"], i), r.mul(frequency, r.load(r.at["time"])))
            sine, cosine = self.sines.pair(r, angle)
            r.store(cosine, r.at["c"], 2 * i)
            r.store(sine, r.at["c"], 2 * i + 1)
        r.done()
        return r

    def observed_along(self, lines: Straight) -> Routine:
        """Write ``observed_along``: the model's outputs, and their rates along the vector ``v``."""
        r = Routine(self.module, "observed_along", {"y": "rows", "p": "rows", "v": "rows", "o": "rows", "rate": "rows"})
        self._store(r, self._results(r, lines), "o", "rate")
        return r

    def guards(self, lines: Straight, frequencies: Straight, name: str = "guards") -> Routine:
        """Write ``guards``: value of each surface, and its rate along the vector ``v`` and, times ``clock``, with time."""
        names: tuple[str, ...] = ("y", "c", "p", "modes", "v", "clock", "g", "rate")
        kinds: dict[str, Kind] = dict.fromkeys(names, "rows")
        r = Routine(self.module, name, kinds)
        clock = r.load(r.at["clock"])
        waves: dict[str, Value] = {}
        for i, frequency in enumerate(self._results(r, frequencies)):
            c, s = r.load(r.at["c"], 2 * i), r.load(r.at["c"], 2 * i + 1)
            turn = r.mul(clock, frequency)
            waves |= {f"c{i}_dt": r.sub(number(0.0), r.mul(turn, s)), f"s{i}_dt": r.mul(turn, c)}
        self._store(r, self._results(r, lines, waves), "g", "rate")
        return r

    def sides(self, lines: Straight) -> Routine:
        """Write ``sides``: the sign of each surface; zero on it."""
        r = Routine(self.module, "sides", {"y": "rows", "c": "rows", "p": "rows", "modes": "rows"})
        code = self._code(r, lines.names())
        pending = dict(split(lines)[0])

        def value(e: Expr) -> Value:
            for symbol in sorted(e.free_symbols & pending.keys(), key=str):
                if symbol in pending:
                    code.names[symbol.name] = value(pending.pop(symbol))
            return code.value(e)

        for k, surface in enumerate(lines.results):  # a surface may be made of the sides of earlier ones
            g = value(surface)
            below = r.b.select(r.less(g, number(0.0)), number(-1.0), number(0.0))
            code.names[side_name(k)] = r.b.select(r.less(number(0.0), g), number(1.0), below)
            r.store(code.names[side_name(k)], r.at["modes"], k)
        r.done()
        return r

    def turns(self, frequencies: Straight) -> Routine:
        """Write ``turns``: angle of every harmonic in the time ``h``."""
        r = Routine(self.module, "turns", {"h": "rows", "p": "rows", "turn": "rows"})
        for i, frequency in enumerate(self._results(r, frequencies)):
            r.store(r.mul(frequency, r.load(r.at["h"])), r.at["turn"], i)
        r.done()
        return r

    def harmonics(self, count: int) -> Routine:
        """Write ``harmonics``: cosine and sine of every harmonic, advanced by a ``part`` of the angle ``turn``."""
        r = Routine(self.module, "harmonics", dict.fromkeys(("c", "turn", "part", "out"), "rows"))
        for i in range(count):
            sine, cosine = self.sines.pair(r, r.mul(r.load(r.at["turn"], i), r.load(r.at["part"])))
            c, s = r.load(r.at["c"], 2 * i), r.load(r.at["c"], 2 * i + 1)
            r.store(r.sub(r.mul(c, cosine), r.mul(s, sine)), r.at["out"], 2 * i)
            r.store(r.add(r.mul(s, cosine), r.mul(c, sine)), r.at["out"], 2 * i + 1)
        r.done()
        return r

    @staticmethod
    def _store(r: Routine, values: Sequence[Value], *rows: str) -> None:
        """Store results into equally long arrays, one after the other, and end the routine."""
        each = len(values) // len(rows)
        for i, value in enumerate(values):
            r.store(value, r.at[rows[i // each]], i % each)
        r.done()

    def _results(
        self, r: Routine, lines: Straight, known: dict[str, Value] | None = None, states: str = "y"
    ) -> Sequence[Value]:
        code = self._code(r, lines.names(), states)
        code.names |= known or {}
        for symbol, e in split(lines)[0]:
            code.names[symbol.name] = code.value(e)
        return [code.value(e) for e in lines.results]

    def _code(self, r: Routine, names: set[str], states: str = "y") -> VectorCode:
        return VectorCode(r, self._inputs(r, names, states), self.roots, self.sines)

    def _inputs(self, r: Routine, names: set[str], states: str = "y") -> dict[str, Value]:
        """Values of the named inputs of a routine."""
        known = {
            local_name(s): r.load(r.at[states], i) for i, s in enumerate(self.model.states) if local_name(s) in names
        }  # fmt: skip
        if "v" in r.at:
            directions = {direction_name(s): i for i, s in enumerate(self.model.states)}
            known |= {name: r.load(r.at["v"], i) for name, i in directions.items() if name in names}
        known |= {q.name: r.load(r.at["p"], i) for i, q in enumerate(self.hoisted.symbols) if q.name in names}
        if "modes" in r.at:
            known |= {side_name(k): r.load(r.at["modes"], k) for k in range(self.surfaces) if side_name(k) in names}
        for i in range(len(self.model.harmonics) if "c" in r.at else 0):
            for part, kind in enumerate("cs"):
                if f"{kind}{i}" in names:
                    known[f"{kind}{i}"] = r.load(r.at["c"], 2 * i + part)
        return known


def split(lines: Straight) -> tuple[list[tuple[Symbol, Expr]], list[tuple[Symbol, Expr]]]:
    """Assignments that the coordinates of tables need (all of them where no table is read), and the others."""
    steps = [step for step in lines.steps if not isinstance(step, Read)]
    reads = [step for step in lines.steps if isinstance(step, Read)]
    if not reads:
        return steps, []
    needed = {c for read in reads for c in read.coordinates}
    for symbol, e in reversed(steps):
        if symbol in needed:
            needed |= e.free_symbols
    return [s for s in steps if s[0] in needed], [s for s in steps if s[0] not in needed]


