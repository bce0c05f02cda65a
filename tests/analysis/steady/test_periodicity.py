"""Section points whose period is known by construction."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from whirlmap.analysis.steady.periodicity import (
    PERIOD_STATUS,
    RETURN_STATUS,
    period_in_T,
    return_multiple,
)
from whirlmap.errors import RangeError

GOLDEN = (np.sqrt(5) - 1) / 2


def cycle(m, window, states=3, seed=0):
    """(period, state): m distinct points in turn."""
    points = np.random.default_rng(seed + m).random((m, states))
    return np.resize(points, (window, states))


def circle(window, step):
    angle = 2 * np.pi * step * np.arange(window)
    return np.c_[np.cos(angle), np.sin(angle), np.cos(angle + 1)]


def logistic(r, window, x=0.3):
    out = np.empty((window, 1))
    for i in range(20_000 + window):
        x = r * x * (1 - x)
        if i >= 20_000:
            out[i - 20_000] = x
    return out


def meanings(result, words):
    return [words[k] for k in result.status.values]


@given(m=st.integers(1, 64), states=st.integers(1, 5), noise=st.sampled_from([0.0, 1e-13, 1e-9]))
@settings(max_examples=40, deadline=None)
def test_a_cycle_returns_after_its_length(m, states, noise):
    x = cycle(m, 128, states)
    x = x + noise * np.random.default_rng(m).standard_normal(x.shape)
    result = return_multiple(x, scale=1.0)
    assert result.multiple.values.tolist() == [m] == result.nearest_multiple.values.tolist()
    assert float(result.distance[0]) <= 10 * noise
    assert float(result.drift[0]) <= 10 * noise


@pytest.mark.parametrize(
    ("r", "m"), [(2.9, 1), (3.2, 2), (3.5, 4), (3.55, 8), (3.566, 16), (3.835, 3), (3.845, 6)]
)
def test_logistic_windows(r, m):
    result = return_multiple(logistic(r, 128))
    assert result.multiple.values.tolist() == [m]


def test_chaos_and_quasi_periodicity_do_not_return():
    both = np.stack([np.repeat(logistic(4.0, 128), 3, axis=1), circle(128, GOLDEN)], axis=-1)
    result = return_multiple(both)
    assert result.multiple.values.tolist() == [0, 0]
    assert meanings(result, RETURN_STATUS) == ["no-return", "no-return"]
    # The golden mean is nearest to a return after Fibonacci numbers; 55 is the largest below 64.
    assert int(result.nearest_multiple[1]) == 55
    chord = 2 * np.sin(np.pi * abs(55 * GOLDEN - 34))
    assert float(result.distance[1]) == pytest.approx(chord / 2, rel=0.02)  # spread of a circle: 2


def test_lanes_are_judged_alone():
    lanes = [cycle(m, 128) for m in (1, 8, 64)] + [circle(128, GOLDEN), np.full((128, 3), np.nan)]
    together = return_multiple(np.stack(lanes, axis=-1), scale=np.ones(3))
    assert together.multiple.values.tolist() == [1, 8, 64, 0, 0]
    assert meanings(together, RETURN_STATUS) == ["returns"] * 3 + ["no-return", "not-finite"]
    assert np.isnan(together.distance.values).tolist() == [False] * 4 + [True]
    for k, lane in enumerate(lanes):
        alone = return_multiple(lane, scale=np.ones(3))
        for name in alone:
            np.testing.assert_array_equal(alone[name].values[0], together[name].values[k])
    assert all({"units", "long_name"} <= set(v.attrs) for v in together.variables.values())


def test_the_worst_state_and_the_worst_point_decide():
    """A mean over states or points would hide one state that doubles, or one point that does not return."""
    x = cycle(4, 128)
    x[::8, 1] += 1e-4
    result = return_multiple(x, scale=1.0)
    assert int(result.multiple[0]) == 8
    x = cycle(4, 128)
    x[77, 2] += 1e-4
    result = return_multiple(x, scale=1.0)
    assert int(result.multiple[0]) == 0 and int(result.deciding_state[0]) == 2
    assert float(result.distance[0]) == pytest.approx(1e-4)


def test_tiny_motion_is_judged_by_its_own_scale():
    """A state that swings by 1e-9 about 0.7: only its range over the orbit shows that it moves."""
    x = 0.7 + 1e-9 * circle(128, GOLDEN)
    assert int(return_multiple(x, scale=2e-9).multiple[0]) == 0
    assert int(return_multiple(x).multiple[0]) == 1  # the documented limit of guessing from the section


def test_rounding_errors_of_states_at_rest_do_not_forbid_a_return():
    rng = np.random.default_rng(0)
    x = np.c_[
        cycle(2, 128, 1),
        1e-17 * rng.standard_normal(128),
        0.7 + 1e-15 * rng.standard_normal(128),
        np.zeros(128),
    ]
    assert int(return_multiple(x).multiple[0]) == 2
    assert int(return_multiple(x, scale=np.ptp(x, axis=0)).multiple[0]) == 2
    assert int(return_multiple(np.zeros((128, 2))).multiple[0]) == 1
    alone = 0.7 + 1e-15 * rng.standard_normal((128, 1))  # nothing larger beside it
    assert int(return_multiple(alone, scale=np.ptp(alone, axis=0)).multiple[0]) == 1


def test_cyclic_state_is_taken_modulo_its_period():
    """A pendulum that goes round once per two periods: its angle returns modulo 2 pi only."""
    i = np.arange(128)
    x = np.c_[np.pi * i + 0.1, np.where(i % 2, 0.3, 0.4)]
    assert int(return_multiple(x, scale=1.0).multiple[0]) == 0
    assert int(return_multiple(x, scale=1.0, cyclic={0: 2 * np.pi}).multiple[0]) == 2
    assert int(return_multiple(x, cyclic={0: 2 * np.pi}).multiple[0]) == 2
    seam = np.c_[np.mod(1e-9 * (-1.0) ** i, 2 * np.pi), np.ones(128)]  # jumps between 0 and 2 pi
    assert int(return_multiple(seam, scale=1.0, cyclic={0: 2 * np.pi}).multiple[0]) == 1


def test_drift_shows_a_slow_beat():
    """A beat of 1e-7 turns per period passes the tolerance; the drift is 127 times larger."""
    result = return_multiple(circle(128, 1e-7), scale=2.0)
    assert int(result.multiple[0]) == 1
    assert float(result.drift[0]) == pytest.approx(127 * float(result.distance[0]), rel=1e-3)


@given(factor=st.floats(1e-9, 1e9), m=st.integers(1, 16))
@settings(max_examples=20, deadline=None)
def test_units_do_not_matter(factor, m):
    x = cycle(m, 64) * np.array([1.0, 1e-3, 1e3])
    a, b = return_multiple(x, most=16), return_multiple(x * factor, most=16)
    assert int(a.multiple[0]) == int(b.multiple[0]) == m


def test_short_windows_are_refused():
    with pytest.raises(RangeError, match=r"127 points.*need at least 128.*most=63"):
        return_multiple(cycle(1, 127))
    assert return_multiple(cycle(5, 12), most=6).multiple.values.tolist() == [5]


# Periods in T.


@given(n=st.integers(1, 40), common=st.sampled_from([1, 2, 8, 40]))
@settings(max_examples=60, deadline=None)
def test_period_in_T_of_a_cycle(n, common):
    """n points, one per T: the multiple m is n / gcd(n, common); the period in T must come back as n."""
    m = n // np.gcd(n, common)
    assume(m <= 16)
    points = cycle(n, max(m * common, 2 * 32 * common if common < 8 else 32 * common))
    found = return_multiple(points[::common], scale=1.0, most=16)
    assert found.multiple.values.tolist() == [m]
    result = period_in_T(points, found.multiple.values, common_over_T=common, scale=1.0)
    assert result.period.values.tolist() == [n]


def test_statuses_of_periods():
    lanes = np.stack(
        [cycle(8, 64), cycle(4, 64), cycle(16, 64), cycle(1, 64), circle(64, GOLDEN), cycle(8, 64)], axis=-1
    )
    lanes[3, 0, 5] = np.nan
    result = period_in_T(lanes, np.array([1, 1, 2, 9, 0, 1]), common_over_T=8, scale=1.0)
    assert meanings(result, PERIOD_STATUS) == [
        "periodic", "periodic", "periodic", "window-too-short", "no-return", "not-finite",
    ]  # fmt: skip
    assert result.period.values.tolist() == [8, 4, 16, 0, 0, 0]


def test_the_whole_needs_no_second_look():
    """The window just holds it: return_multiple has seen that return, no proper divisor returns."""
    result = period_in_T(cycle(16, 16), np.array([2]), common_over_T=8, scale=1.0)
    assert result.period.values.tolist() == [16]
    assert np.isnan(result.distance[0]) and int(result.distance_status[0]) == 1


def test_wrong_input_is_refused():
    x = cycle(2, 128)
    with pytest.raises(RangeError, match="shape"):
        return_multiple(x[:, 0])
    with pytest.raises(RangeError, match="tolerance"):
        return_multiple(x, tolerance=0.0)
    with pytest.raises(RangeError, match="scale"):
        return_multiple(x, scale=-1.0)
    with pytest.raises(RangeError, match="scale has shape"):
        return_multiple(x, scale=np.ones((3, 4)))
    with pytest.raises(RangeError, match="cyclic"):
        return_multiple(x, cyclic={3: 1.0})
    with pytest.raises(RangeError, match="multiple"):
        period_in_T(x, np.array([1, 1]), common_over_T=8)
    with pytest.raises(RangeError, match="common_over_T"):
        period_in_T(x, np.array([1]), common_over_T=0)
