"""Power spectra, and full spectra of orbits (forward and backward whirl).

The spectra are single windowed periodograms over the whole record, not averages of segments (Welch): a steady
motion is recorded as long as is wanted, and resolution is what tells lines from a broadband spectrum.
"""

from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from whirlmap.errors import RangeError
from whirlmap.results.findings import Findings, gives_dataset

Window = Literal["boxcar", "hann", "hamming", "blackman", "blackmanharris", "flattop"]

#: Each window as a sum of cosines, over one turn.
_COSINES = {
    "boxcar": (1.0,),
    "hann": (0.5, 0.5),
    "hamming": (0.54, 0.46),
    "blackman": (0.42, 0.50, 0.08),
    "blackmanharris": (0.35875, 0.48829, 0.14128, 0.01168),
    "flattop": (0.21557895, 0.41663158, 0.277263158, 0.083578947, 0.006947368),
}

LOBE = {"boxcar": 1, "hann": 2, "hamming": 2, "blackman": 3, "blackmanharris": 4, "flattop": 5}
"""Half-width of each window's main lobe [frequency bins]."""


@gives_dataset
def power_spectrum(
    values: ArrayLike, *, rate: float, window: Window = "hann", detrend: bool = True, unit: str = "1"
) -> Findings:
    """One-sided power spectrum and power spectral density of real series.

    Parameters
    ----------
    values : array, shape (time,), (time, lane) or (time, state, lane)
        Evenly spaced samples.
    rate : float
        Samples per unit of time; to have frequencies in orders of 1/T give the samples per T.
    window : {"hann", "boxcar", "hamming", "blackman", "blackmanharris", "flattop"}
        Hann tells apart lines two bins from each other; flattop gives the height of a line between bins to
        0.1 %.
    detrend : bool
        Subtract the mean of each series first. A linear trend is left in: a steady motion has none.
    unit : str
        The unit of time ``rate`` counts samples in, for the attributes: frequencies are in 1/unit.

    Returns
    -------
    xr.Dataset
        ``power(frequency, ...)``: a sine of amplitude a on a bin shows a^2/2 there (scaling "spectrum";
        between two
        bins down to 0.72 of it with Hann). ``density(frequency, ...)``: its sum times ``frequency_step`` is
        the window-weighted mean square of the series, sum((w x)^2) / sum(w^2), exactly (Parseval); the plain
        mean square for the boxcar. Squared units of the series, here "1", and that per frequency.

    Raises
    ------
    RangeError
        Fewer than 8 samples, numbers that are not finite, a rate that is not positive, an unknown window.

    Notes
    -----
    A single windowed periodogram (FFT) of the whole record: no averages over segments as in Welch's method, for a steady
    motion is recorded as long as is wanted and lines stay narrow. The price is that the density of a broadband signal
    scatters by 100 %.

    References
    ----------
    [welch1967] scaling of power and density, and the averages that are not taken.
    """
    x = np.asarray(values, dtype=np.float64)
    weights = _checked(x, rate, window)
    if x.ndim > 3:
        raise RangeError(f"values has shape {x.shape}: time and at most state and lane are needed.")
    frequency, density = _periodogram(x - _means(x) if detrend else x, weights, rate)
    bandwidth = (
        rate * np.sum(weights**2) / np.sum(weights) ** 2
    )  # power = density * equivalent noise bandwidth
    dims = ("frequency", *{1: (), 2: ("lane",), 3: ("state", "lane")}[x.ndim])
    per_unit = "1" if unit == "1" else f"1/{unit}"
    return Findings(
        {
            "power": (dims, density * bandwidth, {"units": "1", "long_name": "power of a line, a^2/2"}),
            "density": (dims, density, {"units": unit, "long_name": "power spectral density"}),
            "frequency_step": ((), rate / x.shape[0], {"units": per_unit, "long_name": "frequency step"}),
        },
        {"frequency": ("frequency", frequency, {"units": per_unit, "long_name": "frequency"})},
        {"window": window, "rate": rate, "samples": x.shape[0], "detrend": int(detrend)},
    )


