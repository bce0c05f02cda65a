"""Dimensional inputs of the gear pair, and every dimensionless group of it as an expression of them.

Definitions are those of `studies/gear_psfd/audit.md`, section 3.1. Lengths are over the clearance c (the same
in both bearings; each shaft has two identical bearings in two identical housings), time is counted in radians
of the clock. The pinion turns counter-clockwise.
"""

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction

from sympy import Abs, Expr, Rational, cos, pi, sign, sqrt

from whirlmap.equations.groups import Bearing, Groups, Route
from whirlmap.equations.parts import Output
from whirlmap.equations.quantities import Parameter
from whirlmap.models import gear_pair as pair
from whirlmap.models import mesh, rub, torsion
from whirlmap.models.operation import LUBRICANT, OPERATION, range_fault, rho, speed_max, viscosity_routes

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

J_p = Parameter("J_p", "kg*m^2", "polar inertia of the pinion and what turns with it", above=0)
J_g = Parameter("J_g", "kg*m^2", "polar inertia of the gear and what turns with it", above=0)
k_tp = Parameter("k_tp", "N*m/rad", "torsional stiffness between pinion and driver", at_least=0)
k_tg = Parameter("k_tg", "N*m/rad", "torsional stiffness between gear and load", at_least=0)
c_tp = Parameter("c_tp", "N*m*s/rad", "torsional damping between pinion and driver", at_least=0)
c_tg = Parameter("c_tg", "N*m*s/rad", "torsional damping between gear and load", at_least=0)
T_p = Parameter("T_p", "N*m", "torque into the pinion along its rotation; negative where the gear drives")
P_t = Parameter("P_t", "W", "power through the mesh at speed_P; negative where the gear drives")
speed_P = Parameter("speed_P", "rad/s", "speed of the pinion for which P_t is given; speed_max where absent", above=0)
module = Parameter("module", "m", "transverse module of the teeth", above=0)
alpha = Parameter("alpha", "rad", "transverse pressure angle", latex=r"\alpha", at_least=0, below=float(pi / 2))
beta_c = Parameter("beta_c", "rad", "direction from pinion to gear, from x (horizontal)", latex=r"\beta_c")
j_n = Parameter("j_n", "m", "backlash along the line of action", above=0)
k_c1 = Parameter("k_c1", "N/m", "centring spring of each bearing 1", at_least=0)
k_c2 = Parameter("k_c2", "N/m", "centring spring of each bearing 2", at_least=0)
K_r = Parameter("K_r", "N/m", "stiffness of a bearing's wall against a rubbing journal", at_least=0)
h_r = Parameter("h_r", "m", "film thickness at which the surfaces touch", above=0)
U_p = Parameter("U_p", "kg*m", "unbalance of the pinion", at_least=0)
U_g = Parameter("U_g", "kg*m", "unbalance of the gear", at_least=0)
G_p = Parameter("G_p", "m/s", "balance quality grade of the pinion, e omega at speed_max", at_least=0)
G_g = Parameter("G_g", "m/s", "balance quality grade of the gear, e omega at its speed for speed_max", at_least=0)

SECTIONS = {
    "pinion": (z_p, m_p, J_p),
    "gear": (z_g, m_g, J_g),
    "mesh": (K_m, C_m, e_TE, T_p, P_t, speed_P, module, alpha, beta_c, j_n),
    "shafts": (K_p, K_g, C_p, C_g, k_tp, k_tg, c_tp, c_tg),
    "bearings": (c, R_1, L_1, R_2, L_2, H, Phi, K_r, h_r),
    "dampers": (k_c1, k_c2),
    "suspension": (m_1, m_2, k_11, k_21, k_12, k_22, c_1, c_2),
    "lubricant": (mu, *LUBRICANT),
    "unbalance": (e_up, e_ug, U_p, U_g, G_p, G_g),
    "operation": (speed, g, *OPERATION),
}
SHARED = {
    "K": (K_p, K_g), "C": (C_p, C_g), "k_t": (k_tp, k_tg), "c_t": (c_tp, c_tg), "R": (R_1, R_2), "L": (L_1, L_2),
    "k_c": (k_c1, k_c2), "m_h": (m_1, m_2), "k_1": (k_11, k_21), "k_3": (k_12, k_22), "c_h": (c_1, c_2),
    "e_u": (e_up, e_ug), "U": (U_p, U_g), "G": (G_p, G_g),
}  # fmt: skip

INPUTS = (
    z_p, z_g, m_p, m_g, m_1, m_2, K_p, K_g, C_p, C_g, k_11, k_21, k_12, k_22, c_1, c_2, K_m, C_m,
    e_TE, e_up, e_ug, mu, c, R_1, L_1, R_2, L_2, H, Phi, speed, g, T_p, P_t, speed_P, module, alpha, beta_c, j_n,
    J_p, J_g, k_tp, k_tg, c_tp, c_tg, k_c1, k_c2, K_r, h_r, U_p, U_g, G_p, G_g, *LUBRICANT, *OPERATION,
)  # fmt: skip

