"""Beam elements against closed forms of beam theory."""

from math import pi, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import eigh

from whirlmap.machines.beams import MATERIALS, Element, bending, torsion
from whirlmap.machines.shafts import Shaft

STEEL = MATERIALS["steel"]


def shaft(L, d, n, d_i=0.0):
    return Shaft("beam", tuple(Element(L / n, d, d_i, STEEL) for _ in range(n)))


def test_a_cantilever_bends_and_shears(validate):
    """P L^3/(3 E I) + P L/(kappa G A) at the tip, to rounding with any number of elements."""
    for n, d_i in ((1, 0.0), (3, 0.04)):
        beam = shaft(0.4, 0.08, n, d_i)
        K = beam.matrices[2][2:, 2:]
        tip = np.linalg.solve(K, np.eye(K.shape[0])[-2])[-2]
        e = beam.elements[0]
        expected = 0.4**3 / (3 * STEEL.E * e.inertia) + 0.4 / (e.shear_coefficient * STEEL.G * e.area)
        validate(f"cantilever of {n} beam elements, bore {d_i:g} m: deflection of the tip in m/N", tip, expected,
                 tier="exact", source="P L^3/(3 E I) + P L/(kappa G A)", rel=1e-10)  # fmt: skip


def test_a_thin_ring_has_half_the_shear_coefficient_of_a_solid_rod_and_less(validate):
    """Cowper 1966: (6 + 6 nu)/(7 + 6 nu) of a rod, (2 + 2 nu)/(4 + 3 nu) of a thin ring."""
    nu = STEEL.nu
    rod, ring = Element(1.0, 0.1, 0.0, STEEL), Element(1.0, 0.1, 0.0999999, STEEL)
    validate("shear coefficients of a solid rod and a thin ring", [rod.shear_coefficient, ring.shear_coefficient],
             [(6 + 6 * nu) / (7 + 6 * nu), (2 + 2 * nu) / (4 + 3 * nu)], tier="published", source="Cowper 1966",
             rel=[1e-6, 1e-5])  # fmt: skip


def test_a_simply_supported_beam_has_the_frequencies_of_timoshenko(validate):
    """Roots of the frequency equation of a pinned Timoshenko beam, a quadratic in omega^2 for each wave number."""
    L, d = 1.0, 0.1
    beam = shaft(L, d, 80)
    M, _, K = beam.matrices
    loose = [i for i in range(M.shape[0]) if i not in (0, M.shape[0] - 2)]
    found = np.sqrt(eigh(K[np.ix_(loose, loose)], M[np.ix_(loose, loose)], eigvals_only=True))[:3]
    e, rho = beam.elements[0], STEEL.rho
    I, A, GA = e.inertia, e.area, e.shear_coefficient * STEEL.G * e.area
    for n, omega in enumerate(found, start=1):
        k = n * pi / L
        # rho A rho I/(kappa G A) w^4 - (rho A + rho I k^2 + rho A E I k^2/(kappa G A)) w^2 + E I k^4 = 0
        a, c = rho * A * rho * I / GA, STEEL.E * I * k**4
        b = rho * A + rho * I * k**2 + rho * A * STEEL.E * I * k**2 / GA
        validate(f"pinned Timoshenko beam, 80 elements: natural frequency {n} in rad/s", omega,
                 sqrt((b - sqrt(b**2 - 4 * a * c)) / (2 * a)), tier="exact", source="frequency equation", rel=1e-4)


def test_a_free_slender_beam_has_the_frequencies_of_euler(validate):
    """(4.73004, 7.85320)^2 sqrt(E I/(rho A L^4)) for a beam so slender that shear and rotary inertia vanish."""
    beam = shaft(2.0, 0.004, 16)
    e = beam.elements[0]
    unit = sqrt(STEEL.E * e.inertia / (STEEL.rho * e.area * 2.0**4))
    validate("free slender beam, 16 elements: first two frequencies over sqrt(E I/(rho A L^4))",
             beam.spectrum.frequency[2:4] / unit, [4.730041**2, 7.853205**2], tier="exact",
             source="roots of cos cosh = 1", rel=2e-5)  # fmt: skip


def test_a_free_rod_twists_with_half_waves(validate):
    beam = shaft(1.5, 0.05, 60)
    J, K = beam.torsion
    found = np.sqrt(np.maximum(eigh(K, J, eigvals_only=True), 0.0))[1:3]
    validate("free rod, 60 elements: first two torsional frequencies in rad/s", found,
             pi / 1.5 * sqrt(STEEL.G / STEEL.rho) * np.array([1, 2]), tier="exact", source="n pi/L sqrt(G/rho)", rel=1e-3)
    assert J.sum() == pytest.approx(STEEL.rho * pi / 32 * 0.05**4 * 1.5)


@given(L=st.floats(0.02, 1.0), d=st.floats(0.01, 0.3), hollow=st.floats(0.0, 0.9))
def test_rigid_motion_has_the_mass_of_the_element_and_no_force(L, d, hollow):
    e = Element(L, d, hollow * d, STEEL)
    M, G, K = bending(e)
    for whole in (M, G, K):
        np.testing.assert_array_equal(whole, whole.T)
    shift, tilt = np.array([1, 0, 1, 0.0]), np.array([-L / 2, 1, L / 2, 1])
    size = np.abs(K).max() * max(1.0, L)
    assert np.abs(K @ shift).max() < 1e-10 * size and np.abs(K @ tilt).max() < 1e-10 * size
    assert shift @ M @ shift == pytest.approx(e.mass, rel=1e-12)
    rotary = STEEL.rho * e.inertia * L
    assert tilt @ M @ tilt == pytest.approx(e.mass * L**2 / 12 + rotary, rel=1e-9)
    assert tilt @ G @ tilt == pytest.approx(2 * rotary, rel=1e-9)
    J, twist = torsion(e)
    assert J.sum() == pytest.approx(2 * rotary, rel=1e-12) and np.abs(twist.sum(axis=0)).max() == 0.0
