"""The 0-1 test on maps whose nature is known."""

import numpy as np
import pytest
from tests.analysis.maps import GOLDEN, circle_map, henon, logistic, sines

from whirlmap.analysis.indicators.zero_one import remove_cycle, zero_one_test
from whirlmap.errors import RangeError


@pytest.mark.parametrize(
    "series",
    [logistic(4.0, 2000), logistic(3.97, 2000), henon(2000)[:, 0], np.random.default_rng(1).normal(size=2000)],
    ids=["logistic 4", "logistic 3.97", "henon", "noise"],
)
def test_chaos_and_noise_diffuse(series):
    found = zero_one_test(series)
    assert float(found.K[0]) > 0.95
    assert float(found.K_low[0]) > 0.8


@pytest.mark.parametrize(
    "series",
    [logistic(3.5, 2000), logistic(3.83, 2000), sines(2000, GOLDEN), sines(2000, GOLDEN / 3, np.sqrt(2) - 1),
     np.cos(2 * np.pi * circle_map(0.44, 0.9, 2000))],
    ids=["period 4", "period 3", "one sine", "two sines", "circle map"],
)  # fmt: skip
def test_regular_motion_stays_bounded(series):
    found = zero_one_test(series)
    assert abs(float(found.K[0])) < 0.1


def test_lanes_are_judged_alone_and_scale_does_not_matter():
    both = np.stack([logistic(4.0, 1000), sines(1000, GOLDEN)], axis=1)
    found = zero_one_test(both)
    np.testing.assert_allclose(found.K, zero_one_test(1e-6 * both + 3.0).K, atol=1e-6)
    assert float(zero_one_test(both[:, 1]).K[0]) == float(found.K[1])


def test_an_oversampled_flow_is_marked():
    """A slow sine sampled 60 times per period; thinned to 3 per period it is not oversampled."""
    slow = sines(3000, 1 / 60.3)
    assert int(zero_one_test(slow).status[0]) == 1
    assert int(zero_one_test(slow[::20]).status[0]) == 0


def test_damping_hides_weak_noise_on_a_regular_signal():
    noisy = sines(2000, GOLDEN) + 0.05 * np.random.default_rng(3).normal(size=2000)
    assert abs(float(zero_one_test(noisy, damping=2.0).K[0])) < abs(float(zero_one_test(noisy).K[0]))
    assert float(zero_one_test(logistic(4.0, 2000), damping=2.0).K[0]) > 0.9


def test_constant_and_broken_series_have_no_number():
    found = zero_one_test(np.stack([np.ones(200), np.where(np.arange(200) == 7, np.nan, 1.0)], axis=1))
    assert found.status.values.tolist() == [2, 3]
    assert np.isnan(found.K).all()
    with pytest.raises(RangeError, match="100 samples"):
        zero_one_test(np.zeros(99))


def test_banded_chaos_diffuses_once_its_cycle_is_taken_off():
    """At r = 3.57 chaos lives in narrow bands around a cycle: the hops hide the diffusion."""
    narrow = logistic(3.574, 1000)[:, None]
    hidden = float(zero_one_test(narrow).K[0])
    rest, cycle = remove_cycle(narrow)
    assert cycle[0] in (8, 16)
    assert hidden < 0.5 < 0.8 < float(zero_one_test(rest).K[0])


def test_no_cycle_is_taken_off_where_there_is_none():
    x = np.stack([logistic(4.0, 1000), sines(1000, GOLDEN)], axis=1)
    rest, cycle = remove_cycle(x)
    assert cycle.tolist() == [1, 1]
    np.testing.assert_allclose(rest, x - x.mean(axis=0), atol=1e-14)
