"""Film laws as expressions: the velocity of a massless journal under a load, for declarations of models.

Every law solves ``M w = q`` for the journal's velocity ``w``, seen from the frame that turns at half the journal's spin;
``q = kappa d/(2 Gamma)`` is the shaft's force in film units. All are written without dividing by the eccentricity where
the film has a limit at the centre. Source: equation audit, sections 3.2 and 4; coordinates of the tables from `scaled`.
"""

from collections.abc import Callable
from dataclasses import dataclass

from sympy import Expr, Float, Integer, Rational, cbrt, pi, sqrt

from whirlmap.equations import Table
from whirlmap.films import scaled
from whirlmap.films.tables import fixed_arc_smooth, positive_arc_smooth

#: Added to squares under a root, so that 0/0 at the very centre, or under no load, is the limit 0 that the film has there.
CENTRE = Float("1e-100")

FIXED_ARC = Table("fixed_arc", ("fD", "fH", "fB"), fixed_arc_smooth, cells=(64,), degree=5)
POSITIVE_ARC = Table("positive_arc", ("F", "H"), positive_arc_smooth, cells=(64, 32), degree=5)

Vector = tuple[Expr, Expr]
Mobility = Callable[[Expr, Expr], tuple[Expr, Expr, Expr]]


@dataclass(frozen=True)
class FilmLaw:
    """One film law in symbols.

    Attributes
    ----------
    velocity : callable
        ``velocity(ux, uy, qx, qy, psi, sigma) -> (wx, wy)``; sigma is the sign of the journal's spin.
    mobility : callable, optional
        ``mobility(e2, psi) -> (D/Delta, (G - D)/(Delta eps^2), B/(Delta eps))`` of a fixed half film.
    tables : tuple of Table
        Tables that the expressions read.
    """

    velocity: Callable[..., Vector]
    mobility: Mobility | None = None
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
        radial, _, coupling = self.mobility(e2, psi)
        slip = factor * coupling * ((qx * ux + qy * uy) / sqrt(e2 + CENTRE) - coupling / radial * moment)
        return -slip * uy, slip * ux


def film_law(film: str, arc: str, *, plain: bool = False) -> FilmLaw:
    """Return the law for one choice of film (porous, printed) and arc (fixed, positive); ``plain`` takes psi = 0."""
    if film == "printed":
        return FilmLaw(printed_velocity)
    if arc == "positive":
        return FilmLaw(positive_arc_velocity, tables=(POSITIVE_ARC,))
    if plain:
        return FilmLaw(_fixed_arc(plain_mobility), plain_mobility)
    return FilmLaw(_fixed_arc(porous_mobility), porous_mobility, (FIXED_ARC,))


def printed_velocity(ux: Expr, uy: Expr, qx: Expr, qy: Expr, psi: Expr, sigma: Expr) -> Vector:  # noqa: ARG001
    """Film with h^3 dropped, as printed: G = D = pi/(2 psi), B = 0; psi = 0 is the limit w = 0."""
    return 2 * psi / pi * qx, 2 * psi / pi * qy


def plain_mobility(e2: Expr, psi: Expr) -> tuple[Expr, Expr, Expr]:  # noqa: ARG001
    """Mobilities of the plain film with its half film fixed at 0..pi (Booker's integrals)."""
    q = 1 - e2
    P = pi**2 + (2 * pi**2 - 16) * e2
    return 2 * pi * q**2 * sqrt(q) / P, 6 * pi * q * sqrt(q) / P, -8 * q**2 / P


def porous_mobility(e2: Expr, psi: Expr) -> tuple[Expr, Expr, Expr]:
    """Mobilities of the porous film with its half film fixed at 0..pi, from the table."""
    k = cbrt(psi)
    wall, centre = (_unfolded((1 - edge) / 2, k) ** Rational(1, 4) for edge in ((1 + scaled.BEYOND * k) ** 2, 0))
    T = _unfolded((1 - e2) / 2, k)
    root = sqrt(T)
    fD, fH, fB = FIXED_ARC(psi, (sqrt(root) - wall) / (centre - wall))
    return T**2 * root * fD, T * root * fH, T**2 * fB


def _unfolded(gap: Expr, k: Expr) -> Expr:
    centred = gap - k / 2
    return centred + sqrt(centred**2 + Rational(3, 4) * k**2)


def _fixed_arc(mobility: Mobility) -> Callable[..., Vector]:
    def velocity(ux: Expr, uy: Expr, qx: Expr, qy: Expr, psi: Expr, sigma: Expr) -> Vector:
        """Velocity under a half film fixed at 0..pi (spin > 0) or pi..2 pi (spin < 0)."""
        e2 = ux**2 + uy**2
        radial, excess, mB = mobility(e2, psi)
        along = qx * ux + qy * uy  # eps s_r
        across = qy * ux - qx * uy  # eps s_t
        coupling = sigma * mB / sqrt(e2 + CENTRE)  # direction-dependent at the centre, but bounded
        return (
            radial * qx - excess * across * uy - coupling * (across * ux - along * uy),
            radial * qy + excess * across * ux - coupling * (across * uy + along * ux),
        )

    return velocity


def positive_arc_velocity(ux: Expr, uy: Expr, qx: Expr, qy: Expr, psi: Expr, sigma: Expr) -> Vector:  # noqa: ARG001
    """Velocity under the half film of positive pressure, in the frame of the load (Booker's mobility), from the table."""
    k = cbrt(psi)
    size = sqrt(qx**2 + qy**2 + CENTRE)
    cx, cy = qx / size, qy / size
    xi, eta = ux * cx + uy * cy, uy * cx - ux * cy
    R = 1 + Rational(3, 4) * k
    far = 1 + scaled.BEYOND * k
    near, behind = (_unfolded(1 - edge, k) ** Rational(1, 4) for edge in (far, -far))
    T = _unfolded(1 - xi, k)
    root = sqrt(T)
    z = sqrt((eta**2 + CENTRE) / (R**2 - xi**2))
    F, H = POSITIVE_ARC(psi, (sqrt(root) - near) / (behind - near), z * R / far)
    ahead, aside = T**2 * root * F, -eta * T * root * H
    return size * (ahead * cx - aside * cy), size * (ahead * cy + aside * cx)


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
