"""Scaled mobilities and their tables against the reference film."""

import numpy as np
import pytest

from whirlmap.errors import RangeError
from whirlmap.films import porous_short, scaled, tables

PSI = [0.0, 1e-8, 1e-4, 1e-3, 0.1, 10.0]


def states(psi, size=4000, seed=3):
    """Journal centres up to the table's end, half of them close to the wall; unit loads, half along u."""
    rng = np.random.default_rng(seed)
    end = (1.0 + scaled.BEYOND * np.cbrt(psi)) * (1.0 - 1e-12) if psi else 1.0 - 1e-5
    near = np.abs(end - 10.0 ** rng.uniform(-5, 0, size))
    eps = np.where(rng.random(size) < 0.5, end * np.sqrt(rng.random(size)), near)
    phi, load = rng.uniform(-np.pi, np.pi, (2, size))
    load[::2] = phi[::2] + 10.0 ** rng.uniform(-4, 0, load[::2].size)
    return eps, eps * np.cos(phi), eps * np.sin(phi), np.cos(load), np.sin(load)


@pytest.mark.parametrize("psi", PSI)
def test_fixed_table(psi):
    eps, *args = states(psi)
    table = tables.tabulate_fixed(psi)
    for sigma in (1.0, -1.0):
        expected = np.array(porous_short.fixed_arc_velocity(*args, psi, sigma))
        error = np.hypot(*(np.array(tables.fixed_arc_velocity(table, *args, psi, sigma)) - expected))
        speed = np.hypot(*expected)
        assert error.max() < 1e-9
        assert (error / speed)[eps < 0.99].max() < 1e-8  # on the wall w is of order psi^(5/6)
        assert (error / speed).max() < (3e-4 if 0.0 < psi < 1e-6 else 1e-6)


@pytest.mark.parametrize("psi", PSI)
def test_positive_table(psi):
    eps, *args = states(psi)
    expected = np.array(porous_short.positive_arc_velocity(*args, psi))
    table = tables.tabulate_positive(psi)
    assert table.coefficients.shape == (64, 32, 6, 6, 2)
    error = np.hypot(*(np.array(tables.positive_arc_velocity(table, *args, psi)) - expected))
    speed = np.hypot(*expected)
    assert error.max() < 1e-9
    assert (error / speed)[eps < 0.99].max() < 1e-8
    assert (error / speed).max() < (1e-4 if 0.0 < psi < 1e-6 else 1e-6)


@pytest.mark.parametrize("psi", PSI)
def test_coordinates_fill_the_unit_square(psi):
    eps, ux, uy, qx, qy = states(psi)
    s, *_ = scaled.fixed_arc_coordinates(eps**2, psi)
    wall, centre = scaled.fixed_arc_range(psi)
    assert ((s >= wall - 1e-9) & (s <= centre + 1e-9)).all()
    xi, eta = ux * qx + uy * qy, uy * qx - ux * qy
    s, z, _, _ = scaled.positive_arc_coordinates(xi, eta**2, psi)
    (near, behind), (start, end) = scaled.positive_arc_range(psi)
    assert ((s >= near - 1e-9) & (s <= behind + 1e-9) & (z >= start) & (z <= end + 1e-9)).all()


@pytest.mark.parametrize("psi", PSI)
def test_smooth_functions_are_of_order_one(psi):
    """No power of the gap is left: that is what makes a uniform table possible."""
    x = np.linspace(0.0, 1.0, 201)
    fD, fH, fB = tables.fixed_arc_smooth(psi, x)
    F, H = tables.positive_arc_smooth(psi, x[:, None], x[:-1])
    assert fD.min() > 0.0 and F.min() > 0.0 and H.min() > 0.0 and fB.max() < 0.0
    assert max(fD.max(), np.abs(fH).max(), np.abs(fB).max(), F.max(), H.max()) < 30.0


def test_even_integrals_have_no_cancellation_at_the_centre():
    """Limits eps -> 0 of (G-D)/eps^2, from int sin^4 = 3 pi/8, and of B/eps, from int sin^3 = 4/3."""
    psi = 1e-3
    s, T52, T32, T2 = scaled.fixed_arc_coordinates(np.array([0.0, 1e-30, 1e-16]), psi)
    fD, fH, fB = scaled.fixed_arc_scaled(s, psi)
    D = 0.5 * np.pi / (1 + psi)
    G_D = (np.pi / 8) * (18 / (1 + psi) ** 3 - 6 / (1 + psi) ** 2)
    np.testing.assert_allclose(T52 * fD, 1 / D, rtol=1e-12)
    np.testing.assert_allclose(T32 * fH, G_D / D**2, rtol=1e-12)
    np.testing.assert_allclose(T2 * fB, -2 / (1 + psi) ** 2 / D**2, rtol=1e-12)


def test_table_is_continuous_and_even_across_cells():
    table = tables.tabulate_positive(1e-3, cells=(8, 8), degree=3)
    edge, y = np.full(50, 3 / 8), np.linspace(0.01, 0.99, 50)
    for args in ((edge, y), (y, edge)):
        below = [np.nextafter(a, 0) if a is edge else a for a in args]
        np.testing.assert_allclose(table(*below), table(*args), rtol=1e-9)


@pytest.mark.parametrize(("psi", "eps"), [(0.0, 1.0), (1e-3, 1.04), (0.1, np.nan)])
def test_outside_the_table_is_an_error(psi, eps):
    with pytest.raises(RangeError, match="outside the table"):
        tables.fixed_arc_velocity(tables.tabulate_fixed(psi), [0.1, eps], 0.0, 1.0, 0.0, psi)
    with pytest.raises(RangeError, match="outside the table"):
        tables.positive_arc_velocity(tables.tabulate_positive(psi), [0.1, eps], 0.0, 1.0, 0.0, psi)


def test_no_load_and_the_centre():
    fixed, positive = tables.tabulate_fixed(0.1), tables.tabulate_positive(0.1)
    u, q = ([0.4, 0.0, 0.0], [0.1, 0.0, 0.0]), ([0.0, 0.0, 1.0], [0.0, 0.0, 0.0])
    expected = ([0.0, 0.0, 2.2 / np.pi], [0.0, 0.0, 0.0])
    np.testing.assert_allclose(tables.fixed_arc_velocity(fixed, *u, *q, 0.1), expected, atol=1e-10)
    np.testing.assert_allclose(tables.positive_arc_velocity(positive, *u, *q, 0.1), expected, atol=1e-9)
