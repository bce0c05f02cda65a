"""Newton's method onto a branch: many points at once, each in a hyperplane of its own.

The hyperplane's normal may be the branch's tangent (pseudo-arclength), a chord between two points of it (events), or the
direction of a free parameter (the ends of a range).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.branches.unknowns import Equations, Linear, Unknowns
from whirlmap.results.status import Status

Array = NDArray[np.float64]

#: Iterations at most; scaled steps below which one is rounding, and below which one that no longer falls is.
ITERATIONS, ROUNDING, STALLED = 12, 1e-12, 1e-7
#: Scaled step at an iterate whose derivatives are as good as those at the solution, and next one that need not be taken.
SOON, NEXT = 1e-6, 1e-12
#: Scaled step at an iterate whose derivatives by the free parameters are near enough for a step to the next point.
NEAR = 1e-3
#: Scaled residual with which a point may be one: a step is small too where a derivative is far too large, beside a pole.
CLOSED = 1e-7
#: Roundings of a state that a residual may be of, stretched as the derivatives by states say.
ROUNDINGS = 16 * float(np.finfo(float).eps)
#: Largest scaled step in one iteration: beyond, the method has left the branch.
FARTHEST = 3.0
#: Condition number beyond which a matrix is singular.
SINGULAR = 1e11


@dataclass(frozen=True)
class Ask:
    """A point to be corrected.

    Attributes
    ----------
    equations : Equations
    guess : Unknowns
    normal : array, shape (unknown,)
        Of the hyperplane through the guess, in units of ``sizes``.
    sizes : array, shape (unknown,)
    exact : bool
        Whether the derivatives must be those at the solution, as events need them; where not, those at an iterate that is
        off by 1e-6 at most will do, and those by the free parameters at one that is off by 1e-3.
    """

    equations: Equations
    guess: Unknowns
    normal: Array
    sizes: Array
    exact: bool = True


@dataclass(frozen=True)
class Corrected:
    """A point of a branch.

    Attributes
    ----------
    equations : Equations
    point : Unknowns
    linear : Linear
        The equations there, linearised.
    tangent : array, shape (unknown,)
        Direction of the branch, in the unknowns' own units; of unit length in units of ``linear.sizes``, and on the side of
        the normal with which the point was found.
    turned : float
        Sign of the determinant of derivatives and tangent: it changes at a branch point.
    iterations : int
    step_error : float, optional
        Error of its steps, where that was measured (`orbit_steps.step_error`).
    """

    equations: Equations
    point: Unknowns
    linear: Linear
    tangent: Array
    turned: float
    iterations: int
    step_error: float | None = None

    @cached_property
    def exponents(self) -> tuple[Array, Array]:
        """As `Equations.exponents`."""
        return self.equations.exponents(self.linear)

    @property
    def value(self) -> float:
        """The first free parameter."""
        return float(self.point.free[0])


@dataclass(frozen=True)
class Lost:
    """A point that was not found: how the run of the last iterate ended."""

    status: Status


def correct(asks: Sequence[Ask]) -> list[Corrected | Lost]:
    """Correct many points; those of the same equations are computed side by side.

    Notes
    -----
    Newton's method with the exact matrices of the segments. What is found by differences (derivatives by free parameters) is
    kept from an iterate that is off by 1e-6 at most; where derivatives need not be exact, by 1e-3. A point is found where
    the scaled residual is below `CLOSED`, or is what the rounding of states grows to, and a step is rounding, or below 1e-7
    and no longer falls; where its derivatives need not be exact, already where a step is so small, and so much smaller than
    the one before, that the next would be rounding. It is lost where a step is longer than `FARTHEST` sizes, where a run
    ends early, or after `ITERATIONS`.
    """
    out: list[Corrected | Lost] = [Lost(Status.ok)] * len(asks)
    last: list[Linear | None] = [None] * len(asks)
    now, before = [a.guess for a in asks], np.full(len(asks), np.inf)
    left = list(range(len(asks)))
    for turn in range(ITERATIONS):
        found = _linear([(asks[k].equations, now[k], last[k]) for k in left])
        stay = []
        for k, linear in zip(left, found, strict=True):
            ask = asks[k]
            if linear.status != Status.ok or not np.isfinite(linear.jacobian).all():
                out[k] = Lost(linear.status if linear.status != Status.ok else Status.failed)
                continue
            off = ask.normal @ ((now[k].vector - ask.guess.vector) / ask.sizes)
            right = np.append(linear.residual / linear.weights, off)
            step, tangent, sign = _solve(linear, ask.normal, ask.sizes, right)
            size = float(np.abs(step / ask.sizes).max())
            if not size <= FARTHEST:
                continue
            now[k] = now[k].of(now[k].vector - step)
            soon = not ask.exact and size <= SOON and size * size <= NEXT * before[k] < np.inf
            closed = np.abs(linear.residual / linear.weights).max() <= max(CLOSED, _rounding(linear, ask))
            if closed and (size <= ROUNDING or (size <= STALLED and size > 0.3 * before[k]) or soon):
                length = np.linalg.norm(tangent / linear.sizes)
                out[k] = Corrected(ask.equations, now[k], linear, tangent / length, sign, turn + 1)
                continue
            before[k], last[k] = size, linear if size <= (SOON if ask.exact else NEAR) else None
            stay.append(k)
        left = stay
        if not left:
            break
    return out


def _linear(points: Sequence[tuple[Equations, Unknowns, Linear | None]]) -> list[Linear]:
    """Linearise points, those of the same equations in one call."""
    out: list[Linear | None] = [None] * len(points)
    for key, equations in {e.key: e for e, _, _ in points}.items():
        mine = [k for k, (e, _, _) in enumerate(points) if e.key == key]
        found = equations.linear([points[k][1] for k in mine], [points[k][2] for k in mine])
        for k, linear in zip(mine, found, strict=True):
            out[k] = linear
    return [linear for linear in out if linear is not None]


def _solve(linear: Linear, normal: Array, sizes: Array, right: Array) -> tuple[Array, Array, float]:
    """Newton step and tangent, in the unknowns' units, and the sign of the determinant of derivatives and tangent.

    At a branch point the matrix is singular, and the equations are consistent all the same: the shortest step solves them
    there. The tangent is then the normal, for want of another, and the sign zero.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        matrix = np.vstack([linear.jacobian * sizes / linear.weights[:, None], normal])
    ahead = np.zeros(right.size)
    ahead[-1] = 1.0
    if not np.isfinite(matrix).all():  # a segment that stretches beyond all numbers
        return np.full(right.size, np.inf), ahead, 0.0
    with np.errstate(over="ignore", invalid="ignore"):
        try:
            step, tangent = np.linalg.solve(matrix, np.stack([right, ahead], axis=1)).T
        except np.linalg.LinAlgError:
            step, tangent = np.full((2, right.size), np.inf)
        if not np.abs(step).max() <= FARTHEST and SINGULAR < np.linalg.cond(matrix) < np.inf:
            return np.linalg.lstsq(matrix, right, rcond=1 / SINGULAR)[0] * sizes, normal * sizes, 0.0
        unit = tangent / np.linalg.norm(tangent)
    matrix[-1] = unit
    return step * sizes, tangent * sizes, float(np.linalg.slogdet(matrix)[0])


def _rounding(linear: Linear, ask: Ask) -> float:
    """Scaled residual that the rounding of states comes to; derivatives by free parameters have no say."""
    states = ask.guess.x.size
    scaled = linear.jacobian[:, :states] * ask.sizes[:states] / linear.weights[:, None]
    return ROUNDINGS * float(np.abs(scaled).sum(axis=1).max())


def along_parameter(point: Unknowns, which: int = 0) -> Array:
    """Normal of the hyperplane in which a free parameter stays."""
    normal = np.zeros(point.vector.size)
    normal[normal.size - point.free.size + which] = 1.0
    return normal
