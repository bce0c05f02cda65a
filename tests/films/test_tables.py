"""The compiled tables against the reference film, and the functions that they are fitted to."""

from functools import cache

import numpy as np
import pytest

import whirlmap
from whirlmap.equations import Model, Parameter, states
from whirlmap.errors import CaseError, RangeError
from whirlmap.films import porous_short, scaled, tables
from whirlmap.films.law import FIXED_ARC, POSITIVE_ARC, film_law
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.system import System
from whirlmap.kernels.lowering.tabulate import entries, reading

PSI = [0.0, 1e-8, 1e-6, 1e-4, 1e-3, 0.1, 1.0, 10.0]


@cache
def film_alone(arc, psi):
    """A journal whose velocity is the film's answer to a load; the load and the sign of the spin are states that rest."""
    ux, uy, qx, qy, sigma = states("ux uy qx qy sigma", "1", "a film by itself")
    p = Parameter("psi", "1", "permeability", at_least=0)
    law = film_law("porous", arc)
    w_x, w_y = law.velocity(ux, uy, qx, qy, p, sigma)
    rates = {ux: w_x, uy: w_y, qx: 0 * ux, qy: 0 * ux, sigma: 0 * ux}
    model = Model(name="film", states=tuple(rates), parameters=(p,), equations=rates, tables=law.tables)
    return System(model, {"psi": psi})


def lane_velocity(arc, psi, ux, uy, qx, qy, sigma=1.0):
    x = np.stack(np.broadcast_arrays(ux, uy, qx, qy, sigma))
    return film_alone(arc, psi).rhs(0.0, x)[:2]


def places(psi, size=4000, seed=3):
    """Journal centres up to the table's end, half of them close to the wall; unit loads, half along u."""
    rng = np.random.default_rng(seed)
    end = (1.0 + scaled.BEYOND * np.cbrt(psi)) * (1.0 - 1e-12) if psi else 1.0 - 1e-5
    near = np.abs(end - 10.0 ** rng.uniform(-5, 0, size))
    eps = np.where(rng.random(size) < 0.5, end * np.sqrt(rng.random(size)), near)
    phi, load = rng.uniform(-np.pi, np.pi, (2, size))
    load[::2] = phi[::2] + 10.0 ** rng.uniform(-4, 0, load[::2].size)
    return eps, eps * np.cos(phi), eps * np.sin(phi), np.cos(load), np.sin(load)


@pytest.mark.parametrize("psi", PSI)
def test_fixed_arc_in_lanes(psi):
    """Velocity under a unit load to 1e-9 everywhere; where the film is thin, also of the small velocity itself."""
    eps, *args = places(psi)
    for sigma in (1.0, -1.0):
        expected = np.array(porous_short.fixed_arc_velocity(*args, psi, sigma))
        error = np.hypot(*(lane_velocity("fixed", psi, *args, sigma) - expected))
        assert error.max() < 1e-9
        assert (error / np.hypot(*expected))[eps < 0.999].max() < 1e-9


@pytest.mark.parametrize("psi", PSI)
def test_fixed_arc_matrix_in_lanes(psi):
    """G, B and D that the lane's mobilities stand for, to 1e-9 of max(G, D), up to an eccentricity of 0.999."""
    eps = np.concatenate([1.0 - 10.0 ** np.linspace(-3.0, 0.0, 2001), np.linspace(0.0, 0.999, 1000)])
    (m_rr, m_rt), (_, m_tt) = (lane_velocity("fixed", psi, eps, 0.0, *q) for q in ((1.0, 0.0), (0.0, 1.0)))
    det = m_rr * m_tt - m_rt**2
    G, B, D = porous_short.film_integrals(eps, psi)
    error = np.max(np.abs(np.stack([m_tt / det - G, -m_rt / det - B, m_rr / det - D])), axis=0)
    assert (error / np.maximum(G, D)).max() < 1e-9


