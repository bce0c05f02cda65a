"""Dimensional inputs of the gear pair, and every dimensionless group of it as an expression of them.

Definitions are those of `studies/gear_psfd/audit.md`, section 3.1. Lengths are over the clearance c (the same
in both bearings; each shaft has two identical bearings in two identical housings), time is counted in radians
of the clock.
"""

from collections.abc import Mapping
from dataclasses import replace

from sympy import Expr, Rational, pi, sqrt

from whirlmap.equations.groups import Groups
from whirlmap.equations.model import Output
from whirlmap.equations.quantities import Parameter
from whirlmap.models import gear_pair as pair

z_p = Parameter("z_p", "1", "teeth of the pinion", above=0, order=True)
z_g = Parameter("z_g", "1", "teeth of the gear", above=0, order=True)
m_p = Parameter("m_p", "kg", "mass of the pinion", above=0)
m_g = Parameter("m_g", "kg", "mass of the gear", above=0)
m_1 = Parameter("m_1", "kg", "mass of one housing of bearing 1", above=0)
m_2 = Parameter("m_2", "kg", "mass of one housing of bearing 2", above=0)
K_p = Parameter("K_p", "N/m", "stiffness of the pinion's shaft", above=0)
K_g = Parameter("K_g", "N/m", "stiffness of the gear's shaft", above=0)
C_p = Parameter("C_p", "N*s/m", "external damping of the pinion", at_least=0)
C_g = Parameter("C_g", "N*s/m", "external damping of the gear", at_least=0)
k_11 = Parameter("k_11", "N/m", "linear stiffness of suspension 1", above=0)
k_21 = Parameter("k_21", "N/m", "linear stiffness of suspension 2", above=0)
k_12 = Parameter("k_12", "N/m^3", "cubic stiffness of suspension 1", at_least=0)
k_22 = Parameter("k_22", "N/m^3", "cubic stiffness of suspension 2", at_least=0)
c_1 = Parameter("c_1", "N*s/m", "damping of suspension 1", at_least=0)
c_2 = Parameter("c_2", "N*s/m", "damping of suspension 2", at_least=0)
K_m = Parameter("K_m", "N/m", "lateral stiffness of the mesh", at_least=0)
C_m = Parameter("C_m", "N*s/m", "lateral damping of the mesh", at_least=0)
e_TE = Parameter("e_TE", "m", "static transmission error")
e_up = Parameter("e_up", "m", "unbalance eccentricity of the pinion", at_least=0)
e_ug = Parameter("e_ug", "m", "unbalance eccentricity of the gear", at_least=0)
mu = Parameter("mu", "Pa*s", "viscosity of the lubricant", latex=r"\mu", above=0)
c = Parameter("c", "m", "radial clearance of both bearings", above=0)
R_1 = Parameter("R_1", "m", "radius of bearing 1", above=0)
L_1 = Parameter("L_1", "m", "length of bearing 1", above=0)
R_2 = Parameter("R_2", "m", "radius of bearing 2", above=0)
L_2 = Parameter("L_2", "m", "length of bearing 2", above=0)
H = Parameter("H", "m", "wall thickness of the porous ring", at_least=0)
Phi = Parameter("Phi", "m^2", "permeability of the porous ring", latex=r"\Phi", at_least=0)
speed = Parameter("speed", "rad/s", "speed of the pinion's shaft", above=0)
g = Parameter("g", "m/s^2", "gravity", at_least=0)

INPUTS = (
    z_p, z_g, m_p, m_g, m_1, m_2, K_p, K_g, C_p, C_g, k_11, k_21, k_12, k_22, c_1, c_2, K_m, C_m,
    e_TE, e_up, e_ug, mu, c, R_1, L_1, R_2, L_2, H, Phi, speed, g,
)  # fmt: skip

omega_0 = sqrt(K_p / m_p)  # natural frequency of the pinion on a rigid bearing


def groups(switches: Mapping[str, str]) -> dict[Parameter, Expr]:
    """Every dimensionless parameter of one edition, as an expression of the inputs and of each other."""
    return {**clocks(switches["edition"]), **MACHINE}


