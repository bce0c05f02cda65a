"""Refinement: the boundaries of shapes that are known, from few of the points."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from whirlmap.sweep.maps.refine import refine


def run(full, coarse=8):
    asked = np.zeros(full.shape, dtype=int)

    def evaluate(at):
        asked[at] += 1
        return full[at]

    labels, known = refine(full.shape, evaluate, coarse=coarse)
    assert asked.max() == 1 and (asked > 0).sum() == known.sum()
    np.testing.assert_array_equal(asked > 0, known)
    np.testing.assert_array_equal(labels[known], full[known])
    return labels, known


def test_a_disc_is_found_from_few_points():
    y, x = np.meshgrid(np.linspace(-1, 1, 300), np.linspace(-1, 1, 400))
    full = (x**2 + y**2 < 0.5).astype(int)
    labels, known = run(full)
    np.testing.assert_array_equal(labels, full)
    assert known.mean() < 0.06


def test_a_thin_tongue_is_followed_to_its_end():
    """It is seen where it is wide, and followed to where it is a single point wide."""
    full = np.zeros((129, 129), dtype=int)
    for i in range(129):
        full[i, 64 - i // 16 : 65 + i // 16] = 1
    labels, known = run(full)
    np.testing.assert_array_equal(labels, full)
    assert known.mean() < 0.25


@pytest.mark.parametrize("shape", [(1, 50), (50, 1), (1, 1), (2, 2), (9, 9), (8, 8), (10, 3)])
def test_any_shape(shape):
    full = (np.arange(shape[0])[:, None] + np.arange(shape[1])[None, :] > sum(shape) // 3).astype(int)
    labels, _ = run(full)
    np.testing.assert_array_equal(labels, full)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**31), st.integers(2, 40), st.integers(2, 40), st.sampled_from([2, 4, 8]))
def test_neighbours_with_different_labels_are_both_evaluated(seed, rows, columns, coarse):
    rng = np.random.default_rng(seed)
    full = np.repeat(np.repeat(rng.integers(0, 3, (8, 8)), 5, 0), 5, 1)[:rows, :columns]
    labels, known = run(full, coarse)
    for axis in (0, 1):
        n = full.shape[axis]
        first, second = (np.take(labels, range(k, n - 1 + k), axis) for k in (0, 1))
        both = np.take(known, range(n - 1), axis) & np.take(known, range(1, n), axis)
        assert both[first != second].all()
