"""Time series and sections of one operating point."""

from collections.abc import Callable
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from sympy import lambdify

from whirlmap.analysis.points import make_ensemble, run_attributes
from whirlmap.equations.model import Model
from whirlmap.errors import RangeError
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.system import System
from whirlmap.kernels.reference import reference_rates
from whirlmap.results.schema import names_coordinate, status_variable, variable, with_attributes
from whirlmap.results.status import Status

Array = NDArray[np.float64]


def outputs_of(model: Model, values: Array, x: Array) -> Array:
    """Outputs of a model at states (state, ...) for parameters (parameter,); shape (output, ...)."""
    function = lambdify(
        [list(model.states), list(model.parameters)], [o.expression for o in model.outputs.values()], modules="numpy"
    )
    rows = function(list(x), list(values))
    return np.array([np.broadcast_to(np.asarray(r, dtype=float), x.shape[1:]) for r in rows]).reshape(-1, *x.shape[1:])


def simulate(
    system: System,
    *,
    periods: int = 20,
    transient: int = 0,
    every: int = 1,
    steps: int | None = None,
    method: str = "rk4",
    workers: int | None = None,
    progress: Callable[[int], None] | None = None,
) -> xr.Dataset:
    """Time series of a system.

    Parameters
    ----------
    periods, transient : int
        Common periods that are recorded, and dropped before (for an unforced model: typical times).
    every : int
        Steps between recorded samples.
    steps : int, optional
        Steps per T.

    Returns
    -------
    xr.Dataset
        ``x(time, state)`` and ``output(time, output)``, with the start of the record first; ``time`` in the model's
        unit and ``turn(time)`` in T; ``status`` and ``end_time``. After an event the remaining samples are NaN.
    """
    ensemble, found = _one(system, steps, method, workers)
    _refuse_counts(periods=(periods, 1), transient=(transient, 0), every=(every, 1))
    common = ensemble.common_multiple
    if (periods * common * ensemble.steps) % every:
        raise RangeError(f"every = {every} does not divide the {periods * common * ensemble.steps} recorded steps")
    ensemble.advance(transient * common, progress=progress)
    begin = ensemble.x.copy()
    segment = ensemble.advance(periods * common, save_every=every, progress=progress)
    x = np.concatenate([begin[None, :, 0], segment.saved[:, :, 0]])
    count = np.arange(x.shape[0]) * every + transient * common * ensemble.steps
    model = system.model
    values = outputs_of(model, system.vector, x.T)
    ds = xr.Dataset(
        {
            "x": variable(("time", "state"), x, "1", "state", unit_of_each=_units(model)),
            "output": variable(("time", "output"), values.T, "1", "output"),
            "status": status_variable((), ensemble.status[0]),
            "end_time": variable((), ensemble.end_time[0], "time", "time at which the run ended early"),
            "start_found": variable((), int(found[0]), "1", "whether the default start exists"),
        },
        coords={
            "time": variable("time", count * float(ensemble.period[0]) / ensemble.steps, "time", "model's time"),
            "turn": variable("time", count / ensemble.steps, "T", "time in periods T"),
            "state": names_coordinate("state", system.states, "state"),
            "output": names_coordinate("output", list(model.outputs), "output"),
        },
    )
    return with_attributes(ds, run_attributes(system, ensemble, **_run_facts(system, ensemble, transient=transient)))


