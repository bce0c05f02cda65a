"""The finest common grid of spectral lines whose chance of fitting is bounded: one frequency of which all are multiples."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Errors of a line within which it lies on a grid: faint lines beside it, which no model has, pull it by some of them.
ERRORS = 3.8
#: Chance up to which a grid is believed, and above which one that fits says nothing.
BELIEVED, ANYTHING = 0.01, 0.1
#: Cycles per record by which lines may miss a coarse grid without being called unrelated.
NEAR = 0.02
#: Periods that a record must hold at least.
PERIODS = 2.5
#: Multiples of a fundamental considered beyond the Nyquist frequency, their largest share of the power, and finest grid that
#: may have them.
FOLDED, WEAK, COARSE = 60, 0.05, 3
#: Coefficients of sums of two lines.
SUMS = 6
#: Largest number of grids.
GRIDS = 200_000

GridKind = Literal["grid", "chance", "none"]


@dataclass(frozen=True)
class CommonGrid:
    """What was found.

    Attributes
    ----------
    kind : str
        ``grid``; ``chance`` where one fits that might do so by chance; ``none``.
    fundamental, error : float
        Cycles per record.
    multiples : array of int, shape (line,)
        Of each line; of folded ones the multiple beyond the Nyquist frequency.
    chance : float
        That a line somewhere would have fitted a grid as coarse as this one, or a coarser one.
    """

    kind: GridKind
    fundamental: float
    error: float
    multiples: NDArray[np.int64]
    chance: float


def common_grid(frequency: Array, error: Array, share: Array, *, samples: int) -> CommonGrid:
    """Find the coarsest grid on which all lines lie.

    Parameters
    ----------
    frequency, error : array, shape (line,)
        Cycles per record, the strongest line first.
    share : array, shape (line,)
        Share of the power.
    samples : int
        Of the record: lines beyond half of them are folded back.

    Notes
    -----
    The strongest line is the k-th multiple of the fundamental, k = 1, 2, ..., as long as the record holds 2.5 periods. A
    line lies on a grid where it is within 3.8 errors, its own and that of the strongest line carried to it. A line without
    relation does so with the chance 2 t k / f, t the tolerance and f the strongest line: the sum over all grids up to k
    is the chance that such a line would have fitted by now. Its factors are up to two lines, the first that is no multiple
    of the strongest and the first that is no sum of both: harmonics and sums are no independent witnesses. Weak lines may
    also be multiples beyond the Nyquist frequency, folded back, where that is no chance: of edges, and of rounding to few
    levels.
    """
    f, top = frequency, float(frequency[0])
    none = CommonGrid("none", np.nan, np.nan, np.zeros(f.size, np.int64), 1.0)
    most = int(min(max(top / PERIODS, 1.0), GRIDS))
    tolerance = ERRORS * np.hypot(error, error[0] * f / top)
    tolerance[0] = 0.0
    k = np.arange(1, most + 1)[:, None]
    spacing = top / k
    multiple = np.round(f / spacing)
    off = np.abs(f - multiple * spacing)
    on = (off <= tolerance) & (multiple >= 1)
    on[:, 0] = True
    for row in range(min(COARSE, most)):
        weak = ~on[row] & (share < WEAK)
        if (on[row] | weak).all() and weak.any():
            which, at, chances = _folded(f, tolerance, float(spacing[row, 0]), samples)
            if which[weak].all() and np.prod(np.minimum(chances[weak], 1.0)) < BELIEVED / COARSE:
                multiple[row] = np.where(weak, at, multiple[row])
                on[row] = True
    fits = np.flatnonzero(on.all(axis=1))
    if not fits.size:  # a miss by less than faint lines between may pull a frequency is no proof that there is no grid
        near = (off[:COARSE] <= np.maximum(tolerance, NEAR)).all(axis=1)
        return replace(none, kind="chance") if near.any() else none
    best = int(fits[0])
    witnesses = _witnesses(f, tolerance, on[0])
    factors = [np.minimum(1.0, 2 * tolerance[w] * k[: best + 1, 0] / top) for w in witnesses]
    chance = float(np.prod(factors, axis=0).sum()) if factors else 0.0
    if chance > ANYTHING:
        return none
    m = multiple[best].astype(np.int64)
    direct = m * float(spacing[best, 0]) <= samples / 2 * (1 + 1e-9)
    weight = np.where(direct, 1.0 / error**2, 0.0)
    whole = float((weight * m**2).sum())
    fundamental = float((weight * m * f).sum()) / whole
    return CommonGrid("grid" if chance <= BELIEVED else "chance", fundamental, whole**-0.5, m, min(chance, 1.0))


def _witnesses(f: Array, tolerance: Array, harmonic: NDArray[np.bool_]) -> list[int]:
    """Lines that say something of their own: no multiple of the strongest, and no sum of it and the first such line."""
    alone = np.flatnonzero(~harmonic)
    if not alone.size:
        return []
    first = int(alone[tolerance[alone].argmin()])
    p, q = (v.ravel() for v in np.meshgrid(np.arange(-SUMS, SUMS + 1), np.arange(-SUMS, SUMS + 1)))
    sums = p * f[0] + q * f[first]
    for other in alone:
        if other != first and np.abs(sums - f[other]).min() > 2 * tolerance[other]:
            return [first, int(other)]
    return [first]


def _folded(f: Array, tolerance: Array, fundamental: float, samples: int) -> tuple[NDArray[np.bool_], Array, Array]:
    """Which lines are multiples beyond the Nyquist frequency, folded back; which multiples; the chance of each to be one."""
    m = np.arange(1, FOLDED + 1) + int(samples / 2 / fundamental)
    image = np.abs((m * fundamental + samples / 2) % samples - samples / 2)
    off = np.abs(f[:, None] - image)
    nearest = off.argmin(axis=1)
    at = m[nearest]
    # The error of the fundamental grows with the multiple.
    wide = tolerance * np.maximum(1.0, at * fundamental / np.maximum(f, 1e-9))
    return off[np.arange(f.size), nearest] <= wide, at.astype(float), 4 * FOLDED * wide / samples
