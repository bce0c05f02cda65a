"""`diagnose` and `label_points` on the same points: one label, one period, and exponents within their errors."""

import numpy as np
import pytest

import whirlmap
from whirlmap.results.labels import labels

#: Stock case -> parameters, and the ranges that points are drawn from; how many.
DRAWN = {
    "duffing": ({"gamma": (0.2, 0.65), "omega": (1.1, 1.3)}, 7),
    "pendulum": ({"g": (0.9, 1.5)}, 3),
    "van_der_pol": ({"omega": (0.9, 1.3)}, 3),
    "gear_backlash": ({"Omega": (0.5, 1.5)}, 3),
    "roessler": ({"c": (2.5, 5.0)}, 2),
    "jeffcott": ({"s": (0.5, 1.8)}, 2),
}  # fmt: skip


def points(case):
    ranges, count = DRAWN[case]
    rng = np.random.default_rng([len(case), 20])
    return {name: rng.uniform(*ends, count) for name, ends in ranges.items()}


@pytest.mark.parametrize("share", [pytest.param(1, marks=pytest.mark.slow), 3], ids=["all", "a third"])
@pytest.mark.parametrize("case", DRAWN)
def test_labels_periods_and_exponents_agree(case, share):
    drawn = {name: values[::share] for name, values in points(case).items()}
    ds = whirlmap.label_points(whirlmap.load(case), drawn)
    words, seen = labels(ds).values, 0
    for k in range(ds.sizes["point"]):
        at = {name: float(values[k]) for name, values in drawn.items()}
        one = whirlmap.diagnose(whirlmap.load(case, **at), max_periods=4096, points=400, exponent_count=1)
        said = str(labels(one).values)
        assert "undecided" in (said, words[k]) or said == words[k], (at, said, words[k])
        seen += said == words[k] != "undecided"
        if said == words[k]:
            assert int(one["period_T"]) == int(ds["period_T"][k]), at
        here, there = float(one["lyapunov"][0]), float(ds["lyapunov"][k])
        if np.isfinite(there) and said != "periodic":
            error = np.hypot(float(one["lyapunov_error"][0]), float(ds["lyapunov_error"][k]))
            assert abs(here - there) < 4 * error + 1e-4, (at, here, there, error)
    assert seen >= ds.sizes["point"] - 1
    assert case != "duffing" or share > 1 or {"periodic", "chaotic"} <= set(words)
