"""Eigenvalues of products of matrices that are never formed: multipliers of orbits, down to the smallest.

Orthonormal frames are carried round (QR) until the subspaces they span return to themselves; the eigenvalues are those of
the diagonal blocks, each a product of triangular blocks with its own scale [lust2001]. Each is good to rounding relative to
itself, as long as no direction shrinks by more than about 1e-12 within one matrix. Eigenvalues of moduli within some percent
of each other share a block and are good relative to the largest in it.
"""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Most passes round the orbit until its invariant subspaces have converged, and the tolerance of that.
PASSES, STILL = 60, 1e-7
#: Passes after which the blocks that are left are taken as they are, where they have not changed.
ENOUGH = 8
#: Ratio of the moduli of two eigenvalues from which they may share a block: the smaller is good to rounding over this.
SHARED = 0.1


def eigenvalues_of_products(matrices: Array) -> tuple[Array, Array]:
    """Eigenvalues of many products of as many matrices.

    Parameters
    ----------
    matrices : array, shape (product, factor, n, n)
        The first factor acts first.

    Returns
    -------
    log_modulus, argument : array, shape (product, n)
        Largest modulus first; logarithms of zero are minus infinity.
    """
    products, factors, n, _ = matrices.shape
    frame = np.broadcast_to(np.linalg.qr(np.random.default_rng(5).normal(size=(n, n)))[0], (products, n, n)).copy()
    logs, angles = np.empty((products, n)), np.empty((products, n))
    triangles, turned = np.empty((products, factors, n, n)), np.empty((products, n, n))
    left, edges = np.arange(products), dict.fromkeys(range(products), (0, n))
    since = np.zeros(products, dtype=np.int64)
    for turn in range(PASSES):
        first = frame[left]
        now = first
        for k in range(factors):
            now, triangles[left, k] = np.linalg.qr(matrices[left, k] @ now)
        frame[left], turned[left] = now, first.transpose(0, 2, 1) @ now
        stay = []
        for one in left.tolist():
            below = np.abs(turned[one])
            found = (0, *(i for i in range(1, n) if below[i:, :i].max() < STILL), n)
            since[one] = since[one] + 1 if found == edges[one] else 0
            edges[one] = found
            # Two that share a block, a pair as a rule, need no more passes; two that do not will part in some of them.
            small = max(np.diff(found)) <= 2 and _even(triangles[one], turned[one], found)
            if not (since[one] and (small or since[one] >= ENOUGH)):
                stay.append(one)
        left = np.array(stay, dtype=np.intp)
        if not left.size or turn == PASSES - 1:
            break
    for one in range(products):
        logs[one], angles[one] = _of_blocks(triangles[one], turned[one], edges[one])
    order = np.lexsort((-angles, -logs), axis=1)
    return np.take_along_axis(logs, order, axis=1), np.take_along_axis(angles, order, axis=1)


def _even(triangles: Array, turned: Array, edges: tuple[int, ...]) -> bool:
    """Whether the two eigenvalues of each block of two have moduli that may share it."""
    for a, b in pairwise(edges):
        if b - a == 2:
            large, small = np.sort(_of_blocks(triangles[:, a:b, a:b], turned[a:b, a:b], (0, 2))[0])[::-1]
            if not small >= large + np.log(SHARED):
                return False
    return True


def _of_blocks(triangles: Array, turned: Array, edges: tuple[int, ...]) -> tuple[Array, Array]:
    """Logarithms and arguments of the eigenvalues of one product, block by block."""
    logs, angles = [], []
    for a, b in pairwise(edges):
        block, scale = np.eye(b - a), 0.0
        for triangle in triangles:
            block = triangle[a:b, a:b] @ block
            size = np.abs(block).max()
            if size == 0.0:
                break
            block, scale = block / size, scale + np.log(size)
        values = np.linalg.eigvals(turned[a:b, a:b] @ block)
        with np.errstate(divide="ignore"):
            logs.append(np.log(np.abs(values)) + scale)
        angles.append(np.angle(values))
    return np.concatenate(logs), np.concatenate(angles)
