"""Bifurcation diagrams: the section of a system against one parameter, every point labelled."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, Unpack

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from whirlmap.analysis.labels.labelling import measure
from whirlmap.analysis.labels.measured import Measured, joined
from whirlmap.analysis.motion.ensembles import run_attributes
from whirlmap.errors import RangeError
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.ranges import Range
from whirlmap.integrate.system import System
from whirlmap.options.computed import LABELLING, Labelling
from whirlmap.options.execution import EXECUTION, Execution
from whirlmap.options.taking import LabellingParts, takes_options
from whirlmap.results.schema import names_coordinate, with_attributes
from whirlmap.results.status import Status
from whirlmap.sweep.diagrams.hysteresis import with_hysteresis
from whirlmap.sweep.parameters.axis import Axis
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


@takes_options("bifurcation")
def bifurcation_diagram(
    system: System,
    parameter: str,
    values: ArrayLike | Range | Axis,
    *,
    follow: Follow | None = None,
    states: Sequence[str] | None = None,
    labelling: Labelling = LABELLING,
    execution: Execution = EXECUTION,
    **_given: Unpack[LabellingParts],
) -> xr.Dataset:
    """Section of every state against one parameter, with status, regime and amplitude of every point.

    Parameters
    ----------
    system : System
        Its values and start states count.
    parameter : str
        Name of the varied parameter, or of a dimensional input of the case.
    values : array_like, shape (point,), Range or str
        Its values, ascending. Of a case with dimensions they may have a unit: ``["40 um", "60 um"]``, or the text of a
        range, ``"40um:80um:50"``. The axis of a dimensional input is in that unit, and all groups follow from it.
    follow : {"up", "down", "both"}, optional
        Carry the state along, each point starting from the end of its neighbour, upwards, downwards or both (then
        the Dataset has a dimension ``direction``). Absent: every point starts cold, and all run together.
    states : sequence of str, optional
        States whose section is kept; the model's displacements (`kept_states`) where absent. All of them take 512 bytes
        per point and state with 64 T kept.
    labelling : Labelling, optional
        How points are measured; or its parts as keywords, ``settling``, ``lyapunov``, ``method``, ``steps``, ``accuracy``.
    execution : Execution, optional
        How it is run, which changes no number; or its parts as keywords, ``workers``, ``progress``.

    Returns
    -------
    xr.Dataset
        ``section(parameter, period, state)`` once per T; ``regime``, ``status``, ``period_T`` (in T), ``period_common``,
        ``return_distance``, ``lyapunov``, ``lyapunov_error``, ``lyapunov_periods``, ``confidence``, ``rule``,
        ``rotation_number``, ``end_time`` (parameter); ``minimum``, ``maximum``, ``mean``, ``rms``, ``peak_to_peak``
        (parameter, quantity) of states and outputs over all steps of the record; ``max_eccentricity``, ``min_film``
        (parameter, bearing) where the model has bearings; with ``follow="both"`` also ``hysteresis`` (parameter): whether
        the two branches differ.

    Raises
    ------
    RangeError
        An unknown parameter, state or ``follow``; values that do not ascend; the order of a harmonic as the parameter; an
        unknown method, or steps and an accuracy together.

    Notes
    -----
    Following is a chain by its nature, one point after the other; it shows hysteresis, and is slower than a cold start.
    A point that ends in contact or diverges hands on the default start of the next.
    Points are labelled as `label_points` says. Unstable branches and the bifurcation points themselves are not computed; two
    values between which the label changes bracket one.
    """
    axis = Axis.of(system, parameter, values, "values")
    if follow is not None and follow not in ("up", "down", "both"):
        raise RangeError(f"follow is up, down or both, not {follow!r}")
    kept = kept_states(system, states)
    run, settling = _Run(system, kept, labelling, execution), labelling.settling
    if follow is None:
        measured, ensemble = run.cold(axis)
        ds = _dataset(system, axis, measured, kept)
    else:
        parts = []
        for way in ("up", "down") if follow == "both" else (follow,):
            measured, ensemble = run.chain(axis, downwards=way == "down")
            parts.append(_dataset(system, axis, measured, kept).assign_coords(direction=way))
        ds = parts[0] if len(parts) == 1 else xr.concat(parts, "direction", join="exact", coords="minimal", compat="equals")
    facts = {
        "varied": axis.name, "follow": follow or "none", "transient": settling.transient, "most": settling.most,
        "tolerance": settling.tolerance, "lyapunov_periods": labelling.longest(ensemble.strobe),
        **shared_common_multiple(system, axis.columns, ensemble),
    }  # fmt: skip
    attributes = run_attributes(system, ensemble, **facts)
    attributes.pop("accuracy_not_met", None)  # of the last point of a chain; this is of all
    ds = with_attributes(ds, attributes | doubts(ds, system.model))
    return with_hysteresis(ds, system, axis.name) if follow == "both" else ds


@dataclass(frozen=True)
class _Run:
    """What all points of a diagram share."""

    system: System
    kept: list[str]
    labelling: Labelling
    execution: Execution

    def cold(self, axis: Axis, starts: Array | None = None) -> tuple[Measured, Ensemble]:
        """Measure points, each from its own start."""
        return measure(self.system, axis.columns, self.labelling, self.execution, starts=starts, kept=self.kept)

    def chain(self, axis: Axis, *, downwards: bool) -> tuple[Measured, Ensemble]:
        """Measure points one after the other, each from the end of the one before."""
        count = axis.values.size
        order = range(count - 1, -1, -1) if downwards else range(count)
        starts: Array | None = None
        made: dict[int, Measured] = {}
        for i in order:
            made[i], ensemble = self.cold(axis.take(slice(i, i + 1)), starts)
            starts = made[i].end_state if made[i].status[0] == Status.ok else None
        return joined([made[i] for i in range(count)], [np.array([i]) for i in range(count)]), ensemble


def select_states(ds: xr.Dataset, system: System, kept: list[str]) -> xr.Dataset:
    """Return a diagram with the section of some of its states."""
    out = ds.sel(state=kept)
    out["section"].attrs["unit_of_each"] = " ".join({s.name: s.unit for s in system.model.states}[n] for n in kept)
    return out


def _dataset(system: System, axis: Axis, m: Measured, kept: list[str]) -> xr.Dataset:
    parameter, r = axis.name, m.returns
    data: dict[str, Any] = {
        "section": section_variable(parameter, system, m, kept),
        **point_variables(parameter, m),
        **common_multiple_variable(parameter, system, axis.columns, m),
        **extreme_variables(parameter, system, m.returns.extremes, axis.columns),
    }  # fmt: skip
    return xr.Dataset(
        data,
        coords={
            **axis.coordinates(system),
            "period": np.arange(1, r.section.shape[0] + 1),
            "state": names_coordinate("state", kept, "state"),
            **extreme_coordinates(system),
        },
    )
