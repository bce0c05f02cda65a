"""Coordinates in which the film's mobility is smooth up to the wall, for tables with one psi each.

The mobility (velocity per load) of a thin film falls like powers of the gap, and for small psi turns within a
few k = psi^(1/3) of the wall from those powers into a finite plateau. Both are taken out by one coordinate.
Where the film is thinnest, h^3 + psi vanishes at h = -k and h = k exp(+-i pi/3), and the film integrals have
branch points at the complex pair. With d the gap,

``T = (d - k/2) + sqrt((d - k/2)^2 + 3 k^2/4)``

is the Joukowski variable that unfolds that pair; T -> 2 d for d >> k, and T > 0 beyond the wall. Every
function below is (power of T) x (smooth function of s = T^(1/4), of order one). The powers are those of the
plain film near contact: T^(5/2) for radial and T^(3/2) for tangential motion (Booker 1965). The fourth root
narrows the cells towards the wall without a logarithm. Tables are for psi = 0 or psi >= 1e-12; between, a
double has no room for k.

All lengths in c; mobilities per load q = kappa d/(2 Gamma) as in `whirlmap.films.porous_short`.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from whirlmap.films.porous_short import film_integrals, unit_load_velocity

Floats = NDArray[np.float64]

BEYOND = 0.3  # tables reach to eps = 1 + BEYOND k: a stage of an integrator may step over the wall
_HAT = 0.75  # the wall seen by z lies at 1 + _HAT k, so that z < 1 on the whole table
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(96)  # B/eps and (G-D)/eps^2 are sharper than G, B, D


def _root(psi: float) -> float:
    return float(np.cbrt(psi))


def _unfolded(gap: Floats, k: float) -> Floats:
    centred = gap - 0.5 * k
    return centred + np.sqrt(centred * centred + 0.75 * k * k)


def _folded(T: Floats, k: float) -> Floats:
    """Gap of T: the inverse of `_unfolded`."""
    return 0.5 * T if k == 0.0 else 0.5 * (k + T - 0.75 * k * k / T)


def fixed_arc_coordinates(e2: ArrayLike, psi: float) -> tuple[Floats, Floats, Floats, Floats]:
    """Coordinate and scale factors of the fixed half film.

    ``w = T52 fD q + T32 fH (q.Ju) Ju - sigma T2 fB [(q.Ju) u + (q.u) Ju]/eps`` with

    ``D/Delta = T52 fD``,   ``(G-D)/(Delta eps^2) = T32 fH``,   ``B/(Delta eps) = T2 fB``.

    The radial mobility D/Delta is the smallest near the wall and stands alone: with G/Delta q + ... (q.u) u
    instead it would be the difference of two terms 1/(1-eps) times larger.

    Parameters
    ----------
    e2 : array_like
        eps^2 [1], at most (1 + 0.3 k)^2; below 1 for psi = 0.
    psi : float
        Permeability parameter [1].

    Returns
    -------
    s : array
        Table coordinate T^(1/4) with d = (1 - eps^2)/2.
    T52, T32, T2 : array
        Scale factors T^(5/2), T^(3/2), T^2.
    """
    T = _unfolded(0.5 * (1.0 - np.asarray(e2, dtype=float)), _root(psi))
    root = np.sqrt(T)
    T32, T2 = T * root, T * T
    return np.sqrt(root), T * T32, T32, T2


def fixed_arc_range(psi: float) -> tuple[float, float]:
    """Return the ends of the coordinate s: the wall (eps = 1 + 0.3 k) and the centre (eps = 0)."""
    wall, *_ = fixed_arc_coordinates((1.0 + BEYOND * _root(psi)) ** 2, psi)
    centre, *_ = fixed_arc_coordinates(0.0, psi)
    return float(wall), float(centre)


def fixed_arc_scaled(s: ArrayLike, psi: float) -> Floats:
    """Scaled mobilities fD, fH, fB of the fixed half film.

    Parameters
    ----------
    s : array_like, shape (...)
        Table coordinate inside `fixed_arc_range`, above 0.
    psi : float

    Returns
    -------
    f : array, shape (3, ...)

    Notes
    -----
    psi = 0 from the closed form [audit sec. 3.2]. Otherwise the rule of `film_integrals`, with B and G - D
    integrated by parts so that no 0/0 is left at eps = 0, W = 1/(h^3 + psi):

    ``B/eps = -3/2 int sin^3 h^2 W^2``,   ``(G-D)/eps^2 = 1/3 int sin^4 W^2 (18 h^4 W - 6 h)``.
    """
    s_ = np.asarray(s, dtype=float)
    T = s_.ravel() ** 4
    k = _root(psi)
    e2 = np.maximum(1.0 - 2.0 * _folded(T, k), 0.0)  # rounding at the centre
    if psi == 0.0:
        P = np.pi**2 + (2.0 * np.pi**2 - 16.0) * e2
        return np.multiply.outer([2.0 * np.pi, 6.0 * np.pi, -8.0], 1.0 / P).reshape(3, *s_.shape)
    D, G_D, B_eps, Delta = _even_integrals(np.sqrt(e2), psi)
    f = np.stack([D / T**2.5, G_D / T**1.5, B_eps / T**2]) / Delta
    return f.reshape(3, *s_.shape)


def _even_integrals(eps: Floats, psi: float) -> tuple[Floats, Floats, Floats, Floats]:
    """D, (G - D)/eps^2, B/eps and Delta: the even functions of eps that the Cartesian form needs."""
    G, B, D = film_integrals(eps, psi)
    margin = _HAT * _root(psi)
    wall = 1.0 + margin
    eh = eps / wall
    one_minus = (1.0 - eps + margin) / wall
    x = 0.25 * np.pi * (_NODES + 1.0)  # chi/2
    sin2, sine = np.sin(x) ** 2, np.sin(2.0 * x)
    q = one_minus[:, None] + 2.0 * np.multiply.outer(eh, sin2)
    level = ((1.0 - eps) * (1.0 + eps) + margin) / wall
    N = level[:, None] + np.multiply.outer(margin * eh, 1.0 - 2.0 * sin2)
    N3, seep = N * N * N, psi * (q * q * q)
    den = N3 + seep
    S = np.sqrt(one_minus * (1.0 + eh))
    weights = 0.5 * np.pi * _WEIGHTS
    B_eps = -1.5 * S**4 * ((N / den) ** 2 @ (weights * sine**3))
    G_D = 2.0 * S**5 * ((N * (2.0 * N3 - seep) / den**3) @ (weights * sine**4))
    return D, G_D, B_eps, G * D - B * B


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
    k = _root(psi)
    R = 1.0 + _HAT * k
    T = _unfolded(1.0 - xi_, k)
    root = np.sqrt(T)
    T32 = T * root
    return np.sqrt(root), np.sqrt(eta2_ / ((R - xi_) * (R + xi_))), T * T32, T32


def positive_arc_range(psi: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the ends of the coordinates s (from the wall ahead of the load to the wall behind it) and z."""
    k = _root(psi)
    far = 1.0 + BEYOND * k
    near, behind = (float(_unfolded(np.asarray(1.0 - x), k) ** 0.25) for x in (far, -far))
    return (near, behind), (0.0, far / (1.0 + _HAT * k))


