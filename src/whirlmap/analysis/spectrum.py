"""Power spectra, full spectra of orbits (forward and backward whirl), and the lines in a spectrum.

The spectra are single windowed periodograms over the whole record, not averages of segments (Welch): a steady
motion is recorded as long as is wanted, and resolution is what tells lines from a broadband spectrum.
"""

from typing import Any, Literal

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from whirlmap.errors import RangeError

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

_LOBE = {"boxcar": 1, "hann": 2, "hamming": 2, "blackman": 3, "blackmanharris": 4, "flattop": 5}
"""Half-width of each window's main lobe [frequency bins]."""

LINE_STATUS = ("ok", "no-power")
"""Meaning of ``status`` of ``spectral_lines`` by value."""


def power_spectrum(
    values: ArrayLike, *, rate: float, window: Window = "hann", detrend: bool = True, unit: str = "1"
) -> xr.Dataset:
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
    result = xr.Dataset(
        {
            "power": (dims, density * bandwidth, {"units": "1", "long_name": "power of a line, a^2/2"}),
            "density": (dims, density, {"units": unit, "long_name": "power spectral density"}),
            "frequency_step": ((), rate / x.shape[0], {"units": per_unit, "long_name": "frequency step"}),
        },
        {"frequency": ("frequency", frequency, {"units": per_unit, "long_name": "frequency"})},
    )
    result.attrs = {"window": window, "rate": rate, "samples": x.shape[0], "detrend": int(detrend)}
    return result


def full_spectrum(
    x: ArrayLike, y: ArrayLike, *, rate: float, window: Window = "hann", detrend: bool = True, unit: str = "1"
) -> xr.Dataset:
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
    radius |A - B|/2; a straight line has equal parts of both.
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
    result = xr.Dataset(
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
    )
    result.attrs = {"window": window, "rate": rate, "samples": n, "detrend": int(detrend)}
    return result


