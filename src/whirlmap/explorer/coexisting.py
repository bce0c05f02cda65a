"""Coexisting motions of a point: those that come to it along an axis from below and from above."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.explorer.control import Values, system_at
from whirlmap.explorer.exploration import Exploration
from whirlmap.explorer.jobs import Job
from whirlmap.explorer.motion import Motion, motion, motion_json
from whirlmap.options.computed import Labelling
from whirlmap.sweep.points.label_points import label_points

Array = NDArray[np.float64]

#: Steps in which the state is carried to the point, and the part of the axis on either side that they begin at.
STEPS, REACH = 8, 0.2


def coexisting(
    job: Job, exploration: Exploration, values: Values, along: str, quantity: str
) -> dict[str, Any]:
    """Carry the state to a point along an axis, upwards and downwards.

    Returns
    -------
    dict
        ``up`` and ``down``: the motion, as `motion_json` gives it, None where the run ended on the way.
    """
    job.total = 2 * (STEPS + 1)
    found: dict[str, Any] = {}
    for way, sign in (("up", -1.0), ("down", 1.0)):
        arrived = _carried(job, exploration, values, along, sign)
        found[way] = None if arrived is None else motion_json(arrived, quantity)
    return found


def _carried(
    job: Job, exploration: Exploration, values: Values, along: str, sign: float
) -> Motion | None:
    control = exploration.controls[along]
    here = float(values.get(along, control.value))
    low, high = control.low, control.high
    if control.log and min(here, low) > 0:
        far = here * (high / low) ** (sign * REACH)
        path = np.geomspace(far, here, STEPS + 1)
    else:
        path = np.linspace(here + sign * REACH * (high - low), here, STEPS + 1)
    state: Array | None = None
    for value in np.clip(path, min(low, here), max(high, here))[:-1]:
        system = system_at(exploration.system, exploration.controls, {**values, along: float(value)})
        point = label_points(
            system, {system.parameters[0]: [float(system.vector[0])]}, ends=True,
            starts=None if state is None else state[:, None],
            labelling=Labelling(exploration.labelling.settling, 0, exploration.labelling.integration),
        )  # fmt: skip
        end = np.asarray(point["end_state"])[0]
        state = end if np.isfinite(end).all() else None
        job(1)
    system = system_at(exploration.system, exploration.controls, values)
    arrived = motion(system, exploration.labelling, state)
    job(1)
    return arrived
