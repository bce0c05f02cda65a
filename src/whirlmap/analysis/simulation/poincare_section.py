"""Poincaré sections of one operating point."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Unpack

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.motion.endings import confirm_run, restarted
from whirlmap.analysis.motion.ensembles import run_attributes
from whirlmap.analysis.motion.record_length import settled_periods
from whirlmap.analysis.motion.section_crossing import run_with_crossings
from whirlmap.analysis.simulation.one_point import one_point, refuse_counts, run_facts, units_of_states
from whirlmap.analysis.steady.settled_steps import check_steps
from whirlmap.errors import RangeError
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.system import System
from whirlmap.options.computed import INTEGRATION, Integration
from whirlmap.options.execution import EXECUTION, Execution
from whirlmap.options.taking import IntegrationParts, takes_options
from whirlmap.results.schema import names_coordinate, status_variable, variable, with_attributes

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]


@takes_options("section", former={"periods": "points"})
def section(
    system: System,
    *,
    points: int = 500,
    transient: int | None = None,
    once_per: str = "T",
    starts: int = 1,
    integration: Integration = INTEGRATION,
    execution: Execution = EXECUTION,
    **_given: Unpack[IntegrationParts],
) -> "xr.Dataset":
    """Poincaré section of a system.

    Parameters
    ----------
    system : System
        Its values and start states count.
    points : int
        Section points; for an unforced model, typical times in which crossings are collected.
    transient : int, optional
        T dropped before; where absent, 200 turns of the slowest clock (`settled_periods`).
    once_per : {"T", "common"}
        For a forced model: once per T, as the figures do, or once per common period, as dimensions need where it is short.
    starts : int
        Runs from starts that differ by 1e-6; in chaos they decorrelate, and the points of all are one sample.
    integration : Integration, optional
        Method, and steps or accuracy; or its parts as keywords, ``method``, ``steps``, ``accuracy``.
    execution : Execution, optional
        How it is run, which changes no number; or its parts as keywords, ``workers``, ``progress``.

    Returns
    -------
    xr.Dataset
        ``section(run, period, state)``, ``status(run)``; for an unforced model also ``crossing_time(run, period)``,
        rows beyond a run's last crossing being NaN.

    Raises
    ------
    RangeError
        Another ``once_per``, an unknown method, steps and an accuracy together, or a count that makes no sense.

    Notes
    -----
    Crossings are as exact as the steps (`crossings`), which are checked where the transient has passed; an end is believed
    where more steps find it again.
    A forced model is sampled at phase zero; an unforced one where it crosses its declared `Section`, located on the step.

    References
    ----------
    [parker1989] sections of forced and unforced systems.
    """
    import xarray as xr

    if once_per not in ("T", "common"):
        raise RangeError(f"once_per is 'T' or 'common', not {once_per!r}")
    transient = settled_periods(system) if transient is None else transient
    refuse_counts(points=(points, 1), transient=(transient, 0), starts=(starts, 1))
    ensemble, _ = one_point(system, integration, execution, starts)
    progress = execution.progress
    every = ensemble.common_multiple if system.model.forced and once_per == "common" else 1
    refuse_counts(**{"T of the section": (points * every, 1)})
    start, began, passed = ensemble.x.copy(), ensemble.turns.copy(), transient
    ensemble.advance(transient, progress=progress)
    confirm_run(ensemble, start, began, transient)
    if transient and check_steps(ensemble, progress):
        ensemble.advance(transient, progress=progress)
        passed += transient
    found, times = _section_points(ensemble, points, every, progress)
    if confirm_run(ensemble, start, began, passed + points * every):
        ensemble = restarted(ensemble, np.arange(starts), start, began, ensemble.point_steps)
        ensemble.advance(passed, progress=progress)
        found, times = _section_points(ensemble, points, every, progress)
    data = {} if times is None else {"crossing_time": variable(("run", "period"), times, "time", "time of the crossing")}
    data |= {
        "steps": variable("run", ensemble.point_steps, "1/T", "steps per T"),
        "section": variable(
            ("run", "period", "state"), found, "1", "section point", unit_of_each=units_of_states(system.model)
        ),
        "status": status_variable("run", ensemble.status),
    }
    ds = xr.Dataset(
        data,
        coords={
            "run": np.arange(found.shape[0]),
            "period": np.arange(1, found.shape[1] + 1),
            "state": names_coordinate("state", system.states, "state"),
        },
    )
    facts = run_facts(system, ensemble, transient=transient, once_per=once_per)
    return with_attributes(ds, run_attributes(system, ensemble, **facts))


def _section_points(
    ensemble: Ensemble, periods: int, every: int, progress: Callable[[int], None] | None
) -> tuple[Array, Array | None]:
    """Section points of the next ``periods`` times ``every`` T, shape (run, period, state).

    Of an unforced model: crossings in as many typical times, with their times from the start.
    """
    if ensemble.model.forced:
        points = ensemble.advance(periods * every, save_periods=every, progress=progress).saved
        return np.moveaxis(points, 2, 0), None
    start = ensemble.turns * ensemble.period
    points, times, _ = run_with_crossings(ensemble, periods, progress=progress)
    return np.moveaxis(points, 2, 0), (start + times).T