def clocks(edition: str) -> dict[Parameter, Expr]:
    """Express the rates of shafts, mesh and journals over the clock's speed; each edition has its clock."""
    if edition == "physical":  # the clock is the pinion's shaft; external gears turn against each other
        return {pair.r_p: 1, pair.r_g: -z_p / z_g, pair.r_m: z_p, pair.j_p: pair.r_p, pair.j_g: pair.r_g}
    quarter, eighth = Rational(1, 4), Rational(1, 8)  # the clock is the mesh; orders are those of (34)-(37)
    if edition == "intended":
        return {pair.r_p: quarter, pair.r_g: -eighth, pair.r_m: 1, pair.j_p: pair.r_p, pair.j_g: pair.r_g}
    return {pair.r_p: quarter, pair.r_g: eighth, pair.r_m: 1, pair.j_p: 1, pair.j_g: 1}  # (31), (33)


MACHINE: dict[Parameter, Expr] = {
    pair.s: speed / (pair.r_p * omega_0),
    pair.psi: 12 * Phi * H / c**3,
    pair.f: m_p * g / (K_p * c),
    pair.Lambda: K_m / K_p,
    pair.xi_p: C_p / (2 * m_p * omega_0),
    pair.xi_g: C_g / (2 * m_g * omega_0),
    pair.xi_m: C_m / (2 * m_p * omega_0),
    pair.xi_1: c_1 / (2 * sqrt(k_11 * m_1)),
    pair.xi_2: c_2 / (2 * sqrt(k_21 * m_2)),
    pair.nu_g: m_g / m_p,
    pair.kappa_g: K_g / K_p,
    pair.nu_1: m_1 / m_p,
    pair.nu_2: m_2 / m_p,
    pair.S_1: sqrt(m_1 * K_p / (m_p * k_11)),
    pair.S_2: sqrt(m_2 * K_p / (m_p * k_21)),
    pair.a_1: k_12 * c**2 / (K_p * pair.nu_1),
    pair.a_2: k_22 * c**2 / (K_p * pair.nu_2),
    pair.b_p: e_up / c,
    pair.b_g: e_ug / c,
    pair.E: e_TE / c,
    pair.Gamma_1: mu * R_1 * L_1**3 * omega_0 / (c**3 * K_p),  # at s = 1; the equations multiply by s
    pair.Gamma_2: mu * R_2 * L_2**3 * omega_0 / (c**3 * K_p),
}


def quantities(switches: Mapping[str, str]) -> dict[str, Output]:  # noqa: ARG001
    """Dimensional results: where the machine runs, and how far the model's assumptions carry."""
    clock = pair.s * omega_0
    return {
        "omega_0": Output(omega_0, "rad/s", "natural frequency sqrt(K_p/m_p)"),
        "clock_speed": Output(clock, "rad/s", "speed of the clock, which s counts"),
        "pinion_speed": Output(pair.r_p * clock, "rad/s", "speed of the pinion's shaft"),
        "gear_speed": Output(
            pair.r_g * clock, "rad/s", "speed of the gear's shaft; negative: against the pinion"
        ),
        "mesh_frequency": Output(pair.r_m * clock, "rad/s", "tooth-passing frequency"),
        "slenderness_1": Output(
            L_1 / (2 * R_1), "1", "length over diameter of bearing 1; short is below 0.25"
        ),
        "slenderness_2": Output(
            L_2 / (2 * R_2), "1", "length over diameter of bearing 2; short is below 0.25"
        ),
        "ring_1": Output(pi * H / L_1, "1", "pi H/L_1; psi is too large by about a third of its square"),
        "ring_2": Output(pi * H / L_2, "1", "pi H/L_2; psi is too large by about a third of its square"),
    }


#: The gear pair with its dimensional inputs: what case files call ``gear_pair``.
GEAR_PAIR_MACHINE = replace(
    pair.GEAR_PAIR, groups=Groups(inputs=INPUTS, declare=groups, quantities=quantities)
)
