"""A bearing of a dimensional rotor as the keyword arguments of ROSS's ``BearingElement``."""

import numpy as np

from whirlmap.analysis.linear.film_coefficients import film_coefficients
from whirlmap.errors import RangeError
from whirlmap.integrate.system import System


def ross_bearing(system: System, film: str = "1") -> dict[str, float]:
    """Keyword arguments of ``ross.BearingElement`` for one bearing of the system: kxx ... cyy, without its node.

    ROSS's x and y are the transverse axes, its shaft turning from x to y, as the pinion does here. A gear turns the other
    way: its coefficients are for these axes all the same, and its shaft has a negative speed in ROSS.

    Parameters
    ----------
    system : System
        With dimensional inputs, such as machines/jeffcott-rig or machines/turbo-gearbox.
    film : str
        Name of the bearing: "1", or "2" for those of the gear.

    Returns
    -------
    dict
        kxx, kxy, kyx, kyy [N/m] and cxx, cxy, cyx, cyy [N*s/m].

    Raises
    ------
    RangeError
        Where there is no such film, no static equilibrium, or a case without dimensions.

    Notes
    -----
    Stiffness and damping are those of `film_coefficients` in SI units: the half film of a short bearing (pi film), linear
    about the static equilibrium. ROSS asks for a table over speed: call this once for each.

    References
    ----------
    [lund1966] definition of the eight coefficients.
    [childs1993] their use in rotor models.
    """
    name = system.case or system.model.name
    if film not in system.model.films:
        known = ", ".join(system.model.films) or "none"
        raise RangeError(f"{name}: found no film {film!r} that carries a load at rest, expected one of: {known}")
    found = film_coefficients(system).get(film)
    if found is None or np.isnan(found.W_c_omega):
        raise RangeError(
            f"{name}: coefficients of film {film} in N/m need a journal that turns and carries a load, and dimensional"
            " inputs, as in machines/jeffcott-rig"
        )
    sets = (("k", found.W_c * found.K), ("c", found.W_c_omega * found.C))
    axes = (("xx", 0, 0), ("xy", 0, 1), ("yx", 1, 0), ("yy", 1, 1))
    return {f"{letter}{axis}": float(A[i, j]) for letter, A in sets for axis, i, j in axes}
