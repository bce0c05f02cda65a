"""Weighted Birkhoff averages: rotation numbers of quasi-periodic motion, and how surely it is quasi-periodic.

Plain time averages converge as 1/N. With weights that vanish smoothly at both ends, averages over smooth
quasi-periodic motion converge faster than any power of N, over chaos still as 1/sqrt(N): the speed of convergence
tells them apart without a neighbour, an embedding or an exponent [das2017] [sander2020].
"""

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import ArrayLike, NDArray

from whirlmap.errors import RangeError

Array = NDArray[np.float64]

#: Digits that no average can exceed.
MOST_DIGITS = 16.0


def weighted_average(values: ArrayLike) -> Array:
    """Weighted Birkhoff average over the first axis, weights exp(-1/(t(1 - t))) with t = 1/(N+1), ..., N/(N+1)."""
    # Each series in one piece, and no matrix product: the sums of one series must not depend on the others.
    x = np.ascontiguousarray(np.moveaxis(np.asarray(values, dtype=np.float64), 0, -1))
    t = np.arange(1, x.shape[-1] + 1) / (x.shape[-1] + 1)
    weight = np.exp(-1.0 / (t * (1.0 - t)))
    return np.asarray((x * (weight / weight.sum())).sum(axis=-1))


def converged_digits(values: ArrayLike) -> Array:
    """Digits to which the averages over the two halves of each series agree.

    Parameters
    ----------
    values : array, shape (time, ...)
        Settled section points, iterates, or samples; each series by itself.

    Returns
    -------
    array, shape (...)
        -log10 of |difference| over the standard deviation of the series, from 0 to 16; NaN for a series that is
        constant, or not finite.

    Raises
    ------
    RangeError
        Fewer than 64 samples.

    Notes
    -----
    [sander2020]. With N = 1000 smooth quasi-periodic motion shows 6 to 14 digits, chaos 1 to 3. A series whose slowest
    beat is not much shorter than N/2 shows few digits although it is quasi-periodic; so does one on a torus that is
    about to break up. Errors of the integration end the convergence at their own size.
    """
    x = np.asarray(values, dtype=np.float64)
    if x.ndim < 1 or x.shape[0] < 64:
        raise RangeError(f"values has shape {x.shape}: at least 64 samples along the first axis are needed.")
    half = x.shape[0] // 2
    with np.errstate(invalid="ignore"):
        difference = np.abs(weighted_average(x[:half]) - weighted_average(x[half : 2 * half]))
        size = np.ascontiguousarray(np.moveaxis(x, 0, -1)).std(axis=-1)
        moves = size > 1e-13 * np.abs(x).max(axis=0)
    share = np.divide(difference, size, out=np.full(size.shape, np.nan), where=moves)
    return np.asarray(np.clip(-np.log10(np.maximum(share, 10.0**-MOST_DIGITS)), 0.0, MOST_DIGITS))


@dataclass(frozen=True)
class RotationNumber:
    """Rotation number of a closed section curve.

    Attributes
    ----------
    number : float
        Turns around the curve's centre per sample, in [0, 1), anticlockwise in the plane given; the motion may make any
        whole number of turns more, which the section cannot see. NaN unless ``status`` is ``ok``.
    error : float
        Difference between the halves of the record.
    status : str
        ``ok``; ``through-centre``: the angles' steps have no gap, so that they cannot be unwrapped: no closed curve
        around its centre, as for chaos; ``not-finite``.
    """

    number: float
    error: float
    status: str


def rotation_number(x: ArrayLike, y: ArrayLike, *, least_gap: float = 0.02) -> RotationNumber:
    """Rotation number of points that go round a closed curve, with its error.

    Parameters
    ----------
    x, y : array, shape (time,)
        Successive section points in a plane in which the curve surrounds its centre.
    least_gap : float
        Part of a turn in which no step of the angle may fall.

    Raises
    ------
    RangeError
        Fewer than 64 points, or shapes differ.

    Notes
    -----
    Weighted Birkhoff average of the steps of the angle about the weighted mean of the points [das2017]. The steps are
    a continuous function on the curve, known modulo one turn: they are cut where they leave the widest gap. A curve
    that does not surround its mean needs another plane.
    """
    u, v = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
    if u.shape != v.shape or u.ndim != 1 or u.size < 64:
        raise RangeError(f"x and y have shapes {u.shape} and {v.shape}: twice (time,) with at least 64 are needed.")
    return rotation_numbers(u[None], v[None], least_gap=least_gap)[0]


def rotation_numbers(x: Array, y: Array, *, least_gap: float = 0.02) -> list[RotationNumber]:
    """`rotation_number` of many curves, ``x`` and ``y`` of shape (curve, time)."""
    out = [RotationNumber(np.nan, np.nan, "not-finite")] * len(x)
    finite = np.flatnonzero((np.isfinite(x) & np.isfinite(y)).all(axis=1))
    u, v = x[finite], y[finite]
    angle = np.arctan2(v - weighted_average(v.T)[:, None], u - weighted_average(u.T)[:, None]) / (2 * np.pi)
    step = np.diff(angle) % 1.0
    ordered = np.sort(step)
    following = np.roll(ordered, -1, axis=1)
    following[:, -1] += 1.0
    gaps = following - ordered
    widest = gaps.argmax(axis=1)[:, None]
    cut = np.take_along_axis(ordered, (widest + 1) % ordered.shape[1], axis=1)
    lifted = (step - cut) % 1.0
    half = lifted.shape[1] // 2
    number = (cut[:, 0] + weighted_average(lifted.T)) % 1.0
    error = np.abs(weighted_average(lifted[:, :half].T) - weighted_average(lifted[:, half : 2 * half].T))
    open_gap = np.take_along_axis(gaps, widest, axis=1)[:, 0] >= least_gap
    for k, curve in enumerate(finite):
        found = RotationNumber(float(number[k]), float(error[k]), "ok")
        out[curve] = found if open_gap[k] else RotationNumber(np.nan, np.nan, "through-centre")
    return out


@dataclass(frozen=True)
class Locking:
    """Rational p/q near a rotation number, and whether the number is that within its error."""

    ratio: Fraction
    distance: float
    locked: bool


def locking_ratio(number: float, error: float, *, most: int = 64) -> Locking:
    """Simplest ratio that a rotation number equals within its error, else the nearest one.

    Parameters
    ----------
    error : float
        Of the number; three of it, and at least 1e-9, are granted.
    most : int
        Largest denominator.

    Notes
    -----
    Denominators upwards: the first within the error wins, and the motion is *locked*. The rationals up to q lie about
    1/q^2 apart, so that with an error above 1/most^2 everything looks locked: such a number is refused.

    Raises
    ------
    RangeError
        The number is not finite, or its error too large for ``most``.
    """
    if not np.isfinite(number) or not 0 <= error * most**2 < 1:
        raise RangeError(f"rotation number {number} +- {error} cannot be told from a ratio with denominators to {most}.")
    nearest = Fraction(round(number))
    for q in range(1, most + 1):
        ratio = Fraction(round(number * q), q)
        distance = abs(number - float(ratio))
        if distance <= max(3 * error, 1e-9):
            return Locking(ratio, distance, True)
        if distance < abs(number - float(nearest)):
            nearest = ratio
    return Locking(nearest, abs(number - float(nearest)), False)
