"""The machine of `newton.py` with real teeth, torsion and rubbing journals, in SI; imports nothing of whirlmap.

Tooth forces act at the pitch point, along the common normal of the flanks; moments are cross products about the centres
of the wheels. So line of action, base radii and the signs of torsion come out of the geometry instead of going in.
"""

from dataclasses import dataclass, field, replace
from math import cos, hypot, pi, sin, sqrt

import numpy as np
from tests.independent.newton import GRAVITY, Machine, journal_velocity


@dataclass(frozen=True)
class Gearbox:
    """What a gearbox has beside the machine, SI; the pinion turns counter-clockwise."""

    machine: Machine = field(default_factory=Machine)
    T_p: float = 20.0  # torque into the pinion, with its rotation; negative where the gear drives
    z_p: int = 20
    z_g: int = 40
    module: float = 2.5e-3
    alpha: float = pi / 9
    beta: float = 0.3  # direction from pinion to gear
    harmonics: tuple[tuple[float, float], ...] = ()  # of the mesh stiffness: over its mean, phase
    play: float | None = None
    J_p: float = 0.01
    J_g: float = 0.2
    k_tp: float = 4e4
    k_tg: float = 9e4
    c_tp: float = 2.0
    c_tg: float = 5.0
    turning: bool = False
    K_r: float = 0.0
    mu_r: float = 0.0
    touch: float = 1e-6  # film thickness at which the surfaces touch
    k_c1: float = 0.0
    k_c2: float = 0.0

    def scattered(self, rng: np.random.Generator) -> "Gearbox":
        """Every number times its own random factor."""
        names = ["T_p", "module", "alpha", "J_p", "J_g", "k_tp", "k_tg", "c_tp", "c_tg", "K_r", "k_c1", "k_c2"]
        made = {n: getattr(self, n) * f for n, f in zip(names, np.exp(rng.uniform(-0.4, 0.4, len(names))), strict=True)}
        return replace(self, machine=self.machine.scattered(rng), beta=rng.uniform(-3, 3), **made)

    def groups(self) -> dict[str, float]:
        """Dimensionless groups beside those of the machine."""
        q = self.machine
        R_p = self.module * self.z_p * cos(self.alpha) / 2
        R_g = self.module * self.z_g * cos(self.alpha) / 2
        sense = 1 if self.T_p > 0 else -1
        found = {
            "F_0": abs(self.T_p) / R_p / (q.K_p * q.c),
            "phi_m": self.beta + sense * (pi / 2 - self.alpha),
            "iota_p": self.J_p / (q.m_p * R_p**2),
            "iota_g": self.J_g / (q.m_p * R_g**2),
            "kappa_tp": self.k_tp / (q.K_p * R_p**2),
            "kappa_tg": self.k_tg / (q.K_p * R_g**2),
            "xi_tp": self.c_tp / (2 * sqrt(q.K_p * q.m_p) * R_p**2),
            "xi_tg": self.c_tg / (2 * sqrt(q.K_p * q.m_p) * R_g**2),
            "eps_r": 1 - self.touch / q.c,
            "kappa_r": self.K_r / q.K_p,
            "mu_r": self.mu_r,
            "kappa_c1": self.k_c1 / q.K_p,
            "kappa_c2": self.k_c2 / q.K_p,
            "B_m": (self.play or 0.0) / q.c,
        }
        for n, (size, phase) in enumerate(self.harmonics, start=1):
            found |= {f"v_{n}": size, f"chi_{n}": phase}
        return found


def cross(a: np.ndarray, b: np.ndarray) -> float:
    """Moment of b at a, counter-clockwise."""
    return float(a[0] * b[1] - a[1] * b[0])


def quarter(a: np.ndarray) -> np.ndarray:
    """The vector turned by a quarter, counter-clockwise."""
    return np.array([-a[1], a[0]])


def wall(box: Gearbox, e: np.ndarray, spin: float) -> np.ndarray:
    """Force of one bearing's wall on its journal: normal, and friction against the sliding surface."""
    size = hypot(*e)
    depth = size - (box.machine.c - box.touch)
    if depth <= 0.0:
        return np.zeros(2)
    outwards = e / size
    slip = np.sign(spin) * quarter(outwards)  # the journal's surface at the contact runs with its spin
    return -box.K_r * depth * (outwards + box.mu_r * slip)


