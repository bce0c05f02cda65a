"""Labelling of operating points, with all options: used by diagrams, maps, attractors, speeds and `diagnose`.

The steps by which a point gets its label are in `labelled_points`.

The numbers of a point depend on its own parameters and start alone: not on the points computed with it, their number or
order, nor on the number of threads.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from whirlmap.analysis.labels.labelled_points import LabelledPoints
from whirlmap.analysis.labels.measured import Measured, joined
from whirlmap.analysis.motion.ensembles import make_ensemble, parameter_values
from whirlmap.analysis.steady.settling import Settling
from whirlmap.analysis.variational.lyapunov import BLOCKS
from whirlmap.errors import RangeError
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.orders import order_groups
from whirlmap.integrate.system import System

Array = NDArray[np.float64]
Progress = Callable[[int], None]

#: T, and common periods, over which the exponent of a point that does not return is measured at most, the longer of both.
LONGEST, LONGEST_COMMON = 16384, 1024


@dataclass(frozen=True)
class Labelling:
    """How points are measured: the options of `label_points`, and the states whose section is kept."""

    settling: Settling
    lyapunov: int | None = None
    steps: int | None = None
    accuracy: float | None = None
    method: str | None = None
    workers: int | None = None
    kept: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Refuse a length of the exponent's run that gives no error."""
        if self.lyapunov and not BLOCKS <= self.lyapunov <= 10_000_000:
            raise RangeError(f"lyapunov must be 0, or from {BLOCKS} to 10000000 T, not {self.lyapunov}")

    def longest(self, strobe: int) -> int:
        """T over which exponents are measured at most, with this many T between section points that show returns."""
        return max(LONGEST, LONGEST_COMMON * strobe) if self.lyapunov is None else self.lyapunov

    def measure(
        self,
        system: System,
        values: Mapping[str, ArrayLike],
        *,
        starts: Array | None = None,
        progress: Progress | None = None,
    ) -> tuple[Measured, Ensemble]:
        """Measure points, each from its own start.

        Returns
        -------
        measured : Measured
        ensemble : Ensemble
            Stands where the points were left. Where the common periods of points differ, those of one length are measured
            together, and this is the ensemble of the longest.
        """
        columns = {name: np.atleast_1d(np.asarray(v, dtype=float)) for name, v in values.items()}
        groups = order_groups(system, parameter_values(system, columns), columns)
        parts = []
        for group in groups:
            at = group.members
            some = {name: column[at] for name, column in columns.items()}
            begin = None if starts is None else starts[:, at]
            ensemble, found = make_ensemble(
                system, some, starts=begin, steps=self.steps, accuracy=self.accuracy, method=self.method,
                workers=self.workers,
            )  # fmt: skip
            parts.append(self.measure_ensemble(system, some, ensemble, found, progress))
        return (parts[0] if len(parts) == 1 else joined(parts, [group.members for group in groups])), ensemble

    def measure_ensemble(
        self,
        system: System,
        values: Mapping[str, Array],
        ensemble: Ensemble,
        start_found: NDArray[np.bool_],
        progress: Progress | None = None,
    ) -> Measured:
        """Measure the points of an ensemble, in place: all at phase zero, with the same orders of harmonics."""
        points = LabelledPoints(
            system, values, ensemble, self.settling, longest=self.longest(ensemble.strobe), kept=self.kept, progress=progress
        )
        return points.measure(start_found)
