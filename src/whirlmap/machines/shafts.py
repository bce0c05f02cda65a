"""A shaft as matrices: beam elements with disks at their stations, or one lumped rotor on a shaft spring.

Stations are the ends of the elements, numbered from 0. A lumped rotor has two: ``rotor``, where its mass is, and
``journal`` without mass, joined by the stiffness K of the shaft; it moves across its axis and does not tilt.
"""

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from whirlmap.errors import CaseError
from whirlmap.machines.beams import Element, bending, torsion
from whirlmap.machines.matrices import ShaftMatrices
from whirlmap.machines.reduction import Modes, Spectrum, reduce, spectrum

Matrix = NDArray[np.float64]

#: Elastic and attachment modes in a plane that are kept at least; elastic modes below RANGE times the highest shaft speed
#: are all kept.
LEAST, RANGE = 2, 6.0
#: Residual flexibility over the shaft's own below which a journal would be as fast as rounding allows.
FLEXIBLE = 1e-5
#: Stations of a lumped rotor.
ROTOR, JOURNAL = 0, 1


@dataclass(frozen=True)
class Disk:
    """A rigid disk at a station: mass m [kg], diametral and polar inertia I_d, I_p [kg m^2]."""

    name: str
    station: int
    m: float
    I_d: float
    I_p: float


@dataclass(frozen=True)
class Shaft:
    """One shaft with its disks.

    Attributes
    ----------
    name : str
    elements : tuple of Element
        Empty for a lumped rotor, whose mass, stiffness and inertia are inputs; here it has mass, stiffness and inertia 1.
    disks : tuple of Disk
    modes, twists : int or None
        Elastic modes to keep in a plane, and of the rotation; None leaves that to the highest speed.
    fastest : float
        Highest speed of this machine's shafts [rad/s], for that choice.
    attached, twisted : tuple of int
        Stations at which forces act across the axis other than those of journals (teeth, unbalances, bearings by their
        coefficients, rubs), and those at which teeth or couplings act on the rotation.
    bearings : tuple of int
        Stations of its journals.
    held : tuple of int
        Stations of its bearings by coefficients.
    given : ShaftMatrices or None
        Matrices that stand for those of the elements, which then say no more than where the stations are.
    """

    name: str
    elements: tuple[Element, ...]
    disks: tuple[Disk, ...] = ()
    modes: int | None = None
    fastest: float = 0.0
    attached: tuple[int, ...] = ()
    twisted: tuple[int, ...] = ()
    bearings: tuple[int, ...] = ()
    twists: int | None = None
    held: tuple[int, ...] = ()
    given: ShaftMatrices | None = None

    @property
    def lumped(self) -> bool:
        """Whether it is one rotor on a shaft spring."""
        return not self.elements

    @property
    def stations(self) -> int:
        """Number of stations."""
        return 2 if self.lumped else len(self.elements) + 1

    @property
    def positions(self) -> NDArray[np.float64]:
        """Distance of each station from the first [m]."""
        return np.cumsum([0.0, *(e.L for e in self.elements)]) if self.elements else np.zeros(2)

    def freedom(self, station: int) -> int:
        """Row of a station's displacement in the matrices of a plane."""
        return station if self.lumped else 2 * station

    @cached_property
    def matrices(self) -> tuple[Matrix, Matrix, Matrix]:
        """Mass, gyroscopic (per rad/s) and stiffness matrices of one plane."""
        if self.lumped:
            return np.diag([1.0, 0.0]), np.zeros((2, 2)), np.array([[1.0, -1.0], [-1.0, 1.0]])
        n = 2 * self.stations
        M, G, K = (np.zeros((n, n)) for _ in range(3)) if self.given is None else self.given.arrays()
        for i, element in enumerate(self.elements if self.given is None else ()):
            at = slice(2 * i, 2 * i + 4)
            for whole, part in zip((M, G, K), bending(element), strict=True):
                whole[at, at] += part
        for disk in self.disks:
            i = 2 * disk.station
            M[i, i] += disk.m
            M[i + 1, i + 1] += disk.I_d
            G[i + 1, i + 1] += disk.I_p
        return M, G, K

    @cached_property
    def torsion(self) -> tuple[Matrix, Matrix]:
        """Inertia and stiffness of the rotation of the stations; a lumped rotor turns as one piece."""
        if self.lumped:
            return np.array([[1.0]]), np.array([[0.0]])
        J, K = (np.zeros((self.stations, self.stations)) for _ in range(2))
        for i, element in enumerate(self.elements):
            for whole, part in zip((J, K), torsion(element), strict=True):
                whole[i : i + 2, i : i + 2] += part
        for disk in self.disks:
            J[disk.station, disk.station] += disk.I_p
        return J, K

    @cached_property
    def rigid(self) -> Matrix:
        """Rigid motions in a plane: translation, and tilt of a shaft of elements."""
        if self.lumped:
            return np.ones((2, 1))
        motions = np.zeros((2 * self.stations, 2))
        motions[0::2, 0] = 1.0
        motions[0::2, 1], motions[1::2, 1] = self.positions, 1.0
        return motions

    @property
    def mass(self) -> float:
        """Mass with the disks [kg]; 1 of a lumped rotor."""
        t = self.rigid[:, 0]
        return float(t @ self.matrices[0] @ t)

    @property
    def inertia(self) -> float:
        """Polar inertia with the disks [kg m^2]; 1 of a lumped rotor."""
        return float(self.torsion[0].sum())

    @property
    def centre(self) -> float:
        """Distance of the centre of mass from the first station [m]."""
        t = self.rigid[:, 0]
        return 0.0 if self.lumped else float(t @ self.matrices[0] @ self.rigid[:, 1]) / self.mass

    @cached_property
    def stiffness(self) -> float:
        """Stiffness m omega^2 of the lowest bending mode at standstill on rigid bearings [N/m]; 1 of a lumped rotor.

        Where one bearing lets the shaft tilt, the lowest mode that bends it.
        """
        if self.lumped:
            return 1.0
        M, _, K = self.matrices
        held = [self.freedom(station) for station in {*self.bearings, *self.held}]
        loose = [i for i in range(M.shape[0]) if i not in held]
        size = 1 / np.sqrt(np.diag(M)[loose])
        L = np.linalg.cholesky(size[:, None] * M[np.ix_(loose, loose)] * size)
        inner = np.linalg.solve(L, np.linalg.solve(L, size[:, None] * K[np.ix_(loose, loose)] * size).T).T
        values = np.linalg.eigvalsh((inner + inner.T) / 2)
        rigid = max(self.rigid.shape[1] - len(held), 0)
        return float(self.mass * values[rigid])

    @cached_property
    def spectrum(self) -> Spectrum:
        """All modes of the free shaft in one plane."""
        return spectrum(self.matrices[0], self.matrices[2], self.rigid)

    @cached_property
    def reduced(self) -> Modes:
        """The modes that are kept, and the residual flexibility.

        Where the number is not given, fewer are kept of a shaft with so few elements that nothing would be left at its
        bearings.
        """
        kept = self.modes
        if kept is not None:
            return self._keeping(kept)
        within = int(np.sum(self.spectrum.frequency <= RANGE * self.fastest)) - self.spectrum.rigid
        kept = max(LEAST - len(self.attached), within, 1)
        while kept > 0 and not self.flexible(self._keeping(kept)):
            kept -= 1
        return self._keeping(kept)

    def _keeping(self, elastic: int) -> Modes:
        pressed, all_of_them = ([self.freedom(i) for i in some] for some in (self.attached, range(self.stations)))
        return reduce(self.spectrum, elastic, pressed, all_of_them)

    def flexible(self, modes: Modes) -> bool:
        """Whether the omitted modes leave a flexibility between the kept ones and every journal."""
        rows = [self.freedom(station) for station in self.bearings]
        left = modes.residual[np.ix_(rows, rows)]
        return not rows or bool(np.linalg.eigvalsh(left)[0] > FLEXIBLE * np.abs(self.spectrum.flexibility).max())

    @cached_property
    def twisting(self) -> Modes:
        """Torsional modes: rigid rotation, elastic ones within the range, and attachments where teeth and couplings act."""
        J, K = self.torsion
        if self.lumped:
            one = np.ones((1, 1))
            return Modes(one, np.ones(1), np.zeros(1), np.zeros((1, 1)), 1)
        whole = spectrum(J, K, np.ones((self.stations, 1)))
        within = int(np.sum(whole.frequency <= RANGE * self.fastest)) - 1
        return reduce(whole, within if self.twists is None else self.twists, self.twisted, range(self.stations))

    def settled(self) -> "Shaft":
        """The same with the numbers of modes that the highest speed asks for, so that speeds do not tell shafts apart."""
        twists = self.twisting.count - self.twisting.rigid - self.twisting.attached
        kept = self.reduced.count - self.reduced.rigid - self.reduced.attached
        return replace(self, modes=kept, twists=twists, fastest=0.0)

    def turning_station(self, station: int) -> int:
        """Row of a station in the matrices of the rotation."""
        return 0 if self.lumped else station


