"""The gear pair with backlash solved exactly: linear between the corners of its dead zone, which are roots of closed forms.

x'' + 2 zeta x' + f(x) = F_m + F_ah Omega^2 cos(Omega t); f(x) = 0 between -1 and 1 and x -+ 1 beyond. Nothing of whirlmap is
used. The force is continuous at the corners, so that the variational equation passes them without a jump.
"""

from math import cos, exp, pi, sin, sqrt

import numpy as np

#: Parts of a period in which a crossing of a corner is looked for; two within one part would be missed.
PARTS = 400


class DeadZone:
    """One operating point; ``mean`` and ``amplitude`` of the right-hand side are forces."""

    def __init__(self, zeta, mean, amplitude, omega):
        self.zeta, self.mean, self.omega = zeta, mean, omega
        self.period = 2 * pi / omega
        # Particular solutions p cos + q sin at stiffness 0 and 1, beside a constant or a drift from the mean load.
        self.harmonic = []
        for stiffness in (0.0, 1.0):
            a, b = stiffness - omega**2, 2 * zeta * omega
            size = amplitude / (a * a + b * b)
            self.harmonic.append((a * size, b * size))

    def particular(self, side, t):
        p, q = self.harmonic[abs(side)]
        c, s = cos(self.omega * t), sin(self.omega * t)
        x, v = p * c + q * s, self.omega * (q * c - p * s)
        if side:
            return x + self.mean + side, v
        drift = self.mean / (2 * self.zeta)
        return x + drift * t, v + drift

    def propagator(self, side, t):
        """Matrix that takes a difference of two states over a time within one side."""
        z = self.zeta
        if side:
            w = sqrt(1 - z * z)
            c, s, e = cos(w * t), sin(w * t) / w, exp(-z * t)
            return np.array([[e * (c + z * s), e * s], [-e * s, e * (c - z * s)]])
        e = exp(-2 * z * t)
        return np.array([[1.0, (1 - e) / (2 * z)], [0.0, e]])

    def state(self, side, t0, start, t):
        x0, v0 = self.particular(side, t0)
        x1, v1 = self.particular(side, t)
        return self.propagator(side, t - t0) @ (start - (x0, v0)) + (x1, v1)

    def turn(self, state, periods=1):
        """State and derivative of it after some periods from phase zero."""
        state, tangent = np.array(state, dtype=float), np.eye(2)
        t, end = 0.0, periods * self.period
        side = self.side_of(state[0])
        for k in range(PARTS * periods):
            until = end * (k + 1) / (PARTS * periods)
            while True:
                after = self.state(side, t, state, until)
                beyond = self.leaves(side, after[0])
                if beyond is None:
                    break
                low, high = t, until
                for _ in range(60):  # bisection to the last bits
                    middle = (low + high) / 2
                    if self.leaves(side, self.state(side, t, state, middle)[0]) is None:
                        low = middle
                    else:
                        high = middle
                state, tangent = self.state(side, t, state, high), self.propagator(side, high - t) @ tangent
                t, side = high, beyond
            state, tangent, t = after, self.propagator(side, until - t) @ tangent, until
        return state, tangent

    @staticmethod
    def side_of(x):
        return 1 if x > 1 else -1 if x < -1 else 0

    @staticmethod
    def leaves(side, x):
        """Side that a position belongs to, None if it is the one given."""
        if side == 0:
            return 1 if x > 1 else -1 if x < -1 else None
        return 0 if side * x < 1 else None

    def orbit(self, state, periods):
        """Newton on the stroboscopic map: a state of the orbit, and its multipliers."""
        for _ in range(20):
            after, tangent = self.turn(state, periods)
            step = np.linalg.solve(tangent - np.eye(2), after - state)
            state = state - step
            if np.abs(step).max() < 1e-12:
                break
        after, tangent = self.turn(state, periods)
        assert np.abs(after - state).max() < 1e-10
        return state, np.linalg.eigvals(tangent)