ROUTES = (
    *viscosity_routes(mu),
    Route(e_up, (U_p, m_p), lambda U, m: U / m, "e = U/m"),
    Route(e_ug, (U_g, m_g), lambda U, m: U / m, "e = U/m"),
    Route(e_up, (G_p, speed_max), lambda G, w: G / w, "e = G/omega at speed_max, ISO 21940-11"),
    Route(e_ug, (G_g, speed_max, z_p, z_g), lambda G, w, zp, zg: G * zg / (w * zp), "e = G/omega, ISO 21940-11"),
    Route(T_p, (P_t, speed_max), lambda P, w: P / w, "T = P/omega at that speed", {speed_max: speed_P}),
)

def torque_fault(inputs: Mapping[str, Fraction]) -> str:
    """Say that a torque of zero has no line of action: its sign chooses the flanks that touch."""
    if inputs.get(T_p.name) == 0:
        return (
            "found T_p = 0, expected a torque with a sign, which says on which flanks the teeth touch; or F_0 = 0 with"
            " phi_m, the direction in which the pinion pushes the gear"
        )
    return ""


omega_0 = sqrt(K_p / m_p)  # natural frequency of the pinion on a rigid bearing


def groups(switches: Mapping[str, str]) -> dict[Parameter, Expr]:
    """Every dimensionless parameter of one edition, as an expression of the inputs and of each other."""
    made = {**clocks(switches["edition"]), **MACHINE}
    if switches["mesh"] == "line":
        made |= LINE
    if switches["backlash"] == "dead_zone":
        made |= {mesh.B_m: j_n / c}
    if switches["torsion"] == "rigid_rotors":
        made |= TURNING
    if switches["contact"] == "rub":
        made |= {rub.eps_r: 1 - h_r / c, rub.kappa_r: K_r / K_p}
    if switches["centring"] == "spring":
        made |= {pair.kappa_c1: k_c1 / K_p, pair.kappa_c2: k_c2 / K_p}
    return made


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


R_bp = module * z_p * cos(alpha) / 2  # base radii
R_bg = module * z_g * cos(alpha) / 2

LINE: dict[Parameter, Expr] = {
    mesh.F_0: Abs(T_p) / (R_bp * K_p * c),
    # The flank that pushes the gear: ahead of the pinion's motion, or behind it where the gear drives.
    mesh.phi_m: beta_c + sign(T_p) * (pi / 2 - alpha),
}
TURNING: dict[Parameter, Expr] = {
    torsion.iota_p: J_p / (m_p * R_bp**2),
    torsion.iota_g: J_g / (m_p * R_bg**2),
    torsion.kappa_tp: k_tp / (K_p * R_bp**2),
    torsion.kappa_tg: k_tg / (K_p * R_bg**2),
    torsion.xi_tp: c_tp / (2 * m_p * omega_0 * R_bp**2),
    torsion.xi_tg: c_tg / (2 * m_p * omega_0 * R_bg**2),
}


def quantities(switches: Mapping[str, str]) -> dict[str, Output]:
    """Dimensional results: where the machine runs, and how far the model's assumptions carry."""
    clock = pair.s * omega_0
    loaded = {
        "mesh_load": Output(Abs(T_p) / R_bp, "N", "transmitted tooth force T_p/R_bp along the line of action"),
        "transmitted_power": Output(T_p * pair.r_p * clock, "W", "torque times speed of the pinion, at pinion_speed"),
        "base_radius_p": Output(R_bp, "m", "base radius of the pinion"),
    }
    return {
        "omega_0": Output(omega_0, "rad/s", "natural frequency sqrt(K_p/m_p)", role="unit_speed"),
        "force_unit": Output(K_p * c, "N", "unit of forces, K_p c"),
        "clock_speed": Output(clock, "rad/s", "speed of the clock, which s counts"),
        "pinion_speed": Output(pair.r_p * clock, "rad/s", "speed of the pinion's shaft", role="shaft_speed"),
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
        "ring_1": Output(
            pi * H / L_1, "1", "pi H/L_1; psi is too large by about a third of its square", role="ring", bearing="1"
        ),
        "ring_2": Output(
            pi * H / L_2, "1", "pi H/L_2; psi is too large by about a third of its square", role="ring", bearing="2"
        ),
        **(loaded if switches["mesh"] == "line" else {}),
    }


#: The gear pair with its dimensional inputs: what case files call ``gear_pair``.
GEAR_PAIR_MACHINE = replace(
    pair.GEAR_PAIR,
    groups=Groups(
        inputs=INPUTS,
        declare=groups,
        quantities=quantities,
        bearings=lambda _: {
            "1": Bearing(R_1, L_1, c, mu, rho, pair.j_p, "eps_1", pair.psi),
            "2": Bearing(R_2, L_2, c, mu, rho, pair.j_g, "eps_2", pair.psi),
        },
        units={"force": K_p * c, "length": c, "speed": pair.s * omega_0, "rotation": pair.r_p * omega_0},
        routes=ROUTES,
        shared={name: tuple(q.name for q in both) for name, both in SHARED.items()},
        sections={name: tuple(q.name for q in inside) for name, inside in SECTIONS.items()}
        | {"bearings": (*(q.name for q in SECTIONS["bearings"]), "R", "L")},
        speed=speed,
        operation=tuple(q.name for q in OPERATION),
        checks=(range_fault, torque_fault),
    ),
)
