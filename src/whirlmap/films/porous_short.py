"""Short journal bearing with a porous ring and a half film, gap cubed kept: the reference film.

Pressure law of the short bearing with seepage through a ring that is sealed at its back [audit sec. 2.B, 4],
``d/dz[(h^3 + 12 Phi H) dp/dz] = 6 mu U h_x + 12 mu h_t``. Everything here is dimensionless: lengths over the
clearance c, time over 1/omega_c, force over A omega_c with A = mu R L^3 / (2 c^2), psi = 12 Phi H / c^3.

u = eps (cos phi, sin phi) is the journal centre in its housing, w = u' - (j/2) J u the journal velocity seen
from the frame that turns at half the journal speed j, J(x, y) = (-y, x). The film answers with F = -2 M w,
where M = [[G, B], [B, D]] in (e_r, e_t) is an integral over a half circle of theta (0 at the thickest film):

- ``fixed``: theta in [0, pi] for a positive spin, [pi, 2 pi] for a negative one, as in the paper;
- ``positive``: the half circle on which the pressure of this w is positive, theta1 = atan2(w_r, -w_t).

The lane kernels read `whirlmap.films.tables`, which is computed with this file.
"""

from collections.abc import Iterator
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from whirlmap.errors import IntegrationError, RangeError

Arc = Literal["fixed", "positive"]
Floats = NDArray[np.float64]

N_NODES = 64  # 48 give 1e-14 on 0..pi, 56 give 3e-14 on any half circle [audit sec. 4.3]; the rest is margin
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(N_NODES)
_BLOCK = 1024  # points per block: block x nodes stays in the second-level cache
_MAX_NEWTON = 80


def film_integrals(eps: ArrayLike, psi: ArrayLike, theta1: ArrayLike = 0.0) -> tuple[Floats, Floats, Floats]:
    """Film integrals of the half circle [theta1, theta1 + pi].

    ``G, B, D = int (cos^2, sin cos, sin^2) / ((1 + eps cos theta)^3 + psi) dtheta``.

    Parameters
    ----------
    eps : array_like
        Eccentricity [1]: below 1 for psi = 0, below 1 + 3/4 psi^(1/3) otherwise.
    psi : array_like
        Permeability parameter 12 Phi H / c^3 [1], >= 0.
    theta1 : array_like
        Start of the arc [rad]; 0 for the fixed film.

    Returns
    -------
    G, B, D : array, shape of the broadcast arguments

    Raises
    ------
    RangeError
        ``eps`` or ``psi`` lies outside the range above, or is not finite.

    Notes ----- Gauss-Legendre rule in a generalised Sommerfeld angle chi [audit sec. 4.3]: with eh = eps/(1 +
    3/4 psi^(1/3)), cos theta = (cos chi - eh)/(1 - eh cos chi). The powers of 1 - eh cos chi cancel, so that
    each node costs one division; at psi = 0 the denominator is constant and the integrand a trigonometric
    polynomial. The differences cos chi - eh and 1 - eh cos chi are formed from sin^2(chi/2), which keeps
    their digits on arcs that leave out the thin film. Error against quadrature with 30 digits:
    tests/films/test_porous_short.py.
    """
    eps_, psi_, theta1_ = np.broadcast_arrays(*(np.asarray(a, dtype=float) for a in (eps, psi, theta1)))
    check_range(eps_, psi_)
    flat = [a.ravel() for a in (eps_, 1.0 - eps_, psi_, theta1_)]
    out = np.empty((3, eps_.size))
    for block in _blocks(eps_.size):
        out[:, block] = _integrals(*(a[block] for a in flat))
    G, B, D = out.reshape(3, *eps_.shape)
    return G, B, D


def _blocks(size: int) -> Iterator[slice]:
    return (slice(i, i + _BLOCK) for i in range(0, size, _BLOCK))


