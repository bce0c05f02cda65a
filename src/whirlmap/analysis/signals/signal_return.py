"""Return of a signal: x(t + P) compared with x(t), directly."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def return_distance(x: Array, period: float) -> float:
    """Mean square of x(t + P) - x(t) over twice the variance: 0 where the signal returns, about 1 for noise.

    Parameters
    ----------
    x : array, shape (time,)
    period : float
        In samples, less than the record.

    Notes
    -----
    Between samples the signal is moved by the phases of its transform; a Hann weight keeps the ends out, where that is
    wrong.
    """
    whole = round(period)
    part = period - whole
    centred = x - x.mean()
    moved = centred
    if abs(part) > 1e-9:
        transform = np.fft.rfft(centred) * np.exp(2j * np.pi * np.fft.rfftfreq(x.size) * part)
        moved = np.fft.irfft(transform, x.size)
    early, late = centred[: x.size - whole], moved[whole:]
    weight = np.hanning(early.size + 2)[1:-1]
    variance = float(weight @ (early - weight @ early / weight.sum()) ** 2)
    return float(weight @ (late - early) ** 2) / (2 * variance) if variance > 0 else np.inf
