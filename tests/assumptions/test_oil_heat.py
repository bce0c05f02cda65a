"""The oil's rise of temperature against the integrals of the short bearing, and when its viscosity is said to change."""

from math import exp, pi

import numpy as np
import pytest
from scipy.integrate import quad

import whirlmap
from whirlmap.assumptions.oil_heat import HEAT_CAPACITY, heat_balance, oil_heat, why_none
from whirlmap.assumptions.violation import Facts
from whirlmap.assumptions.violations import violations
from whirlmap.models.lubricant import by_grade, by_two_points

RIG, TURBO, AERO = "machines/jeffcott-rig", "machines/turbo-gearbox", "machines/aero-damper"


@pytest.mark.parametrize("eps", [0.1, 0.5, 0.9])
def test_power_and_flow_are_the_integrals_over_the_film(eps):
    mu, omega, R, L, c = 0.02, 300.0, 0.05, 0.02, 8e-5
    power, flow, rise = heat_balance(mu, -omega, R, L, c, eps)
    shear = quad(lambda a: mu * omega * R / (c * (1 + eps * np.cos(a))), 0, 2 * pi)[0]
    assert power == pytest.approx(omega * R * shear * R * L)
    # What leaves at both ends, from Ocvirk's pressure p = 3 mu U eps sin a (L^2/4 - z^2)/(R c^2 (1 + eps cos a)^3), a from 0
    # to pi: 2 times the integral of h^3/(12 mu) |dp/dz| R da at z = L/2.
    out = 2 * quad(lambda a: c**3 / (12 * mu) * 3 * mu * omega * R * eps * np.sin(a) * L / (R * c**2) * R, 0, pi)[0]
    assert flow == pytest.approx(out)
    assert rise == pytest.approx(power / (HEAT_CAPACITY * flow))


def test_without_eccentricity_no_oil_flows():
    assert heat_balance(0.02, 300.0, 0.05, 0.02, 8e-5, 0.0)[2] == np.inf


def heat(case, **changes):
    return oil_heat(Facts.of(whirlmap.load(case, **changes), []))


def test_each_law_gives_the_viscosity_of_the_warmer_oil():
    one = heat(TURBO)["_1"]
    assert one.thinning == pytest.approx(1 - by_grade(32, 100, 65 + one.rise, 845) / by_grade(32, 100, 65, 845))
    assert "D341" in one.law
    two = heat(RIG, nu_40="32 mm^2/s", nu_100="5.4 mm^2/s", T_oil="50 degC", speed="6000 rpm")[""]
    warm, cold = (by_two_points(32e-6, 5.4e-6, t, 850) for t in (50 + two.rise, 50))
    assert two.thinning == pytest.approx(1 - warm / cold)
    bare = heat(RIG, mu="0.02 Pa*s")[""]
    assert bare.thinning == pytest.approx(1 - exp(-0.03 * bare.rise))
    assert "assumed" in bare.law and "no grade" in bare.law


def test_it_is_a_strain_from_a_fifth_of_the_viscosity_on():
    for speed in ("6000 rpm", "20000 rpm"):
        here = whirlmap.load(RIG, speed=speed, L="9 mm", mu="0.02 Pa*s")
        found = {s.name: s for s in violations(here)}
        lost = oil_heat(Facts.of(here, []))[""].thinning
        assert ("oil_temperature" in found) == (lost > 0.2) == (speed == "20000 rpm")
    text = found["oil_temperature"].sentence
    assert "2e+04 rpm" in text and "exp(-0.03 dT)" in text and "no grade" in text
    violation = {s.name: s for s in violations(whirlmap.load(TURBO))}["oil_temperature_1"]
    assert "65 degC" in violation.sentence and "Walther" in violation.sentence


def test_a_damper_heats_nothing_and_a_porous_ring_is_not_judged():
    assert heat(AERO) == {} and why_none(Facts.of(whirlmap.load(AERO), [])) == ""
    porous = Facts.of(whirlmap.load("gear-psfd/machine"), [])
    assert oil_heat(porous) == {} and "porous ring" in why_none(porous)
    assert set(heat("gear-psfd/machine", psi=0)) == {"_1", "_2"}


def test_the_oil_of_a_bearing_has_its_own_numbers():
    """A machine from parts names its oil: the grade is read there, and a case with one oil keeps plain names."""
    for case in ("machines/two-shaft-gearbox", TURBO):
        for bearing in Facts.of(whirlmap.load(case), []).bearings:
            assert (bearing.oil["VG"], bearing.oil["T_oil"]) == (32, 65)
