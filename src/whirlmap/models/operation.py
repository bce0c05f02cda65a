"""Inputs of every machine: its oil and its operation."""

from collections.abc import Mapping
from fractions import Fraction

from whirlmap.equations.groups import Route
from whirlmap.equations.quantities import Parameter
from whirlmap.models.lubricant import by_grade, by_two_points

speed_min = Parameter("speed_min", "rad/s", "lowest speed at which the machine is run", above=0)
speed_max = Parameter("speed_max", "rad/s", "highest speed at which the machine is run", above=0)
limit = Parameter("limit", "m", "largest amplitude that is allowed", above=0)

#: Of machines from parts: the speed of their reference shaft, and gravity.
speed = Parameter("speed", "rad/s", "speed of the reference shaft", above=0)
g = Parameter("g", "m/s^2", "gravity", at_least=0)

#: What `speeds` reads; only unbalance grades and a rated power change a parameter by it.
OPERATION = (speed_min, speed_max, limit)

VG = Parameter("VG", "1", "ISO VG grade of the oil", above=0)
VI = Parameter("VI", "1", "viscosity index of the oil")
nu_40 = Parameter("nu_40", "m^2/s", "kinematic viscosity of the oil at 40 degC", latex=r"\nu_{40}", above=0)
nu_100 = Parameter("nu_100", "m^2/s", "kinematic viscosity of the oil at 100 degC", latex=r"\nu_{100}", above=0)
T_oil = Parameter("T_oil", "degC", "temperature of the film", above=-273.15)
rho = Parameter("rho", "kg/m^3", "density of the oil at its temperature", latex=r"\rho", above=0)

LUBRICANT = (VG, VI, nu_40, nu_100, T_oil, rho)


def viscosity_routes(mu: Parameter) -> tuple[Route, ...]:
    """Ways in which data sheets give the viscosity of an oil."""
    return (
        Route(mu, (VG, VI, T_oil, rho), by_grade, "Walther's equation, ASTM D341, with the index of ASTM D2270"),
        Route(mu, (nu_40, nu_100, T_oil, rho), by_two_points, "Walther's equation, ASTM D341"),
    )


def range_fault(inputs: Mapping[str, Fraction]) -> str:
    """Say what is wrong with a range of speeds; empty where nothing is."""
    if {"speed_min", "speed_max"} <= inputs.keys() and inputs["speed_min"] >= inputs["speed_max"]:
        low, high = (float(inputs[name]) * 9.549296585513721 for name in ("speed_min", "speed_max"))
        return f"found speed_min = {low:g} rpm and speed_max = {high:g} rpm, expected speed_min below speed_max"
    return ""
