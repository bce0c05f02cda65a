"""Segments of orbits: side by side in lanes, and their matrices one after the other round an orbit."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.branches.unknowns import Unknowns

Array = NDArray[np.float64]


def cycle(out: Array, matrices: Array, last: float) -> None:
    """Add those of the segments to a matrix, less the identity at the next; ``last`` times it where it closes."""
    count, n, _ = matrices.shape
    for k in range(count):
        here, after = slice(k * n, k * n + n), (k + 1) % count * n
        out[here, here] += matrices[k]
        out[here, after : after + n] += (last if k == count - 1 else -1.0) * np.eye(n)


@dataclass(frozen=True)
class Lanes:
    """Segments of many orbits, one lane each.

    Attributes
    ----------
    x : array, shape (state, lane)
    free : array, shape (free, lane)
    orbit, place, share : arrays of int, shape (lane,)
        Which orbit a segment belongs to, its place there, and the number of that orbit's segments.
    time : array, shape (lane,)
        Duration of a cycle's segment; NaN of a forced one.
    """

    x: Array
    free: Array
    orbit: NDArray[np.intp]
    place: NDArray[np.intp]
    share: NDArray[np.intp]
    time: Array

    @classmethod
    def of(cls, points: Sequence[Unknowns]) -> "Lanes":
        """One lane for each segment of each orbit."""
        counts = [len(p.x) for p in points]
        orbit = np.repeat(np.arange(len(points)), counts)
        place = np.concatenate([np.arange(c) for c in counts])
        share = np.array(counts)[orbit]
        free = np.stack([p.free for p in points], axis=1)[:, orbit]
        durations = np.array([np.nan if p.duration is None else p.duration for p in points])
        return cls(np.concatenate([p.x for p in points]).T, free, orbit, place, share, durations[orbit] / share)

    def repeated(self, times: int) -> "Lanes":
        """The same lanes several times."""
        orbit, place, share = (np.tile(a, times) for a in (self.orbit, self.place, self.share))
        x, free = (np.tile(a, (1, times)) for a in (self.x, self.free))
        return Lanes(x, free, orbit, place, share, np.tile(self.time, times))
