"""What is solved for at one point of a branch, and the equations there, linearised.

The unknowns of an orbit are its states at the beginnings of some segments, the duration of one that is not forced, and the
free parameters. An equilibrium has one state.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from whirlmap.results.status import Status

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Unknowns:
    """Unknowns of one point.

    Attributes
    ----------
    x : array, shape (segment, state)
        States at the beginnings of the segments; the first is at phase zero, or on the section.
    free : array, shape (parameter,)
        The free parameters, as they are varied.
    duration : float, optional
        Time of one return of an unforced cycle.
    """

    x: Array
    free: Array
    duration: float | None = None

    @property
    def vector(self) -> Array:
        """All of them in one row: states, duration, free parameters."""
        time = [] if self.duration is None else [self.duration]
        return np.concatenate([self.x.ravel(), time, self.free])

    def of(self, vector: Array) -> "Unknowns":
        """The same unknowns with other numbers."""
        states = self.x.size
        duration = None if self.duration is None else float(vector[states])
        return Unknowns(vector[:states].reshape(self.x.shape), vector[vector.size - self.free.size :], duration)

    def at(self, *free: float) -> "Unknowns":
        """The same states with other free parameters."""
        return replace(self, free=np.array(free))


@dataclass(frozen=True)
class Linear:
    """The equations at some unknowns.

    Attributes
    ----------
    residual : array, shape (equation,)
        What must vanish.
    jacobian : array, shape (equation, unknown)
    sizes : array, shape (unknown,)
        Sizes of the unknowns, in which steps are measured.
    weights : array, shape (equation,)
        Sizes of the residuals.
    matrices : array, shape (segment, state, state)
        Derivative of each segment's end by its beginning, in units of the states' sizes; of an equilibrium the Jacobian
        times the typical time.
    status : Status
        How the run of an orbit ended; where it is not ``ok``, the numbers are NaN.
    """

    residual: Array
    jacobian: Array
    sizes: Array
    weights: Array
    matrices: Array
    status: Status = Status.ok


class Equations(Protocol):
    """A kind of solutions: periodic orbits, equilibria, or events of either."""

    @property
    def key(self) -> tuple[Any, ...]:
        """What tells equations whose points may be computed together from others."""

    def linear(self, points: Sequence[Unknowns], before: Sequence[Linear | None] = ()) -> list[Linear]:
        """The equations at many points, computed side by side.

        ``before`` may hold what they were at points so near that the derivatives by the free parameters are the same.
        """

    def exponents(self, linear: Linear) -> tuple[Array, Array]:
        """Logarithms of the multipliers' moduli, largest first, and arguments; of an equilibrium growth and turn."""
