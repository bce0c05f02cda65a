"""How the points of an ensemble settled: what every search for steady motion gives."""

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from whirlmap.integrate.ensemble import Ensemble

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass(frozen=True)
class Settled:
    """How every point of an ensemble settled; arrays end in the point axis.

    Attributes
    ----------
    multiple : array of int
        Smallest return in common periods; 0 where there is none.
    distance : array
        The return distance that decided, over the range of each state; where a point was given up, the smallest one. NaN
        where it ended.
    scale : array, shape (state, point)
        Size of each state since the look before the last (`integrate.scales`), times how wide the tolerance is.
    waited : array of int
        Common periods run, extrapolation attempts included.
    accelerated : array of bool
        Whether convergence was accelerated.
    moved : array, shape (state, point)
        Largest range of each state between two looks, from the start on.
    growth : array
        Rate per common period of the amplitude of points that grew steadily beyond the bound; NaN in others.
    drift : array, shape (state, point)
        Speed per common period of the mean of points that drifted beyond the bound; zero in others.
    thinning, turning : array
        Power of time with which a gap fell where steps failed at last, and rotation number (`trends.film_thinning`); NaN in
        others.
    """

    multiple: Integers
    distance: Array
    scale: Array
    waited: Integers
    accelerated: NDArray[np.bool_]
    moved: Array
    growth: Array
    drift: Array
    thinning: Array
    turning: Array

    @classmethod
    def none(cls, ensemble: Ensemble) -> "Settled":
        """Points that have not begun."""
        n, states = ensemble.points, ensemble.model.dimension
        none = np.zeros(n, dtype=np.int64), np.full(n, np.nan), np.full((states, n), np.nan)
        zero = np.zeros((states, n))
        return cls(
            *none, np.zeros(n, dtype=np.int64), np.zeros(n, dtype=np.bool_), zero, np.full(n, np.nan), zero.copy(),
            np.full(n, np.nan), np.full(n, np.nan),
        )  # fmt: skip

    def of(self, points: NDArray[np.intp]) -> "Settled":
        """How some of the points settled."""
        return Settled(*(getattr(self, one.name)[..., points] for one in fields(self)))

    def forget(self, points: NDArray[np.intp]) -> None:
        """Forget how far points moved that begin anew: with too few steps that was not their motion."""
        self.moved[:, points] = 0.0

    def take(self, again: "Settled", points: NDArray[np.intp]) -> None:
        """Take over how some points settled that have settled on, in place; the time they waited adds up."""
        self.multiple[points], self.distance[points] = again.multiple, again.distance
        self.scale[:, points], self.accelerated[points] = again.scale, again.accelerated
        self.waited[points] += again.waited
        self.moved[:, points] = np.maximum(self.moved[:, points], again.moved)
        self.growth[points], self.drift[:, points] = again.growth, again.drift
        self.thinning[points], self.turning[points] = again.thinning, again.turning
