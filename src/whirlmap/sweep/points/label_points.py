"""Labels of operating points anywhere in parameter space: what diagrams, maps and draws are made of.

The numbers of a point depend on its own parameters and start alone: not on the points computed with it, their number or
order, nor on the number of threads.
"""

from collections.abc import Mapping
from typing import Unpack

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from whirlmap.analysis.labels.labelling import measure
from whirlmap.analysis.motion.ensembles import parameter_values, run_attributes
from whirlmap.analysis.steady.pool import POOL
from whirlmap.errors import RangeError
from whirlmap.integrate.division import cores
from whirlmap.integrate.own_units import in_own_units
from whirlmap.integrate.ranges import plain_numbers
from whirlmap.integrate.system import System
from whirlmap.kernels.writing.routine import LANES
from whirlmap.options.computed import LABELLING, Labelling
from whirlmap.options.execution import EXECUTION, Execution
from whirlmap.options.taking import LabellingParts, takes_options
from whirlmap.results.schema import names_coordinate, variable, with_attributes
from whirlmap.sweep.points.point_variables import doubts, points_dataset, shared_common_multiple

Array = NDArray[np.float64]

#: Batches that `label_points` works through hold so many pools of lanes: enough that few lanes wait for the last point.
POOLS = 2


@takes_options("points")
def label_points(
    system: System,
    values: Mapping[str, ArrayLike],
    *,
    starts: Array | None = None,
    ends: bool = False,
    labelling: Labelling = LABELLING,
    execution: Execution = EXECUTION,
    **_given: Unpack[LabellingParts],
) -> xr.Dataset:
    """Label operating points anywhere in parameter space.

    Parameters
    ----------
    system : System
        Its values and start states count.
    values : mapping of str to array, shape (point,)
        The parameters that differ between points, in any order; all columns of the same length. Texts may have a unit,
        ``{"speed": ["500 rpm", "600 rpm"]}``; a column may be a range, ``"500 rpm:6000 rpm:50"``.
    starts : array, shape (state, point), optional
        Start states, at phase zero; the model's default start where absent.
    ends : bool
        Whether to keep the states at the ends of the records, at phase zero: starts of others. NaN where a run has ended.
    labelling : Labelling, optional
        How points are measured; or its parts as keywords, ``settling``, ``lyapunov``, ``method``, ``steps``, ``accuracy``.
    execution : Execution, optional
        How it is run, which changes no number; or its parts as keywords, ``workers``, ``progress``.

    Returns
    -------
    xr.Dataset
        Over ``point``, with the varied parameters as coordinates: ``regime``, ``status``, ``period_T`` (in T),
        ``period_common``, ``return_distance``, ``lyapunov``, ``lyapunov_error``, ``lyapunov_periods``, ``confidence``,
        ``rule``, ``rotation_number``, ``end_time``, ``settled_after``, ``start_found``, ``steps``, ``step_error``,
        ``step_verdict``, ``grazings``; over
        ``(point, quantity)``, states and outputs: ``minimum``, ``maximum``, ``mean``, ``rms``, ``peak_to_peak``; over
        ``(point, bearing)``, where the model has outputs named ``eps``: ``max_eccentricity`` and ``min_film``, in
        clearances, and ``max_load`` where it has outputs named ``load``; with ``ends`` also ``end_state(point, state)``,
        and ``end_periods``, the T since phase zero there: zero where motions return.
        No section is kept.

    Raises
    ------
    RangeError
        Where a name or a value is not the model's, lengths differ, or there is no point.
    InputError
        A unit that a parameter does not have, or a speed without one.

    Notes
    -----
    A point settles until it returns within the tolerance (periodic), and otherwise runs with one tangent vector in doubling
    stretches until the rule of `regime` gives a label or ``lyapunov`` T have passed. A return that is longer than
    `Settling.most` common periods is not seen; the attractor is that of the one start.

    The numbers of a point do not depend, by a bit, on the points in its company. Points that ended early have NaN for
    what needs a whole record, and their ``status`` says why.

    References
    ----------
    [benettin1980] exponents; [das2017] and [sander2020] averages and rotation numbers; [gomez2010] locked motion.
    """
    columns: dict[str, Array] = {}
    for written, given in values.items():
        name, column = in_own_units(system, written, given)
        if name in columns:
            raise RangeError(f"values: {name} is given twice: expected each parameter once")
        columns[name] = column
    if not columns:
        raise RangeError("values: found no parameter, expected at least one, as in {'s': [0.5, 1.0]}")
    for name, column in columns.items():
        if column.ndim != 1 or not column.size or not np.isfinite(column).all():
            raise RangeError(f"values of {name!r} must be a list of one or more finite numbers")
    points = parameter_values(system, columns).shape[1]
    x = None if starts is None else plain_numbers("starts", starts)
    if x is not None and x.shape != (system.model.dimension, points):
        raise RangeError(f"starts have shape {x.shape}, expected {(system.model.dimension, points)}")
    size = POOLS * POOL * LANES * (execution.workers or cores())
    parts = []
    for first in range(0, points, size):
        batch = slice(first, first + size)
        measured, ensemble = measure(
            system, {name: column[batch] for name, column in columns.items()}, labelling, execution,
            starts=None if x is None else x[:, batch],
        )  # fmt: skip
        part = points_dataset(system, {name: column[batch] for name, column in columns.items()}, measured)
        if ends:
            left = measured.end_state.T
            part["end_state"] = variable(("point", "state"), left, "1", "state at the end of the run")
            part["end_periods"] = variable("point", measured.end_periods, "T", "T since phase zero there")
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
