"""The whole machine in kilograms, metres and seconds, written from mechanics; imports nothing of whirlmap.

Two shafts, each carrying one gear on two identical bearings whose housings move alike. Journals are
massless. The film is a short bearing with a porous ring: its pressure is integrated over the bearing by
brute force, and the velocity of a journal is whatever makes film force and shaft force cancel.

`literal_rates` is the other thing here: equations (30)-(41) of the paper typed from the print, in its polar
coordinates.
"""

from dataclasses import dataclass, replace
from math import cos, hypot, pi, sin, sqrt

import numpy as np
from scipy.optimize import brentq, root

GRAVITY = 9.81  # m/s^2, as in the audit's f = 0.4905


@dataclass(frozen=True)
class Machine:
    """Inputs of audit section 6.2, SI."""

    m_p: float = 10.0
    m_g: float = 40.0
    K_p: float = 4e6
    K_g: float = 8e6
    C_p: float = 250.0
    C_g: float = 700.0
    m_1: float = 5.0
    m_2: float = 10.0
    k_11: float = 2e7
    k_21: float = 4e7
    k_12: float = 1e15
    k_22: float = 2e15
    c_1: float = 1e3
    c_2: float = 2e3
    K_m: float = 1e8
    C_m: float = 2.8e3
    e_te: float = 5e-6
    e_up: float = 5e-6
    e_ug: float = 10e-6
    mu: float = 0.02
    c: float = 50e-6
    R_1: float = 25e-3
    L_1: float = 12e-3
    R_2: float = 30e-3
    L_2: float = 14.4e-3
    seepage: float = 0.0  # Phi H, m^3
    chi_p: float = 0.0
    chi_g: float = 0.0

    def scattered(self, rng: np.random.Generator) -> "Machine":
        """Every input times its own random factor, so that no two groups agree by accident."""
        names = [n for n in self.__dataclass_fields__ if n not in ("seepage", "chi_p", "chi_g")]
        factors = np.exp(rng.uniform(-0.4, 0.4, len(names)))
        made = {n: getattr(self, n) * f for n, f in zip(names, factors, strict=True)}
        chi_p, chi_g = rng.uniform(-3, 3, 2)
        return replace(self, **made, chi_p=chi_p, chi_g=chi_g)

    def permeable(self, psi: float) -> "Machine":
        """The same machine with 12 Phi H/c^3 = psi."""
        return replace(self, seepage=psi * self.c**3 / 12)

    @property
    def omega_0(self) -> float:
        """Pinion on its rigidly held shaft, rad/s."""
        return sqrt(self.K_p / self.m_p)

    def groups(
        self, s: float, *, r_p: float, r_g: float, r_m: float, j_p: float, j_g: float
    ) -> dict[str, float]:
        """Dimensionless groups of audit section 3.1 at the speed ratio s."""
        w0 = self.omega_0
        nu_1, nu_2 = self.m_1 / self.m_p, self.m_2 / self.m_p
        return {
            "s": s,
            "psi": 12 * self.seepage / self.c**3,
            "f": self.m_p * GRAVITY / (self.K_p * self.c),
            "Lambda": self.K_m / self.K_p,
            "xi_p": self.C_p / (2 * self.m_p * w0),
            "xi_g": self.C_g / (2 * self.m_g * w0),
            "xi_m": self.C_m / (2 * self.m_p * w0),
            "xi_1": self.c_1 / (2 * sqrt(self.k_11 * self.m_1)),
            "xi_2": self.c_2 / (2 * sqrt(self.k_21 * self.m_2)),
            "nu_g": self.m_g / self.m_p,
            "kappa_g": self.K_g / self.K_p,
            "nu_1": nu_1,
            "nu_2": nu_2,
            "S_1": w0 * sqrt(self.m_1 / self.k_11),
            "S_2": w0 * sqrt(self.m_2 / self.k_21),
            "a_1": self.k_12 * self.c**2 / (self.K_p * nu_1),
            "a_2": self.k_22 * self.c**2 / (self.K_p * nu_2),
            "b_p": self.e_up / self.c,
            "b_g": self.e_ug / self.c,
            "E": self.e_te / self.c,
            "Gamma_1": self.mu * self.R_1 * self.L_1**3 * w0 / (self.c**3 * self.K_p),
            "Gamma_2": self.mu * self.R_2 * self.L_2**3 * w0 / (self.c**3 * self.K_p),
            "r_p": r_p, "r_g": r_g, "r_m": r_m, "j_p": j_p, "j_g": j_g,
            "chi_p": self.chi_p, "chi_g": self.chi_g,
        }  # fmt: skip


