"""Points of the four exact systems drawn at random, so that a rule that was mended on the eighty can be asked afresh."""

import numpy as np
from tests.trust.blind_exact import equilibria, hopf_threshold
from tests.trust.blind_points import Point


def margin(random, low=-5.0, high=-1.5):
    """Signed distance to a threshold, over decades."""
    return float(random.choice([-1, 1]) * 10 ** random.uniform(low, high))


def drawn(seed, each=8):
    """``each`` points of every system: linear, flip, rotor, hopf. Their truths are signs of exact numbers."""
    random, points = np.random.default_rng(seed), []

    def keep(system, truth, start, values):
        regime, n = ("periodic", int(truth[:-1])) if truth[:-1].isdigit() else (truth, 0)
        values = {name: float(value) for name, value in values.items()}
        points.append(Point(f"{system}-{seed}-{len(points)}", system, values, start, regime, n, "closed form"))

    for _ in range(each):
        c, b = 10 ** random.uniform(-5.3, -1, 2)
        keep("linear", "1T", (1, 0, 0.5), dict(c=c, k=random.uniform(0.5, 2), b=b, A=1, w=random.uniform(1.6, 3)))
        eps, a, q, w = margin(random), *random.uniform((0.3, 0.1, 0.8), (1, 0.4, 2.5))
        keep("flip", "1T" if eps < 0 else "2T", (a, 0.1), dict(eps=eps, a=a, q=q, w=w))
        c, over = random.uniform(0.05, 0.4), margin(random, -4)
        keep("rotor", "1T" if over < 0 else "growing", (0.5, 0, 0, 0.2),
             dict(k=c * (1 + over), c=c, a=random.uniform(0.1, 0.5), w=random.uniform(1.3, 3)))  # fmt: skip
        fixed = dict(mu=random.uniform(0.05, 0.3), b=random.uniform(-0.5, 0.5), w0=1.0, w=random.uniform(1.5, 2.5))
        over = margin(random, -3.5)
        values = {**fixed, "F": hopf_threshold(**fixed) * (1 + over)}
        stable = equilibria(**values)[1].min() < 0  # one equilibrium, of positive determinant, so far from w0
        assert len(equilibria(**values)[0]) == 1
        assert stable == (over > 0)
        keep("hopf", "1T" if stable else "quasi-periodic", (0.2, 0.1), values)
    return points
