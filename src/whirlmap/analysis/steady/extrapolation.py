"""The limit of a sequence that approaches it linearly, and the multipliers that the approach shows.

Near a periodic orbit the section points' differences d_j follow the linearised map, so that the few multipliers that are
still to be seen make a linear recurrence d_(j+q) = c_0 d_j + ... + c_(q-1) d_(j+q-1). Its coefficients, the same for all
states, are fitted by least squares; the roots of p(z) = z^q - c_(q-1) z^(q-1) - ... - c_0 are the multipliers, and the limit
is p(S) x / p(1), S the shift (minimal polynomial extrapolation, Smith, Ford and Sidi 1987, SIAM Review 29, 199; here with
more equations than unknowns, so that the last differences also test the fit).

These are parts of loops (`kernels.running.loops`), for one lane: its differences (DIFFERENCES, state), scaled, oldest first,
and the largest of each over the states.
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Most multipliers that are fitted.
MODES = 4
#: Differences that are fitted and tested.
DIFFERENCES = 12
#: The last three differences follow the recurrence to this fraction of themselves.
FOLLOWS = 0.05
#: Largest modulus of a multiplier: closer to one its distance from one is no longer sure.
STABLE = 0.999
#: A column that is less than this fraction of another when the columns before are taken off it determines no coefficient.
DETERMINED = 1e-9
#: Halvings of the bracket of the largest modulus.
HALVINGS = 48


def room_for_fit(states: int) -> Array:
    """Room that the parts need beside the differences."""
    return np.empty((MODES + 1) * DIFFERENCES * states + MODES * (MODES + 2))


def recurrence(d: Array, largest: Array, states: int, modes: int, c: int, room: Array) -> bool:
    """Coefficients by least squares, into ``room`` from ``c`` on; returns whether they are determined.

    Every equation is divided by the largest of its differences. Gram and Schmidt's method takes each column off those after
    it, the right-hand side as the last.
    """
    rows, r = (DIFFERENCES - modes) * states, c + MODES
    for j in range(DIFFERENCES - modes):
        by = 0.0
        for i in range(modes + 1):
            by = max(by, largest[j + i])
        for i in range(modes + 1):
            for k in range(states):
                room[i * rows + j * states + k] = d[(j + i) * states + k] / by
    shortest, longest = np.inf, 0.0
    for a in range(modes):
        square = 0.0
        for i in range(rows):
            square += room[a * rows + i] ** 2
        length = np.sqrt(square)
        shortest, longest = min(shortest, length), max(longest, length)
        if not shortest > DETERMINED * longest:
            return False
        room[r + a * (MODES + 1) + a] = length
        for b in range(a + 1, modes + 1):
            dot = 0.0
            for i in range(rows):
                dot += room[a * rows + i] * room[b * rows + i]
            room[r + a * (MODES + 1) + b] = dot / length
            for i in range(rows):
                room[b * rows + i] -= dot / square * room[a * rows + i]
    for a in range(modes - 1, -1, -1):
        value = room[r + a * (MODES + 1) + modes]
        for b in range(a + 1, modes):
            value -= room[r + a * (MODES + 1) + b] * room[c + b]
        room[c + a] = value / room[r + a * (MODES + 1) + a]
    return True


def inside(modes: int, c: int, radius: float, a: int, room: Array) -> bool:
    """Whether all roots of z^q - c_(q-1) z^(q-1) - ... - c_0 have a modulus below a radius (Schur and Cohn's recursion).

    ``room`` holds the coefficients from ``c`` on, and has room for q + 1 numbers from ``a`` on.
    """
    power = 1.0
    for i in range(modes):
        room[a + i] = -room[c + i] * power
        power *= radius
    room[a + modes] = power
    for degree in range(modes, 0, -1):
        k = room[a] / room[a + degree]
        if not abs(k) < 1:
            return False
        # a_i - k a_(degree - i), and one degree less: two at a time, for each needs the other
        for i in range((degree + 2) // 2):
            low, high = room[a + i], room[a + degree - i]
            room[a + i], room[a + degree - i] = low - k * high, high - k * low
        for i in range(degree):
            room[a + i] = room[a + i + 1]
    return True


def modulus(modes: int, c: int, a: int, room: Array) -> float:
    """Largest modulus of the roots of `inside`, infinite from `STABLE` on; its bracket is halved."""
    if not inside(modes, c, STABLE, a, room):
        return np.inf
    low, high = 0.0, STABLE
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        if inside(modes, c, middle, a, room):
            high = middle
        else:
            low = middle
    return high


def step_to_limit(
    d: Array, largest: Array, states: int, tolerance: float, step: Array, room: Array
) -> tuple[float, float]:
    """Set the scaled step from the last point to the limit; returns its error, infinite where none is, and the modulus.

    With as few multipliers as meet the tolerance; only where the last three differences follow the recurrence and all
    multipliers lie inside the unit circle.
    """
    c = (MODES + 1) * DIFFERENCES * states
    for j in range(DIFFERENCES):
        if not largest[j] > 0:
            return np.inf, np.nan
    for modes in range(1, min(MODES, states) + 1):
        if not recurrence(d, largest, states, modes, c, room):
            break
        follows, missed = True, 0.0
        for j in range(DIFFERENCES - 3, DIFFERENCES):
            off = 0.0
            for k in range(states):
                rest = d[j * states + k]
                for i in range(modes):
                    rest -= room[c + i] * d[(j - modes + i) * states + k]
                off = max(off, abs(rest))
            follows = follows and off <= FOLLOWS * largest[j]
            missed = max(missed, off)
        at_one = 1.0
        for i in range(modes):
            at_one -= room[c + i]
        error = missed / abs(at_one)
        if not (follows and error <= tolerance):
            continue
        leading = modulus(modes, c, c + MODES, room)
        if leading < STABLE:
            for k in range(states):
                step[k] = 0.0
                for i in range(modes):
                    total = 0.0
                    for j in range(DIFFERENCES - modes + i, DIFFERENCES):
                        total += d[j * states + k]
                    step[k] += room[c + i] / at_one * total
            return error, leading
    return np.inf, np.nan


#: These, in the order in which they call each other.
PARTS = (recurrence, inside, modulus, step_to_limit)
