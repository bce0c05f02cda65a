"""Machine files of the gearboxes of `finite_elements.py`."""


def machine_file(box, *, modes=None, operation=""):
    """The text of a case file with the numbers of a `finite_elements.Gearbox`."""
    names = ["pinion", "gear"][: len(box.rotors)]
    text = [f"""model = "machine"
[operation]
reference = "pinion"
torsion = "{"free" if box.couplings else "none"}"
speed = "{box.speed!r} rad/s"
g = "9.81 m/s^2"
{operation}
[lubricant]
mu = "{box.mu!r} Pa*s"
"""]
    for name, rotor in zip(names, box.rotors, strict=True):
        pieces = ", ".join(f'{{ L = "{L!r} m", d = "{d!r} m", d_i = "{d_i!r} m" }}' for L, d, d_i in rotor.pieces)
        kept = "" if modes is None else f"modes = {modes}"
        text.append(f'[[shaft]]\nname = "{name}"\nmaterial = "steel"\nelements = [ {pieces} ]\n{kept}\n')
        for i, (station, m, I_d, I_p) in enumerate(rotor.disks, start=1):
            text.append(f"""[[disk]]
name = "disk{i}_{name}"
shaft = "{name}"
at = {station}
m = "{m!r} kg"
I_d = "{I_d!r} kg*m^2"
I_p = "{I_p!r} kg*m^2"
""")
        for i, b in enumerate(rotor.bearings, start=1):
            held = f'support = "pedestal{i}_{name}"' if b.pedestal else ""
            text.append(f"""[[bearing]]
name = "bearing{i}_{name}"
shaft = "{name}"
at = {b.station}
arc = "{b.arc}"
R = "{b.R!r} m"
L = "{b.L!r} m"
c = "{b.c!r} m"
{held}
""")
            if b.pedestal:
                m, k, c = b.pedestal
                text.append(f"""[[support]]
name = "pedestal{i}_{name}"
m = "{m!r} kg"
k = "{k!r} N/m"
c = "{c!r} N*s/m"
""")
        for i, (station, U, phase) in enumerate(rotor.unbalances, start=1):
            text.append(f"""[[unbalance]]
name = "unbalance{i}_{name}"
shaft = "{name}"
at = {station}
U = "{U!r} kg*m"
phase = "{phase!r} rad"
""")
    for shaft, station, k_t, c_t in box.couplings or ():
        text.append(f"""[[coupling]]
name = "coupling_{names[shaft]}"
shaft = "{names[shaft]}"
at = {station}
k_t = "{k_t!r} N*m/rad"
c_t = "{c_t!r} N*m*s/rad"
""")
    if box.mesh:
        m = box.mesh
        text.append(f"""[[mesh]]
name = "teeth"
driver = "pinion"
driven = "gear"
at = {list(m.stations)}
z = {list(m.z)}
module = "{m.module!r} m"
alpha = "{m.alpha!r} rad"
beta_c = "{m.beta!r} rad"
K_m = "{m.K!r} N/m"
C_m = "{m.C!r} N*s/m"
e_TE = "{m.error!r} m"
T = "{m.torque!r} N*m"
""")
    return "\n".join(text)