# --- the film ----------------------------------------------------------------------------------------------

_X, _W = np.polynomial.legendre.leggauss(24)
_Z, _V = np.polynomial.legendre.leggauss(3)  # pressure is a parabola in z


def _graded(start: float, stop: float, centre: float, width: float) -> tuple[np.ndarray, np.ndarray]:
    """Gauss points and weights of [start, stop], in panels that narrow towards ``centre``."""
    cuts = [centre + sign * width * 2.0**k for k in range(-2, 14) for sign in (-1, 1)]
    cuts += [centre + 2 * pi * n + d for n in (-1, 1) for d in (-4 * width, -width, 0, width, 4 * width)]
    edges = np.array([start, *sorted(x for x in {centre, *cuts} if start < x < stop), stop])
    half, middle = np.diff(edges) / 2, (edges[1:] + edges[:-1]) / 2
    return (middle[:, None] + half[:, None] * _X).ravel(), (half[:, None] * _W).ravel()


def film_force(
    e: np.ndarray,
    e_dot: np.ndarray,
    spin: float,
    *,
    R: float,
    L: float,
    c: float,
    mu: float,
    seepage: float,
    arc: str,
) -> np.ndarray:
    """Force of the film on the journal, N: minus the integral of pressure times normal over (gamma, z).

    (h^3 + 12 Phi H) p_zz = 12 mu (spin/2 h_gamma + h_t) with p = 0 at both ends; gamma counts from +X.
    """
    size, towards = hypot(*e), np.arctan2(e[1], e[0])  # thinnest film where the journal is

    def source(gamma: np.ndarray) -> np.ndarray:
        normal, along = np.array([np.cos(gamma), np.sin(gamma)]), np.array([-np.sin(gamma), np.cos(gamma)])
        h_gamma, h_t = -(e @ along), -(e_dot @ normal)
        return 12 * mu * (spin / 2 * h_gamma + h_t)

    if arc == "fixed":  # the half that converges when the journal only spins: upstream of the thinnest film
        start, stop = (towards - pi, towards) if spin > 0 else (towards, towards + pi)
    else:  # wherever pressure is positive: where the source is negative
        coarse = np.linspace(towards - 3.0, towards - 3.0 + 2 * pi, 721)  # no zero of a pure spin on the grid
        value = source(coarse)
        rising = np.flatnonzero((value[:-1] < 0) & (value[1:] >= 0))
        falling = np.flatnonzero((value[:-1] >= 0) & (value[1:] < 0))
        if rising.size == 0 or falling.size == 0:
            return np.zeros(2)
        one = lambda g: float(source(np.array(g)))  # noqa: E731
        start = brentq(one, coarse[falling[0]], coarse[falling[0] + 1], xtol=1e-15)
        stop = brentq(one, coarse[rising[0]], coarse[rising[0] + 1], xtol=1e-15)
        if stop < start:
            stop += 2 * pi
    thin = max(c - size, 0.0) / c + (12 * seepage / c**3) ** (1 / 3)
    gamma, weight = _graded(start, stop, towards, sqrt(2 * thin) + 1e-3)
    h = c - e @ np.array([np.cos(gamma), np.sin(gamma)])
    z, v = L / 2 * _Z, L / 2 * _V
    p = -(source(gamma) / (h**3 + 12 * seepage))[:, None] / 2 * (L**2 / 4 - z**2)  # N/m^2
    line = (p * v).sum(axis=1) * weight * R
    return -np.array([np.cos(gamma) @ line, np.sin(gamma) @ line])


