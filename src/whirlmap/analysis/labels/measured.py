"""Measured numbers of operating points as plain arrays, before they become a Dataset; joined where measured in parts."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.steady.returns import Returns

Array = NDArray[np.float64]

#: Arrays over the points of `Returns` that a later measurement can replace.
RETURNS = (
    "section", "regime", "period", "multiple", "distance", "waited", "accelerated", "growth", "drift", "thinning", "turning",
)  # fmt: skip


@dataclass(frozen=True)
class Measured:
    """What was measured of points; arrays of shape (point,) beside those of `Returns` and ``end_state`` (state, point).

    The latter is the state at the end of the record, NaN where a run has ended.
    """

    returns: Returns
    status: NDArray[np.int8]
    end_time: Array
    exponent: Array
    exponent_error: Array
    exponent_periods: NDArray[np.int64]
    confidence: Array
    winding: Array
    rule: NDArray[np.int8]
    start_found: NDArray[np.bool_]
    steps: NDArray[np.int64]
    step_error: Array
    step_verdict: NDArray[np.int8]
    grazings: NDArray[np.int64]
    common: Array
    end_state: Array


def joined(parts: Sequence[Measured], places: Sequence[NDArray[np.intp]]) -> Measured:
    """Join what was measured in parts; ``places`` are the points of each. Sections that are shorter end with NaN."""
    first, points = parts[0], sum(p.size for p in places)

    def together(arrays: Sequence[NDArray]) -> NDArray:
        rows = max(a.shape[0] for a in arrays)
        shape = arrays[0].shape if arrays[0].ndim == 1 else (rows, *arrays[0].shape[1:])
        out = np.full((*shape[:-1], points), np.nan) if arrays[0].dtype.kind == "f" else np.zeros(points, arrays[0].dtype)
        for array, at in zip(arrays, places, strict=True):
            out[(slice(array.shape[0]), ..., at) if array.ndim > 1 else at] = array
        return out

    returns = replace(
        first.returns,
        **{name: together([getattr(p.returns, name) for p in parts]) for name in RETURNS},
        extremes={k: together([p.returns.extremes[k] for p in parts]) for k in first.returns.extremes},
    )
    rest = {f.name: together([getattr(p, f.name) for p in parts]) for f in fields(Measured) if f.name != "returns"}
    return Measured(returns, **rest)
