"""Trends of a motion, from its section points alone: steady growth, decay or drift.

The sections of a bounded motion (a cycle, a torus, chaos) have spreads that do not change from one part of a long record to
the next, and a constant mean. A steady change is a candidate only: whether it is unbounded is another
question (`goes_on`).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.indicators.birkhoff import weighted_average

Array = NDArray[np.float64]

#: Parts of a record whose spreads are compared, and least section points in each.
PARTS, LEAST = 8, 4
#: Least change of the logarithm of the amplitude over a record, and largest part of it by which the parts may miss a line.
CHANGE, BEND = 1e-3, 0.2
#: A drift moves the mean by so many ranges of what is left without it, and as fast in both parts of a record's last half.
FAR, EVEN = 10.0, 1e-3


@dataclass(frozen=True)
class Trend:
    """Steady changes per section point, arrays that end in the point axis.

    Attributes
    ----------
    growth : array, shape (point,)
        Growth rate of the amplitude, negative where it dies away; NaN where it does not change steadily.
    drift : array, shape (state, point)
        Speed of the mean; zero in states whose mean is constant or does not move steadily.
    """

    growth: Array
    drift: Array


def trend(section: Array, cyclic: dict[int, float] | None = None, least: Array | None = None) -> Trend:
    """Growth and drift of many motions.

    Parameters
    ----------
    section : array, shape (time, state, point)
        Section points, once per common period or crossing. Points with NaN, and records shorter than `PARTS` times
        `LEAST`, show no trend.
    cyclic : mapping of state index to period, optional
        Angles, which are left out: one that goes round does not drift.
    least : array, shape (state, point), optional
        Spread below which a state counts as constant: that of the surface that a section lies on is rounding.

    Notes
    -----
    The amplitude of each of `PARTS` parts is the mean over the moving states of the state's spread in that part over its
    largest; its logarithm must rise or fall from every part to the next, along a line. Spreads are taken with the weights of
    Birkhoff averages, for a few turns of a whirl, sampled as they come, have another spread each time.
    """
    rows, states, points = section.shape
    growth, drift = np.full(points, np.nan), np.zeros((states, points))
    plain = [k for k in range(states) if k not in (cyclic or {})]
    good = np.flatnonzero(np.isfinite(section).all(axis=(0, 1)))
    if rows < PARTS * LEAST or not plain or not good.size:
        return Trend(growth, drift)
    x = section[:, plain][:, :, good]
    drift[np.array(plain)[:, None], good] = _drift(x)
    still = (drift[:, good] == 0).all(axis=0)
    moves = np.zeros_like(x[0]) if least is None else least[plain][:, good]
    growth[good[still]] = _growth(x[:, :, still], moves[:, still])
    return Trend(growth, drift)


def spread(x: Array) -> Array:
    """Standard deviation over the first axis, with the weights of `weighted_average`."""
    return np.asarray(np.sqrt(weighted_average((x - weighted_average(x)) ** 2)))


def _growth(x: Array, least: Array) -> Array:
    """Slope of the logarithm of the amplitude per row; NaN where it is not steady."""
    length = x.shape[0] // PARTS
    parts = x[-PARTS * length :].reshape(PARTS, length, *x.shape[1:])
    sizes = spread(np.moveaxis(parts, 1, 0))
    largest = sizes.max(axis=0)
    moving = largest > least
    share = np.divide(sizes, largest, out=np.zeros_like(sizes), where=moving)
    # What is summed stands in one piece: a point's sums must not depend on those beside it.
    whole = np.ascontiguousarray(np.moveaxis(share, 1, -1)).sum(axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        size = np.ascontiguousarray(np.log(whole / moving.sum(axis=0)).T)
        steps = np.diff(size)
        same = (steps > 0).all(axis=1) | (steps < 0).all(axis=1)
        at = np.arange(PARTS) - (PARTS - 1) / 2
        slope = (at * size).sum(axis=1) / (at**2).sum()
        off = np.abs(size - size.mean(axis=1)[:, None] - slope[:, None] * at).max(axis=1)
        total = np.abs(slope) * (PARTS - 1)
        steady = same & (off <= BEND * total) & (total >= CHANGE)
    return np.where(steady, slope / length, np.nan)


def _drift(x: Array) -> Array:
    """Speed of the mean of each state per row; zero where it is not steady."""
    x = x[x.shape[0] // 2 :]  # the first half may be a transient
    step = np.diff(x, axis=0)
    half = step.shape[0] // 2
    first, second = weighted_average(step[:half]), weighted_average(step[-half:])
    speed = (first + second) / 2
    rest = x - speed * np.arange(x.shape[0])[:, None, None]
    far = np.abs(speed) * x.shape[0] > FAR * np.ptp(rest, axis=0)
    even = np.abs(first - second) <= EVEN * np.abs(speed)
    return np.where(far & even, speed, 0.0)
