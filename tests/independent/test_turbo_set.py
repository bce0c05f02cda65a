"""The geared two-shaft turbo-set of Yang et al. 2016 (JSV 381, 246) against ROSS, whose test suite holds its numbers.

A generator shaft with the gear at its end, driven by a turbine shaft over a pinion; bearings by constant coefficients, teeth
along their line of action, torsion free. What ROSS answered is kept in `ross_turbo_set.json`, with what it was asked. To ask
it again, in an environment of its own with ross-rotordynamics and plotly below 6:

    python test_turbo_set.py | ROSS_PYTHON ross_turbo_set.py > ross_turbo_set.json
"""

import json
from pathlib import Path

import numpy as np
import pytest

import whirlmap
from whirlmap.kernels.running.reference import reference_rates

HERE = Path(__file__).parent
MATERIAL = {"rho": 7800.0, "E": 207e9, "G_s": 79.5e9}
ALPHA, K_M, BASE, Z = float(np.radians(22.5)), 1e8, (0.5086, 0.03567), (328, 23)
#: Of each piece of the paper's shafts: length, diameter, elements.
PIECES = (
    [(0.1, 0.3, 1), (4.24, 0.3, 8), (1.16, 0.22, 3), (0.3, 0.22, 1)],
    [(0.3, 0.15, 1), (5.0, 0.15, 10), (0.1, 0.15, 1)],
)
#: Station of the file, mass, diametral and polar inertia.
DISKS = ([(1, 525.7, 16.1, 32.2), (9, 116.04, 3.115, 6.23)], [(11, 7.45, 0.0745, 0.149)])
WHEELS = ((13, 726.4, 56.95, 113.9), (0, 5.0, 0.002, 0.004))
BEARINGS = ([(0, 183.9e6, 200.4e6, 3e3), (12, 183.9e6, 200.4e6, 3e3)], [(1, 10.1e6, 41.6e6, 3e3), (12, 10.1e6, 41.6e6, 3e3)])
#: Speeds of the generator [rad/s]; the turbine turns 14.26 times as fast.
SPEEDS, HIGHEST = [20.0, 60.0, 100.0, 157.0], 1000.0
UNBALANCE = (1, 0.05)
PROBES = {"generator": (0, 1), "wheel_0": (0, 13), "wheel_1": (1, 0), "turbine": (1, 11)}
#: Names of the shafts, and how many bending modes of each are kept.
NAMES, MODES = ("low", "high"), 4


def question():
    """What ROSS is asked."""
    return {
        "material": MATERIAL, "K_m": K_M, "beta_c": 0.0, "speeds": SPEEDS, "highest": HIGHEST, "unbalance": UNBALANCE,
        "probes": PROBES,
        "shafts": [
            {
                "pieces": [[L / n, d] for L, d, n in PIECES[i] for _ in range(n)], "disks": DISKS[i],
                "bearings": BEARINGS[i],
                "wheel": [*WHEELS[i], Z[i], BASE[i]], "alpha": ALPHA,
            }
            for i in (0, 1)
        ],
    }  # fmt: skip


