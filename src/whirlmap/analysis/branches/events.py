"""Bifurcation points between two neighbouring points of a branch: which there are, and where.

Folds change the sign of the tangent's part along the parameter; branch points that of the determinant of derivatives and
tangent; period doublings that of det(M + I). A Neimark-Sacker or Hopf point takes a pair of multipliers across the unit
circle: what is left of the change in their number once the others are counted. The number of multipliers outside must then
be explained; where it is not, or where two kinds lie in one step, the step is too long.
"""

from collections.abc import Callable, Generator
from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.branches.bracketing import located
from whirlmap.analysis.branches.corrector import Ask, Corrected, Lost
from whirlmap.analysis.branches.equilibria import Equilibria
from whirlmap.analysis.branches.periodic_orbits import PeriodicOrbits
from whirlmap.analysis.branches.segments import cycle
from whirlmap.analysis.branches.unknowns import Linear

Array = NDArray[np.float64]

#: Logarithm of a modulus beyond which a multiplier lies outside the unit circle, not on it.
OUTSIDE = 1e-9
#: Arguments closer than this to 0 or pi are no pair's.
REAL = 1e-6
#: Distance, in sizes, within which a fold and a branch point are one.
ONE_POINT = 1e-4


@dataclass(frozen=True)
class Event:
    """A bifurcation point, or a grazing orbit.

    Attributes
    ----------
    kind : str
        ``fold``, ``branch-point``, ``period-doubling``, ``neimark-sacker``, ``hopf`` or ``grazing``.
    at : Corrected
    surface : str
        Which switching a grazing orbit touches.
    contacts : int
        How many contacts of the orbit begin or end within the step in which it lies.
    """

    kind: str
    at: Corrected
    surface: str = ""
    contacts: int = 1


class StepTooLongError(Exception):
    """Events that cannot be told apart, or not explained, in one step."""


def outside(c: Corrected) -> int:
    """Number of multipliers outside the unit circle."""
    return int((c.exponents[0] > OUTSIDE).sum())


def may_cross_twice(p: Corrected, a: Corrected, b: Corrected, first: float, second: float) -> bool:
    """Whether a multiplier may cross the unit circle and come back between two points, or an eigenvalue the axis.

    Two such events would cancel. A parabola goes through the logarithms of the modulus, or the real parts, at three points
    of a branch, the steps between which are given. Its extreme in the second step, twice as far from the points as it is,
    lies on the other side.
    """
    count = outside(a)
    if not isinstance(a.equations, PeriodicOrbits | Equilibria) or outside(b) != count:
        return False
    for k, sign in ((count, 1.0), (count - 1, -1.0)):
        if not 0 <= k < a.exponents[0].size:
            continue
        before, here, there = (sign * float(c.exponents[0][k]) for c in (p, a, b))
        slope = (there - here) / second
        bend = (slope - (here - before) / first) / (first + second)
        at = second / 2 - slope / (2 * bend) if bend < 0 else -1.0
        if 0 < at < second:
            top = here + slope * at + bend * at * (at - second)
            if 2 * top - max(here, there) > sign * OUTSIDE:
                return True
    return False


def events_between(a: Corrected, b: Corrected, *, alone: bool = True) -> Generator[Ask, Corrected | Lost, list[Event]]:
    """Bifurcation points between two points, in their order along the branch.

    Parameters
    ----------
    alone : bool
        Whether two kinds in one step are refused.

    Raises
    ------
    StepTooLongError
    """
    tests: dict[str, Callable[[Corrected], float]] = {}
    if np.sign(along(a)) != np.sign(along(b)):
        tests["fold"] = along
    if a.turned != b.turned:
        tests["branch-point"] = _determinant(b.linear, b)
    if isinstance(a.equations, PeriodicOrbits) and doubling(a.linear)[0] != doubling(b.linear)[0]:
        scale = max(doubling(a.linear)[1], doubling(b.linear)[1])
        tests["period-doubling"] = lambda c: _signed(doubling(c.linear), scale)
    change = outside(b) - outside(a)
    single = len(tests)
    if "period-doubling" in tests and single > 1 and alone:
        raise StepTooLongError
    pair = (abs(change) - single) // 2 if abs(change) > single else 0
    if (abs(change) - single) % 2 or (pair and (single or pair > 1) and alone):
        raise StepTooLongError
    for k in range(pair):
        place = min(outside(a), outside(b)) + 2 * k + (single if change else 0)
        tests[f"pair {k}"] = lambda c, place=place: float(c.exponents[0][place])  # type: ignore[misc]
    found = []
    for kind, test in tests.items():
        at = yield from located(a, b, test)
        if at is None:
            raise StepTooLongError
        if kind.startswith("pair"):
            if not _has_pair(at):
                raise StepTooLongError
            kind = "neimark-sacker" if isinstance(at.equations, PeriodicOrbits) else "hopf"
        found.append(Event(kind, at))
    folds = [e for e in found if e.kind in ("fold", "branch-point")]
    if len(folds) == 2:  # where a branch meets its mirror image it turns too: one point, at which two branches cross
        if _apart(folds[0].at, folds[1].at) > ONE_POINT and alone:
            raise StepTooLongError
        found.remove(next(e for e in folds if e.kind == "fold"))
    chord = (b.point.vector - a.point.vector) / a.linear.sizes
    return sorted(found, key=lambda e: float(chord @ ((e.at.point.vector - a.point.vector) / a.linear.sizes)))


def along(c: Corrected) -> float:
    """Part of the tangent along the first free parameter: zero at a fold."""
    return float(c.tangent[c.tangent.size - c.point.free.size])


def doubling(linear: Linear) -> tuple[float, float]:
    """Sign of det(M + I), and the logarithm of its modulus, from the segments' matrices."""
    count, n, _ = linear.matrices.shape
    matrix = np.zeros((count * n, count * n))
    cycle(matrix, linear.matrices, 1.0)
    sign, log = np.linalg.slogdet(matrix)
    return float(sign), float(log)


def _signed(of: tuple[float, float], scale: float) -> float:
    return of[0] * float(np.exp(of[1] - scale))


def _determinant(reference: Linear, at: Corrected) -> Callable[[Corrected], float]:
    """Determinant of derivatives and the reference's tangent, over its own size there: zero at a branch point."""
    last = at.tangent / reference.sizes

    def of(c: Corrected) -> tuple[float, float]:
        sign, log = np.linalg.slogdet(
            np.vstack([c.linear.jacobian * reference.sizes / reference.weights[:, None], last])
        )
        return float(sign), float(log)

    scale = of(at)[1]
    return lambda c: _signed(of(c), scale)


def _apart(a: Corrected, b: Corrected) -> float:
    return float(np.abs((a.point.vector - b.point.vector) / a.linear.sizes).max())


def _has_pair(c: Corrected) -> bool:
    """Whether the multiplier nearest to the circle is one of a pair."""
    modulus, argument = c.exponents
    nearest = abs(argument[np.abs(modulus).argmin()])
    if isinstance(c.equations, PeriodicOrbits):
        return bool(REAL < nearest < pi - REAL)
    return bool(nearest > REAL)
