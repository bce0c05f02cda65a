"""Coordinates of section points for the indicators: scaled by their spread, combined, and projected to a plane."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.indicators.birkhoff import RotationNumber, rotation_numbers

Array = NDArray[np.float64]

#: Observables of each point: fixed random combinations of its scaled coordinates, so that no symmetry hides the motion.
OBSERVABLES = 3
#: A coordinate whose spread is below this part of its magnitude is constant.
STILL = 1e-10
#: The same part of the range that it has over the motion.
FIXED = 1e-9
#: Points whose coordinates are held at once: as many as stay in cache.
TOGETHER = 32


def parts_of(points: int) -> list[NDArray[np.intp]]:
    """Points that are worked on together."""
    everything = np.arange(points)
    return [everything[k : k + TOGETHER] for k in range(0, points, TOGETHER)]


class Watch:
    """Observables of some points: their weights come from the section that they are made with.

    Parameters
    ----------
    section : array, shape (time, state, point)
        That of points with NaN is not watched.
    cyclic : mapping of state index to period, optional
        Angles, which enter by their cosine and sine.
    ranges : array, shape (state, point), optional
        Of the states over the motion: the one that a section fixes is rounding there.
    """

    def __init__(
        self, section: Array, cyclic: Mapping[int, float] | None = None, ranges: Array | None = None
    ) -> None:
        self.cyclic = cyclic
        weights = [
            _weights(section[:, :, part], cyclic, None if ranges is None else ranges[:, part])
            for part in parts_of(section.shape[2])
        ]
        self.weights = np.concatenate(weights) if weights else np.zeros((0, 2 * section.shape[1], OBSERVABLES))

    def __call__(self, section: Array, points: NDArray[np.intp]) -> Array:
        """Observables of some of the points, shape (point, OBSERVABLES, time), from section (time, state, points)."""
        weights, out = self.weights[points], np.zeros((points.size, OBSERVABLES, section.shape[0]))
        at = 0
        for k in range(section.shape[1]):  # a matrix product would round by how many points there are
            for column in _column(section[:, k].T, (self.cyclic or {}).get(k)):
                for o in range(OBSERVABLES):
                    out[:, o] += weights[:, at, o, None] * column
                at += 1
        return out


def _weights(section: Array, cyclic: Mapping[int, float] | None, ranges: Array | None) -> Array:
    """Weight of each coordinate in each observable, shape (point, coordinate, OBSERVABLES)."""
    x = _columns(section, cyclic)
    good = np.isfinite(x).all(axis=(1, 2)) & (x.shape[2] > 0)
    weights, spread = np.zeros((*x.shape[:2], OBSERVABLES)), np.ones(x.shape[:2])
    moves = np.zeros(x.shape[:2], dtype=bool)
    if good.any():
        spread[good] = x[good].std(axis=2)
        moves[good] = spread[good] > _least(x, cyclic, ranges)[good]
    for pattern in np.unique(moves, axis=0):
        drawn = np.random.default_rng(11).uniform(0.5, 1.5, (pattern.sum(), OBSERVABLES))
        drawn *= np.where(np.random.default_rng(12).random(drawn.shape) < 0.5, -1.0, 1.0)
        same = np.flatnonzero((moves == pattern).all(axis=1))
        weights[same[:, None], np.flatnonzero(pattern)] = drawn
    return np.asarray(weights / np.where(moves, spread, 1.0)[:, :, None])


def _columns(section: Array, cyclic: Mapping[int, float] | None) -> Array:
    """Coordinates of section points, shape (point, coordinate, time): states, angles as their cosine and sine."""
    columns = [c for k in range(section.shape[1]) for c in _column(section[:, k].T, (cyclic or {}).get(k))]
    return np.stack(columns, axis=1)


def _least(x: Array, cyclic: Mapping[int, float] | None, ranges: Array | None) -> Array:
    """Spread of each coordinate, shape (point, coordinate), up to which it is constant."""
    least = STILL * np.maximum(np.abs(x).max(axis=2), 1e-300)
    if ranges is None:
        return np.asarray(least)
    size = np.concatenate([np.ones((2, ranges.shape[1])) if k in (cyclic or {}) else r[None] for k, r in enumerate(ranges)])
    return np.asarray(np.maximum(least, FIXED * np.nan_to_num(size.T)))


def _column(values: Array, period: float | None) -> list[Array]:
    """A state as coordinates; an angle as its cosine and sine."""
    if period is None:
        return [np.ascontiguousarray(values)]
    angle = 2 * np.pi * values / period
    return [np.cos(angle), np.sin(angle)]


def _combined(columns: Array, weights: Array) -> Array:
    """Weighted sum of the coordinates of each point, shape (point, time).

    Coordinate by coordinate: a matrix product would round by how many points there are, and spread over threads of its own.
    """
    out = np.zeros((columns.shape[0], columns.shape[2]))
    for k in range(columns.shape[1]):
        out += weights[:, k, None] * columns[:, k]
    return out


def moving_coordinates(
    section: Array, cyclic: Mapping[int, float] | None = None, ranges: Array | None = None
) -> tuple[Array, NDArray[np.bool_]]:
    """Coordinates of zero mean and unit spread, angles as cosine and sine, and which of them move; ``ranges`` as of `Watch`.

    Returns
    -------
    columns : array, shape (point, coordinate, time)
        Zero where a coordinate is constant, or the point is not finite. Nothing moves in an empty section.
    moves : array of bool, shape (point, coordinate)
    """
    x = _columns(section, cyclic)
    if not x.shape[2]:
        return x, np.zeros(x.shape[:2], dtype=bool)
    x[~np.isfinite(x).all(axis=(1, 2))] = 0.0
    spread = x.std(axis=2)
    moves = spread > _least(x, cyclic, ranges)
    x -= x.mean(axis=2, keepdims=True)
    x /= np.where(moves, spread, 1.0)[:, :, None]
    x[~moves] = 0.0
    return x, moves


def rotation_numbers_of(
    section: Array, cyclic: Mapping[int, float] | None = None, ranges: Array | None = None
) -> list[RotationNumber]:
    """Rotation numbers of section points, shape (time, state, point), in the plane of their two largest extents.

    The section holds 65 points or more.

    The direction of turning depends on the plane, so that number and 1 - number mean the same.
    """
    out = [RotationNumber(np.nan, np.nan, "not-finite")] * section.shape[2]
    for part in parts_of(section.shape[2]):
        some = None if ranges is None else ranges[:, part]
        columns, moves = moving_coordinates(section[:, :, part], cyclic, some)
        count = moves.sum(axis=1)
        lines, planes = np.flatnonzero(count == 1), np.flatnonzero(count > 1)
        # One coordinate turns in the plane of itself and its last value.
        line = columns[lines, moves[lines].argmax(axis=1)]
        found = rotation_numbers(line[:, 1:], line[:, :-1])
        if planes.size:
            found += rotation_numbers(*largest_extents(columns[planes]))
        for k, winding in zip(np.concatenate([lines, planes]), found, strict=True):
            out[part[k]] = winding
    return out


def largest_extents(columns: Array) -> tuple[Array, Array]:
    """Coordinates of each point along its two largest extents, each of shape (point, time)."""
    products = np.stack([(columns[:, k, None] * columns).sum(axis=2) for k in range(columns.shape[1])], axis=1)
    axes = np.linalg.eigh(products)[1]
    # The sign of an axis is arbitrary, and turns the plane round: it is fixed by a direction that no symmetry favours.
    side = (axes / np.arange(1, axes.shape[1] + 1)[:, None]).sum(axis=1)
    axes = np.where(side[:, None] < 0, -axes, axes)
    return _combined(columns, axes[:, :, -1]), _combined(columns, axes[:, :, -2])
