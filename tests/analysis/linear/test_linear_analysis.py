"""The linearised whole system against the closed oil-whip results of the rigid rotor."""

import numpy as np
import pytest

import whirlmap
from whirlmap.analysis.linear import linearisation
from whirlmap.analysis.linear.linearisation import NotLinearError
from whirlmap.analysis.linear.truncation import truncation
from whirlmap.equations import Model, State, when
from whirlmap.errors import RangeError
from whirlmap.films.linear import linear_film, whip_threshold, whirl_ratio_squared
from whirlmap.integrate.system import System


def rotor(eps, s):
    """Return the rigid rotor whose static eccentricity is eps at the speed s."""
    return whirlmap.load("jeffcott", s=s, Gamma=1 / (s * float(linear_film(eps, 0.0).load)))


@pytest.mark.parametrize(("eps", "expected"), [(0.1, 2.7413), (0.3, 2.6058), (0.5, 2.5417), (1e-3, 2.763953)])
def test_threshold_is_the_known_one(eps, expected, validate):
    found = whirlmap.stability_threshold(rotor(eps, expected), "s", (0.9 * expected, 1.1 * expected))
    validate(f"rigid rotor, eccentricity {eps:g}: stability threshold of the whole system", found, expected,
             tier="independent", source="closed-form film integrals and Routh-Hurwitz, other code", rel=1e-4)  # fmt: skip


@pytest.mark.parametrize("arc", ["fixed", "positive"])
def test_flexible_shaft_lowers_the_threshold_as_springs_in_series(arc, validate):
    eps, k = 0.3, 20.0
    p, nu2 = float(whip_threshold(eps, 0.0)), float(whirl_ratio_squared(linear_film(eps, 0.0)))
    kappa = p**2 * nu2  # the film's stiffness in the whirl; the shaft's k is in series with it
    expected = p / np.sqrt(1 + kappa / k)
    gamma = 1 / (expected * float(linear_film(eps, 0.0).load))
    flexible = whirlmap.load("jeffcott", rotor="flexible", arc=arc, s=expected, Gamma=gamma, k=k, xi=0, b=0)
    found = whirlmap.stability_threshold(flexible, "s", (0.9 * expected, 1.1 * expected))
    validate(f"Jeffcott rotor on a flexible shaft, arc {arc}: stability threshold", found, expected, tier="exact",
             source="film and shaft as springs in series", rel=1e-4)  # fmt: skip


def test_whirl_at_the_threshold_has_the_known_ratio():
    least = whirlmap.linear_analysis(rotor(0.3, 2.6058)).eigenvalues[0]
    assert abs(least.real) < 1e-4
    assert abs(least.imag) == pytest.approx(0.51942, abs=1e-4)


def test_jacobian_is_the_film_of_the_closed_integrals():
    film, s = linear_film(0.5, 0.0), 2.0
    small = whirlmap.linear_analysis(rotor(0.5, s))
    assert np.hypot(*small.equilibrium[:2]) == pytest.approx(0.5, rel=1e-9)
    turn = np.array([[0.0, -1.0], [1.0, 0.0]])  # the film's x is the load's direction, -y of the model
    for block, exact in ((small.jacobian[2:, :2], film.K), (small.jacobian[2:, 2:], film.C)):
        assert -(s**2) * turn @ block @ turn.T == pytest.approx(exact, rel=1e-6)


@pytest.mark.parametrize(("bracket", "words"), [((1.0, 1.5), "is stable"), ((3.5, 4.0), "is unstable"), ((2, 1), "low <")])
def test_bracket_without_a_threshold_is_refused(bracket, words):
    with pytest.raises(RangeError, match=words):
        whirlmap.stability_threshold(rotor(0.3, 2.6058), "s", bracket)


def test_model_without_equilibrium_is_refused():
    with pytest.raises(RangeError, match="no static equilibrium"):
        whirlmap.linear_analysis(whirlmap.load("lorenz"))


def test_the_declared_equilibrium_of_a_damper_is_one():
    from whirlmap.integrate.equilibrium import rest_state
    from whirlmap.kernels.running.reference import reference_rates

    damper = whirlmap.load("machines/aero-damper", speed="9000 rpm")
    rest = np.array(list(rest_state(damper).values()))
    np.testing.assert_allclose(reference_rates(damper.model, forced=False)(0.0, rest, damper.vector), 0.0, atol=1e-12)
    with pytest.raises(NotLinearError, match="no eigenvalues"):
        whirlmap.linear_analysis(damper)


def test_unknown_parameter_is_refused():
    with pytest.raises(RangeError, match="no parameter 'sped'"):
        whirlmap.stability_threshold(rotor(0.3, 2.6), "sped", (2.0, 3.0))


def curved(inside):
    """x' = inside - ..., with a rest at x = 1 and another state that turns the system into one of two."""
    x, y = State("x", "1", "x", start=1.0), State("y", "1", "y", start=1.0)
    u = x - 1
    return System(Model("curved", (x, y), (), {x: inside(u) + (y - 1), y: -(x - 1) - 2 * (y - 1)}, start="equilibrium"), {})


def test_a_slope_that_curves_is_no_kink():
    """A stiff film's slope changes by a tenth of itself over a millionth of the motion, and is what it is at the rest."""
    found = whirlmap.linear_analysis(curved(lambda u: -u + 1e4 * u**2 + 1e11 * u**3))
    assert found.jacobian[0, 0] == pytest.approx(-1, rel=1e-9)
    assert np.sort(found.eigenvalues.imag) == pytest.approx([-np.sqrt(3) / 2, np.sqrt(3) / 2], rel=1e-9)


def test_a_kink_has_the_mean_of_its_slopes():
    found = whirlmap.linear_analysis(curved(lambda u: when(u > 0, -3 * u, -u)))
    assert found.jacobian[0, 0] == pytest.approx(-2, rel=1e-6)


def test_many_modes_of_a_machine_come_near_its_matrices():
    """With all but three modes of a stiff shaft journals are 450 times as fast as it turns, and eigenvalues right."""

    def of(generator, turbine):
        modes = {"shaft.generator_shaft.modes": generator, "shaft.turbine_shaft.modes": turbine}
        found = truncation(whirlmap.load("machines/geared-turbo-set", **modes))
        assert found is not None
        return found

    assert of(8, 8).error.max() < 3e-3
    assert of(10, 10).error.max() < 1e-3 and of(10, 10).fastest > 300


def test_points_linearised_together_or_one_by_one_have_the_same_bits(monkeypatch):
    system = whirlmap.load("gear-psfd/reference")
    values = np.repeat(system.vector[:, None], 5, axis=1) * np.linspace(0.99, 1.01, 5)
    together = linearisation.linearised(system.plain_model(), values)[1]
    monkeypatch.setattr(linearisation, "BYTES", 1)
    assert np.isfinite(together).all()
    np.testing.assert_array_equal(linearisation.linearised(system.plain_model(), values)[1], together)
