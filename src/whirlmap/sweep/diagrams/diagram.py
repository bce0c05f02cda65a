"""Bifurcation diagrams: the section of a system against one parameter, every point labelled."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from whirlmap.analysis.labels.labelling import Labelling
from whirlmap.analysis.labels.measured import Measured, joined
from whirlmap.analysis.motion.ensembles import run_attributes
from whirlmap.analysis.steady.settling import Settling
from whirlmap.errors import RangeError
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.system import System
from whirlmap.progress import ProgressOption, shows_progress
from whirlmap.results.schema import names_coordinate, variable, with_attributes
from whirlmap.results.status import Status
from whirlmap.sweep.diagrams.hysteresis import with_hysteresis
from whirlmap.sweep.points.extremes import extreme_coordinates, extreme_variables
from whirlmap.sweep.points.point_variables import (
    common_multiple_variable,
    doubts,
    kept_states,
    point_variables,
    section_variable,
    shared_common_multiple,
)

Array = NDArray[np.float64]
Follow = Literal["up", "down", "both"]


@shows_progress("bifurcation")
def bifurcation_diagram(
    system: System,
    parameter: str,
    values: ArrayLike,
    *,
    follow: Follow | None = None,
    settling: Settling | None = None,
    lyapunov: int | None = None,
    states: Sequence[str] | None = None,
    steps: int | None = None,
    accuracy: float | None = None,
    method: str | None = None,
    workers: int | None = None,
    progress: ProgressOption = None,
) -> xr.Dataset:
    """Section of every state against one parameter, with status, regime and amplitude of every point.

    Parameters
    ----------
    parameter : str
        Name of the varied parameter.
    values : array_like, shape (point,)
        Its values, ascending.
    follow : {"up", "down", "both"}, optional
        Carry the state along, each point starting from the end of its neighbour, upwards, downwards or both (then
        the Dataset has a dimension ``direction``). Absent: every point starts cold, and all run together.
    settling : Settling, optional
        Transient, windows and tolerance.
    lyapunov : int, optional
        T over which points that do not return run with a tangent vector, at most, as in `label_points`; 0: none do, and stay
        undecided. Where absent: as long as labels may need.
    states : sequence of str, optional
        States whose section is kept; the model's displacements (`kept_states`) where absent. All of them take 512 bytes
        per point and state with 64 T kept.
    progress : callable or True, optional
        Called with the number of points x periods T done since the last call; True shows a bar.

    Returns
    -------
    xr.Dataset
        ``section(parameter, period, state)`` once per T; ``regime``, ``status``, ``period_T`` (in T), ``period_common``,
        ``return_distance``, ``lyapunov``, ``lyapunov_error``, ``lyapunov_periods``, ``confidence``, ``rule``,
        ``rotation_number``, ``end_time`` (parameter); ``minimum``, ``maximum``, ``mean``, ``rms``, ``peak_to_peak``
        (parameter, quantity) of states and outputs over all steps of the record; ``max_eccentricity``, ``min_film``
        (parameter, bearing) where the model has bearings; with ``follow="both"`` also ``hysteresis`` (parameter): whether
        the two branches differ.

    Notes
    -----
    Following is a chain by its nature, one point after the other; it shows hysteresis, and is slower than a cold start.
    A point that ends in contact or diverges hands on the default start of the next.
    """
    settling = settling or Settling()
    try:
        points = np.atleast_1d(np.asarray(values, dtype=float))
    except ValueError as error:  # text such as "1000 rpm", which the command line converts
        raise RangeError(f"values of {parameter!r} must be numbers in the model's own units: {error}") from error
    if points.ndim != 1 or points.size < 1 or np.any(np.diff(points) <= 0) or not np.isfinite(points).all():
        raise RangeError(f"values of {parameter!r} must be finite and ascend")
    if follow is not None and follow not in ("up", "down", "both"):
        raise RangeError(f"follow is up, down or both, not {follow!r}")
    kept = kept_states(system, states)
    labelling = Labelling(settling, lyapunov, steps, accuracy, method, workers, kept=tuple(kept))
    run = _Run(system, parameter, labelling, progress)
    if follow is None:
        measured, ensemble = run.cold(points)
        ds = _dataset(system, parameter, points, measured, kept)
    else:
        parts = []
        for way in ("up", "down") if follow == "both" else (follow,):
            measured, ensemble = run.chain(points, downwards=way == "down")
            parts.append(_dataset(system, parameter, points, measured, kept).assign_coords(direction=way))
        ds = parts[0] if len(parts) == 1 else xr.concat(parts, "direction", join="exact", coords="minimal", compat="equals")
    facts = {
        "varied": parameter, "follow": follow or "none", "transient": settling.transient, "most": settling.most,
        "tolerance": settling.tolerance, "lyapunov_periods": labelling.longest(ensemble.strobe),
        **shared_common_multiple(system, [parameter], ensemble),
    }  # fmt: skip
    attributes = run_attributes(system, ensemble, **facts)
    attributes.pop("accuracy_not_met", None)  # of the last point of a chain; this is of all
    ds = with_attributes(ds, attributes | doubts(ds, system.model))
    return with_hysteresis(ds, system, parameter) if follow == "both" else ds


@dataclass(frozen=True)
class _Run:
    """What all points of a diagram share."""

    system: System
    parameter: str
    labelling: Labelling
    progress: Callable[[int], None] | None

    def cold(self, points: Array, starts: Array | None = None) -> tuple[Measured, Ensemble]:
        """Measure points, each from its own start."""
        return self.labelling.measure(self.system, {self.parameter: points}, starts=starts, progress=self.progress)

    def chain(self, points: Array, *, downwards: bool) -> tuple[Measured, Ensemble]:
        """Measure points one after the other, each from the end of the one before."""
        order = range(points.size - 1, -1, -1) if downwards else range(points.size)
        starts: Array | None = None
        made: dict[int, Measured] = {}
        for i in order:
            made[i], ensemble = self.cold(points[i : i + 1], starts)
            starts = made[i].end_state if made[i].status[0] == Status.ok else None
        return joined([made[i] for i in range(points.size)], [np.array([i]) for i in range(points.size)]), ensemble


def select_states(ds: xr.Dataset, system: System, kept: list[str]) -> xr.Dataset:
    """Return a diagram with the section of some of its states."""
    out = ds.sel(state=kept)
    out["section"].attrs["unit_of_each"] = " ".join({s.name: s.unit for s in system.model.states}[n] for n in kept)
    return out


def _dataset(system: System, parameter: str, points: Array, m: Measured, kept: list[str]) -> xr.Dataset:
    model, r = system.model, m.returns
    declared = model.parameter(parameter)
    data: dict[str, Any] = {
        "section": section_variable(parameter, system, m, kept),
        **point_variables(parameter, m),
        **common_multiple_variable(parameter, system, [parameter], m),
        **extreme_variables(parameter, system, m.returns.extremes),
    }  # fmt: skip
    return xr.Dataset(
        data,
        coords={
            parameter: variable(parameter, points, declared.unit, declared.meaning),
            "period": np.arange(1, r.section.shape[0] + 1),
            "state": names_coordinate("state", kept, "state"),
            **extreme_coordinates(system),
        },
    )
