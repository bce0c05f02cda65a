"""Small motions about the static equilibrium of a whole system: damped eigenvalues with all forcing off."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from whirlmap.equations.model import Model
from whirlmap.errors import RangeError
from whirlmap.integrate.equilibrium import start_states
from whirlmap.integrate.system import System
from whirlmap.kernels.reference import reference_rates

#: Half-width of the central differences; extrapolated once, so that their error is of order STEP^4.
STEP = 1e-4


@dataclass(frozen=True)
class LinearAnalysis:
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


def linear_analysis(system: System) -> LinearAnalysis:
    """Linearise a system about its static equilibrium, with all forcing off.

    Parameters
    ----------
    system : System
        Of a model that starts at its static equilibrium.

    Returns
    -------
    LinearAnalysis

    Raises
    ------
    RangeError
        Where the model declares no static equilibrium, or none is found.
    """
    x, jacobian, found = linearised(system.plain_model(), system.vector[:, None])
    if not found[0]:
        raise RangeError(f"{system.model.name}: no static equilibrium was found at these values")
    eigenvalues, vectors = np.linalg.eig(jacobian[0])
    order = np.argsort(-eigenvalues.real, kind="stable")
    return LinearAnalysis(
        x[:, 0], jacobian[0], eigenvalues[order].astype(complex), vectors[:, order].astype(complex)
    )


def linearised(
    model: Model, values: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
    """Equilibria (state, point), Jacobians (point, row, column) of the unforced rates there, and where they were found.

    Jacobians are central differences of the reference kernel with one step of Richardson's extrapolation; those of
    points without an equilibrium are NaN.
    """
    if model.start != "equilibrium":
        raise RangeError(f"{model.name} declares no static equilibrium (start = {model.start}) to linearise about")
    x, found = start_states(model, values)
    n, at = x.shape[0], np.flatnonzero(found)
    jacobian = np.full((values.shape[1], n, n), np.nan)
    if at.size:
        # every (width, moved state, point) in one call; the smooth functions, so that differences see no table's knots
        widths = STEP * np.array([1.0, -1.0, 2.0, -2.0])
        moved = x[:, None, None, at] + widths[:, None, None] * np.eye(n)[:, None, :, None]
        tables = "samples" if model.tables else "read"
        rates = reference_rates(model, forced=False, tables=tables)
        many = rates(0.0, moved.reshape(n, -1), np.tile(values[:, at], 4 * n)).reshape(moved.shape)
        near, far = (many[:, 0] - many[:, 1]) / (2 * STEP), (many[:, 2] - many[:, 3]) / (4 * STEP)
        jacobian[at] = ((4 * near - far) / 3).transpose(2, 0, 1)
    return x, jacobian, found
