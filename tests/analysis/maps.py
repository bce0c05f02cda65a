"""Small systems with known answers that the tests of indicators share: maps, tori as sums of sines, noise."""

import numpy as np

GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0


def logistic(r, n, x=0.3, drop=1000):
    out = np.empty(n + drop)
    for i in range(n + drop):
        x = r * x * (1.0 - x)
        out[i] = x
    return out[drop:]


def henon(n, a=1.4, b=0.3, x=0.1, y=0.1, drop=1000):
    out = np.empty((n + drop, 2))
    for i in range(n + drop):
        x, y = 1.0 - a * x * x + y, b * x
        out[i] = x, y
    return out[drop:]


def circle_map(omega, k, n, theta=0.1, drop=1000):
    """Lift of theta + omega - k / (2 pi) sin(2 pi theta); k < 1 is invertible."""
    out = np.empty(n + drop)
    for i in range(n + drop):
        theta = theta + omega - k / (2 * np.pi) * np.sin(2 * np.pi * theta)
        out[i] = theta
    return out[drop:]


def sines(n, *frequencies, amplitudes=None):
    """Sum of sines; frequencies per sample."""
    t = np.arange(n)[:, None]
    size = np.ones(len(frequencies)) if amplitudes is None else np.asarray(amplitudes)
    return (size * np.sin(2 * np.pi * t * np.asarray(frequencies) + np.arange(len(frequencies)))).sum(axis=1)
