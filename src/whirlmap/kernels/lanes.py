"""Compiled kernels of a model: many operating points at once, `LANES` in each call."""

from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from types import ModuleType
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from whirlmap.equations.model import Model
from whirlmap.kernels import cache
from whirlmap.kernels.methods import Method
from whirlmap.kernels.source import LANES, KernelSource, stored_source
from whirlmap.kernels.tabulate import fill

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class LaneKernel:
    """One compiled module and what its calls need."""

    model: Model
    source: KernelSource
    module: ModuleType

    def inputs(self, values: Array) -> "Inputs":
        """Prepare the inputs of many points: values of shape (parameter, point)."""
        n = values.shape[1]
        index = {q.name: i for i, q in enumerate(self.model.parameters)}
        parameters = tuple(values[index[p]] if isinstance(p, str) else np.full(n, p) for p in self.source.tables.values())
        tables = {table.name: table for table in self.model.tables}
        entries, offsets = fill(tuple(tables[name] for name in self.source.tables), parameters, n)
        return Inputs(self.source.hoisted.evaluate(values), entries, offsets)


@dataclass(frozen=True)
class Inputs:
    """Hoisted parameters, table entries and offsets of many lanes."""

    p: Array
    tables: Array
    offsets: Integers

    def lanes(self, points: NDArray[np.intp]) -> tuple[Array, Array, Integers]:
        """Inputs of one block of points, laid out for the kernel."""
        return self.p[:, points], self.tables, self.offsets[:, points]


@lru_cache(maxsize=64)
def lane_kernel(model: Model, method: Method, *, tangents: bool, kind: Literal["locked", "free"]) -> LaneKernel:
    """Compile, or find again, the kernel of a model (compilation itself happens at the first call)."""
    source = stored_source(model, method, tangents=tangents, kind=kind)
    return LaneKernel(model, source, cache.module(source.text))


@dataclass(frozen=True)
class Waves:
    """Cosines and sines of the harmonics at every stage time of their own cycles.

    A harmonic of order p/q (over the fastest one) repeats after q periods T, so its table has q times the steps per T;
    the tables stay short whatever the common period is. Angles come from exact integers.
    """

    table: Array
    starts: Integers
    lengths: Integers

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
        return cls(table, np.array(starts, dtype=np.int64), np.array(lengths, dtype=np.int64))


def padded(values: NDArray[Any]) -> NDArray[Any]:
    """Fill the last block with copies of the last lane: kernels always work on whole blocks."""
    n = values.shape[-1]
    missing = -n % LANES
    return np.concatenate([values, np.repeat(values[..., -1:], missing, axis=-1)], axis=-1) if missing else values