def section(
    system: System,
    *,
    periods: int = 500,
    transient: int = 200,
    once_per: str = "T",
    starts: int = 1,
    steps: int | None = None,
    method: str = "rk4",
    workers: int | None = None,
    progress: Callable[[int], None] | None = None,
) -> xr.Dataset:
    """Poincaré section of a system.

    Parameters
    ----------
    periods : int
        Section points; for an unforced model, typical times in which crossings are collected.
    transient : int
        Common periods dropped before.
    once_per : {"T", "common"}
        For a forced model: once per T, as the figures do, or once per common period, as dimensions need.
    starts : int
        Runs from starts that differ by 1e-6; in chaos they decorrelate, and the points of all are one sample.

    Returns
    -------
    xr.Dataset
        ``section(run, period, state)``, ``status(run)``; for an unforced model also ``crossing_time(run, period)``,
        rows beyond a run's last crossing being NaN.

    Notes
    -----
    Crossings are located on the cubic Hermite interpolant of each step by bisection: fourth order, as the method.
    """
    if once_per not in ("T", "common"):
        raise RangeError(f"once_per is 'T' or 'common', not {once_per!r}")
    _refuse_counts(periods=(periods, 1), transient=(transient, 0), starts=(starts, 1))
    ensemble, _ = _one(system, steps, method, workers, starts)
    common = ensemble.common_multiple
    ensemble.advance(transient * common, progress=progress)
    data: dict[str, Any] = {}
    if system.model.forced:
        every = common if once_per == "common" else 1
        points = ensemble.advance(periods * every, save_every=every * ensemble.steps, progress=progress).saved
        points = np.moveaxis(points, 2, 0)
    else:
        points, times = _crossings(system, ensemble, periods, progress)
        data["crossing_time"] = variable(("run", "period"), times, "time", "time of the crossing")
    data |= {
        "section": variable(("run", "period", "state"), points, "1", "section point", unit_of_each=_units(system.model)),
        "status": status_variable("run", ensemble.status),
    }
    ds = xr.Dataset(
        data,
        coords={
            "run": np.arange(points.shape[0]),
            "period": np.arange(1, points.shape[1] + 1),
            "state": names_coordinate("state", system.states, "state"),
        },
    )
    facts = _run_facts(system, ensemble, transient=transient, once_per=once_per)
    return with_attributes(ds, run_attributes(system, ensemble, **facts))


def _one(
    system: System, steps: int | None, method: str, workers: int | None, starts: int = 1
) -> tuple[Ensemble, NDArray[np.bool_]]:
    repeat = {system.parameters[0]: np.full(starts, system.vector[0])}
    return make_ensemble(system, repeat, steps=steps, method=method, workers=workers, swarm=starts > 1)


def _crossings(
    system: System, ensemble: Ensemble, periods: int, progress: Callable[[int], None] | None
) -> tuple[Array, Array]:
    """Crossings of the model's surface in the next ``periods`` typical times: (run, crossing, state) and times."""
    place = system.model.section
    if place is None:
        raise RangeError(f"{system.model.name} is not forced and declares no section: add section=Section(...)")
    surface = lambdify([list(system.model.states), list(system.model.parameters)], place.surface, modules="numpy")
    begin, h = ensemble.x.copy(), float(ensemble.period[0]) / ensemble.steps
    start = ensemble.step_count[0] * h
    x = np.concatenate([begin[None], ensemble.advance(periods, save_every=1, progress=progress).saved])
    value = surface(list(np.moveaxis(x, 1, 0)), list(system.vector))
    sign = 1.0 if place.direction == "rising" else -1.0
    step, run = np.nonzero((sign * value[:-1] <= 0) & (sign * value[1:] > 0))
    a, b = x[step, :, run].T, x[step + 1, :, run].T
    rates = reference_rates(system.model)
    fa, fb = rates(0.0, a, system.vector[:, None]), rates(0.0, b, system.vector[:, None])

    def hermite(u: Array) -> Array:
        return (
            (1 + 2 * u) * (1 - u) ** 2 * a + u * (1 - u) ** 2 * h * fa
            + u**2 * (3 - 2 * u) * b + u**2 * (u - 1) * h * fb
        )  # fmt: skip

    low, high = np.zeros(step.size), np.ones(step.size)
    for _ in range(60):
        middle = (low + high) / 2
        below = sign * surface(list(hermite(middle)), list(system.vector)) <= 0
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    located = hermite(low)
    count = np.bincount(run, minlength=x.shape[2])
    points = np.full((x.shape[2], max(int(count.max(initial=0)), 1), x.shape[1]), np.nan)
    times = np.full(points.shape[:2], np.nan)
    order = np.lexsort((step, run))
    index = np.concatenate([np.arange(c) for c in count]) if count.sum() else np.zeros(0, dtype=int)
    points[run[order], index] = located[:, order].T
    times[run[order], index] = start + (step + low)[order] * h
    return points, times


def _units(model: Model) -> str:
    return " ".join(s.unit for s in model.states)


def _run_facts(system: System, ensemble: Ensemble, **more: Any) -> dict[str, Any]:
    return {
        "period_T": float(ensemble.period[0]),
        "common_multiple": ensemble.common_multiple,
        "stop": _stop_name(system.model, ensemble),
        **more,
    }


def _stop_name(model: Model, ensemble: Ensemble) -> str | None:
    if ensemble.status[0] != Status.contact:
        return None
    return list(model.stops)[int(ensemble.end_stop[0])]


def _refuse_counts(**counts: tuple[int, int]) -> None:
    for name, (value, least) in counts.items():
        if not least <= value <= 100_000_000:
            raise RangeError(f"{name} must lie between {least} and 100000000, not {value}")
