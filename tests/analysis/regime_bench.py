"""Operating points whose regime is known, for `test_regime_bench` and for a table: `python -m tests.analysis.regime_bench`.

Where from: *exact* follows from the equations; *table* is known_values.md; *pub* is the literature named; *long* was seen in
longer runs than those judged (forced oscillators: 3000 T with DOP853 at 1e-11; maps: plain iteration).
n is counted in T, in iterates, or in crossings. The thresholds of `regime` were set on about
105 other points of the same systems, a few maps excepted, which are in both sets.
"""

import sys
from collections import Counter
from dataclasses import dataclass, field

import numpy as np
from tests.analysis.maps import GOLDEN, circle_map, sines

import whirlmap
from whirlmap.analysis.diagnosis.diagnosis import diagnose
from whirlmap.analysis.labels.regime import regime
from whirlmap.analysis.steady.periodicity import return_multiple
from whirlmap.results.regime import Regime


@dataclass(frozen=True)
class Point:
    """One operating point: system and values, what it is, who says so."""

    system: str
    values: dict = field(hash=False)
    regime: str
    n: int | None
    known: str
    start: dict = field(default_factory=dict, hash=False)

    @property
    def name(self):
        return f"{self.system} {' '.join(f'{k}={v}' for k, v in self.values.items())}"


def p(system, regime, n, known, start=None, **values):
    return Point(system, values, regime, n, known, start or {})


PERIODIC, TORUS, CHAOS = "periodic", "quasi-periodic", "chaotic"

MAPS = [
    p("logistic", PERIODIC, 1, "exact", r=2.8),
    p("logistic", PERIODIC, 2, "exact", r=3.2),
    p("logistic", PERIODIC, 4, "exact", r=3.5),
    p("logistic", PERIODIC, 8, "pub: Feigenbaum's cascade", r=3.55),
    p("logistic", PERIODIC, 16, "pub: Feigenbaum's cascade", r=3.566),
    p("logistic", PERIODIC, 3, "exact: window from 1 + sqrt 8", r=3.83),
    p("logistic", PERIODIC, 6, "pub: cascade of the window", r=3.845),
    p("logistic", PERIODIC, 5, "long", r=3.739),
    p("logistic", CHAOS, None, "long: two bands", r=3.6),
    p("logistic", CHAOS, None, "long", r=3.7),
    p("logistic", CHAOS, None, "long", r=3.8),
    p("logistic", CHAOS, None, "long", r=3.9),
    p("logistic", CHAOS, None, "exact: ln 2", r=4.0),
    p("henon", PERIODIC, 1, "exact", a=0.3),
    p("henon", PERIODIC, 2, "exact", a=0.9),
    p("henon", PERIODIC, 4, "pub: first doublings", a=1.0),
    p("henon", PERIODIC, 7, "pub: window", a=1.3),
    p("henon", CHAOS, None, "long: bands", a=1.08),
    p("henon", CHAOS, None, "long", a=1.2),
    p("henon", CHAOS, None, "table", a=1.4),
    p("circle", TORUS, None, "exact: rigid", omega=GOLDEN, k=0.0),
    p("circle", TORUS, None, "exact: rigid", omega=float(np.sqrt(2) - 1), k=0.0),
    p("circle", TORUS, None, "long: irrational winding to 1e-9", omega=0.4, k=0.5),
    p("circle", TORUS, None, "long: irrational winding to 1e-9", omega=0.293, k=0.8),
    p("circle", PERIODIC, 2, "exact: symmetric tongue", omega=0.5, k=0.9),
    p("circle", PERIODIC, 1, "exact: |omega| < k / 2 pi", omega=0.1, k=0.9),
    p("delayed-logistic", PERIODIC, 1, "exact: below a = 2", a=1.9),
    p("delayed-logistic", TORUS, None, "pub: Aronson et al. 1982, above a = 2", a=2.1),
    p("delayed-logistic", TORUS, None, "long: irrational winding", a=2.16),
    p("delayed-logistic", CHAOS, None, "pub: Aronson et al. 1982", a=2.27),
    p("sines", TORUS, None, "exact", f1=GOLDEN, f2=float(np.sqrt(2) - 1)),
    p("sines", TORUS, None, "exact", f1=float(1 / np.pi), f2=float(np.exp(1) / 7)),
]

