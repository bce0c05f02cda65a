"""Least-squares fit of spectral lines at sums of given frequencies to section points: the spectrum of a locked motion."""

from fractions import Fraction
from functools import lru_cache
from math import isqrt, lcm

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Turns = tuple[Fraction, ...]

#: Lines below this part of the largest are ignored.
NOTHING = 1e-8
#: Regularisation, over the number of points: lines may be closer to each other than a record tells apart.
RIDGE = 1e-12


class Lines:
    """Least squares of points on lines: their frequencies, and of which multiples of the generators each is the sum."""

    def __init__(self, sums: Integers, frequency: Array, times: int) -> None:
        self.sums, self.frequency = sums, frequency
        self.both = np.flatnonzero((frequency > 0) & (frequency < 0.5))
        waves = _waves(frequency, times)
        self.waves = np.hstack([waves.real, waves.imag[:, self.both]])
        gram = self.waves.T @ self.waves
        gram[np.diag_indices_from(gram)] += RIDGE * times
        self.inverse = np.linalg.inv(gram)

    def fitted(self, y: Array) -> tuple[Array, Array]:
        """What the lines leave of points, and the coefficients; the second pass takes back the rounding of the first."""
        c = self.inverse @ (self.waves.T @ y)
        rest = y - self.waves @ c
        more = self.inverse @ (self.waves.T @ rest)
        return rest - self.waves @ more, c + more

    def unexplained(self, frequency: Array) -> Array:
        """Part of a line at each of other frequencies that these lines leave."""
        waves = _waves(frequency, len(self.waves))
        rest = self.fitted(np.hstack([waves.real, waves.imag]))[0]
        return np.asarray(np.sqrt((rest**2).mean(axis=0).reshape(2, -1).sum(axis=0)))

    def weights(self, c: Array) -> Array:
        """How fast lines fall with multiples of each generator, over the slowest, as powers of two; (point, generator)."""
        power = c[:, : len(self.sums)] ** 2
        power[:, self.both] += c[:, len(self.sums) :] ** 2
        size = np.sqrt(power.max(axis=2))
        size /= size.max(axis=1, keepdims=True) + 1e-300
        decay = np.ones((len(c), self.sums.shape[1]))
        for i, multiple in enumerate(np.abs(self.sums).T):
            seen = np.ones(len(c), bool)
            for j in range(1, multiple.max() + 1):
                if (multiple == j).any():
                    at = np.clip(size[:, multiple == j].max(axis=1), NOTHING, 0.99)
                    decay[:, i] = np.where(seen, -np.log(at) / j, decay[:, i])
                    seen &= at > NOTHING
        return 2 ** np.rint(np.log2(np.clip(decay / decay.min(axis=1, keepdims=True), 1, 16)))


@lru_cache(maxsize=64)
def sums_of(generators: Turns, weights: tuple[float, ...], most: int) -> tuple[Integers, Array]:
    """Multiples of each generator, and frequencies in (0, 1/2), of the lightest sums with ``most`` terms; none twice."""
    common = lcm(*(g.denominator for g in generators))
    parts = np.array([int(g * common) for g in generators], dtype=object)
    reach = 2.0
    while True:
        ends = [min(int(reach / w), g.denominator // 2) for g, w in zip(generators, weights, strict=True)]
        m = np.indices([2 * e + 1 for e in ends]).reshape(len(ends), -1).T - np.array(ends, dtype=np.int64)
        cost = np.abs(m) @ np.array(weights)
        m = m[cost <= reach][np.argsort(cost[cost <= reach], kind="stable")]
        turn = m.astype(object) @ parts % common if generators else np.zeros(1, dtype=object)
        turn = np.minimum(turn, common - turn)
        _, first = np.unique(turn, return_index=True)
        first.sort()
        terms = np.cumsum([1 if 2 * t in (0, common) else 2 for t in turn[first]])
        if terms[-1] >= most or all(2 * e + 1 >= g.denominator for e, g in zip(ends, generators, strict=True)):
            break
        reach *= 1.3
    first = first[terms <= most]
    return m[first], np.array([t / common for t in turn[first]], dtype=np.float64)


def _waves(frequency: Array, times: int) -> NDArray[np.complex128]:
    """exp(2 pi i f k), shape (time, line), as products of waves at few times."""
    side = isqrt(times - 1) + 1
    turn = 2j * np.pi * np.outer(np.arange(side), frequency)
    return np.asarray((np.exp(side * turn[:, None]) * np.exp(turn)).reshape(-1, frequency.size)[:times])


def strongest(rest: Array) -> Array:
    """Frequency of the strongest line of each point."""
    times = rest.shape[1]
    window = np.hanning(times + 1)[:-1]
    power = (np.abs(np.fft.rfft(rest * window[:, None], axis=1)) ** 2).sum(axis=2) + 1e-300
    at, rows = power.argmax(axis=1), np.arange(len(rest))
    low, mid, high = (np.log(power[rows, np.minimum(np.abs(at + s), times - at - s)]) for s in (-1, 0, 1))
    bend = low - 2 * mid + high
    return (at + np.where(bend < 0, np.clip(0.5 * (low - high) / np.where(bend < 0, bend, 1), -1, 1), 0)) / times
