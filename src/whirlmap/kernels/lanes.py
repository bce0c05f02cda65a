"""Compiled kernels of a model: many operating points at once, in blocks of `LANES`."""

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.equations.model import Model
from whirlmap.kernels import advancing, marching
from whirlmap.kernels.machine import Code, Function, aligned
from whirlmap.kernels.methods import Method
from whirlmap.kernels.rates import Slopes, Time
from whirlmap.kernels.root_choice import by_estimates
from whirlmap.kernels.routine import LANES
from whirlmap.kernels.source import KernelSource, stored_source
from whirlmap.kernels.tabulate import fill

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


#: Side of a surface of a point that has been put somewhere: the kernel finds it from the state.
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
        """Prepare the inputs of many points: values of shape (parameter, point).

        A step that leaves ``limits``, shape (state, point), is not taken; where they are absent, one that is not finite.
        Lengths of tangent vectors count states in units of ``sizes``, shape (state, point); of one where they are absent.
        """
        n = values.shape[1]
        index = {q.name: i for i, q in enumerate(self.model.parameters)}
        parameters = tuple(values[index[p]] if isinstance(p, str) else np.full(n, p) for p in self.source.tables.values())
        tables = {table.name: table for table in self.model.tables}
        entries, offsets = fill(tuple(tables[name] for name in self.source.tables), parameters, n)
        inside = np.zeros((self.model.dimension, n)) if limits is None else 1 / limits
        weights = np.ones_like(inside) if sizes is None else sizes**-2.0
        return Inputs(np.concatenate([self.source.hoisted.evaluate(values), inside, weights]), entries, offsets)


@dataclass(frozen=True)
class Inputs:
    """Hoisted parameters, reciprocal limits and weights of tangent vectors, table entries and offsets of many points."""

    p: Array
    tables: Array
    offsets: Integers

    def blocks(self, points: NDArray[np.intp]) -> dict[str, Any]:
        """Inputs of some points, as the kernels take them."""
        return {"p": blocked(self.p[:, points]), "tables": self.tables, "offsets": blocked(self.offsets[:, points])}


def slopes_for(tangents: int) -> Slopes:
    """What a kernel computes beside the rates for so many tangent vectors."""
    return "none" if tangents == 0 else "along" if tangents == 1 else "jacobian"


def lane_kernel(model: Model, method: Method, *, slopes: Slopes, kind: Time) -> LaneKernel:
    """Compile, or find again, the kernel of a model, with the choice of roots that is in force."""
    return _compiled(model, method, slopes, kind, by_estimates(model))


@lru_cache(maxsize=64)
def _compiled(model: Model, method: Method, slopes: Slopes, kind: Time, estimated: bool) -> LaneKernel:
    source = stored_source(model, method, slopes=slopes, kind=kind, estimated=estimated)
    return LaneKernel(model, source, Code.of(source.text))


@dataclass(frozen=True)
class Waves:
    """Cosines and sines of the harmonics at every stage time of their own cycles.

    A harmonic of order p/q (over the fastest one) repeats after q periods T, so its table has q times the steps per T;
    the tables stay short whatever the common period is. Angles come from exact integers.
    """

    table: Array
    starts: Integers
    lengths: Integers
    turns: Array

    @classmethod
    def of(cls, orders: tuple[Fraction, ...], steps: int, nodes: tuple[float, ...]) -> "Waves":
        """Tabulate harmonics of the given orders at ``steps`` steps per T."""
        pieces: list[Array] = []
        starts, lengths = [], []
        at = 0
        for order in orders:
            length = order.denominator * steps
            k = np.arange(length, dtype=np.int64)[:, None]
            turn = ((k * order.numerator) % length + order.numerator * np.array(nodes)) / length
            pair = np.stack([np.cos(2 * np.pi * turn), np.sin(2 * np.pi * turn)], axis=-1)
            starts.append(at)
            lengths.append(length)
            pieces.append(pair.ravel())
            at += pieces[-1].size
        table = np.concatenate(pieces) if pieces else np.zeros(2)
        turns = np.array([2 * np.pi * order.numerator / (order.denominator * steps) for order in orders])
        return cls(table, np.array(starts, dtype=np.int64), np.array(lengths, dtype=np.int64), turns)

    def arguments(self, begin: int) -> dict[str, Any]:
        """Arguments of a locked kernel for a run that begins so many steps after phase zero."""
        at = np.array([begin % n for n in self.lengths], dtype=np.int64)
        return {"waves": self.table, "starts": self.starts, "lengths": self.lengths, "begin": at, "turns": self.turns}


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
