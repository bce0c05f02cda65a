"""Linear oscillators under sums of cosines in closed form: what superposition says of period, extremes, mean and rms.

x'' + c x' + k x = sum of F_i cos(w_i t + p_i): each cosine answers with F_i / (k - w_i^2 + i c w_i). The frequencies are
whole multiples of a common one, given exactly, so that the common period is too.
"""

from fractions import Fraction
from math import lcm

import numpy as np
from scipy.optimize import minimize_scalar


class Linear:
    """Steady motion of x'' + c x' + k x = mean + sum of forces; ``forces`` maps an exact frequency to a complex amplitude.

    ``unit`` is the frequency that the exact ones count in.
    """

    def __init__(self, c, k, forces, mean=0.0, unit=1.0):
        self.offset = mean / k
        self.parts = [(w, f / (k - (float(w) * unit) ** 2 + 1j * c * float(w) * unit)) for w, f in forces.items()]
        self.unit = unit

    def common(self, declared=None):
        """Common period of the declared frequencies (all where absent) in periods of the fastest."""
        exact = [abs(Fraction(w)) for w in declared or [w for w, _ in self.parts]]
        fastest = max(exact)
        return lcm(*((w / fastest).denominator for w in exact if w))

    def of(self, t, derivative=0):
        t = np.asarray(t, dtype=float)
        turns = [(1j * float(w) * self.unit, x) for w, x in self.parts]
        value = sum(np.real(x * w**derivative * np.exp(w * t)) for w, x in turns)
        return value + (self.offset if derivative == 0 else 0.0)

    @property
    def rms(self):
        """About the mean; frequencies differ from each other and from zero."""
        return float(np.sqrt(sum(abs(x) ** 2 for _, x in self.parts) / 2))

    def extremes(self, derivative=0):
        exact = [abs(Fraction(w)) for w, _ in self.parts]
        slowest = Fraction(1, lcm(*(w.denominator for w in exact)))
        whole = 2 * np.pi / (float(slowest) * self.unit)
        return extremes_of(lambda t: self.of(t, derivative), whole, float(max(exact)) * self.unit)


def extremes_of(function, duration, fastest):
    """Smallest and largest value of a smooth periodic function: sampled finely, then refined to rounding."""
    count = int(200 * duration * fastest / (2 * np.pi)) + 200
    t = np.linspace(0, duration, count)
    x = function(t)
    out = []
    for sign in (1, -1):
        best = np.inf
        for i in np.argsort(sign * x)[:8]:
            found = minimize_scalar(lambda s, sign=sign: sign * float(function(s)), method="bounded",
                                    bounds=(t[i] - t[1], t[i] + t[1]), options={"xatol": 1e-10 * t[1]})  # fmt: skip
            best = min(best, found.fun)
        out.append(sign * best)
    return out[0], out[1]
