"""Critical speeds in a response curve: amplification factor and separation margin as API 617 defines them."""

from dataclasses import dataclass
from math import sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

Array = NDArray[np.float64]

#: Amplification factor below which a response is critically damped, so that no margin is asked for.
DAMPED = 2.5
#: Smallest amplitude over the largest that is told apart: an antiresonance may be zero.
LEAST = 1e-3
#: Points that a curve needs: a cubic has four.
LEAST_POINTS = 4


@dataclass(frozen=True)
class Critical:
    """A peak of a response curve.

    Attributes
    ----------
    speed, amplitude : float
        Of the peak.
    low, high : float or None
        Speeds below and above it at which the amplitude is 1/sqrt(2) of the peak; None where the curve has none before it
        ends or rises above this peak.
    """

    speed: float
    amplitude: float
    low: float | None
    high: float | None

    @property
    def factor(self) -> float | None:
        """Amplification factor N_c/(N_2 - N_1); with one of the two speeds, it counts for both sides."""
        if self.low is None and self.high is None:
            return None
        below = None if self.low is None else self.speed - self.low
        above = None if self.high is None else self.high - self.speed
        width = sum(side for side in (below, above) if side is not None)
        return self.speed / (width if below is not None and above is not None else 2 * width)

    @property
    def one_sided(self) -> bool:
        """Whether the amplification factor is that of one side."""
        return (self.low is None) != (self.high is None)

    def margin(self, slowest: float, fastest: float) -> float:
        """Separation margin: distance from the range of operation over its nearer end; 0 inside."""
        if self.speed < slowest:
            return (slowest - self.speed) / slowest
        return max((self.speed - fastest) / fastest, 0.0)

    def required(self, slowest: float) -> float | None:
        """Separation margin that API 617 asks for; 0 where the peak is critically damped, None without a factor."""
        if self.factor is None:
            return None
        if self.factor < DAMPED:
            return 0.0
        part = 0.17 * (1 - 1 / (self.factor - 1.5))
        return part if self.speed < slowest else 0.10 + part


def criticals(speed: Array, amplitude: Array) -> list[Critical]:
    """Find the peaks of a response curve, ascending.

    Parameters
    ----------
    speed, amplitude : array, shape (point,)
        Ascending speeds, at least four of them.

    Notes
    -----
    Near a resonance 1/amplitude^2 is smooth however sharp the peak is (of one mode it is a parabola). So peaks and
    half-power points are those of the cubic spline through 1/amplitude^2: a peak with an amplification factor of 100, as
    narrow as the distance of two points, is found to 1e-5, and its factor to 1.1e-4. Half power: 1/sqrt(2) of the amplitude.
    A peak that the points do not resolve, so that the spline falls to zero, stands at its highest point, without half-power
    speeds and so without a factor.

    References
    ----------
    [api617] amplification factor and required separation margin.
    """
    if speed.size < LEAST_POINTS or not np.isfinite(amplitude).all() or not amplitude.max() > 0:
        return []
    curve = CubicSpline(speed, np.maximum(amplitude / amplitude.max(), LEAST) ** -2.0)
    flat = np.asarray(curve.derivative().roots(extrapolate=False))
    flat = flat[np.isfinite(flat)]
    inner = 1 + np.flatnonzero((amplitude[1:-1] > amplitude[:-2]) & (amplitude[1:-1] >= amplitude[2:]))
    peaks = []
    for i in inner.tolist():
        near = flat[(flat >= speed[i - 1]) & (flat <= speed[i + 1])]
        peaks.append(float(near[curve(near).argmin()]) if near.size else float(speed[i]))
    found = []
    for at, i in zip(peaks, inner.tolist(), strict=True):
        depth = float(curve(at))
        if depth <= 0.0:
            found.append(Critical(float(speed[i]), float(amplitude[i]), None, None))
            continue
        half = np.asarray(curve.solve(2 * depth, extrapolate=False))
        low, high = half[half < at].max(initial=-np.inf), half[half > at].min(initial=np.inf)
        higher = [other for other in peaks if curve(other) < depth]
        below = max((other for other in higher if other < at), default=-np.inf)
        above = min((other for other in higher if other > at), default=np.inf)
        found.append(Critical(
            at, float(amplitude.max() / sqrt(depth)), float(low) if low > below and np.isfinite(low) else None,
            float(high) if high < above and np.isfinite(high) else None,
        ))  # fmt: skip
    return found
