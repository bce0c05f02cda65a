"""Every method satisfies its order conditions, and shows its order on a run."""

from functools import cache
from math import log2

import numpy as np
import pytest

from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.system import System
from whirlmap.kernels.methods import METHODS, Method
from whirlmap.models import family


@cache
def trees(order):
    """All rooted trees with that many vertices, each the sorted tuple of its root's branches."""
    if order == 1:
        return ((),)
    found = set()

    def grow(left, largest, branches):
        if left == 0:
            found.add(tuple(sorted(branches)))
        for size in range(min(left, largest), 0, -1):
            for tree in trees(size):
                grow(left - size, size, (*branches, tree))

    grow(order - 1, order - 1, ())
    return tuple(sorted(found))


def vertices(tree):
    return 1 + sum(vertices(branch) for branch in tree)


def density(tree):
    product = vertices(tree)
    for branch in tree:
        product *= density(branch)
    return product


def residuals(method, order):
    """Residuals b . Phi(t) - 1/gamma(t) of all trees of one order (Butcher's conditions)."""
    a = np.zeros((method.stages, method.stages))
    for i, row in enumerate(method.a):
        a[i, : len(row)] = [float(x) for x in row]
    b = np.array([float(x) for x in method.b])

    def weights(tree):
        out = np.ones(method.stages)
        for branch in tree:
            out = out * (a @ weights(branch))
        return out

    return np.array([b @ weights(tree) - 1 / density(tree) for tree in trees(order)])


def test_trees_are_counted_right():
    assert [len(trees(n)) for n in range(1, 9)] == [1, 1, 2, 4, 9, 20, 48, 115]


@pytest.mark.parametrize("name", METHODS)
def test_order_conditions(name):
    method = METHODS[name]
    for order in range(1, method.order + 1):
        assert np.abs(residuals(method, order)).max() < 1e-13, order  # rounding of coefficients up to 43
    assert np.abs(residuals(method, method.order + 1)).max() > 1e-8  # and not one order more
    for row, c in zip(method.a, method.c, strict=True):
        assert abs(sum(float(x) for x in row) - float(c)) < 1e-14


@pytest.mark.parametrize(("name", "coarse"), [("rk4", 128), ("tsit5", 128), ("dop853", 20)])
def test_observed_order(name, coarse):
    """Duffing's oscillator over two periods, against the eighth order with many steps."""
    system = System(family("duffing").model(), {"delta": 0.1, "alpha": -1, "beta": 1, "gamma": 0.3, "omega": 1.2})
    x = np.array([[0.7], [0.3]])

    def end(steps, method=METHODS[name]):
        e = Ensemble(system.model, system.vector[:, None], x, orders=system.orders, steps=steps, method=method)
        e.advance(2)
        return e.x[:, 0]

    exact = end(200, METHODS["dop853"])
    errors = [np.abs(end(n) - exact).max() for n in (coarse, 2 * coarse)]
    assert 1e-13 < errors[1] < errors[0] < 1e-2  # neither rounding nor too coarse to have an order
    assert log2(errors[0] / errors[1]) == pytest.approx(METHODS[name].order, abs=0.55)


@pytest.mark.parametrize("method", METHODS.values(), ids=METHODS)
def test_what_is_integrated_twice_takes_the_square_of_the_coefficients(method):
    a = np.array([[float(x) for x in (*row, *[0] * (method.stages - len(row)))] for row in (*method.a, method.b)])
    nystroem = np.array([[float(x) for x in (*row, *[0] * (method.stages - len(row)))] for row in method.nystroem])
    np.testing.assert_allclose(nystroem, a @ a[:-1], rtol=0, atol=1e-13)
    assert np.abs(nystroem[nystroem != 0]).min() > 1e-5  # what is left of zeros is gone


@pytest.mark.parametrize("nystroem", [False, True])
@pytest.mark.parametrize("method", METHODS.values(), ids=METHODS)
def test_slopes_that_are_still_needed_share_no_slot(method, nystroem):
    slots = method.slope_slots(nystroem=nystroem)
    tables = ((*method.a, method.b), *([method.nystroem] if nystroem else []))
    for i in range(method.stages):  # while stage i is computed, and until the step ends
        needed = [j for j in range(i) if any(row[j] for table in tables for row in table[i:] if j < len(row))]
        assert len({slots[j] for j in needed} | {slots[i]}) == len(needed) + 1


KUTTA = Method("kutta3", 3, a=((), (0.5,), (-1, 2)), b=(1 / 6, 2 / 3, 1 / 6), c=(0, 0.5, 1), source="")


@pytest.mark.parametrize("method", [KUTTA, *METHODS.values()], ids=lambda m: m.name)
@pytest.mark.parametrize("tangents", [0, 1, 2])
def test_steps_are_the_methods_polynomial_of_a_linear_system(method, tangents):
    """Stages are combined in pairs: here also of a method that has three. The state is its own tangent vector."""
    system = System(family("duffing").model(), {"delta": 0.3, "alpha": 2, "beta": 0, "gamma": 0, "omega": 3.0})
    x, steps = np.array([0.7, 0.4]), 5
    z = np.array([[0.0, 1.0], [-2.0, -0.3]]) * system.period / steps
    slopes = []  # of the stages, as matrices
    for row in method.a:
        slopes.append(z @ (np.eye(2) + sum((float(w) * k for w, k in zip(row, slopes, strict=True)), np.zeros((2, 2)))))
    one = np.eye(2) + sum(float(w) * k for w, k in zip(method.b, slopes, strict=True))
    expected = np.linalg.matrix_power(one, steps) @ x
    e = Ensemble(system.model, system.vector[:, None], x[:, None], orders=system.orders, steps=steps, method=method,
                 tangents=tangents, sizes=np.ones((2, 1)))  # fmt: skip
    if tangents:
        e._y[2:4, 0] = x
    growth = e.advance(1).growth
    np.testing.assert_allclose(e.x[:, 0], expected, rtol=0, atol=1e-14)
    if tangents:
        assert growth[0, 0, 0] == pytest.approx(np.log(np.linalg.norm(expected)), abs=1e-13)
        np.testing.assert_allclose(e._y[2:4, 0], expected / np.linalg.norm(expected), rtol=0, atol=1e-13)
