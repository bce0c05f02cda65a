"""The search for a return among the section points of one lane, as loops: `periodicity` and `settling` both use it.

A section is a stretch of a row of numbers: point i of ``count`` stands at place ``begin`` + i of a ring of ``ring`` places
that begins at ``base``, its ``states`` numbers side by side. ``period`` holds the period of each state, infinite where it is
not cyclic; ``size``, room for one number of each state, what its differences are divided by (`integrate.scales`).
"""

import numpy as np
from numpy.typing import NDArray

from whirlmap.kernels.running.loops import compiled

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Differences smaller than this fraction of the one a whole orbit before have shrunk.
SHRINKS = 0.99
#: Differences over fewer periods that are smaller than `SMALL` must repeat to this part of themselves to be an orbit's own:
#: those of a spiral that closes in do not.
SMALL, STEADY = 1e-4, 0.03
#: Differences below this count as they are, for rounding hides the ratio of one to the next.
ROUNDING = 1e-9


# --- parts of loops -----------------------------------------------------------------------------------------


def wrapped(a: float, b: float, period: float) -> float:
    """Difference a - b; of a cyclic state the shorter way round."""
    difference = a - b
    if period < np.inf:
        difference -= period * np.rint(difference / period)
    return difference


def apart(a: float, b: float, period: float) -> float:
    """Size of a difference."""
    return abs(wrapped(a, b, period))


def place(base: int, begin: int, i: int, ring: int, states: int) -> int:
    """Where point i of a section stands in its row."""
    at = begin + i
    return base + (at - ring if at >= ring else at) * states


def sized(
    x: Array, base: int, ring: int, begin: int, count: int, stride: int, states: int, scale: Array, size: Array
) -> bool:  # fmt: skip
    """Set sizes to the scales; returns whether every ``stride``-th point is finite."""
    finite = True
    for k in range(states):
        size[k] = scale[k]
    for i in range(0, count, stride):
        at = place(base, begin, i, ring, states)
        for k in range(states):
            if not abs(x[at + k]) < np.inf:
                finite = False
    return finite


def step(x: Array, at: int, then: int, states: int, period: Array, size: Array) -> float:
    """Largest scaled difference of two points."""
    largest = 0.0
    for k in range(states):
        largest = max(largest, apart(x[at + k], x[then + k], period[k]) / size[k])
    return largest


def across(
    x: Array, base: int, ring: int, begin: int, count: int, m: int, states: int, period: Array, size: Array, enough: float
) -> float:
    """Largest scaled difference of points m apart, all over a section; the search ends at one of ``enough``."""
    largest = 0.0
    for i in range(count - 1, m - 1, -1):
        at, then = place(base, begin, i, ring, states), place(base, begin, i - m, ring, states)
        largest = max(largest, step(x, at, then, states, period, size))
        if largest >= enough:
            break
    return largest


def to_limit(
    x: Array, base: int, ring: int, begin: int, count: int, m: int, states: int, period: Array, size: Array
) -> float:
    """Scaled distance of the last section point from the limit of its geometric approach, which returns after m.

    From the last difference over one return, d, and the one before it, d / r, the distance is d r / (1 - r). Differences
    that do not shrink have no limit: infinity, but for those below `ROUNDING`. A section too short for two differences
    has r = 0.
    """
    last = place(base, begin, count - 1, ring, states)
    before = place(base, begin, count - 1 - m, ring, states)
    late = step(x, last, before, states, period, size)
    if late <= ROUNDING:
        return late
    ratio = 0.0
    if count - 1 - 2 * m >= 0:
        early = step(x, before, place(base, begin, count - 1 - 2 * m, ring, states), states, period, size)
        if early > 0:
            ratio = late / early
    return late * ratio / (1 - ratio) if ratio < 1 else np.inf


