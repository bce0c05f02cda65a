"""Points that approach an orbit so slowly that extrapolation is expected to save time, and their extrapolated orbits."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.steady import extrapolation, return_search
from whirlmap.analysis.steady.extrapolation import DIFFERENCES, room_for_fit, step_to_limit
from whirlmap.analysis.steady.return_search import place, sized, wrapped
from whirlmap.kernels.running.loops import compiled

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Largest return, in common periods, that is extrapolated.
LONGEST_RETURN = 4
#: Extrapolation is attempted where plain integration is expected to take this many times what the attempt costs.
WORTH = 1.5
#: Above this scaled size differences are not those of a linear approach.
LINEAR = 0.1
#: Differences at either end of an approach whose largest are compared.
END = 4
#: Common periods that a return is confirmed over, however small its differences are.
CONFIRMED = 8


def worth_it(m: int, largest: Array, needed: int, tolerance: float) -> bool:
    """Whether differences over m shrink so slowly that an attempt of ``needed`` common periods is expected to save time."""
    first, last = 0.0, 0.0
    for j in range(END):
        first, last = max(first, largest[j]), max(last, largest[DIFFERENCES - END + j])
    if not (last < LINEAR and last < first and last > tolerance):
        return False
    rate = np.log(first / last) / (DIFFERENCES - END)
    return m * np.log(last / tolerance) / rate + CONFIRMED > WORTH * needed


@compiled(
    {
        "due": "ints", "chosen": "int", "slot": "ints", "history": "doubles", "ring": "int", "states": "int", "n": "int",
        "ran": "ints", "needed": "ints", "period": "doubles", "tolerance": "doubles", "scale": "doubles", "own": "doubles",
        "size": "doubles", "d": "doubles", "largest": "doubles", "step": "doubles",
        "room": "doubles", "multiple": "ints", "x": "doubles", "leading": "doubles",
    },
    parts=(*return_search.PARTS, *extrapolation.PARTS, worth_it),
)  # fmt: skip
def _ends(
    due: Integers, chosen: int, slot: Integers, history: Array, ring: int, states: int, n: int, ran: Integers,
    needed: Integers, period: Array, tolerance: Array, scale: Array, own: Array, size: Array, d: Array,
    largest: Array, step: Array, room: Array, multiple: Integers, x: Array, leading: Array,
) -> None:  # fmt: skip
    """Shortest return of each point over which its approach has a limit, that limit (due point, state), and its modulus."""
    for j in range(chosen):
        p = due[j]
        base = slot[p] * ring * states
        for k in range(states):
            own[k] = scale[k * n + p]
        for m in range(1, LONGEST_RETURN + 1):
            count = m * DIFFERENCES + 1
            if ran[p] < count:
                break
            begin = (ran[p] - count) % ring
            if not sized(history, base, ring, begin, count, m, states, own, size):
                continue
            for i in range(DIFFERENCES):
                largest[i] = 0.0
                at = place(base, begin, (i + 1) * m, ring, states)
                then = place(base, begin, i * m, ring, states)
                for k in range(states):
                    d[i * states + k] = wrapped(history[at + k], history[then + k], period[k]) / size[k]
                    largest[i] = max(largest[i], abs(d[i * states + k]))
            if not worth_it(m, largest, needed[m], tolerance[0]):
                continue
            error, modulus = step_to_limit(d, largest, states, tolerance[0] / 4, step, room)
            if error < np.inf:
                last = place(base, begin, count - 1, ring, states)
                for k in range(states):
                    x[j * states + k] = history[last + k] + step[k] * size[k]
                multiple[j], leading[j] = m, modulus
                break


def room_for_approaches(states: int) -> dict[str, Array]:
    """Room that `ends_of_approaches` needs."""
    own, size, step = np.empty((3, states))
    return {
        "own": own, "size": size, "step": step, "d": np.empty((DIFFERENCES, states)),
        "largest": np.empty(DIFFERENCES), "room": room_for_fit(states),
    }  # fmt: skip


def ends_of_approaches(
    due: Integers, slot: Integers, history: Array, ran: Integers, needed: Integers, period: Array, tolerance: Array,
    scale: Array, room: Mapping[str, Array],
) -> tuple[Integers, Array, Array]:  # fmt: skip
    """Where the approaches of points lead that are slow enough.

    Parameters
    ----------
    due : array of int
        Which of all points.
    slot, ran : array of int, shape (all points,)
        Place in the history, and common periods run.
    history : array, shape (place, ring, state)
        Section points, each in the row of its number, as far as the ring goes.
    needed : array of int
        Common periods that an attempt takes, by multiple.
    scale : array, shape (state, all points)
        Range of each state.

    Returns
    -------
    multiple : array of int, shape like ``due``
        Return in common periods over which the approach is seen, the shortest; 0 where it is none, or not worth an attempt.
    x : array, shape (due, state)
    leading : array
        Largest modulus of the multipliers that it shows.
    """
    multiple, x, leading = np.zeros(due.size, dtype=np.int64), np.empty((due.size, period.size)), np.empty(due.size)
    _ends(
        due=due, chosen=due.size, slot=slot, history=history, ring=history.shape[1], states=period.size, n=ran.size, ran=ran,
        needed=needed, period=period, tolerance=tolerance, scale=scale, multiple=multiple, x=x, leading=leading, **room,
    )  # fmt: skip
    return multiple, x, leading
