"""Reduction of a free shaft: its lowest modes, and the residual flexibility of all others where stiff parts act.

The shaft is free in space. With modes Phi (rigid and the lowest elastic ones) and forces f at stations its displacement is

    u = Phi q + G_r f,     Phi^T M Phi q'' + Phi^T K Phi q = Phi^T f,

where G_r is the static flexibility of the omitted modes: that of the free shaft under forces balanced by its own inertia
(inertia relief) less that of the kept modes. Massless degrees of freedom are condensed statically first. Where a mesh or
an unbalance acts, the residual response to its force is taken into the modes (an attachment mode), so that nothing is
omitted there, meshes of one shaft do not couple algebraically, and forces on journals are forms of states alone. Sources:
MacNeal 1971 [macneal1971], Rubin 1975 [rubin1975].
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from whirlmap.errors import CaseError

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]

#: Masses and stiffnesses below this part of the largest are none: rounding of a matrix.
NONE = 1e-11
#: Static answers below this part of the whole shaft's are none, and so are those that others make up to this part: where
#: nearly all modes are kept, nothing but rounding is left for attachment modes, and it would be one of any frequency.
LITTLE = 1e-8
#: Frequencies below this part of the largest are those of rigid motion. Beams have a range of up to 1e6 between modes.
RIGID = 1e-7


@dataclass(frozen=True)
class Modes:
    """Modes of a free shaft in one plane.

    Attributes
    ----------
    shapes : array, shape (freedom, mode)
        Largest displacement 1, rigid modes first.
    mass : array, shape (mode,)
        Modal masses.
    frequency : array, shape (mode,)
        Angular frequencies [rad/s], 0 for rigid motion.
    residual : array, shape (freedom, freedom)
        Flexibility of the omitted modes.
    rigid, attached : int
        Numbers of rigid modes, and of attachment modes, which are the last ones.
    """

    shapes: Matrix
    mass: Vector
    frequency: Vector
    residual: Matrix
    rigid: int
    attached: int = 0

    @property
    def count(self) -> int:
        """Number of modes."""
        return self.mass.size


@dataclass(frozen=True)
class Spectrum:
    """All modes of a free shaft, the lowest first, with its static flexibility under balanced forces.

    Attributes
    ----------
    M, K : array, shape (freedom, freedom)
    shapes : array, shape (freedom, mode)
        Mass-normalised.
    frequency : array, shape (mode,)
        [rad/s]; 0 for rigid motion.
    flexibility : array, shape (freedom, freedom)
        Displacement under forces that inertia balances, without rigid motion.
    rigid : int
    """

    M: Matrix
    K: Matrix
    shapes: Matrix
    frequency: Vector
    flexibility: Matrix
    rigid: int


def spectrum(M: Matrix, K: Matrix, rigid: Matrix) -> Spectrum:
    """Modes of a free structure by a symmetric eigenproblem of the degrees of freedom that have mass.

    Parameters
    ----------
    M, K : array, shape (freedom, freedom)
        Symmetric; M may be singular.
    rigid : array, shape (freedom, motion)
        Rigid motions, without elastic forces.

    Raises
    ------
    CaseError
        No mass, or a part without mass that nothing holds.
    """
    heavy = np.diag(M) > NONE * np.max(np.diag(M), initial=0.0)
    if not heavy.any():
        raise CaseError("found no mass, expected a shaft or a disk with mass")
    back = _condensation(K, heavy)
    Md, Kd = M[np.ix_(heavy, heavy)], back.T @ K @ back
    # Displacements are in m and slopes in rad: in units of their own masses the matrices have one size.
    size = 1 / np.sqrt(np.diag(Md))
    L = np.linalg.cholesky(size[:, None] * Md * size)
    inner = np.linalg.solve(L, np.linalg.solve(L, size[:, None] * Kd * size).T).T
    values, vectors = np.linalg.eigh((inner + inner.T) / 2)
    shapes = back @ (size[:, None] * np.linalg.solve(L.T, vectors))
    free = rigid_motions(M, rigid)
    n = free.shape[1]
    shapes[:, :n] = free
    frequency = np.sqrt(np.maximum(values, 0.0))
    if frequency.size > n and not frequency[n] > RIGID * frequency[-1]:
        raise CaseError("found a shaft whose parts nothing holds together, expected one piece")
    frequency[:n] = 0.0
    return Spectrum(M, K, shapes, frequency, balanced_flexibility(M, K, free), n)


def _condensation(K: Matrix, heavy: NDArray[np.bool_]) -> Matrix:
    """Displacements of all degrees of freedom by those with mass, nothing acting on the others."""
    back = np.eye(K.shape[0])[:, heavy]
    if not heavy.all():
        own = K[np.ix_(~heavy, ~heavy)]
        if np.linalg.svd(own, compute_uv=False)[-1] <= NONE * np.abs(own).max():
            raise CaseError("found a station without mass that nothing holds, expected a spring or an element")
        back[~heavy] = -np.linalg.solve(own, K[np.ix_(~heavy, heavy)])
    return back


def rigid_motions(M: Matrix, rigid: Matrix) -> Matrix:
    """Rigid motions made orthogonal by mass and of mass one, in their order; those without inertia are left out."""
    made: list[Vector] = []
    for motion in rigid.T:
        left = motion - sum((made_one * (made_one @ M @ motion) for made_one in made), np.zeros_like(motion))
        inertia = left @ M @ left
        if inertia > NONE * (motion @ M @ motion):
            made.append(left / np.sqrt(inertia))
    return np.stack(made, axis=1)


def balanced_flexibility(M: Matrix, K: Matrix, rigid: Matrix) -> Matrix:
    """Static flexibility with inertia relief: K u = f - M a, with the rigid acceleration a that f causes, and no rigid u.

    Forces at each degree of freedom are columns; ``rigid`` is mass-normalised.
    """
    n, k = rigid.shape
    Mr = M @ rigid
    scale = np.abs(K).max() / np.abs(Mr).max()  # one size for both blocks of the bordered matrix
    size = np.concatenate([1 / np.sqrt(np.diag(K)), np.ones(k)])
    bordered = np.block([[K, scale * Mr], [scale * Mr.T, np.zeros((k, k))]])
    unit = np.zeros((n + k, n))
    unit[:n] = np.eye(n)
    found = (size[:, None] * np.linalg.solve(size[:, None] * bordered * size, size[:, None] * unit))[:n]
    return np.asarray((found + found.T) / 2)


def reduce(whole: Spectrum, elastic: int, attachments: Sequence[int], displacements: Sequence[int]) -> Modes:
    """Keep the rigid and the lowest elastic modes, and what the omitted ones answer to forces at some places.

    Parameters
    ----------
    whole : Spectrum
    elastic : int
        Number of elastic modes; fewer where the shaft has fewer.
    attachments : sequence of int
        Degrees of freedom at which the kept modes shall answer statically like the whole shaft.
    displacements : sequence of int
        Degrees of freedom that are displacements, for the size of the shapes.
    """
    count = min(whole.rigid + elastic, whole.frequency.size)
    shapes, frequency = whole.shapes[:, :count], whole.frequency[:count]
    bent = shapes[:, whole.rigid :]
    residual = whole.flexibility - (bent / frequency[whole.rigid :] ** 2) @ bent.T
    residual = _without_rounding(residual, whole.flexibility)
    answers = [place for place in attachments if residual[place, place] > LITTLE * whole.flexibility[place, place]]
    columns = residual[:, answers]
    columns = columns - shapes @ (shapes.T @ whole.M @ columns)  # rounding holds some of the kept modes
    attached = 0
    if columns.size:
        values, vectors = _attachment(whole, columns)
        shapes, frequency = np.hstack([shapes, vectors]), np.concatenate([frequency, values])
        residual = _without_rounding(residual - (vectors / values**2) @ vectors.T, whole.flexibility)
        residual[list(attachments)] = residual[:, list(attachments)] = 0.0  # but for rounding they are
        attached = values.size
    size = np.array([_largest(shape[list(displacements)]) for shape in shapes.T])
    return Modes(shapes / size, 1 / size**2, frequency, residual, whole.rigid, attached)


def _attachment(whole: Spectrum, columns: Matrix) -> tuple[Vector, Matrix]:
    """Frequencies and mass-normalised shapes of the motions that some static responses span."""
    size = 1 / np.sqrt(np.einsum("ij,ik,kj->j", columns, whole.K, columns))
    columns = columns * size
    energy, mixed = np.linalg.eigh(columns.T @ whole.K @ columns)
    if energy[0] <= LITTLE * energy[-1]:
        own = energy > LITTLE * energy[-1]
        columns = columns @ (mixed[:, own] / np.sqrt(energy[own]))
    M, K = columns.T @ whole.M @ columns, columns.T @ whole.K @ columns
    if np.linalg.eigvalsh(M)[0] <= NONE * np.abs(M).max():
        raise CaseError("found a force at a station without mass, expected mass where teeth or unbalances act")
    L = np.linalg.cholesky(M)
    inner = np.linalg.solve(L, np.linalg.solve(L, K).T).T
    values, vectors = np.linalg.eigh((inner + inner.T) / 2)
    return np.sqrt(values), columns @ np.linalg.solve(L.T, vectors)


def _without_rounding(residual: Matrix, flexibility: Matrix) -> Matrix:
    """Set to zero what is rounding of the flexibility that it is the small rest of."""
    size = np.sqrt(np.maximum(np.diag(flexibility), 0.0))
    return np.where(np.abs(residual) > NONE * np.outer(size, size), residual, 0.0)


def _largest(values: Vector) -> float:
    """The value of largest magnitude, with its sign; of equal ones the last."""
    near = np.flatnonzero(np.abs(values) >= np.abs(values).max() * (1 - 1e-9))
    return float(values[near[-1]])


def mode_names(modes: Modes) -> list[str]:
    """What each mode of a plane is called: translation, tilt, bending 1, ..., attachment 1, ..."""
    rigid = ["translation", "tilt"][: modes.rigid]
    bent = [f"bending {i + 1}" for i in range(modes.count - modes.rigid - modes.attached)]
    return [*rigid, *bent, *(f"attachment {i + 1}" for i in range(modes.attached))]
