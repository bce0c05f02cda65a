"""The worked machines as finite-element rotors of ROSS; imports nothing of whirlmap.

Runs where ROSS is installed: reads machines in SI as JSON, with the linear coefficients of their films, and writes ROSS's
damped eigenvalues [rad/s] and bearing coefficients. `test_ross.py` says how.
"""

import json
import os
import sys
import warnings
from math import pi, sqrt

import numpy as np

warnings.filterwarnings("ignore")  # of ROSS's other packages
answer = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)  # what they print, from C too, goes to stderr
import ross as rs  # noqa: E402

#: Density [kg/m3] at which a shaft weighs below 1e-7 of what it carries: the shafts of whirlmap have no mass.
LIGHT = 1e-3
#: Frequency [rad/s] below which eigenvalues are kept: above every mode of the machines, below those of the shafts' own mass.
HIGHEST = 2e4
LENGTH, YOUNG = 0.4, 2.1e11


def shaft(stiffness: float) -> list:
    """Two beams of one slender shaft whose stiffness at its middle is 48 E I/l^3."""
    inertia = stiffness * LENGTH**3 / (48 * YOUNG)
    steel = rs.Material(name="light", rho=LIGHT, E=YOUNG, G_s=8.1e10)
    beam = {"L": LENGTH / 2, "idl": 0.0, "odl": sqrt(sqrt(64 * inertia / pi)), "material": steel}
    slender = {"shear_effects": False, "rotary_inertia": False, "gyroscopic": False}
    return [rs.ShaftElement(**beam, **slender) for _ in range(2)]


def eigenvalues(rotor: "rs.Rotor", speed: float) -> list:
    """Damped eigenvalues as pairs of real and imaginary part, the slowest first."""
    found = rotor.run_modal(speed, num_modes=2 * rotor.ndof, sparse=False).evalues
    return [[z.real, z.imag] for z in sorted(found, key=abs) if abs(z) < HIGHEST]


def jeffcott(q: dict) -> list:
    """A disc in the middle of a shaft on two films."""
    disc = rs.DiskElement(n=1, m=q["M"], Id=1e-9, Ip=1e-9)  # does not tilt
    air = rs.BearingElement(n=1, kxx=0.0, cxx=q["C"])
    films = [rs.BearingElement(n=n, **q["film"]) for n in (0, 2)]
    return eigenvalues(rs.Rotor(shaft(2 * q["K"]), [disc], [*films, air]), q["speed"])


def on_housings(q: dict) -> list:
    """A disc in the middle of a shaft on two films, each in a housing on a spring and a damper."""
    disc = rs.DiskElement(n=1, m=q["m"], Id=1e-9, Ip=1e-9)
    elements, masses = [rs.BearingElement(n=1, kxx=0.0, cxx=q["C"])], []
    for node, housing in ((0, 3), (2, 4)):
        elements.append(rs.BearingElement(n=node, n_link=housing, **q["film"]))
        elements.append(rs.BearingElement(n=housing, kxx=q["k"], cxx=q["c"]))
        masses.append(rs.PointMass(n=housing, m=q["m_h"]))
    return eigenvalues(rs.Rotor(shaft(q["K"]), [disc], elements, masses), q["speed"])


def gearbox(q: dict) -> list:
    """Two rotors in rigid housings whose teeth press along their line of action; nothing holds their common rotation."""
    rotors = []
    for w in (q["pinion"], q["gear"]):
        inertia = {"m": w["m"], "Id": w["J"] / 2, "Ip": w["J"]}
        gear = rs.GearElement(
            n=1, n_teeth=w["z"], pitch_diameter=q["module"] * w["z"], pr_angle=q["alpha"], **inertia
        )  # fmt: skip
        films = [rs.BearingElement(n=n, **w["film"]) for n in (0, 2)]
        rotors.append(rs.Rotor(shaft(w["K"]), [gear], [*films, rs.BearingElement(n=1, kxx=0.0, cxx=w["C"])]))
    both = rs.MultiRotor(*rotors, coupled_nodes=(1, 1), gear_mesh_stiffness=q["K_m"], orientation_angle=q["beta_c"])
    return eigenvalues(both, q["speed"])


def bearing(q: dict) -> dict:
    """ROSS's own short bearing, Friswell et al. 2010, p. 177."""
    sizes = {"bearing_length": q["L"], "journal_diameter": 2 * q["R"], "radial_clearance": q["c"], "oil_viscosity": q["mu"]}
    made = rs.CylindricalBearing(n=0, speed=np.array([q["speed"]]), weight=q["W"], **sizes)
    names = ("kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy")
    return {"eccentricity": float(made.eccentricity[0]), **{name: float(getattr(made, name)[0]) for name in names}}


MACHINES = {"jeffcott": jeffcott, "on_housings": on_housings, "gearbox": gearbox, "bearing": bearing}

if __name__ == "__main__":
    asked = json.load(sys.stdin)
    made = {name: [MACHINES[name](q) for q in machines] for name, machines in asked.items()}
    json.dump({"ross": rs.__version__, "asked": asked, "answered": made}, answer, indent=1)