def check_range(eps: Floats, psi: Floats) -> None:
    """Raise a `RangeError` where no film is."""
    bad = ~((psi >= 0.0) & (eps >= 0.0) & (eps < 1.0 + 0.75 * np.cbrt(psi)) & np.isfinite(psi))
    if bad.any():
        at = np.flatnonzero(bad)[0]
        raise RangeError(
            f"the film is undefined at {bad.sum()} of {bad.size} points, first at index {at}: "
            f"eps = {eps.ravel()[at]!r}, psi = {psi.ravel()[at]!r}; expected psi >= 0 and "
            "0 <= eps < 1 + 0.75 psi^(1/3) (eps < 1 for psi = 0)"
        )


def _integrals(eps: Floats, gap: Floats, psi: Floats, theta1: Floats) -> Floats:
    """G, B, D of flat arrays, shape (3, point); the gap 1 - eps is passed for its digits near the wall."""
    margin = 0.75 * np.cbrt(psi)
    wall = 1.0 + margin
    eh = eps / wall
    one_minus, one_plus = (gap + margin) / wall, 1.0 + eh
    a, b = np.sqrt(one_minus), np.sqrt(one_plus)
    # tan(theta/2) = sqrt((1+eh)/(1-eh)) tan(chi/2), and both halves stay on one branch of atan2 below
    half = 0.5 * np.remainder(theta1 + np.pi, 2.0 * np.pi) - 0.5 * np.pi
    start = np.arctan2(a * np.sin(half), b * np.cos(half))
    stop = np.arctan2(a * np.cos(half), -b * np.sin(half))  # theta1 + pi: sin -> cos, cos -> -sin
    span = 0.5 * (stop - start)
    x = (0.5 * (stop + start))[:, None] + span[:, None] * _NODES  # x = chi/2
    sin_x, cos_x = np.sin(x), np.cos(x)
    sin2 = sin_x * sin_x
    difference = one_minus[:, None] - 2.0 * sin2  # cos chi - eh
    sine = 2.0 * sin_x * cos_x
    q = one_minus[:, None] + 2.0 * eh[:, None] * sin2  # 1 - eh cos chi
    # N = q + eps (cos chi - eh) = h q, written so that nothing cancels where the film is thin
    N = ((gap * (1.0 + eps) + margin) / wall)[:, None] + (margin * eh)[:, None] * (1.0 - 2.0 * sin2)
    weight = (2.0 * span)[:, None] * _WEIGHTS / (N * N * N + psi[:, None] * (q * q * q))
    S = a * b
    weighted = weight * difference
    G = S * np.einsum("ij,ij->i", weighted, difference)
    B = S**2 * np.einsum("ij,ij->i", weighted, sine)
    D = S**3 * np.einsum("ij,ij->i", weight * sine, sine)
    return np.stack([G, B, D])


def film_force(
    ux: ArrayLike,
    uy: ArrayLike,
    wx: ArrayLike,
    wy: ArrayLike,
    psi: ArrayLike,
    *,
    arc: Arc,
    sigma: ArrayLike = 1.0,
) -> tuple[Floats, Floats]:
    """Film force on the journal divided by A omega_c, F = -2 M w.

    Parameters
    ----------
    ux, uy : array_like
        Journal centre in its housing [c].
    wx, wy : array_like
        Velocity seen from the half-speed frame, u' - (j/2) J u [c omega_c].
    psi : array_like
        Permeability parameter [1].
    arc : {"fixed", "positive"}
        Half circle that carries pressure, see the module.
    sigma : array_like
        Sign of the journal's spin; it multiplies B on the fixed arc, and does nothing on the positive one.

    Returns
    -------
    Fx, Fy : array
        Both are 0 where w = 0. At u = 0 the film is isotropic and the line of centres is taken along x.
    """
    ux, uy, wx, wy, psi, sigma = _floats(ux, uy, wx, wy, psi, sigma)
    eps, cos_phi, sin_phi = _polar(ux, uy)
    w_r, w_t = wx * cos_phi + wy * sin_phi, wy * cos_phi - wx * sin_phi
    if arc == "fixed":
        G, B, D = film_integrals(eps, psi)
        B = sigma * B
    elif arc == "positive":
        G, B, D = film_integrals(eps, psi, np.arctan2(w_r, -w_t))
    else:
        raise RangeError(f"the arc must be 'fixed' or 'positive' (got {arc!r})")
    F_r, F_t = -2.0 * (G * w_r + B * w_t), -2.0 * (B * w_r + D * w_t)
    return F_r * cos_phi - F_t * sin_phi, F_r * sin_phi + F_t * cos_phi


