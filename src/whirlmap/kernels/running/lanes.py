"""Compiled kernels of a model: many operating points at once, in blocks of `LANES`."""

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.equations.model import Model
from whirlmap.errors import RangeError
from whirlmap.kernels.lowering.tabulate import fill
from whirlmap.kernels.methods import Method
from whirlmap.kernels.running.machine import Code, Function, aligned, fuses
from whirlmap.kernels.running.root_choice import by_estimates
from whirlmap.kernels.running.source import KernelSource, stored_source
from whirlmap.kernels.writing import advancing, marching
from whirlmap.kernels.writing.rates import Slopes, Time
from whirlmap.kernels.writing.routine import LANES

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


#: Rows of the longest table of a harmonic, and parts of a turn that are counted.
LONGEST, COUNTED = 1 << 17, 1 << 62
#: Side of a surface for a point whose state was set from outside: the kernel finds it from the state.
UNKNOWN = 2.0


@dataclass(frozen=True, eq=False)
class LaneKernel:
    """One compiled module and what its calls need."""

    model: Model
    source: KernelSource
    code: Code

    @cached_property
    def advance(self) -> Function:
        """Many steps at one phase of the forcing (locked kernels)."""
        return self.code.function("advance", advancing.ARGUMENTS)

    @cached_property
    def march(self) -> Function:
        """A few steps, every lane at its own time (free kernels)."""
        return self.code.function("march", marching.MARCH)

    @cached_property
    def evaluate(self) -> Function:
        """Rates, Jacobian and outputs at given times (free kernels)."""
        return self.code.function("evaluate", marching.EVALUATE)

    def with_sides(self, y: Array) -> Array:
        """States and tangent vectors, shape (row, point), with rows for the sides of surfaces, not known yet."""
        return np.concatenate([y, np.full((self.source.sizes.surfaces, y.shape[1]), UNKNOWN)])

    def work(self) -> Array:
        """Working memory of one call."""
        return aligned(self.source.sizes.work)

    def inputs(self, values: Array, limits: Array | None = None, sizes: Array | None = None) -> "Inputs":
        """Prepare the inputs of many points (`kernel_inputs`)."""
        return kernel_inputs(self.model, self.source, values, limits, sizes)


@dataclass(frozen=True)
class Inputs:
    """Hoisted parameters, reciprocal limits and weights of tangent vectors, table entries and offsets of many points."""

    p: Array
    tables: Array
    offsets: Integers

    def blocks(self, points: NDArray[np.intp]) -> dict[str, Any]:
        """Inputs of some points, as the kernels take them."""
        return {"p": blocked(self.p[:, points]), "tables": self.tables, "offsets": blocked(self.offsets[:, points])}


def kernel_inputs(
    model: Model, source: KernelSource, values: Array, limits: Array | None = None, sizes: Array | None = None
) -> Inputs:
    """Prepare the inputs of many points: values of shape (parameter, point).

    A step that leaves ``limits``, shape (state, point), is not taken; where they are absent, one that is not finite.
    Lengths of tangent vectors count states in units of ``sizes``, shape (state, point); of one where they are absent.
    """
    n = values.shape[1]
    index = {q.name: i for i, q in enumerate(model.parameters)}
    parameters = tuple(values[index[p]] if isinstance(p, str) else np.full(n, p) for p in source.tables.values())
    tables = {table.name: table for table in model.tables}
    entries, offsets = fill(tuple(tables[name] for name in source.tables), parameters, n)
    inside = np.zeros((model.dimension, n)) if limits is None else 1 / limits
    weights = np.ones_like(inside) if sizes is None else sizes**-2.0
    return Inputs(np.concatenate([source.hoisted.evaluate(values), inside, weights]), entries, offsets)


def slopes_for(tangents: int) -> Slopes:
    """Which derivatives a kernel computes beside the rates, for so many tangent vectors."""
    return "none" if tangents == 0 else "along" if tangents == 1 else "jacobian"


def lane_kernel(model: Model, method: Method, *, slopes: Slopes, kind: Time) -> LaneKernel:
    """Compile, or find again, the kernel of a model, with the choice of roots that is in force."""
    return _compiled(model, method, slopes, kind, by_estimates(model))


@lru_cache(maxsize=64)
def _compiled(model: Model, method: Method, slopes: Slopes, kind: Time, estimated: bool) -> LaneKernel:
    source = stored_source(model, method, slopes=slopes, kind=kind, estimated=estimated, fused=fuses())
    return LaneKernel(model, source, Code.of(source.text))


