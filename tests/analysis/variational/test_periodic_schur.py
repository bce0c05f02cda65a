"""Eigenvalues of products of matrices that are not formed."""

import numpy as np
import pytest

from whirlmap.analysis.variational.periodic_schur import eigenvalues_of_products


@pytest.mark.parametrize("logs", [(18.0, -28.0), (0.1, -69.0), (18.0, -69.0), (3.0, 1.0, -40.0)])
def test_eigenvalues_far_apart_are_each_good_to_rounding(logs):
    """Two states too: their whole product is a block of two from the start."""
    mix = np.random.default_rng(1).normal(size=(len(logs), len(logs)))
    factor = mix @ np.diag(np.exp(np.array(logs) / 32)) @ np.linalg.inv(mix)
    found, angles = eigenvalues_of_products(np.broadcast_to(factor, (1, 32, *factor.shape)))
    np.testing.assert_allclose(found[0], logs, atol=1e-10)
    np.testing.assert_allclose(angles, 0, atol=1e-12)


def test_a_pair_keeps_its_block():
    """A rotation by 0.3 in each of 10 factors, which shrinks by 0.1."""
    turn = 0.1 * np.array([[np.cos(0.3), -np.sin(0.3)], [np.sin(0.3), np.cos(0.3)]])
    found, angles = eigenvalues_of_products(np.broadcast_to(turn, (1, 10, 2, 2)))
    np.testing.assert_allclose(found[0], 10 * np.log(0.1), atol=1e-12)
    np.testing.assert_allclose(angles[0], [3.0, -3.0], atol=1e-12)
