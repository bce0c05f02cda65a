"""The integrally geared compressor against unreduced finite-element matrices of three shafts and two meshes: eigenvalues.

The file's numbers are read as text, and everything else is done again: elements by quadrature, films by integration over
their half circle, teeth and torsion by the geometry of the pitch point.
"""

import re
import tomllib
from math import cos, pi, sin
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import root
from tests.independent.finite_elements import GAUSS, GRAVITY, RHO, WEIGHT, Bearing, beam, film
from tests.independent.finite_elements import G as SHEAR

import whirlmap

CASE = "machines/integrally-geared-compressor"
FILE = Path(whirlmap.__file__).parent / "cases" / f"{CASE}.toml"
UNITS = {"mm": 1e-3, "um": 1e-6, "rpm": pi / 30, "kW": 1e3, "deg": pi / 180}
#: Largest relative difference, by the damping ratio below and above 0.3.
LIGHT, HEAVY = 0.01, 0.03


def number(entry, key):
    """A number of the file in SI."""
    one = entry[key]
    if isinstance(one, str):
        value, unit = re.fullmatch(r"(\S+) (\S+)", one).groups()
        return float(value) * UNITS.get(unit, 1.0)
    return one["value"] * UNITS.get(one.get("unit", ""), 1.0)


class Compressor:
    """Coordinates: x, dx/dz, y, dy/dz of every station, then the angle of every station about the uniform rotation."""

    def __init__(self, mu):
        case = tomllib.loads(FILE.read_text(encoding="utf-8"))
        self.mu, self.speed = mu, number(case["operation"], "speed")
        self.shafts = [one["name"] for one in case["shaft"]]
        z = {"bull_shaft": 1.0, **{m["driven"]: -m["z"]["value"][0] / m["z"]["value"][1] for m in case["mesh"]}}
        self.spins = {name: self.speed * z[name] for name in self.shafts}
        self.stations = {one["name"]: len(one["elements"]) + 1 for one in case["shaft"]}
        self.first, self.angle, n = {}, {}, 0
        for name, count in self.stations.items():
            self.first[name], self.angle[name] = n, n + 4 * count
            n += 5 * count
        self.M, self.C, self.K = (np.zeros((n, n)) for _ in range(3))
        self.down, self.n = np.zeros(n), n
        for one in case["shaft"]:
            self._shaft(one["name"], [(number(e, "L"), number(e, "d"), 0.0) for e in one["elements"]])
        for one in case["disk"]:
            j, spin = self.at(one), self.spins[one["shaft"]]
            m, I_d, I_p = (number(one, key) for key in ("m", "I_d", "I_p"))
            self.M[[j, j + 2], [j, j + 2]] += m
            self.M[[j + 1, j + 3], [j + 1, j + 3]] += I_d
            self.C[j + 1, j + 3] += spin * I_p
            self.C[j + 3, j + 1] -= spin * I_p
            k = self.angle[one["shaft"]] + one["at"]
            self.M[k, k] += I_p
        self.load = -GRAVITY * self.M @ self.down
        for one in case["mesh"]:
            self._mesh(one, number(case["operation"], "speed_max"))
        for one in case["coupling"]:
            k = self.angle[one["shaft"]] + one["at"]
            self.K[k, k] += number(one, "k_t")
            self.C[k, k] += number(one, "c_t")
        self.bearings = [
            (self.at(b), self.spins[b["shaft"]], Bearing(b["at"], *(number(b, key) for key in "RLc")))
            for b in case["bearing"]
        ]

    def at(self, entry):
        return self.first[entry["shaft"]] + 4 * entry["at"]

    def _shaft(self, name, pieces):
        for k, (L, d, d_i) in enumerate(pieces):
            M, gyro, K = beam(L, d, d_i)
            j, spin = self.first[name] + 4 * k, self.spins[name]
            x, y = [j, j + 1, j + 4, j + 5], [j + 2, j + 3, j + 6, j + 7]
            for rows in (x, y):
                self.M[np.ix_(rows, rows)] += M
                self.K[np.ix_(rows, rows)] += K
            self.C[np.ix_(x, y)] += spin * gyro
            self.C[np.ix_(y, x)] -= spin * gyro
            self.down[[j + 2, j + 6]] = 1.0
            polar, two = pi * d**4 / 32, [self.angle[name] + k, self.angle[name] + k + 1]
            for place, weight in zip(GAUSS, WEIGHT, strict=True):
                shape = np.array([(1 - place) / 2, (1 + place) / 2])
                self.M[np.ix_(two, two)] += RHO * polar * L / 2 * weight * np.outer(shape, shape)
            self.K[np.ix_(two, two)] += SHEAR * polar / L * np.array([[1, -1], [-1, 1]])

    def _mesh(self, one, full_speed):
        """The bull gear turns from x to y and drives: its teeth push ahead of their motion, at the pitch point."""
        beta, alpha = number(one, "beta_c"), number(one, "alpha")
        z = one["z"]["value"]
        n_x, n_y = cos(beta + pi / 2 - alpha), sin(beta + pi / 2 - alpha)
        across = np.zeros(self.n)
        for key, station, teeth, way in (("driver", one["at"][0], z[0], 1), ("driven", one["at"][1], z[1], -1)):
            j, place = self.first[one[key]] + 4 * station, way * number(one, "module") * teeth / 2
            across[[j, j + 2]] = way * n_x, way * n_y
            across[self.angle[one[key]] + station] = way * place * (cos(beta) * n_y - sin(beta) * n_x)
        self.K += number(one, "K_m") * np.outer(across, across)
        self.C += number(one, "C_m") * np.outer(across, across)
        W = number(one, "P") / full_speed / (number(one, "module") * z[0] / 2 * cos(alpha))
        lateral = across.copy()
        for name in (one["driver"], one["driven"]):  # the rotation is counted from the twisted state
            lateral[self.angle[name] : self.angle[name] + self.stations[name]] = 0.0
        self.load = self.load - W * lateral

    def equilibrium(self, guess):
        def left(u):
            q = 1e-6 * u
            force = self.load - self.K @ q
            for j, spin, b in self.bearings:
                force[[j, j + 2]] += film(b, self.mu, spin, q[[j, j + 2]], np.zeros(2))
            return force / np.abs(self.load).max()

        found = root(left, guess / 1e-6, tol=1e-12)
        assert np.abs(found.fun).max() < 1e-8, found.message
        return 1e-6 * found.x

    def eigenvalues(self, q):
        K, C = self.K.copy(), self.C.copy()
        for j, spin, b in self.bearings:
            rows = np.array([j, j + 2])
            for k, e in enumerate(np.eye(2)):
                step, still = 1e-5 * b.c * e, np.zeros(2)
                for matrix, dq, dv in ((K, step, still), (C, still, abs(spin) * step)):
                    change = film(b, self.mu, spin, q[rows] + dq, dv) - film(b, self.mu, spin, q[rows] - dq, -dv)
                    matrix[rows, rows[k]] -= change / (2 * np.abs(dq + dv).max())
        inverse = np.linalg.inv(self.M)
        A = np.block([[np.zeros((self.n, self.n)), np.eye(self.n)], [-inverse @ K, -inverse @ C]])
        return np.linalg.eigvals(A)


