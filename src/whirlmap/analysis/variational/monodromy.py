"""Monodromy matrices of many orbits at once, and their largest multipliers.

The tangent vectors of an orbit begin as the unit vectors and are integrated over one return without orthonormalisation;
they end as the columns of its monodromy matrix. The largest modulus of its eigenvalues is good to rounding relative to
itself, the small ones drown in that rounding: `floquet` finds these, for one orbit. Of models with many states the largest
modulus is sought in a subspace of a few vectors first (`go_round`).
"""

from collections.abc import Mapping
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
#: Singular value of 1 - M, over the largest, below which a direction is one that M leaves as it is.
SAME = 1e-12


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


@dataclass(frozen=True)
class Return:
    """What one return of some points tells of the orbit near them.

    Attributes
    ----------
    largest : array, shape (point,)
        Largest modulus of the multipliers; infinite where the orbit ends before its return, or sticks to a surface.
    change, left : array, shape (state, point)
        Change over the return, and what is left of the way to the orbit after it.
    """

    largest: Array
    change: Array
    left: Array


def largest_multipliers(ensemble: Ensemble, points: Points, multiple: Integers, x: Array | None = None) -> Array:
    """Largest modulus of the multipliers over one return of some points that lie on periodic orbits: see `go_round`."""
    return go_round(ensemble, points, multiple, x).largest


def go_round(
    ensemble: Ensemble, points: Points, multiple: Integers, x: Array | None = None,
    cyclic: Mapping[int, float] | None = None,
) -> Return:  # fmt: skip
    """Go round once from points that lie on periodic orbits, or near them.

    Parameters
    ----------
    ensemble : Ensemble
        Stays as it is, at phase zero.
    points : array of int
    multiple : array of int, shape like ``points``
        Return of each, in common periods.
    x : array, shape (state, len(points)), optional
        A point of each orbit; the present states where absent.
    cyclic : mapping of state index to period, optional
        States that are angles.

    Returns
    -------
    Return
        In the order of ``points``.

    Notes
    -----
    With the monodromy matrix M and the change d over the return, (1 - M)^-1 M d is left. Directions in which M is one are
    left out: nothing is known of a way along them.

    Of `MANY` states or more, `SUBSPACE` vectors go round the orbit again and again, orthonormalised after each return:
    subspace iteration with Rayleigh-Ritz projection, Saad 2011, chapter 5 [saad2011]. The largest Ritz value is taken where
    its residual is below `RESIDUAL` of it, and below `FROM_CIRCLE` of its distance from the unit circle, so that
    stability is not in doubt; what is left is that in the subspace, for the other directions have died away. The other
    points, whose multipliers are close to each other, take all vectors.
    """
    x = ensemble.x[:, points] if x is None else x
    found = Return(np.full(points.size, np.nan), np.full(x.shape, np.nan), np.full(x.shape, np.nan))
    left = np.arange(points.size)
    if ensemble.model.dimension >= MANY:
        for these in batches(points.size):
            _in_subspace(ensemble, points, multiple, x, cyclic, these, found)
        left = np.flatnonzero(np.isnan(found.largest))
    for part in batches(left.size):
        these = left[part]
        went = monodromies(ensemble, points[these], multiple[these], x[:, these])
        found.largest[these] = spectral_radius(went.matrix)
        found.change[:, these] = change = _change(x[:, these], went.end, cyclic)
        known = np.isfinite(found.largest[these])
        found.left[:, these[known]] = _left(went.matrix[known], change[:, known].T).T
    return found


def _change(begin: Array, end: Array, cyclic: Mapping[int, float] | None) -> Array:
    change = end - begin
    for k, period in (cyclic or {}).items():
        change[k] -= period * np.rint(change[k] / period)
    return change


def _left(matrix: Array, change: Array) -> Array:
    """(1 - M)^-1 M d for matrices (point, n, n) and changes (point, n)."""
    away = np.linalg.pinv(np.eye(matrix.shape[-1]) - matrix, rcond=SAME)
    return np.asarray((away @ matrix @ change[:, :, None])[:, :, 0])


def _in_subspace(
    ensemble: Ensemble, points: Points, multiple: Integers, x: Array, cyclic: Mapping[int, float] | None, these: Points,
    found: Return,
) -> None:  # fmt: skip
    """The same of ``these`` by subspace iteration, into ``found``; NaN stays where that has not converged."""
    n, left = ensemble.model.dimension, these
    start = np.linalg.qr(np.random.default_rng(20240101).normal(size=(n, SUBSPACE)))[0]
    Q = np.repeat(start[None], left.size, axis=0)
    for _ in range(RETURNS):
        size = tangent_sizes(ensemble.model, ensemble.period[points[left]], x[:, left]).T[:, :, None]
        e = _with_vectors(ensemble, points[left], x[:, left], SUBSPACE)
        e.vectors[:] = (Q * size).transpose(2, 1, 0)
        e.advance(multiple[left] * e.strobe)
        went = np.flatnonzero(e.running & np.isfinite(e.vectors).all(axis=(0, 1)))
        if not went.size:
            break
        Q, left, size = Q[went], left[went], size[went]
        Y = e.vectors.transpose(2, 1, 0)[went] / size
        largest, residual = _largest_ritz(Q, Y)
        good = residual <= np.minimum(RESIDUAL * largest, FROM_CIRCLE * np.abs(1 - largest))
        done = left[good]
        change = _change(x[:, left], e.x[:, went], cyclic)
        found.largest[done], found.change[:, done] = largest[good], change[:, good]
        back = Q[good].transpose(0, 2, 1)
        left_within = _left(back @ Y[good], (back @ (change.T[:, :, None] / size)[good])[:, :, 0])
        found.left[:, done] = (Q[good] @ left_within[:, :, None] * size[good])[:, :, 0].T
        Q, left = np.linalg.qr(Y[~good])[0], left[~good]
        if not left.size:
            break


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
