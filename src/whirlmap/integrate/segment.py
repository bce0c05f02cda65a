"""What one run of an ensemble recorded: saved states, growth of tangent vectors, extremes, mean and rms."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass(frozen=True)
class Segment:
    """What one call of `Ensemble.advance` recorded.

    Attributes
    ----------
    saved : array, shape (save, state, point)
        States at the asked steps; NaN once a point has ended.
    growth : array, shape (event, vector, point)
        Logarithmic growth of the tangent vectors in each T.
    extremes : dict or None
        ``minimum``, ``maximum``, ``mean``, ``rms`` (about the mean) of every state and output, shape (row, point);
        NaN for points that have ended.
    """

    saved: Array
    growth: Array
    extremes: dict[str, Array] | None


def statistics(sums: Array, steps: Integers, running: NDArray[np.bool_]) -> dict[str, Array]:
    """Extremes, mean and rms of what `fold` summed; NaN for points that did not run to the end."""
    reference, low, high, total, squares = sums
    mean = total / steps
    with np.errstate(over="ignore", invalid="ignore"):  # of a motion that runs away
        variance = np.maximum(squares / steps - mean**2, 0.0)  # rounding alone can make it negative
    out = {"minimum": low, "maximum": high, "mean": reference + mean, "rms": np.sqrt(variance)}
    if running.all():
        return out
    return {name: np.where(running, values, np.nan) for name, values in out.items()}
