"""Waterfall diagrams: spectra of one state over a range of a parameter, as a rule the speed."""

import json
from fractions import Fraction
from typing import Unpack

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from whirlmap.analysis.motion.ensembles import make_ensemble, run_attributes
from whirlmap.analysis.motion.record_length import recorded, settled_periods, spectrum_periods, turns_per_T
from whirlmap.analysis.spectra.spectrum import power_spectrum
from whirlmap.errors import RangeError, nearest
from whirlmap.integrate.own_units import in_own_units
from whirlmap.integrate.system import System
from whirlmap.options.computed import INTEGRATION, Integration
from whirlmap.options.execution import EXECUTION, Execution
from whirlmap.options.taking import IntegrationParts, takes_options
from whirlmap.results.schema import status_variable, variable, with_attributes

#: Turns of the slowest clock that pass before the record, and that it holds: half of what one spectrum has, for many speeds.
PASSED, HELD = 100, 8


@takes_options("waterfall")
def waterfall(
    system: System,
    parameter: str,
    values: ArrayLike,
    state: str,
    *,
    transient: int | None = None,
    periods: int = 256,
    samples: int = 20,
    integration: Integration = INTEGRATION,
    execution: Execution = EXECUTION,
    **_given: Unpack[IntegrationParts],
) -> xr.Dataset:
    """Power spectrum (Hann window) of a state at every value of a parameter.

    Parameters
    ----------
    system : System
        Its values and start states count.
    parameter : str
        Name of the varied parameter, or of the dimensional input that is the speed.
    values : array_like, shape (point,)
        Ascending; texts with a unit, or the text of a range, ``"500 rpm:6000 rpm:50"``.
    state : str
        The one whose spectrum is taken.
    transient : int, optional
        T dropped; where absent, `PASSED` turns of the slowest clock, up to `record_length.LONGEST_SETTLED` T.
    periods : int
        Least T of the record, which holds `HELD` turns of the slowest clock and, where they are short, whole common
        periods (`spectrum_periods`). A forced line then stands on a bin; else it may stand between two, and shows down to
        0.72 of its power, with the rest beside it.
    samples : int
        Samples per T; frequencies reach half of it. The record takes whole multiples of them as steps.
    integration : Integration, optional
        Method, and steps or accuracy; or its parts as keywords, ``method``, ``steps``, ``accuracy``.
    execution : Execution, optional
        How it is run, which changes no number; or its parts as keywords, ``workers``, ``progress``.

    Returns
    -------
    xr.Dataset
        ``power(frequency, parameter)``, one-sided, a sine of amplitude a showing a^2/2; ``frequency`` in multiples of 1/T;
        ``status(parameter)``. Points that ended have NaN. ``attrs["clocks"]`` holds the turns of each clock per T.

    Raises
    ------
    RangeError
        An unknown parameter or state, values that do not ascend, an unknown method, or a count that makes no sense.
    InputError
        A unit that the parameter does not have, or a speed without one.

    Notes
    -----
    Every point runs from its cold start through the transient, then records; the spectra are those of `power_spectrum`.
    Nothing asks whether a motion has settled or is periodic: labels come from `bifurcation_diagram`.
    """
    parameter, points = in_own_units(system, parameter, values)
    if state not in system.states:
        raise RangeError(f"{system.model.name} has no state {state!r}.{nearest(state, system.states)}")
    if points.ndim != 1 or np.any(np.diff(points) <= 0) or not np.isfinite(points).all():
        raise RangeError(f"values of {parameter!r} must be finite and ascend")
    ensemble, _ = make_ensemble(system, {parameter: points}, integration=integration, execution=execution)
    progress = execution.progress
    ensemble.advance(settled_periods(system, PASSED) if transient is None else transient, progress=progress)
    # the same samples in every point: whole multiples of them, at least as many as the point's own steps
    ensemble = ensemble.subset(np.arange(points.size), steps=samples * -(-ensemble.point_steps // samples))
    length = spectrum_periods(system, periods, HELD)
    series = recorded(ensemble, length, Fraction(1, samples), [system.states.index(state)], progress)[:, 0]
    good = ensemble.running
    power = power_spectrum(np.where(good, series, 0.0), rate=samples, unit="T")
    declared = system.model.parameter(parameter)
    lanes = str(power["power"].dims[1])
    ds = power.rename({lanes: parameter}).assign_coords(
        {parameter: variable(parameter, points, declared.unit, declared.meaning)}
    )
    ds["power"] = ds["power"].where(xr.DataArray(good, dims=parameter)).assign_attrs(ds["power"].attrs)
    ds["density"] = ds["density"].where(xr.DataArray(good, dims=parameter)).assign_attrs(ds["density"].attrs)
    ds["status"] = status_variable(parameter, ensemble.status)
    facts = {"clocks": json.dumps(turns_per_T(system)), "state": state, "varied": parameter}
    return with_attributes(ds, run_attributes(system, ensemble, **facts))
