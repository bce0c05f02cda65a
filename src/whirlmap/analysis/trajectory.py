"""Time series and sections of one operating point."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.crossing import run_with_crossings
from whirlmap.analysis.points import make_ensemble, run_attributes
from whirlmap.analysis.settled_steps import check_steps
from whirlmap.equations.model import Model
from whirlmap.errors import RangeError
from whirlmap.integrate.accuracy import doubtful
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.rescue import end_named
from whirlmap.integrate.system import System
from whirlmap.kernels.reference import reference_outputs
from whirlmap.results.schema import names_coordinate, status_variable, variable, with_attributes

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]


def outputs_of(model: Model, values: Array, x: Array) -> Array:
    """Outputs of a model at states (state, ...) for parameters (parameter,); shape (output, ...)."""
    return reference_outputs(model)(x, values.reshape(-1, *(1,) * (x.ndim - 1)))


#: Least steps per T of a time series whose steps are chosen by accuracy: a smooth picture needs more than an orbit.
SAMPLES = 100


def series_steps(
    system: System, *, steps: int | None = None, accuracy: float | None = None, method: str | None = None
) -> tuple[int, dict[str, str]]:
    """Return the steps per T of a time series: those given, or enough for the accuracy and for a smooth picture.

    With them the attribute that says where the accuracy is not met.
    """
    chosen = make_ensemble(system, steps=steps, accuracy=accuracy, method=method)[0]
    doubts = doubtful(chosen.step_verdict)
    return chosen.steps if steps is not None else max(SAMPLES, chosen.steps), {"accuracy_not_met": doubts} if doubts else {}


def simulate(
    system: System,
    *,
    periods: int = 20,
    transient: int = 0,
    every: int = 1,
    steps: int | None = None,
    accuracy: float | None = None,
    method: str | None = None,
    workers: int | None = None,
    progress: Callable[[int], None] | None = None,
) -> "xr.Dataset":
    """Time series of a system.

    Parameters
    ----------
    periods, transient : int
        Common periods that are recorded, and dropped before (for an unforced model: typical times).
    every : int
        Steps between recorded samples.
    steps, accuracy, method, workers
        As in `make_ensemble`; but `SAMPLES` steps per T are taken where the accuracy asks for fewer.

    Returns
    -------
    xr.Dataset
        ``x(time, state)`` and ``outputs(time, output)``, with the start of the record first; ``time`` in the model's
        unit and ``turn(time)`` in T; ``status`` and ``end_time``. After an event the remaining samples are NaN.
    """
    import xarray as xr

    steps, doubts = series_steps(system, steps=steps, accuracy=accuracy, method=method)
    ensemble, found = _one(system, steps, None, method, workers)
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
            "outputs": variable(("time", "output"), values.T, "1", "output"),
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
    facts = _run_facts(system, ensemble, transient=transient, **doubts)
    return with_attributes(ds, run_attributes(system, ensemble, **facts))


def section(
    system: System,
    *,
    periods: int = 500,
    transient: int = 200,
    once_per: str = "T",
    starts: int = 1,
    steps: int | None = None,
    accuracy: float | None = None,
    method: str | None = None,
    workers: int | None = None,
    progress: Callable[[int], None] | None = None,
) -> "xr.Dataset":
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
    Crossings are as exact as the steps (`crossings`).
    """
    import xarray as xr

    if once_per not in ("T", "common"):
        raise RangeError(f"once_per is 'T' or 'common', not {once_per!r}")
    _refuse_counts(periods=(periods, 1), transient=(transient, 0), starts=(starts, 1))
    ensemble, _ = _one(system, steps, accuracy, method, workers, starts)
    common = ensemble.common_multiple
    ensemble.advance(transient * common, progress=progress)
    if transient and check_steps(ensemble, progress):
        ensemble.advance(transient * common, progress=progress)
    data: dict[str, Any] = {}
    if system.model.forced:
        every = common if once_per == "common" else 1
        points = ensemble.advance(periods * every, save_periods=every, progress=progress).saved
        points = np.moveaxis(points, 2, 0)
    else:
        points, times = _crossings(ensemble, periods, progress)
        data["crossing_time"] = variable(("run", "period"), times, "time", "time of the crossing")
    data |= {
        "steps": variable("run", ensemble.point_steps, "1/T", "steps per T"),
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
    system: System, steps: int | None, accuracy: float | None, method: str | None, workers: int | None, starts: int = 1
) -> tuple[Ensemble, NDArray[np.bool_]]:
    repeat = {system.parameters[0]: np.full(starts, system.vector[0])}
    return make_ensemble(
        system, repeat, steps=steps, accuracy=accuracy, method=method, workers=workers, swarm=starts > 1
    )  # fmt: skip


def _crossings(
    ensemble: Ensemble, periods: int, progress: Callable[[int], None] | None
) -> tuple[Array, Array]:
    """Crossings in the next ``periods`` typical times: (run, crossing, state), and their times from the start."""
    start = ensemble.turns * ensemble.period
    points, times, _ = run_with_crossings(ensemble, periods, progress=progress)
    return np.moveaxis(points, 2, 0), (start + times).T


def _units(model: Model) -> str:
    return " ".join(s.unit for s in model.states)


def _run_facts(system: System, ensemble: Ensemble, **more: Any) -> dict[str, Any]:
    return {
        "period_T": float(ensemble.period[0]),
        "common_multiple": ensemble.common_multiple,
        "stop": end_named(system.model, int(ensemble.end_stop[0])),
        **more,
    }


def _refuse_counts(**counts: tuple[int, int]) -> None:
    for name, (value, least) in counts.items():
        if not least <= value <= 100_000_000:
            raise RangeError(f"{name} must lie between {least} and 100000000, not {value}")