@gives_dataset
def full_spectrum(
    x: ArrayLike, y: ArrayLike, *, rate: float, window: Window = "hann", detrend: bool = True, unit: str = "1"
) -> Findings:
    """Two-sided amplitude spectrum of the orbit x + iy: forward and backward whirl apart.

    Parameters
    ----------
    x, y : array, shape (time,) or (time, lane)
        Displacements in two perpendicular directions, in the same unit.
    rate, window, detrend, unit
        As in ``power_spectrum``.

    Returns
    -------
    xr.Dataset
        ``amplitude(frequency, ...)`` over ascending signed frequencies: a circular orbit of radius a on a bin
        shows a there; ``phase`` [rad] is that of the rotating vector at the first sample. The same amplitudes
        over ``whirl_frequency`` > 0: ``forward`` turns from x to y (anticlockwise), ``backward`` from y to x.
        A shaft that spins clockwise has its own forward direction in ``backward``.

    Raises
    ------
    RangeError
        As ``power_spectrum``; and if the shapes of x and y differ.

    Notes
    -----
    An ellipse with half-axes A and B is the sum of a forward circle of radius (A + B)/2 and a backward one of
    radius ``|A - B|/2``; a straight line has equal parts of both.
    """
    u, v = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
    if u.shape != v.shape or u.ndim > 2:
        raise RangeError(f"x has shape {u.shape} and y {v.shape}: twice (time,) or (time, lane) is needed.")
    z = u + 1j * v
    weights = _checked(z, rate, window)
    if detrend:
        z = z - z.mean(axis=0)
    n = z.shape[0]
    shaped = weights.reshape((n,) + (1,) * (z.ndim - 1))
    whole = np.fft.fft(z * shaped, axis=0) / weights.sum()
    frequency = np.fft.fftshift(np.fft.fftfreq(n, 1.0 / rate))
    shifted = np.fft.fftshift(whole, axes=0)
    turning = (n - 1) // 2  # number of positive frequencies that have a negative twin (not Nyquist's)
    forward, backward = whole[1 : turning + 1], whole[: n - turning - 1 : -1]
    rest = () if z.ndim == 1 else ("lane",)
    per_unit = "1" if unit == "1" else f"1/{unit}"
    return Findings(
        {
            "amplitude": (
                ("frequency", *rest),
                np.abs(shifted),
                {"units": "1", "long_name": "radius of the circular orbit"},
            ),
            "phase": (
                ("frequency", *rest),
                np.angle(shifted),
                {"units": "rad", "long_name": "phase at the start"},
            ),
            "forward": (
                ("whirl_frequency", *rest),
                np.abs(forward),
                {"units": "1", "long_name": "radius of forward whirl, from x to y"},
            ),
            "backward": (
                ("whirl_frequency", *rest),
                np.abs(backward),
                {"units": "1", "long_name": "radius of backward whirl, from y to x"},
            ),
        },
        {
            "frequency": ("frequency", frequency, {"units": per_unit, "long_name": "signed whirl frequency"}),
            "whirl_frequency": (
                "whirl_frequency",
                np.arange(1, turning + 1) * rate / n,
                {"units": per_unit, "long_name": "whirl frequency"},
            ),
        },
        {"window": window, "rate": rate, "samples": n, "detrend": int(detrend)},
    )


def window_weights(name: str, length: int) -> NDArray[np.float64]:
    """Weights of a window whose next value would be its first again (Fourier analysis wants periodic windows)."""
    angle = np.linspace(-np.pi, np.pi, length + 1)[:-1]
    return np.sum([a * np.cos(k * angle) for k, a in enumerate(_COSINES[name])], axis=0, dtype=np.float64)


def _means(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Mean of each series, summed along contiguous memory: the same bits alone and in a batch."""
    return np.asarray(np.ascontiguousarray(np.moveaxis(x, 0, -1)).mean(axis=-1))


def _periodogram(
    x: NDArray[np.float64], weights: NDArray[np.float64], rate: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Frequencies, and the one-sided density of each series: every bin but zero and Nyquist counts twice."""
    n = x.shape[0]
    transform = np.fft.rfft(x * weights.reshape(-1, *(1,) * (x.ndim - 1)), axis=0)
    density = np.abs(transform) ** 2 / (rate * np.sum(weights**2))
    density[1 : (n + 1) // 2] *= 2.0
    return np.asarray(np.fft.rfftfreq(n, 1 / rate), dtype=np.float64), density


def _checked(x: NDArray[Any], rate: float, window: str) -> NDArray[np.float64]:
    """Give the window's weights, or a RangeError about the series."""
    if x.ndim == 0 or x.shape[0] < 8:
        raise RangeError(
            f"the series has shape {x.shape}: at least 8 samples along the first axis are needed."
        )
    if not np.isfinite(x).all():
        raise RangeError("the series holds numbers that are not finite: leave out points that diverged.")
    if not 0 < rate < np.inf:
        raise RangeError(f"rate = {rate}: a positive number of samples per unit is needed.")
    if window not in LOBE:
        raise RangeError(f"window = {window!r}: one of {', '.join(LOBE)} is needed.")
    return window_weights(window, x.shape[0])
