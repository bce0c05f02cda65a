"""Rotors of beam elements in ROSS; imports nothing of whirlmap. Runs where ROSS is installed: see `test_ross_parts.py`.

Reads rotors in SI as JSON, with the stiffness and damping of their films, and writes ROSS's damped eigenvalues [rad/s].
"""

import json
import os
import sys
import warnings

warnings.filterwarnings("ignore")  # of ROSS's other packages
answer = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)  # what they print, from C too, goes to stderr
import ross as rs  # noqa: E402

STEEL = rs.Material(name="steel", rho=7810.0, E=211e9, G_s=81.2e9)


def eigenvalues(q: dict) -> list:
    """Damped eigenvalues as pairs of real and imaginary part, the slowest first."""
    shaft = [rs.ShaftElement(L=L, odl=d, idl=d_i, material=STEEL) for L, d, d_i in q["pieces"]]
    disks = [rs.DiskElement(n=n, m=m, Id=I_d, Ip=I_p) for n, m, I_d, I_p in q["disks"]]
    bearings, masses = [], []
    for i, b in enumerate(q["bearings"]):
        film = {name: b[name] for name in ("kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy")}
        if b["pedestal"]:
            m, k, c = b["pedestal"]
            node = len(shaft) + 1 + i
            bearings.append(rs.BearingElement(n=b["station"], n_link=node, **film))
            bearings.append(rs.BearingElement(n=node, kxx=k, cxx=c))
            masses.append(rs.PointMass(n=node, m=m))
        else:
            bearings.append(rs.BearingElement(n=b["station"], **film))
    nodes = sorted({b.n for b in bearings if b.n > len(shaft)})
    for element in (*bearings, *masses):  # pedestals are numbered from the shaft's last station on
        if element.n > len(shaft):
            element.n = element.n_l = element.n_r = len(shaft) + 1 + nodes.index(element.n)
        if getattr(element, "n_link", None):
            element.n_link = len(shaft) + 1 + nodes.index(element.n_link)
    rotor = rs.Rotor(shaft, disks, bearings, masses)
    found = rotor.run_modal(q["speed"], num_modes=2 * rotor.ndof, sparse=False).evalues
    return [[z.real, z.imag] for z in sorted(found, key=abs) if 1e-3 * q["speed"] < abs(z) < 8 * q["speed"]]


if __name__ == "__main__":
    asked = json.load(sys.stdin)
    json.dump({"ross": rs.__version__, "asked": asked, "answered": [eigenvalues(q) for q in asked]}, answer, indent=1)
