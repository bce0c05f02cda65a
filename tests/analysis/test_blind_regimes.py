"""Labels of random operating points, none of which was used to set a threshold, against long runs of another integrator.

Truth: classical RK4 in NumPy, 160 steps per T, 3000 T: a return to 1e-7 over the last 256 T, else the total growth of a
tangent vector over 2000 T (above 25: chaotic; within 12: quasi-periodic; else nobody knows, and the point does not count).
The dampers of Duffing's oscillator and of the pendulum contract areas of the section everywhere, so that it has no invariant
curve: what does not return there and does not grow still approaches a periodic orbit, which this run is too short to name.
Seen on the 48 points of this seed: none wrong, one undecided.
"""

import numpy as np
import pytest

import whirlmap
from whirlmap.results.regime import Regime
from whirlmap.sweep.points.label_points import label_points

COUNT, STEPS, PERIODS = 16, 160, 3000


def drawn():
    """Operating points of each system, of one seed, in this order."""
    random = np.random.default_rng(20260712)

    def between(low, high):
        return random.uniform(low, high, COUNT)

    return {
        "duffing": {"gamma": between(0.1, 0.7), "omega": between(0.7, 1.5), "delta": between(0.1, 0.4)},
        "pendulum": {"g": between(0.7, 1.8), "omega": between(0.5, 0.9)},
        "van_der_pol": {"omega": between(0.8, 2.6), "A": between(0.1, 2.0)},
    }


def rates(case, p):
    """Rates of the state and of a tangent vector, written out here once more."""
    if case == "duffing":
        return lambda t, x, v, a, b: (
            v, p["gamma"] * np.cos(p["omega"] * t) - p["delta"] * v - p["alpha"] * x - p["beta"] * x**3,
            b, -p["delta"] * b - (p["alpha"] + 3 * p["beta"] * x * x) * a,
        )  # fmt: skip
    if case == "pendulum":
        return lambda t, x, v, a, b: (
            v, p["g"] * np.cos(p["omega"] * t) - p["q"] * v - np.sin(x), b, -p["q"] * b - np.cos(x) * a,
        )  # fmt: skip
    return lambda t, x, v, a, b: (
        v, p["mu"] * (1 - x * x) * v - x + p["A"] * np.cos(p["omega"] * t),
        b, p["mu"] * (1 - x * x) * b - (2 * p["mu"] * x * v + 1) * a,
    )  # fmt: skip


def truth(case, p, start):
    """Label and period of each point; None where nobody knows."""
    rate, h = rates(case, p), 2 * np.pi / p["omega"] / STEPS
    y = np.array([np.full(COUNT, c) for c in (*start, 0.8, 0.6)])
    section, growth = [], []
    for _ in range(PERIODS):
        for i in range(STEPS):
            t = i * h
            k1 = np.array(rate(t, *y))
            k2 = np.array(rate(t + h / 2, *(y + h / 2 * k1)))
            k3 = np.array(rate(t + h / 2, *(y + h / 2 * k2)))
            y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + np.array(rate(t + h, *(y + h * k3))))
        size = np.hypot(y[2], y[3])
        y[2:] /= size
        growth.append(np.log(size))
        section.append(y[:2].copy())
    total, points, found = np.array(growth)[1000:].sum(axis=0), np.array(section)[-256:], []
    for k in range(COUNT):
        for m in range(1, 97):
            apart = points[m:, :, k] - points[:-m, :, k]
            if case == "pendulum":
                apart[:, 0] -= 2 * np.pi * np.rint(apart[:, 0] / (2 * np.pi))
            if np.abs(apart).max() < 1e-7:
                found.append((Regime.periodic, m))
                break
        else:
            torus = case == "van_der_pol" and abs(total[k]) < 12
            kind = Regime.chaotic if total[k] > 25 else Regime.quasi_periodic if torus else None
            found.append((kind, 0))
    return found


@pytest.mark.slow
def test_no_random_point_is_labelled_wrongly():
    counted = undecided = 0
    for case, values in drawn().items():
        system = whirlmap.load(case)
        p = {name: np.full(COUNT, float(v)) for name, v in system.values.items()} | values
        known = truth(case, p, [s.start for s in system.model.states])
        ds = label_points(system, values, lyapunov=1024)
        for k, (kind, period) in enumerate(known):
            label = int(ds["regime"][k])
            if kind is None:
                continue
            counted, undecided = counted + 1, undecided + (label == Regime.undecided)
            if label != Regime.undecided:
                where = {name: float(v[k]) for name, v in values.items()}
                assert (label, int(ds["period_T"][k])) == (kind, period), (case, where)
    assert counted >= 40 and undecided <= 0.05 * counted


@pytest.mark.slow
@pytest.mark.parametrize("case", ["duffing", "pendulum", "van_der_pol"])
def test_labels_stay_with_finer_steps_twice_the_length_and_another_start(case):
    """Points that one of both leaves undecided may differ; no two labels may contradict each other."""
    system, values = whirlmap.load(case), drawn()[case]
    base = label_points(system, values, steps=32, lyapunov=1024)
    size = base.sizes["point"]
    finer = label_points(system, values, steps=64, lyapunov=1024)
    longer = label_points(system, values, steps=32, lyapunov=2048, settling=whirlmap.Settling(transient=200))
    # Another state on the same attractor: where the motion stands after some more periods.
    moved = np.empty((2, size))
    for k in range(size):
        here = system.replace(**{name: float(v[k]) for name, v in values.items()})
        moved[:, k] = whirlmap.simulate(here, periods=230, steps=32)["x"].isel(time=-1).values
    other = label_points(system, values, steps=32, lyapunov=1024, starts=moved)
    for name, again in (("finer", finer), ("longer", longer), ("other start", other)):
        both = (base["regime"].values != Regime.undecided) & (again["regime"].values != Regime.undecided)
        assert both.mean() > 0.85, name
        for variable in ("regime", "period_T"):
            np.testing.assert_array_equal(base[variable].values[both], again[variable].values[both], f"{name} {variable}")