@pytest.mark.parametrize(
    "psi", [p if k in (0, len(PSI) // 2) else pytest.param(p, marks=pytest.mark.slow) for k, p in enumerate(PSI)]
)
def test_positive_arc_in_lanes(psi):
    """As for the fixed arc; the relative error is that of the interpolated mobility where k is smallest."""
    eps, *args = places(psi)
    expected = np.array(porous_short.positive_arc_velocity(*args, psi))
    error = np.hypot(*(lane_velocity("positive", psi, *args) - expected))
    assert error.max() < 1e-9
    assert (error / np.hypot(*expected))[eps < 0.999].max() < (5e-8 if psi < 1e-6 else 5e-9)


@pytest.mark.parametrize("psi", PSI)
def test_positive_arc_of_the_reference_kernel(psi):
    """The reference kernel solves the film, and reads nothing that was fitted."""
    eps, *args = places(psi)
    args = [a[eps < 0.999][:500] for a in args]
    expected = np.array(porous_short.positive_arc_velocity(*args, psi))
    x = np.stack([*args, np.ones(500)])
    got = film_alone("positive", psi).reference_rhs(0.0, x)[:2]
    assert np.hypot(*(got - expected)).max() < 1e-12


@pytest.mark.parametrize("psi", PSI)
def test_smooth_functions_are_of_order_one(psi):
    """No power of the gap is left: that is what panels can interpolate."""
    (near, behind), (start, end) = scaled.positive_arc_range(psi)
    s, z = np.linspace(near, behind, 201)[:, None], np.linspace(start, end, 200)
    F, H = scaled.positive_arc_smooth(psi, s, z)
    assert F.min() > 0.0 and H.min() > 0.0 and max(F.max(), H.max()) < 30.0


def test_fixed_mobilities_have_no_cancellation_at_the_centre():
    """Limits eps -> 0 of (G-D)/eps^2, from int sin^4 = 3 pi/8, and of B/eps, from int sin^3 = 4/3."""
    psi = 1e-3
    radial, excess, coupling = tables.fixed_arc(psi, [0.0, 1e-30, 1e-16])
    D = 0.5 * np.pi / (1 + psi)
    G_D = (np.pi / 8) * (18 / (1 + psi) ** 3 - 6 / (1 + psi) ** 2)
    np.testing.assert_allclose(radial, 1 / D, rtol=1e-12)
    np.testing.assert_allclose(excess, G_D / D**2, rtol=1e-12)
    np.testing.assert_allclose(coupling, -2 / (1 + psi) ** 2 / D**2, rtol=1e-12)


@pytest.mark.parametrize("psi", PSI)
def test_cells_ascend_and_cover_the_film(psi):
    far = 1.0 + scaled.BEYOND * np.cbrt(psi)
    (e2,), (xi, z) = FIXED_ARC.edges(psi), POSITIVE_ARC.edges(psi)
    for edges in (e2, xi, z):
        assert (np.diff(edges) > 0).all() and edges.size < 170
    short = 0.0 if psi else 1e-6  # the plain film's last cells end before the wall, where there is none
    assert e2[0] == 0.0 and e2[-1] == pytest.approx(far**2, abs=1e-14 + short)
    assert (xi[0], xi[-1]) == pytest.approx((-far, far), abs=1e-14 + short)


def test_neighbouring_cells_of_the_fixed_arc_join():
    """The rates of an orbit that passes an edge must not jump."""
    (edges,) = FIXED_ARC.edges(0.1)
    eps = np.sqrt(edges[1:-1])
    below, above = (lane_velocity("fixed", 0.1, eps * (1 + d), 0.0, 0.6, 0.8) for d in (-1e-15, 1e-15))
    np.testing.assert_allclose(below, above, rtol=0, atol=1e-13)


@pytest.mark.parametrize("arc", ["fixed", "positive"])
def test_a_lane_that_moves_is_read_in_its_own_cell(arc):
    """A run keeps the cells of the stage before; cut into pieces it begins by finding them, and has the same bits."""
    x = np.stack([np.linspace(0.0, 0.5, 32), np.full(32, 0.1), np.full(32, 0.4), np.full(32, 0.3), np.ones(32)])
    whole, cut = (
        Ensemble(film_alone(arc, 0.1).model, np.full((1, 32), 0.1), x.copy(), orders=(), steps=4) for _ in range(2)
    )
    whole.advance(8)
    for _ in range(8):
        cut.advance(1)
    assert np.abs(whole.x[0] - x[0]).min() > 0.2  # several cells
    np.testing.assert_array_equal(whole.x, cut.x)


@pytest.mark.parametrize("arc", ["fixed", "positive"])
@pytest.mark.parametrize("psi", [1e-4, 0.1])
def test_reading_a_table_outside_of_the_kernels_gives_what_it_is_fitted_to(arc, psi):
    table, rng = {"fixed": FIXED_ARC, "positive": POSITIVE_ARC}[arc], np.random.default_rng(1)
    inside = [rng.uniform(e[0], e[-1], (40, 3)) for e in table.edges(psi)]
    read, fitted = reading(table, psi, *inside), table.samples(psi, *inside)
    assert len(read) == len(table.outputs)
    for a, b in zip(read, fitted, strict=True):
        assert a.shape == (40, 3)
        np.testing.assert_allclose(a, b, rtol=1e-8, atol=1e-10 * np.abs(b).max())


def test_no_load_and_the_centre():
    u, q = ([0.4, 0.0, 0.0], [0.1, 0.0, 0.0]), ([0.0, 0.0, 1.0], [0.0, 0.0, 0.0])
    expected = ([0.0, 0.0, 2.2 / np.pi], [0.0, 0.0, 0.0])
    for arc in ("fixed", "positive"):
        np.testing.assert_allclose(lane_velocity(arc, 0.1, *u, *q), expected, atol=1e-10)


def test_beyond_the_film_there_is_no_mobility():
    with pytest.raises(RangeError, match="undefined"):
        tables.fixed_arc(1e-3, [0.5, 1.2])
    with pytest.raises(RangeError, match="undefined"):
        tables.positive_arc(1e-3, [0.5, 0.99], 1.1)
    assert np.isnan(lane_velocity("positive", 0.0, 1.1, 0.0, 1.0, 0.0)).any()


def test_a_permeability_that_drowns_in_rounding_is_refused():
    with pytest.raises(CaseError, match=r"psi = 1e-13 is too small .* expected 0 .* or at least 1e-12"):
        whirlmap.load("gear-psfd/reference", psi=1e-13)
    for edges in (FIXED_ARC.edges, POSITIVE_ARC.edges):
        edges(1e-12)
        with pytest.raises(RangeError, match="too small for a table"):
            edges(9e-13)


def test_a_table_says_how_it_is_laid_out():
    table = entries(POSITIVE_ARC, 0.1)
    cells = [e.size - 1 for e in POSITIVE_ARC.edges(0.1)]
    assert list(table[:2]) == cells
    assert table.size == 2 + sum(cells) - 2 + cells[0] * cells[1] * (6 + 2 * 28)
