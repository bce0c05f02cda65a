"""Adaptive refinement of a map: a coarse lattice first, then its cells with different labels, down to the full grid."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Mask = NDArray[np.bool_]
Labels = NDArray[np.int64]

#: Spacing of the coarse lattice, in points of the grid.
COARSE = 8


def refine(
    shape: tuple[int, int], evaluate: Callable[[tuple[NDArray[np.intp], NDArray[np.intp]]], Labels], *, coarse: int = COARSE
) -> tuple[Labels, Mask]:
    """Label a grid, evaluating only the points that the boundaries between labels ask for.

    Parameters
    ----------
    shape : tuple
        Points along the two dimensions.
    evaluate : callable
        Given the indices of points along both dimensions, returns their labels.
    coarse : int
        Spacing of the first lattice, a power of two: what is smaller may lie unseen between its points.

    Returns
    -------
    labels : array of int
        Of the whole grid.
    evaluated : array of bool
        Which of them were evaluated; the others have the label of their surroundings.

    Notes
    -----
    1. The lattice with the given spacing is evaluated, its last row and column included.
    2. Every cell on whose edge or in whose middle two labelled points differ is split: the middles of its edges and its
       own are evaluated. A middle that differs from its edge makes the neighbouring cell split too, until nothing
       changes; then the spacing is halved, down to one.
    3. What is left lies in cells whose evaluated points all agree, and takes their label.

    So of two neighbours with different labels both are evaluated.
    """
    labels, known = np.zeros(shape, dtype=np.int64), np.zeros(shape, dtype=bool)
    assigned = known.copy()  # evaluated, or inside of a cell that agrees

    def ask(rows: NDArray[np.intp], columns: NDArray[np.intp]) -> None:
        wanted = np.zeros(shape, dtype=bool)
        wanted[rows, columns] = True
        where = np.nonzero(wanted & ~known)
        if where[0].size:
            labels[where] = evaluate((where[0], where[1]))
            known[where] = assigned[where] = True

    spacing = coarse
    marks = [_marks(n, spacing) for n in shape]
    ask(*(m.ravel() for m in np.meshgrid(*marks, indexing="ij")))
    while spacing > 1:
        finer = [_marks(n, spacing // 2) for n in shape]
        while True:
            mixed = _mixed(labels, assigned, marks)
            lower = [m[:-1] if m.size > 1 else m for m in marks]
            upper = [m[1:] if m.size > 1 else m for m in marks]
            before = int(known.sum())
            cells = np.nonzero(mixed)
            points = [
                _within(finer[k], lower[k][cells[k]], upper[k][cells[k]]) for k in (0, 1)
            ]  # of each cell: up to three marks of the finer lattice along each dimension
            rows = np.repeat(points[0], points[1].shape[1], axis=1).ravel()
            columns = np.tile(points[1], (1, points[0].shape[1])).ravel()
            ask(rows, columns)
            if int(known.sum()) == before:
                break
        _fill(labels, assigned, marks, mixed)
        spacing, marks = spacing // 2, finer
    return labels, known


def _marks(n: int, spacing: int) -> NDArray[np.intp]:
    """Marks of a lattice along one dimension, the last point always among them."""
    return np.unique(np.append(np.arange(0, n, spacing), n - 1))


def _within(marks: NDArray[np.intp], low: NDArray[np.intp], high: NDArray[np.intp]) -> NDArray[np.intp]:
    """Of each cell the marks of the finer lattice from its lower to its upper edge, shape (cell, 3)."""
    first, last = np.searchsorted(marks, low), np.searchsorted(marks, high)
    return marks[np.stack([first, (first + last) // 2, last], axis=1)]


def _mixed(labels: Labels, assigned: Mask, marks: list[NDArray[np.intp]]) -> Mask:
    """Cells of a lattice among whose labelled points, edges included, two differ."""
    low = np.where(assigned, labels, np.iinfo(np.int64).max)
    high = np.where(assigned, labels, np.iinfo(np.int64).min)
    for axis in (0, 1):
        low, high = _cells(np.minimum, low, marks[axis], axis), _cells(np.maximum, high, marks[axis], axis)
    return np.asarray(high > low)


def _cells(reduce: np.ufunc, values: Labels, marks: NDArray[np.intp], axis: int) -> Labels:
    """Reduce along one dimension over each cell with both of its edges."""
    if marks.size == 1:
        return values
    inner = reduce.reduceat(values, marks[:-1], axis=axis)  # the last cell holds its upper edge
    return np.asarray(reduce(inner, np.take(values, marks[1:], axis=axis)))


def _fill(labels: Labels, assigned: Mask, marks: list[NDArray[np.intp]], mixed: Mask) -> None:
    """Give what has no label yet, inside of cells that agree, that of their corner."""
    place = [np.clip(np.searchsorted(m, np.arange(n), side="right") - 1, 0, max(m.size - 2, 0))
             for m, n in zip(marks, labels.shape, strict=True)]  # fmt: skip
    corner = labels[marks[0][:, None], marks[1][None, :]]
    cell = np.ix_(place[0], place[1])
    uniform = ~mixed[cell] & ~assigned
    labels[uniform], assigned[uniform] = corner[cell][uniform], True
