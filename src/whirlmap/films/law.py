"""Film laws as expressions: the velocity of a massless journal under a load, for declarations of models.

Every law solves ``M w = q`` for the journal's velocity ``w``, seen from the frame that turns at half the journal's spin;
``q = kappa d/(2 Gamma)`` is the shaft's force in film units. All are written without dividing by the eccentricity where
the film has a limit at the centre. Source: equation audit, sections 3.2 and 4.
"""

from collections.abc import Callable
from dataclasses import dataclass

from sympy import Expr, Float, Integer, pi, sqrt

from whirlmap.equations import Table

#: Added to the squared eccentricity under a root, so that 0/0 at the very centre is the limit 0 that the film has there.
CENTRE = Float("1e-100")

Vector = tuple[Expr, Expr]


@dataclass(frozen=True)
class FilmLaw:
    """One film law in symbols.

    Attributes
    ----------
    velocity : callable
        ``velocity(ux, uy, qx, qy, psi, sigma) -> (wx, wy)``; sigma is the sign of the journal's spin.
    mobility : callable, optional
        ``mobility(e2, psi) -> (mG, mDG, mB)`` = (G/Delta, (D - G)/(Delta eps^2), B/(Delta eps)) of a fixed half film.
    tables : tuple of Table
        Tables that the expressions read.
    """

    velocity: Callable[..., Vector]
    mobility: Callable[[Expr, Expr], tuple[Expr, Expr, Expr]] | None = None
    tables: tuple[Table, ...] = ()

    def misprint_31(self, ux: Expr, uy: Expr, qx: Expr, qy: Expr, psi: Expr) -> Vector:
        """Printed less derived last term of (31): beta^2 m for beta delta s_r, as a velocity."""
        return self._misprint(ux, uy, qx, qy, psi, 1, qy * ux + qx * uy)

    def misprint_33(self, ux: Expr, uy: Expr, qx: Expr, qy: Expr, psi: Expr) -> Vector:
        """Printed less derived last two terms of (33), as a velocity."""
        return self._misprint(ux, uy, qx, qy, psi, 2, qy * ux)

    def _misprint(self, ux: Expr, uy: Expr, qx: Expr, qy: Expr, psi: Expr, factor: int, moment: Expr) -> Vector:
        if self.mobility is None:  # beta_1 = 0: the wrong terms vanish
            return Integer(0), Integer(0)
        e2 = ux**2 + uy**2
        eps = sqrt(e2 + CENTRE)
        mG, mDG, mB = self.mobility(e2, psi)
        slip = factor * mB * ((qx * ux + qy * uy) / eps - mB / (mG + e2 * mDG) * moment)
        return -slip * uy, slip * ux


def film_law(film: str, arc: str, *, plain: bool = False) -> FilmLaw:
    """Return the law for one choice of film and arc; ``plain`` takes psi = 0."""
    if film == "printed":
        return FilmLaw(printed_velocity)
    if arc == "positive":
        raise NotImplementedError
    if plain:
        return FilmLaw(_fixed_arc(plain_mobility), plain_mobility)
    raise NotImplementedError


def printed_velocity(ux: Expr, uy: Expr, qx: Expr, qy: Expr, psi: Expr, sigma: Expr) -> Vector:  # noqa: ARG001
    """Film with h^3 dropped, as printed: G = D = pi/(2 psi), B = 0; psi = 0 is the limit w = 0."""
    return 2 * psi / pi * qx, 2 * psi / pi * qy


def plain_mobility(e2: Expr, psi: Expr = Integer(0)) -> tuple[Expr, Expr, Expr]:  # noqa: ARG001
    """Mobilities of the plain film with its half film fixed at 0..pi (Booker's integrals; audit 3.2)."""
    q = 1 - e2
    P = pi**2 + (2 * pi**2 - 16) * e2
    root = q * sqrt(q)
    return 2 * pi * (1 + 2 * e2) * root / P, -6 * pi * root / P, -8 * q**2 / P


def _fixed_arc(mobility: Callable[[Expr, Expr], tuple[Expr, Expr, Expr]]) -> Callable[..., Vector]:
    def velocity(ux: Expr, uy: Expr, qx: Expr, qy: Expr, psi: Expr, sigma: Expr) -> Vector:
        """Velocity under a half film fixed at 0..pi (spin > 0) or pi..2 pi (spin < 0)."""
        e2 = ux**2 + uy**2
        mG, mDG, mB = mobility(e2, psi)
        along = qx * ux + qy * uy  # eps s_r
        across = qy * ux - qx * uy  # eps s_t
        coupling = sigma * mB / sqrt(e2 + CENTRE)  # direction-dependent at the centre, but bounded
        return (
            mG * qx + mDG * along * ux - coupling * (across * ux - along * uy),
            mG * qy + mDG * along * uy - coupling * (across * uy + along * ux),
        )

    return velocity


def plain_fixed_force(ux: Expr, uy: Expr, wx: Expr, wy: Expr) -> Vector:
    """Force of the plain film with fixed half film on the journal, over A times the clock speed: F = -2 M w."""
    e2 = ux**2 + uy**2
    q = 1 - e2
    root = sqrt(q)
    D = pi / (2 * q * root)
    GD = 3 * pi / (2 * q**2 * root)  # (G - D)/eps^2
    B = -2 / q**2 / sqrt(e2 + CENTRE)  # B/eps^2
    along = wx * ux + wy * uy
    across = wy * ux - wx * uy
    return (
        -2 * (D * wx + GD * along * ux + B * (across * ux - along * uy)),
        -2 * (D * wy + GD * along * uy + B * (across * uy + along * ux)),
    )
