"""Squeeze-film dampers in machines from parts, with and without a squirrel cage: circular orbits in closed form, sag."""

import numpy as np
import pytest
from scipy.optimize import brentq
from tests.machines.test_coefficients import loaded

import whirlmap
from whirlmap.analysis.linear.linearisation import NotLinearError

MU, R, L, C, M, K, D, CAGE, U = 0.01, 0.06, 0.025, 1e-4, 40.0, 2e7, 200.0, 8e6, 800e-6
MACHINE = f"""model = "machine"
[operation]
speed = "SPEED rad/s"
g = "0 m/s^2"
[lubricant]
mu = "{MU} Pa*s"
[[shaft]]
name = "rotor"
m = "{M} kg"
K = "{K} N/m"
C = "{D} N*s/m"
[[unbalance]]
name = "u"
shaft = "rotor"
U = "{U} kg*m"
[[bearing]]
name = "sfd"
shaft = "rotor"
kind = "damper"
R = "{R} m"
L = "{L} m"
c = "{C} m"
two_alike = 2
"""


def film(eps, w, R=R, L=L, c=C, mu=MU):
    """Stiffness and damping of a cavitated (pi) short film at a circular centred orbit, over the eccentricity, e = eps c.

    San Andres, Modern Lubrication Theory: K = 2 mu R L^3 w eps/(c^3 (1 - eps^2)^2), C = pi mu R L^3/(2 c^3 (1 - eps^2)^1.5).
    """
    size = mu * R * L**3 / c**3
    return 2 * size * w * eps / (1 - eps**2) ** 2, np.pi * size / (2 * (1 - eps**2) ** 1.5)


@pytest.mark.parametrize(("cage", "w"), [(CAGE, 250.0), (CAGE, 500.0), (0.0, 500.0)])
def test_circular_orbits_are_those_of_the_textbook(tmp_path, cage, w):
    """K (r - u) = 2 (k_c + K_film + i w C_film) u,  (K - m w^2 + i w C) r - K u = U w^2, with |u| = eps c."""

    def apart(eps):
        k, c = film(eps, w)
        held = 2 * (cage + k + 1j * w * c)
        r_over_u = 1 + held / K
        return abs((K - M * w**2 + 1j * w * D) * r_over_u - K) * eps * C - U * w**2

    eps = brentq(apart, 1e-4, 0.95)
    text = MACHINE.replace("SPEED", str(w)) + (f'k_c = "{cage} N/m"\n' if cage else "")
    system = loaded(tmp_path, text)
    ds = whirlmap.simulate(system, transient=400, periods=1)
    ours = ds["outputs"].sel(output="eps_sfd").values
    assert ours == pytest.approx(np.full(ours.shape, eps), rel=1e-5)


def test_the_ring_sags_in_its_cage(tmp_path):
    """At rest the film of a ring that does not turn carries nothing: the cage has the weight."""
    text = MACHINE.replace("SPEED", "250").replace('g = "0 m/s^2"', 'g = "9.81 m/s^2"') + f'k_c = "{CAGE} N/m"\n'
    system = loaded(tmp_path, text)
    ds = whirlmap.simulate(system, periods=1)
    x0 = ds["x"].values[0]
    assert int(ds["start_found"]) == 1
    assert x0[system.states.index("uy_sfd")] == pytest.approx(-M * 9.81 / 2 / CAGE / C, rel=1e-6)
    assert x0[system.states.index("y_rotor")] == pytest.approx(-(M * 9.81 / 2 / CAGE + M * 9.81 / K) / C, rel=1e-6)
    with pytest.raises(NotLinearError, match="film of a damper carries nothing at rest"):
        whirlmap.linear_analysis(system)


def test_a_film_without_a_cage_holds_a_shaft_up_by_its_motion(tmp_path):
    """Weight and unbalance: the ring lifts off the bottom, on a film that carries by squeezing alone."""
    text = MACHINE.replace("SPEED", "500").replace('g = "0 m/s^2"', 'g = "9.81 m/s^2"')
    ds = whirlmap.simulate(loaded(tmp_path, text.replace(f"{U} kg*m", "3e-3 kg*m")), transient=300, periods=4)
    u = ds["x"].sel(state="uy_sfd").values
    assert int(ds["status"]) == 0
    assert u.mean() > -0.9 and ds["outputs"].sel(output="eps_sfd").values.max() < 0.99
