"""Unbalance response of rotors of beam elements in ROSS; imports nothing of whirlmap. See `test_ross_response.py`."""

import json
import sys

import numpy as np
from ross_parts import STEEL, answer, rs


def response(q: dict) -> dict:
    """Amplitude [m] and phase lag [rad] along x and y at every station, at the speed asked for."""
    shaft = [rs.ShaftElement(L=L, odl=d, idl=d_i, material=STEEL) for L, d, d_i in q["pieces"]]
    disks = [rs.DiskElement(n=n, m=m, Id=I_d, Ip=I_p) for n, m, I_d, I_p in q["disks"]]
    names = ("kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy")
    bearings = [rs.BearingElement(n=b["station"], **{name: b[name] for name in names}) for b in q["bearings"]]
    rotor = rs.Rotor(shaft, disks, bearings)
    stations, sizes, phases = zip(*q["unbalances"], strict=True)
    found = rotor.run_unbalance_response(list(stations), list(sizes), list(phases), frequency=np.array([q["speed"]]))
    moved = found.forced_resp[:, 0]
    at = rotor.number_dof * np.arange(len(shaft) + 1)
    return {axis: [[abs(z), float(-np.angle(z))] for z in moved[at + i]] for i, axis in enumerate("xy")}


if __name__ == "__main__":
    asked = json.load(sys.stdin)
    json.dump({"ross": rs.__version__, "asked": asked, "answered": [response(q) for q in asked]}, answer, indent=1)
