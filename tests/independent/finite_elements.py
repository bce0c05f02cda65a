"""Two geared shafts as unreduced finite-element matrices, in SI; imports nothing of whirlmap.

Shape functions of a Timoshenko beam are integrated numerically, so no closed-form matrix goes in; films are integrated over
their half circle. Coordinates: for every station of every shaft x, dx/dz, y, dy/dz, then x, y of every pedestal. The
journal is the station of the shaft itself, with the mass that the beam has there.
"""

from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np
from scipy.optimize import root

GRAVITY = 9.81
E, G, RHO = 211e9, 81.2e9, 7810.0
GAUSS, WEIGHT = np.polynomial.legendre.leggauss(8)
ARC, ARC_WEIGHT = np.polynomial.legendre.leggauss(80)


@dataclass(frozen=True)
class Bearing:
    station: int
    R: float
    L: float
    c: float
    arc: str = "positive"
    pedestal: tuple[float, float, float] | None = None  # mass, stiffness, damping


@dataclass(frozen=True)
class Rotor:
    pieces: tuple[tuple[float, float, float], ...]  # length, outer and inner diameter
    disks: tuple[tuple[int, float, float, float], ...]  # station, mass, diametral and polar inertia
    bearings: tuple[Bearing, ...]
    unbalances: tuple[tuple[int, float, float], ...]  # station, kg m, phase


@dataclass(frozen=True)
class Mesh:
    stations: tuple[int, int]
    z: tuple[int, int]
    module: float
    alpha: float
    beta: float
    K: float
    C: float
    error: float
    torque: float


@dataclass(frozen=True)
class Gearbox:
    rotors: tuple[Rotor, ...]
    mesh: Mesh | None
    speed: float
    mu: float
    couplings: tuple[tuple[int, int, float, float], ...] | None = None  # shaft, station, k_t, c_t; None: no torsion

    @property
    def speeds(self) -> list[float]:
        """Speed of each shaft, the driven one against the driver."""
        if self.mesh is None:
            return [self.speed]
        return [self.speed, -self.speed * self.mesh.z[0] / self.mesh.z[1]]