def journal_velocity(
    e: np.ndarray, load: np.ndarray, spin: float, *, speed: float, **film: float
) -> np.ndarray:
    """Velocity at which film force and load cancel, m/s; ``speed`` (m/s) is the unit of the search."""
    size = hypot(*load)
    if size == 0.0:
        return spin / 2 * np.array([-e[1], e[0]])

    def unbalance(v: np.ndarray) -> np.ndarray:
        return (film_force(e, v * speed, spin, **film) + load) / size

    def slopes(v: np.ndarray, step: float) -> np.ndarray:
        ups = [unbalance(v + d) - unbalance(v - d) for d in step * np.eye(2)]
        return np.array(ups).T / (2 * step)

    v = spin / (2 * speed) * np.array([-e[1], e[0]])
    if film["arc"] == "fixed":  # the film force is then affine in the velocity: any differences are exact
        for _ in range(3):
            v = v - np.linalg.solve(slopes(v, 1.0), unbalance(v))
    else:
        tries = [v + 0.3 * load / size * k for k in (1, 0.1, 3)]
        found = (root(unbalance, x, method="hybr", tol=1e-13) for x in tries)
        v = next(r.x for r in found if hypot(*r.fun) < 1e-6)
        for _ in range(4):  # polish: differences much shorter than |w|
            scale = hypot(*(v - spin / (2 * speed) * np.array([-e[1], e[0]])))
            v = v - np.linalg.solve(slopes(v, 1e-4 * scale), unbalance(v))
    assert hypot(*unbalance(v)) < 1e-11, "the independent force balance did not close"
    return v * speed


# --- Newton's equations ------------------------------------------------------------------------------------


def rates(machine: Machine, s: float, tau: float, x: np.ndarray, *, r_p: float, r_g: float, r_m: float,
          j_p: float, j_g: float, arc: str) -> np.ndarray:  # fmt: skip
    """Dimensionless rates d/d(tau) of the 20 states, from the dimensional machine."""
    q = machine
    clock = s * q.omega_0
    t = tau / clock
    e1, e2, P, G, H1, H2 = (q.c * x[i : i + 2] for i in range(0, 12, 2))
    vP, vG, vH1, vH2 = (q.c * clock * x[i : i + 2] for i in range(12, 20, 2))
    shaft_p, shaft_g = q.K_p * (P - H1 - e1), q.K_g * (G - H2 - e2)  # on both journals of a shaft together
    film = {"c": q.c, "mu": q.mu, "seepage": q.seepage, "arc": arc, "speed": q.c * clock}
    v1 = journal_velocity(e1, shaft_p / 2, j_p * clock, R=q.R_1, L=q.L_1, **film)
    v2 = journal_velocity(e2, shaft_g / 2, j_g * clock, R=q.R_2, L=q.L_2, **film)
    Omega, w_p, w_g = r_m * clock, r_p * clock, r_g * clock
    te = q.e_te * np.array([cos(Omega * t), sin(Omega * t)])
    te_rate = q.e_te * Omega * np.array([-sin(Omega * t), cos(Omega * t)])
    mesh = q.K_m * (P - G - te) + q.C_m * (vP - vG - te_rate)  # on the gear; its opposite on the pinion
    turn_p = np.array([cos(w_p * t + q.chi_p), sin(w_p * t + q.chi_p)])
    turn_g = np.array([cos(w_g * t + q.chi_g), sin(w_g * t + q.chi_g)])
    down = np.array([0.0, -GRAVITY])
    # The mass centre is off the geometric centre by e_u: m (a - e_u w^2 turn) = forces.
    a_p = (-q.C_p * vP - shaft_p - mesh) / q.m_p + q.e_up * w_p**2 * turn_p + down
    a_g = (-q.C_g * vG - shaft_g + mesh) / q.m_g + q.e_ug * w_g**2 * turn_g + down
    # One housing: its film carries half of the shaft's force; each axis has a linear and a cubic spring.
    a_1 = (-q.c_1 * vH1 - q.k_11 * H1 - q.k_12 * H1**3 + shaft_p / 2) / q.m_1 + down
    a_2 = (-q.c_2 * vH2 - q.k_21 * H2 - q.k_22 * H2**3 + shaft_g / 2) / q.m_2 + down
    unit = q.c * clock
    accelerations = [a / (unit * clock) for a in (a_p, a_g, a_1, a_2)]
    return np.concatenate([v1 / unit, v2 / unit, x[12:20], *accelerations])


