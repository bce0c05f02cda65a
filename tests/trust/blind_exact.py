"""What is known exactly of four systems of `blind_models`: label, number of T, contraction per T.

Linear equations by their eigenvalues; z' = (mu + i w0) z - (1 + i b) |z|^2 z + F exp(i w t) in the frame that turns with the
forcing, where it is autonomous: its equilibria by a cubic, their folds by its discriminant, Hopf's threshold by a trace.
"""

from dataclasses import dataclass

import numba
import numpy as np
from tests.trust.blind_truth import _A, _B, STAGES


@dataclass(frozen=True)
class Known:
    """A truth: regime, n (0 where it has none), contraction per T."""

    regime: str
    n: int
    rate: float
    how: str


def linear(c, k, b, A, w):
    """A focus or node that drives a slow node: the slowest of three eigenvalues."""
    rates = np.append(np.roots([1, c, k]).real, -b)
    assert rates.max() < 0
    return Known("periodic", 1, -float(rates.max()) * 2 * np.pi / w, "eigenvalues")


def rotor(k, c, a, w):
    """A rotor with cross-coupled stiffness k and damping c: forward whirl at its natural frequency repels from k = c on."""
    rate = float(np.roots([1, c, 1 - 1j * k]).real.max())
    if rate > 0:
        return Known("growing", 0, -rate * 2 * np.pi / w, "eigenvalues; threshold k = c")
    return Known("periodic", 1, -rate * 2 * np.pi / w, "eigenvalues; threshold k = c")


def flip(eps, a, q, w):
    """Axes that turn by half the angle of the forcing: 2T from eps = 0 on."""
    T = 2 * np.pi / w
    if eps < 0:
        return Known("periodic", 1, -eps * T, "closed form; multiplier -exp(eps T)")
    return Known("periodic", 2, 2 * eps * T, "closed form; multiplier -exp(eps T)")


def equilibria(mu, b, F, w0, w):
    """In the turning frame: |u|^2 of each, trace and determinant of its Jacobian."""
    D = w0 - w
    # F^2 = R ((mu - R)^2 + (D - b R)^2)
    R = np.roots([1 + b**2, -2 * (mu + b * D), mu**2 + D**2, -(F**2)])
    R = np.sort(R[np.abs(R.imag) < 1e-9 * np.abs(R).max()].real)
    alpha, beta = mu + 1j * D, 1 + 1j * b
    return R, 2 * mu - 4 * R, np.abs(alpha - 2 * beta * R) ** 2 - np.abs(beta) ** 2 * R**2


def hopf_threshold(mu, b, w0, w):
    """F at which the equilibrium with |u|^2 = mu/2 has a trace of zero, its determinant being positive."""
    R, D = mu / 2, w0 - w
    assert np.abs(mu + 1j * D - 2 * (1 + 1j * b) * R) ** 2 > (1 + b**2) * R**2
    return float(np.sqrt(R * ((mu - R) ** 2 + (D - b * R) ** 2)))


def fold_threshold(mu, b, F, w0, inside, outside):
    """w between the two at which the stable equilibrium is lost at a fold: a determinant of zero."""

    def count(w):
        return len(equilibria(mu, b, F, w0, w)[0])

    assert count(inside) == 3 and count(outside) == 1
    for _ in range(200):
        middle = (inside + outside) / 2
        if middle in (inside, outside):
            break
        inside, outside = (middle, outside) if count(middle) == 3 else (inside, middle)
    return (inside + outside) / 2


def hopf(mu, b, F, w0, w):
    """An equilibrium of the turning frame attracts: 1T. None does: its cycle is a torus in the frame at rest."""
    T = 2 * np.pi / w
    _, trace, determinant = equilibria(mu, b, F, w0, w)
    eigenvalues = [np.roots([1, -s, d]).real.max() for s, d in zip(trace, determinant, strict=True)]
    if min(eigenvalues) < 0:
        return Known("periodic", 1, -float(min(eigenvalues)) * T, "turning frame: equilibrium attracts")
    beat, rate = cycle(mu, b, F, w0, w)
    near = min((abs(beat / w * q - round(beat / w * q)) / q, q) for q in range(1, 201))
    how = f"turning frame: cycle, frequency {beat:.9g} = {beat / w:.9g} w, {near[0]:.1e} from a ratio of {near[1]}"
    return Known("quasi-periodic", 0, rate * T, how)


def cycle(mu, b, F, w0, w, step=0.05, settle=2_000_000, kept=200_000):
    """Frequency of the turning frame's cycle about its equilibrium, and the rate at which it attracts.

    Runge-Kutta of order 8 with fixed steps; weighted averages (C-infinity at both ends) of the angle's advance and of the
    divergence, whose negative is the rate.
    """
    R = equilibria(mu, b, F, w0, w)[0]
    assert len(R) == 1
    middle = F / (-(mu + 1j * (w0 - w)) + (1 + 1j * b) * R[0])
    at = turning(mu + 1j * (w0 - w), 1 + 1j * b, F, middle * 1.1, step, settle, kept)
    s = (np.arange(kept - 1) + 0.5) / (kept - 1)
    weight = np.exp(-1 / (s * (1 - s)))
    weight /= weight.sum()
    # In the plane a cycle goes round an equilibrium, and there is only one.
    advance = np.angle((at[1:] - middle) / (at[:-1] - middle))
    divergence = 2 * mu - 4 * np.abs(at[1:]) ** 2
    return float(abs(weight @ advance)) / step, -float(weight @ divergence)


@numba.njit(cache=True)
def turning(alpha, beta, F, z, step, settle, kept):
    """States of u' = alpha u - beta |u|^2 u + F at the ends of steps."""
    out, k = np.empty(kept, dtype=np.complex128), np.empty(STAGES, dtype=np.complex128)
    for n in range(settle + kept):
        for stage in range(STAGES):
            u = z + 0j
            for m in range(stage):
                u += step * _A[stage, m] * k[m]
            k[stage] = alpha * u - beta * (u.real**2 + u.imag**2) * u + F
        for m in range(STAGES):
            z += step * _B[m] * k[m]
        if n >= settle:
            out[n - settle] = z
    return out
