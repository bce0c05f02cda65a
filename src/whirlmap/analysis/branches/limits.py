"""Where branches end, and how finely they are followed."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.branches.corrector import Corrected
from whirlmap.analysis.branches.unknowns import Unknowns

Array = NDArray[np.float64]

#: Distance from the end of a range, over its width, that is rounding.
EDGE = 1e-10


@dataclass(frozen=True)
class Limits:
    """Where branches end, and how finely they are followed.

    Attributes
    ----------
    low, high : array, shape (free,)
        Ranges of the free parameters.
    longest : float
        Longest step, in units of the range and of the sizes of the states; where the branch is straight, of the range alone.
    points : int
        Most points of a branch in one direction.
    accuracy : float
        Largest error of an orbit's segments, over the sizes of the states.
    """

    low: Array
    high: Array
    longest: float = 0.02
    points: int = 2000
    accuracy: float = 1e-11

    @property
    def width(self) -> float:
        """Width of the first range."""
        return float(self.high[0] - self.low[0])

    def outside(self, point: Unknowns) -> NDArray[np.intp]:
        """Which free parameters lie beyond their range, by more than rounding."""
        beyond = EDGE * (self.high - self.low)
        return np.flatnonzero((point.free < self.low - beyond) | (point.free > self.high + beyond))

    def left(self, c: Corrected) -> tuple[int, float, float]:
        """Which free parameter reaches its end first along the tangent, at which length, and that end."""
        free = c.point.free
        rates = c.tangent[-free.size :]
        ends = np.where(rates > 0, self.high, self.low)
        with np.errstate(divide="ignore", invalid="ignore"):
            lengths = np.where(rates == 0, np.inf, np.maximum((ends - free) / rates, 0.0))
        k = int(lengths.argmin())
        return k, float(lengths[k]), float(ends[k])