def spectral_lines(
    spectrum: xr.Dataset,
    *,
    false_alarm: float = 1e-3,
    floor_width: int | None = None,
    least: float = 1e-8,
) -> xr.Dataset:
    """Lines that stand above the broadband floor of a power spectrum, and the share of power in them.

    Parameters
    ----------
    spectrum : xr.Dataset
        From ``power_spectrum``, with a window other than the boxcar: its leakage looks like a floor.
    false_alarm : float
        Probability that noise alone shows one line or more in the whole spectrum.
    floor_width : int, optional
        Width of the running median [bins]. Default: 1/32 of the spectrum, at least 15 main lobes. The floor
        follows broadband humps wider than this; lines must fill less than half of it.
    least : float
        Lines with a smaller share of the total power in their highest bin are not counted: below, rounding
        and truncation errors of an integration make lines of their own.

    Returns
    -------
    xr.Dataset
        ``count(...)``; ``line_frequency``, ``line_power`` and ``line_floor`` over ``line``, the strongest
        first, NaN where ``line_present`` is 0; ``floor(frequency, ...)``, the density of the broadband part;
        ``line_fraction`` and ``broadband_fraction`` of the total power (they sum to 1; both 0 where
        ``status`` is no-power).

    Raises
    ------
    RangeError
        The spectrum is not from ``power_spectrum``, was taken with a boxcar, is too short, or an option is
        out of range.

    Notes
    -----
    1. The broadband level is the running median of the density over ``floor_width`` bins, divided by ln 2:
       the bins of noise are exponentially distributed, with median ln 2 times their mean. A median
       ignores lines.
    2. The floor is the largest of that and of the same medians over the 8 lobe-widths on either side, outside
       the main lobe: a narrow resonance of a broadband motion has flanks, a line has not.
    3. A line is a local maximum of the density above ln(bins / false_alarm) times the floor, at least four
       lobe-widths from zero frequency (of slower motions the record does not hold enough), with a share of
       the power above ``least`` in its highest bin, and more than four times what any stronger line may leak
       there.
    4. Its power is the density above the floor, summed over its main lobe; bins between two lines closer than
       two lobes go to the nearer. Its frequency is the vertex of the parabola through the logarithms of three
       bins, good to 0.02 bins with Hann and 0.3 with the flat top.
    5. What the lines do not hold is broadband, including the far leakage of lines (below 0.1 % for Hann).

    A resonance narrower than the record can resolve looks like a line: lengthen the record until ``count``
    and ``line_fraction`` stay.
    """
    if "density" not in spectrum or spectrum.attrs.get("window") not in _LOBE:
        raise RangeError(
            "spectrum must come from power_spectrum: it needs `density` and the attribute `window`."
        )
    if spectrum.attrs["window"] == "boxcar":
        raise RangeError(
            "the boxcar leaks too far to tell lines from a floor: use power_spectrum(window='hann')."
        )
    if not 0 < false_alarm < 1 or not 0 <= least < 1:
        raise RangeError(
            f"false_alarm = {false_alarm} and least = {least}: shares between 0 and 1 are needed."
        )
    lobe = _LOBE[spectrum.attrs["window"]]
    density = spectrum["density"].transpose("frequency", ...)
    bins = density.sizes["frequency"]
    width = max(bins // 32, 30 * lobe + 1) if floor_width is None else floor_width
    if not 4 * lobe < width <= bins // 2:
        raise RangeError(
            f"floor_width = {width} bins: from {4 * lobe + 1} to half the {bins} bins is needed."
        )
    flat = density.values.reshape(bins, -1)
    step = float(spectrum["frequency_step"])
    floor = np.stack([_floor(column, width, lobe) for column in flat.T], axis=1)
    options: dict[str, Any] = {"step": step, "lobe": lobe, "leakage": _leakage(spectrum.attrs["window"])}
    options |= {"threshold": np.log(bins / false_alarm), "least": least}
    found = [_lines_of(flat[:, k], floor[:, k], **options) for k in range(flat.shape[1])]
    most = max((len(f) for f, *_ in found), default=0)
    table = np.full((3, most, flat.shape[1]), np.nan)
    for k, columns in enumerate(found):
        for row, column in enumerate(columns):
            table[row, : len(column), k] = column
    total = flat.sum(axis=0) * step
    count = np.array([len(f) for f, *_ in found])
    in_lines = np.nansum(table[1], axis=0)
    share = np.divide(in_lines, total, out=np.zeros_like(total), where=total > 0)
    rest, shape = density.dims[1:], density.shape[1:]

    def variable(values: NDArray[Any], long_name: str, units: str = "1", *first: str) -> tuple[Any, ...]:
        lead = values.shape[: len(first)]
        return (*first, *rest), values.reshape(lead + shape), {"units": units, "long_name": long_name}

    per_unit, per_frequency = spectrum["frequency"].attrs["units"], density.attrs["units"]
    result = xr.Dataset(
        {
            "count": variable(count, "number of lines"),
            "line_frequency": variable(table[0], "frequency of the line", per_unit, "line"),
            "line_power": variable(table[1], "power of the line", "1", "line"),
            "line_floor": variable(table[2], "density of the floor under the line", per_frequency, "line"),
            "line_present": variable(
                np.isfinite(table[0]).astype(np.int8), "whether the line exists", "1", "line"
            ),
            "floor": variable(floor, "density of the broadband floor", per_frequency, "frequency"),
            "line_fraction": variable(share, "share of the power in lines"),
            "broadband_fraction": variable(
                np.where(total > 0, 1.0 - share, 0.0), "share of the power not in lines"
            ),
            "status": variable((total == 0).astype(np.int8), "status of the line search"),
        },
        {"frequency": spectrum["frequency"]},
    )
    for name, meanings in (("status", " ".join(LINE_STATUS)), ("line_present", "absent present")):
        result[name].attrs |= {"flag_values": np.array([0, 1], np.int8), "flag_meanings": meanings}
    result.attrs = {"false_alarm": false_alarm, "floor_width": width, "least": least}
    return result


def _window(name: str, length: int) -> NDArray[np.float64]:
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


def _peaks(density: NDArray[np.float64]) -> NDArray[np.intp]:
    """Bins higher than what stands on either side; of equally high neighbours the middle one."""
    ends = np.append(np.flatnonzero(np.diff(density)), density.size - 1)  # of runs of equal values
    starts = np.append(0, ends[:-1] + 1)
    level = density[starts]
    top = (level[1:-1] > level[:-2]) & (level[1:-1] > level[2:])
    return np.asarray((starts[1:-1] + ends[1:-1]) // 2)[top]


def _floor(density: NDArray[np.float64], width: int, lobe: int) -> NDArray[np.float64]:
    """Mean level of the broadband part around each bin (steps 1 and 2 of ``spectral_lines``)."""
    half = 4 * lobe
    near = _running_median(density, 2 * half + 1)
    aside = np.pad(near, half + lobe + 1, mode="edge")
    sides = np.maximum(aside[: density.size], aside[-density.size :])
    wide = _running_median(density, width)
    return np.asarray(np.maximum(wide, sides) / np.log(2.0))


def _running_median(x: NDArray[np.float64], width: int) -> NDArray[np.float64]:
    """Median of the ``width`` values around each one (the upper of two), the ends mirrored."""
    mirrored = np.pad(x, (width // 2, width - 1 - width // 2), mode="symmetric")
    windows = np.lib.stride_tricks.sliding_window_view(mirrored, width)
    return np.asarray(np.partition(windows, width // 2, axis=-1)[:, width // 2])


def _leakage(window: str) -> NDArray[np.float64]:
    """Largest power that a line can show so many bins away, or further, as a share of its highest bin."""
    fine, bins, length = 16, 256, 1024  # sums of cosines: their transforms do not depend on the length
    response = np.abs(np.fft.rfft(_window(window, length), fine * length)[: fine * bins]) ** 2
    envelope = np.maximum.accumulate(response[::-1])[::-1]
    # A line half a bin off shows its highest bin at response[fine / 2], and half a bin more on the far side.
    nearest = np.maximum(np.arange(bins) * fine - fine // 2, 0)
    return np.asarray(envelope[nearest] / response[fine // 2])


def _lines_of(
    density: NDArray[np.float64],
    floor: NDArray[np.float64],
    *,
    step: float,
    lobe: int,
    leakage: NDArray[np.float64],
    threshold: float,
    least: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Frequencies, powers and floors of the lines of one spectrum, the strongest first."""
    peaks = _peaks(density)
    peaks = peaks[density[peaks] >= threshold * floor[peaks]]
    peaks = peaks[(peaks >= 4 * lobe) & (density[peaks] * step >= least * density.sum() * step)]
    # A side lobe of a stronger line is not a line. Two amplitudes may add: four times the power.
    reach = np.abs(peaks[:, None] - peaks)
    leaked = (
        np.where(reach < leakage.size, leakage[np.minimum(reach, leakage.size - 1)], 0.0) * density[peaks]
    )
    np.fill_diagonal(leaked, 0.0)
    peaks = peaks[density[peaks] > 4.0 * leaked.max(axis=1, initial=0.0)]
    if peaks.size == 0:
        return (np.zeros(0),) * 3
    index = np.arange(density.size)
    right = np.clip(
        np.searchsorted(peaks, index), 0, peaks.size - 1
    )  # nearest peak on either side of each bin
    left = np.maximum(right - 1, 0)
    owner = np.where(np.abs(index - peaks[left]) <= np.abs(peaks[right] - index), left, right)
    inside = np.abs(index - peaks[owner]) <= lobe
    excess = np.where(inside, density - floor, 0.0)
    power = np.bincount(owner, weights=excess, minlength=peaks.size) * step
    # A peak is never the first or last bin, so both neighbours exist; zeros would break the
    # logarithm.
    around = np.log(np.maximum(density[peaks[:, None] + np.array([-1, 0, 1])], np.finfo(float).tiny))
    curvature = around[:, 0] - 2 * around[:, 1] + around[:, 2]
    shift = np.divide(
        (around[:, 0] - around[:, 2]) / 2, curvature, out=np.zeros(peaks.size), where=curvature < 0
    )
    frequency = np.asarray((peaks + shift) * step)
    order = np.argsort(-power, kind="stable")
    return frequency[order], np.asarray(power[order]), floor[peaks[order]]


def _checked(x: NDArray[Any], rate: float, window: str) -> NDArray[np.float64]:
    """Give the window's weights, or a RangeError about the series."""
    if x.ndim == 0 or x.shape[0] < 8:
        raise RangeError(
            f"the series has shape {x.shape}: at least 8 samples along the first axis are needed."
        )
    if not np.isfinite(x).all():
        raise RangeError("the series holds numbers that are not finite: leave out lanes that diverged.")
    if not 0 < rate < np.inf:
        raise RangeError(f"rate = {rate}: a positive number of samples per unit is needed.")
    if window not in _LOBE:
        raise RangeError(f"window = {window!r}: one of {', '.join(_LOBE)} is needed.")
    return _window(window, x.shape[0])
