"""Scaled coordinates for tables of film mobility, and the film of positive pressure (Guembel) interpolated in them.

The mobility (velocity per load) of a thin film falls like powers of the gap, and for small psi turns within a
few k = psi^(1/3) of the wall from those powers into a finite plateau. Where the film is thinnest, h^3 + psi
vanishes at h = -k and h = k exp(+-i pi/3), and the film integrals have branch points at the complex pair. With
d the gap,

``T = (d - k/2) + sqrt((d - k/2)^2 + 3 k^2/4)``

is the Joukowski variable that unfolds that pair; T -> 2 d for d >> k, and T > 0 beyond the wall. Since
``dT/T = dd/|d - branch point|``, cells whose edges are equidistant in log T are all as wide as the mobility
allows, whatever psi is. Tables are for psi = 0 or psi >= 1e-12; between, a double has no room for k.

The positive arc has no formula and a solved point costs 30 microseconds; a table asks for 10^5 of them. So it
is interpolated between 16128 points solved once per psi (0.5 s), as (power of T) x (smooth function of
s = T^(1/4), of order one). The powers are those of the plain film near contact: T^(5/2) for radial and T^(3/2)
for tangential motion (Booker 1965).

All lengths in c; mobilities per load q = kappa d/(2 Gamma) as in `whirlmap.films.porous_short`.
"""

from functools import lru_cache

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike, NDArray

from whirlmap.films.porous_short import check_range, unit_load_velocity

Floats = NDArray[np.float64]

BEYOND = 0.3  # tables reach to eps = 1 + BEYOND k: a stage of an integrator may step over the wall
SMALLEST = 1e-12  # permeability of a table, but for zero: below it k drowns in the rounding of the gap
HAT = 0.75  # the wall seen by z lies at 1 + HAT k, so that z < 1 on the whole table
_BLOCK = 1024  # points solved together: with their quadrature nodes they stay in the second-level cache
_ORDER = 12  # points per panel and coordinate
_NEAREST = 0.03  # psi = 0 reaches s = 0, where no film is left to solve: sample from T = 8e-7 and continue


def root_of(psi: float) -> float:
    """Return k = psi^(1/3)."""
    return float(np.cbrt(psi))


def unfolded(gap: Floats, k: float) -> Floats:
    """T of a gap."""
    centred = gap - 0.5 * k
    return centred + np.sqrt(centred * centred + 0.75 * k * k)


def folded(T: Floats, k: float) -> Floats:
    """Gap of T: the inverse of `unfolded`."""
    return 0.5 * T if k == 0.0 else 0.5 * (k + T - 0.75 * k * k / T)


def positive_arc_coordinates(
    xi: ArrayLike, eta2: ArrayLike, psi: float
) -> tuple[Floats, Floats, Floats, Floats]:
    """Coordinates and scale factors of the positive-pressure half film, in the frame of the load.

    With qhat = q/|q|, xi = u.qhat and eta = qhat x u, the velocity is
    ``w = |q| [T52 F qhat - eta T32 H J qhat]`` with F, H > 0 even in eta.

    Parameters
    ----------
    xi, eta2 : array_like
        Component of u along the load [c], and eta^2; eps at most 1 + 0.3 k, below 1 for psi = 0.
    psi : float
        Permeability parameter [1].

    Returns
    -------
    s, z : array
        Table coordinates: s = T^(1/4) with d = 1 - xi, and z = |eta|/sqrt((1 + 3k/4)^2 - xi^2) in [0, 1].
    T52, T32 : array
        Scale factors.

    Notes
    -----
    z and not z^2: as xi -> 1 the edge of the arc leaves the thin film like 1/z, and the tails it cuts off are
    odd powers of z. Analytic in z up to z = 1, for there the arc leaves out the thin film altogether.
    """
    xi_, eta2_ = np.asarray(xi, dtype=float), np.asarray(eta2, dtype=float)
    k = root_of(psi)
    R = 1.0 + HAT * k
    T = unfolded(1.0 - xi_, k)
    root = np.sqrt(T)
    T32 = T * root
    return np.sqrt(root), np.sqrt(eta2_ / ((R - xi_) * (R + xi_))), T * T32, T32


