"""What the truncation of modes costs: eigenvalues of the reduced machine against those of all its matrices."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from sympy import Expr, cos, sin

from whirlmap.analysis.linear.film_coefficients import FilmCoefficients, film_coefficients
from whirlmap.analysis.linear.linearisation import linear_analysis, standing
from whirlmap.errors import RangeError
from whirlmap.integrate.system import System
from whirlmap.machines.assembly import AnyBearing, Machine
from whirlmap.machines.parts.coefficients import CoefficientBearing
from whirlmap.machines.parts.contact import Rub
from whirlmap.machines.parts.coupling import Coupling
from whirlmap.machines.parts.journal import JournalBearing
from whirlmap.machines.parts.rotor import Rotor
from whirlmap.models import mesh

Matrix = NDArray[np.float64]

#: Modes below this many times the highest shaft speed are compared.
RANGE = 2.5
#: Damping ratio from which a mode may be off by more, and the largest relative errors of the others and of these.
OVERDAMPED, LIGHT, HEAVY = 0.3, 0.01, 0.03
#: Rates of the linearised machine over the shaft speed from which steps follow them and not the motion.
FAST = 30.0


@dataclass(frozen=True)
class Truncation:
    """Comparison of the reduced machine with its full matrices, linearised at its static equilibrium.

    Attributes
    ----------
    eigenvalues : array of complex, shape (mode,)
        Of the full matrices, per clock radian: those below `RANGE` times the highest shaft speed, of positive frequency.
    error : array, shape (mode,)
        Distance of the nearest eigenvalue of the reduced machine, over their size.
    allowed : array, shape (mode,)
    fastest : float
        Fastest rate of the reduced machine over the highest shaft speed.
    """

    eigenvalues: NDArray[np.complex128]
    error: NDArray[np.float64]
    allowed: NDArray[np.float64]
    fastest: float

    @property
    def holds(self) -> bool:
        """Whether every mode is as accurate as it has to be."""
        return bool((self.error <= self.allowed).all())


def truncation(system: System) -> Truncation | None:
    """Compare a machine from parts with its unreduced matrices.

    Parameters
    ----------
    system : System
        Of a case that describes a machine by its parts.

    Returns
    -------
    Truncation or None
        None for any other system.

    Raises
    ------
    RangeError
        No static equilibrium was found; a film has no linear coefficients there (a damper, a film as printed).

    Notes
    -----
    Both are linearised at the static equilibrium of the reduced machine, with its film coefficients. In the full matrices a
    journal is the station of the shaft itself, and teeth act on their stations.
    """
    machine = machine_of(system)
    if machine is None:
        return None
    if standing(system) or len(system.model.films) < len(machine.bearings):
        raise RangeError("a damper, or a film as printed, has no linear coefficients at rest")
    linear = linear_analysis(system)
    if any(_touches(system, rub, linear.equilibrium) for rub in machine.rubs):
        raise RangeError("a shaft touches its casing at rest")
    ours, rest = linear.eigenvalues, dict(zip(system.states, map(float, linear.equilibrium), strict=True))
    full = _Full(system, machine).eigenvalues(film_coefficients(system), rest)
    highest = max(abs(float(system.values[rotor.r.name])) for rotor in machine.rotors)
    full = full[(np.abs(full) < RANGE * highest) & (full.imag > -1e-9 * highest)]
    full = full[np.argsort(np.abs(full))]
    error = np.abs(ours[None] - full[:, None]).min(axis=1) / np.abs(full)
    light = -full.real < OVERDAMPED * np.abs(full)
    return Truncation(full, error, np.where(light, LIGHT, HEAVY), float(np.abs(ours).max() / highest))


def _touches(system: System, rub: Rub, rest: NDArray[np.float64]) -> bool:
    numbers = {p: float(system.values[p.name]) for p in system.model.parameters}
    numbers |= dict(zip(system.model.states, map(float, rest), strict=True))
    return float(system.model.outputs[f"gap_{rub.name}"].expression.subs(numbers)) < 0


def machine_of(system: System) -> Machine | None:
    """The parts of a system's case; None where it is not described by parts."""
    parts = system.machine.case.parts if system.machine else None
    return parts.machine if parts else None