@pytest.fixture(scope="module")
def both():
    system = whirlmap.load(CASE)
    full = Compressor(system.machine.inputs["lubricant.mu"].value)
    linear = whirlmap.linear_analysis(system)
    c_0 = system.machine.inputs["bearing.motor_side.c"].value
    guess, state = np.zeros(full.n), dict(zip(system.states, map(float, linear.equilibrium), strict=True))
    for name in full.shafts:  # as one piece: the solver bends the shafts
        for off, axis in ((0, "x"), (2, "y")):
            guess[full.first[name] + off : full.angle[name] : 4] = c_0 * state[f"{axis}_{name}"]
    return system, linear, full, full.equilibrium(guess), c_0


def test_eigenvalues_are_those_of_the_full_matrices(both, validate):
    """Every mode below 2.5 times the highest shaft speed: to 1 % where its damping ratio is below 0.3, else to 3 %."""
    _, linear, full, rest, _ = both
    highest = max(map(abs, full.spins.values()))
    theirs = full.eigenvalues(rest)
    theirs = theirs[(np.abs(theirs) < 2.5 * highest) & (theirs.imag > -1e-6)]
    assert theirs.size >= 15 and (theirs.imag > 1e-3 * highest).sum() >= 10
    nearest = np.abs(linear.eigenvalues[None] * full.speed - theirs[:, None])
    assert np.unique(nearest.argmin(axis=1)).size == theirs.size
    error, damping = nearest.min(axis=1) / np.abs(theirs), -theirs.real / np.abs(theirs)
    validate("integrally geared compressor: relative error of its eigenvalues by reduction", error, 0, tier="independent",
             source="full finite-element matrices, written for this test",
             within=np.where(damping < 0.3, LIGHT, HEAVY))  # fmt: skip


def test_journals_rest_where_those_of_the_full_matrices_do(both):
    system, linear, full, rest, c_0 = both
    state = dict(zip(system.states, linear.equilibrium, strict=True))
    names = ("motor_side", "free_side", "low_1", "low_2", "high_3", "high_4")
    for (j, _, b), name in zip(full.bearings, names, strict=True):
        ours = c_0 * np.array([float(state[f"u{axis}_{name}"]) for axis in "xy"])
        assert 0.1 < np.hypot(*rest[[j, j + 2]]) / b.c < 0.9
        np.testing.assert_allclose(ours, rest[[j, j + 2]], atol=1e-3 * b.c)
