"""What a sequence of section points says by itself: the indicators of a regime that need no equations."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.winding import Winding, converged_digits, winding_numbers
from whirlmap.analysis.zero_one import STATUS, growth_rates, phase_means, remove_cycle

Array = NDArray[np.float64]

#: Observables of each point: fixed random combinations of its scaled coordinates, so that none is blind by symmetry.
OBSERVABLES = 3
#: A coordinate whose spread is below this part of its magnitude stands still.
STILL = 1e-10
#: What is left of an observable without its cycle, over the whole, below which it is not judged.
REST = 1e-5
#: Fewer section points say nothing.
LEAST = 256
#: Digits of Birkhoff averages above which a motion is smooth.
SMOOTH = 6.0
#: Longest return that is looked for, fewest section points for that, distance over the spread of a near one, and how much
#: nearer it comes where it closes.
LONGEST_RETURN, LEAST_RETURNS, NEAR, CLOSER = 200, 48, 0.02, 0.7
#: Rounds of a cycle that a record holds at least where the mean of each of its phases is taken off.
ROUNDS = 8
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
    digits, digits_before : array
        `converged_digits` of the weighted Birkhoff average, median over observables: the larger of those of the whole record
        and of its last half, and those of its last quarter.
    rough : array
        The same of the whole record, relative to what is left without the cycle that the motion hops around.
    uneven : array
        How much the extents of the first and the last third of the record differ, over the extent; the largest of the
        observables.
    closes : array of bool
        Whether the section comes near to a return, and nearer in the last third of the record than in the first.
    points : int
        Section points judged.
    """

    growth: Array
    growth_low: Array
    digits: Array
    digits_before: Array
    rough: Array
    uneven: Array
    closes: NDArray[np.bool_]
    points: int


