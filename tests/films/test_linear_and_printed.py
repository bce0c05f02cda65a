"""Linear coefficients, the oil-whip threshold, and the film as printed."""

import numpy as np
import pytest
from scipy.optimize import brentq

from whirlmap.errors import RangeError
from whirlmap.films import printed
from whirlmap.films.linear import linear_film, whip_threshold, whirl_ratio_squared
from whirlmap.films.porous_short import film_force


def test_oil_whip_table(validate):
    """Own values of known_values.md, plain film: attitude, whirl ratio, threshold."""
    rows = [(0.1, 82.708, 0.50294, 2.7413), (0.3, 68.178, 0.51942, 2.6058), (0.5, 53.680, 0.51464, 2.5417)]
    for eps, attitude, ratio, p_s in rows:
        film = linear_film(eps, 0.0)
        found = [np.degrees(film.attitude), np.sqrt(whirl_ratio_squared(film)), float(whip_threshold(eps, 0.0))]
        validate(f"plain short bearing, eccentricity {eps:g}: attitude in degrees, whirl ratio, threshold omega sqrt(c/g)",
                 found, [attitude, ratio, p_s], tier="independent",
                 source="closed-form film integrals and Routh-Hurwitz, other code",
                 within=[6e-4, 6e-6, 6e-5])  # fmt: skip


def test_oil_whip_limits(validate):
    light = [float(whip_threshold(1e-5, 0.0)), float(np.sqrt(whirl_ratio_squared(linear_film(1e-5, 0.1))))]
    validate("short bearing without load: threshold omega sqrt(c/g) and whirl ratio", light,
             [2.0 * np.sqrt(6.0 / np.pi), 0.5], tier="exact", source="limit of small eccentricity", rel=1e-8)  # fmt: skip
    end = brentq(lambda eps: float(whirl_ratio_squared(linear_film(eps, 0.0))), 0.7, 0.8)
    assert end == pytest.approx(0.75603, abs=5e-6)
    assert np.isinf(whip_threshold([0.7561, 0.9], 0.0)).all()


def test_coefficients_at_one_half(validate):
    film = linear_film(0.5, 0.0)
    known = [[2.9233, 3.9766], [-0.8577, 2.2099]], [[6.6148, 2.2450], [2.2450, 3.0539]]
    validate("plain short bearing, eccentricity 0.5: stiffness and damping coefficients", [film.K, film.C], known,
             tier="independent", source="closed-form film integrals, other code", within=6e-5)  # fmt: skip


@pytest.mark.parametrize("arc", ["fixed", "positive"])
@pytest.mark.parametrize(("eps", "psi"), [(0.2, 0.0), (0.5, 1e-3), (0.8, 0.1), (0.95, 1e-4), (0.7, 10.0)])
def test_coefficients_against_differences_of_the_force(arc, eps, psi):
    """Central differences of the full nonlinear force, both arcs."""
    film = linear_film(eps, psi)
    u = eps * np.array([np.cos(film.attitude), np.sin(film.attitude)])

    def force(u, u_dot):
        w = u_dot - 0.5 * np.array([-u[1], u[0]])
        return np.array(film_force(*u, *w, psi, arc=arc)) / film.load

    np.testing.assert_allclose(force(u, np.zeros(2)), [-1.0, 0.0], atol=1e-12)  # carries the load along x
    step = 1e-5 * (1.0 - eps)
    for j, e in enumerate(np.eye(2) * step):
        K = -(force(u + e, np.zeros(2)) - force(u - e, np.zeros(2))) / (2.0 * step)
        C = -(force(u, e) - force(u, -e)) / (2.0 * step)
        scale = max(np.abs(film.K).max(), np.abs(film.C).max())
        # the positive arc's force is C^{1,1} in w only: its central difference is first order in the step
        np.testing.assert_allclose(film.K[:, j], K, atol=2e-5 * scale)
        np.testing.assert_allclose(film.C[:, j], C, atol=2e-5 * scale)


def test_permeability_lowers_the_threshold():
    assert (np.diff(whip_threshold(0.5, [0.0, 1e-3, 0.1, 10.0])) < 0.0).all()


@pytest.mark.parametrize("eps", [0.0, 1.0, np.nan])
def test_linear_film_needs_an_eccentricity_inside(eps):
    with pytest.raises(RangeError):
        linear_film([0.3, eps], 0.1)


def test_printed_film_is_a_linear_damper():
    qx, qy = np.array([0.3, -2.0]), np.array([0.0, 5.0])
    w = printed.velocity(qx, qy, 0.1)
    F = printed.force(*w, 0.1)
    np.testing.assert_allclose(F, (-2.0 * qx, -2.0 * qy), rtol=1e-14)  # F = -2 M w and M w = q


def test_printed_film_exceeds_the_porous_film_by_the_factor_of_the_audit():
    """Audit sec. 0.1: (1 + psi)/psi at the centre, x11 at psi = 0.1."""
    for psi, factor in ((1e-4, 10001.0), (1e-3, 1001.0), (0.1, 11.0)):
        ratio = printed.force(0.2, 0.1, psi)[0] / film_force(0.0, 0.0, 0.2, 0.1, psi, arc="fixed")[0]
        assert ratio == pytest.approx(factor, rel=1e-12)


def test_printed_film_without_permeability():
    np.testing.assert_array_equal(printed.velocity(0.3, 0.4, 0.0), (0.0, 0.0))
    with pytest.raises(RangeError, match="psi = 0"):
        printed.force(0.3, 0.4, 0.0)
    with pytest.raises(RangeError, match="permeability"):
        printed.velocity(0.3, 0.4, -1e-3)
