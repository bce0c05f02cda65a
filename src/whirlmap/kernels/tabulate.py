"""Fill a table: in every cell a polynomial, in powers of the distance from the cell's centre.

With one coordinate it is the polynomial through Chebyshev-Lobatto points, so that neighbouring cells join. With two it is
the Chebyshev series of what such points give, cut off at the total degree: as accurate as the whole tensor product with
half of its terms, but neighbours join only to the table's accuracy.
"""

from collections.abc import Sequence
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from whirlmap.equations.pieces import Table

Array = NDArray[np.float64]

#: Numbers that a cell's record begins with for each coordinate: lower edge, upper edge, centre.
EDGES = 3


def _points(degree: int) -> tuple[Array, Array, Array]:
    """Lobatto points of [-1, 1], the matrix from values there to Chebyshev coefficients, and that on to powers."""
    points = chebyshev.chebpts2(degree + 1)
    powers = np.zeros((degree + 1, degree + 1))
    for k in range(degree + 1):
        powers[: k + 1, k] = chebyshev.cheb2poly(np.eye(degree + 1)[k, : k + 1])
    return points, np.asarray(np.linalg.inv(chebyshev.chebvander(points, degree)), dtype=float), powers


@lru_cache(maxsize=64)
def entries(table: Table, parameter: float) -> Array:
    """Entries of a table at one value of its parameter.

    Returns
    -------
    array
        Flat: the number of cells along each coordinate; their inner edges; and for each cell, the last coordinate
        fastest, its record: `EDGES` numbers for each coordinate, and for each output the coefficients of the powers.
        The outermost edges in the records are infinite.
    """
    n = table.degree + 1
    points, series, powers = _points(table.degree)
    edges = table.edges(parameter)
    centres = [(e[1:] + e[:-1]) / 2 for e in edges]
    halves = [np.diff(e) / 2 for e in edges]
    places = [c[:, None] + np.multiply.outer(h, points) for c, h in zip(centres, halves, strict=True)]
    scaled = [powers / h[:, None, None] ** np.arange(n)[:, None] for h in halves]  # (cell, power, order)
    if len(edges) == 1:
        values = np.stack(table.samples(parameter, places[0]))  # (output, cell, point)
        coefficients = np.einsum("ocp,sp,cks->cok", values, series, scaled[0], optimize=True)
    else:
        values = np.stack(table.samples(parameter, places[0][:, None, :, None], places[1][None, :, None, :]))
        sums = np.einsum("oijab,sa,tb->ijost", values, series, series, optimize=True)
        kept = np.add.outer(np.arange(n), np.arange(n)) < n
        coefficients = np.einsum("ijost,iks,jlt->ijokl", sums * kept, *scaled, optimize=True)[..., kept]
    cells = tuple(c.size for c in centres)
    bounds = []
    for axis, e in enumerate(edges):
        rows = np.stack([np.append(-np.inf, e[1:-1]), np.append(e[1:-1], np.inf), centres[axis]], axis=-1)
        shape = [1] * len(cells)
        shape[axis] = cells[axis]
        bounds.append(np.broadcast_to(rows.reshape(*shape, EDGES), (*cells, EDGES)))
    records = np.concatenate([*bounds, coefficients.reshape(*cells, -1)], axis=-1)
    out = np.concatenate([np.array(cells, dtype=float), *(e[1:-1] for e in edges), records.ravel()])
    out.setflags(write=False)
    return out


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
