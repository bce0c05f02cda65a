"""A bearing of a dimensional rotor as the keyword arguments of ROSS's ``BearingElement``."""

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.linear import linear_analysis
from whirlmap.errors import RangeError
from whirlmap.films.linear import linear_film
from whirlmap.integrate.system import System

Matrix = NDArray[np.float64]


def film_coefficients(system: System) -> tuple[Matrix, Matrix]:
    """Stiffness [N/m] and damping [N*s/m] of one film of a dimensional Jeffcott rotor at its static equilibrium.

    Axes are the model's: x horizontal, y up, the journal turning from x to y; the force on the journal is -K u - C u'.

    Raises
    ------
    RangeError
        Where the system is not a Jeffcott rotor on journal bearings with dimensional inputs, or has no equilibrium.
    """
    given = getattr(system.details, "inputs", {})
    if system.model.name != "jeffcott" or system.model.switches["bearing"] != "journal" or not {"M", "g", "c"} <= set(given):
        raise RangeError(
            f"{system.case or system.model.name}: coefficients in N/m need a dimensional Jeffcott rotor on journal bearings,"
            " such as machines/jeffcott-rig"
        )
    M, g, c = (float(given[name].value) for name in ("M", "g", "c"))
    ux, uy = linear_analysis(system).equilibrium[:2]
    film = linear_film(np.hypot(ux, uy), 0.0)
    load = np.arctan2(uy, ux) - film.attitude  # direction of the load, from which the film counts the line of centres
    turn = np.array([[np.cos(load), -np.sin(load)], [np.sin(load), np.cos(load)]])
    W, omega = M * g / 2, float(system.values["s"]) * np.sqrt(g / c)
    return W / c * turn @ film.K @ turn.T, W / (c * omega) * turn @ film.C @ turn.T


def ross_bearing(system: System) -> dict[str, float]:
    """Keyword arguments of ``ross.BearingElement`` for one bearing of the rotor: kxx ... cyy, without its node.

    ROSS's x and y are the transverse axes, its shaft turning from x to y, as here.

    Returns
    -------
    dict
        kxx, kxy, kyx, kyy [N/m] and cxx, cxy, cyx, cyy [N*s/m].

    Raises
    ------
    RangeError
        See `film_coefficients`.
    """
    K, C = film_coefficients(system)
    axes = (("xx", 0, 0), ("xy", 0, 1), ("yx", 1, 0), ("yy", 1, 1))
    return {f"{letter}{name}": float(A[i, j]) for letter, A in (("k", K), ("c", C)) for name, i, j in axes}
