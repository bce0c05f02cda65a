"""A gear pair with every physics switch, and its energy written from mechanics alone."""

import numpy as np
from sympy import lambdify, symbols

from whirlmap.equations import t
from whirlmap.films import porous_short
from whirlmap.films.law import plain_fixed_force
from whirlmap.integrate.system import System
from whirlmap.models import family, mesh
from whirlmap.models.gear_pair import BEYOND

VALUES = {
    "s": 1.7, "psi": 0.0, "f": 0.49, "Lambda": 25.0, "xi_p": 0.02, "xi_g": 0.014, "xi_m": 0.22, "xi_1": 0.05,
    "xi_2": 0.05, "nu_g": 4.0, "kappa_g": 2.0, "nu_1": 0.5, "nu_2": 1.0, "S_1": 0.32, "S_2": 0.32, "a_1": 1.25,
    "a_2": 1.25, "b_p": 0.1, "b_g": 0.2, "E": 0.3, "Gamma_1": 1.1, "Gamma_2": 2.3, "r_p": 1.0, "r_g": -0.5, "r_m": 20.0,
    "j_p": 1.0, "j_g": -0.5, "chi_p": 0.3, "chi_g": -1.0,
    "F_0": 0.8, "phi_m": 1.3, "v_1": 0.3, "v_2": -0.2, "v_3": 0.1, "chi_1": 0.4, "chi_2": 1.0, "chi_3": -2.0,
    "CR": 1.6, "v_m": 0.6, "chi_m": 0.5, "B_m": 0.05,
    "iota_p": 0.6, "iota_g": 2.5, "kappa_tp": 8.0, "kappa_tg": 5.0, "xi_tp": 0.1, "xi_tg": 0.2,
    "eps_r": 0.6, "kappa_r": 30.0, "mu_r": 0.2, "kappa_c1": 0.3, "kappa_c2": 0.6,
}  # fmt: skip


def pair(changes=None, **switches):
    model = family("gear_pair").model(**{"edition": "physical", **switches})
    values = {**VALUES, **(changes or {})}
    return System(model, {p.name: values[p.name] for p in model.parameters})


#: One of each switch on its own, and all of them at once.
SWITCHED = [
    {},
    {"suspension": "linear"},
    {"centring": "spring"},
    {"contact": "rub"},
    {"mesh": "line"},
    {"mesh": "line", "stiffness": "fourier"},
    {"mesh": "line", "stiffness": "rectangular"},
    {"mesh": "line", "backlash": "dead_zone"},
    {"mesh": "line", "torsion": "rigid_rotors"},
    {
        "mesh": "line", "stiffness": "rectangular", "backlash": "dead_zone", "torsion": "rigid_rotors", "contact": "rub",
        "centring": "spring", "suspension": "linear",
    },
]  # fmt: skip

#: Every film: switches, and changes of values.

ux, uy, wx, wy = symbols("ux uy wx wy", real=True)
_FILM = lambdify((ux, uy, wx, wy), plain_fixed_force(ux, uy, wx, wy), "math")


def film_force(u, slip, sense, psi, arc):
    """Force of a film from the velocity, the other way round than the model uses it."""
    if arc == "positive" or psi > 0.0:
        return np.array(porous_short.film_force(*u, *slip, psi, arc=arc, sigma=sense))
    force = np.array(_FILM(u[0], sense * u[1], slip[0], sense * slip[1]))  # mirrored where the journal turns clockwise
    return force * (1, sense)