OSCILLATORS = [
    *(p("duffing", PERIODIC, n, "table", gamma=g) for g, n in ((0.20, 1), (0.28, 2), (0.29, 4), (0.37, 5), (0.65, 2))),
    p("duffing", CHAOS, None, "table", gamma=0.50),
    p("duffing", CHAOS, None, "table", delta=0.2, gamma=0.3, omega=1.0),
    p("duffing", CHAOS, None, "pub: Ueda 1979", delta=0.05, alpha=0.0, beta=1.0, gamma=7.5, omega=1.0),
    p("duffing", PERIODIC, 1, "exact: linear", alpha=1.0, beta=0.0, gamma=0.5),
    p("pendulum", PERIODIC, 1, "pub: Baker and Gollub", g=0.9),
    p("pendulum", PERIODIC, 2, "pub: Baker and Gollub", g=1.07),
    p("pendulum", CHAOS, None, "pub: Baker and Gollub", g=1.15),
    p("pendulum", PERIODIC, 1, "pub: Baker and Gollub", g=1.35),
    p("pendulum", PERIODIC, 2, "pub: Baker and Gollub", g=1.45),
    p("pendulum", PERIODIC, 4, "pub: Baker and Gollub", g=1.47),
    p("pendulum", CHAOS, None, "pub: Baker and Gollub", g=1.50),
    p("van_der_pol", PERIODIC, 1, "long: entrained", omega=0.93),
    p("van_der_pol", PERIODIC, 1, "long: entrained", omega=1.0),
    p("van_der_pol", PERIODIC, 3, "long: entrained at a third", omega=2.85),
    p("van_der_pol", TORUS, None, "long", omega=1.1),
    p("van_der_pol", TORUS, None, "long", omega=1.387),
    p("van_der_pol", TORUS, None, "long", omega=2.1),
    p("van_der_pol", TORUS, None, "exact: amplitude too small to entrain", A=0.01, omega=1.3),
    p("van_der_pol", TORUS, None, "long: relaxation", mu=5.0, A=0.5, omega=2.466),
    p("lorenz", CHAOS, None, "table", rho=28.0),
    p("lorenz", CHAOS, None, "long", rho=45.0),
    p("lorenz", PERIODIC, None, "pub: Sparrow, window 99.5-100.8", rho=100.5),
    p("lorenz", PERIODIC, None, "pub: Sparrow, window 145-166", rho=160.0),
    p("lorenz", PERIODIC, None, "pub: Sparrow, above 214.4 on to 313", rho=350.0),
    *(p("roessler", r, n, "pub: a = b = 0.1", a=0.1, b=0.1, c=c) for c, r, n in (
        (4.0, PERIODIC, 1), (6.0, PERIODIC, 2), (8.5, PERIODIC, 4), (8.7, PERIODIC, 8), (9.0, CHAOS, None),
        (12.0, PERIODIC, 3), (12.6, PERIODIC, 6), (13.0, CHAOS, None), (18.0, CHAOS, None))),
    p("roessler", CHAOS, None, "table", c=5.7),
    p("roessler", PERIODIC, 2, "table", c=3.0),
    p("roessler", PERIODIC, 1, "table", c=2.5),
    *(p("gear_backlash", PERIODIC, 1, "table", F_ah=0.05, Omega=o) for o in (0.3, 0.8, 1.3)),
    p("gear_backlash", PERIODIC, 2, "table", F_ah=0.2, Omega=0.8),
    p("gear_backlash", PERIODIC, 4, "table", F_ah=0.2, Omega=0.9),
    p("gear_backlash", CHAOS, None, "table", F_ah=0.2, Omega=1.1),
    p("gear_backlash", CHAOS, None, "table", F_ah=0.2, Omega=1.2),
]  # fmt: skip

