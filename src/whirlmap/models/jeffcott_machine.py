"""Dimensional inputs of the Jeffcott rotor, and its dimensionless groups as expressions of them.

Lengths are over the clearance c, the speed is s = omega sqrt(c/g), and each of the two bearings carries W = M g/2.
"""

from collections.abc import Mapping
from dataclasses import replace

from sympy import Expr, pi, sqrt

from whirlmap.equations.groups import Bearing, Groups, Route
from whirlmap.equations.parts import Output
from whirlmap.equations.quantities import Parameter
from whirlmap.models import jeffcott as rotor
from whirlmap.models.operation import LUBRICANT, OPERATION, range_fault, rho, speed_max, viscosity_routes

M = Parameter("M", "kg", "mass of the rotor", above=0)
K = Parameter("K", "N/m", "stiffness of the shaft at each bearing, half of that at the disc", above=0)
C = Parameter("C", "N*s/m", "external damping of the rotor", at_least=0)
R = Parameter("R", "m", "radius of both bearings", above=0)
L = Parameter("L", "m", "length of both bearings", above=0)
c = Parameter("c", "m", "radial clearance of both bearings", above=0)
K_c = Parameter("K_c", "N/m", "stiffness of the squirrel cage of each damper", above=0)
mu = Parameter("mu", "Pa*s", "viscosity of the lubricant", latex=r"\mu", above=0)
e_u = Parameter("e_u", "m", "unbalance eccentricity of the rotor", at_least=0)
U = Parameter("U", "kg*m", "unbalance of the rotor", at_least=0)
G = Parameter("G", "m/s", "balance quality grade of the rotor, e omega at speed_max", at_least=0)
speed = Parameter("speed", "rad/s", "speed of the shaft", above=0)
g = Parameter("g", "m/s^2", "gravity, which loads the bearings", above=0)

SECTIONS = {
    "rotor": (M,),
    "shafts": (K, C),
    "bearings": (R, L, c),
    "dampers": (K_c,),
    "lubricant": (mu, *LUBRICANT),
    "unbalance": (e_u, U, G),
    "operation": (speed, g, *OPERATION),
}
INPUTS = tuple(q for inside in SECTIONS.values() for q in inside)
ROUTES = (
    *viscosity_routes(mu),
    Route(e_u, (U, M), lambda U, m: U / m, "e = U/m"),
    Route(e_u, (G, speed_max), lambda G, w: G / w, "e = G/omega at speed_max, ISO 21940-11"),
)

W = M * g / 2  # load of one bearing
A = mu * R * L**3 / (2 * c**2)  # film coefficient [N s]


def groups(switches: Mapping[str, str]) -> dict[Parameter, Expr]:
    """Every dimensionless parameter as an expression of the inputs."""
    made = {
        rotor.s: speed * sqrt(c / g),
        rotor.Gamma: A * sqrt(g / c) / W,
        rotor.b: e_u / c,
        rotor.k: K * c / W,
        rotor.xi: C / (2 * M) * sqrt(c / g),
    }
    return made | ({rotor.k_c: K_c * c / W} if switches["bearing"] == "damper" else {})


def quantities(switches: Mapping[str, str]) -> dict[str, Output]:
    """Dimensional results: where the rotor runs, and how far the model's assumptions carry."""
    clock, damper = rotor.s * sqrt(g / c), switches["bearing"] == "damper"
    made = {
        "omega_0": Output(sqrt(g / c), "rad/s", "speed at which s = 1, sqrt(g/c)", role="unit_speed"),
        "force_unit": Output(W, "N", "weight on one bearing W, the unit of forces"),
        "shaft_speed": Output(clock, "rad/s", "speed of the shaft", role="shaft_speed"),
        "omega_n": Output(sqrt(2 * K / M), "rad/s", "natural frequency of the rotor on rigid bearings"),
        "slenderness": Output(L / (2 * R), "1", "length over diameter of the bearings; short is below 0.25"),
        "film_inertia": Output(rho * clock * c**2 / mu, "1", "inertia over viscosity in the film, rho omega c^2/mu"),
        **({} if damper else {
            "taylor": Output(rho * clock * R * c / mu * sqrt(c / R), "1", "Re sqrt(c/R) of the film; laminar below 41.2"),
        }),
        "specific_load": Output(W / (2 * R * L), "Pa", "load of a bearing over its projected area"),
    }  # fmt: skip
    if damper:
        made |= {
            "omega_cage": Output(
                sqrt(2 * K_c / M), "rad/s", "natural frequency of the rigid rotor on its squirrel cages",
                role="natural_frequency",
            ),
            "sag": Output(W / K_c, "m", "sag of the squirrel cages under the weight"),
            "film_damping": Output(pi * mu * R * L**3 / (2 * c**3), "N*s/m", "damping of one film at the centre"),
        }
    return made


#: The rotor with its dimensional inputs: what case files call ``jeffcott``.
JEFFCOTT_MACHINE = replace(
    rotor.JEFFCOTT,
    groups=Groups(
        inputs=INPUTS,
        declare=groups,
        quantities=quantities,
        bearings=lambda switches: {"1": Bearing(R, L, c, mu, rho, 0 if switches["bearing"] == "damper" else 1, "eps")},
        units={"force": W, "length": c, "speed": rotor.s * sqrt(g / c), "rotation": sqrt(g / c)},
        routes=ROUTES,
        sections={name: tuple(q.name for q in inside) for name, inside in SECTIONS.items()},
        speed=speed,
        operation=tuple(q.name for q in OPERATION),
        checks=(range_fault,),
    ),
)
