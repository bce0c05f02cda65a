"""Mobility tables of the lane kernels, and their cells.

Cells are equidistant in log T (`whirlmap.films.scaled`), so that their number grows with log(1/psi) only and their error
hardly depends on psi. Largest error of the compiled tables at 6000 points, half of them close to the wall and to the load's
direction: velocity under a unit load for eps from 0 to 1 + 0.3 k (1 - 1e-5 for psi = 0), and the error over the velocity
itself at eps < 0.999.

=====  =====  ==================  ========  ====================
psi    cells  fixed: abs., rel.   cells     positive: abs., rel.
=====  =====  ==================  ========  ====================
0      103    5e-14, 3e-13        141 x 20  4e-11, 1e-08
1e-8   48     5e-14, 1e-12        71 x 20   4e-11, 8e-09
1e-6   38     4e-14, 2e-12        59 x 20   3e-11, 2e-09
1e-4   27     5e-14, 8e-13        46 x 20   3e-11, 1e-10
1e-3   22     1e-13, 9e-13        39 x 20   1e-11, 7e-11
1e-2   16     4e-13, 1e-12        33 x 20   8e-12, 4e-11
0.1    10     3e-12, 4e-12        26 x 20   4e-12, 2e-11
1      6      4e-11, 2e-11        20 x 20   2e-11, 5e-12
10     5      2e-13, 3e-14        14 x 20   2e-10, 7e-12
=====  =====  ==================  ========  ====================
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from whirlmap.errors import RangeError
from whirlmap.films import scaled
from whirlmap.films.porous_short import film_integrals

Floats = NDArray[np.float64]

_WIDTH_FIXED, _WIDTH_POSITIVE = 0.15, 0.12  # of a cell in log T, for polynomials of degree 7 and 6
_ACROSS = 20  # cells of z
_PANELS = 2  # panels in a decade of psi
_THINNEST = 2e-7  # T at which the table of a plain film ends: there is no film at T = 0
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(96)  # B/eps and (G-D)/eps^2 are sharper than G, B, D


def fixed_arc(psi: float, e2: ArrayLike) -> tuple[Floats, Floats, Floats]:
    """Mobilities of the fixed half film.

    ``w = radial q + excess (q.Ju) Ju - sigma coupling [(q.Ju) u + (q.u) Ju]/eps`` with

    ``radial = D/Delta``,   ``excess = (G-D)/(Delta eps^2)``,   ``coupling = B/(Delta eps)``.

    The radial mobility is the smallest near the wall and stands alone: with G/Delta q + ... (q.u) u instead it
    would be the difference of two terms 1/(1-eps) times larger.

    Parameters
    ----------
    psi : float
        Permeability parameter [1].
    e2 : array_like
        eps^2 [1], below (1 + 3/4 k)^2.

    Returns
    -------
    radial, excess, coupling : array

    Raises
    ------
    RangeError
        Some point lies where no film is.

    Notes
    -----
    psi = 0 from the closed form [audit sec. 3.2]. Otherwise the rule of `film_integrals`, with B and G - D
    integrated by parts so that no 0/0 is left at eps = 0, W = 1/(h^3 + psi):

    ``B/eps = -3/2 int sin^3 h^2 W^2``,   ``(G-D)/eps^2 = 1/3 int sin^4 W^2 (18 h^4 W - 6 h)``.
    """
    e2_ = np.asarray(e2, dtype=float)
    if psi == 0.0:
        q = 1.0 - e2_
        P = np.pi**2 + (2.0 * np.pi**2 - 16.0) * e2_
        return 2.0 * np.pi * q**2.5 / P, 6.0 * np.pi * q**1.5 / P, -8.0 * q**2 / P
    D, G_D, B_eps, Delta = _even_integrals(np.sqrt(e2_.ravel()), psi)
    radial, excess, coupling = (np.stack([D, G_D, B_eps]) / Delta).reshape(3, *e2_.shape)
    return radial, excess, coupling


def _even_integrals(eps: Floats, psi: float) -> tuple[Floats, Floats, Floats, Floats]:
    """D, (G - D)/eps^2, B/eps and Delta: the even functions of eps that the Cartesian form needs."""
    G, B, D = film_integrals(eps, psi)
    margin = scaled.HAT * scaled.root_of(psi)
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
    # einsum sums each row alike; a product of matrices rounds a row by where it stands among the others
    B_eps = -1.5 * S**4 * np.einsum("ij,j->i", (N / den) ** 2, weights * sine**3)
    G_D = 2.0 * S**5 * np.einsum("ij,j->i", N * (2.0 * N3 - seep) / den**3, weights * sine**4)
    return D, G_D, B_eps, G * D - B * B


def fixed_arc_edges(psi: float) -> tuple[Floats]:
    """Edges of the cells of eps^2, from the centre to eps = 1 + 0.3 k."""
    k = scaled.root_of(psi)
    wall = (1.0 - (1.0 + scaled.BEYOND * k) ** 2) / 2.0
    edges = 1.0 - 2.0 * _gaps(0.5, wall, k, _cells(0.5, wall, k, _WIDTH_FIXED))
    edges[0] = 0.0  # not by a rounding below
    return (edges,)


def _cells(widest: float, thinnest: float, k: float, width: float) -> int:
    """Number of cells between two gaps, none wider than ``width`` in log T.

    Raises
    ------
    RangeError
        For a permeability between zero and `scaled.SMALLEST`: a swept one passes no check of a model.
    """
    if 0.0 < k < scaled.root_of(scaled.SMALLEST):
        raise RangeError(f"psi = {k**3:g} is too small for a table: expected 0 or at least {scaled.SMALLEST:g}")
    start, stop = _ends(widest, thinnest, k)
    return int(np.ceil(np.log(start / stop) / width))


def _gaps(widest: float, thinnest: float, k: float, cells: int) -> Floats:
    """Gaps that are equidistant in log T."""
    return scaled.folded(np.geomspace(*_ends(widest, thinnest, k), 1 + cells), k)


def _ends(widest: float, thinnest: float, k: float) -> tuple[float, float]:
    start, stop = (float(scaled.unfolded(np.asarray(gap), k)) for gap in (widest, thinnest))
    return start, max(stop, _THINNEST)


def positive_arc(psi: float, xi: ArrayLike, z: ArrayLike) -> tuple[Floats, Floats]:
    """Mobilities of the positive-pressure half film, solved: see `whirlmap.films.scaled.positive_arc_solved`."""
    return scaled.positive_arc_solved(1.0 - np.asarray(xi, dtype=float), np.asarray(z, dtype=float), psi)


def positive_arc_samples(psi: float, xi: ArrayLike, z: ArrayLike) -> tuple[Floats, Floats]:
    """Mobilities of the positive-pressure half film, interpolated: see `whirlmap.films.scaled.positive_arc_smooth`."""
    T = scaled.unfolded(1.0 - np.asarray(xi, dtype=float), scaled.root_of(psi))
    F, H = scaled.positive_arc_smooth(psi, T**0.25, z)
    return T**2.5 * F, T**1.5 * H


def positive_arc_panel(psi: float) -> tuple[float, float] | None:
    """Half decade of psi that shares its number of cells, the one that the lower end asks for; None for psi = 0."""
    if psi < scaled.SMALLEST:
        return None
    panel = np.floor(_PANELS * np.log10(psi))
    return float(10.0 ** (panel / _PANELS)), float(10.0 ** ((panel + 1.0) / _PANELS))


def positive_arc_edges(psi: float) -> tuple[Floats, Floats]:
    """Edges of the cells of xi, from the wall behind the load to the one ahead of it, and of z."""
    panel = positive_arc_panel(psi)
    low = scaled.root_of(panel[0] if panel else psi)
    cells = _cells(2.0 + scaled.BEYOND * low, -scaled.BEYOND * low, low, _WIDTH_POSITIVE)
    k = scaled.root_of(psi)
    far = 1.0 + scaled.BEYOND * k
    return 1.0 - _gaps(1.0 + far, 1.0 - far, k, cells), np.linspace(0.0, far / (1.0 + scaled.HAT * k), 1 + _ACROSS)
