"""Attractors of piecewise smooth systems: periodic orbits by Newton's method and exponents by QR, on `truth_events`.

A periodic orbit is a fixed point of the map of n periods, whose derivative is the tangent matrix of the run, saltation
and sliding included; its multipliers are that matrix's eigenvalues. Nothing of whirlmap is used.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar
from tests.trust.truth_events import LOOSE, Equations, Runs


class Pieces(Equations):
    """Equations in pieces; ``at`` gives the motion at some parameter values."""

    def at(self, **values):
        return Motion(self, values)


class Motion(Runs):
    """One operating point: where it settles, and what that is."""

    def turn(self, z, periods=1, **options):
        """Run from phase zero over some periods."""
        return self.run(0.0, z, periods * self.period, **options)

    def settle(self, z, periods, tolerance=LOOSE):
        """State at phase zero after some periods."""
        for _ in range(periods):
            z = self._wrap(self.turn(z, tolerance=tolerance).z)
        return z

    def _wrap(self, z):
        z = np.array(z)
        for name, round_ in self.pieces.cyclic.items():
            k = self.pieces.states.split().index(name)
            z[k] -= round_ * np.round(z[k] / round_)
        return z

    def difference(self, a, b):
        return self._wrap(np.subtract(a, b))

    def orbit(self, z, periods):
        """Newton's method on the map of some periods: a state of the orbit at phase zero, and its multipliers."""
        z = np.array(z, dtype=float)
        for _ in range(25):
            made = self.turn(z, periods, tangent=True)
            step = np.linalg.solve(made.tangent - np.eye(self.n), self.difference(made.z, z))
            z = z - step
            if np.abs(step).max() < 1e-11 * max(np.abs(z).max(), 1e-3 * self.scale):
                break
        made = self.turn(z, periods, tangent=True)
        missed = np.abs(self.difference(made.z, z)).max()
        assert missed < 1e-9 * max(np.abs(z).max(), 1e-2 * self.scale), f"no orbit of {periods} periods: {missed}"
        return z, np.linalg.eigvals(made.tangent)

    def attractor(self, start, *, settle=200, most=16, near=1e-4):
        """Where a start leads: `Orbit` of the least period found, or None where nothing returns."""
        z = self.settle(start, settle)
        points = [z]
        for _ in range(most):
            points.append(self.settle(points[-1], 1))
        size = max(np.ptp(points, axis=0).max(), 1e-3 * np.abs(points).max())
        for n in range(1, most + 1):
            if np.abs(self.difference(points[n], points[0])).max() < near * size:
                try:
                    return self.described(points[n], n)
                except (AssertionError, np.linalg.LinAlgError):
                    continue
        return None

    def spectrum(self, start, *, settle=100, periods=400, blocks=16, tolerance=LOOSE):
        """Lyapunov exponents and their standard errors, by QR of the tangent matrix of every period; the periods' means."""
        z, frame = self.settle(start, settle), np.eye(self.n)
        grown = np.empty((periods, self.n))
        for k in range(periods):
            made = self.turn(z, tangent=True, tolerance=tolerance)
            z = self._wrap(made.z)
            frame, triangle = np.linalg.qr(made.tangent @ frame)
            with np.errstate(divide="ignore"):
                grown[k] = np.log(np.abs(np.diag(triangle))) / self.period
        means = grown[: periods - periods % blocks].reshape(blocks, -1, self.n).mean(axis=1)
        return means.mean(axis=0), means.std(axis=0, ddof=1) / np.sqrt(blocks), z

    def described(self, z, n):
        z, multipliers = self.orbit(z, n)
        for k in range(1, n):
            assert np.abs(self.difference(self.turn(z, k).z, z)).max() > 1e-6 * self.scale, f"{k} periods already"
        made = self.turn(z, n, keep=True)
        low, high = extremes(made.arcs, self.n)
        kinds = [kind for _, _, kind in made.events]
        return Orbit(n, z, multipliers, low, high, kinds.count("crosses"), kinds.count("slides"), self.period)


@dataclass(frozen=True)
class Orbit:
    """A periodic orbit: period in T, state at phase zero, multipliers over its own period, extremes of its states."""

    n: int
    z: np.ndarray
    multipliers: np.ndarray
    low: np.ndarray
    high: np.ndarray
    crosses: int
    slides: int
    period: float

    @property
    def largest(self):
        return float(np.abs(self.multipliers).max())

    @property
    def exponents(self):
        with np.errstate(divide="ignore"):
            return np.sort(np.log(np.abs(self.multipliers)))[::-1] / (self.n * self.period)

    def plain(self):
        order = np.argsort(-np.abs(self.multipliers))
        return {
            "n": self.n, "z": self.z.tolist(), "real": self.multipliers.real[order].tolist(),
            "imaginary": self.multipliers.imag[order].tolist(), "low": self.low.tolist(), "high": self.high.tolist(),
            "crosses": self.crosses, "slides": self.slides,
        }  # fmt: skip


def extremes(arcs, n, samples=24):
    """Smallest and largest value of each state over some arcs, refined on the interpolant to rounding."""
    low, high = np.full(n, np.inf), np.full(n, -np.inf)
    for arc in arcs:
        ts = np.unique(np.concatenate([np.linspace(a, b, samples) for a, b in zip(arc.solution.ts[:-1], arc.solution.ts[1:],
                                                                                  strict=True)]))  # fmt: skip
        if ts.size < 3:
            continue
        x = arc.solution(ts)[:n]
        for k in range(n):
            for sign, best in ((1, low), (-1, high)):
                i = int(np.argmin(sign * x[k]))
                value = sign * x[k, i]
                if 0 < i < ts.size - 1:
                    found = minimize_scalar(lambda s, k=k, sign=sign, arc=arc: sign * arc.solution(s)[k],
                                            bounds=(ts[i - 1], ts[i + 1]), method="bounded",
                                            options={"xatol": 1e-9 * (ts[i + 1] - ts[i - 1])})  # fmt: skip
                    value = min(value, found.fun)
                best[k] = sign * min(sign * best[k], value)
    return low, high
