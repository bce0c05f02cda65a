"""Cycles of unforced systems by SciPy: period, returns to the section, extremes, and exponents of the other directions.

Nothing of whirlmap is used. Radau or DOP853 (Adams-like steps where the system is stiff) runs at a relative tolerance of
1e-11 or less to the crossings of the section, which are located as events of the interpolant; the cycle is taken once two
rounds of it differ by less than 1e-9 of its size. The sum of the exponents is the mean of the divergence (Liouville), an
integral of its own, so that a multiplier of e^-500 is as exact as one of e^-1; multipliers beside it come from the
variational equation over one round.
"""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from sympy import Matrix, Symbol, lambdify, sympify
from tests.trust.truth_events import Arc
from tests.trust.truth_orbits import extremes


@dataclass(frozen=True)
class Cycle:
    """A limit cycle: period, crossings of its section in one period, sum of its exponents, multipliers, extremes."""

    period: float
    returns: int
    divergence: float
    multipliers: np.ndarray
    low: np.ndarray
    high: np.ndarray
    z: np.ndarray

    def plain(self):
        order = np.argsort(-np.abs(self.multipliers))
        return {
            "period": self.period, "returns": self.returns, "divergence": self.divergence,
            "real": self.multipliers.real[order].tolist(), "imaginary": self.multipliers.imag[order].tolist(),
            "low": self.low.tolist(), "high": self.high.tolist(), "z": self.z.tolist(),
        }  # fmt: skip


class Flow:
    """Equations as text, at one operating point; ``section`` is crossed where it rises."""

    def __init__(self, states, rates, section, **values):
        names = states.split()
        z = [Symbol(n, real=True) for n in names]
        local = {**dict(zip(names, z, strict=True)), **values}
        f = Matrix([sympify(r, locals=local) for r in rates])
        jacobian = f.jacobian(z)
        self.n = len(names)
        self.rates = lambdify(z, list(f), modules="math", cse=True)
        self.jacobian = lambdify(z, list(jacobian), modules="math", cse=True)
        self.height = lambdify(z, sympify(section, locals=local), modules="math")

    def _run(self, y, time, right, jac, method, events=None, keep=False, rtol=1e-11):
        size = max(np.abs(y[: self.n]).max(), 1e-3)
        made = solve_ivp(right, (0, time), y, method=method, rtol=rtol, atol=1e-3 * rtol * size, events=events,
                         dense_output=keep, **({"jac": jac} if method == "Radau" else {}))  # fmt: skip
        assert made.success, made.message
        return made

    def cycle(self, start, time, *, method="DOP853", most=8, near=1e-9, multipliers=True, skip=0.0):
        """Cycle that a start leads to within a time; ``skip`` is a time beyond which a return counts (grazing wiggles)."""
        n = self.n

        def right(_, z):
            return self.rates(*z)

        def jac(_, z):
            return np.array(self.jacobian(*z)).reshape(n, n)

        def rises(_, z):
            return self.height(*z)

        rises.direction = 1
        made = self._run(np.array(start, dtype=float), time, right, jac, method, events=[rises])
        times, points = made.t_events[0], made.y_events[0]
        size = np.ptp(points[-min(len(points), 40) :], axis=0).max() + np.abs(points[-1]).max()
        last = points[-1]
        k = next(k for k in range(1, most + 1) if np.abs(points[-1 - k] - last).max() < near * size
                 and times[-1] - times[-1 - k] > skip)  # fmt: skip
        period = times[-1] - times[-1 - k]

        # One more round, with the integral of the divergence and, where asked, the variational equation.
        def whole(t, y):
            j = jac(t, y[:n])
            grown = (j @ y[n + 1 :].reshape(n, n)).ravel() if multipliers else []
            return np.concatenate([self.rates(*y[:n]), [np.trace(j)], grown])

        y = np.concatenate([last, [0.0], np.eye(n).ravel() if multipliers else []])
        round_ = self._run(y, period, whole, None, "DOP853" if method == "DOP853" else "LSODA", keep=True, rtol=1e-12)
        assert np.abs(round_.y[:n, -1] - last).max() < 1e-6 * size
        eigen = np.linalg.eigvals(round_.y[n + 1 :, -1].reshape(n, n)) if multipliers else np.array([1.0])
        low, high = extremes([Arc((), 0.0, period, round_.sol)], n)
        return Cycle(period, k, float(round_.y[n, -1] / period), eigen, low, high, last)
