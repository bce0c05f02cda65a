"""What a sequence of section points says by itself: the indicators of a regime that need no equations."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.winding import Winding, converged_digits, winding_numbers
from whirlmap.analysis.zero_one import STATUS, growth_rates, remove_cycle

Array = NDArray[np.float64]

#: Observables of each point: fixed random combinations of its scaled coordinates, so that none is blind by symmetry.
OBSERVABLES = 3
#: A coordinate whose spread is below this part of its magnitude stands still.
STILL = 1e-10
#: What is left of an observable without its cycle, over the whole, below which it is not judged.
REST = 1e-5
#: Fewer section points say nothing.
LEAST = 256
#: Points whose coordinates are held at once: as many as stay in cache.
TOGETHER = 32


@dataclass(frozen=True)
class SectionEvidence:
    """Numbers of every operating point, each array of shape (point,); NaN where the section is too short or broken.

    Attributes
    ----------
    growth : array
        K of the 0-1 test, median over observables.
    growth_low : array
        Its lower quartile over angles.
    digits : array
        `converged_digits` of the weighted Birkhoff average, median over observables.
    points : int
        Section points judged.
    """

    growth: Array
    growth_low: Array
    digits: Array
    points: int


def section_evidence(
    section: Array, *, cyclic: Mapping[int, float] | None = None, angles: int = 40
) -> SectionEvidence:
    """0-1 test and weighted Birkhoff average of many operating points.

    Parameters
    ----------
    section : array, shape (time, state, point)
        Successive section points, one per common period (or crossing), settled. Points with NaN are not judged.
    cyclic : mapping of state index to period, optional
        Angles, which enter by their cosine and sine.
    angles : int
        Of the 0-1 test.

    Notes
    -----
    Coordinates are divided by their spread; the cycle that the motion hops around is taken off (`remove_cycle`), so
    that chaos in narrow bands is seen, and digits are relative to what is left. An observable that turns slowly
    (oversampled) silences the 0-1 test.
    """
    count = section.shape[2]
    growth, low, digits = (np.full(count, np.nan) for _ in range(3))
    for part in _parts(section):
        columns, moves = moving_coordinates(section[:, :, part], cyclic)
        judged = np.flatnonzero(moves.any(axis=1))
        watched = observables(columns[judged], moves[judged])
        flat = watched.reshape(-1, watched.shape[-1]).T  # (time, point and observable)
        rest = remove_cycle(flat)[0]
        # What a cycle leaves over may be the tail of a transient, or rounding: that must not be judged.
        left = np.ascontiguousarray(rest.T).reshape(watched.shape)
        moving = (left.std(axis=2) >= REST * watched.std(axis=2)).all(axis=1)
        judged, rest = judged[moving], left[moving].reshape(-1, watched.shape[-1]).T
        if not judged.size:
            continue
        (lower, middle, _), status, _ = growth_rates(rest, angles)
        each = (judged.size, OBSERVABLES)
        slow = (status.reshape(each) == STATUS.index("oversampled")).any(axis=1)
        at = part[judged]
        growth[at] = np.where(slow, np.nan, np.median(middle.reshape(each), axis=1))
        low[at] = np.where(slow, np.nan, np.median(lower.reshape(each), axis=1))
        digits[at] = np.median(converged_digits(rest).reshape(each), axis=1)
    return SectionEvidence(growth, low, digits, section.shape[0])


def _parts(section: Array) -> list[NDArray[np.intp]]:
    """Points that are judged together; none where the section is too short."""
    points = np.arange(section.shape[2] if section.shape[0] >= LEAST else 0)
    return [points[k : k + TOGETHER] for k in range(0, points.size, TOGETHER)]


def observables(columns: Array, moves: NDArray[np.bool_]) -> Array:
    """Random combinations of the moving coordinates of each point, shape (point, OBSERVABLES, time)."""
    weights = np.zeros((*moves.shape, OBSERVABLES))
    for pattern in np.unique(moves, axis=0):
        drawn = np.random.default_rng(11).uniform(0.5, 1.5, (pattern.sum(), OBSERVABLES))
        drawn *= np.where(np.random.default_rng(12).random(drawn.shape) < 0.5, -1.0, 1.0)
        same = np.flatnonzero((moves == pattern).all(axis=1))
        weights[same[:, None], np.flatnonzero(pattern)] = drawn
    return np.stack([_combined(columns, weights[:, :, k]) for k in range(OBSERVABLES)], axis=1)


def _combined(columns: Array, weights: Array) -> Array:
    """Weighted sum of the coordinates of each point, shape (point, time).

    Coordinate by coordinate: a matrix product would round by how many points there are, and spread over threads of its own.
    """
    out = np.zeros((columns.shape[0], columns.shape[2]))
    for k in range(columns.shape[1]):
        out += weights[:, k, None] * columns[:, k]
    return out


def moving_coordinates(
    section: Array, cyclic: Mapping[int, float] | None = None
) -> tuple[Array, NDArray[np.bool_]]:
    """Coordinates of zero mean and unit spread, angles as cosine and sine, and which of them move.

    Returns
    -------
    columns : array, shape (point, coordinate, time)
        Zero where a coordinate stands still, or the point is not finite. Nothing moves in an empty section.
    moves : array of bool, shape (point, coordinate)
    """
    columns = []
    for k in range(section.shape[1]):
        column = section[:, k].T
        if cyclic and k in cyclic:
            angle = 2 * np.pi * column / cyclic[k]
            columns += [np.cos(angle), np.sin(angle)]
        else:
            columns.append(column)
    x = np.stack(columns, axis=1)
    if not x.shape[2]:
        return x, np.zeros(x.shape[:2], dtype=bool)
    x[~np.isfinite(x).all(axis=(1, 2))] = 0.0
    spread = x.std(axis=2)
    moves = spread > STILL * np.maximum(np.abs(x).max(axis=2), 1e-300)
    x -= x.mean(axis=2, keepdims=True)
    x /= np.where(moves, spread, 1.0)[:, :, None]
    x[~moves] = 0.0
    return x, moves


def windings_of(section: Array, cyclic: Mapping[int, float] | None = None) -> list[Winding]:
    """Rotation numbers of section points, shape (time, state, point), in the plane of their two largest extents.

    The direction of turning depends on the plane, so that number and 1 - number mean the same.
    """
    out = [Winding(np.nan, np.nan, "not-finite")] * section.shape[2]
    for part in _parts(section):
        columns, moves = moving_coordinates(section[:, :, part], cyclic)
        count = moves.sum(axis=1)
        lines, planes = np.flatnonzero(count == 1), np.flatnonzero(count > 1)
        # One coordinate turns in the plane of itself and its last value.
        line = columns[lines, moves[lines].argmax(axis=1)]
        found = winding_numbers(line[:, 1:], line[:, :-1])
        if planes.size:
            found += winding_numbers(*largest_extents(columns[planes]))
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
