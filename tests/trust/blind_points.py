"""Eighty operating points for the blind test of labels: the table of `blind_truths`.

`Point.regime` and `n` are the truth, ``known`` says how it was found, ``margin`` how far the nearest threshold is (relative
to the parameter that the threshold is one of), where there is one. ``locked`` with n: no frequency but those of the forcing
and their n-th parts, where the forcing has no common period below 128 T.
"""

from dataclasses import dataclass, field

import numpy as np
from tests.trust.blind_exact import fold_threshold, hopf_threshold

GOLDEN = (np.sqrt(5) - 1) / 2


@dataclass(frozen=True)
class Point:
    """One operating point and what it is."""

    name: str
    system: str
    values: dict = field(hash=False)
    start: tuple
    regime: str
    n: int
    known: str
    margin: float | None = None

    @property
    def truth(self):
        return f"{self.n}T" if self.regime == "periodic" else f"locked {self.n}" if self.regime == "locked" else self.regime


POINTS: list[Point] = []


def add(name, system, truth, known, start, margin=None, **values):
    """``truth`` as it is printed: ``2T``, ``locked 1``, ``chaotic``."""
    regime, n = ("periodic", int(truth[:-1])) if truth[:-1].isdigit() else (truth, 0)
    if truth.startswith("locked"):
        regime, n = "locked", int(truth.split()[1])
    values = {key: float(value) for key, value in values.items()}
    POINTS.append(Point(name, system, values, start, regime, n, known, margin))


EXACT, NEWTON, LONG = "closed form", "Newton's method and multipliers", "long run, exponent and returns"
Z3, Z4 = (1.0, 0.0, 0.5), (0.5, 0.0, 0.0, 0.2)

# 1. Slow contraction: a focus that drives a node, per T down to 1e-5.
for name, values in {
    "focus-1e-3": dict(c=1e-3, k=1, b=1, A=1, w=1.3),
    "focus-1e-4": dict(c=1e-4, k=1, b=0.7, A=0.4, w=1.7),
    "focus-3e-5": dict(c=2e-5, k=2, b=0.9, A=1, w=2.1),
    "focus-1e-5": dict(c=3.2e-6, k=1, b=1, A=0.6, w=np.sqrt(2) * 0.7),
    "node-1e-3": dict(c=0.5, k=1, b=1e-3, A=1, w=1.1),
    "node-1e-5": dict(c=0.4, k=1, b=1.6e-5, A=1, w=10),
    "both-slow": dict(c=1e-4, k=1, b=3e-5, A=1, w=0.6),
    "soft-node": dict(c=0.3, k=3e-5, b=0.5, A=1, w=1.2),
}.items():
    add(f"linear-{name}", "linear", "1T", EXACT, Z3, **values)
for c, A, w1 in ((3e-3, 0.05, 2.6), (3e-4, 0.08, 2.3), (3e-5, 0.06, 2.9), (4e-6, 0.05, 2.7)):
    add(f"duffing-slow-{c:.0e}", "duffing", "1T", NEWTON, (0.02, 0.0), A=A, c=c, k=1, q2=0.2, q3=0.5, D=0, w1=w1)

# 2. Near folds: exact ones of the forced Hopf oscillator; inside it is 1T, outside its beat is long.
for name, fixed, inside, outside, margins in (
    ("a", dict(mu=0.1, b=0, F=0.005, w0=1), 1.001, 1.05, (1e-3, 1e-5, -1e-2)),
    ("b", dict(mu=0.2, b=0.3, F=0.02, w0=1), 0.95, 0.8, (1e-2, 1e-4, -3e-2)),
):
    at = fold_threshold(**fixed, inside=inside, outside=outside)
    for m in margins:
        add(f"fold-{name}{m:+.0e}", "hopf", "1T" if m > 0 else "quasi-periodic", "turning frame: cubic, discriminant",
            (0.3, 0.1), m, **fixed, w=at - m * (at - 1))  # fmt: skip
