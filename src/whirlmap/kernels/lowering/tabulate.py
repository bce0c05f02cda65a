"""Fit a table: one polynomial per cell, in powers of the distance from the cell's centre.

With one coordinate it is the polynomial through Chebyshev-Lobatto points, so that neighbouring cells join. With two it is
the Chebyshev series of what such points give, cut off at the total degree: as accurate as the whole tensor product with
half of its terms, but neighbours join only to the table's accuracy.

A table that is costly to fit has panels (`Table.panel`): the coefficients of each cell, in its own coordinate from -1 to 1,
are analytic in the logarithm of the parameter, and a new value takes its own from those of `NODES` Chebyshev points of the
panel, fitted once and kept on disk. Every value is interpolated, so that its bits depend on nothing else.
"""

import hashlib
import threading
from collections import OrderedDict
from collections.abc import Callable, Sequence
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from whirlmap.equations.pieces import Table
from whirlmap.kernels.cache import source_of, stored

Array = NDArray[np.float64]

#: Numbers that a cell's record begins with for each coordinate: lower edge, upper edge, centre.
EDGES = 3
#: Values of the parameter in a panel that are fitted; the others are interpolated between them.
NODES = 10
#: Layers whose source decides what a fitted panel holds.
SOLVERS = ("equations", "films", "kernels")
#: Bytes of tables, and of fitted panels, that a process keeps in memory.
KEPT = 96_000_000


class Shelf:
    """Cache of arrays in memory; beyond a number of bytes the least recently used are dropped."""

    def __init__(self, most: int) -> None:
        self.most, self.size = most, 0
        self._arrays: OrderedDict[Any, Array] = OrderedDict()
        self._lock = threading.Lock()

    def get(self, key: Any, make: Callable[[], Array]) -> Array:
        """Return the array of a key, computed where it is not in memory; it is read-only."""
        with self._lock:
            if key in self._arrays:
                self._arrays.move_to_end(key)
                return self._arrays[key]
        made = make()  # two threads may make the same, to the same bits
        made.setflags(write=False)
        with self._lock:
            self.size += made.nbytes if key not in self._arrays else 0
            self._arrays[key] = made
            while self.size > self.most and len(self._arrays) > 1:
                self.size -= self._arrays.popitem(last=False)[1].nbytes
        return made

    def clear(self) -> None:
        """Forget all."""
        with self._lock:
            self._arrays.clear()
            self.size = 0


_ENTRIES, _PANELS = Shelf(KEPT), Shelf(KEPT)


@cache
def _points(degree: int) -> tuple[Array, Array, Array]:
    """Lobatto points of [-1, 1], the matrix from values there to Chebyshev coefficients, and that on to powers."""
    points = chebyshev.chebpts2(degree + 1)
    powers = np.zeros((degree + 1, degree + 1))
    for k in range(degree + 1):
        powers[: k + 1, k] = chebyshev.cheb2poly(np.eye(degree + 1)[k, : k + 1])
    return points, np.asarray(np.linalg.inv(chebyshev.chebvander(points, degree)), dtype=float), powers


def entries(table: Table, parameter: float) -> Array:
    """Entries of a table at one value of its parameter; the same bits whatever was asked before.

    Returns
    -------
    array
        Flat: the number of cells along each coordinate; their inner edges; and for each cell, the last coordinate
        fastest, its record: `EDGES` numbers for each coordinate, and for each output the coefficients of the powers.
        The outermost edges in the records are infinite.
    """
    return _ENTRIES.get((table, parameter), lambda: _entries(table, parameter))


def _entries(table: Table, parameter: float) -> Array:
    edges = table.edges(parameter)
    centres = [(e[1:] + e[:-1]) / 2 for e in edges]
    scales = [(np.diff(e) / 2)[:, None] ** -np.arange(table.degree + 1.0) for e in edges]  # (cell, power)
    panel = table.panel(parameter) if table.panel else None
    if panel:
        local = _between(table, panel, parameter)
    else:
        local = _alone(table, parameter) if table.panel else fitted(table, parameter)
    if len(edges) == 1:
        coefficients = local * scales[0][:, None, :]
    else:
        first, second = np.nonzero(_kept(table.degree))
        coefficients = local * scales[0][:, None, None, first] * scales[1][None, :, None, second]
    cells = tuple(c.size for c in centres)
    bounds = []
    for axis, e in enumerate(edges):
        rows = np.stack([np.append(-np.inf, e[1:-1]), np.append(e[1:-1], np.inf), centres[axis]], axis=-1)
        shape = [1] * len(cells)
        shape[axis] = cells[axis]
        bounds.append(np.broadcast_to(rows.reshape(*shape, EDGES), (*cells, EDGES)))
    records = np.concatenate([*bounds, coefficients.reshape(*cells, -1)], axis=-1)
    return np.concatenate([np.array(cells, dtype=float), *(e[1:-1] for e in edges), records.ravel()])


def fitted(table: Table, parameter: float) -> Array:
    """Coefficients of the powers of each cell's own coordinate, from -1 to 1: shape (cell..., output, term)."""
    points, series, powers = _points(table.degree)
    places = [
        ((e[1:] + e[:-1]) / 2)[:, None] + np.multiply.outer(np.diff(e) / 2, points) for e in table.edges(parameter)
    ]
    if len(places) == 1:
        values = np.stack(table.samples(parameter, places[0]))  # (output, cell, point)
        return np.einsum("ocp,sp,ks->cok", values, series, powers, optimize=True)
    values = np.stack(table.samples(parameter, places[0][:, None, :, None], places[1][None, :, None, :]))
    sums = np.einsum("oijab,sa,tb->ijost", values, series, series, optimize=True)
    kept = _kept(table.degree)
    return np.einsum("ijost,ks,lt->ijokl", sums * kept, powers, powers, optimize=True)[..., kept]


