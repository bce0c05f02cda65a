"""What a sequence of section points says by itself: the indicators of a regime that need no equations."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.winding import Winding, converged_digits, winding_number
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
    if section.shape[0] >= LEAST:
        for k in range(count):  # each point by itself, so that its bits do not depend on its neighbours
            watched = observables(section[:, :, k], cyclic)
            if watched is None:
                continue
            rest, _ = remove_cycle(watched)
            # What a cycle leaves over may be the tail of a transient, or rounding: that must not be judged.
            if (rest.std(axis=0) < REST * watched.std(axis=0)).any():
                continue
            (lower, middle, _), status, _ = growth_rates(rest, angles)
            if not (status == STATUS.index("oversampled")).any():
                growth[k], low[k] = float(np.median(middle)), float(np.median(lower))
            digits[k] = np.median(converged_digits(rest))
    return SectionEvidence(growth, low, digits, section.shape[0])


def observables(points: Array, cyclic: Mapping[int, float] | None = None) -> Array | None:
    """Random combinations of scaled coordinates, shape (time, OBSERVABLES); None where nothing moves or is not finite."""
    columns = moving_coordinates(points, cyclic)
    if columns is None:
        return None
    weights = np.random.default_rng(11).uniform(0.5, 1.5, (columns.shape[1], OBSERVABLES))
    weights *= np.where(np.random.default_rng(12).random(weights.shape) < 0.5, -1.0, 1.0)
    return columns @ weights


def moving_coordinates(points: Array, cyclic: Mapping[int, float] | None = None) -> Array | None:
    """Coordinates that move, of zero mean and unit spread, angles as cosine and sine; None where nothing moves."""
    if points.shape[0] < 2 or not np.isfinite(points).all():
        return None
    columns = []
    for k in range(points.shape[1]):
        if cyclic and k in cyclic:
            angle = 2 * np.pi * points[:, k] / cyclic[k]
            columns += [np.cos(angle), np.sin(angle)]
        else:
            columns.append(points[:, k])
    x = np.stack(columns, axis=1)
    spread = x.std(axis=0)
    moves = spread > STILL * np.maximum(np.abs(x).max(axis=0), 1e-300)
    if not moves.any():
        return None
    return np.asarray((x[:, moves] - x[:, moves].mean(axis=0)) / spread[moves])


def winding_of(points: Array, cyclic: Mapping[int, float] | None = None) -> Winding:
    """Rotation number of one operating point's section points, in the plane of their two largest extents.

    The direction of turning depends on the plane, so that number and 1 - number mean the same.
    """
    columns = moving_coordinates(points, cyclic)
    if columns is None or len(columns) < 64:
        return Winding(np.nan, np.nan, "not-finite")
    if columns.shape[1] == 1:
        return winding_number(columns[1:, 0], columns[:-1, 0])
    _, _, axes = np.linalg.svd(columns, full_matrices=False)
    return winding_number(columns @ axes[0], columns @ axes[1])