def positive_arc_range(psi: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the ends of the coordinates s (from the wall ahead of the load to the wall behind it) and z."""
    k = root_of(psi)
    far = 1.0 + BEYOND * k
    near, behind = (float(unfolded(np.asarray(1.0 - x), k) ** 0.25) for x in (far, -far))
    return (near, behind), (0.0, far / (1.0 + HAT * k))


def positive_arc_solved(d: Floats, z: Floats, psi: float) -> tuple[Floats, Floats]:
    """Mobility of the positive-pressure half film, solved.

    Parameters
    ----------
    d, z : array, broadcasting
        d = 1 - xi, and z as in `positive_arc_coordinates`; z below 1e-8 counts as 1e-8, for the second
        mobility is a ratio whose limit is reached there.
    psi : float

    Returns
    -------
    ahead, aside : array
        ``w = |q| [ahead qhat - eta aside J qhat]``.

    Raises
    ------
    RangeError, IntegrationError
        Some point lies where no film is, or did not converge.

    Notes
    -----
    Solved with `unit_load_velocity`; the gap 1 - eps is formed from d and z, so that it keeps its digits.
    """
    d_, z_ = np.broadcast_arrays(np.asarray(d, dtype=float), np.maximum(z, 1e-8))
    shape = d_.shape
    d_, z_ = d_.ravel(), z_.ravel()
    margin = HAT * root_of(psi)
    off_axis = d_ * (2.0 - d_)  # 1 - xi^2
    beyond = margin * (2.0 + margin)  # R^2 - 1
    xi, eta = 1.0 - d_, z_ * np.sqrt(off_axis + beyond)
    eps = np.hypot(xi, eta)
    gap = (off_axis * (1.0 - z_) * (1.0 + z_) - z_ * z_ * beyond) / (1.0 + eps)
    psis = np.full_like(eps, psi)
    check_range(eps, psis)
    cos, sin = xi / eps, eta / eps  # of the angle from the load to u
    w_r, w_t = np.empty_like(eps), np.empty_like(eps)
    for first in range(0, eps.size, _BLOCK):
        at = slice(first, first + _BLOCK)
        w_r[at], w_t[at] = unit_load_velocity(eps[at], gap[at], psis[at], cos[at], -sin[at])
    M_xi, M_eta = w_r * cos - w_t * sin, w_r * sin + w_t * cos
    return M_xi.reshape(shape), (-M_eta / eta).reshape(shape)


def positive_arc_smooth(psi: float, s: ArrayLike, z: ArrayLike) -> tuple[Floats, Floats]:
    """Scaled mobilities F, H of the positive arc, interpolated on panels.

    Parameters
    ----------
    psi : float
    s, z : array, broadcasting
        Inside `positive_arc_range`. The first call for a psi takes half a second.

    Returns
    -------
    F, H : array
        ``ahead = T^(5/2) F``, ``aside = T^(3/2) H``. Relative error at most 6e-8 (psi = 1e-8, at the wall),
        3e-9 for psi >= 1e-4, 2e-8 in H for psi = 0 at 1 - eps < 1e-3; 1e-11 of the largest w.
    """
    s_, z_ = np.broadcast_arrays(np.asarray(s, dtype=float), np.asarray(z, dtype=float))
    shape = s_.shape
    s_, z_ = s_.ravel(), z_.ravel()
    edges_s, edges_z, coefficients = _positive_panels(psi)
    out = np.empty((2, s_.size))
    for first in range(0, s_.size, 2048):
        block = slice(first, first + 2048)
        panel_s, basis_s = _chebyshev_basis(edges_s, s_[block])
        panel_z, basis_z = _chebyshev_basis(edges_z, z_[block])
        local = coefficients[panel_s, panel_z]
        out[:, block] = np.einsum("na,nabf,nb->fn", basis_s, local, basis_z, optimize=True)
    F, H = out.reshape(2, *shape)
    return F, H


@lru_cache(maxsize=8)
def _positive_panels(psi: float) -> tuple[Floats, Floats, Floats]:
    """Panel edges in s and z, and Chebyshev coefficients (panel_s, panel_z, order, order, 2) of F, H."""
    (near, behind), (start, end) = positive_arc_range(psi)
    edges_s = np.geomspace(max(near, _NEAREST), behind, 15)
    edges_z = np.linspace(start, end, 9)
    s, z = (_panel_points(edges) for edges in (edges_s, edges_z))
    T = s[:, None] ** 4
    ahead, aside = positive_arc_solved(folded(T, root_of(psi)), z, psi)
    sampled = np.stack([ahead / T**2.5, aside / T**1.5]).reshape(2, 14, _ORDER, 8, _ORDER)
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
