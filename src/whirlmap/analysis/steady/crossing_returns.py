"""Returns of an unforced motion, counted in crossings of its section.

As for forced motion (`return_search.search_windows`), but crossings fall between the steps and scatter by their error: small
differences do not shrink steadily, so that the largest of each half of a section are compared.
"""

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.steady.return_search import PARTS, across, shorter_on_its_way, shortest
from whirlmap.kernels.running.loops import compiled

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Crossings of a section scatter by the error of the steps: differences that fall by less in half a section stand still, and
#: a return whose divisor returns within so many tolerances is that divisor's.
SCATTER, WITHIN = 0.9, 10.0


@compiled(
    {
        "x": "doubles", "lanes": "int", "count": "int", "states": "int", "period": "doubles", "sizes": "doubles",
        "tolerance": "doubles", "most": "int", "size": "doubles", "room": "doubles", "multiple": "ints",
        "distance": "doubles",
    },
    parts=PARTS,
)  # fmt: skip
def _settled_returns(
    x: Array, lanes: int, count: int, states: int, period: Array, sizes: Array, tolerance: Array, most: int, size: Array,
    room: Array, multiple: Integers, distance: Array,
) -> None:  # fmt: skip
    """Return of every lane of x (lane, point, state), negative where it still approaches, and its distance, or the least."""
    for lane in range(lanes):
        base = lane * count * states
        for k in range(states):
            size[k] = sizes[lane * states + k]
        distance[lane] = np.inf
        m = shortest(x, base, count, 0, count, most, states, period, size, tolerance[0])
        if m == 0:
            for tried in range(1, most + 1):
                nearer = across(x, base, count, 0, count, tried, states, period, size, distance[lane])
                distance[lane] = min(distance[lane], nearer)
            continue
        for d in range(1, m):  # crossings scatter by the error of the steps, which the tolerance may cut in two
            enough = WITHIN * tolerance[0]
            if m % d == 0 and across(x, base, count, 0, count, d, states, period, size, enough) < enough:
                m = d
                break
        multiple[lane] = -m
        distance[lane] = across(x, base, count, 0, count, m, states, period, size, np.inf)
        half = (count - m) // 2
        early = across(x, base, count, 0, half + m, m, states, period, size, np.inf)
        late = across(x, base, count, half, count - half, m, states, period, size, np.inf)
        if late < SCATTER * early:
            ratio = (late / early) ** (m / half)
            if late * ratio / (1 - ratio) > tolerance[0]:
                continue
        if not shorter_on_its_way(x, base, count, 0, count, m, states, period, size, room):
            multiple[lane] = m


def settled_returns(
    section: Array, size: Array, period: Array, tolerance: float, most: int
) -> tuple[Integers, Array]:
    """Smallest returns of sections that are no part of an approach.

    Parameters
    ----------
    section : array, shape (crossing, state, lane)
    size : array, shape (state, lane)
        What differences are divided by.
    period : array, shape (state,)
        Of each state, infinite where it is not cyclic.
    tolerance : float
        Of a return.
    most : int
        Largest return that is sought, at most half the number of crossings.

    Returns
    -------
    multiple : array of int, shape (lane,)
        0 where nothing returns. Negative where the motion still approaches: where what is left, by the largest differences
        in the halves of the section, is beyond the tolerance, or a shorter return is still on its way.
    distance : array, shape (lane,)
        Of the return, else the smallest one.
    """
    count, states, lanes = section.shape
    multiple, distance = np.zeros(lanes, dtype=np.int64), np.empty(lanes)
    _settled_returns(
        x=np.ascontiguousarray(section.transpose(2, 0, 1)), lanes=lanes, count=count, states=states, period=period,
        sizes=np.ascontiguousarray(size.T), tolerance=np.array([tolerance], dtype=np.float64), most=most,
        size=np.empty(states), room=np.empty(count), multiple=multiple, distance=distance,
    )  # fmt: skip
    return multiple, distance
