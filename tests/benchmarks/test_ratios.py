"""Interpolation at equal error, on curves whose answers are known."""

import numpy as np
import pytest

from contest.ratios import best_time, front, ratio, time_at


def power_law(order, factor, n=9):
    """Times of a method of some order: time = factor * error^(-1/order)."""
    return [(float(e), float(factor * e ** (-1 / order))) for e in np.geomspace(1e-2, 1e-10, n)]


def test_a_power_law_is_interpolated_exactly():
    for error in (3e-4, 1e-5, 7e-9):
        assert time_at(power_law(4, 2.0), error) == pytest.approx(2.0 * error ** (-1 / 4), rel=1e-12)


def test_the_order_of_the_points_does_not_matter():
    points = power_law(5, 1.0)
    assert time_at(points[::-1], 1e-5) == time_at(points, 1e-5)


def test_ratio_of_two_curves_of_one_order_is_that_of_their_factors():
    assert ratio([power_law(4, 2.0)], [power_law(4, 6.0)], 2e-6) == pytest.approx(3.0, rel=1e-12)


def test_ratio_takes_the_best_curve_of_each_side():
    ours, theirs = [power_law(4, 9.0), power_law(4, 2.0)], [power_law(4, 6.0), power_law(4, 50.0)]
    assert ratio(ours, theirs, 2e-6) == pytest.approx(3.0, rel=1e-12)


def test_curves_are_not_joined_into_one():
    """Between a point of one curve and a point of another nothing was measured."""
    a, b = [(1e-3, 1.0)], [(1e-9, 100.0)]
    assert best_time([a, b], 1e-6) == 100.0
    assert time_at([*a, *b], 1e-6) == pytest.approx(10.0)


def test_beaten_points_do_not_count():
    points = [(1e-3, 1.0), (1e-4, 50.0), (1e-5, 4.0), (1e-6, 3.0)]
    assert front(points) == [(1e-3, 1.0), (1e-6, 3.0)]


def test_a_curve_that_is_more_accurate_than_asked_counts_with_its_cheapest_point():
    assert time_at([(1e-6, 2.0), (1e-8, 4.0)], 1e-3) == 2.0


def test_nothing_is_extrapolated_to_smaller_errors():
    assert time_at([(1e-3, 1.0), (1e-5, 2.0)], 1e-6) is None
    assert ratio([power_law(4, 1.0)], [[(1e-3, 1.0)]], 1e-6) is None


def test_lost_points_do_not_enter():
    assert front([(float("nan"), 1.0), (float("inf"), 0.5), (0.0, 0.1)]) == []