# Duffing's oscillator where its resonance breaks off, by Newton's method on orbit and multiplier one.
UPPER = 1.69373748964529
for m in (-1e-3, -1e-5, 1e-6, 1e-4):
    add(f"fold-duffing{m:+.0e}", "duffing", "1T", "threshold by Newton's method", (-0.0749, 3.4148), abs(m),
        A=0.3, c=0.08, k=1, q2=0, q3=0.5, D=0, w1=UPPER * (1 + m))  # fmt: skip

# 3. Near flips: exact ones, and two of the pendulum by Newton's method on orbit and multiplier minus one.
FLIP_1, FLIP_2 = 1.339324809196892, 1.3713145770847792
for at, m, n in ((FLIP_1, -1e-5, 1), (FLIP_1, 5e-6, 2), (FLIP_2, -1e-5, 2)):
    add(f"flip-pendulum-{n}T{m:+.0e}", "pendulum", f"{n}T", "threshold by Newton's method", (0.3, 0.0), abs(m),
        A=at * (1 + m), c=0.4, s=1, D=0, w1=0.7)  # fmt: skip
for eps in (-1e-2, -1e-3, -1e-4, -5e-6, 1e-5, 1e-4, 1e-3):
    add(f"flip{eps:+.0e}", "flip", "1T" if eps < 0 else "2T", EXACT, (0.9, 0.1), abs(eps), eps=eps, a=0.8, q=0.3, w=1.7)

# 4. Near Neimark-Sacker points: the forced Hopf oscillator by F, the rotor by k, whose threshold is c.
for name, fixed, factor in (
    ("a", dict(mu=0.1, b=0.5, w0=1, w=1.3), 1.024),
    ("b", dict(mu=0.3, b=0, w0=1, w=0.72), 1.0003),
    ("c", dict(mu=0.2, b=-0.4, w0=1, w=1.7), 1.003),
    ("d", dict(mu=0.1, b=0.5, w0=1, w=1.3), 0.997),
    ("e", dict(mu=0.2, b=-0.4, w0=1, w=1.7), 0.98),
):
    add(f"hopf-{name}", "hopf", "1T" if factor > 1 else "quasi-periodic", "turning frame: trace", (0.2, 0.1), factor - 1,
        **fixed, F=factor * hopf_threshold(**fixed))  # fmt: skip
for k in (0.195, 0.199, 0.1999, 0.19999, 0.2005, 0.201, 0.21):
    add(f"rotor-{k}", "rotor", "1T" if k < 0.2 else "growing", "eigenvalues, threshold 0.2", Z4, k / 0.2 - 1,
        k=k, c=0.2, a=0.3, w=1.4)  # fmt: skip

# 5. Hunting teeth: mesh, shafts and their second order; two pairs have a common period of 296 851 T.
A37 = dict(w1=1, w2=1 / 37, w3=1 / 113, w4=2 / 37)
A23 = dict(w1=1, w2=1 / 23, w3=1 / 187, w4=2 / 23)
A29 = dict(w1=1, w2=1 / 29, w3=1 / 71, w4=2 / 29)
PAIRS = dict(w1=1, w2=1 / 37, w3=29 / 113, w4=29 / 8023)
PARAMETRIC = dict(c=0.06, mu=0, k=0.25, h=0.25, q3=0.4, A=0.05, B=0.02, C=0.02, E=0.01)
for name, truth, known, values in (
    ("37-113-linear", "locked 1", "superposition", dict(A37, c=0.1, k=0.3, A=1, B=0.5, C=0.3, E=0.1)),
    ("37-113-cubic", "locked 1", LONG, dict(A37, c=0.1, k=0.3, q3=1, A=0.5, B=0.3, C=0.1, E=0.05)),
    ("23-187-linear", "locked 1", "superposition", dict(A23, c=0.02, k=0.6, A=1, B=0.3, C=0.4, E=0.2)),
    ("23-187-halved", "locked 2", LONG, dict(A23, **PARAMETRIC)),
    ("29-71-slow", "locked 1", "superposition", dict(A29, c=1e-3, k=0.4, A=1, B=0.5, C=0.3, E=0.1)),
    ("two-pairs-linear", "locked 1", "superposition", dict(PAIRS, c=0.1, k=0.5, A=1, B=0.5, C=0.8, E=0.2)),
    ("two-pairs-cubic", "locked 1", LONG, dict(PAIRS, c=0.15, k=0.5, q3=1, A=0.5, B=0.2, C=0.3, E=0.05)),
    ("two-pairs-halved", "locked 2", LONG, dict(PAIRS, **PARAMETRIC)),
    ("37-113-torus", "quasi-periodic", LONG, dict(A37, mu=0.3, k=0.15, A=0.1, B=0.05, C=0.05, E=0.02)),
    ("37-113-chaos", "chaotic", LONG, dict(A37, c=0.2, k=-1, q3=1, A=0.35, B=0.1, C=0.05, E=0.02)),
):
    add(f"teeth-{name}", "tones", truth, known, (0.5, 0.1), **{**dict(c=0, mu=0, h=0, q3=0), **values})

