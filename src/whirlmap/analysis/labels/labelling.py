"""Labelling of operating points, with all options: used by diagrams, maps, attractors, speeds and `diagnose`.

The steps by which a point gets its label are in `labelled_points`.

The numbers of a point depend on its own parameters and start alone: not on the points computed with it, their number or
order, nor on the number of threads.
"""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from whirlmap.analysis.labels.labelled_points import LabelledPoints
from whirlmap.analysis.labels.measured import Measured, joined
from whirlmap.analysis.motion.ensembles import make_ensemble, parameter_values
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.orders import order_groups
from whirlmap.integrate.system import System
from whirlmap.options.computed import Labelling
from whirlmap.options.execution import EXECUTION, Execution

Array = NDArray[np.float64]


def measure(
    system: System,
    values: Mapping[str, ArrayLike],
    labelling: Labelling,
    execution: Execution = EXECUTION,
    *,
    starts: Array | None = None,
    kept: Sequence[str] = (),
) -> tuple[Measured, Ensemble]:
    """Measure points, each from its own start.

    Parameters
    ----------
    starts : array, shape (state, point), optional
        The model's default starts where absent.
    kept : sequence of str
        States whose section is kept.

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
            system, some, starts=begin, integration=labelling.integration, execution=execution
        )  # fmt: skip
        parts.append(measure_ensemble(system, some, labelling, ensemble, found, execution.progress, kept=kept))
    return (parts[0] if len(parts) == 1 else joined(parts, [group.members for group in groups])), ensemble


def measure_ensemble(
    system: System,
    values: Mapping[str, Array],
    labelling: Labelling,
    ensemble: Ensemble,
    start_found: NDArray[np.bool_],
    progress: Callable[[int], None] | None = None,
    *,
    kept: Sequence[str] = (),
) -> Measured:
    """Measure the points of an ensemble, in place: all at phase zero, with the same orders of harmonics."""
    longest = labelling.longest(ensemble.strobe)
    points = LabelledPoints(
        system, values, ensemble, labelling.settling, longest=longest, kept=tuple(kept), progress=progress
    )
    return points.measure(start_found)
