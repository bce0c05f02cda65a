"""Frequencies of spectral lines with their errors: least squares on the windowed transform around each line."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.spectra.spectrum import window_weights

Array = NDArray[np.float64]

#: Bins on either side of a line that are fitted, and steps of the iteration.
REACH, ITERATIONS = 2, 12
#: Smallest error that is believed, in bins: what is left out of the model (weak lines, a slow change) is no noise.
LEAST_ERROR = 3e-5
#: Factor between the error of independent bins and that under a Hann window, measured on lines in white noise.
CORRELATED = 1.2


@dataclass(frozen=True)
class FittedLines:
    """Lines, in the order given.

    Attributes
    ----------
    frequency, error : array, shape (line,)
        Cycles per record, and one standard error.
    """

    frequency: Array
    error: Array


def fit_lines(x: Array, frequencies: Array, floor: Array) -> FittedLines:
    """Refine frequencies of lines.

    Parameters
    ----------
    x : array, shape (time,)
    frequencies : array, shape (line,)
        In cycles per record, good to half of one.
    floor : array, shape (line,)
        Density of the broadband floor under each, at one sample per unit of time.

    Notes
    -----
    The transform under a Hann window is a sum of kernels, one for each line and one for its mirror image, so that
    neighbouring lines do not pull each other. Amplitudes, phases and frequencies are found together by Gauss-Newton
    steps over five bins around each line. The error comes from what is left in these bins, or from the floor where that is
    higher, for few bins may fit too well, times 1.2: neighbouring bins under a window are not independent. Lines within two
    bins of the Nyquist frequency are left where they are, for there a line and its mirror image are one.
    """
    n = x.size
    transform = np.fft.rfft((x - x.mean()) * window_weights("hann", n)) / n
    f = np.asarray(frequencies, dtype=float).copy()
    error = np.full(f.size, 0.25)
    free = np.flatnonzero(np.abs(f - n / 2) > REACH)
    error[np.abs(f - n / 2) < 0.05] = LEAST_ERROR
    if not free.size:
        return FittedLines(f, error)
    centre = np.round(f[free]).astype(np.intp)
    bins = np.clip(centre[:, None] + np.arange(-REACH, REACH + 1), 1, transform.size - 1).ravel()
    data = transform[bins]
    given = f[free].copy()
    for _ in range(ITERATIONS):
        forward, backward = _kernel(bins[:, None] - f[free], n), _kernel(bins[:, None] + f[free], n)
        step = 1e-4
        turned = [
            (_kernel(bins[:, None] - s * (f[free] + step), n) - _kernel(bins[:, None] - s * (f[free] - step), n))
            / (2 * step)
            for s in (1, -1)
        ]
        amplitude = _solved(np.hstack([_stacked(forward + backward), _stacked(1j * (forward - backward))]), _parted(data))
        c = amplitude[: free.size] + 1j * amplitude[free.size :]
        slopes = c * turned[0] + c.conj() * turned[1]
        columns = np.hstack([_stacked(forward + backward), _stacked(1j * (forward - backward)), _stacked(slopes)])
        rest = _parted(data) - _stacked(forward * c + backward * c.conj()).sum(axis=1)
        moved = _solved(columns, rest)[2 * free.size :]
        f[free] = np.clip(f[free] + np.clip(moved, -0.3, 0.3), given - 0.7, given + 0.7)
        if np.abs(moved).max() < 1e-9:
            break
    squares = (rest[: bins.size] ** 2 + rest[bins.size :] ** 2).reshape(free.size, -1).sum(axis=1)
    weights = window_weights("hann", n)
    expected = floor[free] * float(weights @ weights) / (4 * n**2)  # of the real part of a bin of `transform`
    variance = CORRELATED**2 * np.maximum(squares / (2 * (2 * REACH + 1) - 3), expected)
    sizes = np.sqrt((columns**2).sum(axis=0))
    scaled = columns / np.where(sizes > 0, sizes, 1.0)
    covariance = np.linalg.pinv(scaled.T @ scaled)
    inverse = np.diag(covariance)[2 * free.size :] / np.where(sizes > 0, sizes, 1.0)[2 * free.size :] ** 2
    error[free] = np.hypot(np.sqrt(variance * inverse), LEAST_ERROR)
    return FittedLines(f, np.minimum(error, 0.5))


def line_amplitudes(x: Array, frequencies: Array) -> NDArray[np.complex128]:
    """Complex amplitudes of lines of known frequencies [cycles per record], together, by the same least squares."""
    n = x.size
    transform = np.fft.rfft((x - x.mean()) * window_weights("hann", n)) / n
    centre = np.round(frequencies).astype(np.intp)
    bins = np.unique(np.clip(centre[:, None] + np.arange(-REACH, REACH + 1), 1, transform.size - 1))
    forward, backward = _kernel(bins[:, None] - frequencies, n), _kernel(bins[:, None] + frequencies, n)
    found = _solved(np.hstack([_stacked(forward + backward), _stacked(1j * (forward - backward))]), _parted(transform[bins]))
    return np.asarray(2 * (found[: frequencies.size] + 1j * found[frequencies.size :]))


def _kernel(offset: Array, n: int) -> NDArray[np.complex128]:
    """Transform, over n, of a Hann window at an offset in bins."""

    def dirichlet(d: Array) -> NDArray[np.complex128]:
        angle = np.pi * d / n
        below = n * np.sin(angle)
        near = np.abs(below) < 1e-12
        size = np.where(near, 1.0, np.sin(np.pi * d) / np.where(near, 1.0, below))
        return np.asarray(size * np.exp(-1j * angle * (n - 1)))

    return np.asarray(0.5 * dirichlet(offset) - 0.25 * (dirichlet(offset - 1) + dirichlet(offset + 1)))


def _parted(z: NDArray[np.complex128]) -> Array:
    return np.concatenate([z.real, z.imag])


def _stacked(z: NDArray[np.complex128]) -> Array:
    return np.vstack([z.real, z.imag])


def _solved(columns: Array, data: Array) -> Array:
    """Least squares with columns of one length, so that lines of any strength count alike."""
    sizes = np.sqrt((columns**2).sum(axis=0))
    sizes = np.where(sizes > 0, sizes, 1.0)
    return np.asarray(np.linalg.lstsq(columns / sizes, data, rcond=1e-10)[0] / sizes)
