"""Diagnosis of a long record in sliding windows."""

from collections.abc import Callable

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from whirlmap.analysis.signals.diagnose_series import diagnose_series
from whirlmap.errors import RangeError
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
    progress : callable, optional
        Told of each window.

    Returns
    -------
    xr.Dataset
        ``window_regime``, ``window_rms`` and ``window_frequency`` over ``window_start``; windows that cannot be judged (few
        swings, no motion) are ``undecided``, and their frequency is NaN.

    Raises
    ------
    RangeError
        The window is longer than the record or shorter than 1000 samples, or there are more than 200.
    """
    x = np.asarray(values, dtype=float)
    size = round(length * rate)
    if not 1000 <= size <= x.size:
        raise RangeError(f"a window of {length:g} {unit} holds {size} samples: 1000 to {x.size} are needed")
    begins = np.arange(0, x.size - size + 1, size // 2)
    if begins.size > MOST:
        raise RangeError(f"windows of {length:g} {unit} are {begins.size}: at most {MOST}; take longer ones")
    regimes, frequency, rms = [], [], []
    for begin in begins:
        part = x[begin : begin + size]
        scale = float(np.abs(part).max()) or 1.0
        rms.append(float((part / scale).std()) * scale)
        try:
            ds = diagnose_series(part, rate=rate, unit=unit)
        except RangeError:
            regimes.append(0)
            frequency.append(np.nan)
        else:
            regimes.append(int(ds["regime"]))
            frequency.append(float(ds.attrs.get("frequency", np.nan)))
        if progress:
            progress(1)
    return xr.Dataset(
        {
            "window_regime": regime_variable("window_start", regimes),
            "window_rms": variable("window_start", rms, "1", "rms of the window about its mean"),
            "window_frequency": variable(
                "window_start", frequency, f"1/{unit}", "frequency: of the cycle, else of the strongest line"
            ),
        },
        {"window_start": variable("window_start", start + begins / rate, unit, "first time of the window")},
        {"window_length": length},
    )
