"""Tables of the scaled mobilities of `whirlmap.films.scaled`, one psi each, and velocities read from them.

`fixed_arc_smooth` and `positive_arc_smooth` are the functions to tabulate, of coordinates in [0, 1]. The
second interpolates: a solved point costs 30 microseconds and a table asks for 10^5 of them, so it solves
16128 points once per psi (0.5 s) on panels of degree 11 that narrow towards the wall. The local polynomials
and velocities below show in NumPy what a compiled kernel does, and measure its error.

Largest error of w under a unit load with quintic cells (64 on the fixed arc, 64 x 32 on the positive one),
eps from 0 to 1 + 0.3 k (1 - 1e-5 for psi = 0), 20000 points, half of them close to the wall and to the load's
direction:

=====  ========================  =========================
psi    fixed: absolute, over w   positive: absolute, over w
=====  ========================  =========================
0      2e-12, 1e-10              7e-13, 2e-08
1e-8   3e-10, 1e-04              7e-12, 3e-05
1e-6   2e-10, 5e-06              1e-11, 3e-06
1e-4   1e-10, 8e-08              4e-11, 3e-07
1e-3   5e-11, 8e-09              8e-11, 7e-08
1e-2   2e-11, 4e-10              1e-10, 2e-08
0.1    2e-12, 9e-12              2e-10, 3e-09
1      2e-13, 2e-13              2e-10, 3e-10
10     8e-13, 1e-13              1e-10, 2e-11
=====  ========================  =========================

The relative error is largest on the wall, where w is of order psi^(5/6); it falls like cells^-6.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike, NDArray

from whirlmap.errors import RangeError
from whirlmap.films import scaled

Floats = NDArray[np.float64]

_ORDER = 12  # points per panel and coordinate
_NEAREST = 0.03  # psi = 0 reaches s = 0, where no film is left to solve: sample from T = 8e-7 and continue


@dataclass(frozen=True)
class LocalPolynomials:
    """Piecewise polynomials on uniform cells of one or two coordinates in [0, 1], continuous across cells.

    Attributes
    ----------
    coefficients : array
        Shape (cells, degree + 1, function) or (cells_x, cells_y, degree + 1, degree + 1, function), of
        1, t, t^2, ... in the local coordinate t = x * cells - floor(x * cells).
    """

    coefficients: Floats

    def __call__(self, *x: Floats) -> Floats:
        """Values, shape (function, point), at flat arrays of coordinates; outside, the end cell continues."""
        cells, local = [], []
        for axis, x_axis in enumerate(x):
            position = x_axis * self.coefficients.shape[axis]
            cell = np.clip(np.floor(position).astype(int), 0, self.coefficients.shape[axis] - 1)
            cells.append(cell)
            local.append(position - cell)
        value = self.coefficients[tuple(cells)]  # (point, degree + 1, ..., function)
        for t in local:
            t = t.reshape(-1, *(1,) * (value.ndim - 2))
            total = value[:, -1]
            for power in range(value.shape[1] - 2, -1, -1):
                total = total * t + value[:, power]
            value = total
        return value.T


def fixed_arc_smooth(psi: float, x: ArrayLike) -> tuple[Floats, Floats, Floats]:
    """Scaled mobilities fD, fH, fB of the fixed arc over x in [0, 1], from the wall to the centre.

    x = (s - s_wall) / (s_centre - s_wall), see `whirlmap.films.scaled.fixed_arc_coordinates`.
    """
    wall, centre = scaled.fixed_arc_range(psi)
    fD, fH, fB = scaled.fixed_arc_scaled(wall + (centre - wall) * np.asarray(x, dtype=float), psi)
    return fD, fH, fB


def positive_arc_smooth(psi: float, x: ArrayLike, y: ArrayLike) -> tuple[Floats, Floats]:
    """Scaled mobilities F, H of the positive arc over the unit square.

    x = (s - s_near) / (s_behind - s_near) runs from the wall ahead of the load to the wall behind it,
    y = z / z_end, see `whirlmap.films.scaled.positive_arc_coordinates`. Interpolated on panels; the first
    call for a psi takes half a second. Relative error at most 6e-8 (psi = 1e-8, at the wall), 3e-9 for
    psi >= 1e-4, 2e-8 in H for psi = 0 at 1 - eps < 1e-3; 1e-11 of the largest w.
    """
    x_, y_ = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(y, dtype=float))
    (near, behind), (start, end) = scaled.positive_arc_range(psi)
    s, z = near + (behind - near) * x_.ravel(), start + (end - start) * y_.ravel()
    edges_s, edges_z, coefficients = _positive_panels(psi)
    out = np.empty((2, s.size))
    for first in range(0, s.size, 2048):
        block = slice(first, first + 2048)
        panel_s, basis_s = _chebyshev_basis(edges_s, s[block])
        panel_z, basis_z = _chebyshev_basis(edges_z, z[block])
        local = coefficients[panel_s, panel_z]
        out[:, block] = np.einsum("na,nabf,nb->fn", basis_s, local, basis_z, optimize=True)
    F, H = out.reshape(2, *x_.shape)
    return F, H


@lru_cache(maxsize=8)
def _positive_panels(psi: float) -> tuple[Floats, Floats, Floats]:
    """Panel edges in s and z, and Chebyshev coefficients (panel_s, panel_z, order, order, 2) of F, H."""
    (near, behind), (start, end) = scaled.positive_arc_range(psi)
    edges_s = np.geomspace(max(near, _NEAREST), behind, 15)
    edges_z = np.linspace(start, end, 9)
    s, z = (_panel_points(edges) for edges in (edges_s, edges_z))
    sampled = scaled.positive_arc_scaled(s[:, None], z, psi).reshape(2, 14, _ORDER, 8, _ORDER)
    to_chebyshev = np.linalg.inv(chebyshev.chebvander(chebyshev.chebpts1(_ORDER), _ORDER - 1))
    coefficients = np.einsum("ai,fpiqj,bj->pqabf", to_chebyshev, sampled, to_chebyshev, optimize=True)
    return edges_s, edges_z, np.ascontiguousarray(coefficients)


def _panel_points(edges: Floats) -> Floats:
    nodes = 0.5 * (1.0 + chebyshev.chebpts1(_ORDER))
    return (edges[:-1, None] + np.multiply.outer(np.diff(edges), nodes)).ravel()


def _chebyshev_basis(edges: Floats, x: Floats) -> tuple[NDArray[np.intp], Floats]:
    """Panel of each point and the Chebyshev polynomials there; the first panel continues towards the wall."""
    panel = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, edges.size - 2)
    local = 2.0 * (x - edges[panel]) / np.diff(edges)[panel] - 1.0
    return panel, np.asarray(chebyshev.chebvander(local, _ORDER - 1), dtype=np.float64)


def tabulate_fixed(psi: float, *, cells: int = 64, degree: int = 5) -> LocalPolynomials:
    """Table of `fixed_arc_smooth`."""
    x, to_monomials = _cell_points(cells, degree)
    f = np.stack(fixed_arc_smooth(psi, x), axis=-1)
    return LocalPolynomials(np.einsum("ij,cjf->cif", to_monomials, f))


def tabulate_positive(psi: float, *, cells: tuple[int, int] = (64, 32), degree: int = 5) -> LocalPolynomials:
    """Table of `positive_arc_smooth`."""
    (x, to_monomials), (y, _) = (_cell_points(n, degree) for n in cells)
    f = np.stack(positive_arc_smooth(psi, x[:, :, None, None], y), axis=-1)
    return LocalPolynomials(np.einsum("im,amcnf,jn->acijf", to_monomials, f, to_monomials, optimize=True))


def _cell_points(cells: int, degree: int) -> tuple[Floats, Floats]:
    """Chebyshev-Lobatto points, shape (cells, degree + 1), and the matrix to the monomials of a cell.

    Neighbours share the point between them, which makes the table continuous.
    """
    local = 0.5 * (1.0 + chebyshev.chebpts2(degree + 1))
    to_monomials = np.asarray(np.linalg.inv(np.vander(local, increasing=True)), dtype=np.float64)
    return (np.arange(cells)[:, None] + local) / cells, to_monomials


def fixed_arc_velocity(
    table: LocalPolynomials,
    ux: ArrayLike,
    uy: ArrayLike,
    qx: ArrayLike,
    qy: ArrayLike,
    psi: float,
    sigma: ArrayLike = 1.0,
) -> tuple[Floats, Floats]:
    """`whirlmap.films.porous_short.fixed_arc_velocity` from a table of `tabulate_fixed` for the same psi.

    Raises
    ------
    RangeError
        A point lies beyond the wall by more than 0.3 k (psi = 0: at it or beyond).
    """
    (ux, uy, qx, qy, sigma), shape = _flat(ux, uy, qx, qy, sigma)
    e2 = ux * ux + uy * uy
    _check_inside(e2, psi)
    s, T52, T32, T2 = scaled.fixed_arc_coordinates(e2, psi)
    wall, centre = scaled.fixed_arc_range(psi)
    fD, fH, fB = table((s - wall) / (centre - wall))
    along, across = qx * ux + qy * uy, qy * ux - qx * uy  # q.u and q.Ju
    eps = np.sqrt(e2)
    cross = np.divide(sigma * T2 * fB, eps, out=np.zeros_like(eps), where=eps > 0.0)  # of order eps with u, u
    wx = T52 * fD * qx - T32 * fH * across * uy - cross * (across * ux - along * uy)
    wy = T52 * fD * qy + T32 * fH * across * ux - cross * (across * uy + along * ux)
    return wx.reshape(shape), wy.reshape(shape)


def positive_arc_velocity(
    table: LocalPolynomials, ux: ArrayLike, uy: ArrayLike, qx: ArrayLike, qy: ArrayLike, psi: float
) -> tuple[Floats, Floats]:
    """`whirlmap.films.porous_short.positive_arc_velocity` from a table of `tabulate_positive`."""
    (ux, uy, qx, qy), shape = _flat(ux, uy, qx, qy)
    _check_inside(ux * ux + uy * uy, psi)
    load = np.hypot(qx, qy)
    loaded = load > 0.0
    cos, sin = (np.divide(q, load, out=np.zeros_like(load), where=loaded) for q in (qx, qy))
    xi, eta = ux * cos + uy * sin, uy * cos - ux * sin
    s, z, T52, T32 = scaled.positive_arc_coordinates(xi, eta * eta, psi)
    (near, behind), (start, end) = scaled.positive_arc_range(psi)
    F, H = table((s - near) / (behind - near), (z - start) / (end - start))
    along, across = load * T52 * F, -load * eta * T32 * H
    return (along * cos - across * sin).reshape(shape), (along * sin + across * cos).reshape(shape)


def _flat(*args: ArrayLike) -> tuple[list[Floats], tuple[int, ...]]:
    arrays = np.broadcast_arrays(*(np.asarray(a, dtype=float) for a in args))
    return [a.ravel() for a in arrays], arrays[0].shape


def _check_inside(e2: Floats, psi: float) -> None:
    limit = 1.0 + scaled.BEYOND * float(np.cbrt(psi))
    outside = ~(e2 <= limit**2) if psi > 0.0 else ~(e2 < 1.0)
    if outside.any():
        at = np.flatnonzero(outside)[0]
        raise RangeError(
            f"{outside.sum()} of {e2.size} points lie outside the table, first at index {at}: "
            f"eps = {np.sqrt(e2[at])!r}; expected at most {limit!r}" + (" (excluded)" if psi == 0.0 else "")
        )
