"""Finite elements of a shaft: a uniform Timoshenko beam, solid or hollow, that rotates about its axis.

A station has two degrees of freedom in each plane, displacement and slope: (x, dx/dz) and (y, dy/dz). Written in slopes
both planes have the same matrices, and the gyroscopic moments couple them::

    M x'' + Omega G y' + K x = f_x
    M y'' - Omega G x' + K y = f_y

with Omega positive from x to y. Sources: Nelson 1980 [nelson1980], as in Friswell et al. 2010, chapter 5; shear coefficients
of Cowper 1966 [cowper1966].
"""

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray

Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class Material:
    """An isotropic elastic material: Young's modulus E and shear modulus G [Pa], density rho [kg/m^3]."""

    E: float
    G: float
    rho: float

    @property
    def nu(self) -> float:
        """Poisson's ratio [1]."""
        return self.E / (2 * self.G) - 1


#: Materials by name: rounded values of the usual tables (steel: Friswell et al. 2010, all examples).
MATERIALS = {"steel": Material(211e9, 81.2e9, 7810.0)}


@dataclass(frozen=True)
class Element:
    """A uniform piece of a shaft: length L, outer diameter d, inner diameter d_i [m]."""

    L: float
    d: float
    d_i: float
    material: Material

    @property
    def area(self) -> float:
        """Cross section [m^2]."""
        return pi * (self.d**2 - self.d_i**2) / 4

    @property
    def inertia(self) -> float:
        """Second moment of area about a diameter [m^4]; the polar one is twice that."""
        return pi * (self.d**4 - self.d_i**4) / 64

    @property
    def mass(self) -> float:
        """Mass [kg]."""
        return self.material.rho * self.area * self.L

    @property
    def shear_coefficient(self) -> float:
        """Cowper's coefficient of a hollow circle; of a solid one 6 (1 + nu)/(7 + 6 nu)."""
        nu, m2 = self.material.nu, (self.d_i / self.d) ** 2
        whole = (1 + m2) ** 2
        return 6 * (1 + nu) * whole / ((7 + 6 * nu) * whole + (20 + 12 * nu) * m2)

    @property
    def shear(self) -> float:
        """Phi = 12 E I/(kappa G A L^2), the bending deflection that shear adds [1]."""
        m = self.material
        return 12 * m.E * self.inertia / (self.shear_coefficient * m.G * self.area * self.L**2)


def bending(e: Element) -> tuple[Matrix, Matrix, Matrix]:
    """Mass, gyroscopic and stiffness matrices of one plane, each of shape (4, 4).

    Degrees of freedom: displacement and slope at the first end, then at the second. The mass holds translation and rotary
    inertia; the gyroscopic matrix is per rad/s of rotation, twice the part of rotary inertia, for I_p = 2 I_d.
    """
    L, S = e.L, e.shear
    translation = _pattern(
        312 + 588 * S + 280 * S**2, (44 + 77 * S + 35 * S**2) * L, 108 + 252 * S + 140 * S**2,
        -(26 + 63 * S + 35 * S**2) * L, (8 + 14 * S + 7 * S**2) * L**2, -(6 + 14 * S + 7 * S**2) * L**2,
    )  # fmt: skip
    rotation = _pattern(
        36.0, (3 - 15 * S) * L, -36.0, (3 - 15 * S) * L, (4 + 5 * S + 10 * S**2) * L**2, (-1 - 5 * S + 5 * S**2) * L**2
    )
    K = _pattern(12.0, 6 * L, -12.0, 6 * L, (4 + S) * L**2, (2 - S) * L**2)
    rho = e.material.rho
    rotary = rho * e.inertia / (30 * (1 + S) ** 2 * L) * rotation
    M = rho * e.area * L / (840 * (1 + S) ** 2) * translation + rotary
    return M, 2 * rotary, e.material.E * e.inertia / ((1 + S) * L**3) * K


def _pattern(m1: float, m2: float, m3: float, m4: float, m5: float, m6: float) -> Matrix:
    """The symmetric matrix that a beam has by its symmetry about its middle."""
    return np.array([[m1, m2, m3, m4], [m2, m5, -m4, m6], [m3, -m4, m1, -m2], [m4, m6, -m2, m5]])


def torsion(e: Element) -> tuple[Matrix, Matrix]:
    """Inertia [kg m^2] and stiffness [N m/rad] of the rotation of both ends, each of shape (2, 2)."""
    polar = 2 * e.inertia
    J = e.material.rho * polar * e.L / 6 * np.array([[2.0, 1.0], [1.0, 2.0]])
    return J, e.material.G * polar / e.L * np.array([[1.0, -1.0], [-1.0, 1.0]])
