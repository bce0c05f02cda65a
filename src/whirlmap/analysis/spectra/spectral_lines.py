"""Detection of spectral lines above the broadband floor of a spectrum."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.spectra.spectrum import LOBE, window_weights
from whirlmap.errors import RangeError
from whirlmap.results.findings import Findings, gives_dataset

if TYPE_CHECKING:
    import xarray as xr

LINE_STATUS = ("ok", "no-power")
"""Meaning of ``status`` of ``spectral_lines`` by value."""

#: Numbers in all windows of a running median, above which they are not written out.
LONG = 1 << 24


@gives_dataset
def spectral_lines(
    spectrum: "Findings | xr.Dataset",
    *,
    false_alarm: float = 1e-3,
    floor_width: int | None = None,
    least: float = 1e-8,
) -> Findings:
    """Lines that stand above the broadband floor of a power spectrum, and the share of power in them.

    Parameters
    ----------
    spectrum : xr.Dataset or Findings
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
       there. The Nyquist frequency may be one: a period of two samples.
    4. Its power is the density above the floor, summed over its main lobe; bins between two lines closer than
       two lobes go to the nearer. Its frequency is the vertex of the parabola through the logarithms of three
       bins, good to 0.02 bins with Hann and 0.3 with the flat top.
    5. What the lines do not hold is broadband, including the far leakage of lines (below 0.1 % for Hann).

    A resonance narrower than the record can resolve looks like a line: lengthen the record until ``count``
    and ``line_fraction`` stay.
    """
    if not isinstance(spectrum, Findings):
        spectrum = Findings.of(spectrum)
    if "density" not in spectrum or spectrum.attrs.get("window") not in LOBE:
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
    lobe = LOBE[spectrum.attrs["window"]]
    dims, values, attributes = spectrum.variable("density")
    density = np.moveaxis(values, dims.index("frequency"), 0)
    bins = density.shape[0]
    width = max(bins // 32, 30 * lobe + 1) if floor_width is None else floor_width
    if not 4 * lobe < width <= bins // 2:
        raise RangeError(
            f"floor_width = {width} bins: from {4 * lobe + 1} to half the {bins} bins is needed."
        )
    flat = density.reshape(bins, -1)
    step = float(spectrum["frequency_step"])
    floor = np.stack([_floor(column, width, lobe) for column in flat.T], axis=1)
    options: dict[str, Any] = {"step": step, "lobe": lobe, "leakage": _leakage(spectrum.attrs["window"])}
    options |= {"threshold": np.log(bins / false_alarm), "least": least, "odd": int(spectrum.attrs.get("samples",
        0)) % 2 == 1}
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
    rest, shape = tuple(d for d in dims if d != "frequency"), density.shape[1:]

    def variable(values: NDArray[Any], long_name: str, units: str = "1", *first: str) -> tuple[Any, ...]:
        lead = values.shape[: len(first)]
        return (*first, *rest), values.reshape(lead + shape), {"units": units, "long_name": long_name}

    frequency = spectrum.variable("frequency")
    per_unit, per_frequency = frequency[2]["units"], attributes["units"]
    variables = {
        "count": variable(count, "number of lines"),
        "line_frequency": variable(table[0], "frequency of the line", per_unit, "line"),
        "line_power": variable(table[1], "power of the line", "1", "line"),
        "line_floor": variable(table[2], "density of the floor under the line", per_frequency, "line"),
        "line_present": variable(np.isfinite(table[0]).astype(np.int8), "whether the line exists", "1", "line"),
        "floor": variable(floor, "density of the broadband floor", per_frequency, "frequency"),
        "line_fraction": variable(share, "share of the power in lines"),
        "broadband_fraction": variable(np.where(total > 0, 1.0 - share, 0.0), "share of the power not in lines"),
        "status": variable((total == 0).astype(np.int8), "status of the line search"),
    }
    for name, meanings in (("status", " ".join(LINE_STATUS)), ("line_present", "absent present")):
        variables[name][2].update(flag_values=np.array([0, 1], np.int8), flag_meanings=meanings)
    return Findings(
        variables, {"frequency": frequency}, {"false_alarm": false_alarm, "floor_width": width, "least": least}
    )


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
    if x.size * width > LONG:  # a heap in place of all windows at once: the same medians in little memory
        from scipy.ndimage import rank_filter

        return np.asarray(rank_filter(x, width // 2, size=width, mode="reflect"))
    mirrored = np.pad(x, (width // 2, width - 1 - width // 2), mode="symmetric")
    windows = np.lib.stride_tricks.sliding_window_view(mirrored, width)
    return np.asarray(np.partition(windows, width // 2, axis=-1)[:, width // 2])


def _leakage(window: str) -> NDArray[np.float64]:
    """Largest power that a line can show so many bins away, or further, as a share of its highest bin."""
    fine, bins, length = 16, 256, 1024  # sums of cosines: their transforms do not depend on the length
    response = np.abs(np.fft.rfft(window_weights(window, length), fine * length)[: fine * bins]) ** 2
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
    odd: bool,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Frequencies, powers and floors of the lines of one spectrum, the strongest first."""
    peaks = _peaks(density)
    if density[-1] > density[-2]:  # beyond the Nyquist frequency stands the mirror image: its bin may be a peak
        peaks = np.append(peaks, density.size - 1)
    peaks = peaks[density[peaks] >= threshold * floor[peaks]]
    peaks = peaks[(peaks >= 4 * lobe) & (density[peaks] * step >= least * density.sum() * step)]
    # A side lobe of a stronger line is not a line. Two amplitudes may add: four times the power.
    leaked = np.zeros(peaks.size)
    for apart in range(1, leakage.size):  # in the list of peaks, which are a bin apart at least
        reach = peaks[apart:] - peaks[:-apart]
        if not (reach < leakage.size).any():
            break
        share = np.where(reach < leakage.size, leakage[np.minimum(reach, leakage.size - 1)], 0.0)
        leaked[apart:] = np.maximum(leaked[apart:], share * density[peaks[:-apart]])
        leaked[:-apart] = np.maximum(leaked[:-apart], share * density[peaks[apart:]])
    peaks = peaks[density[peaks] > 4.0 * leaked]
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
    # Beyond the last bin stands its mirror image, which for an odd number of samples is the last bin itself; zeros would
    # break the logarithm.
    beyond = density[-1 if odd else -2]
    around = np.log(np.maximum(np.append(density, beyond)[peaks[:, None] + np.array([-1, 0, 1])], np.finfo(float).tiny))
    curvature = around[:, 0] - 2 * around[:, 1] + around[:, 2]
    shift = np.divide(
        (around[:, 0] - around[:, 2]) / 2, curvature, out=np.zeros(peaks.size), where=curvature < 0
    )
    if odd:  # two equal bins on either side of the Nyquist frequency
        shift = np.where(peaks == density.size - 1, 0.5, shift)
    frequency = np.asarray((peaks + shift) * step)
    order = np.argsort(-power, kind="stable")
    return frequency[order], np.asarray(power[order]), floor[peaks[order]]