def _kept(degree: int) -> NDArray[np.bool_]:
    return np.add.outer(np.arange(degree + 1), np.arange(degree + 1)) <= degree


def _between(table: Table, panel: tuple[float, float], parameter: float) -> Array:
    """`fitted`, interpolated in the logarithm of the parameter between the Chebyshev points of its panel."""
    low, high = np.log(panel)
    place = 2.0 * (np.log(parameter) - low) / (high - low) - 1.0
    nodes = chebyshev.chebvander(chebyshev.chebpts1(NODES), NODES - 1)
    weights = (chebyshev.chebvander(place, NODES - 1) @ np.linalg.inv(nodes))[0]
    between: Array = np.einsum("j,j...->...", weights, _panel(table, panel))
    return between


def _panel(table: Table, panel: tuple[float, float]) -> Array:
    """`fitted` at the Chebyshev points of a panel, shape (node, cell..., output, term)."""
    low, high = np.log(panel)
    nodes = np.exp(low + 0.5 * (high - low) * (1.0 + chebyshev.chebpts1(NODES)))
    shape = (NODES, *_shape(table, float(nodes[0])))

    def solve() -> Array:
        return np.stack([fitted(table, float(p)) for p in nodes])

    return _PANELS.get((table, panel), lambda: _on_disk(table, f"{panel}", shape, solve))


def _alone(table: Table, parameter: float) -> Array:
    """`fitted` of a table that is costly to fit, at a value of the parameter that lies in no panel."""
    return _on_disk(table, f"{parameter!r}", _shape(table, parameter), lambda: fitted(table, parameter))


def _shape(table: Table, parameter: float) -> tuple[int, ...]:
    """Shape of `fitted`."""
    outputs = len(table.outputs)
    return (*(e.size - 1 for e in table.edges(parameter)), outputs, table.terms // outputs)


def _on_disk(table: Table, what: str, shape: tuple[int, ...], solve: Callable[[], Array]) -> Array:
    """Solve, or read an earlier solution from disk.

    Tables of this package are kept on disk under the hash of its source; the source of others is not known well enough.
    """
    if not table.samples.__module__.startswith("whirlmap."):
        return solve()
    question = f"{source_of(SOLVERS)}\n{table.name} {what}"
    name = f"table_{hashlib.sha256(question.encode()).hexdigest()[:32]}.f8"
    size = 8 * int(np.prod(shape))
    data = stored(name, lambda: solve().astype("<f8").tobytes(), lambda found: len(found) == size)
    return np.frombuffer(data, dtype="<f8").reshape(shape)


def reading(table: Table, parameter: float, *coordinates: Array) -> tuple[Array, ...]:
    """Read a table as the kernels do, one value for each output; coordinates broadcast against each other.

    A point's values depend on nothing else, not on its place among the others either.
    """
    flat, axes, n = entries(table, parameter), len(coordinates), table.degree + 1
    places = [z.ravel() for z in np.broadcast_arrays(*coordinates)]
    cell, at = np.zeros(places[0].size, dtype=np.intp), axes
    for axis, z in enumerate(places):
        inner = int(flat[axis]) - 1
        cell = cell * (inner + 1) + np.searchsorted(flat[at : at + inner], z, side="right")
        at += inner
    record = flat[at:].reshape(-1, EDGES * axes + table.terms)[cell].T
    away = [z - record[EDGES * axis + 2] for axis, z in enumerate(places)]
    out = []
    for coefficients in np.split(record[EDGES * axes :], len(table.outputs)):
        rows = list(coefficients)
        if axes == 2:  # one polynomial in the second coordinate for each power of the first, ever shorter
            starts = np.cumsum([0, *range(n, 0, -1)])
            rows = [_horner(coefficients[a:b], away[1]) for a, b in pairwise(starts.tolist())]
        out.append(_horner(rows, away[0]).reshape(np.broadcast_shapes(*(z.shape for z in coordinates))))
    return tuple(out)


def _horner(coefficients: Sequence[Array] | Array, x: Array) -> Array:
    out = coefficients[-1]
    for c in coefficients[-2::-1]:
        out = out * x + c
    return out


def fill(tables: tuple[Table, ...], parameters: tuple[Array, ...], lanes: int) -> tuple[Array, NDArray[np.int64]]:
    """Lay out the tables of many lanes, each distinct parameter value once.

    Parameters
    ----------
    parameters : tuple of arrays, shape (lanes,)
        Value of each table's parameter in each lane.

    Returns
    -------
    entries : array
    offsets : array of int, shape (table, lanes)
        Where each lane's entries begin.
    """
    offsets = np.zeros((max(len(tables), 1), lanes), dtype=np.int64)
    pieces: list[Array] = []
    at = 0
    for row, (table, values) in enumerate(zip(tables, parameters, strict=True)):
        distinct, index = np.unique(values, return_inverse=True)
        starts = []
        for value in distinct:
            pieces.append(entries(table, float(value)))
            starts.append(at)
            at += pieces[-1].size
        offsets[row] = np.array(starts)[index]
    return (np.concatenate(pieces) if pieces else np.zeros(1)), offsets
