"""The geared two-shaft turbo-set of Yang et al. 2016 in ROSS; imports nothing of whirlmap. See `test_turbo_set.py`."""

import json
import sys

import numpy as np
from ross_parts import answer, rs


def rotor(q: dict, material: "rs.Material") -> "rs.Rotor":
    """One shaft with its disks, its wheel and its bearings."""
    shaft = [rs.ShaftElement(L=L, odl=d, idl=0.0, material=material) for L, d in q["pieces"]]
    disks = [rs.DiskElement(n=n, m=m, Id=I_d, Ip=I_p) for n, m, I_d, I_p in q["disks"]]
    n, m, I_d, I_p, z, base = q["wheel"]
    wheel = rs.GearElement(n=n, m=m, Id=I_d, Ip=I_p, n_teeth=z, base_diameter=2 * base, pr_angle=q["alpha"])
    bearings = [rs.BearingElement(n=n, kxx=k_xx, kyy=k_yy, cxx=c, cyy=c) for n, k_xx, k_yy, c in q["bearings"]]
    return rs.Rotor(shaft, [*disks, wheel], bearings)


def solved(q: dict) -> dict:
    """Damped eigenvalues [rad/s] at each speed, and the response to an unbalance of the first shaft [m]."""
    material = rs.Material(name="steel", **q["material"])
    first, second = (rotor(one, material) for one in q["shafts"])
    coupled = (q["shafts"][0]["wheel"][0], q["shafts"][1]["wheel"][0])
    both = rs.MultiRotor(first, second, coupled_nodes=coupled, gear_mesh_stiffness=q["K_m"], orientation_angle=q["beta_c"])
    made = []
    for speed in q["speeds"]:
        found = both.run_modal(speed, num_modes=2 * both.ndof, sparse=False).evalues
        made.append(
            [[z.real, z.imag] for z in sorted(found, key=abs) if 1e-3 * speed < abs(z) < q["highest"] and z.imag >= 0]
        )
    station, U = q["unbalance"]
    response = both.run_unbalance_response([station], [U], [0.0], frequency=np.array(q["speeds"])).forced_resp
    first_of_second = len(q["shafts"][0]["pieces"]) + 1
    moved = {}
    for name, i in q["probes"].items():
        node = i[1] + (first_of_second if i[0] else 0)
        moved[name] = [[abs(z) for z in response[both.number_dof * node + axis]] for axis in (0, 1)]
    return {"eigenvalues": made, "response": moved}


if __name__ == "__main__":
    asked = json.load(sys.stdin)
    json.dump({"ross": rs.__version__, "asked": asked, "answered": solved(asked)}, answer, indent=1)
