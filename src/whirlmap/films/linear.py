"""Small motions about the static equilibrium: stiffness, damping and the oil-whip threshold of a rigid rotor.

The journal turns at omega > 0 from x to y and carries the load W along x. In the steady state w = -(1/2) J u,
the film is theta in [0, pi] for both arcs, and the two films have the *same* first derivatives: the pressure
vanishes at both ends of the arc, where the films differ. Derivatives are exact (integrals of the
differentiated integrand).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from whirlmap.errors import RangeError
from whirlmap.films.porous_short import film_integrals

Floats = NDArray[np.float64]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(96)  # h^2/(h^3 + psi)^2 is sharper than 1/(h^3 + psi)


@dataclass(frozen=True)
class LinearFilm:
    """Static equilibrium of one journal and the film's derivatives there.

    Attributes
    ----------
    load : array
        Static load W over A omega [1].
    attitude : array
        Angle from the load to the line of centres, in the sense of rotation [rad].
    K, C : array, shape (..., 2, 2)
        Stiffness [W/c] and damping [W/(c omega)]: force on the journal = -K u - C u'; axes x (load) and y.
    """

    load: Floats
    attitude: Floats
    K: Floats
    C: Floats


def linear_film(eps: ArrayLike, psi: ArrayLike) -> LinearFilm:
    """Linear film about the static equilibrium at the eccentricity ``eps``.

    Parameters
    ----------
    eps : array_like
        Static eccentricity [1], 0 < eps < 1.
    psi : array_like
        Permeability parameter [1].

    Returns
    -------
    LinearFilm

    Notes ----- With n the direction from the centre to the film, F = -2 int n (n.w) W dgamma, W = 1/(h^3 +
    psi), h = 1 - n.u. Hence C = 2 M and K = 6 int n n^T (n.w) h^2 W^2 dgamma - M J, where n.w = (eps/2) sin
    theta.
    """
    eps_, psi_ = np.broadcast_arrays(np.asarray(eps, dtype=float), np.asarray(psi, dtype=float))
    if not ((eps_ > 0.0) & (eps_ < 1.0)).all():
        raise RangeError("the static eccentricity must lie between 0 and 1, both excluded")
    G, B, D = film_integrals(eps_, psi_)
    rrs, rts, tts = _gradient_integrals(eps_, psi_)
    load = eps_ * np.hypot(B, D)
    K = _matrix(3.0 * eps_ * rrs - B, 3.0 * eps_ * rts + G, 3.0 * eps_ * rts - D, 3.0 * eps_ * tts + B)
    attitude = np.arctan2(D, -B)
    cos, sin = np.cos(attitude), np.sin(attitude)
    turn = _matrix(cos, -sin, sin, cos)
    back = np.swapaxes(turn, -1, -2)
    over_load = 1.0 / load[..., None, None]
    C = 2.0 * over_load * (turn @ _matrix(G, B, B, D) @ back)
    return LinearFilm(load, attitude, over_load * (turn @ K @ back), C)


def _gradient_integrals(eps: Floats, psi: Floats) -> tuple[Floats, Floats, Floats]:
    """Integrals of (cos^2 sin, cos sin^2, sin^3) h^2/(h^3 + psi)^2 over [0, pi], as in `film_integrals`."""
    eps, margin = eps[..., None], 0.75 * np.cbrt(psi[..., None])
    wall = 1.0 + margin
    eh, one_minus = eps / wall, (1.0 - eps + margin) / wall
    x = 0.25 * np.pi * (_NODES + 1.0)  # chi/2
    sin2, sine = np.sin(x) ** 2, np.sin(2.0 * x)
    difference, q = one_minus - 2.0 * sin2, one_minus + 2.0 * eh * sin2
    N = ((1.0 - eps) * (1.0 + eps) + margin) / wall + margin * eh * (1.0 - 2.0 * sin2)
    S = np.sqrt(one_minus * (1.0 + eh))
    weight = 0.5 * np.pi * _WEIGHTS * sine * (S * N / (N**3 + psi[..., None] * q**3)) ** 2
    rrs, rts, tts = (
        (weight * factor).sum(axis=-1) for factor in (difference**2, S * difference * sine, (S * sine) ** 2)
    )
    return rrs, rts, tts


def _matrix(a: Floats, b: Floats, c: Floats, d: Floats) -> Floats:
    return np.stack([np.stack([a, b], axis=-1), np.stack([c, d], axis=-1)], axis=-2)


def whirl_ratio_squared(film: LinearFilm) -> Floats:
    """Return (whirl frequency at the threshold / omega)^2, negative where no whirl can be sustained."""
    K, C, kappa = film.K, film.C, _whirl_stiffness(film)
    det_C = C[..., 0, 0] * C[..., 1, 1] - C[..., 0, 1] * C[..., 1, 0]
    return ((K[..., 0, 0] - kappa) * (K[..., 1, 1] - kappa) - K[..., 0, 1] * K[..., 1, 0]) / det_C


def whip_threshold(eps: ArrayLike, psi: ArrayLike) -> Floats:
    """Oil-whip threshold p_s = omega_s sqrt(c/g) of a rigid rotor that weighs W = M g per bearing.

    Parameters
    ----------
    eps, psi : array_like
        As in `linear_film`.

    Returns
    -------
    p_s : array
        inf where the rotor is stable at every speed.

    Notes ----- Routh-Hurwitz on p^2 u'' + C u' + K u = 0: at the threshold u = exp(i nu tau) with nu^2 =
    `whirl_ratio_squared` and p^2 nu^2 = kappa (Lund 1966). The static eccentricity is held, so the load
    number is the independent variable, as in published stability charts.
    """
    film = linear_film(eps, psi)
    nu2, kappa = whirl_ratio_squared(film), _whirl_stiffness(film)
    unstable = nu2 > 0.0
    return np.sqrt(np.divide(kappa, nu2, out=np.full_like(nu2, np.inf), where=unstable))


def _whirl_stiffness(film: LinearFilm) -> Floats:
    """Stiffness kappa that balances the inertia of a whirl of constant amplitude [W/c]."""
    K, C = film.K, film.C
    mixed = K[..., 0, 0] * C[..., 1, 1] + K[..., 1, 1] * C[..., 0, 0]
    mixed = mixed - K[..., 0, 1] * C[..., 1, 0] - K[..., 1, 0] * C[..., 0, 1]
    return mixed / (C[..., 0, 0] + C[..., 1, 1])