def machine():
    """The same as a machine from parts; a torsional spring of next to nothing holds the common rotation."""
    lines = [
        'model = "machine"', "[operation]", 'reference = "low"', 'torsion = "free"', 'speed = "157 rad/s"', 'g = "0 m/s^2"',
    ]  # fmt: skip
    for i, name in enumerate(NAMES):
        elements = [f'{{ L = "{L / n} m", d = "{d} m" }}' for L, d, n in PIECES[i] for _ in range(n)]
        lines += [
            "[[shaft]]", f'name = "{name}"', f"modes = {MODES}", f'E = "{MATERIAL["E"]} Pa"', f'G = "{MATERIAL["G_s"]} Pa"',
            f'rho = "{MATERIAL["rho"]} kg/m^3"', f"elements = [{', '.join(elements)}]",
        ]  # fmt: skip
        probes = {station: probe for probe, (shaft, station) in PROBES.items() if shaft == i}
        for n, m, I_d, I_p in (*DISKS[i], WHEELS[i]):
            lines += [
                "[[disk]]", f'name = "{probes.get(n, f"disk_{n}")}"', f'shaft = "{name}"', f"at = {n}", f'm = "{m} kg"',
                f'I_d = "{I_d} kg*m^2"', f'I_p = "{I_p} kg*m^2"',
            ]  # fmt: skip
        for j, (n, k_xx, k_yy, c) in enumerate(BEARINGS[i]):
            lines += [
                "[[bearing]]", f'name = "{name}_{j}"', f'shaft = "{name}"', f"at = {n}", 'kind = "coefficients"',
                f'k_xx = "{k_xx} N/m"', f'k_yy = "{k_yy} N/m"', f'c_xx = "{c} N*s/m"', f'c_yy = "{c} N*s/m"',
            ]  # fmt: skip
    module = float(2 * BASE[0] / (Z[0] * np.cos(ALPHA)))
    lines += [
        "[[mesh]]", 'name = "teeth"', 'driver = "low"', 'driven = "high"', f"at = [{WHEELS[0][0]}, {WHEELS[1][0]}]",
        f"z = [{Z[0]}, {Z[1]}]", f'module = "{module!r} m"', f'alpha = "{ALPHA!r} rad"', 'beta_c = "0 rad"', 'T = "1 N*m"',
        f'K_m = "{K_M} N/m"',
        "[[coupling]]", 'name = "grid"', 'shaft = "low"', "at = 0", 'k_t = "1e-3 N*m/rad"',
        "[[unbalance]]", 'name = "u"', 'shaft = "low"', f"at = {UNBALANCE[0]}", f'U = "{UNBALANCE[1]} kg*m"',
    ]  # fmt: skip
    return "\n".join([*lines, ""])


def eigenvalues_of_ross(speed):
    kept = json.loads((HERE / "ross_turbo_set.json").read_text())
    assert json.loads(json.dumps(question())) == kept["asked"]
    return np.array([complex(*z) for z in kept["answered"]["eigenvalues"][SPEEDS.index(speed)]])


def farthest(ours, theirs):
    return float((np.abs(ours[None] - theirs[:, None]).min(axis=1) / np.abs(theirs)).max())


@pytest.fixture
def system(tmp_path):
    file = tmp_path / "turbo_set.toml"
    file.write_text(machine(), encoding="utf-8")
    return whirlmap.load(file)


SOURCE = "Yang et al. 2016 by ROSS, finite elements"


def test_the_turbo_set_has_the_eigenvalues_of_ross(system, validate):
    """Below 1000 rad/s at the highest speed, with torsion and teeth: of the equations as they stand, which are linear."""
    rates = reference_rates(system.model, forced=False)
    n = len(system.states)
    A = np.stack([rates(0.0, e, system.vector) - rates(0.0, np.zeros(n), system.vector) for e in np.eye(n)], axis=1)
    apart = farthest(np.linalg.eigvals(A) * SPEEDS[-1], eigenvalues_of_ross(SPEEDS[-1]))
    what = "turbo-set: largest relative distance of an eigenvalue below 1000 rad/s"
    validate(what, apart, 0, tier="independent", source=SOURCE, within=1e-3)


@pytest.mark.slow
def test_the_turbo_set_responds_as_in_ross(system, validate):
    """Eigenvalues by `linear_analysis` at four speeds, and amplitudes of both shafts under an unbalance of the generator."""
    unit, apart = float(system.values["s"]) / SPEEDS[-1], list[float]()
    for speed in SPEEDS:
        ours = whirlmap.linear_analysis(system.replace(s=unit * speed)).eigenvalues * speed
        apart.append(farthest(ours, eigenvalues_of_ross(speed)))
    what = "turbo-set at four speeds: largest relative distance of an eigenvalue"
    validate(what, apart, 0, tier="independent", source=SOURCE, within=1e-3)
    ds = whirlmap.unbalance_response(system, "s", unit * np.array(SPEEDS)).sel(rotor="low")
    answered = json.loads((HERE / "ross_turbo_set.json").read_text())["answered"]["response"]
    c_0 = 1e-4  # what lengths of a machine without films are over [m]
    for name, both in answered.items():
        for axis, theirs in zip("xy", both, strict=True):
            ratio = ds["amplitude"].sel(station=name, axis=axis).values * c_0 / np.array(theirs)
            what = f"turbo-set: amplitude of {name} along {axis}, over ROSS's"
            validate(what, ratio, np.ones(len(SPEEDS)), tier="independent", source=SOURCE, within=1e-3)


if __name__ == "__main__":
    print(json.dumps(question()))
