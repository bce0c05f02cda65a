"""Start states: the static equilibrium of the whole machine, and what happens where there is none."""

import numpy as np
import pytest
from tests.integrate.rotors import gear_pair, jeffcott

from whirlmap.integrate.equilibrium import start_states
from whirlmap.integrate.system import System
from whirlmap.kernels.running.reference import reference_rates
from whirlmap.models import family


def start(system):
    x, found = start_states(system.model, system.vector[:, None])
    return x[:, 0], bool(found[0])


def residual(system, x):
    return np.max(np.abs(reference_rates(system.plain_model(), forced=False)(0.0, x, system.vector)))


@pytest.mark.parametrize(("s", "psi", "Lambda", "eps_1", "eps_2"), [
    (1.0, 0.0, 25.0, 0.378, 0.492), (3.0, 0.0, 25.0, 0.159, 0.260),  # audit section 3.4
    (1.0, 0.0, 0.0, 0.247, 0.529), (3.0, 0.0, 0.0, 0.093, 0.297), (1.0, 0.1, 0.0, 0.274, 0.620),  # and 6.2
])  # fmt: skip
def test_static_eccentricities_of_the_reference_machine(s, psi, Lambda, eps_1, eps_2):
    system = gear_pair(s, psi, Lambda=Lambda)
    x, found = start(system)
    assert found
    assert np.hypot(x[0], x[1]) == pytest.approx(eps_1, abs=5.01e-4)  # the printed digits
    assert np.hypot(x[2], x[3]) == pytest.approx(eps_2, abs=5.01e-4)
    assert residual(system, x) < 1e-11
    np.testing.assert_array_equal(x[12:], 0)


def test_mesh_shifts_the_load_between_the_shafts():
    """Audit section 3.4, Lambda = 25, s = 1: shafts carry (0.70, 1.75) f and (-0.17, 0.81) nu_g f downwards."""
    system = gear_pair(1.0)
    x, _ = start(system)
    f = float(system.values["f"])
    d_1, d_2 = x[4:6] - x[8:10] - x[0:2], x[6:8] - x[10:12] - x[2:4]
    np.testing.assert_allclose(-d_1 / f, [0.70, 1.75], atol=6e-3)
    np.testing.assert_allclose(-2 * d_2 / (4 * f), [-0.17, 0.81], atol=6e-3)  # kappa_g = 2, nu_g = 4


@pytest.mark.parametrize("eps", [0.1, 0.3, 0.5, 0.8, 0.95, 0.99])
def test_plain_bearing_sits_on_its_locus(eps):
    """eps sqrt(B^2 + D^2) = 1/(Gamma s), tan(attitude) = D/(-B); both rotors of the Jeffcott model."""
    B, D = -2 * eps / (1 - eps**2) ** 2, np.pi / (2 * (1 - eps**2) ** 1.5)
    N = eps * np.hypot(B, D)
    rigid = System(family("jeffcott").model(rotor="rigid"), {"s": 2.0, "Gamma": 1 / (2 * N), "b": 0.0})
    for system in (rigid, jeffcott(Gamma=1 / (2 * N)), jeffcott("positive", Gamma=1 / (2 * N))):
        x, found = start(system)
        assert found
        expected = eps * np.array([D, B]) / np.hypot(B, D)  # spin carries it to +x under a load along -y
        tolerance = 1e-7 if system.model.tables else 1e-10  # the table of the positive arc at psi = 0
        np.testing.assert_allclose(x[:2], expected, atol=tolerance)


@pytest.mark.parametrize("s", [1.4, 1.7])
def test_equilibria_close_to_the_wall_are_found(s):
    """psi = 0.1 carries the gear's weight down to s = 1.39 (audit 6.2), at eccentricities up to 0.996 here."""
    system = gear_pair(s, 0.1, clock="mesh", Lambda=0.0)
    x, found = start(system)
    assert found
    assert 0.9 < np.hypot(x[2], x[3]) < 1
    assert residual(system, x) < 1e-11


@pytest.mark.parametrize("s", [1.0, 1.38])
def test_where_no_equilibrium_exists_the_declared_start_is_used(s):
    system = gear_pair(s, 0.1, clock="mesh", Lambda=0.0)
    x, found = start(system)
    assert not found
    assert x[0] == x[2] == 0.1
    assert np.count_nonzero(x) == 2


def test_a_start_does_not_depend_on_the_other_points():
    """Light and heavy journals, permeabilities mixed: every point as alone and in other company, to the bit."""
    system = gear_pair(1.0, 0.1, clock="mesh")
    names, rng = list(system.parameters), np.random.default_rng(3)
    values = np.repeat(system.vector[:, None], 37, axis=1)
    values[names.index("s")] = rng.uniform(0.5, 4.0, 37)
    values[names.index("psi")] = rng.choice([0.0, 1e-3, 0.1], 37)
    values[names.index("Gamma_1")] = rng.uniform(0.1, 3.0, 37)
    x, found = start_states(system.model, values)
    assert 5 < found.sum() < 37
    order = rng.permutation(37)
    np.testing.assert_array_equal(start_states(system.model, values[:, order])[0], x[:, order])
    for i in range(0, 37, 6):
        np.testing.assert_array_equal(start_states(system.model, values[:, i : i + 1])[0][:, 0], x[:, i])


def test_models_that_start_from_their_states_do():
    model = family("duffing").model()
    x, found = start_states(model, np.ones((5, 3)))
    assert found.all()
    np.testing.assert_array_equal(x, np.repeat([[1.0], [0.0]], 3, axis=1))