# 6. Two frequencies without a common period.
R2, R3, RPI = np.sqrt(2), np.sqrt(3), 1 / np.pi
for name, truth, known, values in (
    ("golden-linear", "locked 1", "superposition", dict(c=0.1, k=1, A=1, B=0.7, w1=1.4, w2=1.4 * GOLDEN)),
    ("golden-slow", "locked 1", "superposition", dict(c=1e-3, k=1, A=1, B=0.7, w1=1.7, w2=1.7 * GOLDEN)),
    ("root2-cubic", "locked 1", LONG, dict(c=0.15, k=0.8, q3=0.6, A=0.5, B=0.4, w1=1.3 * R2, w2=1.3)),
    ("entrained", "locked 1", LONG, dict(mu=0.3, k=1, A=1.5, B=0.2, w1=1.05, w2=1.05 * GOLDEN)),
    ("pi-halved", "locked 2", LONG, dict(c=0.1, k=1, h=1, q3=1, A=0.1, B=0.1, w1=2, w2=2 * RPI)),
    ("golden-halved", "locked 2", LONG, dict(c=0.1, k=1, h=1, q3=1, A=0.1, B=0.1, w1=2, w2=2 * (1 - GOLDEN))),
    ("golden-torus", "quasi-periodic", LONG, dict(mu=0.6, k=1, A=0.3, B=0.4, w1=1.3, w2=1.3 * GOLDEN)),
    ("root2-torus", "quasi-periodic", LONG, dict(mu=0.2, k=1, A=0.2, B=0.2, w1=1.1 * R2, w2=1.1)),
    ("golden-chaos", "chaotic", LONG, dict(c=0.2, k=-1, q3=1, A=0.3, B=0.2, w1=1.1, w2=1.1 * GOLDEN)),
    ("root3-chaos", "chaotic", LONG, dict(c=0.2, k=-1, q3=1, A=0.4, B=0.15, w1=1.2, w2=1.2 / R3)),
):
    add(f"tones-{name}", "two_tones", truth, known, (0.5, 0.1), **{**dict(c=0, mu=0, h=0, q3=0), **values})

# 7. Locking at high periods: van der Pol's oscillator.
TONGUES = {3.38: 27, 3.415: 17, 3.52: 12, 3.59: 13, 4.29: 51, 4.675: 17, 5.515: 10, 5.97: 11, 7.055: 13}
for w1, n in TONGUES.items():
    add(f"tongue-{n}T-{w1}", "van_der_pol", f"{n}T", NEWTON, (1.0, 0.0), A=5, mu=5, k=1, w1=w1)

# 8. Weak chaos and chaos in bands.
for A, known in ((1.3805, "48 bands, .0010"), (1.3815, "24 bands, .0017"), (1.3855, "6 bands, .0065"), (1.388, "8 bands")):
    add(f"bands-pendulum-{A}", "pendulum", "chaotic", f"{LONG}: {known}", (0.3, 0.0), A=A, c=0.4, s=1, D=0, w1=0.7)
for A, known in ((0.3333, "12 bands, .0057"), (0.3334, "6 bands, .011"), (0.3337, "3 bands, .0067")):
    add(f"bands-duffing-{A}", "duffing", "chaotic", f"{LONG}: {known}", (1.0, 0.0), A=A, c=0.25, k=-1, q2=0, q3=1, D=0, w1=1)
