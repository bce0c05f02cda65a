"""Results for non-periodic operating points."""

from dataclasses import dataclass, field, fields

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.labels.regime import Rule
from whirlmap.results.regime import Regime

Array = NDArray[np.float64]
Points = NDArray[np.intp]


@dataclass(frozen=True)
class NonperiodicResults:
    """Results, each array of shape (point,).

    Attributes
    ----------
    regime : array of int
        `Regime`: quasi-periodic, chaotic, locked or undecided.
    rule : array of int
        `Rule` that decided.
    confidence, winding : array
        As of `whirlmap.analysis.labels.regime.regime`.
    exponent, error : array
        Largest Lyapunov exponent and one standard error, per unit of the model's time.
    periods : array of int
        T over which it was measured.
    shrinks : array of bool
        Whether the tangent vector shrinks for sure.
    closes : array of bool
        Whether its section comes near to a return, and nearer as time goes on.
    growth : array
        Rate per unit of time at which the section's range grows or falls steadily; NaN where it does not.
    drift : array, shape (state, point)
        Speed per unit of time at which the section's mean moves steadily; zero where it does not.
    centre, reach : array, shape (state, point)
        Of the section, as in `Trends`.
    x : array, shape (state, point)
        Where the run was left, at phase zero.
    nearest : array of int
        Return in common periods that the section comes nearest to, 0 where none was sought.
    nearness : array
        Its scaled distance, by the last section point.
    returned : array of bool
        Whether the end of the run returns after so many, to the tolerance.
    multiple : array of int
        n of a locked motion.
    paths : dict of array, shape (time, state)
        Last section points of points that may return, once per common period.
    """

    regime: NDArray[np.int8]
    rule: NDArray[np.int8]
    confidence: Array
    winding: Array
    exponent: Array
    error: Array
    periods: NDArray[np.int64]
    shrinks: NDArray[np.bool_]
    closes: NDArray[np.bool_]
    growth: Array
    drift: Array
    centre: Array
    reach: Array
    x: Array
    nearest: NDArray[np.int64]
    nearness: Array
    returned: NDArray[np.bool_]
    multiple: NDArray[np.int64]
    paths: dict[int, Array] = field(default_factory=dict)

    @classmethod
    def none(cls, x: Array) -> "NonperiodicResults":
        """Points of which nothing is known yet, at states of shape (state, point)."""
        states, points = x.shape
        zero, unknown = np.zeros((states, points)), np.full((5, points), np.nan)
        whole, no = np.zeros((3, points), dtype=np.int64), np.zeros((3, points), dtype=bool)
        return cls(
            np.full(points, Regime.undecided, dtype=np.int8), np.full(points, Rule.none, dtype=np.int8), np.zeros(points),
            unknown[0], unknown[1], unknown[2], whole[0], no[0], no[1], unknown[3], zero, zero.copy(), zero.copy(), x.copy(),
            whole[1], unknown[4], no[2], whole[2],
        )  # fmt: skip

    def take(self, other: "NonperiodicResults", points: Points) -> None:
        """Take over what was found of some points."""
        for one in fields(self):
            if one.name != "paths":
                getattr(self, one.name)[..., points] = getattr(other, one.name)
        self.paths.update({int(points[k]): path for k, path in other.paths.items()})
