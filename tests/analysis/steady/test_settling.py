"""Settling that stops early gives what waiting gives, whoever shares the pool."""

import numpy as np
import pytest

from whirlmap.analysis.motion.ensembles import make_ensemble
from whirlmap.analysis.steady import pool as module
from whirlmap.analysis.steady.periodicity import return_multiple
from whirlmap.analysis.steady.return_search import to_limit
from whirlmap.analysis.steady.settling import Settling, settle
from whirlmap.integrate.loading import load


def gear(speeds, psi=1e-3):
    system = load("gear-psfd/reference").replace(psi=psi)
    return make_ensemble(system, {"s": np.asarray(speeds)}, steps=16, method="dop853")[0]


def duffing(gamma):
    return make_ensemble(load("duffing"), {"gamma": np.asarray(gamma)}, steps=30, method="dop853")[0]


def test_points_and_labels_are_those_of_plain_settling():
    """200 common periods and a window of 16 after them, against stopping early: gear pair and Duffing's ladder."""
    for make, values in ((gear, np.linspace(1.5, 4, 12)), (duffing, [0.2, 0.28, 0.29, 0.37, 0.5, 0.65])):
        early, plain = make(values), make(values)
        got = settle(early, Settling(transient=200, most=16))
        common = plain.common_multiple
        plain.advance(200 * common)
        segment = plain.advance(32 * common, save_periods=common, extremes=True)
        size = (segment.extremes["maximum"] - segment.extremes["minimum"])[: plain.model.dimension]
        found = return_multiple(segment.saved, scale=size, most=16)
        np.testing.assert_array_equal(got.multiple, found["multiple"].values)
        assert (got.multiple > 0).any()
        done = got.multiple > 0
        assert got.waited[done].mean() < 200 / 3
        # the orbit may be met at another of its m section points
        for i in np.flatnonzero(done):
            orbit = segment.saved[-got.multiple[i] :, :, i]
            apart = np.abs(orbit - early.x[:, i]) / size[:, i]
            assert apart.max(axis=1).min() < 1e-5


def test_chaos_waits_to_the_end():
    e = duffing([0.5])
    got = settle(e, Settling(transient=40, most=16))
    assert got.multiple[0] == 0
    assert got.waited[0] == 72  # 40 and twice 16


@pytest.mark.parametrize("size", [1, 3, 50])
def test_bits_do_not_depend_on_when_a_point_entered_the_pool(monkeypatch, size):
    gamma = np.concatenate([np.linspace(0.1, 0.29, 18), np.linspace(0.4, 0.7, 5)])
    expected = duffing(gamma)
    wanted = settle(expected, Settling(transient=24, most=8))
    assert np.unique(wanted.waited).size > 2  # some leave early, so that others enter late
    monkeypatch.setattr(module, "POOL", 1)
    monkeypatch.setattr(module, "LANES", size)
    e = duffing(gamma)
    e.workers = 1
    got = settle(e, Settling(transient=24, most=8))
    np.testing.assert_array_equal(got.waited, wanted.waited)
    np.testing.assert_array_equal(got.multiple, wanted.multiple)
    np.testing.assert_array_equal(got.scale, wanted.scale)
    np.testing.assert_array_equal(e.x, expected.x)


def distance_to_limit(x, m):
    """Of a series of one state with scale one."""
    return to_limit(x, 0, x.size, 0, x.size, m, 1, np.array([np.inf]), np.ones(1))


def test_distance_to_the_limit_of_a_geometric_approach():
    """x_k = 1 + r^k: what is left after k is r^k, whatever the rate, and several common periods per return."""
    for ratio in (0.1, 0.9, 0.999):
        for m in (1, 3):
            k = np.arange(40) // m
            left = distance_to_limit(1 + 1e-3 * ratio ** k.astype(float), m)
            expected = 1e-3 * ratio ** k[-1].astype(float)
            assert left == pytest.approx(expected, rel=1e-6) or left < 1e-9
    assert np.isinf(distance_to_limit(1.01 ** np.arange(20.0), 1))


def test_a_slow_approach_is_not_taken_for_a_return():
    """Differences below the tolerance that add up to more than it: not settled yet."""
    x = 1 + 0.5e-6 * 0.99 ** np.arange(16.0) / 0.01
    found = return_multiple(x[:, None, None], scale=np.ones((1, 1)), most=8)
    assert found["multiple"].values[0] == 1
    assert distance_to_limit(x, 1) > 1e-5


def test_a_spiral_that_closes_in_is_not_a_doubled_orbit():
    """Multipliers 0.88 exp(+-i 3.0): after two periods the difference is small long before it is after one.

    Hardening spring at 60 frequencies; nothing is doubled there, as a run with a hundredth of the tolerance agrees.
    """
    system = load("duffing", alpha=1, beta=0.5, delta=0.1, gamma=0.5)
    omega = {"omega": np.linspace(0.8, 2.2, 60)}
    for tolerance in (1e-6, 1e-8):
        ensemble, _ = make_ensemble(system, omega)
        found = settle(ensemble, Settling(transient=200, most=8, tolerance=tolerance))
        assert (found.multiple == 1).all(), tolerance
