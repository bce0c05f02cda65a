"""Labels of operating points anywhere in parameter space: what diagrams, maps and draws are made of.

The numbers of a point depend on its own parameters and start alone: not on the points computed with it, their number or
order, nor on the number of threads.
"""

from collections.abc import Callable, Mapping

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from whirlmap.analysis.labels.labelling import Labelling
from whirlmap.analysis.motion.ensembles import parameter_values, run_attributes
from whirlmap.analysis.steady.settling import POOL, Settling
from whirlmap.errors import RangeError
from whirlmap.integrate.ensemble import cores
from whirlmap.integrate.system import System
from whirlmap.kernels.writing.routine import LANES
from whirlmap.progress import ProgressOption, shows_progress
from whirlmap.results.schema import names_coordinate, variable, with_attributes
from whirlmap.sweep.points.point_variables import doubts, points_dataset, shared_common_multiple

Array = NDArray[np.float64]
Progress = Callable[[int], None]

#: Batches that `label_points` works through hold so many pools of lanes: enough that few lanes wait for the last point.
POOLS = 2


@shows_progress("points")
def label_points(
    system: System,
    values: Mapping[str, ArrayLike],
    *,
    settling: Settling | None = None,
    lyapunov: int | None = None,
    steps: int | None = None,
    accuracy: float | None = None,
    method: str | None = None,
    workers: int | None = None,
    starts: Array | None = None,
    ends: bool = False,
    progress: ProgressOption = None,
) -> xr.Dataset:
    """Label operating points anywhere in parameter space.

    Parameters
    ----------
    values : mapping of str to array, shape (point,)
        The parameters that differ between points, in any order; all columns of the same length.
    settling : Settling, optional
        Transient, windows and tolerance.
    lyapunov : int, optional
        T over which points that do not return have their largest exponent measured and their section recorded, at most:
        each point stops when it has a label and the error of its exponent is small enough (`nonperiodic_points.ENOUGH`).
        Less than 256 leave them undecided, 0 measures nothing. Where absent: as long as labels may need
        (`labelling.LONGEST`).
    steps, accuracy, method, workers
        As in `make_ensemble`.
    starts : array, shape (state, point), optional
        Start states, at phase zero; the model's default start where absent.
    ends : bool
        Whether to keep the states at the ends of the records, at phase zero: starts of others. NaN where a run has ended.
    progress : callable or True, optional
        Called with the number of points x periods T done since the last call; True shows a bar.

    Returns
    -------
    xr.Dataset
        Over ``point``, with the varied parameters as coordinates: ``regime``, ``status``, ``period_T`` (in T),
        ``period_common``, ``return_distance``, ``lyapunov``, ``lyapunov_error``, ``lyapunov_periods``, ``confidence``,
        ``rule``, ``rotation_number``, ``end_time``, ``settled_after``, ``start_found``, ``steps``, ``step_error``,
        ``step_verdict``, ``grazings``; over
        ``(point, quantity)``, states and outputs: ``minimum``, ``maximum``, ``mean``, ``rms``, ``peak_to_peak``; over
        ``(point, bearing)``, where the model has outputs named ``eps``: ``max_eccentricity`` and ``min_film``, in
        clearances, and ``max_load`` where it has outputs named ``load``; with ``ends`` also ``end_state(point, state)``.
        No section is kept.

    Raises
    ------
    RangeError
        Where a name or a value is not the model's, lengths differ, or there is no point.

    Notes
    -----
    The numbers of a point do not depend, by a bit, on the points in its company. Points that ended early have NaN for
    what needs a whole record, and their ``status`` says why.
    """
    columns = {name: np.atleast_1d(np.asarray(v, dtype=float)) for name, v in values.items()}
    if not columns:
        raise RangeError("values: found no parameter, expected at least one, as in {'s': [0.5, 1.0]}")
    for name, column in columns.items():
        if column.ndim != 1 or not column.size or not np.isfinite(column).all():
            raise RangeError(f"values of {name!r} must be a list of one or more finite numbers")
    points = parameter_values(system, columns).shape[1]
    if starts is not None and np.shape(starts) != (system.model.dimension, points):
        raise RangeError(f"starts have shape {np.shape(starts)}, expected {(system.model.dimension, points)}")
    labelling = Labelling(settling or Settling(), lyapunov, steps, accuracy, method, workers)
    size = POOLS * POOL * LANES * (workers or cores())
    parts = []
    for first in range(0, points, size):
        batch = slice(first, first + size)
        measured, ensemble = labelling.measure(
            system, {name: column[batch] for name, column in columns.items()},
            starts=None if starts is None else np.asarray(starts, dtype=float)[:, batch], progress=progress,
        )  # fmt: skip
        part = points_dataset(system, {name: column[batch] for name, column in columns.items()}, measured)
        if ends:
            left = measured.end_state.T
            part["end_state"] = variable(("point", "state"), left, "1", "state at the end of the run, at phase zero")
            part = part.assign_coords(state=names_coordinate("state", system.states, "state"))
        parts.append(part)
    ds = parts[0] if len(parts) == 1 else xr.concat(parts, "point", data_vars="minimal", coords="minimal", join="exact")
    s = labelling.settling
    attributes = run_attributes(
        system, ensemble, varied=" ".join(columns), transient=s.transient, most=s.most, tolerance=s.tolerance,
        lyapunov_periods=labelling.longest(ensemble.strobe), **shared_common_multiple(system, columns, ensemble),
    )  # fmt: skip
    attributes.pop("accuracy_not_met", None)  # of the last batch; this is of all
    return with_attributes(ds, attributes | doubts(ds, system.model))