class _Full:
    """Matrices of all degrees of freedom, per clock radian, over m_0: both planes of each shaft, arcs, supports."""

    def __init__(self, system: System, machine: Machine) -> None:
        self.values = {name: float(value) for name, value in system.values.items()}
        self.machine, self.s2 = machine, self.values["s"] ** 2
        self.places: dict[tuple[str, str], int] = {}
        size = 0
        for rotor in machine.rotors:
            for axis in "xy":
                self.places[rotor.name, axis] = size
                size += rotor.shaft.matrices[0].shape[0]
            if rotor.base is not None:
                self.places[rotor.name, "arc"] = size
                size += rotor.shaft.torsion[0].shape[0]
        for support in machine.supports:
            for axis in "xy":
                self.places[support.name, axis] = size
                size += 1
        self.M, self.C, self.K = (np.zeros((size, size)) for _ in range(3))

    def _number(self, parameter: object, other: float = 0.0) -> float:
        return self.values.get(getattr(parameter, "name", ""), other)

    def eigenvalues(self, films: dict[str, FilmCoefficients], rest: dict[str, float]) -> NDArray[np.complex128]:
        """Damped eigenvalues with these films, about this state of the reduced machine."""
        for rotor in self.machine.rotors:
            self._shaft(rotor)
        self._supports(rest)
        for bearing in self.machine.bearings:
            self._film(bearing, films[bearing.name])
        for by_coefficients in self.machine.coefficients:
            self._coefficients(by_coefficients)
        self._teeth()
        for coupling in self.machine.couplings:
            self._coupling(coupling)
        massive = np.diag(self.M) > 0
        return _eigenvalues(self.M, self.C, self.K, massive)

    def _rotor(self, name: str) -> Rotor:
        return next(one for one in self.machine.rotors if one.name == name)

    def _shaft(self, rotor: Rotor) -> None:
        shaft, s = rotor.shaft, self.values["s"]
        M, G, K = shaft.matrices
        nu, kappa, r = (self._number(p) for p in (rotor.nu, rotor.kappa, rotor.r))
        n, x, y = M.shape[0], self.places[rotor.name, "x"], self.places[rotor.name, "y"]
        modes = shaft.reduced
        damping = 2 * self._number(rotor.xi) / s * nu * M / shaft.mass
        if self._number(rotor.zeta):
            moved = M @ modes.shapes / shaft.mass  # of the kept modes
            own = np.sqrt(rotor.numbers.stiffness * kappa * rotor.numbers.mass * nu) / rotor.numbers.mass**2
            damping = damping + 2 * self._number(rotor.zeta) / s * (moved * own) @ moved.T
        for i in (x, y):
            at = slice(i, i + n)
            self.M[at, at] += nu * M / shaft.mass
            self.K[at, at] += kappa * K / shaft.stiffness / self.s2
            self.C[at, at] += damping
        self.C[x : x + n, y : y + n] += r * nu * G / shaft.mass
        self.C[y : y + n, x : x + n] -= r * nu * G / shaft.mass
        if rotor.base is not None:
            J, twist = shaft.torsion
            i, iota = self.places[rotor.name, "arc"], self._number(rotor.iota) / shaft.inertia
            at = slice(i, i + J.shape[0])
            self.M[at, at] += iota * J
            if twist.any():
                self.K[at, at] += iota * twist / self.values["omega_0_2"] / self.s2
                if self._number(rotor.zeta):
                    kept = shaft.twisting
                    turned = J @ kept.shapes
                    own = kept.frequency / np.sqrt(self.values["omega_0_2"]) / kept.mass
                    self.C[at, at] += 2 * self._number(rotor.zeta) / s * iota * (turned * own) @ turned.T

    def _supports(self, rest: dict[str, float]) -> None:
        for support in self.machine.supports:
            alike = max(b.alike for b in self.machine.supporting if b.name in support.bearings)
            for axis in "xy":
                i = self.places[support.name, axis]
                cubic = 3 * self._number(support.a(axis)) * self._number(support.nu) * rest[f"{axis}_{support.name}"] ** 2
                self.M[i, i] += alike * self._number(support.nu)
                self.K[i, i] += alike * (self._number(support.kappa(axis)) + cubic) / self.s2
                self.C[i, i] += alike * 2 * self._number(support.xi(axis)) / self.values["s"]

    def _film(self, bearing: JournalBearing, found: FilmCoefficients) -> None:
        """Stiffness and damping between a station and its support, of all alike bearings."""
        size = bearing.alike * found.load / self._number(bearing.gamma) / self.s2
        spin = abs(self._number(bearing.spin))
        K = size * found.K + bearing.alike * self._number(bearing.kappa_c) / self.s2 * np.eye(2)
        between = self._between(bearing)
        self.K += between.T @ K @ between
        self.C += between.T @ (size * found.C / spin) @ between

    def _coefficients(self, bearing: CoefficientBearing) -> None:
        def of(e: Expr) -> Matrix:
            return np.array([float(e.subs({q: self.values[q.name] for q in e.free_symbols}))])

        between = self._between(bearing)
        self.K += bearing.alike / self.s2 * between.T @ bearing.stiffness(of)[0] @ between
        self.C += bearing.alike * 2 / self.values["s"] * between.T @ bearing.damping(of)[0] @ between

    def _between(self, bearing: AnyBearing) -> Matrix:
        """Displacement of the station from its support along x and y, by all degrees of freedom."""
        row = self._rotor(bearing.shaft).shaft.freedom(bearing.station)
        between = np.zeros((2, self.M.shape[0]))
        for i, axis in enumerate("xy"):
            between[i, self.places[bearing.shaft, axis] + row] = 1.0
            if bearing.support:
                between[i, self.places[bearing.support, axis]] = -1.0
        return between

    def _coupling(self, one: Coupling) -> None:
        laws = (("arc", one.kappa, one.xi), ("x", one.kappa_r, one.xi_r), ("y", one.kappa_r, one.xi_r))
        for axis, stiff, damped in laws:
            across = np.zeros(self.M.shape[0])
            for name, station, sign in one.ends():
                shaft = self._rotor(name).shaft
                row = shaft.turning_station(station) if axis == "arc" else shaft.freedom(station)
                if (name, axis) in self.places:
                    across[self.places[name, axis] + row] += sign
            self.K += self._number(stiff) / self.s2 * np.outer(across, across)
            self.C += 2 * self._number(damped) / self.values["s"] * np.outer(across, across)

    def _teeth(self) -> None:
        s = self.values["s"]
        for one in self.machine.meshes:
            directions = np.eye(2)
            if one.kind == "line":
                phi = self._number(one.own[mesh.phi_m])
                directions = np.array([[float(cos(phi)), float(sin(phi))]])
            for direction in directions:
                across = np.zeros(self.M.shape[0])
                for wheel, way in ((one.driver, 1), (one.driven, -1)):
                    shaft = self._rotor(wheel.shaft).shaft
                    for axis, part in zip("xy", direction, strict=True):
                        across[self.places[wheel.shaft, axis] + shaft.freedom(wheel.station)] += way * part
                    if one.turning:
                        ratio = wheel.ratio(one.name)
                        arc = self.places[wheel.shaft, "arc"] + shaft.turning_station(wheel.station)
                        across[arc] += way * self._number(one.tau) * self._number(ratio, 1.0)
                self.K += self._number(one.Lambda) / self.s2 * np.outer(across, across)
                self.C += 2 * self._number(one.xi) / s * np.outer(across, across)


def _eigenvalues(M: Matrix, C: Matrix, K: Matrix, massive: NDArray[np.bool_]) -> NDArray[np.complex128]:
    """Eigenvalues of M q'' + C q' + K q = 0; coordinates without mass (journals of lumped rotors) are of first order."""
    n, heavy = M.shape[0], np.flatnonzero(massive)
    # Unknowns are q and the rates of the heavy ones: A z' = B z, and A is regular where every massless one is damped.
    A, B = np.zeros((n + heavy.size,) * 2), np.zeros((n + heavy.size,) * 2)
    A[:n, :n], B[:n, :n] = C, -K
    A[:n, n:] = M[:, heavy]
    A[n + np.arange(heavy.size), heavy] = 1.0
    B[n:, n:] = np.eye(heavy.size)
    return np.linalg.eigvals(np.linalg.solve(A, B)).astype(complex)
