"""Fill a table: in every cell, the polynomial through Chebyshev-Lobatto points, in powers of the local coordinate."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from whirlmap.equations.pieces import Table

Array = NDArray[np.float64]


def _points(degree: int) -> tuple[Array, Array]:
    """Lobatto points of [0, 1], and the matrix that turns values there into powers of the coordinate."""
    points = (1 - np.cos(np.pi * np.arange(degree + 1) / degree)) / 2
    return points, np.asarray(np.linalg.inv(np.vander(points, increasing=True)), dtype=float)


@lru_cache(maxsize=64)
def entries(table: Table, parameter: float) -> Array:
    """Entries of a table at one value of its parameter, flat over (cell, output, power...).

    Neighbouring cells share their boundary points, so the polynomials join continuously.
    """
    points, powers = _points(table.degree)
    axes = [(np.arange(n)[:, None] + points) / n for n in table.cells]
    if len(axes) == 1:
        values = np.stack(table.exact(parameter, axes[0]))  # (output, cell, point)
        flat = np.einsum("ocp,kp->cok", values, powers)
    else:
        first, second = axes
        values = np.stack(table.exact(parameter, first[:, None, :, None], second[None, :, None, :]))
        flat = np.einsum("oijab,ka,lb->ijokl", values, powers, powers)
    out: Array = np.ascontiguousarray(flat).ravel()
    out.setflags(write=False)
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
