"""Source of table readings: the cell that each lane is in, kept at hand, and the polynomials in it.

Every reading of a table has rows of scratch of its own, which stay from one stage to the next: the lane's coordinates, and
the record of its cell.
"""

from dataclasses import dataclass

from sympy import Symbol

from whirlmap.equations.pieces import Table
from whirlmap.kernels.lower import Read
from whirlmap.kernels.tabulate import EDGES


@dataclass(frozen=True)
class Place:
    """Rows of one reading.

    Attributes
    ----------
    number : int
        Number of the reading in its kernel.
    index : int
        Number of its table.
    table : Table
    first : int
        First row of scratch: coordinates, then edges and centre of the cell for each of them, then coefficients.
    lanes : int
        Lanes in a row.
    """

    number: int
    index: int
    table: Table
    first: int
    lanes: int

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

    def examine(self, read: Read) -> list[str]:
        """Statements that keep a lane's coordinates and count it where it has left its cell (NaN is in no cell)."""
        out = [f"{self._row(axis)} = {z.name}" for axis, z in enumerate(read.coordinates)]
        tests = []
        for axis, z in enumerate(read.coordinates):
            lower, upper, _ = self._cell(axis)
            tests += [f"({lower} <= {z.name})", f"({z.name} < {upper})"]
        return [*out, f"moved{self.number} += 0 if ({' & '.join(tests)}) else 1"]

    def fetch(self) -> list[str]:
        """Statements that fetch the new records of the lanes that have left their cells."""
        tests = []
        for axis in range(self.axes):
            lower, upper, _ = self._cell(axis)
            tests += [f"({lower} <= {self._row(axis)})", f"({self._row(axis)} < {upper})"]
        return [f"    if moved{self.number} > 0:",
                "        for l in range(L):",
                f"            if not ({' & '.join(tests)}):",
                f"                fetch(tables, offsets[{self.index * self.lanes} + l], {self.axes}, {self.record},"
                f" scratch, {self.first}, l)"]  # fmt: skip

    def polynomials(self, read: Read) -> list[str]:
        """Statements that evaluate a polynomial (Horner) for each output and derivative.

        Outside of the table the outermost cell's polynomial goes on; NaN stays NaN. With two coordinates the polynomials
        in the second are shared by the value and the derivatives.
        """
        out = [f"d{self.number}_{axis} = {self._row(axis)} - {self._cell(axis)[2]}" for axis in range(self.axes)]
        made: set[tuple[int, int]] = set()
        for output, orders, symbol in read.outputs:
            inner = self._coefficients(output)
            if self.axes == 2:
                order = orders[1]
                lines = [row for row in inner if len(row) > order]
                names = [f"g{self.number}_{output}_{order}_{k}" for k in range(len(lines))]
                if (output, order) not in made:
                    made.add((output, order))
                    variable = f"d{self.number}_1"
                    out += [f"{name} = {_horner(row, variable, order)}" for name, row in zip(names, lines, strict=True)]
            else:
                names = [row[0] for row in inner]
            out.append(f"{symbol.name} = {_horner(names, f'd{self.number}_0', orders[0])}")
        return out

    def _row(self, row: int) -> str:
        return f"scratch[{(self.first + row) * self.lanes} + l]"

    def _cell(self, axis: int) -> tuple[str, str, str]:
        """Lower edge, upper edge and centre of a lane's cell."""
        lower, upper, centre = (self._row(self.axes + EDGES * axis + i) for i in range(EDGES))
        return lower, upper, centre

    def _coefficients(self, output: int) -> list[list[str]]:
        """Coefficients of an output, by the power of the first coordinate and then of the second."""
        n = self.table.degree + 1
        at = self.axes + EDGES * self.axes + output * self.table.terms // len(self.table.outputs)
        rows = []
        for k in range(n):
            length = n - k if self.axes == 2 else 1
            rows.append([self._row(at + j) for j in range(length)])
            at += length
        return rows


class Places:
    """The places of all readings of a kernel."""

    def __init__(self, tables: tuple[Table, ...], lanes: int) -> None:
        self.tables = {table.name: (i, table) for i, table in enumerate(tables)}
        self.lanes = lanes
        self.made: dict[tuple[str, tuple[Symbol, ...]], Place] = {}

    @property
    def rows(self) -> int:
        """Rows of all places so far."""
        return sum(place.rows for place in self.made.values())

    def of(self, read: Read) -> Place:
        """Place of a reading; the same table at the same coordinates is the same place."""
        key = (read.table, read.coordinates)
        if key not in self.made:
            self.made[key] = Place(len(self.made), *self.tables[read.table], self.rows, self.lanes)
        return self.made[key]


def _horner(coefficients: list[str], x: str, order: int) -> str:
    """Polynomial, or its first derivative, in Horner's form."""
    terms = [c if order == 0 or k == 1 else f"{float(k)!r} * {c}" for k, c in enumerate(coefficients)][order:]
    out = terms[-1]
    for term in reversed(terms[:-1]):
        out = f"({out}) * {x} + {term}"
    return out
