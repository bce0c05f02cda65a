"""The paper's gear pair said by parts: a machine file with the numbers and switches of `gear_pair`."""

import numpy as np

#: Inputs of the gear pair in SI.
INPUTS = {
    "m_p": 10.0, "m_g": 40.0, "m_1": 5.0, "m_2": 9.0, "K_p": 2e7, "K_g": 5e7, "C_p": 300.0, "C_g": 900.0, "k_11": 1e7,
    "k_21": 2e7, "k_12": 1e15, "k_22": 2e15, "c_1": 2e3, "c_2": 3e3, "K_m": 1.3e7, "C_m": 1.1e3, "e_TE": 2e-6, "e_up": 5e-6,
    "e_ug": 7e-6, "mu": 0.03, "c": 50e-6, "R_1": 25e-3, "L_1": 12e-3, "R_2": 30e-3, "L_2": 15e-3, "H": 2e-3, "Phi": 1e-14,
    "speed": 314.0, "g": 9.81,
}  # fmt: skip
LINE = {"T_p": 20.0, "module": 2.5e-3, "alpha": np.pi / 9, "beta_c": 0.3}
TURNING = {"J_p": 0.01, "J_g": 0.2, "k_tp": 4e4, "k_tg": 9e4, "c_tp": 2.0, "c_tg": 5.0}
STEP = {"CR": 1.6, "v_m": 0.5, "chi_m": 0.7}
FOURIER = {"v_1": 0.3, "v_2": -0.2, "v_3": 0.1, "chi_1": 0.4, "chi_2": 1.1, "chi_3": -2.0}
RUB = {"K_r": 2e8, "h_r": 10e-6}

#: Names of the states by parts, and of the gear pair.
STATES = {
    "ux_b1": "u1x", "uy_b1": "u1y", "ux_b2": "u2x", "uy_b2": "u2y", "x_pinion": "xp", "y_pinion": "yp", "x_gear": "xg",
    "y_gear": "yg", "x_h1": "x1", "y_h1": "y1", "x_h2": "x2", "y_h2": "y2", "vx_pinion": "vxp", "vy_pinion": "vyp",
    "vx_gear": "vxg", "vy_gear": "vyg", "vx_h1": "vx1", "vy_h1": "vy1", "vx_h2": "vx2", "vy_h2": "vy2",
    "q_pinion": "qp", "q_gear": "qg", "vq_pinion": "vqp", "vq_gear": "vqg",
}  # fmt: skip


def scattered(values, rng):
    """Every positive number times its own random factor."""
    return {
        k: float(v * np.exp(rng.uniform(-0.4, 0.4))) if v > 0 and k not in ("alpha", "beta_c") else v
        for k, v in values.items()
    }


def pair_inputs(switches, q, chi_g):
    """Changes of `gear_pair` for these numbers."""
    units = {
        "m": "kg", "K": "N/m", "C": "N*s/m", "k_1": "N/m", "k_2": "N/m", "c_1": "N*s/m", "c_2": "N*s/m", "e": "m", "R": "m",
        "L": "m", "J": "kg*m^2",
    }  # fmt: skip
    special = {
        "k_12": "N/m^3", "k_22": "N/m^3", "mu": "Pa*s", "c": "m", "H": "m", "Phi": "m^2", "speed": "rad/s", "g": "m/s^2",
        "T_p": "N*m", "module": "m", "alpha": "rad", "beta_c": "rad", "k_tp": "N*m/rad", "k_tg": "N*m/rad",
        "c_tp": "N*m*s/rad", "c_tg": "N*m*s/rad", "j_n": "m", "h_r": "m", "k_c1": "N/m", "k_c2": "N/m", "k_11": "N/m",
        "k_21": "N/m", "K_r": "N/m", "C_m": "N*s/m", "K_m": "N/m",
    }  # fmt: skip
    pure = {*STEP, *FOURIER, "z_p", "z_g", "mu_r"}
    made = {}
    for name, value in q.items():
        unit = special.get(name) or next((units[k] for k in (name[:3], name[:1]) if k in units), "")
        made[name] = value if name in pure else f"{value!r} {unit}"
    if switches["edition"] == "intended":  # its clock ratios are those of the paper
        read = {"z_p": switches["mesh"] == "line", "z_g": switches["torsion"] != "none"}
        made = {name: value for name, value in made.items() if read.get(name, True)}
    if switches["suspension"] == "linear":
        del made["k_12"], made["k_22"]
    return made | {"chi_g": chi_g} | dict(switches)


