"""Bearings by coefficients against ROSS, a finite-element code for rotors of other authors.

ROSS is no dependency. What it answered is kept in `ross_coefficients.json`, with what it was asked. To ask it again, in an
environment of its own with ross-rotordynamics and plotly below 6:

    python test_ross_coefficients.py | ROSS_PYTHON ross_coefficients.py > ross_coefficients.json
"""

import json
from pathlib import Path

import numpy as np
import pytest

import whirlmap

HERE = Path(__file__).parent
RPM = np.pi / 30
NAMES = ("kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy")

#: A vendor's table of a tilting-pad bearing, nearly symmetric, and of a plain one with cross-coupling.
PADS = {
    "kxx": (4.1e7, 5.0e7, 6.4e7), "kxy": (0.0, 0.0, 0.0), "kyx": (0.0, 0.0, 0.0), "kyy": (6.2e7, 7.1e7, 8.8e7),
    "cxx": (1.2e5, 7.0e4, 5.1e4), "cxy": (0.0, 0.0, 0.0), "cyx": (0.0, 0.0, 0.0), "cyy": (1.5e5, 9.0e4, 6.0e4),
}  # fmt: skip
PLAIN = {
    "kxx": (3.0e7, 2.6e7, 2.4e7), "kxy": (1.1e7, 1.6e7, 2.1e7), "kyx": (-4.0e7, -3.4e7, -3.1e7),
    "kyy": (7.0e7, 5.2e7, 4.3e7), "cxx": (9.0e4, 5.5e4, 4.1e4), "cxy": (-4.2e4, -2.0e4, -1.3e4),
    "cyx": (-4.1e4, -2.1e4, -1.3e4), "cyy": (2.4e5, 1.3e5, 9.0e4),
}  # fmt: skip
SPEEDS = [float(n * RPM) for n in (3000, 6000, 9000)]
ROTORS = [
    {
        "pieces": [[0.1, 0.08, 0.0]] * 10, "disks": [[3, 22.0, 0.12, 0.22], [6, 30.0, 0.2, 0.38]], "speeds": SPEEDS,
        "bearings": [{"station": 1, **PADS}, {"station": 9, **PADS}], "unbalance": [3, 4e-4, 0.5],
    },
    {
        "pieces": [[0.08, 0.07, 0.01]] * 4 + [[0.09, 0.09, 0.0]] * 4, "disks": [[8, 9.0, 0.04, 0.07], [4, 18.0, 0.08, 0.15]],
        "speeds": SPEEDS, "bearings": [{"station": 1, **PLAIN}, {"station": 6, **PLAIN}], "unbalance": [8, 1e-4, -1.0],
    },
]  # fmt: skip


def machine_file(q, speed):
    """The rotor as a case."""
    lines = ['model = "machine"', "[operation]", f'speed = "{speed!r} rad/s"', f'speed_max = "{q["speeds"][-1]!r} rad/s"',
             'g = "0 m/s^2"', "[[shaft]]", 'name = "rotor"', 'E = "211e9 Pa"', 'G = "81.2e9 Pa"',
             'rho = "7810 kg/m^3"', "modes = 5", "elements = ["]  # fmt: skip
    lines += [f' {{ L = "{L} m", d = "{d} m"{f", d_i = {chr(34)}{d_i} m{chr(34)}" if d_i else ""} }},'
              for L, d, d_i in q["pieces"]]  # fmt: skip
    lines += ["]"]
    for n, m, I_d, I_p in q["disks"]:
        lines += ["[[disk]]", 'shaft = "rotor"', f"at = {n}", f'm = "{m} kg"', f'I_d = "{I_d} kg*m^2"',
                  f'I_p = "{I_p} kg*m^2"']  # fmt: skip
    for i, b in enumerate(q["bearings"]):
        lines += ["[[bearing]]", f'name = "b{i}"', 'kind = "coefficients"', 'shaft = "rotor"', f"at = {b['station']}"]
        lines += ["table = ["]
        for row, at in enumerate(q["speeds"]):
            entries = [f'{n[0]}_{n[1:]} = "{b[n][row]!r} {"N/m" if n[0] == "k" else "N*s/m"}"' for n in NAMES]
            lines += [f' {{ speed = "{at!r} rad/s", {", ".join(entries)} }},']
        lines += ["]"]
    n, U, phase = q["unbalance"]
    lines += ["[[unbalance]]", 'shaft = "rotor"', f"at = {n}", f'U = "{U!r} kg*m"', f'phase = "{phase!r} rad"']
    return "\n".join(lines) + "\n"


def response(system):
    """Complex amplitudes of the states at the speed of the shaft: x = Re(X exp(i t)). The system is linear."""
    n, count = len(system.states), 8
    phases = 2 * np.pi * np.arange(count) / count
    forcing = np.array([system.rhs(t, np.zeros(n)) for t in phases])
    F = 2 / count * (forcing * np.exp(-1j * phases)[:, None]).sum(axis=0)
    return np.linalg.solve(1j * np.eye(n) - system.jacobian(0.0, np.zeros(n)), F)


@pytest.mark.parametrize("at", [pytest.param(0, marks=pytest.mark.slow), *range(1, len(ROTORS))])
def test_eigenvalues_and_unbalance_response_are_those_of_ross(tmp_path, at):
    """At the speeds of the table, to 0.5 %: eigenvalues below 2.5 times the highest, amplitudes of x and y everywhere."""
    kept, q = json.loads((HERE / "ross_coefficients.json").read_text()), ROTORS[at]
    assert kept["asked"][at] == json.loads(json.dumps(q))
    file = tmp_path / "rotor.toml"
    for speed, theirs in zip(q["speeds"], kept["answered"][at], strict=True):
        file.write_text(machine_file(q, speed), encoding="utf-8")
        system = whirlmap.load(file)
        poles = np.array([complex(*z) for z in theirs["eigenvalues"]])
        poles = poles[(np.abs(poles) < 2.5 * q["speeds"][-1]) & (poles.imag > -1e-6)]
        poles = poles[np.abs(poles.real) > 1e-9 * np.abs(poles)]  # without axial motion and torsion, which nothing damps
        assert poles.size >= 2
        ours = whirlmap.linear_analysis(system).eigenvalues * speed
        error = np.abs(ours[None] - poles[:, None]).min(axis=1) / np.abs(poles)
        assert error.max() < 5e-3, (poles / speed, error)
        machine = system.machine.case.parts.machine
        c_0, (rotor,) = 1e-4, machine.rotors
        X = response(system)
        of = {name: X[system.states.index(name)] for name in system.states}
        for axis, column in (("x", 0), ("y", 1)):
            modes = np.array([of[q.name] for q in rotor.coordinates(axis)])
            ours_at = c_0 * rotor.numbers.shapes @ modes
            theirs_at = np.array([complex(*station[column]) for station in theirs["amplitudes"]])
            assert np.abs(ours_at - theirs_at).max() < 5e-3 * np.abs(theirs_at).max(), axis


if __name__ == "__main__":
    print(json.dumps(ROTORS))
