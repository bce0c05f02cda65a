"""Diagnosis of a long record in sliding windows."""

from collections.abc import Callable

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from whirlmap.analysis.signals.judged_signal import NoMotionError, judge_signal
from whirlmap.analysis.signals.order_names import order_name
from whirlmap.errors import RangeError
from whirlmap.recordings.shaft_speed import ShaftSpeed
from whirlmap.results.regime import Regime
from whirlmap.results.schema import regime_variable, variable

#: Windows of a record at most.
MOST = 200


def sliding_verdict(
    values: ArrayLike,
    *,
    rate: float,
    length: float,
    start: float = 0.0,
    unit: str = "s",
    quantity_unit: str = "1",
    shaft: ShaftSpeed | None = None,
    teeth: int | None = None,
    progress: Callable[[int], None] | None = None,
) -> xr.Dataset:
    """Judge windows of a record, half a window apart.

    Parameters
    ----------
    values : array, shape (time,)
    rate : float
        Samples per unit of time.
    length : float
        Of a window, in units of time.
    start : float
        Time of the first sample.
    unit, quantity_unit : str
        Units of time and of the values.
    shaft : ShaftSpeed, optional
        How a shaft turns during the record.
    teeth : int, optional
        Of the gear on that shaft.
    progress : callable, optional
        Told of each window.

    Returns
    -------
    xr.Dataset
        ``window_regime``, ``window_reason``, ``window_rms`` and ``window_frequency`` over ``window_start``; with a shaft
        also ``window_speed``, ``window_order`` and ``window_order_name``. Windows that cannot be judged (few oscillations,
        no motion) are ``undecided`` with their reason, and their frequency is NaN.

    Raises
    ------
    RangeError
        The window is longer than the record or shorter than 1000 samples, or there are more than 200.
    """
    x = np.asarray(values, dtype=float)
    size = round(length * rate)
    if not 1000 <= size <= x.size:
        raise RangeError(f"a window of {length:g} {unit} holds {size} samples: 1000 to {x.size} are needed")
    begins = range(0, x.size - size + 1, size // 2)
    if len(begins) > MOST:
        raise RangeError(f"windows of {length:g} {unit} are {len(begins)}: at most {MOST}; take longer ones")
    regimes, frequency, rms, why, speeds, names = [], [], [], [], [], []
    for begin in begins:
        part = x[begin : begin + size]
        scale = float(np.abs(part).max()) or 1.0
        rms.append(float((part / scale).std()) * scale)
        try:
            ds = judge_signal(part, rate, unit)
        except NoMotionError as fault:
            regimes.append(int(Regime.undecided))
            frequency.append(np.nan)
            why.append(fault.reason)
        else:
            regimes.append(int(ds["regime"]))
            frequency.append(float(ds.attrs.get("frequency", np.nan)))
            why.append(str(ds.attrs["why"]))
        turning = None if shaft is None else shaft.per_sample(begin, begin + size)
        speeds.append(np.nan if turning is None else turning * rate)
        named = turning is not None and np.isfinite(frequency[-1])
        names.append(order_name(frequency[-1], speeds[-1], teeth, rate / size) if named else "")
        if progress:
            progress(1)
    over, per = "window_start", "1" if unit == "1" else f"1/{unit}"
    data = {
        "window_regime": regime_variable(over, regimes),
        "window_reason": variable(over, why, "1", "why the window has no one regime, or is undecided"),
        "window_rms": variable(over, rms, quantity_unit, "rms of the window about its mean"),
        "window_frequency": variable(over, frequency, per, "frequency: of the cycle, else of the strongest line"),
    }
    if shaft is not None:
        order = np.divide(frequency, speeds)
        data["window_speed"] = variable(over, speeds, per, "mean speed of the shaft in the window [turns]")
        data["window_order"] = variable(over, order, "1", "frequency of the window over the speed of the shaft")
        data["window_order_name"] = variable(over, names, "1", "name of that order")
    at = variable(over, start + np.array(begins) / rate, unit, "first time of the window")
    return xr.Dataset(data, {over: at}, {"window_length": length})
