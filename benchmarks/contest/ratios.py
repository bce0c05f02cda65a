"""Times at equal error from measured (error, time) pairs."""

from collections.abc import Iterable, Sequence

import numpy as np

Point = tuple[float, float]


def front(points: Iterable[Point]) -> list[Point]:
    """Points (error, time) that no other point beats in both, from the loosest to the tightest."""
    kept: list[Point] = []
    for error, time in sorted(points, key=lambda p: (p[1], p[0])):
        if error > 0 and np.isfinite(error) and (not kept or error < kept[-1][0]):
            kept.append((error, time))
    return kept


def time_at(points: Iterable[Point], error: float) -> float | None:
    """Time that one curve takes for an error, interpolated in log-log between its best points.

    Where every point is more accurate than asked, the cheapest counts: it meets what was asked. Where none is accurate
    enough the result is None, for nothing is known about what comes behind the end of a curve.
    """
    curve = front(points)
    if not curve or curve[-1][0] > error:
        return None
    if curve[0][0] <= error:
        return curve[0][1]
    errors, times = np.log(np.array(curve)).T
    return float(np.exp(np.interp(-np.log(error), -errors, times)))


def best_time(curves: Iterable[Sequence[Point]], error: float) -> float | None:
    """Shortest time of several curves at an error; each is interpolated on its own. None where none gets there."""
    times = [t for t in (time_at(curve, error) for curve in curves) if t is not None]
    return min(times) if times else None


def ratio(ours: Iterable[Sequence[Point]], theirs: Iterable[Sequence[Point]], error: float) -> float | None:
    """Their best time over our best time at equal error; above 1 we are faster. None where a side does not get there."""
    a, b = best_time(ours, error), best_time(theirs, error)
    return None if a is None or b is None else b / a
