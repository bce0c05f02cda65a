"""Torsion of a gear pair: pinion and gear turn as rigid bodies, each tied to its machine by a shaft in torsion.

``qp`` and ``qg`` are the arcs on the base circles, R_b times the angle by which a rotor leaves its uniform rotation,
over c, positive along the line of action as the pinion pushes the gear. They are small: the unbalance keeps the phase
of the uniform rotation. Driving and driven machine turn uniformly behind their shafts, whose twist under the
transmitted torque is taken off. Source: Kahraman and Singh 1990 for the two rotors and their mesh.
"""

from collections.abc import Mapping

from sympy import Expr

from whirlmap.equations import Parameter, State, states

qp, qg = states("qp qg", "1", "arc of the base circle from uniform rotation, over c", "length")
vqp, vqg = states("vqp vqg", "1", "its rate, over c and clock radian", "velocity")

iota_p = Parameter("iota_p", "1", "inertia of the pinion J_p/(m_p R_bp^2)", latex=r"\iota_p", above=0)
iota_g = Parameter("iota_g", "1", "inertia of the gear J_g/(m_p R_bg^2)", latex=r"\iota_g", above=0)
kappa_tp = Parameter("kappa_tp", "1", "torsional stiffness to the driver k_tp/(K_p R_bp^2)", at_least=0)
kappa_tg = Parameter("kappa_tg", "1", "torsional stiffness to the load k_tg/(K_p R_bg^2)", at_least=0)
xi_tp = Parameter("xi_tp", "1", "torsional damping to the driver c_tp/(2 m_p omega_0 R_bp^2)", at_least=0)
xi_tg = Parameter("xi_tg", "1", "torsional damping to the load c_tg/(2 m_p omega_0 R_bg^2)", at_least=0)

STATES = (qp, qg, vqp, vqg)
BODIES = {"pinion torsion": (qp,), "gear torsion": (qg,)}
PARAMETERS = (iota_p, iota_g, kappa_tp, kappa_tg, xi_tp, xi_tg)


def equations(W: Expr, F_0: Expr, s: Expr) -> dict[State, Expr]:
    """Angular momentum of pinion and gear under mesh force W and transmitted load F_0."""
    return {
        qp: vqp,
        qg: vqg,
        vqp: (F_0 / s**2 - W - 2 * xi_tp / s * vqp - kappa_tp / s**2 * qp) / iota_p,
        vqg: (W - F_0 / s**2 - 2 * xi_tg / s * vqg - kappa_tg / s**2 * qg) / iota_g,
    }


def held(values: Mapping[str, float]) -> str:
    """Refuse two rotors that nothing ties to the ground: their common angle would drift."""
    if values["kappa_tp"] == 0.0 and values["kappa_tg"] == 0.0:
        return "kappa_tp = kappa_tg = 0: nothing holds the common angle of the rotors, expected one of them above 0"
    return ""