# --- the print ---------------------------------------------------------------------------------------------


def printed_integrals(eps: float, psi: float, *, cubed: bool) -> tuple[float, float, float]:
    """beta, gamma, delta below (41): as printed, or with the gap cubed restored."""
    theta, weight = _graded(0.0, pi, pi, sqrt(2 * (1 - eps + psi ** (1 / 3))) + 1e-3)
    W = weight / ((1 + eps * np.cos(theta)) ** 3 + psi) if cubed else weight
    S, C = np.sin(theta), np.cos(theta)
    return float(W @ (S * C)), float(W @ (C * C)), float(W @ (S * S))


def literal_rates(
    machine: Machine, s: float, phi: float, x: np.ndarray, *, xi_5: float, cubed: bool
) -> np.ndarray:
    """Equations (30)-(41) as printed, from the paper's page, ' = d/d(phi); Cartesian states in and out.

    Mended: y_2 -> y_p in (30), C_om -> C_1p in (39), beta, gamma, delta of bearing 2 at eps_2 in (32), (33).
    As printed: alpha_1 and K_p in all four, 1/s^2 without mass or stiffness ratios in (36), (37), (40), (41).
    With ``cubed`` the film integrals and alpha_1 get their h^3 back.
    """
    q = machine
    w0 = q.omega_0
    omega = s * w0
    psi = 12 * q.seepage / q.c**3
    e_1, phi_1 = hypot(x[0], x[1]), np.arctan2(x[1], x[0])
    e_2, phi_2 = hypot(x[2], x[3]), np.arctan2(x[3], x[2])
    xp, yp, xg, yg, x1, y1, x2, y2 = x[4:12]
    dxp, dyp, dxg, dyg, dx1, dy1, dx2, dy2 = x[12:20]
    A = q.mu * q.L_1**3 * q.R_1 / (2 * q.c**2)
    alpha_1 = -A if cubed else -A / psi
    b1, g1, d1 = printed_integrals(e_1, psi, cubed=cubed)
    b2, g2, d2 = printed_integrals(e_2, psi, cubed=cubed)
    cK = q.c * q.K_p
    c1, s1, c2, s2 = cos(phi_1), sin(phi_1), cos(phi_2), sin(phi_2)
    X1, Y1 = xp - x1 - e_1 * c1, yp - y1 - e_1 * s1
    X2, Y2 = xg - x2 - e_2 * c2, yg - y2 - e_2 * s2
    # (30)-(33)
    de_1 = b1 * cK * (Y1 * c1 - X1 * s1) / (4 * alpha_1 * (g1 * d1 - b1**2) * omega) - d1 * cK * (
        X1 * c1 + Y1 * s1
    ) / (4 * alpha_1 * (g1 * d1 - b1**2) * omega)
    dphi_1 = (
        1 / 2
        - cK * (Y1 * c1 - X1 * s1) / (4 * alpha_1 * d1 * e_1 * omega)
        - b1**2 * cK * (Y1 * c1 - X1 * s1) / (4 * alpha_1 * e_1 * d1 * (g1 * d1 - b1**2) * omega)
        + b1**2 * cK * (Y1 * c1 + X1 * s1) / (4 * alpha_1 * e_1 * d1 * (g1 * d1 - b1**2) * omega)
    )
    de_2 = b2 * cK * (Y2 * c2 - X2 * s2) / (4 * alpha_1 * (g2 * d2 - b2**2) * omega) - d2 * cK * (
        X2 * c2 + Y2 * s2
    ) / (4 * alpha_1 * (g2 * d2 - b2**2) * omega)
    dphi_2 = (
        1 / 2
        - cK * (Y2 * c2 - X2 * s2) / (4 * alpha_1 * d2 * e_2 * omega)
        + b2**2 * cK * (Y2 * c2 + X2 * s2) / (4 * alpha_1 * e_2 * d2 * (g2 * d2 - b2**2) * omega)
        - b2 * d2 * cK * (X2 * c2 + Y2 * s2) / (4 * alpha_1 * e_2 * d2 * (g2 * d2 - b2**2) * omega)
    )
    # Groups of the print; beta and beta_g hold the squares of the speed ratios 1/4 and 1/8 (audit 2.E).
    xi_2, xi_4, xi_3 = q.C_p / (2 * q.m_p * w0), q.C_g / (2 * q.m_g * w0), q.C_m / (2 * q.m_p * w0)
    xi_1, xi_6 = q.c_1 / (2 * sqrt(q.k_11 * q.m_1)), q.c_2 / (2 * sqrt(q.k_21 * q.m_2))
    beta, beta_g = q.e_up / q.c / 16, q.e_ug / q.c / 64
    Lam, E, f = q.K_m / q.K_p, q.e_te / q.c, q.m_p * GRAVITY / (q.K_p * q.c)
    s_1, s_2 = omega * sqrt(q.m_1 / q.k_11), omega * sqrt(q.m_2 / q.k_21)
    C1p, C2p = q.m_1 / q.m_p, q.m_2 / q.m_p
    cubic_1, cubic_2 = q.k_12 * q.c**2 / (q.K_p * C1p), q.k_22 * q.c**2 / (q.K_p * C2p)
    # (34)-(41)
    ddxp = (-2 * xi_2 / s * dxp - X1 / s**2 + beta * cos(phi / 4) - 2 * xi_3 / s * (dxp - dxg - E * sin(phi))
            - Lam / s**2 * (xp - xg - E * cos(phi)))  # fmt: skip
    ddyp = (-2 * xi_2 / s * dyp - Y1 / s**2 + beta * sin(phi / 4) - f / s**2
            - 2 * xi_3 / s * (dyp - dyg - E * cos(phi)) - Lam / s**2 * (yp - yg - E * sin(phi)))  # fmt: skip
    ddxg = (-2 * xi_4 / s * dxg - X2 / s**2 + beta_g * cos(phi / 8)
            + 2 * xi_5 / s * (dxp - dxg - E * sin(phi))
            - Lam / s**2 * (xp - xg - E * cos(phi)))  # fmt: skip
    ddyg = (-2 * xi_4 / s * dyg - Y2 / s**2 + beta_g * sin(phi / 8)
            + 2 * xi_5 / s * (dyp - dyg - E * cos(phi))
            + Lam / s**2 * (yp - yg - E * sin(phi)) - f / s**2)  # fmt: skip
    ddx1 = -(2 * xi_1 / s_1 * dx1 + x1 / s_1**2 + cubic_1 / s**2 * x1**3 - X1 / (2 * C1p * s**2))
    ddy1 = -(2 * xi_1 / s_1 * dy1 + y1 / s_1**2 + cubic_1 / s**2 * y1**3 - Y1 / (2 * C1p * s**2) + f / s**2)
    ddx2 = -(2 * xi_6 / s_2 * dx2 + x2 / s_2**2 + cubic_2 / s**2 * x2**3 - X2 / (2 * C2p * s**2))
    ddy2 = -(2 * xi_6 / s_2 * dy2 + y2 / s_2**2 + cubic_2 / s**2 * y2**3 - Y2 / (2 * C2p * s**2) + f / s**2)
    journals = [
        de_1 * c1 - e_1 * dphi_1 * s1, de_1 * s1 + e_1 * dphi_1 * c1,
        de_2 * c2 - e_2 * dphi_2 * s2, de_2 * s2 + e_2 * dphi_2 * c2,
    ]  # fmt: skip
    return np.array([*journals, *x[12:20], ddxp, ddyp, ddxg, ddyg, ddx1, ddy1, ddx2, ddy2])
