"""Terms that are not a plain formula: guarded terms, and functions that kernels read from a table.

A `Table` stands for smooth functions that have no cheap closed form (a porous film's mobilities). In a declaration it is
called like a function; the reference kernel evaluates it exactly, the lane kernel by a local polynomial in each cell of a
table that is made once for each value of its parameter.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sympy import Expr, Function, Integer, Piecewise, Symbol
from sympy.core.function import ArgumentIndexError
from sympy.core.relational import Relational

from whirlmap.errors import ModelError, counted

Array = NDArray[np.float64]


def when(condition: Any, value: Any, otherwise: Any = 0) -> Expr:
    """``value`` where the condition holds, else ``otherwise``; a select in the kernel, so both are evaluated."""
    try:
        return Piecewise((value, condition), (otherwise, True))
    except RecursionError:  # SymPy turns some relations over forever, but none with zero on one side
        moved = condition.replace(lambda r: isinstance(r, Relational), lambda r: r.func(r.lhs - r.rhs, 0))
        return Piecewise((value, moved), (otherwise, True))


class magnitude(Function):  # noqa: N801 (printed as a function)
    """``Abs`` of a term whose kink at zero the rates do not have, for it is multiplied by what vanishes there.

    No crossing is located there (`whirlmap.kernels.lowering.surfaces`).
    """


@dataclass(frozen=True)
class Table:
    """Smooth functions of one or two coordinates, tabulated for each value of one parameter.

    Attributes
    ----------
    name : str
        Unique name, used in the generated source.
    coordinates : tuple of str
        Names of the coordinates, one or two.
    outputs : tuple of str
        Names of the functions.
    exact : callable
        ``exact(parameter, *coordinates) -> tuple of arrays``, one for each output; broadcasting. What the reference
        kernel evaluates.
    samples : callable
        The same functions as the table is fitted to them: fast at 10^5 points, as accurate as the table has to be.
    edges : callable
        ``edges(parameter) -> tuple of arrays``: ascending edges of the cells along each coordinate. Beyond the first and
        the last one the polynomial of the outermost cell goes on.
    degree : int
        Degree of the polynomial in a cell; with two coordinates the total degree.
    panel : callable, optional
        ``panel(parameter) -> (low, high)``, or None where the parameter lies in no panel: ends of the stretch of the
        parameter in which there are equally many cells and everything is analytic in its logarithm, so that the
        coefficients of a new value are interpolated between those of a few. Left out where fitting costs little.
    """

    name: str
    coordinates: tuple[str, ...]
    outputs: tuple[str, ...]
    exact: Callable[..., tuple[Array, ...]]
    samples: Callable[..., tuple[Array, ...]]
    edges: Callable[[float], tuple[Array, ...]]
    degree: int
    panel: Callable[[float], tuple[float, float] | None] | None = None

    def __post_init__(self) -> None:
        """Refuse what the kernels cannot lower."""
        if len(self.coordinates) not in (1, 2):
            raise ModelError(f"table {self.name!r} has {len(self.coordinates)} coordinates; one or two can be lowered")

    @property
    def terms(self) -> int:
        """Number of coefficients in a cell, all outputs together."""
        n = self.degree + 1
        return len(self.outputs) * (n if len(self.coordinates) == 1 else n * (n + 1) // 2)

    def __call__(self, parameter: Expr, *coordinates: Expr) -> tuple[Expr, ...]:
        """Write the table's functions into an expression, one for each output."""
        if len(coordinates) != len(self.coordinates):
            taken = counted(len(self.coordinates), "coordinate")
            raise ModelError(f"table {self.name!r} takes {taken}, not {len(coordinates)}")
        place = Symbol(self.name)
        none = (Integer(0),) * len(coordinates)
        return tuple(
            tabulated(place, Integer(i), *none, parameter, *coordinates) for i in range(len(self.outputs))
        )


class tabulated(Function):  # noqa: N801 (printed as a function)
    """One output of a table in an expression: ``tabulated(table, output, orders..., parameter, coordinates...)``.

    ``orders`` are the numbers of derivatives by each coordinate, zero or one.
    """

    @property
    def table_name(self) -> str:
        """Name of the table."""
        return str(self.args[0])

    @property
    def output(self) -> int:
        """Index of the output."""
        return int(self.args[1])

    @property
    def dimensions(self) -> int:
        """Number of coordinates."""
        return (len(self.args) - 3) // 2

    @property
    def orders(self) -> tuple[int, ...]:
        """Number of derivatives by each coordinate."""
        return tuple(int(a) for a in self.args[2 : 2 + self.dimensions])

    @property
    def parameter(self) -> Expr:
        """The parameter that the table is made for."""
        return self.args[2 + self.dimensions]

    @property
    def coordinates(self) -> tuple[Expr, ...]:
        """Where the table is read."""
        return tuple(self.args[3 + self.dimensions :])

    def fdiff(self, argindex: int = 1) -> Expr:
        """Differentiate by a coordinate: the same table with one order more."""
        axis = argindex - (4 + self.dimensions)
        if axis < 0:
            raise ArgumentIndexError(self, argindex)
        changed = list(self.args)
        changed[2 + axis] = changed[2 + axis] + 1
        return tabulated(*changed)