@dataclass(frozen=True)
class HarmonicTables:
    """Harmonic tables: cosines and sines at every stage time of each cycle, for several numbers of steps per T.

    A harmonic of order p/q (over the fastest one) repeats after q periods T, so its table has q times the steps per T;
    the tables stay short whatever the common period is. Where q itself is large, a table of more than `LONGEST` rows, the
    harmonic is *far*: the kernel keeps its phase as a whole number of parts of a turn, q times the steps per T of them, and
    the table holds what turns the phase at a step's begin on to its stage times. Angles come from exact integers, so that
    no phase is lost however long a run is.

    Attributes
    ----------
    orders : tuple of Fraction
    steps : array of int
        Steps per T, ascending.
    table : array
        All tables. That of a harmonic ends with its first cosine and sine: the end of its last step.
    starts, lengths, strides, far, turns : arrays, shape (harmonic, steps)
        Arguments of a locked kernel (`advancing.advance`).
    """

    orders: tuple[Fraction, ...]
    steps: Integers
    table: Array
    starts: Integers
    lengths: Integers
    strides: Integers
    far: Integers
    turns: Array

    @classmethod
    def of(cls, orders: tuple[Fraction, ...], steps: Integers, nodes: tuple[float, ...]) -> "HarmonicTables":
        """Tabulate harmonics of the given orders, for all numbers of steps per T among ``steps``.

        Raises
        ------
        RangeError
            Where an order's denominator times the steps is beyond 2^62: integers of 64 bits do not count so far.
        """
        steps = np.unique(steps)
        pieces, rows, at = [np.zeros(0)], [], 0
        for order in orders:
            for each in steps.tolist():
                length = order.denominator * each
                if length >= COUNTED:
                    raise RangeError(
                        f"the order {order} of a harmonic has a denominator of more than {COUNTED // each:.2g}: its phase"
                        " cannot be counted exactly; expected a ratio of smaller integers"
                    )
                far = length > LONGEST
                if far:
                    turn = order.numerator * np.array([*nodes, 1.0]) / length
                else:
                    k = np.arange(length, dtype=np.int64)[:, None]
                    turn = ((k * order.numerator) % length + order.numerator * np.array(nodes)) / length
                pair = np.stack([np.cos(2 * np.pi * turn), np.sin(2 * np.pi * turn)], axis=-1).ravel()
                pieces += [pair, pair[:2]]
                rows.append((at, length, order.numerator % length if far else 1, int(far)))
                at += pair.size + 2
        shape = len(orders), steps.size
        columns = np.array(rows, dtype=np.int64).reshape(*shape, 4)
        turns = np.array([2 * np.pi * o.numerator / (o.denominator * n) for o in orders for n in steps.tolist()])
        starts, lengths, strides, far = np.ascontiguousarray(np.moveaxis(columns, 2, 0))
        return cls(orders, steps, np.concatenate(pieces), starts, lengths, strides, far, turns.reshape(shape))

    def rows(self, steps: Integers) -> dict[str, NDArray[Any]]:
        """Arguments of points with so many steps per T that stay the same, shape (harmonic, point)."""
        at = np.searchsorted(self.steps, steps)
        return {name: getattr(self, name)[:, at] for name in ("starts", "lengths", "strides", "far", "turns")}

    def begin(self, steps: Integers, turns: Integers, done: Integers) -> Integers:
        """Phases ``done`` steps after ``turns`` T as the kernel counts them, shape (harmonic, point)."""
        out = np.empty((len(self.orders), steps.size), dtype=np.int64)
        for row, order, far in zip(out, self.orders, self.far[:, np.searchsorted(self.steps, steps)], strict=True):
            whole = order.denominator * steps
            row[:] = (turns % order.denominator * steps + done) % whole
            counted = np.flatnonzero(far)
            row[counted] = [int(k) * order.numerator % int(n) for k, n in zip(row[counted], whole[counted], strict=True)]
        return out

    def angles(self, steps: Integers, turns: Integers, done: Integers, part: Array) -> Array:
        """Angle of each harmonic within its turn, a part of a step behind the beginning of a step: (harmonic, point)."""
        out = np.empty((len(self.orders), steps.size))
        for row, order in zip(out, self.orders, strict=True):
            whole = order.denominator * steps
            cycle = (turns % order.denominator * steps + done) % whole
            row[:] = [int(k) * order.numerator % int(n) / int(n) for k, n in zip(cycle, whole, strict=True)]
            row += [float(Fraction(order.numerator, int(n))) for n in whole] * part
        return 2 * np.pi * out


def blocked(values: NDArray[Any]) -> NDArray[Any]:
    """Lay out (row, point) as the kernels take it, (block, row, lane); the last block is filled with its last point."""
    rows, n = values.shape
    blocks = -(-n // LANES)
    flat = aligned(blocks * rows) if values.dtype == np.float64 else np.empty(blocks * rows * LANES, dtype=values.dtype)
    out = flat.reshape(blocks, rows, LANES)
    whole = n // LANES
    out[:whole] = values[:, : whole * LANES].reshape(rows, whole, LANES).transpose(1, 0, 2)
    if whole < blocks:
        left = n - whole * LANES
        out[whole, :, :left] = values[:, whole * LANES :]
        out[whole, :, left:] = values[:, -1:]
    return out


def unblocked(blocks: NDArray[Any], points: int) -> NDArray[Any]:
    """Undo `blocked`: (block, row, lane) to (row, point)."""
    return blocks.transpose(1, 0, 2).reshape(blocks.shape[1], blocks.shape[0] * LANES)[:, :points]