class Energy:
    """Stored energy and power of one system, in m_p c^2 (clock speed)^2, written from mechanics alone."""

    def __init__(self, system):
        self.v = {name: float(value) for name, value in system.values.items()}
        self.on = {name for name, value in system.model.switches.items() if value != BEYOND.get(name)}
        self.switches, self.names = system.model.switches, [s.name for s in system.model.states]

    def at(self, time, x):
        """Unpack a state into vectors, and the mesh's deflection."""
        v, q = self.v, dict(zip(self.names, x, strict=True))
        for a, b in (("u1", "u1{}"), ("u2", "u2{}"), ("P", "{}p"), ("G", "{}g"), ("H1", "{}1"), ("H2", "{}2")):
            q[a] = np.array([q[b.format(axis)] for axis in "xy"])
        for a, b in (("vP", "p"), ("vG", "g"), ("v1", "1"), ("v2", "2")):
            q[a] = np.array([q[f"vx{b}"], q[f"vy{b}"]])
        phase = v["r_m"] * time
        if "mesh" not in self.on:
            turn = np.array([np.cos(phase), np.sin(phase)])
            slew = v["r_m"] * np.array([-turn[1], turn[0]])
            q["delta"], q["approach"] = q["P"] - q["G"], q["vP"] - q["vG"]
            q["te"], q["te_rate"], q["n"] = v["E"] * turn, v["E"] * slew, np.eye(2)
            return q
        q["n"] = np.array([np.cos(v["phi_m"]), np.sin(v["phi_m"])])
        q["delta"] = v["F_0"] / v["Lambda"] + q["n"] @ (q["P"] - q["G"])
        q["approach"] = q["n"] @ (q["vP"] - q["vG"])
        if "torsion" in self.on:
            q["delta"], q["approach"] = q["delta"] + q["qp"] - q["qg"], q["approach"] + q["vqp"] - q["vqg"]
        q["te"], q["te_rate"] = v["E"] * np.cos(phase), -v["E"] * v["r_m"] * np.sin(phase)
        return q

    def stiffness(self):
        """Mesh stiffness over its mean, and its rate; from the declaration, checked by a test of its own."""
        k = mesh.stiffness_over_mean(self.switches["stiffness"], self.v["r_m"] * t)
        numbers = {q: self.v[q.name] for q in k.free_symbols - {t}}
        return lambdify(t, k.subs(numbers)), lambdify(t, k.diff(t).subs(numbers))

    def pressed(self, deflection):
        if "backlash" not in self.on:
            return deflection
        return max(deflection, 0.0) + min(deflection + self.v["B_m"], 0.0)

    def stored(self, time, x, k):
        v, q = self.v, self.at(time, x)
        s2 = v["s"] ** 2
        d1, d2 = q["P"] - q["H1"] - q["u1"], q["G"] - q["H2"] - q["u2"]
        move = (q["vP"] @ q["vP"] + v["nu_g"] * q["vG"] @ q["vG"]) / 2
        move += v["nu_1"] * q["v1"] @ q["v1"] + v["nu_2"] * q["v2"] @ q["v2"]  # two housings of each
        high = v["f"] / s2 * (q["yp"] + v["nu_g"] * q["yg"] + 2 * v["nu_1"] * q["y1"] + 2 * v["nu_2"] * q["y2"])
        bent = (d1 @ d1 + v["kappa_g"] * d2 @ d2) / (2 * s2)
        for H, nu, S, a in ((q["H1"], "nu_1", "S_1", "a_1"), (q["H2"], "nu_2", "S_2", "a_2")):
            bent += v[nu] * H @ H / (v[S] ** 2 * s2)
            if self.switches["suspension"] == "cubic":
                bent += v[nu] * v[a] / s2 * np.sum(H**4) / 2
        loaded = self.pressed(q["delta"] - q["te"]) if "mesh" in self.on else q["delta"] - q["te"]
        bent += v["Lambda"] / (2 * s2) * k * np.sum(np.square(loaded))
        if "torsion" in self.on:
            move += (v["iota_p"] * q["vqp"] ** 2 + v["iota_g"] * q["vqg"] ** 2) / 2
            bent += (v["kappa_tp"] * q["qp"] ** 2 + v["kappa_tg"] * q["qg"] ** 2) / (2 * s2)
        for u, spring in ((q["u1"], "kappa_c1"), (q["u2"], "kappa_c2")):
            if "centring" in self.on:
                bent += v[spring] * u @ u / s2
            if "contact" in self.on:
                bent += v["kappa_r"] * max(np.hypot(*u) - v["eps_r"], 0.0) ** 2 / s2
        return move + high + bent

    def power(self, time, x, u_rates, k, k_rate):
        """What comes in through unbalance, transmission error, torque and varying teeth, less what is lost."""
        v, q = self.v, self.at(time, x)
        s2 = v["s"] ** 2
        lost = 2 / v["s"] * (v["xi_p"] * q["vP"] @ q["vP"] + v["xi_g"] * v["nu_g"] * q["vG"] @ q["vG"])
        for w, nu, xi, S in ((q["v1"], "nu_1", "xi_1", "S_1"), (q["v2"], "nu_2", "xi_2", "S_2")):
            lost += 4 * v[nu] * v[xi] / (v[S] * v["s"]) * w @ w
        come = 0.0
        turning = ((q["vP"], 1.0, "b_p", "r_p", "chi_p"), (q["vG"], v["nu_g"], "b_g", "r_g", "chi_g"))
        for velocity, mass, b, r, chi in turning:
            angle = v[r] * time + v[chi]
            come += mass * v[b] * v[r] ** 2 * velocity @ np.array([np.cos(angle), np.sin(angle)])
        deflection, rate = q["delta"] - q["te"], q["approach"] - q["te_rate"]
        pressed = self.pressed(deflection) if "mesh" in self.on else deflection
        tooth = 2 * v["xi_m"] / v["s"] * rate + v["Lambda"] / s2 * k * pressed
        lost += 2 * v["xi_m"] / v["s"] * np.sum(np.square(rate))
        come -= np.sum(tooth * q["te_rate"])
        come += v["Lambda"] / (2 * s2) * k_rate * np.sum(np.square(pressed))
        if "torsion" in self.on:
            come += v["F_0"] / s2 * (q["vqp"] - q["vqg"])
            lost += 2 / v["s"] * (v["xi_tp"] * q["vqp"] ** 2 + v["xi_tg"] * q["vqg"] ** 2)
        for u, w, Gamma, spin in ((q["u1"], u_rates[:2], "Gamma_1", v["j_p"]), (q["u2"], u_rates[2:], "Gamma_2", v["j_g"])):
            slip = w - spin / 2 * np.array([-u[1], u[0]])
            film = v[Gamma] * v["s"] * film_force(u, slip, np.sign(spin), v["psi"], self.switches["arc"])
            assert film @ slip <= 0, "a film takes energy from the half-speed frame, it never gives any"
            lost -= film @ w / s2
            eps = np.hypot(*u)
            if "contact" in self.on and eps > v["eps_r"]:
                N = 2 * v["kappa_r"] * (eps - v["eps_r"])
                come -= v["mu_r"] * N * np.sign(spin) * np.array([-u[1], u[0]]) @ w / eps / s2
        return come - lost, q