def shorter_on_its_way(
    x: Array, base: int, ring: int, begin: int, count: int, m: int, states: int, period: Array, size: Array, change: Array
) -> bool:
    """Whether a return shorter than m is still on its way: then m is not yet the smallest.

    A transient that alternates about a fixed point (multiplier near -1) returns after two common periods before it returns
    after one, and a spiral that turns by nearly a third of a round returns after three. On an orbit of m common periods
    differences over fewer repeat after m: the largest of the last m is compared with the largest of m a whole number of
    returns earlier, as many as the section holds; and small ones must repeat all over the section, for a spiral may stand
    still at its end. The section holds at least 2 m points; ``change`` is room for as many numbers.
    """
    for d in range(1, m):
        if m % d != 0:
            continue
        changes, largest, varies = count - d, 0.0, 0.0
        for i in range(changes):
            at, then = place(base, begin, i + d, ring, states), place(base, begin, i, ring, states)
            change[i] = step(x, at, then, states, period, size)
            largest = max(largest, change[i])
            if i >= m:
                varies = max(varies, abs(change[i] - change[i - m]))
        phases = max(min(m, changes - m), 1)
        back = (changes - phases) // m * m
        late, early = 0.0, 0.0
        for i in range(changes - phases, changes):
            late, early = max(late, change[i]), max(early, change[i - back])
        if late < SHRINKS * early or (largest < SMALL and varies > STEADY * largest):
            return True
    return False


def shortest(
    x: Array, base: int, ring: int, begin: int, count: int, most: int, states: int, period: Array, size: Array,
    tolerance: float,
) -> int:  # fmt: skip
    """Smallest m up to ``most`` at which all points return, else 0. The last point alone rules out nearly all."""
    last = place(base, begin, count - 1, ring, states)
    for m in range(1, most + 1):
        before = place(base, begin, count - 1 - m, ring, states)
        if (
            step(x, last, before, states, period, size) < tolerance
            and across(x, base, ring, begin, count, m, states, period, size, tolerance) < tolerance
        ):
            return m
    return 0


#: These, in the order in which they call each other.
PARTS = (wrapped, apart, place, sized, step, across, to_limit, shorter_on_its_way, shortest)


# --- loops --------------------------------------------------------------------------------------------------


@compiled(
    {
        "x": "doubles", "lanes": "int", "count": "int", "states": "int", "period": "doubles", "sizes": "doubles",
        "tolerance": "doubles", "most": "int", "size": "doubles", "multiple": "ints", "nearest": "ints", "deciding": "ints",
        "distance": "doubles",
    },
    parts=PARTS,
)  # fmt: skip
def _nearest_returns(
    x: Array, lanes: int, count: int, states: int, period: Array, sizes: Array, tolerance: Array, most: int, size: Array,
    multiple: Integers, nearest: Integers, deciding: Integers, distance: Array,
) -> None:  # fmt: skip
    """Smallest distance of every lane of x (lane, point, state) from a return, up to the first within the tolerance."""
    for lane in range(lanes):
        base = lane * count * states
        for k in range(states):
            size[k] = sizes[lane * states + k]
        for m in range(1, most + 1):
            largest = across(x, base, count, 0, count, m, states, period, size, np.inf)
            if largest < distance[lane]:
                distance[lane], nearest[lane] = largest, m
            if largest < tolerance[0]:
                multiple[lane] = m
                break
        if nearest[lane] > 0:
            most_apart = -1.0
            for k in range(states):
                furthest = 0.0
                for i in range(nearest[lane], count):
                    at = base + i * states + k
                    furthest = max(furthest, apart(x[at], x[at - nearest[lane] * states], period[k]))
                if furthest / size[k] > most_apart:
                    most_apart, deciding[lane] = furthest / size[k], k


