"""Roots of a function along a branch, each value of which needs a corrected point: Chandrupatla's method."""

from collections.abc import Callable, Generator
from dataclasses import replace

import numpy as np

from whirlmap.analysis.branches.corrector import Ask, Corrected, Lost

#: What a step of a branch asks for, and what it is given.
Asking = Generator[Ask, Corrected | Lost, "Corrected | None"]

#: Part of the chord to which a root is located, and most points for it.
EXACT, MOST = 1e-14, 60
#: Value at a root over the larger one of the ends: beyond, the function has jumped across zero, as where rates have a kink.
JUMPS = 1e-3
#: Part of the chord within which the branch is straight to rounding; least and largest distance of places that are tried
#: beside one that was not found.
SHORT, BESIDE = 1e-5, (1e-6, 1e-3)


def located(a: Corrected, b: Corrected, test: Callable[[Corrected], float]) -> Asking:
    """Point between two of a branch where a test function vanishes; None where it jumps, or a point on the way is not found.

    Every value is taken at a point of the branch itself, in the hyperplane across the chord; nothing is interpolated but
    where to look next [chandrupatla1997]. Where a point is not found, as where two branches cross and the equations are
    singular, places beside it shorten the bracket, and the root lies between its ends in the ratio of their values.
    """
    sizes = a.linear.sizes
    begin, chord = a.point.vector, b.point.vector - a.point.vector
    normal = chord / sizes / np.linalg.norm(chord / sizes)
    low, high, at_low, at_high = 0.0, 1.0, test(a), test(b)
    best, part, ends = (a, b)[abs(at_high) < abs(at_low)], 0.5, [a, b]
    of_ends = abs(at_low), abs(at_high)
    least = min(of_ends)
    beside: list[float] = []  # places about one that was not found
    away, lost = BESIDE[0], False
    for _ in range(MOST):
        if lost and high - low < SHORT:
            return _between(ends[0], ends[1], at_low / (at_low - at_high))
        # Close to the root rounding decides: the chord's ends were corrected at hyperplanes of their own.
        where = beside.pop() if beside else low + part * (high - low)
        found = yield Ask(a.equations, a.point.of(begin + where * chord), normal, sizes)
        if isinstance(found, Lost):
            if away > BESIDE[1]:
                return None
            beside = [w for w in (where + away, where - away) if low < w < high]
            away, lost = 10 * away, True
            continue
        value = test(found)
        if not np.isfinite(value):
            return None
        if abs(value) <= least:
            best, least = found, abs(value)
        if value == 0:
            return found
        if not low < where < high:
            continue
        if np.sign(value) == np.sign(at_low):
            third, at_third, low, at_low, ends[0] = low, at_low, where, value, found
        else:
            third, at_third, high, at_high, ends[1] = high, at_high, where, value, found
        width = abs(high - low)
        if width <= 2 * EXACT:
            break
        part = _next_part(low, high, third, at_low, at_high, at_third)
        # A part so near an end that it repeats it moves by what is resolved.
        edge = min(EXACT / width, 0.5)
        part = min(max(part, edge), 1 - edge)
    return None if least > JUMPS * max(of_ends) else best


def _between(a: Corrected, b: Corrected, part: float) -> Corrected:
    """A point between two so near ones that a straight line joins them."""
    vector = a.point.vector + part * (b.point.vector - a.point.vector)
    return replace(a if part < 0.5 else b, point=a.point.of(vector))


def _next_part(low: float, high: float, third: float, at_low: float, at_high: float, at_third: float) -> float:
    """Part of the bracket from its lower end: by inverse quadratic interpolation where that is safe, else its middle."""
    if at_third in (at_low, at_high):
        return 0.5
    # Seen from the end that the third point lies behind, as in the source.
    near, far, of_near, of_far = (low, high, at_low, at_high) if third < low else (high, low, at_high, at_low)
    xi, phi = (near - far) / (third - far), (of_near - of_far) / (at_third - of_far)
    if not 1 - np.sqrt(1 - xi) < phi < np.sqrt(xi):
        return 0.5
    part = of_near / (of_far - of_near) * at_third / (of_far - at_third) + (third - near) / (far - near) * of_near / (
        at_third - of_near
    ) * of_far / (at_third - of_far)
    return float(part if near == low else 1 - part)