def beam(L: float, d: float, d_i: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mass, gyroscopic per rad/s and stiffness matrices by quadrature of the shape functions."""
    A, inertia = pi * (d**2 - d_i**2) / 4, pi * (d**4 - d_i**4) / 64
    nu, m2 = E / (2 * G) - 1, (d_i / d) ** 2
    kappa = 6 * (1 + nu) * (1 + m2) ** 2 / ((7 + 6 * nu) * (1 + m2) ** 2 + (20 + 12 * nu) * m2)
    # Static solution of the beam: w cubic, rotation b = w' + (E I/kappa G A) w''' quadratic, fitted to the ends.
    lag = E * inertia / (kappa * G * A)
    ends = []
    for z in (0.0, L):
        ends.append([1, z, z**2, z**3])  # displacement
        ends.append([0, 1, 2 * z, 3 * z**2 + 6 * lag])  # rotation
    coefficients = np.linalg.inv(np.array(ends))
    M, gyro, K = (np.zeros((4, 4)) for _ in range(3))
    for x, weight in zip(GAUSS, WEIGHT, strict=True):
        z, dz = L * (x + 1) / 2, L / 2 * weight
        w = np.array([1, z, z**2, z**3]) @ coefficients
        slope = np.array([0, 1, 2 * z, 3 * z**2]) @ coefficients
        b = np.array([0, 1, 2 * z, 3 * z**2 + 6 * lag]) @ coefficients
        bend = np.array([0, 0, 2, 6 * z]) @ coefficients
        M += dz * RHO * (A * np.outer(w, w) + inertia * np.outer(b, b))
        gyro += dz * RHO * 2 * inertia * np.outer(b, b)
        K += dz * (E * inertia * np.outer(bend, bend) + kappa * G * A * np.outer(slope - b, slope - b))
    return M, gyro, K


def film(b: Bearing, mu: float, speed: float, e: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Force of the film on the journal: pressure of the short bearing over the half circle that the arc says."""
    A = mu * b.R * b.L**3 / (2 * b.c**2)
    u, w = e / b.c, v / b.c - speed / 2 * np.array([-e[1], e[0]]) / b.c
    if b.arc == "fixed":  # half film behind the line of centres, in the sense of rotation: 0..pi from the thickest film
        middle = np.arctan2(u[1], u[0]) - np.sign(speed) * pi / 2
    else:
        middle = np.arctan2(w[1], w[0])
    angle = middle + pi / 2 * ARC
    n = np.stack([np.cos(angle), np.sin(angle)])
    return -2 * A * (n * (n.T @ w) * pi / 2 * ARC_WEIGHT / (1 - n.T @ u) ** 3).sum(axis=1)


class Matrices:
    """M q'' + (C + G) q' + K q = film + mesh + unbalance + weight of one gearbox."""

    def __init__(self, box: Gearbox) -> None:
        self.box, self.first, n = box, [], 0
        for rotor in box.rotors:
            self.first.append(n)
            n += 4 * (len(rotor.pieces) + 1)
        self.pedestals = {}
        for i, rotor in enumerate(box.rotors):
            for b in rotor.bearings:
                if b.pedestal:
                    self.pedestals[i, b] = n
                    n += 2
        self.angles = []  # first coordinate of each shaft's rotation, counter-clockwise
        for rotor in box.rotors if box.couplings else ():
            self.angles.append(n)
            n += len(rotor.pieces) + 1
        self.M, self.C, self.K, self.n = np.zeros((n, n)), np.zeros((n, n)), np.zeros((n, n)), n
        for i, rotor in enumerate(box.rotors):
            spin = box.speeds[i]
            for k, piece in enumerate(rotor.pieces):
                M, gyro, K = beam(*piece)
                x = [self.at(i, k), self.at(i, k) + 1, self.at(i, k + 1), self.at(i, k + 1) + 1]
                y = [j + 2 for j in x]
                for rows in (x, y):
                    self.M[np.ix_(rows, rows)] += M
                    self.K[np.ix_(rows, rows)] += K
                self.C[np.ix_(x, y)] += spin * gyro
                self.C[np.ix_(y, x)] -= spin * gyro
            for station, m, I_d, I_p in rotor.disks:
                j = self.at(i, station)
                self.M[[j, j + 2], [j, j + 2]] += m
                self.M[[j + 1, j + 3], [j + 1, j + 3]] += I_d
                self.C[j + 1, j + 3] += spin * I_p
                self.C[j + 3, j + 1] -= spin * I_p
        for (_, b), j in self.pedestals.items():
            m, k, c = b.pedestal
            for row in (j, j + 1):
                self.M[row, row], self.K[row, row], self.C[row, row] = m, k, c
        self.weight = np.zeros(n)
        down = np.zeros(n)
        for i, rotor in enumerate(box.rotors):
            down[[self.at(i, k) + 2 for k in range(len(rotor.pieces) + 1)]] = 1
        down[[j + 1 for j in self.pedestals.values()]] = 1
        self.weight = -GRAVITY * self.M @ down
        self.across = np.zeros(n)  # deflection of the teeth by coordinates
        if box.mesh:
            m = box.mesh
            phi = m.beta + np.sign(m.torque) * (pi / 2 - m.alpha)
            for i, sign in ((0, 1), (1, -1)):
                j = self.at(i, m.stations[i])
                self.across[[j, j + 2]] = sign * np.array([cos(phi), sin(phi)])
            if self.angles:  # moments about the centres, of a force at the pitch point
                n_x, n_y = cos(phi), sin(phi)
                for i, place in ((0, m.module * m.z[0] / 2), (1, -m.module * m.z[1] / 2)):
                    p_x, p_y = place * cos(m.beta), place * sin(m.beta)
                    self.across[self.angles[i] + m.stations[i]] = (1, -1)[i] * (p_x * n_y - p_y * n_x)
            self.load = abs(m.torque) / (m.module * m.z[0] / 2 * cos(m.alpha))
            self.K += m.K * np.outer(self.across, self.across)
            self.C += m.C * np.outer(self.across, self.across)
        self._turning()
        self.inverse = np.linalg.inv(self.M)

    def _turning(self) -> None:
        """Inertia and stiffness of the rotation of stations about the uniform one, and couplings to the ground."""
        for first, rotor in zip(self.angles, self.box.rotors, strict=False):
            for k, (L, d, d_i) in enumerate(rotor.pieces):
                polar, two = pi * (d**4 - d_i**4) / 32, [first + k, first + k + 1]
                for x, weight in zip(GAUSS, WEIGHT, strict=True):
                    shape = np.array([(1 - x) / 2, (1 + x) / 2])
                    self.M[np.ix_(two, two)] += RHO * polar * L / 2 * weight * np.outer(shape, shape)
                self.K[np.ix_(two, two)] += G * polar / L * np.array([[1, -1], [-1, 1]])
            for station, _, _, I_p in rotor.disks:
                self.M[first + station, first + station] += I_p
        for shaft, station, k_t, c_t in self.box.couplings or ():
            j = self.angles[shaft] + station
            self.K[j, j] += k_t
            self.C[j, j] += c_t

    def at(self, rotor: int, station: int) -> int:
        """First coordinate of a station."""
        return self.first[rotor] + 4 * station

    def journals(self):
        """Rows of every journal, of its pedestal, the bearing and the journal's speed."""
        for i, rotor in enumerate(self.box.rotors):
            for b in rotor.bearings:
                j = self.at(i, b.station)
                held = self.pedestals.get((i, b))
                yield np.array([j, j + 2]), None if held is None else np.array([held, held + 1]), b, self.box.speeds[i]

    def films(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Forces of all films."""
        f = np.zeros(self.n)
        for rows, held, b, speed in self.journals():
            e, rate = q[rows], v[rows]
            if held is not None:
                e, rate = e - q[held], rate - v[held]
            force = film(b, self.box.mu, speed, e, rate)
            f[rows] += force
            if held is not None:
                f[held] -= force
        return f

    def steady(self) -> np.ndarray:
        """Forces that stand still: weight, transmitted tooth load, and the torques that balance it."""
        if not self.box.mesh:
            return self.weight
        load = -self.load * self.across
        for first, rotor in zip(self.angles, self.box.rotors, strict=False):
            load[first : first + len(rotor.pieces) + 1] = 0.0
        return self.weight + load

    def forcing(self, t: float) -> np.ndarray:
        """Unbalances and transmission error."""
        f = np.zeros(self.n)
        for i, rotor in enumerate(self.box.rotors):
            spin = self.box.speeds[i]
            for station, U, phase in rotor.unbalances:
                j = self.at(i, station)
                f[[j, j + 2]] += U * spin**2 * np.array([cos(spin * t + phase), sin(spin * t + phase)])
        if self.box.mesh:
            m, w = self.box.mesh, self.box.speed * self.box.mesh.z[0]
            f += (m.K * m.error * cos(w * t) - m.C * m.error * w * sin(w * t)) * self.across
        return f

    def acceleration(self, t: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Of all coordinates."""
        return self.inverse @ (self.steady() + self.forcing(t) + self.films(q, v) - self.K @ q - self.C @ v)

    def equilibrium(self, guess: np.ndarray) -> np.ndarray:
        """Static equilibrium, forcing off, in clearances of the first bearing for the solver."""
        unit, still = self.box.rotors[0].bearings[0].c, np.zeros(self.n)
        scale = np.abs(self.steady()).max()

        def left(q: np.ndarray) -> np.ndarray:
            return (self.steady() + self.films(unit * q, still) - self.K @ (unit * q)) / scale

        found = root(left, guess / unit, tol=1e-12)
        assert np.abs(found.fun).max() < 1e-8, found.message
        return unit * found.x

    def jacobian(self, q: np.ndarray, v: np.ndarray, scale: float = 1e-5) -> np.ndarray:
        """Derivatives of rates and accelerations; films are differentiated centrally with steps of scale clearances."""
        K, C, n = self.K.copy(), self.C.copy(), self.n
        for rows, held, b, speed in self.journals():
            for j in (*rows, *(held if held is not None else ())):
                step = np.zeros(n)
                step[j] = scale * b.c
                rate = abs(speed) * step
                K[:, j] -= self._film_change(b, rows, held, speed, q, v, step, 0 * step) / (2 * step[j])
                C[:, j] -= self._film_change(b, rows, held, speed, q, v, 0 * step, rate) / (2 * rate[j])
        return np.block([[np.zeros((n, n)), np.eye(n)], [-self.inverse @ K, -self.inverse @ C]])

    def _film_change(self, b, rows, held, speed, q, v, dq, dv) -> np.ndarray:
        """Change of one film's forces from one side of a motion to the other."""
        f = np.zeros(self.n)
        for sign in (1, -1):
            at, rate = q + sign * dq, v + sign * dv
            e, w = at[rows], rate[rows]
            if held is not None:
                e, w = e - at[held], w - rate[held]
            force = sign * film(b, self.box.mu, speed, e, w)
            f[rows] += force
            if held is not None:
                f[held] -= force
        return f

    def eigenvalues(self, q: np.ndarray, scale: float) -> np.ndarray:
        """Damped eigenvalues [rad/s] about an equilibrium."""
        return np.linalg.eigvals(self.jacobian(q, np.zeros(self.n), scale))
