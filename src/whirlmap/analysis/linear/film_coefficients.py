"""Stiffness and damping of each film of a system about its static equilibrium."""

from dataclasses import dataclass
from math import isfinite

import numpy as np
from numpy.typing import NDArray
from sympy import sympify

from whirlmap.analysis.linear.linearisation import linear_analysis
from whirlmap.films.linear import linear_film
from whirlmap.integrate.dimensions import Dimensions
from whirlmap.integrate.system import System
from whirlmap.results.listing import Listed, Listing, Rows

Matrix = NDArray[np.float64]


@dataclass(frozen=True, repr=False)
class FilmCoefficients(Listed):
    """The film of one bearing about its journal's rest: the force on the journal changes by -K u - C u'.

    Axes are the model's, x horizontal and y up.

    Attributes
    ----------
    eccentricity : float
    load : float
        Force W that the film carries, in the model's unit of force.
    K, C : array, shape (2, 2)
        Stiffness [W/c] and damping [W/(c omega)], c the bearing's clearance and omega the journal's speed of rotation.
    W_c, W_c_omega : float
        W/c [N/m] and W/(c omega) [N*s/m]; NaN where the case has no dimensions.
    """

    eccentricity: float
    load: float
    K: Matrix
    C: Matrix
    W_c: float
    W_c_omega: float

    def listing(self) -> Listing:
        """The eight coefficients, for a terminal and a notebook.

        Returns
        -------
        Listing
            Printed as a table; a notebook shows it as one.
        """
        units = "the case has no dimensions"
        if isfinite(self.W_c):
            units = f"W/c = {self.W_c:.5g} N/m, W/(c omega) = {self.W_c_omega:.5g} N*s/m"
        rows = [
            (f"{letter}{one}{other}", f"{matrix[i, j]:.6g}", unit)
            for letter, matrix, unit in (("K", self.K, "W/c"), ("C", self.C, "W/(c omega)"))
            for i, one in enumerate("xy") for j, other in enumerate("xy")
        ]  # fmt: skip
        title = f"Film coefficients at the eccentricity {self.eccentricity:.5g}, load {self.load:.5g}"
        return Listing(title, (units,), (Rows("Coefficients", ("name", "value", "unit"), rows),))


def film_coefficients(system: System) -> dict[str, FilmCoefficients]:
    """Linear coefficients of every film that carries a load at rest, by the name of its bearing.

    Both arcs have the same: see `whirlmap.films.linear`. Films of the printed law and of dampers that do not turn are not
    among them, nor is one whose journal carries nothing: W/c is no unit for it.

    Parameters
    ----------
    system : System
        Of a model that starts at its static equilibrium.

    Returns
    -------
    dict of str to FilmCoefficients
        By the name of the bearing: ``K`` [W/c] and ``C`` [W/(c omega)], shape (2, 2), rows the force along x and y,
        columns the motion along x and y; ``eccentricity`` [c], ``load`` [the model's force], and ``W_c`` [N/m],
        ``W_c_omega`` [N*s/m], which are NaN where the case has no dimensions.

    Raises
    ------
    RangeError
        Where the model has no static equilibrium, or none is found.

    Notes
    -----
    Derivatives of the short bearing's film force at the equilibrium of `linear_analysis`: exact, as integrals over the
    half film (Gauss-Legendre) of the differentiated integrand, for plain and porous bearings alike (`films.linear`).
    Inertia of the oil, its heat and the flow through the ends are left out.

    References
    ----------
    [lund1966] the eight coefficients and their convention of signs.
    [dubois1953] the short bearing.
    """
    values = {p: float(system.values[p.name]) for p in system.model.parameters}
    rest = dict(zip(system.states, linear_analysis(system).equilibrium, strict=True))
    force, length, speed = map(Dimensions(system).worth, ("force", "length", "speed"))
    found = {}
    for name, film in system.model.films.items():
        numbers = (film.psi, film.spin, film.strength, film.clearance)
        psi, spin, strength, clearance = (float(sympify(e).subs(values)) for e in numbers)
        ux, uy = (rest[q.name] / clearance for q in film.u)
        eccentricity = float(np.hypot(ux, uy))
        if spin == 0.0 or eccentricity == 0.0:
            continue
        one, sense = linear_film(eccentricity, psi), np.sign(spin)
        # The film counts the line of centres from the load in the sense of rotation; its second axis is ahead of the load.
        along = np.arctan2(uy, ux) - sense * one.attitude
        turn = np.array([[np.cos(along), -sense * np.sin(along)], [np.sin(along), sense * np.cos(along)]])
        load = float(one.load) * strength * abs(spin)
        W_c = load * force / (length * clearance)
        found[name] = FilmCoefficients(
            eccentricity, load, turn @ one.K @ turn.T, turn @ one.C @ turn.T, W_c, W_c / (abs(spin) * speed)
        )
    return found
