"""The limit of a sequence that approaches it linearly, and the multipliers that the approach shows.

Near a periodic orbit the section points' differences d_j follow the linearised map, so that the few multipliers that are
still to be seen make a linear recurrence d_(j+q) = c_0 d_j + ... + c_(q-1) d_(j+q-1). Its coefficients, the same for all
states, are fitted by least squares; the roots of p(z) = z^q - c_(q-1) z^(q-1) - ... - c_0 are the multipliers, and the limit
is p(S) x / p(1), S the shift (minimal polynomial extrapolation, Smith, Ford and Sidi 1987, SIAM Review 29, 199; here with
more equations than unknowns, so that the last differences also test the fit).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Most multipliers that are fitted.
MODES = 4
#: Differences that are fitted and tested.
DIFFERENCES = 12
#: The last three differences follow the recurrence to this fraction of themselves.
FOLLOWS = 0.05
#: Largest modulus of a multiplier: closer to one its distance from one is no longer sure.
STABLE = 0.999


@dataclass(frozen=True)
class Limit:
    """Where sequences lead; arrays end in the lane axis.

    Attributes
    ----------
    x : array, shape (state, lane)
    error : array
        Scaled error of it, by the residuals of the last three differences; infinite where nothing could be said.
    leading : array
        Largest modulus of a multiplier.
    """

    x: Array
    error: Array
    leading: Array


def limit(points: Array, scale: Array, period: Array, tolerance: float) -> Limit:
    """Extrapolate sequences of points, with as few multipliers as meet the tolerance.

    Parameters
    ----------
    points : array, shape (DIFFERENCES + 1, state, lane)
        Oldest first.
    scale : array, shape (state, lane)
        By which differences are divided.
    period : array, shape (state,)
        Of cyclic states; infinite for the others.
    tolerance : float
        Largest scaled error.

    Returns
    -------
    Limit
        Only where the last three differences follow the recurrence, all multipliers lie inside the unit circle, and the
        error is below the tolerance; elsewhere the error is infinite. What is returned for a lane depends on nothing else.
    """
    lanes = points.shape[2]
    x, error, leading = points[-1].copy(), np.full(lanes, np.inf), np.full(lanes, np.nan)
    d = wrapped(np.diff(points, axis=0), period) / scale
    size = np.abs(d).max(axis=1)
    left = np.flatnonzero((size > 0).all(axis=0))
    for modes in range(1, min(MODES, points.shape[1]) + 1):
        if not left.size:
            break
        c, sound = _recurrence(d[:, :, left], size[:, left], modes)
        left, c = left[sound], c[sound]
        if not left.size:
            break
        missed = d[-3:, :, left].copy()
        for i in range(modes):
            missed -= c[:, i] * d[DIFFERENCES - 3 - modes + i : DIFFERENCES - modes + i, :, left]
        missed_size = np.abs(missed).max(axis=1)
        companion = np.zeros((left.size, modes, modes))
        companion[:, np.arange(1, modes), np.arange(modes - 1)] = 1.0
        companion[:, :, -1] = c
        modulus = np.abs(np.linalg.eigvals(companion)).max(axis=1)
        at_one = np.ones(left.size)
        for i in range(modes):
            at_one = at_one - c[:, i]
        with np.errstate(divide="ignore"):
            off = missed_size.max(axis=0) / np.abs(at_one)
        good = (missed_size <= FOLLOWS * size[-3:, left]).all(axis=0) & (modulus < STABLE) & (off <= tolerance)
        these = left[good]
        step = np.zeros((points.shape[1], these.size))
        for i in range(modes):
            step += c[good, i] / at_one[good] * d[DIFFERENCES - modes + i :, :, these].sum(axis=0)
        x[:, these] += step * scale[:, these]
        error[these], leading[these] = off[good], modulus[good]
        left = left[~good]
    return Limit(x, error, leading)


def wrapped(differences: Array, period: Array) -> Array:
    """Differences (..., state, lane), of cyclic states the shorter way round."""
    out = differences.copy()
    for k in np.flatnonzero(np.isfinite(period)):
        out[..., k, :] -= period[k] * np.rint(out[..., k, :] / period[k])
    return out


def _recurrence(d: Array, size: Array, modes: int) -> tuple[Array, NDArray[np.bool_]]:
    """Coefficients (lane, mode) by least squares, every equation over the size of its differences; which are determined."""
    equations = DIFFERENCES - modes
    windows = np.stack([d[i : i + equations] for i in range(modes + 1)])  # (column, equation, state, lane)
    largest = np.stack([size[i : i + equations] for i in range(modes + 1)]).max(axis=0)
    rows = np.ascontiguousarray((windows / largest[:, None]).transpose(3, 1, 2, 0).reshape(d.shape[2], -1, modes + 1))
    r: Array = np.asarray(np.linalg.qr(rows, mode="r"))  # its last column holds Q'b
    diagonal = np.abs(np.diagonal(r, axis1=1, axis2=2))[:, :modes]
    sound = diagonal.min(axis=1) > 1e-9 * diagonal.max(axis=1)
    c: Array = np.zeros((d.shape[2], modes))
    if sound.any():
        c[sound] = np.linalg.solve(r[sound, :modes, :modes], r[sound, :modes, modes:])[:, :, 0]
    return c, sound