def nearest_returns(
    section: Array, size: Array, period: Array, tolerance: float, most: int
) -> tuple[Integers, Array, Integers, Integers]:
    """Multiple, distance, nearest multiple and deciding state of every lane of a section, shape (period, state, lane).

    ``size`` has shape (state, lane). Where a number is not finite the distance is NaN, the deciding state -1, the rest 0.
    """
    count, states, lanes = section.shape
    finite = np.flatnonzero(np.isfinite(section).all(axis=(0, 1)))
    multiple, nearest, deciding = (np.full(lanes, value, dtype=np.int64) for value in (0, 0, -1))
    distance = np.full(lanes, np.nan)
    found = multiple[finite], nearest[finite], deciding[finite], np.full(finite.size, np.inf)
    _nearest_returns(
        x=np.ascontiguousarray(section[:, :, finite].transpose(2, 0, 1)), lanes=finite.size, count=count, states=states,
        period=period, sizes=np.ascontiguousarray(size[:, finite].T), tolerance=np.array([tolerance], dtype=np.float64),
        most=most, size=np.empty(states), multiple=found[0], nearest=found[1], deciding=found[2], distance=found[3],
    )  # fmt: skip
    for all_lanes, these in zip((multiple, nearest, deciding, distance), found, strict=True):
        all_lanes[finite] = these
    return multiple, distance, nearest, deciding


@compiled(
    {
        "points": "ints", "chosen": "int", "slot": "ints", "history": "doubles", "ring": "int", "states": "int", "n": "int",
        "windows": "ints", "lengths": "int", "ran": "ints", "looked": "ints", "longest": "ints", "period": "doubles",
        "tolerance": "doubles", "scale": "doubles", "own": "doubles", "size": "doubles", "room": "doubles",
        "multiple": "ints", "distance": "doubles",
    },
    parts=PARTS,
)  # fmt: skip
def search_windows(
    points: Integers, chosen: int, slot: Integers, history: Array, ring: int, states: int, n: int, windows: Integers,
    lengths: int, ran: Integers, looked: Integers, longest: Integers, period: Array, tolerance: Array, scale: Array,
    own: Array, size: Array, room: Array, multiple: Integers, distance: Array,
) -> None:  # fmt: skip
    """Search the windows of points that are due: the first always, others where they have filled anew, or at the end.

    ``points`` says which of all n; ``history`` has shape (place, ring, state), ``scale`` (state, n). ``multiple`` and
    ``distance`` of the points are replaced. A return counts where what is left of the approach is within the tolerance,
    and no shorter return is on its way, by two windows where the point has run them: a spiral of nearly m to the round
    looks like an orbit of m in one window. A point that is given up without a return gets the smallest distance.
    """
    for j in range(chosen):
        p = points[j]
        base = slot[p] * ring * states
        for k in range(states):
            own[k] = scale[k * n + p]
        for w in range(lengths):
            window = windows[w]
            given_up = ran[p] >= longest[p]
            due = w == 0 or given_up or ran[p] // window > looked[p] // window
            if not (due and ran[p] >= window and multiple[p] == 0):
                continue
            begin = (ran[p] - window) % ring
            most = max(window // 2, 1)
            distance[p] = np.nan
            if not sized(history, base, ring, begin, window, 1, states, own, size):
                continue
            m = shortest(history, base, ring, begin, window, most, states, period, size, tolerance[0])
            if m == 0:
                if given_up and w == lengths - 1:
                    distance[p] = np.inf
                    for tried in range(1, most + 1):
                        nearer = across(history, base, ring, begin, window, tried, states, period, size, distance[p])
                        distance[p] = min(distance[p], nearer)
                continue
            distance[p] = across(history, base, ring, begin, window, m, states, period, size, np.inf)
            if to_limit(history, base, ring, begin, window, m, states, period, size) <= tolerance[0]:
                length = 2 * window if ran[p] >= 2 * window and 2 * window <= ring else window
                begin = (ran[p] - length) % ring
                finite = sized(history, base, ring, begin, length, 1, states, own, size)
                if finite and not shorter_on_its_way(
                    history, base, ring, begin, length, m, states, period, size, room
                ):
                    multiple[p] = m