def written(switches, q, chi_g):
    """The machine file."""
    film = "printed" if switches["film"] == "printed" else "porous" if q["Phi"] else "short"
    ring = f'H = "{q["H"]!r} m"\nPhi = "{q["Phi"]!r} m^2"' if film != "short" else ""
    rubs = switches["contact"] == "rub"
    wall = f'K_r = "{q["K_r"]!r} N/m"\nh_r = "{q["h_r"]!r} m"\nmu_r = {q["mu_r"]!r}' if rubs else ""
    cubic, turning, line = switches["suspension"] == "cubic", switches["torsion"] != "none", switches["mesh"] == "line"

    def shaft(name, p):
        J = f'J = "{q[f"J_{p}"]!r} kg*m^2"' if turning else ""
        return f"""[[shaft]]
name = "{name}"
m = "{q[f"m_{p}"]!r} kg"
K = "{q[f"K_{p}"]!r} N/m"
C = "{q[f"C_{p}"]!r} N*s/m"
{J}
"""

    def bearing(i, name):
        spring = f'k_c = "{q[f"k_c{i}"]!r} N/m"' if switches["centring"] == "spring" else ""
        k3 = f'k3 = "{q[f"k_{i}2"]!r} N/m^3"' if cubic else ""
        return f"""[[bearing]]
name = "b{i}"
shaft = "{name}"
two_alike = 2
support = "h{i}"
film = "{film}"
arc = "{switches["arc"]}"
contact = "{switches["contact"]}"
R = "{q[f"R_{i}"]!r} m"
L = "{q[f"L_{i}"]!r} m"
c = "{q["c"]!r} m"
{ring}
{wall}
{spring}
[[support]]
name = "h{i}"
m = "{q[f"m_{i}"]!r} kg"
k = "{q[f"k_{i}1"]!r} N/m"
c = "{q[f"c_{i}"]!r} N*s/m"
{k3}
"""

    def coupling(name, p):
        return f"""[[coupling]]
name = "to_{name}"
shaft = "{name}"
k_t = "{q[f"k_t{p}"]!r} N*m/rad"
c_t = "{q[f"c_t{p}"]!r} N*m*s/rad"
"""

    teeth = ""
    if line:
        teeth = f"""module = "{q["module"]!r} m"
alpha = "{q["alpha"]!r} rad"
beta_c = "{q["beta_c"]!r} rad"
T = "{q["T_p"]!r} N*m"
stiffness = "{switches["stiffness"]}"
backlash = "{switches["backlash"]}"
"""
        varying = {"fourier": FOURIER, "rectangular": STEP, "constant": {}}[switches["stiffness"]]
        teeth += "".join(f'{k} = "{v!r} rad"\n' if k.startswith("chi") else f"{k} = {v!r}\n" for k, v in varying.items())
        teeth += f'j_n = "{q["j_n"]!r} m"\n' if switches["backlash"] == "dead_zone" else ""
    return f"""model = "machine"
[operation]
reference = "pinion"
torsion = "{"free" if turning else "none"}"
speed = "{q["speed"]!r} rad/s"
g = "{q["g"]!r} m/s^2"
[lubricant]
mu = "{q["mu"]!r} Pa*s"
{shaft("pinion", "p")}{shaft("gear", "g")}{bearing(1, "pinion")}{bearing(2, "gear")}
[[mesh]]
name = "teeth"
driver = "pinion"
driven = "gear"
kind = "{switches["mesh"]}"
z = [{q["z_p"]}, {q["z_g"]}]
K_m = "{q["K_m"]!r} N/m"
C_m = "{q["C_m"]!r} N*s/m"
e_TE = "{q["e_TE"]!r} m"
{teeth}
[[unbalance]]
name = "up"
shaft = "pinion"
e = "{q["e_up"]!r} m"
[[unbalance]]
name = "ug"
shaft = "gear"
e = "{q["e_ug"]!r} m"
phase = "{chi_g!r} rad"
{coupling("pinion", "p") + coupling("gear", "g") if turning else ""}
"""
