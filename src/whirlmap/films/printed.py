"""The film as printed: gap cubed left out of the pressure law, so that the film is a linear damper.

Without h^3 the film integrals are B = 0 and G = D = pi/(2 psi), whatever the eccentricity and the half circle
[audit sec. 0.1]. Nothing keeps the journal inside its clearance. Scaling as in `whirlmap.films.porous_short`.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from whirlmap.errors import RangeError

Floats = NDArray[np.float64]


def velocity(qx: ArrayLike, qy: ArrayLike, psi: ArrayLike) -> tuple[Floats, Floats]:
    """Velocity w = (2 psi/pi) q that the load q causes, so u' = (j/2) J u + (psi/(pi Gamma)) kappa d.

    Parameters
    ----------
    qx, qy : array_like
        Half the load on the journal, q = kappa d / (2 Gamma) [A omega_c].
    psi : array_like
        Permeability parameter [1], >= 0; 0 is the limit in which the journal circles at half its speed, w =
        0.

    Returns
    -------
    wx, wy : array [c omega_c]
    """
    mobility = 2.0 / np.pi * _checked(psi)
    return mobility * np.asarray(qx, dtype=float), mobility * np.asarray(qy, dtype=float)


def force(wx: ArrayLike, wy: ArrayLike, psi: ArrayLike) -> tuple[Floats, Floats]:
    """Film force on the journal divided by A omega_c, F = -2 M w = -(pi/psi) w.

    Raises
    ------
    RangeError
        psi is 0 somewhere: the printed film is then rigid, and its force is set by the load alone.
    """
    psi_ = _checked(psi)
    if (psi_ == 0.0).any():
        raise RangeError("the printed film has no finite force at psi = 0; expected psi > 0")
    return -np.pi / psi_ * np.asarray(wx, dtype=float), -np.pi / psi_ * np.asarray(wy, dtype=float)


def _checked(psi: ArrayLike) -> Floats:
    psi_ = np.asarray(psi, dtype=float)
    bad = ~((psi_ >= 0.0) & np.isfinite(psi_))
    if bad.any():
        raise RangeError(f"psi = {psi_[bad].ravel()[0]!r} is not a permeability; expected a finite psi >= 0")
    return psi_
