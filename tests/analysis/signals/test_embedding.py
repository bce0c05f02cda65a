"""Lags and dimensions of series whose generator is known."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import lfilter

from whirlmap.analysis.signals.embedding import (
    LAG_STATUS,
    NEIGHBOUR_STATUS,
    _nearest,
    delay_embedding,
    false_neighbours,
    mutual_information,
)
from whirlmap.errors import RangeError


def henon_x(n, seed=0):
    x, y = np.random.default_rng(seed).uniform(-0.1, 0.1, 2)
    out = np.empty(n + 100)
    for i in range(n + 100):
        x, y = 1 - 1.4 * x * x + y, 0.3 * x
        out[i] = x
    return out[100:]


@pytest.fixture(scope="module")
def lorenz_x():
    def f(v):
        x, y, z = v
        return np.array([10 * (y - x), x * (28 - z) - y, x * y - 8 / 3 * z])

    v, dt, out = np.array([1.0, 1.0, 20.0]), 0.02, np.empty(6500)
    for i in range(6500):
        k1 = f(v)
        k2 = f(v + dt / 2 * k1)
        k3 = f(v + dt / 2 * k2)
        k4 = f(v + dt * k3)
        v = v + dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        out[i] = v[0]
    return out[500:]


def test_mutual_information_at_lag_zero_is_the_entropy():
    """Bins of equal occupation: log2(bins) exactly."""
    x = np.random.default_rng(0).standard_normal(16_000 + 3)
    assert float(mutual_information(x, 3, bins=16).mutual_information[0]) == pytest.approx(4.0, abs=1e-3)


def test_mutual_information_of_a_gaussian_pair():
    """x(t+1) = r x(t) + noise: I(lag) = -1/2 log2(1 - r^(2 lag)), less what the bins lose, plus the bias."""
    r, n, rng = 0.8, 100_000, np.random.default_rng(1)
    x = lfilter([np.sqrt(1 - r * r)], [1, -r], rng.standard_normal(n))
    m = mutual_information(x, 3, bins=32)
    exact = -0.5 * np.log2(1 - r ** (2 * np.arange(1, 4)))
    np.testing.assert_allclose(m.mutual_information[1:] - m.bias, exact, rtol=0.06, atol=0.005)


def test_independent_values_show_the_bias():
    x = np.random.default_rng(2).standard_normal(20_000)
    m = mutual_information(x, 20, bins=8)
    assert float(m.mutual_information[1:].mean()) == pytest.approx(float(m.bias), rel=0.15)


def test_first_minimum_of_lorenz(lorenz_x):
    """0.16 to 0.18 time units is commonly given for x; here steps of 0.02."""
    m = mutual_information(lorenz_x, 40, bins=16)
    assert LAG_STATUS[int(m.status)] == "ok"
    assert 0.14 <= 0.02 * int(m.first_minimum) <= 0.20


def test_a_map_has_no_minimum_and_a_constant_is_said():
    m = mutual_information(henon_x(20_000), 6)
    assert LAG_STATUS[int(m.status)] == "no-minimum" and int(m.first_minimum) == 0
    assert LAG_STATUS[int(mutual_information(np.ones(9000), 6).status)] == "constant"


def test_mutual_information_forgets_monotonic_changes_and_pools_lanes(lorenz_x):
    a, b = mutual_information(lorenz_x, 20), mutual_information(np.exp(lorenz_x / 5), 20)
    np.testing.assert_allclose(
        a.mutual_information, b.mutual_information, atol=5e-3
    )  # a few values change bins
    pieces = lorenz_x.reshape(2, -1).T
    np.testing.assert_allclose(
        mutual_information(pieces, 5).mutual_information, a.mutual_information[:6], atol=0.1
    )


@given(
    n=st.integers(20, 60),
    dimension=st.integers(1, 5),
    lag=st.integers(1, 4),
    lanes=st.sampled_from([None, 1, 3]),
)
@settings(max_examples=30, deadline=None)
def test_delay_vectors(n, dimension, lag, lanes):
    x = np.random.default_rng(n).random(n if lanes is None else (n, lanes))
    points = delay_embedding(x, dimension=dimension, lag=lag)
    assert points.shape == (n - (dimension - 1) * lag, *x.shape[1:], dimension)
    for i in (0, len(points) - 1):
        for k in range(dimension):
            np.testing.assert_array_equal(points[i, ..., k], x[i + k * lag])


def test_henon_needs_two_dimensions():
    f = false_neighbours(henon_x(3000), lag=1, most=5)
    assert NEIGHBOUR_STATUS[int(f.status)] == "ok" and int(f.dimension_found) == 2
    assert float(f.fraction[0]) > 0.3


def test_lorenz_needs_three_dimensions(lorenz_x):
    f = false_neighbours(lorenz_x, lag=8, most=5, theiler=20)
    assert int(f.dimension_found) == 3


def test_a_circle_needs_two_and_pieces_are_pooled():
    angle = 0.1 * np.sqrt(2) * np.arange(1200)
    assert int(false_neighbours(np.sin(angle), lag=11, most=4, theiler=5).dimension_found) == 2
    pieces = np.sin(angle.reshape(3, 400).T)
    assert int(false_neighbours(pieces, lag=11, most=4, theiler=5).dimension_found) == 2


def test_noise_has_no_dimension_and_a_constant_is_said():
    f = false_neighbours(np.random.default_rng(4).standard_normal(3000), lag=1, most=6)
    assert NEIGHBOUR_STATUS[int(f.status)] == "no-dimension" and int(f.dimension_found) == 0
    assert NEIGHBOUR_STATUS[int(false_neighbours(np.ones(500), lag=1).status)] == "constant"


def test_rounding_errors_of_a_periodic_series_part_nobody():
    x = np.tile([0.1, 0.7, 0.4, 0.9], 500) + 1e-15 * np.random.default_rng(5).standard_normal(2000)
    assert float(false_neighbours(x, lag=1, most=3).fraction.max()) == 0.0


@pytest.mark.parametrize("theiler", [1, 3, 40])
def test_nearest_neighbours_against_all_distances(theiler):
    """Slow walks in two lanes: without the window nearly every neighbour is one in time."""
    walk = np.cumsum(np.random.default_rng(6).standard_normal((100, 2)), axis=0)
    time, lane = (v.ravel() for v in np.indices(walk.shape))
    points = walk.ravel()[:, None]
    distance, neighbour = _nearest(points, time, lane, theiler)
    away = np.abs(points - points.T)
    away[(lane[:, None] == lane) & (np.abs(time[:, None] - time) < theiler)] = np.inf
    np.testing.assert_array_equal(distance, away.min(axis=1))
    np.testing.assert_array_equal(away[np.arange(200), neighbour], away.min(axis=1))


def test_wrong_input_is_refused():
    x = np.random.default_rng(0).random(5000)
    with pytest.raises(RangeError, match="pairs"):
        mutual_information(x[:500], 5)
    with pytest.raises(RangeError, match="max_lag"):
        mutual_information(x, 5000)
    with pytest.raises(RangeError, match="dimension"):
        delay_embedding(x[:10], dimension=6, lag=2)
    with pytest.raises(RangeError, match="samples leave"):
        false_neighbours(x[:150], lag=10)
    with pytest.raises(RangeError, match="finite"):
        false_neighbours(np.append(x, np.inf), lag=1)
    with pytest.raises(RangeError, match="theiler"):
        false_neighbours(x, lag=1, theiler=0)