def fixed_arc_velocity(
    ux: ArrayLike, uy: ArrayLike, qx: ArrayLike, qy: ArrayLike, psi: ArrayLike, sigma: ArrayLike = 1.0
) -> tuple[Floats, Floats]:
    """Velocity w that the load q causes in the fixed half film: M w = q [audit sec. 3.2].

    Parameters
    ----------
    ux, uy, psi, sigma : array_like
        As in `film_force`.
    qx, qy : array_like
        Half the load on the journal, q = kappa d / (2 Gamma) [A omega_c].

    Returns
    -------
    wx, wy : array [c omega_c]

    Notes
    -----
    Cartesian form of the inverse, with Delta = G D - B^2:

    ``w = G/Delta q + (D-G)/(Delta eps^2) (q.u) u - sigma B/(Delta eps) [(q.Ju) u + (q.u) Ju]/eps``.

    The last term is O(eps) but depends on the direction of u: w is Lipschitz at u = 0, not differentiable.
    """
    ux, uy, qx, qy, psi, sigma = _floats(ux, uy, qx, qy, psi, sigma)
    eps, cos_phi, sin_phi = _polar(ux, uy)
    G, B, D = film_integrals(eps, psi)
    q_r, q_t = qx * cos_phi + qy * sin_phi, qy * cos_phi - qx * sin_phi
    Delta = G * D - B * B
    radial = ((D - G) * q_r - sigma * B * q_t) / Delta
    tangential = -sigma * B * q_r / Delta
    wx = G / Delta * qx + radial * cos_phi - tangential * sin_phi
    return wx, G / Delta * qy + radial * sin_phi + tangential * cos_phi


def positive_arc_velocity(
    ux: ArrayLike, uy: ArrayLike, qx: ArrayLike, qy: ArrayLike, psi: ArrayLike
) -> tuple[Floats, Floats]:
    """Velocity w that the load q causes in the positive-pressure half film: M(w) w = q [audit sec. 4.4].

    Parameters
    ----------
    ux, uy, qx, qy, psi : array_like
        As in `fixed_arc_velocity`. w does not depend on the spin.

    Returns
    -------
    wx, wy : array [c omega_c]
        0 where q = 0. w is homogeneous of degree one in q.

    Raises
    ------
    IntegrationError
        Some point did not converge; the message names it.

    Notes
    -----
    M depends only on the direction e of w, so that one angle is unknown. M e x q changes sign once in the
    half circle about q (the dissipation is convex in w), which brackets it.

    1. Refresh the half film with the last direction and solve M w = q: this is Newton's step, for the ends
       of the arc carry no pressure and add nothing to the derivative of M e.
    2. The sign of e x w says on which side of e the solution lies: shrink the bracket.
    3. Take the direction of w if it lies inside the bracket and the step is shorter than the one before, else the
       middle of the bracket: next to the wall two directions can lead to each other.
    """
    ux, uy, qx, qy, psi = _floats(ux, uy, qx, qy, psi)
    shape = ux.shape
    flat_psi, load = psi.ravel(), np.hypot(qx, qy).ravel()
    eps, cos_phi, sin_phi = (a.ravel() for a in _polar(ux, uy))
    qx_, qy_ = (np.divide(q.ravel(), load, out=np.zeros_like(load), where=load > 0.0) for q in (qx, qy))
    q_r, q_t = qx_ * cos_phi + qy_ * sin_phi, qy_ * cos_phi - qx_ * sin_phi
    w_r, w_t = np.zeros_like(load), np.zeros_like(load)
    check_range(eps, flat_psi)
    for block in _blocks(load.size):
        at = np.flatnonzero(load[block] > 0.0) + block.start
        w_r[at], w_t[at] = unit_load_velocity(eps[at], 1.0 - eps[at], flat_psi[at], q_r[at], q_t[at])
    wx, wy = load * (w_r * cos_phi - w_t * sin_phi), load * (w_r * sin_phi + w_t * cos_phi)
    return wx.reshape(shape), wy.reshape(shape)


