"""Measured numbers of operating points as plain arrays, before they become a Dataset; joined where measured in parts."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from enum import IntEnum
from operator import attrgetter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.labels.regime import Rule
from whirlmap.analysis.steady.returns import Returns, first_drift
from whirlmap.integrate.accuracy import StepVerdict
from whirlmap.results.regime import Regime
from whirlmap.results.schema import variable
from whirlmap.results.status import Status, flags

Array = NDArray[np.float64]

#: Arrays over the points of `Returns` that can be replaced by those of a later measurement.
RETURNS = tuple(f.name for f in fields(Returns) if f.name != "extremes")


@dataclass(frozen=True)
class Measured:
    """What was measured of points; arrays of shape (point,) beside those of `Returns` and ``end_state`` (state, point).

    The latter is the state at the end of the record, NaN where a run has ended; ``end_periods`` are the T there since phase
    zero, modulo the common period where there is one of reasonable length.
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
    end_periods: NDArray[np.int64]

    @property
    def drift_state(self) -> NDArray[np.int64]:
        """Index of the first state that drifts, -1 where none does."""
        return first_drift(self.returns.drift)[0]

    @property
    def drift_rate(self) -> Array:
        """Its speed, NaN where there is none."""
        return first_drift(self.returns.drift)[1]


@dataclass(frozen=True)
class Number:
    """A number of every point as a variable of Datasets: what is declared here is derived everywhere else.

    Attributes
    ----------
    name, unit, meaning : str
        Of the variable.
    source : str
        Attribute of `Measured`, also ``returns.period``.
    absent : float
        What stands at points that were not reached; a number where the variable cannot hold NaN.
    kind : type of IntEnum, optional
        What its values mean.
    """

    name: str
    source: str
    unit: str
    meaning: str
    absent: float = math.nan
    kind: type[IntEnum] | None = None

    def variable(self, dim: str, measured: Measured) -> tuple[Any, ...]:
        """The variable over a dimension."""
        values = attrgetter(self.source)(measured)
        more = flags(self.kind) if self.kind else {}
        return variable(dim, values.astype(np.int8) if values.dtype == bool else values, self.unit, self.meaning, **more)


NUMBERS = (
    Number("status", "status", "1", "how the run ended", Status.failed, Status),
    Number("regime", "returns.regime", "1", "regime", Regime.undecided, Regime),
    Number("period_T", "returns.period", "T", "smallest return, 0 where none was found; of locked motion n", 0),
    Number("period_common", "returns.multiple", "1", "smallest return in common periods, 0 where none", 0),
    Number("return_distance", "returns.distance", "1", "return distance over the range of each state"),
    Number("lyapunov", "exponent", "1/time", "largest Lyapunov exponent of points that do not return"),
    Number("lyapunov_error", "exponent_error", "1/time", "one standard error of it, from block means"),
    Number("lyapunov_periods", "exponent_periods", "T", "T over which it was measured, 0: not", 0),
    Number("confidence", "confidence", "1", "share of the indicators asked that speak for the regime"),
    Number("rule", "rule", "1", "rule that decided the regime, or what is known without one", Rule.none, Rule),
    Number("rotation_number", "winding", "1", "rotation number of the section of points that do not return"),
    Number("winding", "winding", "1", "former name of rotation_number, for one release"),
    Number("growth_rate", "returns.growth", "1/time", "rate of the amplitude: what grows, or comes to rest"),
    Number("drift_rate", "drift_rate", "1/time", "speed of the first state that drifts, in its unit"),
    Number("thinning", "returns.thinning", "1", "power of time with which the narrowest gap of a film falls"),
    Number("drift_state", "drift_state", "1", "index of that state, -1: none", -1),
    Number("end_time", "end_time", "time", "time at which the run ended early"),
    Number("start_found", "start_found", "1", "whether the default start exists", 0),
    Number("settled_after", "returns.waited", "1", "common periods run before the record", 0),
    Number("accelerated", "returns.accelerated", "1", "whether convergence was accelerated", 0),
    Number("steps", "steps", "1/T", "steps per T", 0),
    Number("step_error", "step_error", "1", "measured error over one common period"),
    Number("step_verdict", "step_verdict", "1", "whether the steps meet the accuracy", 0, StepVerdict),
    Number("grazings", "grazings", "1", "grazing contacts with surfaces at which rates change, in the record", 0),
)


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
