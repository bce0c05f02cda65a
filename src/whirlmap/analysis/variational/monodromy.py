"""Monodromy matrices of many orbits at once, and their largest multipliers.

The tangent vectors of an orbit begin as the unit vectors and are integrated over one return without orthonormalisation;
they end as the columns of its monodromy matrix. The largest modulus of its eigenvalues is good to rounding relative to
itself, the small ones drown in that rounding: `floquet` finds these, for one orbit. Of models with many states the largest
modulus is sought in a subspace of a few vectors first (`largest_multipliers`).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.scales import scales_between, tangent_sizes

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Points = NDArray[np.intp]

#: Orbits that are integrated together: a matrix of twenty states takes 3 kB, the points of a long return twenty times as
#: much.
BATCH = 512
#: States from which a subspace is tried, its vectors, and the returns that they go round at most.
MANY, SUBSPACE, RETURNS = 40, 6, 4
#: Part of the largest multiplier, and of its distance from the unit circle, that its residual in the subspace may have.
RESIDUAL, FROM_CIRCLE = 1e-4, 0.01


@dataclass(frozen=True)
class Rounds:
    """One return of some points of an ensemble.

    Attributes
    ----------
    multiple : array of int, shape (point,)
        Their lengths in common periods.
    path : array, shape (common period, state, point)
        States at the end of each common period; NaN behind the return, and from where the motion ends.
    matrix : array, shape (point, state, state)
        Derivative of the last of these by the first state; NaN where the motion ends, or sticks to a surface.
    scale : array, shape (state, point)
        Sizes of the states over the return.
    """

    multiple: Integers
    path: Array
    matrix: Array
    scale: Array

    @property
    def end(self) -> Array:
        """States at the ends of the returns, shape (state, point)."""
        return self.path[self.multiple - 1, :, np.arange(self.multiple.size)].T

    def of(self, points: Points) -> "Rounds":
        """Those of some of the points, with paths as long as the longest of their returns."""
        multiple = self.multiple[points]
        path = self.path[: multiple.max(initial=0), :, points]
        return Rounds(multiple, path, self.matrix[points], self.scale[:, points])


def batches(points: int) -> list[Points]:
    """Indices of so many points, as many in each part as go round together."""
    return np.array_split(np.arange(points), -(-points // BATCH)) if points else []


def monodromies(ensemble: Ensemble, points: Points, multiple: Integers, x: Array) -> Rounds:
    """Go round once, with all tangent vectors: each point its own return.

    Parameters
    ----------
    ensemble : Ensemble
        Stays as it is, at phase zero.
    points : array of int
    multiple : array of int, shape like ``points``
        Return of each, in common periods.
    x : array, shape (state, len(points))
        Where the returns begin.
    """
    e = _with_vectors(ensemble, points, x, ensemble.model.dimension)
    segment = e.advance(multiple * e.strobe, save_periods=e.strobe, extremes=True)
    matrix = np.where(e.running[:, None, None], e.vectors.transpose(2, 1, 0), np.nan)
    assert segment.extremes is not None
    low, high = segment.extremes["minimum"], segment.extremes["maximum"]
    return Rounds(multiple, segment.saved, matrix, scales_between(e.model, e.period, low, high))


def _with_vectors(ensemble: Ensemble, points: Points, x: Array, count: int) -> Ensemble:
    """Some points at other states, with tangent vectors that are not orthonormalised: the first unit vectors."""
    return Ensemble(
        ensemble.model, ensemble.values[:, points], x, orders=ensemble.orders,
        steps=ensemble.point_steps[points], method=ensemble.method, tangents=count,
        workers=ensemble.workers, orthonormal=False, turn=ensemble.period[points], beyond=ensemble.limits[:, points],
    )  # fmt: skip


def largest_multipliers(ensemble: Ensemble, points: Points, multiple: Integers, x: Array | None = None) -> Array:
    """Largest modulus of the multipliers over one return of some points that lie on periodic orbits.

    Parameters
    ----------
    ensemble : Ensemble
        Stays as it is, at phase zero.
    points : array of int
    multiple : array of int, shape like ``points``
        Return of each, in common periods.
    x : array, shape (state, len(points)), optional
        A point of each orbit; the present states where absent.

    Returns
    -------
    array, shape like ``points``
        Infinite where the orbit ends before its return, or sticks to a surface.

    Notes
    -----
    Of `MANY` states or more, `SUBSPACE` vectors go round the orbit again and again, orthonormalised after each return:
    subspace iteration with Rayleigh-Ritz projection, Saad 2011, chapter 5 [saad2011]. The largest Ritz value is taken where
    its residual is below `RESIDUAL` of it, and below `FROM_CIRCLE` of its distance from the unit circle, so that
    stability is not in doubt. The other points, whose multipliers are close to each other, take all vectors.
    """
    x, largest = ensemble.x[:, points] if x is None else x, np.full(points.size, np.nan)
    left = np.arange(points.size)
    if ensemble.model.dimension >= MANY:
        for these in batches(points.size):
            largest[these] = _largest_in_subspace(ensemble, points[these], multiple[these], x[:, these])
        left = np.flatnonzero(np.isnan(largest))
    for part in batches(left.size):
        these = left[part]
        largest[these] = spectral_radius(monodromies(ensemble, points[these], multiple[these], x[:, these]).matrix)
    return largest


def _largest_in_subspace(ensemble: Ensemble, points: Points, multiple: Integers, x: Array) -> Array:
    """The same by subspace iteration; NaN where that has not converged, or the motion ends."""
    largest, left = np.full(points.size, np.nan), np.arange(points.size)
    n = ensemble.model.dimension
    start = np.linalg.qr(np.random.default_rng(20240101).normal(size=(n, SUBSPACE)))[0]
    Q = np.repeat(start[None], points.size, axis=0)
    size = tangent_sizes(ensemble.model, ensemble.period[points], x).T[:, :, None]
    for _ in range(RETURNS):
        e = _with_vectors(ensemble, points[left], x[:, left], SUBSPACE)
        e.vectors[:] = (Q * size[left]).transpose(2, 1, 0)
        e.advance(multiple[left] * e.strobe)
        went = np.flatnonzero(e.running & np.isfinite(e.vectors).all(axis=(0, 1)))
        Q, left = Q[went], left[went]
        if not left.size:
            break
        Y = e.vectors.transpose(2, 1, 0)[went] / size[left]
        found, residual = _largest_ritz(Q, Y)
        good = residual <= np.minimum(RESIDUAL * found, FROM_CIRCLE * np.abs(1 - found))
        largest[left[good]] = found[good]
        Q, left = np.linalg.qr(Y[~good])[0], left[~good]
    return largest


def _largest_ritz(Q: Array, Y: Array) -> tuple[Array, Array]:
    """Largest modulus of the Ritz values of orthonormal vectors Q and their images Y, and the length of its residual."""
    values, vectors = np.linalg.eig(Q.transpose(0, 2, 1) @ Y)
    first = np.abs(values).argmax(axis=-1)[:, None]
    value = np.take_along_axis(values, first, axis=-1)
    vector = np.take_along_axis(vectors, first[:, None], axis=-1)
    residual = np.linalg.norm(Y @ vector - value[:, None] * (Q @ vector), axis=(-2, -1))
    return np.abs(value[:, 0]), residual


def spectral_radius(matrix: Array) -> Array:
    """Largest modulus of the eigenvalues of matrices (..., n, n); infinite where one is not finite."""
    known = np.isfinite(matrix).all(axis=(-2, -1))
    largest = np.full(known.shape, np.inf)
    if known.any():
        largest[known] = np.abs(np.linalg.eigvals(matrix[known])).max(axis=-1)
    return largest
