"""One oscillator of many terms with a Runge-Kutta method of its own, for truths of labels that need long or exact runs.

x'' = mu (1 - x^2) x' - c x' - (k + h cos w1 t) x - q2 x^2 - q3 x^3 - s sin x + D + A cos w1 t + B cos w2 t + C cos w3 t
+ E cos w4 t, with T = 2 pi/w1. Steps are fixed, of Dormand and Prince's method of order 8 with SciPy's coefficients, and
every truth is asked for with two lengths of step.
"""

from dataclasses import dataclass

import numba
import numpy as np
from scipy.integrate._ivp import dop853_coefficients as dop853

NAMES = ("c", "mu", "k", "h", "q2", "q3", "s", "D", "A", "w1", "B", "w2", "C", "w3", "E", "w4")
STAGES = dop853.N_STAGES
_A, _B, _C = (np.ascontiguousarray(m) for m in (dop853.A[:STAGES, :STAGES], dop853.B, dop853.C[:STAGES]))


def vector(**values):
    """Parameters in the order of `NAMES`; those not named are zero, and frequencies not named one."""
    unknown = set(values) - set(NAMES)
    assert not unknown, unknown
    return np.array([float(values.get(name, name[0] == "w")) for name in NAMES])


@numba.njit(cache=True)
def rates(p, t, y, out):
    """Rates of x, v and of tangent vectors (a, b), one after the other."""
    c, mu, k, h, q2, q3, s, D, A, w1, B, w2, C, w3, E, w4 = p
    x, v = y[0], y[1]
    one = np.cos(w1 * t)
    force = D + A * one
    if B != 0:
        force += B * np.cos(w2 * t)
    if C != 0:
        force += C * np.cos(w3 * t)
    if E != 0:
        force += E * np.cos(w4 * t)
    damping, spring = c - mu * (1 - x * x), k + h * one
    slope = spring + 2 * q2 * x + 3 * q3 * x * x + 2 * mu * x * v
    pull = spring * x + q2 * x * x + q3 * x * x * x
    if s != 0:
        pull += s * np.sin(x)
        slope += s * np.cos(x)
    out[0], out[1] = v, force - damping * v - pull
    for j in range(2, y.size, 2):
        out[j], out[j + 1] = y[j + 1], -damping * y[j + 1] - slope * y[j]


@numba.njit(cache=True)
def turns(p, y, first, count, steps, stretch):
    """States at the ends of ``count`` T from T number ``first``; the first tangent vector is set to length one if asked.

    Returns states (count, size) and logarithms of the lengths (count,).
    """
    h = 2 * np.pi / p[9] / steps
    size = y.size
    slopes = np.empty((STAGES, size))
    y, z = y.copy(), np.empty(size)
    points, logs = np.empty((count, size)), np.zeros(count)
    for n in range(count):
        for i in range(steps):
            t = ((first + n) * steps + i) * h
            for stage in range(STAGES):
                for j in range(size):
                    total = 0.0
                    for m in range(stage):
                        total += _A[stage, m] * slopes[m, j]
                    z[j] = y[j] + h * total
                rates(p, t + _C[stage] * h, z, slopes[stage])
            for j in range(size):
                total = 0.0
                for m in range(STAGES):
                    total += _B[m] * slopes[m, j]
                y[j] += h * total
        if stretch:
            length = np.hypot(y[2], y[3])
            y[2] /= length
            y[3] /= length
            logs[n] = np.log(length)
        points[n] = y
    return points, logs


@dataclass(frozen=True)
class Orbit:
    """A periodic orbit of n T and its multipliers."""

    n: int
    z: np.ndarray
    multipliers: np.ndarray

    @property
    def rate(self):
        """Slowest contraction per T: minus the logarithm of the largest multiplier."""
        return -float(np.log(np.abs(self.multipliers).max())) / self.n


def settled(p, z, count, steps=64, first=0):
    return turns(p, np.asarray(z, dtype=float), first, count, steps, False)[0][-1]


def turned_back(difference, angle):
    """The difference of two states, of which the first may be an angle."""
    if angle:
        difference[..., 0] -= 2 * np.pi * np.rint(difference[..., 0] / 2 / np.pi)
    return difference


def orbit(p, z, n, steps=64, most=40, angle=False):
    """Orbit of n T near z by Newton's method (no settling), or None."""
    z = np.asarray(z, dtype=float)
    for _ in range(most):
        y = np.concatenate([z, [1, 0, 0, 1]])
        end = turns(p, y, 0, n, steps, False)[0][-1]
        M = np.array([[end[2], end[4]], [end[3], end[5]]])
        move = np.linalg.solve(M - np.eye(2), turned_back(z - end[:2], angle))
        if not np.isfinite(move).all() or np.abs(move).max() > 10:
            return None
        z = z + move
        if np.abs(move).max() < 1e-11 * max(1, np.abs(z).max()):
            return Orbit(n, z, np.linalg.eigvals(M))
    return None


def least_return(p, z, most, steps=64, tolerance=1e-8, angle=False):
    """Smallest number of T after which the state is back, 0 where none."""
    points = turns(p, np.asarray(z, dtype=float), 0, most, steps, False)[0]
    apart = turned_back(points - np.asarray(z), angle)
    back = np.flatnonzero(np.abs(apart).max(axis=1) < tolerance)
    return int(back[0]) + 1 if back.size else 0


def exponent(p, z, count, settle, steps=64, blocks=20):
    """Largest exponent per unit of time, its standard error from blocks, and the last state."""
    y = np.concatenate([np.asarray(z, dtype=float), [0.8, 0.6]])
    y = turns(p, y, 0, settle, steps, True)[0][-1]
    points, logs = turns(p, y, settle, count, steps, True)
    T = 2 * np.pi / p[9]
    parts = logs[: count // blocks * blocks].reshape(blocks, -1).mean(axis=1) / T
    return float(parts.mean()), float(parts.std(ddof=1) / np.sqrt(blocks)), points, logs
