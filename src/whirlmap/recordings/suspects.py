"""Suspect values of a signal: sentinels, clipping, intervals without change."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: A value is suspect that lies further from the median than this many widths of the central 99 %.
FAR = 5.0
#: Equal samples in a row that count as a constant value, at least, and over their mean number in the record.
STILL, OVER_MEAN = 20, 12
#: Levels of a signal below which it is no sampled motion but a switch.
LEVELS = 12


def suspects(values: Array, place: Callable[[int], str]) -> list[str]:
    """One sentence for each kind of suspect value.

    Parameters
    ----------
    values : array, shape (row,)
        Finite.
    place : callable
        Name of a row.
    """
    if values.size < 100:
        return []
    said = _outliers(values, place)
    levels = np.unique(values[:: max(values.size // 20_000, 1)])
    if levels.size >= LEVELS:
        still = _still(values, place)
        said += still or _clipped(values, levels, place)
    return said


def _outliers(values: Array, place: Callable[[int], str]) -> list[str]:
    scaled = values / max(float(np.abs(values).max()), np.finfo(float).tiny)  # no overflow
    low, middle, high = np.quantile(scaled, (0.005, 0.5, 0.995))
    far = np.flatnonzero(np.abs(scaled - middle) > FAR * max(high - low, 1e-12 * abs(middle)))
    if not far.size or far.size > 0.01 * values.size or high == low:
        return []
    kinds, counts = np.unique(values[far], return_counts=True)
    said = []
    for value in kinds[np.argsort(-counts, kind="stable")][:3]:
        at = np.flatnonzero(values == value)
        times = "once" if at.size == 1 else f"{at.size} times"
        rest = np.delete(values, far)
        said.append(
            f"{place(int(at[0]))}: the value {value:g} ({times}) is far from all others, {rest.min():g} to "
            f"{rest.max():g};"
            f" if it means that there is no value: --missing {value:g}"
        )
    if kinds.size > 3:
        said.append(f"{far.size} values in all are as far from the others, the first at {place(int(far[0]))}")
    return said


def _still(values: Array, place: Callable[[int], str]) -> list[str]:
    ends = np.flatnonzero(np.r_[np.diff(values) != 0, True])
    lengths = np.diff(ends, prepend=-1)
    long = np.flatnonzero(lengths >= max(STILL, OVER_MEAN * values.size / lengths.size))
    if not long.size:
        return []
    first = long[0]
    begin = int(ends[first] - lengths[first] + 1)
    return [
        f"{place(begin)} to {place(int(ends[first])).split()[-1]}: the value stands still at {values[begin]:g}"
        f" ({long.size} such stretch{'es' * (long.size > 1)}, {int(lengths[long].sum())} samples in all): no signal "
        "there, or clipped"
    ]


def _clipped(values: Array, levels: Array, place: Callable[[int], str]) -> list[str]:
    said = []
    span = max(0.02 * float(np.ptp(levels / 2) * 2), 2.5 * float(np.diff(levels).min()))
    for word, edge in (("largest", float(values.max())), ("smallest", float(values.min()))):
        at = np.flatnonzero(values == edge)
        near = int((np.abs(values - edge) <= span).sum()) - at.size
        runs = at.size and int(np.max(np.diff(np.r_[-1, np.flatnonzero(np.diff(at) != 1), at.size - 1])))
        if at.size >= max(0.005 * values.size, 10) and runs >= 3 and at.size > 2 * near:
            said.append(
                f"{place(int(at[0]))}: {at.size} samples stand exactly at the {word} value, {edge:g}: the signal may be "
                "clipped"
            )
    return said