def section_evidence(
    section: Array, *, common: int = 1, cyclic: Mapping[int, float] | None = None, angles: int = 40
) -> SectionEvidence:
    """0-1 test and weighted Birkhoff average of many operating points.

    Parameters
    ----------
    section : array, shape (time, state, point)
        Successive section points, one per T (or crossing), settled. Points with NaN are not judged.
    common : int
        Number of T after which the forcing repeats.
    cyclic : mapping of state index to period, optional
        Angles, which enter by their cosine and sine.
    angles : int
        Of the 0-1 test.

    Notes
    -----
    Coordinates are divided by their spread. What repeats with the forcing is taken off (the mean of each phase of the
    common period, where the record holds `ROUNDS` of these), and the cycle that the motion hops around (`remove_cycle`), for
    the 0-1 test and ``rough``, so that chaos in narrow bands is seen. The 0-1 test sees one point per common period, or as
    many more as it needs; an observable that turns slowly (oversampled) silences it. It is not asked where the averages
    converge (`SMOOTH`): it can only agree.
    """
    count = section.shape[2]
    growth, low, digits, before, rough, uneven = (np.full(count, np.nan) for _ in range(6))
    closes = np.zeros(count, dtype=bool)
    for part in _parts(section):
        columns, moves = moving_coordinates(section[:, :, part], cyclic)
        judged = np.flatnonzero(moves.any(axis=1))
        if not judged.size:
            continue
        watched = observables(columns[judged], moves[judged])
        rows, at = watched.shape[-1], part[judged]
        before[at] = _digits(watched[:, :, -(rows // 4) :])
        digits[at] = np.maximum(_digits(watched), _digits(watched[:, :, -(rows // 2) :]))
        extents = [np.ptp(watched[:, :, k], axis=2) for k in (slice(rows // 3), slice(-(rows // 3), None))]
        with np.errstate(divide="ignore", invalid="ignore"):
            uneven[at] = (np.abs(extents[0] - extents[1]) / np.maximum(*extents)).max(axis=1)
        strobed = watched[:, :, (rows - 1) % common :: common]
        closes[at] = _closes(strobed) if strobed.shape[2] >= LEAST_RETURNS else False
        unsure = np.flatnonzero(digits[at] < SMOOTH)
        at, watched = at[unsure], watched[unsure]
        left = _without_cycles(watched.reshape(-1, rows), common).reshape(watched.shape)
        # What a cycle leaves over may be the tail of a transient, or rounding: that must not be judged.
        moving = (left.std(axis=2) >= REST * watched.std(axis=2)).all(axis=1)
        at, left = at[moving], left[moving]
        if not at.size:
            continue
        rough[at] = _digits(left)
        stride = _stride(rows, common)
        strided = left[:, :, (rows - 1) % stride :: stride]
        (lower, middle, _), status, _ = growth_rates(strided.reshape(-1, strided.shape[-1]).T, angles)
        each = (at.size, OBSERVABLES)
        slow = (status.reshape(each) == STATUS.index("oversampled")).any(axis=1)
        growth[at] = np.where(slow, np.nan, np.median(middle.reshape(each), axis=1))
        low[at] = np.where(slow, np.nan, np.median(lower.reshape(each), axis=1))
    return SectionEvidence(growth, low, digits, before, rough, uneven, closes, section.shape[0])


def _digits(left: Array) -> Array:
    """Digits of observables, shape (point, observable, time): the median over observables."""
    flat = left.reshape(-1, left.shape[-1]).T
    return np.asarray(np.median(converged_digits(flat).reshape(left.shape[:2]), axis=1))


def _closes(strobed: Array) -> NDArray[np.bool_]:
    """Whether the nearest return of observables, shape (point, observable, time), comes nearer along the record.

    On a torus the distance over any number of common periods is that of a shift of the phase, and stays.
    """
    rows = strobed.shape[2]
    most, part = min(LONGEST_RETURN, rows // 2), rows // 6
    near = np.stack([np.abs(strobed[:, :, -part:] - strobed[:, :, -part - q : -q]).max(axis=(1, 2)) for q in range(1, most + 1)])
    nearest = near.argmin(axis=0) + 1
    out = np.zeros(len(strobed), dtype=bool)
    for q in np.unique(nearest[near.min(axis=0) < NEAR]):
        at = np.flatnonzero((nearest == q) & (near.min(axis=0) < NEAR))
        away = ((strobed[at, :, q:] - strobed[at, :, :-q]) ** 2).sum(axis=1)
        third = away.shape[1] // 3
        out[at] = away[:, -third:].mean(axis=1) < CLOSER**2 * away[:, :third].mean(axis=1)
    return out


def _stride(rows: int, common: int) -> int:
    """T between the points that the 0-1 test sees: the largest part of a common period that leaves it enough of them."""
    most = min(common, rows // LEAST)
    return max((d for d in range(1, most + 1) if common % d == 0), default=1)


def _without_cycles(series: Array, common: int) -> Array:
    """Series, shape (series, time), less what repeats with the forcing and the cycle that they hop around."""
    rows = series.shape[1]
    if rows < ROUNDS * common:
        return series - series.mean(axis=1, keepdims=True)
    left = series - phase_means(series, common)
    if common == 1:
        return np.ascontiguousarray(remove_cycle(left.T)[0].T)
    _, cycle = remove_cycle(left[:, ::common].T)
    for m in np.unique(cycle[(cycle > 1) & (rows >= ROUNDS * cycle * common)]):
        left[cycle == m] -= phase_means(left[cycle == m], int(m) * common)
    return left


def _parts(section: Array, least: int = LEAST) -> list[NDArray[np.intp]]:
    """Points that are judged together; none where the section is too short."""
    points = np.arange(section.shape[2] if section.shape[0] >= least else 0)
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


def windings_of(section: Array, cyclic: Mapping[int, float] | None = None, *, least: int = LEAST) -> list[Winding]:
    """Rotation numbers of section points, shape (time, state, point), in the plane of their two largest extents.

    The direction of turning depends on the plane, so that number and 1 - number mean the same.
    """
    out = [Winding(np.nan, np.nan, "not-finite")] * section.shape[2]
    for part in _parts(section, least):
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
