"""Linearisation of a whole system about its static equilibrium: damped eigenvalues with all forcing off."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from sympy import sympify

from whirlmap.analysis.motion.ensembles import first_sizes
from whirlmap.equations.model import Model
from whirlmap.errors import RangeError
from whirlmap.integrate.division import variants
from whirlmap.integrate.equilibrium import start_states
from whirlmap.integrate.evaluation import Evaluator
from whirlmap.integrate.system import System
from whirlmap.results.listing import Listed, Listing, Rows

#: How far to either side of an equilibrium a kink of the rates is sought, over the sizes of the states, and how much shorter
#: the second step is.
STEP, SHORTER = 1e-6, 16
#: Change of the derivatives from one side to the other, over their own size, that is a kink, where the shorter step finds it
#: as well: behind a stiff shaft a film curves by as much over a millionth of the motion, and has a derivative all the same.
KINK = 1e-3
#: Bytes that the Jacobians to all sides of points may take: so many points are linearised together, but one at least.
BYTES = 2**28


class NotLinearError(RangeError):
    """An equilibrium at which the rates have no derivative. It is an answer, no wrong input: there is no linear system."""


@dataclass(frozen=True, repr=False)
class LinearAnalysis(Listed):
    """Linearised system at its static equilibrium.

    Attributes
    ----------
    equilibrium : array, shape (state,)
        In the units of the states.
    jacobian : array, shape (state, state)
        Derivatives of the rates, per radian of the clock.
    eigenvalues : array of complex, shape (state,)
        Per radian of the clock, the least damped first.
    eigenvectors : array of complex, shape (state, eigenvalue)
    """

    equilibrium: NDArray[np.float64]
    jacobian: NDArray[np.float64]
    eigenvalues: NDArray[np.complex128]
    eigenvectors: NDArray[np.complex128]

    @property
    def stable(self) -> bool:
        """Whether every small motion dies out."""
        return bool(self.eigenvalues[0].real < 0)

    def listing(self) -> Listing:
        """Its eigenvalues, of each conjugate pair one, for a terminal and a notebook.

        Returns
        -------
        Listing
            Printed as a table; a notebook shows it as one.
        """
        values = [z for z in self.eigenvalues.tolist() if z.imag >= 0]
        rows = [(f"{z.real:.5g}", f"{z.imag:.5g}", f"{-z.real / abs(z):.4g}" if z else "") for z in values]
        told = "stable" if self.stable else "not stable"
        return Listing(
            f"Linear analysis of {self.equilibrium.size} states: {told}",
            ("per radian of the clock, the least damped first; of a conjugate pair one",),
            (Rows("Eigenvalues", ("real part", "frequency", "damping ratio"), rows),),
        )


def linear_analysis(system: System) -> LinearAnalysis:
    """Linearise a system about its static equilibrium, with all forcing off.

    Parameters
    ----------
    system : System
        Of a model that starts at its static equilibrium.

    Returns
    -------
    LinearAnalysis
        ``equilibrium`` (state), ``jacobian`` (state, state), ``eigenvalues`` and ``eigenvectors`` (state, eigenvalue), the
        least damped first; per radian of the model's clock. ``stable``: whether all real parts are negative.

    Raises
    ------
    NotLinearError
        Where there is a static equilibrium, but no linear system for small motions about it.
    RangeError
        Where the model declares no static equilibrium, or none is found.

    Notes
    -----
    The equilibrium is that of the compiled kernel with all forcing off (`start_states`), the Jacobian is its closed form
    there. At a kink of the rates, where there is no derivative, central differences over both of its sides stand for it;
    the film of a damper that carries nothing at rest has no linear system at all (`NotLinearError`). Eigenvalues are
    LAPACK's, good to rounding relative to the largest. They say nothing of amplitudes, of forced motion, or of what is
    not small.
    """
    x, jacobian, found = linearised(system.plain_model(), system.vector[:, None])
    if not found[0]:
        still = standing(system)
        why = "; a film whose journal does not turn carries nothing at rest, and has no derivative there" if still else ""
        raise RangeError(f"{system.model.name}: no static equilibrium was found at these values{why}")
    eigenvalues, vectors = np.linalg.eig(jacobian[0])
    order = np.argsort(-eigenvalues.real, kind="stable")
    return LinearAnalysis(
        x[:, 0], jacobian[0], eigenvalues[order].astype(complex), vectors[:, order].astype(complex)
    )


def standing(system: System) -> list[str]:
    """Names of the bearings whose journal does not turn."""
    values = {p: float(system.values[p.name]) for p in system.model.parameters}
    return [name for name, journal in system.model.journals.items() if float(sympify(journal.spin).subs(values)) == 0.0]


def linearised(
    model: Model, values: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
    """Equilibria (state, point), Jacobians (point, row, column) of the unforced rates there, and where they were found.

    Jacobians are those of the compiled kernel, in closed form; at a kink of the rates, where there is no derivative, central
    differences over both of its sides. Those of points without an equilibrium are NaN.
    """
    if model.equilibrium or _without_derivative(model):
        raise NotLinearError(
            "no eigenvalues: the film of a damper carries nothing at rest, and its damping of small motions depends on their"
            " direction (the pressure is positive on the side to which the ring moves); no linear system describes that"
        )
    if model.start != "equilibrium":
        raise RangeError(
            f"{model.name} declares no static equilibrium to linearise about (start = {model.start}): use diagnose"
            " for its motion, and bifurcation for the change of its motion along a parameter"
        )
    x, found = start_states(model, values)
    n = x.shape[0]
    jacobian = np.full((values.shape[1], n, n), np.nan)
    for form, members in variants(model, values):
        at = members[found[members]]
        together = max(BYTES // (32 * n**3), 1)  # four Jacobians for each state that is moved
        for part in np.split(at, range(together, at.size, together)) if at.size else ():
            jacobian[part] = _jacobians(form, values[:, part], x[:, part])
    return x, jacobian, found


def _without_derivative(model: Model) -> bool:
    """Whether a film with the arc of positive pressure, which is a table, stands around a ring that never turns."""
    return bool(model.tables) and any(sympify(journal.spin).is_zero for journal in model.journals.values())


def _jacobians(
    model: Model, values: NDArray[np.float64], x: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Jacobians of the unforced rates, shape (point, row, column)."""
    n, points = x.shape
    size = first_sizes(model, values, x)
    # Every (step, side, moved state, point) in one call, the point itself last.
    sides = (np.array([STEP, STEP / SHORTER])[:, None] * np.array([1.0, -1.0])).ravel()
    moved = x[:, None, None, :] + sides[:, None, None] * (np.eye(n)[:, :, None] * size[:, None, :])[:, None]
    many = np.concatenate([moved.reshape(n, -1), x], axis=1)
    evaluate = Evaluator.of(model, values, jacobian=True)
    rates, slopes = evaluate(0.0, many, np.tile(np.arange(points), sides.size * n + 1), forced=False)
    closed = slopes[:, :, -points:]
    of_steps = np.moveaxis(slopes[:, :, :-points].reshape(n, n, 2, 2, n, points), (2, 3), (0, 1))
    whole = (np.abs(closed) * size).sum(axis=1)[:, None, None, :]  # what a row comes to when all states move by their sizes
    far, near = ((np.abs(up - down) * size[:, None, :]).max(axis=1) for up, down in of_steps)  # (row, moved state, point)
    # The slope changes as much over a shorter step at a kink, and less where it only curves.
    kinked = (near > KINK * whole[:, 0]) & (near > far / 2)
    ahead, behind = np.moveaxis(rates[:, :-points].reshape(n, 2, 2, n, points), (1, 2), (0, 1))[1]
    width = np.where(size > 0, 2 * STEP / SHORTER * size, 1.0)  # a state of no size was not moved, and shows no kink
    return np.where(kinked, (ahead - behind) / width, closed).transpose(2, 0, 1)
