"""Points of codimension two on curves of events: cusps, and strong resonances."""

from collections.abc import Callable, Generator

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.branches.bracketing import located
from whirlmap.analysis.branches.corrector import Ask, Corrected, Lost
from whirlmap.analysis.branches.event_curves import Added, EventCurve, pairs
from whirlmap.analysis.branches.events import Event, StepTooLongError
from whirlmap.analysis.branches.unknowns import Linear

Array = NDArray[np.float64]

#: Half the sum of the pair of multipliers at each strong resonance of a Neimark-Sacker curve: cos of their angle.
RESONANCES = {"resonance-1-1": 1.0, "resonance-1-2": -1.0, "resonance-1-3": -0.5, "resonance-1-4": 0.0}
#: Those at which the pair becomes real, so that the curve ends there.
LAST = ("resonance-1-1", "resonance-1-2")


def points_between(a: Corrected, b: Corrected) -> Generator[Ask, Corrected | Lost, list[Event]]:
    """Points of codimension two between two points of a curve, in their order.

    Raises
    ------
    StepTooLongError
        One that is not found.
    """
    curve = a.equations
    assert isinstance(curve, EventCurve)
    tests: dict[str, Callable[[Corrected], float]] = {}
    if curve.kind == "neimark-sacker":
        tests = {kind: lambda c, at=at: half_sum(c) - at for kind, at in RESONANCES.items()}  # type: ignore[misc]
    else:
        first = Added.of(curve.kind, a.point, _own(a))
        tests["resonance-1-1" if curve.kind == "fold" else "resonance-1-2"] = lambda c: _overlap(c, first)
        if curve.kind == "fold":
            tests["cusp"] = lambda c: _towards(c, first)
    found = []
    for kind, test in tests.items():
        if not np.sign(test(a)) * np.sign(test(b)) < 0:
            continue
        at = yield from located(a, b, test)
        if at is None:
            raise StepTooLongError
        found.append(Event(kind, at))
    chord = (b.point.vector - a.point.vector) / a.linear.sizes
    return sorted(found, key=lambda e: float(chord @ ((e.at.point.vector - a.point.vector) / a.linear.sizes)))


def half_sum(c: Corrected) -> float:
    """Half the sum of the pair of multipliers whose product is nearest to one."""
    added = Added.of("neimark-sacker", c.point, _own(c))
    products, halves = pairs(added.multipliers(c.linear.jacobian))
    return float(halves[np.abs(np.log(products)).argmin()])


def _own(c: Corrected) -> Linear:
    """The orbit's equations without the added one."""
    linear = c.linear
    return Linear(linear.residual[:-1], linear.jacobian[:-1], linear.sizes, linear.weights[:-1], linear.matrices)


def _vectors(c: Corrected, first: Added) -> tuple[Array, Array]:
    """Left and right null vectors, on the side of those at the first point."""
    added = Added.of(first.kind, c.point, _own(c))
    return added.left * np.sign(added.left @ first.left), added.right * np.sign(added.right @ first.right)


def _overlap(c: Corrected, first: Added) -> float:
    """Product of the left and the right null vector at one phase: zero where the multiplier is double."""
    left, right = _vectors(c, first)
    count, n = first.shape
    return float(left[(count - 1) * n : count * n] @ right[:n]) if left.size == count * n else np.nan


def _towards(c: Corrected, first: Added) -> float:
    """Part of the curve's direction along itself in the plane of the parameters: it turns round at a cusp."""
    left, _ = _vectors(c, first)
    by_free = left @ (c.linear.jacobian[:-1, -2:] / c.linear.weights[:-1, None])
    return float(c.tangent[-2] * by_free[1] - c.tangent[-1] * by_free[0])