@lru_cache(maxsize=32)
def reduced_numbers(shaft: Shaft) -> "Reduced":
    """Numbers of a shaft without dimensions, over its mass and its stiffness on rigid bearings."""
    modes, (M, G, _) = shaft.reduced, shaft.matrices
    m, k = shaft.mass, shaft.stiffness
    at = [shaft.freedom(station) for station in range(shaft.stations)]
    bearings = [shaft.freedom(station) for station in shaft.bearings]
    flexible = modes.residual[np.ix_(bearings, bearings)] * k
    if not shaft.flexible(modes):
        raise CaseError(
            f"found {modes.count - modes.rigid} elastic modes, which leave no flexibility between them and the journals of"
            f" shaft {shaft.name}; expected fewer modes, or more elements"
        )
    gyroscopic = modes.shapes.T @ G @ modes.shapes / m
    gyroscopic[np.abs(gyroscopic) <= 1e-13 * np.abs(gyroscopic).max(initial=0.0)] = 0.0
    translation = shaft.rigid[:, 0]
    weight = modes.shapes.T @ M @ translation / m
    weight[np.abs(weight) <= 1e-10] = 0.0  # modes are orthogonal to the translation
    return Reduced(
        shapes=modes.shapes[at],
        mass=modes.mass / m,
        stiffness=modes.mass * modes.frequency**2 / k,
        gyroscopic=gyroscopic,
        residual=np.asarray(np.linalg.inv(flexible), dtype=float) if flexible.size else flexible,
        weight=weight,
    )


@dataclass(frozen=True)
class Reduced:
    """What the equations of a shaft's modes contain.

    Attributes
    ----------
    shapes : array, shape (station, mode)
        Displacements.
    mass, stiffness : array, shape (mode,)
        Over the shaft's mass, and over its stiffness on rigid bearings.
    gyroscopic : array, shape (mode, mode)
        Over the shaft's mass.
    residual : array, shape (bearing, bearing)
        Stiffness between modes and journals, the inverse of the residual flexibility.
    weight : array, shape (mode,)
        Part of the weight that acts on a mode.
    """

    shapes: Matrix
    mass: NDArray[np.float64]
    stiffness: NDArray[np.float64]
    gyroscopic: Matrix
    residual: Matrix
    weight: NDArray[np.float64]