def unit_load_velocity(
    eps: Floats, gap: Floats, psi: Floats, q_r: Floats, q_t: Floats
) -> tuple[Floats, Floats]:
    """Velocity of the positive-pressure film under unit loads, in polar components.

    Parameters
    ----------
    eps, psi : array, shape (point,)
        As in `film_integrals`, and not checked here.
    gap : array, shape (point,)
        1 - eps, which the caller may know to more digits than eps gives near the wall.
    q_r, q_t : array, shape (point,)
        Components of the load, q_r^2 + q_t^2 = 1.

    Returns w_r, w_t; algorithm and errors as in `positive_arc_velocity`.
    """
    size = eps.size
    w_r, w_t = np.full(size, np.nan), np.full(size, np.nan)
    beta = np.arctan2(q_t, q_r)
    low, high = beta - 0.5 * np.pi, beta + 0.5 * np.pi
    # Booker's curve fit for psi = 0; its component along the load is positive, so it lies in the bracket
    xi, eta = eps * q_r, -eps * q_t
    beta = beta - np.arctan2(4.0 * eta, np.pi * np.maximum(1.0 - xi, 1e-9))
    # the step after one of 1e-12 is below rounding, and rounding turns w by about 1e-16 / sqrt(thinnest film)
    tolerance = 1e-12 + 1e-15 / np.sqrt(gap + 0.75 * np.cbrt(psi))
    todo, before = np.arange(size), np.full(size, np.inf)
    for _ in range(_MAX_NEWTON):
        e_r, e_t = np.cos(beta), np.sin(beta)
        G, B, D = _integrals(eps[todo], gap[todo], psi[todo], np.arctan2(e_r, -e_t))
        Delta = G * D - B * B
        new_r = (D * q_r[todo] - B * q_t[todo]) / Delta
        new_t = (G * q_t[todo] - B * q_r[todo]) / Delta
        turn = np.arctan2(e_r * new_t - e_t * new_r, e_r * new_r + e_t * new_t)
        low, high = np.where(turn > 0.0, beta, low), np.where(turn < 0.0, beta, high)
        candidate = beta + turn
        inside = (candidate > low) & (candidate < high) & (np.abs(turn) < 0.75 * before)
        w_r[todo], w_t[todo] = new_r, new_t
        going = ~(np.abs(turn) <= tolerance[todo])  # keeps NaN going, so that it is reported
        beta = np.where(inside, candidate, 0.5 * (low + high))[going]
        low, high, todo, before = low[going], high[going], todo[going], np.abs(turn)[going]
        if todo.size == 0:
            return w_r, w_t
    at = todo[0]
    raise IntegrationError(
        f"the positive-arc film did not converge in {_MAX_NEWTON} steps at {todo.size} of {size} points, "
        f"first at eps = {eps[at]!r}, psi = {psi[at]!r}, unit load in (e_r, e_t) = ({q_r[at]!r}, {q_t[at]!r})"
    )


def _floats(*args: ArrayLike) -> tuple[Floats, ...]:
    return np.broadcast_arrays(*(np.asarray(a, dtype=float) for a in args))


def _polar(ux: Floats, uy: Floats) -> tuple[Floats, Floats, Floats]:
    """Eccentricity and direction of u; the direction is (1, 0) at the centre, where the film is isotropic."""
    eps = np.hypot(ux, uy)
    centred = eps < 1e-150  # a denormal eps has too few digits to divide by
    safe = np.where(centred, 1.0, eps)
    return eps, np.where(centred, 1.0, ux / safe), np.where(centred, 0.0, uy / safe)
