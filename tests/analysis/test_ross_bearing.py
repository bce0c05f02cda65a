"""Coefficients in SI against the linearised model itself, and their axes."""

import numpy as np
import pytest

import whirlmap
from whirlmap.analysis.ross import film_coefficients, ross_bearing
from whirlmap.errors import RangeError
from whirlmap.films.linear import linear_film


def test_coefficients_are_those_of_the_linearised_rotor_in_newtons():
    """The rigid rotor's Jacobian is -K/(m omega^2), -C/(m omega) with m = M/2 at each bearing, in the model's axes."""
    system = whirlmap.load("machines/jeffcott-rig", rotor="rigid", arc="fixed")
    given = system.details.inputs
    M, g, c = (given[name].value for name in ("M", "g", "c"))
    omega = system.values["s"] * np.sqrt(g / c)
    J = whirlmap.linear_analysis(system).jacobian
    K, C = film_coefficients(system)
    np.testing.assert_allclose(K, -J[2:, :2] * M / 2 * omega**2, rtol=1e-6)
    np.testing.assert_allclose(C, -J[2:, 2:] * M / 2 * omega, rtol=1e-6)


def test_axes_are_turned_from_the_load_to_horizontal_and_up():
    """The load points down: the film's x is -y here and its y is x."""
    system = whirlmap.load("machines/jeffcott-rig")
    named = ross_bearing(system)
    u = whirlmap.linear_analysis(system).equilibrium[:2]
    given = system.details.inputs
    film, scale = linear_film(np.hypot(*u), 0.0), given["M"].value * given["g"].value / 2 / given["c"].value
    expected = {"kyy": film.K[0, 0], "kyx": -film.K[0, 1], "kxy": -film.K[1, 0], "kxx": film.K[1, 1]}
    for key, value in expected.items():
        assert named[key] == pytest.approx(scale * value, rel=1e-6)
    assert set(named) == {a + b for a in "kc" for b in ("xx", "xy", "yx", "yy")}


@pytest.mark.parametrize("case", ["jeffcott", "gear-psfd/machine"])
def test_systems_without_such_a_bearing_are_refused(case):
    with pytest.raises(RangeError, match="dimensional Jeffcott rotor"):
        ross_bearing(whirlmap.load(case))