GEAR_PAIRS = [
    *(p("gear-psfd/reference", PERIODIC, 8, "long: forced response, multipliers inside the circle", s=s, psi=psi)
      for s, psi in ((3.27, 0.0), (3.27, 1e-4), (2.0, 1e-3), (3.27, 0.1), (1.5, 0.1))),
]  # fmt: skip


def _iterate(point, n, drop=4000):
    """Iterates (time, state) of a map, and local exponents (time,) of its largest direction."""
    v = point.values
    if point.system == "sines":
        columns = [sines(n, v["f1"], v["f2"]), sines(n, v["f1"], v["f2"], amplitudes=(0.3, 1.0))]
        return np.stack(columns, axis=1), np.zeros(n)
    if point.system == "circle":
        lift = circle_map(v["omega"], v["k"], n, drop=drop)
        angle = 2 * np.pi * lift
        return np.stack([np.cos(angle), np.sin(angle)], axis=1), np.log(np.abs(1 - v["k"] * np.cos(angle)))
    x, y = 0.31, 0.29
    w = np.array([1.0, 0.3])
    states, local = np.empty((n, 2)), np.empty(n)
    for i in range(-drop, n):
        if point.system == "logistic":
            jacobian = np.array([[v["r"] * (1 - 2 * x), 0.0], [0.0, 0.0]])
            x, y = v["r"] * x * (1 - x), 0.0
        elif point.system == "henon":
            jacobian = np.array([[-2 * v["a"] * x, 1.0], [0.3, 0.0]])
            x, y = 1 - v["a"] * x * x + y, 0.3 * x
        else:
            jacobian = np.array([[v["a"] * (1 - y), -v["a"] * x], [1.0, 0.0]])
            x, y = v["a"] * x * (1 - y), x
        w = jacobian @ w
        length = np.hypot(*w)
        w = w / length
        if i >= 0:
            states[i], local[i] = (x, y), np.log(length)
    return (states[:, :1] if point.system == "logistic" else states), local


def label_of_map(point, n=2048):
    """Label and n of a map, from its iterates."""
    x, local = _iterate(point, n)
    found = return_multiple(x[-129:], scale=np.maximum(np.ptp(x, axis=0), 1e-3), most=64)
    blocks = local.reshape(16, -1).mean(axis=1)
    ds = regime(
        [0], found["multiple"].values, exponent=local.mean(), exponent_error=blocks.std(ddof=1) / 4, duration=n,
        section=x[:, :, None],
    )  # fmt: skip
    m = int(found["multiple"][0])
    return Regime(int(ds["regime"][0])).label, m or None, ds


def label_of_system(point):
    """Label and n of a system by diagnosis."""
    ds = diagnose(whirlmap.load(point.system, start=point.start, **point.values))
    return Regime(int(ds["regime"])).label, int(ds["period_T"]) or None, ds


def main():
    """Print the confusion table over the whole bench, and every point that is not as known."""
    table = Counter()
    for point in [*MAPS, *OSCILLATORS, *GEAR_PAIRS]:
        label, n, ds = (label_of_map if point in MAPS else label_of_system)(point)
        right = label == point.regime and (point.n is None or n == point.n)
        table[point.regime, label if label != PERIODIC or right or point.regime != PERIODIC else "wrong n"] += 1
        if not right or "-v" in sys.argv:
            known = f"known {point.regime} {point.n} ({point.known})"
            print(f"{'' if right else 'NOT AS KNOWN: '}{point.name}: {label} {n}, {known}")
            if not right:
                print(ds.attrs.get("indicators") or {k: ds[k].values.tolist() for k in ds.data_vars})
    columns = [PERIODIC, TORUS, CHAOS, "undecided", "wrong n"]
    print(f"{'known':16s}" + "".join(f"{c:>16s}" for c in columns))
    for row in (PERIODIC, TORUS, CHAOS):
        print(f"{row:16s}" + "".join(f"{table[row, c]:16d}" for c in columns))


if __name__ == "__main__":
    main()
