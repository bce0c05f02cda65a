"""Kaplan-Yorke dimensions of published spectra."""

import numpy as np
import pytest

from whirlmap.analysis.variational.kaplan_yorke import kaplan_yorke, kaplan_yorke_error


@pytest.mark.parametrize(
    ("spectrum", "dimension"),
    [((0.41922, -1.62319), 1.25827), ((0.9056, 0.0, -14.5723), 2.06215), ((0.0714, 0.0, -5.3943), 2.0132)],
    ids=["henon", "lorenz", "roessler"],
)
def test_published_dimensions(spectrum, dimension):
    assert kaplan_yorke(spectrum) == pytest.approx(dimension, abs=5e-5)


def test_limits():
    assert kaplan_yorke([-1.0, -2.0]) == 0.0
    assert kaplan_yorke([0.0, -2.0]) == 1.0  # a cycle
    assert kaplan_yorke([0.0, 0.0, -2.0]) == 2.0  # a torus
    assert kaplan_yorke([1.0, 0.5]) is None
    assert kaplan_yorke([]) is None
    assert kaplan_yorke([np.nan, -1.0]) is None


def test_error_is_that_of_many_draws():
    value, error = np.array([0.41922, -1.62319]), np.array([0.01, 0.02])
    draws = np.random.default_rng(0).normal(value, error, (4000, 2))
    spread = np.std([kaplan_yorke(d) for d in draws])
    assert kaplan_yorke_error(value, error) == pytest.approx(spread, rel=0.05)
    assert kaplan_yorke_error([1.0, 0.5], [0.1, 0.1]) is None
    assert kaplan_yorke_error([-1.0, -2.0], [0.1, 0.1]) == 0.0
