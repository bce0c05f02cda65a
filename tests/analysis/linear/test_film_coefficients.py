"""Coefficients of each film against the linearised machine itself, in SI, and ROSS's arguments made of them."""

import numpy as np
import pytest

import whirlmap
from whirlmap.analysis.linear.film_coefficients import film_coefficients
from whirlmap.analysis.linear.ross_bearing import ross_bearing
from whirlmap.errors import RangeError
from whirlmap.films.linear import linear_film

#: Axes in which the shaft's own deflection is measured: journal, rotor centre, and the shaft's stiffness over K_p.
JOURNALS = {"1": (("u1x", "u1y"), ("xp", "yp"), "K_p", "j_p"), "2": (("u2x", "u2y"), ("xg", "yg"), "K_g", "j_g")}


def block(system, J, rows, columns):
    """Part of a Jacobian, by names of states."""
    return J[np.ix_(*([system.states.index(n) for n in names] for names in (rows, columns)))]


@pytest.mark.parametrize(
    ("case", "changes"),
    [
        ("gear-psfd/machine", {"arc": "fixed"}),
        ("gear-psfd/machine", {"arc": "positive"}),
        ("gear-psfd/machine", {"arc": "fixed", "psi": 0.1, "speed": "9000 rpm"}),
        ("gear-psfd/reference", {}),
        ("machines/turbo-gearbox", {"arc": "fixed"}),
        ("machines/turbo-gearbox", {"T_p": "60 N*m"}),
    ],
)
def test_coefficients_are_those_of_the_whole_machine_in_newtons(case, changes):
    """Massless journals: C u' = -K u + (K_shaft/2) (rotor - bearing - u), so the Jacobian's rows give C and K."""
    system = whirlmap.load(case, **changes)
    q = {n: given.value for n, given in system.machine.inputs.items()}
    clock = float(system.values["s"]) * np.sqrt(q["K_p"] / q["m_p"])
    J = whirlmap.linear_analysis(system).jacobian
    found = film_coefficients(system)
    assert set(found) == {"1", "2"}
    tolerance = 1e-4 if system.model.switches["arc"] == "positive" else 1e-6  # its table has kinks beside the equilibrium
    for name, (u, rotor, shaft, _) in JOURNALS.items():
        half = q[shaft] / 2 * np.eye(2)
        C = half @ np.linalg.inv(block(system, J, u, rotor) * clock)
        K = -C @ block(system, J, u, u) * clock - half
        film = found[name]
        np.testing.assert_allclose(film.W_c_omega * film.C, C, atol=tolerance * np.abs(C).max())
        np.testing.assert_allclose(film.W_c * film.K, K, atol=tolerance * np.abs(K).max())


def test_films_carry_what_their_shafts_pull():
    """Unit of force K_p c: the load of a film is half of its shaft's deflection times K/K_p."""
    system = whirlmap.load("machines/turbo-gearbox")
    q = dict(zip(system.states, whirlmap.linear_analysis(system).equilibrium, strict=True))
    found = film_coefficients(system)
    for name, kappa, (r, h) in (("1", 1.0, ("p", "1")), ("2", float(system.values["kappa_g"]), ("g", "2"))):
        bent = [q[f"{a}{r}"] - q[f"{a}{h}"] - q[f"u{name}{a}"] for a in "xy"]
        assert found[name].load == pytest.approx(kappa * np.hypot(*bent) / 2, rel=1e-6)


def test_the_rigid_rotor_has_them_on_its_own_mass():
    """The rigid rotor's Jacobian is -K/(m omega^2), -C/(m omega) with m = M/2 at each bearing."""
    system = whirlmap.load("machines/jeffcott-rig", rotor="rigid", arc="fixed")
    M, g, c = (system.machine.inputs[name].value for name in ("M", "g", "c"))
    omega = system.values["s"] * np.sqrt(g / c)
    J, film = whirlmap.linear_analysis(system).jacobian, film_coefficients(system)["1"]
    np.testing.assert_allclose(film.W_c * film.K, -J[2:, :2] * M / 2 * omega**2, rtol=1e-6)
    np.testing.assert_allclose(film.W_c_omega * film.C, -J[2:, 2:] * M / 2 * omega, rtol=1e-6)
    assert film.load == pytest.approx(1.0, rel=1e-9)  # W itself


def test_a_case_without_dimensions_has_them_in_its_load():
    film = film_coefficients(whirlmap.load("jeffcott"))["1"]
    assert np.isnan([film.W_c, film.W_c_omega]).all()
    turn = np.array([[0.0, -1.0], [1.0, 0.0]])  # the load is -y
    np.testing.assert_allclose(turn @ film.K @ turn.T, linear_film(0.3, 0.0).K, rtol=1e-6)


def test_axes_are_turned_from_the_load_to_horizontal_and_up():
    """The load points down: the film's x is -y here and its y is x."""
    system = whirlmap.load("machines/jeffcott-rig")
    named = ross_bearing(system)
    u = whirlmap.linear_analysis(system).equilibrium[:2]
    given = system.machine.inputs
    film, scale = linear_film(np.hypot(*u), 0.0), given["M"].value * given["g"].value / 2 / given["c"].value
    expected = {"kyy": film.K[0, 0], "kyx": -film.K[0, 1], "kxy": -film.K[1, 0], "kxx": film.K[1, 1]}
    for key, value in expected.items():
        assert named[key] == pytest.approx(scale * value, rel=1e-6)
    assert set(named) == {a + b for a in "kc" for b in ("xx", "xy", "yx", "yy")}


@pytest.mark.parametrize(
    ("case", "changes", "film", "words"),
    [
        ("jeffcott", {}, "1", "dimensional inputs"),
        ("machines/jeffcott-rig", {}, "2", "no film '2'.*expected one of: 1"),
        ("gear-psfd/literal", {}, "1", "no film '1'.*none"),
        ("machines/aero-damper", {}, "1", "none"),
    ],
)
def test_systems_without_such_a_bearing_are_refused(case, changes, film, words):
    with pytest.raises(RangeError, match=words):
        ross_bearing(whirlmap.load(case, **changes), film)
