"""Damped eigenvalues of rotors from parts against ROSS, a finite-element code for rotors of other authors.

ROSS is no dependency. What it answered is kept in `ross_parts.json`, with what it was asked. To ask it again, in an
environment of its own with ross-rotordynamics and plotly below 6:

    python test_ross_parts.py | ROSS_PYTHON ross_parts.py > ross_parts.json
"""

import json
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from tests.independent.finite_elements import Gearbox
from tests.independent.parts_of import machine_file
from tests.independent.test_parts import GEAR, PINION, SLENDER

import whirlmap

HERE = Path(__file__).parent
ROTORS = {
    "slender": SLENDER,
    "pinion": Gearbox((PINION,), None, speed=900.0, mu=0.015),
    "gear, faster": Gearbox((replace(GEAR, disks=((3, 35.0, 0.18, 0.34), (7, 4.0, 0.02, 0.04))),), None, 700.0, 0.01),
}


def question(box, system):
    """What ROSS is asked: the rotor, with the film coefficients of whirlmap at its own static equilibrium."""
    (rotor,), found = box.rotors, whirlmap.film_coefficients(system)
    bearings = []
    for i, b in enumerate(rotor.bearings, start=1):
        film = found[f"bearing{i}_pinion"]
        names = ("xx", "xy", "yx", "yy")
        K, C = film.K * film.W_c, film.C * film.W_c_omega
        numbers = {f"k{n}": float(v) for n, v in zip(names, K.ravel(), strict=True)}
        numbers |= {f"c{n}": float(v) for n, v in zip(names, C.ravel(), strict=True)}
        bearings.append({"station": b.station, "pedestal": b.pedestal, **numbers})
    return {"speed": box.speed, "pieces": rotor.pieces, "disks": rotor.disks, "bearings": bearings}


def loaded(folder, box):
    file = Path(folder) / "rotor.toml"
    file.write_text(machine_file(box), encoding="utf-8")
    return whirlmap.load(file)


@pytest.mark.parametrize("name", ROTORS)
def test_rotors_have_the_eigenvalues_of_ross(tmp_path, name, validate):
    """Every mode below 2.5 times the speed: to 1 % where it is lightly damped, else to 3 %."""
    kept, box, at = json.loads((HERE / "ross_parts.json").read_text()), ROTORS[name], list(ROTORS).index(name)
    system = loaded(tmp_path, box)
    asked = json.loads(json.dumps(question(box, system)))
    for one, other in zip(asked["bearings"], kept["asked"][at]["bearings"], strict=True):
        for key, value in one.items():
            assert other[key] == (value if key in ("station", "pedestal") else pytest.approx(value, rel=1e-6)), key
    assert {k: v for k, v in asked.items() if k != "bearings"} == {k: kept["asked"][at][k] for k in asked if k != "bearings"}
    theirs = np.array([complex(*z) for z in kept["answered"][at]])
    theirs = theirs[(np.abs(theirs) < 2.5 * box.speed) & (theirs.imag > -1e-6)]
    theirs = theirs[np.abs(theirs.real) > 1e-9 * np.abs(theirs)]  # without axial motion and torsion, which nothing damps
    assert theirs.size >= 5
    ours = whirlmap.linear_analysis(system).eigenvalues * box.speed
    error, damping = np.abs(ours[None] - theirs[:, None]).min(axis=1) / np.abs(theirs), -theirs.real / np.abs(theirs)
    validate(f"rotor from parts, {name}: relative distance of its eigenvalues from ROSS's", error, 0, tier="independent",
             source="ROSS, finite elements", within=np.where(damping < 0.3, 0.01, 0.03))  # fmt: skip


if __name__ == "__main__":
    with TemporaryDirectory() as folder:
        print(json.dumps([question(box, loaded(folder, box)) for box in ROTORS.values()]))
