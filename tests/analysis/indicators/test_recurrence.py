"""Recurrence: exact counts of small sets, the determinism of noise, periodic and chaotic motion."""

import numpy as np
import pytest
from tests.analysis.maps import GOLDEN, henon, logistic, sines

from whirlmap.analysis.indicators.recurrence import recurrence
from whirlmap.errors import RangeError


def test_a_cycle_of_four_recurs_every_fourth_time():
    """Pairs a multiple of 4 apart, out of all; every one on a line, the longest of N - 4."""
    found = recurrence(np.tile([0.0, 1.0, 2.0, 3.5], 25), radius=0.1)
    pairs = sum(100 - lag for lag in range(4, 100, 4))
    assert float(found.recurrence_rate) == pytest.approx(pairs / (99 * 100 / 2))
    assert float(found.determinism) == 1.0
    assert int(found.longest_line) == 96
    assert float(found.mean_line) == pytest.approx(pairs / 24)


def test_noise_has_the_determinism_of_chance():
    """1 - (1 - p)^2 with least = 2."""
    x = np.random.default_rng(0).uniform(size=3000)
    found = recurrence(x, rate=0.1)
    p = float(found.recurrence_rate)
    assert p == pytest.approx(0.1, abs=0.01)
    assert float(found.determinism) == pytest.approx(1 - (1 - p) ** 2, abs=0.02)


def test_dynamics_exceed_chance():
    turning = np.stack([sines(1000, GOLDEN / 7), sines(1002, GOLDEN / 7)[2:]], axis=1)
    assert float(recurrence(turning).determinism) > 0.95
    assert float(recurrence(henon(2000), rate=0.01).determinism) > 0.5
    assert float(recurrence(logistic(3.5, 500), rate=0.2).determinism) == 1.0


def test_what_cannot_be_judged_is_refused():
    with pytest.raises(RangeError, match="at least 50"):
        recurrence(np.zeros(10))
    with pytest.raises(RangeError, match=r"rate = 0\.7"):
        recurrence(np.arange(100.0), rate=0.7)
