"""Table readings: the record of the cell that each lane is in, kept in scratch, and the polynomials in it.

Every reading has rows of scratch of its own, which stay from one stage to the next: the lane's coordinates, and the record
of its cell (edges, centre, coefficients). Reading a table through an index would cost more than the polynomial that it
serves. A lane leaves its cell in about one step of a hundred, and only then fetches another record.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from llvmlite import ir
from sympy import Symbol

from whirlmap.equations.pieces import Table
from whirlmap.kernels.lowering.lower import Read
from whirlmap.kernels.lowering.tabulate import EDGES
from whirlmap.kernels.writing.routine import BYTE, INT, LANES, Routine, Value, integer, number


def fetch(module: ir.Module) -> Routine:
    """Write ``fetch``: copy the record of the cell that one lane is in behind its coordinates, which stand from ``row`` on.

    A table is laid out by `tabulate.entries`: the number of cells along each coordinate, their inner edges, and one record
    for each cell. A coordinate outside of the table gets the outermost cell, one that is not a number the first.
    """
    r = Routine(
        module, "fetch",
        {"tables": "doubles", "table": "int", "axes": "int", "record": "int", "scratch": "rows", "row": "int",
         "lane": "int"},
    )  # fmt: skip
    b, a = r.b, r.at
    at, cell, inside = r.local(INT), r.local(INT), r.local(INT)
    b.store(b.add(a["table"], a["axes"]), at)
    b.store(integer(0), cell)
    with r.loop(a["axes"]) as axis:
        z = b.load(r.lane(a["scratch"], b.add(a["row"], axis), a["lane"]), align=8)
        edges = b.sub(b.fptosi(r.load(a["tables"], b.add(a["table"], axis)), INT), integer(1))
        begin = b.load(at)
        b.store(integer(0), inside)
        with r.loop(edges) as j:
            beyond = b.fcmp_ordered("<=", r.load(a["tables"], b.add(begin, j)), z)
            b.store(b.add(b.load(inside), b.zext(beyond, INT)), inside)
        b.store(b.add(b.mul(b.load(cell), b.add(edges, integer(1))), b.load(inside)), cell)
        b.store(b.add(begin, edges), at)
    first = b.add(b.load(at), b.mul(b.load(cell), a["record"]))
    behind = b.add(a["row"], a["axes"])
    with r.loop(a["record"]) as k:
        b.store(r.load(a["tables"], b.add(first, k)), r.lane(a["scratch"], b.add(behind, k), a["lane"]), align=8)
    r.done()
    return r


@dataclass(frozen=True)
class TableReading:
    """Rows of one reading.

    Attributes
    ----------
    index : int
        Number of its table.
    table : Table
    first : int
        First row of scratch: coordinates, then edges and centre of the cell for each of them, then coefficients.
    """

    index: int
    table: Table
    first: int

    @property
    def axes(self) -> int:
        """Number of coordinates."""
        return len(self.table.coordinates)

    @property
    def record(self) -> int:
        """Numbers in the record of a cell."""
        return EDGES * self.axes + self.table.terms

    @property
    def rows(self) -> int:
        """Rows in all."""
        return self.axes + self.record

    def examine(self, r: Routine, coordinates: Sequence[Value], fetch: Routine) -> None:
        """Keep the lanes' coordinates, and fetch the records of those that have left their cells (NaN is in no cell).

        No register is kept across the fetch: LLVM would spill all of them to the stack in every evaluation. What was read
        before is read again from its array.
        """
        b, scratch = r.b, r.at["scratch"]
        within = None
        for axis, z in enumerate(coordinates):
            r.store(z, scratch, self.first + axis)
            lower, upper, _ = (r.load(scratch, self._edge(axis, i)) for i in range(EDGES))
            inside = b.and_(b.fcmp_ordered("<=", lower, z), r.less(z, upper))
            within = inside if within is None else b.and_(within, inside)
        moved = b.xor(r.bits(within), ir.Constant(BYTE, -1))
        with b.if_then(b.icmp_unsigned("!=", moved, ir.Constant(BYTE, 0)), likely=False):
            wide = b.zext(moved, INT)
            with r.loop(LANES) as lane:
                out = b.trunc(b.lshr(wide, lane), ir.IntType(1))
                with b.if_then(out):
                    table = b.load(r.lane(r.at["offsets"], self.index, lane), align=8)
                    r.call(
                        fetch, tables=r.at["tables"], table=table, axes=integer(self.axes), record=integer(self.record),
                        scratch=scratch, row=integer(self.first), lane=lane,
                    )  # fmt: skip
            r.forget()

    def polynomials(self, r: Routine, read: Read) -> dict[str, Value]:
        """Values of every output and derivative (Horner), by name.

        Outside of the table the outermost cell's polynomial goes on; NaN stays NaN. With two coordinates the polynomials
        in the second are shared by the value and the derivatives.
        """
        scratch = r.at["scratch"]
        away = [
            r.sub(r.load(scratch, self.first + axis), r.load(scratch, self._edge(axis, 2))) for axis in range(self.axes)
        ]
        inner: dict[tuple[int, int], list[Value]] = {}
        found = {}
        for output, orders, symbol in read.outputs:
            along = orders[1] if self.axes == 2 else 0
            if (output, along) not in inner:
                rows = [[r.load(scratch, row) for row in line] for line in self._coefficients(output) if len(line) > along]
                inner[output, along] = (
                    [horner(r, line, away[1], along) for line in rows] if self.axes == 2 else [line[0] for line in rows]
                )
            found[symbol.name] = horner(r, inner[output, along], away[0], orders[0])
        return found

    def _edge(self, axis: int, part: int) -> int:
        """Row of the lower edge, upper edge or centre of the lanes' cells."""
        return self.first + self.axes + EDGES * axis + part

    def _coefficients(self, output: int) -> list[list[int]]:
        """Rows of an output's coefficients, by the power of the first coordinate and then of the second."""
        n = self.table.degree + 1
        at = self.first + self.axes + EDGES * self.axes + output * self.table.terms // len(self.table.outputs)
        rows = []
        for k in range(n):
            length = n - k if self.axes == 2 else 1
            rows.append([at + j for j in range(length)])
            at += length
        return rows


class TableReadings:
    """Rows of all table readings of a kernel."""

    def __init__(self, tables: tuple[Table, ...]) -> None:
        self.tables = {table.name: (i, table) for i, table in enumerate(tables)}
        self.made: dict[tuple[str, tuple[Symbol, ...]], TableReading] = {}

    @property
    def rows(self) -> int:
        """Rows of all readings so far."""
        return sum(reading.rows for reading in self.made.values())

    def of(self, read: Read) -> TableReading:
        """The reading of a table; the same table at the same coordinates is one reading."""
        key = (read.table, read.coordinates)
        if key not in self.made:
            self.made[key] = TableReading(*self.tables[read.table], self.rows)
        return self.made[key]


def horner(r: Routine, coefficients: Sequence[Value], x: Value, order: int) -> Value:
    """Polynomial, or its first derivative, in Horner's form.

    The derivative is built from the partial sums of the polynomial, which LLVM computes once for both.
    """
    value, slope = coefficients[-1], None
    for c in reversed(coefficients[:-1]):
        if order:
            slope = value if slope is None else r.add(r.mul(slope, x), value)
        value = r.add(r.mul(value, x), c)
    return value if order == 0 else number(0.0) if slope is None else slope
