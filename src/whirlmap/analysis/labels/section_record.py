"""What is kept of the section points of runs: observables once per T, and all states once per common period."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.indicators.section_coordinates import OBSERVABLES, Watch

Array = NDArray[np.float64]


class SectionRecord:
    """Section points of some points, each as many as it has.

    Parameters
    ----------
    points, states : int
    every : int
        T between the section points of which all states are kept.
    cyclic : mapping of state index to period
    ranges : array, shape (state, point)
        Of the states over the motion.

    Attributes
    ----------
    watched : list of array, shape (observable, time)
        Observables of each point; their weights come from its first stretch.
    strobed : list of array, shape (time, state)
        Every ``every``-th section point.
    """

    def __init__(self, points: int, states: int, every: int, cyclic: Mapping[int, float], ranges: Array) -> None:
        self.every, self.cyclic, self.ranges = every, cyclic, ranges
        self.watched: list[Array] = [np.zeros((OBSERVABLES, 0)) for _ in range(points)]
        self.strobed: list[Array] = [np.zeros((0, states)) for _ in range(points)]
        self._watch: Watch | None = None

    def keep(self, which: NDArray[np.intp], section: Array) -> None:
        """Keep a stretch of some of the points, shape (time, state, point), NaN where there are no more crossings.

        The first one is of all points, and whole common periods long, as all others are.
        """
        if self._watch is None:
            self._watch = Watch(np.where(np.isfinite(section), section, section[:1]), self.cyclic, self.ranges)
        watched, last = self._watch(section, which), self.every - 1
        for k, point in enumerate(which):
            seen = np.isfinite(section[:, 0, k])
            strobed = section[last :: self.every, :, k][seen[last :: self.every]]
            self.watched[point] = np.concatenate([self.watched[point], watched[k][:, seen]], axis=1)
            self.strobed[point] = np.concatenate([self.strobed[point], strobed])
