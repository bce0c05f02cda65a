"""Temperature rise of the oil in a plain short journal bearing, from its power loss and its side flow.

In a short bearing the pressure gradient along the circumference is neglected, so that oil moves along it by shear alone.
With surface speed U = omega R, gap h = c (1 + eps cos theta), theta from where the gap is widest, a steady journal has

- the power loss P = U R L times the integral of mu U/h over the whole circle = 2 pi mu omega^2 R^3 L/(c sqrt(1 - eps^2)),
- the side flow Q = (U L/2) (h(0) - h(pi)) = omega R L c eps: what enters the narrowing half and does not leave at its end.

These are the friction and the flow of the short-bearing approximation of Dubois and Ocvirk, NACA Report 1157 (1953). If all
heat goes with that oil it leaves warmer than it came by

    P/(rho c_p Q) = 2 pi mu omega (R/c)^2/(rho c_p eps sqrt(1 - eps^2)),

with rho c_p = 1.8 MJ/(m^3 K), the value of ISO 7902-1 for mineral oils. That is an upper bound: heat also leaves through
shaft and housing, oil that is fed under pressure carries some, and warm oil is thinner and heats less.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import exp, inf, pi, sqrt

from whirlmap.assumptions.violation import BearingNumbers, Facts, Violation
from whirlmap.models.lubricant import HOTTEST, by_grade, by_two_points
from whirlmap.units import convert

#: Heat capacity of mineral oil per volume [J/(m^3 K)], ISO 7902-1.
HEAT_CAPACITY = 1.8e6
#: Part of its viscosity that an oil loses for each kelvin where a case gives no grade: mineral oils of ISO VG 32 to 68 do
#: between 40 and 70 degC.
PER_KELVIN = 0.03
#: Change of the viscosity beyond which one viscosity for the whole film is an assumption that does not hold.
CHANGE = 0.2
#: Rises [K] beyond which their size says nothing.
HOT = 100.0


@dataclass(frozen=True)
class OilHeat:
    """Heat balance of one bearing.

    Attributes
    ----------
    name : str
        Of the bearing.
    omega : float
        Speed of the journal [rad/s] for which it holds.
    power, flow, rise : float
        Power loss [W], side flow [m^3/s] and the rise [K] of the oil's temperature; infinite where no oil flows.
    thinning : float
        Part of the viscosity that an oil loses which warms by that.
    law : str
        By what rule the viscosity falls.
    """

    name: str
    omega: float
    power: float
    flow: float
    rise: float
    thinning: float
    law: str


def heat_balance(mu: float, omega: float, R: float, L: float, c: float, eps: float) -> tuple[float, float, float]:
    """Power loss [W], side flow [m^3/s] and largest rise of temperature [K] of one plain short journal bearing.

    Parameters
    ----------
    mu : float
        Viscosity [Pa*s].
    omega : float
        Speed of the journal [rad/s], of either sign.
    R, L, c : float
        Radius, length and radial clearance [m].
    eps : float
        Eccentricity over the clearance, at least 0 and below 1. The rise is infinite at 0, where no oil leaves by the wedge.
    """
    omega = abs(omega)
    power = 2 * pi * mu * omega**2 * R**3 * L / (c * sqrt(1 - eps**2))
    flow = omega * R * L * c * eps
    return power, flow, power / (HEAT_CAPACITY * flow) if flow else inf


def oil_heat(facts: Facts) -> dict[str, OilHeat]:
    """Heat balance of every bearing whose journal turns in a plain film, at the largest speed that was run."""
    rest, clock = facts.rest_at_speed, facts.clock
    if not facts.plain or facts.switches.get("film") == "printed" or rest is None or clock is None:
        return {}
    found = {}
    for bearing in facts.bearings:
        omega, eps = abs(bearing.spin) * clock, facts.output(bearing.eccentricity, rest)
        if omega == 0.0 or eps >= 1.0:
            continue
        power, flow, rise = heat_balance(bearing.mu, omega, bearing.R, bearing.L, bearing.c, eps)
        thinning, law = _thinning(bearing.oil, bearing.mu, rise)
        found[bearing.name] = OilHeat(bearing.name, omega, power, flow, rise, thinning, law)
    return found


def violations(facts: Facts) -> Iterator[Violation]:
    """Oil that is not the same everywhere in the film."""
    heat = oil_heat(facts)
    for bearing in facts.bearings:
        if (one := heat.get(bearing.name)) and one.thinning > CHANGE:
            yield Violation(f"oil_temperature{bearing.name}", one.thinning, CHANGE, _sentence(bearing, one, bearing.oil))


def why_none(facts: Facts) -> str:
    """Say why a system with dimensions has no heat balance; empty where it has one, or where nothing heats its oil."""
    turning = [b for b in facts.bearings if b.spin]
    if not turning or facts.clock is None or oil_heat(facts):
        return ""
    if not facts.plain:
        return "oil flows through the porous ring too (psi > 0), and power loss and side flow are those of a plain bearing"
    if facts.switches.get("film") == "printed":
        return "the film as printed is no short bearing's, whose power loss and side flow are known"
    return "no static equilibrium was found, whose eccentricity gives the side flow"


def _sentence(bearing: BearingNumbers, one: OilHeat, inputs: Mapping[str, float]) -> str:
    rise = f"up to {one.rise:.3g} K" if one.rise < HOT else f"{HOT:g} K or more"
    than = f" than {inputs['T_oil']:.4g} degC" if "T_oil" in inputs else ""
    return (
        f"{bearing.words}: at {convert(one.omega, 'rad/s', 'rpm'):.4g} rpm the oil warms by {rise} if all heat of the film,"
        f" {one.power:.3g} W, goes with its side flow, {one.flow * 6e4:.3g} l/min; oil that much warmer{than} has lost"
        f" {100 * one.thinning:.0f} % of its viscosity ({one.law}), and the model has one viscosity for the whole film."
    )


def _thinning(inputs: Mapping[str, float], mu: float, rise: float) -> tuple[float, str]:
    """Part of the viscosity that is lost, and by what law."""
    if {"VG", "VI", "T_oil", "rho"} <= inputs.keys():
        warm = by_grade(inputs["VG"], inputs["VI"], min(inputs["T_oil"] + rise, HOTTEST), inputs["rho"])
    elif {"nu_40", "nu_100", "T_oil", "rho"} <= inputs.keys():
        warm = by_two_points(inputs["nu_40"], inputs["nu_100"], min(inputs["T_oil"] + rise, HOTTEST), inputs["rho"])
    else:
        return 1 - exp(-PER_KELVIN * rise), f"3 % for each K are assumed, exp(-{PER_KELVIN:g} dT): the case gives no grade"
    return 1 - warm / mu, "Walther's equation, ASTM D341"
