"""The scaling range of a correlation sum: where its local slopes agree, and the dimension that is read from there."""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray


class Curves:
    """Correlation sums on common radii: ``whole``, and ``without`` each block in turn; with their slopes."""

    half = 8  # radii: one octave to either side

    def __init__(
        self,
        radius: NDArray[np.float64],
        whole: NDArray[np.float64],
        without: NDArray[np.float64],
        usable: NDArray[np.bool_],
    ) -> None:
        # A jackknife replicate may be empty where the whole is not: such radii carry no error and are not
        # used.
        self.radius, self.whole, self.without = radius, whole, without
        self.usable = usable & (without > 0).all(axis=0)
        self.ln_r = np.log(radius)
        self.ln_whole = np.log(np.where(self.usable, whole, 1.0))
        self.ln_without = np.log(np.where(self.usable, without, 1.0))
        self.slope, self.error = (np.full(radius.size, np.nan) for _ in range(2))
        for k in range(self.half, radius.size - self.half):
            window = slice(k - self.half, k + self.half + 1)
            if self.usable[window].all():
                self.slope[k], self.error[k] = self.slope_and_error(window)

    def slope_and_error(self, window: slice) -> tuple[float, float]:
        """Least-squares slope of ln C on ln r in a window, and its jackknife standard error."""
        r = self.ln_r[window] - self.ln_r[window].mean()
        replicates = self.ln_without[:, window] @ r / (r @ r)
        spread = np.mean((replicates - replicates.mean()) ** 2)
        return float(self.ln_whole[window] @ r / (r @ r)), float(np.sqrt((replicates.size - 1) * spread))

    def fit(self, begin: int, end: int) -> dict[str, float]:
        """D2 with its errors over the radii ``begin`` to ``end`` (inclusive)."""
        D2, resampling = self.slope_and_error(slice(begin, end + 1))
        cuts = np.linspace(begin, end, 4).astype(int)
        thirds = [self.slope_and_error(slice(a, b + 1))[0] for a, b in pairwise(cuts)]
        half_range = (max(thirds) - min(thirds)) / 2
        return {
            "D2": D2,
            "D2_error": float(np.hypot(resampling, half_range)),
            "D2_error_resampling": resampling,
            "D2_error_range": half_range,
            "radius_low": float(self.radius[begin]),
            "radius_high": float(self.radius[end]),
            "decades": float((self.ln_r[end] - self.ln_r[begin]) / np.log(10)),
        }


def is_finite_set(curves: Curves, n_points: int) -> bool:
    """Whether C is flat over two decades, or over the last one, at a level of heaps of ten points or more."""
    # The radii end where the size of the set is reached: above it C is flat for any set.
    C = curves.whole[curves.radius <= 1.0]
    for decades, last in ((1, 1), (2, C.size)):
        step = round(decades * np.log2(10.0) * curves.half)
        below, above = C[:-step][:last], C[step:][:last]
        flat = above <= below * 10.0 ** (0.02 * decades)
        if np.any(flat & (below * n_points >= 10.0)):
            return True
    return False


def scaling_range(
    curves: Curves, tolerance: float, least_decades: float, largest_sum: float
) -> tuple[int, int] | None:
    """First and last radius of the widest range whose local slopes agree, or None."""
    usable = curves.usable & (curves.whole <= largest_sum)
    h, x, y = curves.half, curves.ln_r, curves.ln_whole
    best, width = None, least_decades * np.log(10.0) * (1 - 1e-12)
    for i in np.flatnonzero(usable):
        stop = i + int(np.argmin(np.r_[usable[i:], False]))  # first radius after i that may not be used
        if stop - i <= 2 * h or x[stop - 1] - x[i] < width:
            continue
        j = np.arange(
            i + 2 * h, stop
        )  # candidates for the last radius; the windows inside have centres i+h..j-h
        r, ln_C = x[i:stop] - x[i], y[i:stop] - y[i]
        m = np.arange(1, stop - i + 1)
        Sx, Sy, Sxx, Sxy = (np.cumsum(v) for v in (r, ln_C, r * r, r * ln_C))
        D = ((m * Sxy - Sx * Sy)[2 * h :]) / ((m * Sxx - Sx * Sx)[2 * h :])
        slope, error = curves.slope[i + h : stop - h], curves.error[i + h : stop - h]
        highest = np.maximum.accumulate(slope - 2 * error)
        lowest = np.minimum.accumulate(slope + 2 * error)
        # A slope with a large error agrees with anything, so that errors above the tolerance end the range.
        clear = np.maximum.accumulate(error) <= tolerance * D
        agree = (D > 0) & clear & (highest - D <= tolerance * D) & (D - lowest <= tolerance * D)
        agree &= x[j] - x[i] >= width
        if agree.any():
            last = int(j[np.flatnonzero(agree)[-1]])
            if best is None or x[last] - x[i] > width * (1 + 1e-9):
                best, width = (int(i), last), x[last] - x[i]
    return best