def positive_arc_scaled(s: ArrayLike, z: ArrayLike, psi: float) -> Floats:
    """Scaled mobilities F, H of the positive-pressure half film.

    Parameters
    ----------
    s, z : array_like, broadcasting
        Inside `positive_arc_range`; s > 0, and 0 < z < 1 (H is a ratio, and psi = 0 ends at z = 1).
    psi : float

    Returns
    -------
    F, H : array, shape (2, ...)

    Raises
    ------
    IntegrationError
        Some point did not converge.

    Notes
    -----
    Solved with `unit_load_velocity`; the gap 1 - eps is formed from T and z, so that it keeps its digits.
    """
    s_, z_ = np.broadcast_arrays(np.asarray(s, dtype=float), np.asarray(z, dtype=float))
    shape = s_.shape
    s_, z_ = s_.ravel(), z_.ravel()
    k = _root(psi)
    margin = _HAT * k
    T = s_**4
    d = _folded(T, k)
    xi = 1.0 - d
    off_axis = d * (2.0 - d)  # 1 - xi^2
    beyond = margin * (2.0 + margin)  # R^2 - 1
    eta = z_ * np.sqrt(off_axis + beyond)
    eps = np.hypot(xi, eta)
    gap = (off_axis * (1.0 - z_) * (1.0 + z_) - z_ * z_ * beyond) / (1.0 + eps)
    cos, sin = xi / eps, eta / eps  # of the angle from the load to u
    w_r, w_t = unit_load_velocity(eps, gap, np.full_like(eps, psi), cos, -sin)
    M_xi, M_eta = w_r * cos - w_t * sin, w_r * sin + w_t * cos
    return np.stack([M_xi / T**2.5, -M_eta / (eta * T**1.5)]).reshape(2, *shape)
