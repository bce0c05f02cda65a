"""Computes `blind_labels.json`, the evidence of every blind point, anew.

``python -m tests.trust.blind_truths NAME ...`` for some of them.

Periodic orbits of the oscillators are Newton's, from the state that a run from the point's own start came to, with
multipliers and a test that nothing returns sooner. Chaos has an exponent ten errors above zero, a torus one whose
vector does not grow in 1e5 T. Locked motion contracts, and is a function of the forcing's phases on a cover of n turns:
after a common period of so many T, odd in number, it is back (n = 1) or back after two (n = 2); without a common period
its states once per T fit a Fourier series in the second phase, those of even and odd T together (n = 1) or apart (n =
2).
"""

import sys

import numpy as np
from tests.trust import blind_exact as exact
from tests.trust.blind_points import POINTS
from tests.trust.blind_truth import exponent, least_return, orbit, settled, turned_back, vector
from tests.trust.truth_numbers import kept, write

FILE = "blind_labels.json"
#: T until periodic motion has settled, and steps per T of Runge and Kutta's method of order 8.
SETTLE = {"van_der_pol": 3000, "pendulum": 3000, "duffing": 3000}
STEPS = {"van_der_pol": 320, "tones": 32, "two_tones": 48}
#: Common periods in T; all odd, so that a half of the mesh frequency is no multiple of their frequency.
COMMON = {"teeth-37-113": 4181, "teeth-23-187": 4301, "teeth-29-71": 2059, "teeth-two-pairs": 296851}


def evidence(point, finer=1):
    """What is found out about a point: regime, n and numbers; ``finer`` multiplies the steps."""
    if point.system in ("linear", "rotor", "flip"):
        known = getattr(exact, point.system)(**point.values)
        return {"regime": known.regime, "n": known.n, "rate per T": known.rate, "how": known.how}
    if point.system == "hopf":
        known = exact.hopf(**point.values)
        return {"regime": known.regime, "n": known.n, "rate per T": float(known.rate), "how": known.how}
    p, steps = vector(**point.values), STEPS.get(point.system, 64) * finer
    angle = point.system == "pendulum"
    if point.regime == "periodic":
        return periodic(point, p, steps, angle)
    if point.regime == "locked":
        return locked(point, p, steps)
    count = 100_000 if point.regime == "quasi-periodic" else 50_000 if point.name.startswith("bands") else 20_000
    value, error, points, logs = exponent(p, point.start, count, 3000, steps)
    found = {"exponent": value, "error": error, "growth": float(logs.sum())}
    if value > 10 * error:
        return {"regime": "chaotic", "n": 0, **found, "bands": bands(points[-20_000:, :2], angle)}
    if abs(found["growth"]) < 6:
        return {"regime": "quasi-periodic", "n": 0, **found}
    return {"regime": "unknown", "n": 0, **found}


def periodic(point, p, steps, angle):
    slow = point.name.startswith("duffing-slow")
    z = np.array(point.start) if slow else settled(p, point.start, SETTLE[point.system], steps)
    if angle:
        z = turned_back(z, True)
    for n in (point.n,) if slow else range(1, point.n + 1):
        found = orbit(p, z, n, steps, angle=angle)
        if found is not None and np.abs(turned_back(found.z - z, angle)).max() < (0.2 if slow else 1e-2) and found.rate > 0:
            break
    else:
        return {"regime": "unknown", "n": 0}
    least = least_return(p, found.z, n, steps, angle=angle)
    # The run from the start of the point comes to this orbit: it contracts towards it at the rate of the multipliers.
    far = max(200, int(1.5 / found.rate)) // n * n
    after = settled(p, z, far, steps)
    if angle:
        after = turned_back(after - found.z, True) + found.z
    ratio = float(np.hypot(*(after - found.z)) / max(np.hypot(*(z - found.z)), 1e-9))
    return {"regime": "periodic", "n": least, "rate per T": found.rate, "z": found.z.tolist(), "nearer": ratio,
            "multipliers": [[m.real, m.imag] for m in found.multipliers.astype(complex)]}  # fmt: skip


def locked(point, p, steps):
    if point.known == "superposition":
        rate = np.roots([1, point.values["c"], point.values["k"]]).real.max()
        return {"regime": "locked", "n": 1, "exponent": float(rate), "how": "linear"}
    value, error, points, _ = exponent(p, point.start, 20_000, 2000, steps)
    common = next((c for name, c in COMMON.items() if point.name.startswith(name)), 0)
    if common:
        z, misses = points[-1, :2], []
        size, at, first = np.ptp(points[:, :2], axis=0), points[-1, :2], 22_000
        for _ in range(2):
            at, first = settled(p, at, common, steps, first), first + common
            misses.append(float((np.abs(at - z) / size).max()))
    else:
        misses = [unexplained(points[:, :2], point.values["w2"] / point.values["w1"], n) for n in (1, 2)]
    n = next((i + 1 for i, miss in enumerate(misses) if miss < 1e-6), 0)
    regime = "locked" if n and value < -10 * error else "unknown"
    return {"regime": regime, "n": n, "exponent": value, "error": error, "misses": misses}


def unexplained(points, ratio, n, order=30, count=6000):
    """Largest part of the range that a Fourier series in the second phase leaves, of every n-th state by itself."""
    points, worst = points[-count:], 0.0
    number = np.arange(count) + 1
    for r in range(n):
        s = number % n == r
        basis = np.exp(2j * np.pi * np.outer(np.mod(number[s] * ratio, 1), np.arange(-order, order + 1)))
        fit = basis @ np.linalg.lstsq(basis, points[s].astype(complex), rcond=None)[0]
        worst = max(worst, float((np.abs(fit - points[s]).max(axis=0) / np.ptp(points, axis=0)).max()))
    return worst


def bands(points, angle, most=(2, 3, 4, 6, 8, 12, 16, 24, 32, 48)):
    """Largest m of these for which the points of every m-th T lie apart from the others along some line."""
    if angle:
        points = points.copy()
        points[:, 0] = np.mod(points[:, 0] + np.pi, 2 * np.pi) - np.pi
    turn = np.linspace(0, np.pi, 24, endpoint=False)
    along, best = points @ np.array([np.cos(turn), np.sin(turn)]), 1
    for m in most:
        low = np.array([along[i::m].min(axis=0) for i in range(m)])
        high = np.array([along[i::m].max(axis=0) for i in range(m)])
        apart = ((high[:, None] < low[None]) | (high[None] < low[:, None])).any(axis=2)
        best = m if apart[~np.eye(m, dtype=bool)].all() else best
    return best


def main(names):
    """Compute and keep; a truth that is not the table's is said."""
    numbers = kept(FILE)
    for point in POINTS:
        if names and not point.name.startswith(tuple(names)):
            continue
        numbers[point.name] = found = evidence(point)
        same = (found["regime"], found["n"]) == (point.regime, point.n)
        print("" if same else "NOT AS IN THE TABLE", point.name, point.truth, found, flush=True)
        write({p.name: numbers[p.name] for p in POINTS if p.name in numbers}, FILE)


if __name__ == "__main__":
    main(sys.argv[1:])
