"""Whether two long records come from one distribution: averages of many bounded functions, each with its error.

Section points of two runs on one attractor have the same averages, whatever phase the runs began at. The functions are
cosines and sines of projections of the scaled states, along each state and along fixed random directions, at wavelengths
from four times the range to a quarter of it (the characteristic function of the distribution, at fixed places). The error
of an average counts that successive points depend on each other:

- a strange set: from the scatter of the means of blocks, the larger one of short and long blocks;
- a torus: weighted Birkhoff averages [das2017] converge beyond all powers, so that what the two halves of a record differ
  by bounds the error. A run that still drifts towards its torus has a large one.

Records differ where one average does beyond chance: Student's distribution, with the number of functions counted.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.indicators.birkhoff import weighted_average
from whirlmap.integrate.scales import FLOOR

Array = NDArray[np.float64]

#: Random directions, and waves over the range of a record along each direction.
DIRECTIONS, WAVES = 16, (0.25, 0.5, 1.0, 2.0, 4.0)
#: Blocks whose means scatter.
BLOCKS = 8, 32
#: Chance that two records of one strange set are told apart.
CHANCE = 1e-6
#: What two averages over a torus may differ by, over the largest difference between halves, and below what they do not.
HALVES, LEAST = 4.0, 1e-7
#: How much further than the furthest stretch of a trace a run's averages may be; runs that are averaged together.
STRETCHES, TOGETHER = 1.25, 512
#: Error of an average beyond which a record says nothing: the averages lie between -1 and 1.
COARSE = 0.25


@dataclass(frozen=True)
class Comparison:
    """How two records compare.

    Attributes
    ----------
    difference : float
        Largest difference of two averages, of those that differ beyond their error the most; between 0 and 2.
    allowed : float
        What it may be by chance.
    """

    difference: float
    allowed: float

    @property
    def known(self) -> bool:
        """Whether the averages are good enough to tell."""
        return self.allowed <= COARSE

    @property
    def different(self) -> bool:
        """Whether something tells the records apart beyond chance."""
        return self.difference > self.allowed


def compare(
    one: Array, other: Array, scale: Array, cyclic: Mapping[int, float] | None = None, *, smooth: bool = False
) -> Comparison:
    """Compare the distributions of two records.

    Parameters
    ----------
    one, other : array, shape (time, state)
        Section points at one phase; each a whole number of 32 points is used, the last ones.
    scale : array, shape (state,)
        What differences of each state are divided by (`whirlmap.integrate.scales`).
    smooth : bool
        Whether both are tori.
    """
    placed = [coordinates(points, cyclic, scale) for points in (one, other)]
    centre = (placed[0].mean(axis=0) + placed[1].mean(axis=0)) / 2
    values = [_functions(points - centre) for points in placed]
    if smooth:
        means = [np.asarray(weighted_average(v)) for v in values]
        halves = [np.abs(weighted_average(v[: len(v) // 2]) - weighted_average(v[len(v) // 2 :])).max() for v in values]
        allowed = np.full(means[0].shape, max(HALVES * max(halves), LEAST))
    else:
        means = [v.mean(axis=0) for v in values]
        errors = [_error_of_mean(v) for v in values]
        allowed = _student(min(BLOCKS) - 1, means[0].size) * np.hypot(*errors) + LEAST
    difference = np.abs(means[0] - means[1])
    worst = int((difference / allowed).argmax())
    if difference[worst] <= allowed[worst]:
        return Comparison(float(difference[worst]), float(np.median(allowed)))
    return Comparison(float(difference[worst]), float(allowed[worst]))


def visits_like(runs: Array, trace: Array) -> NDArray[np.bool_]:
    """Whether the averages over short runs are among those over stretches of a trace that are as long.

    Parameters
    ----------
    runs : array, shape (run, time, coordinate)
        Points over the scales (`coordinates`).
    trace : array, shape (long time, coordinate)

    Returns
    -------
    array of bool, shape (run,)
        True where no average is further from that of the trace than `STRETCHES` times the furthest of a stretch, all in
        units of the scatter of the stretches; and where the trace is shorter than four runs.
    """
    length = runs.shape[1]
    count = len(trace) // length
    if count < 4:
        return np.ones(len(runs), dtype=bool)
    centre = trace.mean(axis=0)
    own = _functions(trace[-count * length :] - centre).reshape(count, length, -1).mean(axis=1)
    middle, scatter = own.mean(axis=0), own.std(axis=0, ddof=1) + LEAST
    limit = STRETCHES * (np.abs(own - middle) / scatter).max()
    out = np.empty(len(runs), dtype=bool)
    for some in np.array_split(np.arange(len(runs)), -(-len(runs) // TOGETHER)):
        means = _functions((runs[some] - centre).reshape(-1, centre.size)).reshape(some.size, length, -1).mean(axis=1)
        out[some] = (np.abs(means - middle) / scatter).max(axis=1) <= limit
    return out


def coordinates(points: Array, cyclic: Mapping[int, float] | None, scale: Array) -> Array:
    """Points (..., state) over their scales; an angle is its cosine and sine."""
    columns = []
    for k in range(points.shape[-1]):
        if cyclic and k in cyclic:
            angle = 2 * np.pi * points[..., k] / cyclic[k]
            columns += [np.cos(angle), np.sin(angle)]
        else:
            columns.append(points[..., k] / scale[k])
    return np.stack(columns, axis=-1)


def own_scale(points: Array) -> Array:
    """Range of each state of a record (time, state), at least `FLOOR` of its magnitude."""
    size = np.maximum(np.ptp(points, axis=0), FLOOR * np.abs(points).max(axis=0))
    return np.where(size > 0, size, 1.0)


def _functions(placed: Array) -> Array:
    """Values (time, function) of the functions that are averaged, of points (time, coordinate)."""
    n = placed.shape[1]
    random = np.random.default_rng(11).normal(size=(n, DIRECTIONS if n > 1 else 0))
    along = placed @ np.concatenate([np.eye(n), random / np.linalg.norm(random, axis=0)], axis=1)
    angles = 2 * np.pi * np.concatenate([wave * along for wave in WAVES], axis=1)
    return np.concatenate([np.cos(angles), np.sin(angles)], axis=1)


def _error_of_mean(values: Array) -> Array:
    """Standard error of each mean of values (time, function): the larger of those from short and from long blocks."""
    found = []
    for count in BLOCKS:
        length = len(values) // count
        means = values[-count * length :].reshape(count, length, -1).mean(axis=1)
        found.append(means.std(axis=0, ddof=1) / np.sqrt(count))
    return np.asarray(np.maximum(*found))


def _student(degrees: int, functions: int) -> float:
    """How many errors an average may be off by `CHANCE`, of so many functions, both signs."""
    from scipy.special import stdtrit

    return float(-stdtrit(2 * degrees, CHANCE / functions / 2))
