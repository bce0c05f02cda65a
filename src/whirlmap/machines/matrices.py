"""Matrices of a shaft that another program made: mass, gyroscopic moments per rad/s and stiffness of one plane."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from whirlmap.errors import CaseError

Matrix = NDArray[np.float64]

#: Relative size of what counts as rounding of a matrix that another program wrote.
ROUNDING = 1e-6


@dataclass(frozen=True, repr=False)
class ShaftMatrices:
    """Mass M, gyroscopic G and stiffness K of a free shaft in one plane, as bytes, so that equal ones are one.

    Degrees of freedom are displacement and slope of each station in turn, [m] and [rad].
    """

    stations: int
    M: bytes
    G: bytes
    K: bytes

    @classmethod
    def of(cls, M: Matrix, G: Matrix, K: Matrix, z: NDArray[np.float64]) -> "ShaftMatrices":
        """Check matrices, shape (2 station, 2 station), of stations at the distances ``z`` [m].

        Raises
        ------
        CaseError
            Naming the array: another shape, not finite, not symmetric, a mass that is negative, or a stiffness that holds
            a shaft which moves as a rigid body.
        """
        n = z.size
        if z.ndim != 1 or n < 2 or not np.isfinite(z).all() or not (np.diff(z) > 0).all():
            raise CaseError("z: found no ascending distances of stations, expected two or more [m]")
        for name, matrix in (("M", M), ("G", G), ("K", K)):
            if matrix.shape != (2 * n, 2 * n):
                raise CaseError(f"{name}: found the shape {matrix.shape}, expected {(2 * n, 2 * n)}: displacement and slope"
                                f" of {n} stations in turn")  # fmt: skip
            if not np.isfinite(matrix).all():
                raise CaseError(f"{name}: found numbers that are not finite")
            if np.abs(matrix - matrix.T).max() > ROUNDING * np.abs(matrix).max(initial=0.0):
                raise CaseError(f"{name}: found a matrix that is not symmetric, expected one plane of a free shaft")
        if np.linalg.eigvalsh(M)[0] < -ROUNDING * np.abs(M).max():
            raise CaseError("M: found a negative mass")
        rigid = np.zeros((2 * n, 2))
        rigid[0::2, 0], rigid[0::2, 1], rigid[1::2, 1] = 1.0, z - z[0], 1.0
        sizes = np.abs(K) @ np.abs(rigid)
        if (np.abs(K @ rigid) > ROUNDING * np.maximum(sizes, sizes.max(axis=0) * ROUNDING)).any():
            raise CaseError("K: found forces on a shaft that moves as a rigid body, expected a free shaft without bearings")
        M, G, K = ((m + m.T) / 2 for m in (M, G, K))
        return cls(n, M.tobytes(), G.tobytes(), K.tobytes())

    def arrays(self) -> tuple[Matrix, Matrix, Matrix]:
        """M, G and K, each its own copy."""
        n = 2 * self.stations
        M, G, K = (np.frombuffer(one, dtype=float).reshape(n, n).copy() for one in (self.M, self.G, self.K))
        return M, G, K