def rates(box: Gearbox, s: float, tau: float, x: np.ndarray, *, r_p: float, r_g: float, r_m: float,
          j_p: float, j_g: float, arc: str, cubic: bool = True) -> tuple[np.ndarray, float]:  # fmt: skip
    """Dimensionless rates of the 20 or 24 states, and the deflection of the teeth in m."""
    q = box.machine
    clock = s * q.omega_0
    unit, t = q.c * clock, tau / clock
    e1, e2, P, G, H1, H2 = (q.c * x[i : i + 2] for i in range(0, 12, 2))
    vP, vG, vH1, vH2 = (unit * x[i : i + 2] for i in range(12, 20, 2))
    shaft_p, shaft_g = q.K_p * (P - H1 - e1), q.K_g * (G - H2 - e2)
    film = {"c": q.c, "mu": q.mu, "seepage": q.seepage, "arc": arc, "speed": unit}
    load_1 = shaft_p / 2 - box.k_c1 * e1 + wall(box, e1, j_p)
    load_2 = shaft_g / 2 - box.k_c2 * e2 + wall(box, e2, j_g)
    v1 = journal_velocity(e1, load_1, j_p * clock, R=q.R_1, L=q.L_1, **film)
    v2 = journal_velocity(e2, load_2, j_g * clock, R=q.R_2, L=q.L_2, **film)

    # The teeth: normal of the flanks at the pitch point, as the gear is pushed.
    to_gear = np.array([cos(box.beta), sin(box.beta)])
    motion = (1 if box.T_p > 0 else -1) * quarter(to_gear)  # of the pushing tooth against the other one
    normal = cos(box.alpha) * motion + sin(box.alpha) * to_gear
    pitch_p, pitch_g = box.module * box.z_p / 2 * to_gear, -box.module * box.z_g / 2 * to_gear
    R_p, R_g = cross(pitch_p, normal), cross(pitch_g, normal)  # signed base radii
    angle_p = angle_g = spin_p = spin_g = 0.0
    if box.turning:  # from arcs along the line of action to angles, counter-clockwise
        (angle_p, angle_g), (spin_p, spin_g) = q.c * x[20:22] / (R_p, R_g), unit * x[22:24] / (R_p, R_g)
    phase = r_m * tau
    te, te_rate = q.e_te * cos(phase), -q.e_te * r_m * clock * sin(phase)
    stands = abs(box.T_p) / abs(R_p) / q.K_m
    delta = stands + normal @ (P + angle_p * quarter(pitch_p) - G - angle_g * quarter(pitch_g)) - te
    rate = normal @ (vP + spin_p * quarter(pitch_p) - vG - spin_g * quarter(pitch_g)) - te_rate
    pressed = delta
    if box.play is not None:
        pressed = max(delta, 0.0) + min(delta + box.play, 0.0)
    stiff = q.K_m * (1 + sum(v * cos(n * phase + chi) for n, (v, chi) in enumerate(box.harmonics, start=1)))
    tooth = (stiff * pressed + q.C_m * rate) * normal  # on the gear; its opposite on the pinion

    w_p, w_g = r_p * clock, r_g * clock
    turn_p = np.array([cos(w_p * t + q.chi_p), sin(w_p * t + q.chi_p)])
    turn_g = np.array([cos(w_g * t + q.chi_g), sin(w_g * t + q.chi_g)])
    down = np.array([0.0, -GRAVITY])
    a_p = (-q.C_p * vP - shaft_p - tooth) / q.m_p + q.e_up * w_p**2 * turn_p + down
    a_g = (-q.C_g * vG - shaft_g + tooth) / q.m_g + q.e_ug * w_g**2 * turn_g + down
    k_12, k_22 = (q.k_12, q.k_22) if cubic else (0.0, 0.0)
    a_1 = (-q.c_1 * vH1 - q.k_11 * H1 - k_12 * H1**3 + shaft_p / 2) / q.m_1 + down
    a_2 = (-q.c_2 * vH2 - q.k_21 * H2 - k_22 * H2**3 + shaft_g / 2) / q.m_2 + down
    found = [v1 / unit, v2 / unit, x[12:20], *(a / (unit * clock) for a in (a_p, a_g, a_1, a_2))]
    if box.turning:
        # The transmitted torque balances the static tooth force about each centre.
        drive, load = box.T_p, -box.T_p * R_g / R_p
        turns_p = (drive + cross(pitch_p, -tooth) - box.c_tp * spin_p - box.k_tp * angle_p) / box.J_p
        turns_g = (load + cross(pitch_g, tooth) - box.c_tg * spin_g - box.k_tg * angle_g) / box.J_g
        found += [x[22:24], np.array([R_p * turns_p, R_g * turns_g]) / (unit * clock)]
    return np.concatenate(found), delta
