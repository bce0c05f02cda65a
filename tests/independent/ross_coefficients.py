"""Rotors on bearings by coefficients in ROSS; imports nothing of whirlmap. Runs where ROSS is installed.

Reads rotors in SI as JSON, and writes ROSS's damped eigenvalues [rad/s] and its unbalance response [m] at each speed of the
tables. See `test_ross_coefficients.py`.
"""

import json
import os
import sys
import warnings

warnings.filterwarnings("ignore")  # of ROSS's other packages
answer = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)  # what they print, from C too, goes to stderr
import numpy as np  # noqa: E402
import ross as rs  # noqa: E402

STEEL = rs.Material(name="steel", rho=7810.0, E=211e9, G_s=81.2e9)
NAMES = ("kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy")


def answered(q: dict) -> list:
    """At each speed: eigenvalues, and complex amplitudes of x and y at every station."""
    shaft = [rs.ShaftElement(L=L, odl=d, idl=d_i, material=STEEL) for L, d, d_i in q["pieces"]]
    disks = [rs.DiskElement(n=n, m=m, Id=I_d, Ip=I_p) for n, m, I_d, I_p in q["disks"]]
    bearings = [
        rs.BearingElement(n=b["station"], frequency=q["speeds"], **{name: b[name] for name in NAMES}) for b in q["bearings"]
    ]
    rotor, made = rs.Rotor(shaft, disks, bearings), []
    (station, U, phase), dofs = q["unbalance"], rotor.number_dof
    response = rotor.run_unbalance_response([station], [U], [phase], frequency=np.array(q["speeds"])).forced_resp
    for i, speed in enumerate(q["speeds"]):
        found = rotor.run_modal(speed, num_modes=2 * rotor.ndof, sparse=False).evalues
        kept = [[z.real, z.imag] for z in sorted(found, key=abs) if 1e-3 * speed < abs(z) < 8 * speed]
        amplitudes = [
            [[z.real, z.imag] for z in response[dofs * n : dofs * n + 2, i]] for n in range(len(q["pieces"]) + 1)
        ]
        made.append({"eigenvalues": kept, "amplitudes": amplitudes})
    return made


if __name__ == "__main__":
    asked = json.load(sys.stdin)
    json.dump({"ross": rs.__version__, "asked": asked, "answered": [answered(q) for q in asked]}, answer, indent=1)
