"""A bearing of a dimensional rotor as the keyword arguments of ROSS's ``BearingElement``."""

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.linear import linear_analysis
from whirlmap.errors import RangeError
from whirlmap.films.linear import linear_film
from whirlmap.integrate.system import System

Matrix = NDArray[np.float64]


def has_si_film(system: System) -> bool:
    """Whether the system is a Jeffcott rotor on journal bearings with dimensional inputs."""
    rotor = system.model.name == "jeffcott" and system.model.switches["bearing"] == "journal"
    return rotor and {"M", "g", "c"} <= set(getattr(system.details, "inputs", {}))


def load_scale(system: System) -> tuple[float, float]:
    """W/c [N/m] and W/(c omega) [N*s/m] of one bearing of such a rotor."""
    M, g, c = (float(system.details.inputs[name].value) for name in ("M", "g", "c"))
    omega = float(system.values["s"]) * np.sqrt(g / c)
    return M * g / 2 / c, M * g / 2 / (c * omega)


def film_coefficients(system: System) -> tuple[Matrix, Matrix]:
    """Stiffness [N/m] and damping [N*s/m] of one film of a dimensional Jeffcott rotor at its static equilibrium.

    Axes are the model's: x horizontal, y up, the journal turning from x to y; the force on the journal is -K u - C u'.

    Raises
    ------
    RangeError
        Where the system is not a Jeffcott rotor on journal bearings with dimensional inputs, or has no equilibrium.
    """
    if not has_si_film(system):
        raise RangeError(
            f"{system.case or system.model.name}: coefficients in N/m need a dimensional Jeffcott rotor on journal bearings,"
            " such as machines/jeffcott-rig"
        )
    ux, uy = linear_analysis(system).equilibrium[:2]
    film = linear_film(np.hypot(ux, uy), 0.0)
    load = np.arctan2(uy, ux) - film.attitude  # direction of the load, from which the film counts the line of centres
    turn = np.array([[np.cos(load), -np.sin(load)], [np.sin(load), np.cos(load)]])
    stiffness, damping = load_scale(system)
    return stiffness * turn @ film.K @ turn.T, damping * turn @ film.C @ turn.T


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
