"""Film laws as SymPy expressions: the velocity of a massless journal under a load, for declarations of models.

Every law solves ``M w = q`` for the journal's velocity ``w``, seen from the frame that turns at half the journal's spin;
``q = kappa d/(2 Gamma)`` is the shaft's force in film units. All are written without dividing by the eccentricity where
the film has a limit at the centre. Source: equation audit, sections 3.2 and 4.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from sympy import Expr, Float, Integer, Rational, cbrt, pi, sqrt

from whirlmap.equations import Table, magnitude
from whirlmap.films import scaled, tables

#: Added to squares under a root, so that 0/0 at the very centre, or under no load, is the limit 0 that the film has there.
CENTRE = Float("1e-100")

FIXED_ARC = Table(
    "fixed_arc", ("e2",), ("radial", "excess", "coupling"),
    exact=tables.fixed_arc, samples=tables.fixed_arc, edges=tables.fixed_arc_edges, degree=7,
)  # fmt: skip
POSITIVE_ARC = Table(
    "positive_arc", ("xi", "z"), ("ahead", "aside"),
    exact=tables.positive_arc, samples=tables.positive_arc_samples, edges=tables.positive_arc_edges, degree=6,
    panel=tables.positive_arc_panel,
)  # fmt: skip

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


def film_law(film: str, arc: str, *, plain: bool = False, own: str = "") -> FilmLaw:
    """Return the law for one choice of film (porous, printed) and arc (fixed, positive).

    ``plain`` takes psi = 0. ``own`` is the bearing whose own table the law reads, where bearings differ in their
    permeability.
    """
    if film == "printed":
        return FilmLaw(printed_velocity)
    if arc == "positive":
        table = _of(POSITIVE_ARC, own)
        return FilmLaw(_positive_arc(table), tables=(table,))
    if plain:
        return FilmLaw(_fixed_arc(plain_mobility), plain_mobility)
    table = _of(FIXED_ARC, own)
    mobility = _porous_mobility(table)
    return FilmLaw(_fixed_arc(mobility), mobility, (table,))


def _of(table: Table, own: str) -> Table:
    """The table of one bearing: a table is read at one permeability."""
    return replace(table, name=f"{table.name}_{own}") if own else table


def permeability_fault(values: Mapping[str, float]) -> str:
    """Say what is wrong with ``psi`` for a film that is read from a table, as a model's check; empty where nothing is."""
    psi = values["psi"]
    if 0.0 < psi < scaled.SMALLEST:
        return (
            f"psi = {psi:g} is too small for the porous film: expected 0 (the plain film) or at least"
            f" {scaled.SMALLEST:g}; in between psi^(1/3) drowns in the rounding of the gap"
        )
    return ""


def printed_velocity(ux: Expr, uy: Expr, qx: Expr, qy: Expr, psi: Expr, sigma: Expr) -> Vector:  # noqa: ARG001
    """Film with h^3 dropped, as printed: G = D = pi/(2 psi), B = 0; psi = 0 is the limit w = 0."""
    return 2 * psi / pi * qx, 2 * psi / pi * qy


def plain_mobility(e2: Expr, psi: Expr) -> tuple[Expr, Expr, Expr]:  # noqa: ARG001
    """Mobilities of the plain film with its half film fixed at 0..pi (Booker's integrals)."""
    q = 1 - e2
    P = pi**2 + (2 * pi**2 - 16) * e2
    return 2 * pi * q**2 * sqrt(q) / P, 6 * pi * q * sqrt(q) / P, -8 * q**2 / P


def _porous_mobility(table: Table) -> Mobility:
    def mobility(e2: Expr, psi: Expr) -> tuple[Expr, Expr, Expr]:
        """Mobilities of the porous film with its half film fixed at 0..pi, from the table."""
        radial, excess, coupling = table(psi, e2)
        return radial, excess, coupling

    return mobility


def _fixed_arc(mobility: Mobility) -> Callable[..., Vector]:
    def velocity(ux: Expr, uy: Expr, qx: Expr, qy: Expr, psi: Expr, sigma: Expr) -> Vector:
        """Velocity under a half film fixed at 0..pi (spin > 0) or pi..2 pi (spin < 0)."""
        e2 = ux**2 + uy**2
        radial, excess, mB = mobility(e2, psi)
        along = qx * ux + qy * uy  # eps s_r
        across = qy * ux - qx * uy  # eps s_t
        coupling = sigma * mB / sqrt(e2 + CENTRE)  # direction-dependent at the centre, but bounded
        turn, approach = excess * across - coupling * along, coupling * across  # across and against the eccentricity
        return radial * qx - turn * uy - approach * ux, radial * qy + turn * ux - approach * uy

    return velocity


def _positive_arc(table: Table) -> Callable[..., Vector]:
    def velocity(ux: Expr, uy: Expr, qx: Expr, qy: Expr, psi: Expr, sigma: Expr) -> Vector:  # noqa: ARG001
        """Velocity under the half film of positive pressure, in the frame of the load (Booker), from the table."""
        load2 = qx**2 + qy**2 + CENTRE
        along, across = qx * ux + qy * uy, qx * uy - qy * ux
        R = 1 + Rational(3, 4) * cbrt(psi)
        size = sqrt(load2)
        z = magnitude(across) / sqrt(R**2 * load2 - along**2)  # its slope jumps where what it is multiplied by is zero
        ahead, aside = table(psi, along / size, z)
        turn = aside * across / size
        return ahead * qx + turn * qy, ahead * qy - turn * qx

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
