"""Linear theory: the misprint's eigenvalues exactly, and the whirl of an unloaded film at half of the spin."""

import numpy as np
import pytest

import whirlmap
from whirlmap.studies.gear_psfd.search.coarse_diagrams import SPEEDS
from whirlmap.studies.gear_psfd.search.stability import GROWS, Modes, against_simulation, modes, permeability


def test_an_unloaded_printed_film_whirls_at_half_the_spin():
    """Without weight, forcing or pull of the shaft worth mentioning, u' = J u/2 + a little: audit, section 5."""
    system = whirlmap.load("gear-psfd/reference", film="printed", contact="ignore", j_p=1.0, j_g=1.0)
    point = {"s": 2.0, "psi": 1e-4, "Gamma_1": 20.0, "Gamma_2": 20.0}
    found = modes(system, {name: np.array([value]) for name, value in point.items()})
    assert found.frequency[0] == pytest.approx(0.5, abs=1e-3)


def test_the_printed_sign_of_the_mesh_is_unstable_and_the_derived_is_not():
    """Reference machine, xi_5 = xi_m: growth 0.33 per clock radian at s = 1, 0.11 at s = 3 (audit, section 5)."""
    s = np.array([1.0, 3.0])
    psi = np.full(2, 1e-4)
    literal = whirlmap.load("gear-psfd/literal", contact="ignore")
    printed = modes(literal, {"s": s, "psi": psi, "xi_5": np.full(2, float(literal.values["xi_m"]))})
    assert printed.growth == pytest.approx([0.33, 0.11], abs=0.005)
    derived = modes(whirlmap.load("gear-psfd/reference"), {"s": s, "psi": psi})
    assert np.all(derived.growth < GROWS)


def test_the_eigenvalues_agree_with_the_compiled_jacobian():
    system = whirlmap.load("gear-psfd/machine", s=3.6, psi=1e-3)
    found = modes(system, {"s": np.array([3.6]), "psi": np.array([1e-3])})
    from whirlmap.analysis.motion.ensembles import parameter_values
    from whirlmap.integrate.equilibrium import start_states

    x, there = start_states(system.model, parameter_values(system, {"s": np.array([3.6])}))
    assert there.all()
    top = max(np.linalg.eigvals(system.jacobian(0.0, x[:, 0])), key=lambda z: z.real)
    assert found.growth[0] == pytest.approx(top.real, abs=1e-7)
    assert found.frequency[0] == pytest.approx(abs(top.imag), abs=1e-6)
    assert found.growth[0] > GROWS  # above the threshold at 3.2
    assert found.eccentricity[:, 0] == pytest.approx([np.hypot(*x[:2, 0]), np.hypot(*x[2:4, 0])])


def test_what_is_counted():
    growth = np.full((1, 4, len(SPEEDS)), -1.0)
    growth[0, 0, :4], growth[0, -1, 2:6], growth[0, -1, 9:] = 1.0, 1.0, np.nan
    found = Modes(growth, np.zeros(growth.shape), np.full((2, *growth.shape), 0.5))
    rows = permeability(found, (0.0, 0.4, 1.0))
    assert rows.tolist() == [[0.0] * 6, [14.0, 2.0, 2.0, 3.0, 2.0, 5.0]]
    import xarray as xr

    regime = np.ones(growth.shape, dtype=int)
    regime[0, 0, :2], regime[0, -1, 9:] = 0, 4
    over = ("set", "psi", "s")
    ds = xr.Dataset({"regime": (over, regime), "period_T": (over, np.where(regime == 1, 8, 0))})
    assert against_simulation(found, ds, 8).tolist() == [[43.0, 0, 0, 0], [6.0, 2, 0, 0], [0, 0, 5, 0]]
