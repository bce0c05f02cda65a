"""Fits to the mobilities of the porous film with fixed arc: the film as a Taylor integrator likes it best.

The closed forms of the audit (complex roots, logarithms) and its quadrature with constant nodes cost a Taylor integrator a
convolution for every multiplication of variables, some hundreds of them. The mobilities are even in the eccentricity and
analytic in its square, so on the range that the orbits visit they are polynomials in e^2, or quotients of polynomials with
one denominator, to any accuracy. In the Chebyshev basis one convolution gives one more degree for all of them, and sums
with constant factors cost next to nothing. Polynomials are cheapest for loose tolerances, quotients for tight ones.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from whirlmap.errors import RangeError
from whirlmap.films.tables import fixed_arc

Array = NDArray[np.float64]

#: Degree at which rounding is reached for psi = 1e-3 up to an eccentricity of 0.92.
HIGHEST = 48
#: Largest degree of a denominator; quotients reach about 1e-12 there and get no better.
DENOMINATOR = 10
#: Sanathanan-Koerner iterations, each of which weighs the residuals by the last denominator.
_ITERATIONS = 8
#: Points where fits are made, and between them measured.
_POINTS, _CHECKS = 160, 1001


@dataclass(frozen=True, eq=False)
class FilmFit:
    """Mobilities as quotients of Chebyshev series in ``z = 2 e^2/reach^2 - 1``.

    Attributes
    ----------
    above : array, shape (3, degree + 1)
        Numerators of D/Delta, (G - D)/(Delta e^2) and B/(Delta e).
    below : array, shape (degree + 1,)
        Their denominator; (1,) for polynomials.
    reach : float
        Largest eccentricity.
    error : float
        Largest error of the three over the range, measured between the points of the fit.
    """

    above: Array
    below: Array
    reach: float
    error: float

    def __call__(self, e2: Array) -> Array:
        """Mobilities at squares of the eccentricity, shape (3, ...)."""
        z = 2 * e2 / self.reach**2 - 1
        return chebyshev.chebval(z, self.above.T) / chebyshev.chebval(z, self.below)

    @property
    def degree(self) -> int:
        """Highest degree in e^2, above or below."""
        return max(self.above.shape[1], self.below.size) - 1

    @property
    def products(self) -> int:
        """Products and quotients of variables that one evaluation takes."""
        return self.degree - 1 + (4 if self.below.size > 1 else 0)

    @property
    def name(self) -> str:
        """How the fit is called in tables."""
        kind = f"{self.above.shape[1] - 1}/{self.below.size - 1}" if self.below.size > 1 else f"{self.degree}"
        return f"degree {kind}, error {self.error:.0e}"


def mobilities(e2: Array, psi: float) -> Array:
    """D/Delta, (G - D)/(Delta e^2) and B/(Delta e) by the film's quadrature, shape (3, ...)."""
    return np.stack(fixed_arc(psi, e2))


def film_fit(psi: float, reach: float, error: float) -> FilmFit:
    """Fit with the fewest products whose largest error is below ``error``.

    Raises
    ------
    RangeError
        Where no fit gets there.
    """
    fits = _fits(psi, reach)
    good = [fit for fit in fits if fit.error < error]
    if not good:
        best = min(fit.error for fit in fits)
        raise RangeError(f"no film fit up to eccentricity {reach:g} has an error below {error:.1e}; the best has {best:.1e}")
    return min(good, key=lambda fit: fit.products)


@lru_cache(maxsize=4)
def _fits(psi: float, reach: float) -> tuple[FilmFit, ...]:
    """All candidates with their measured errors."""
    nodes = np.cos(np.pi * (np.arange(_POINTS) + 0.5) / _POINTS)
    z = np.linspace(-1, 1, _CHECKS)
    values, exact = mobilities(reach**2 * (nodes + 1) / 2, psi), mobilities(reach**2 * (z + 1) / 2, psi)

    def measured(above: Array, below: Array) -> FilmFit:
        fit = FilmFit(above, below, reach, 0.0)
        return FilmFit(above, below, reach, float(np.abs(fit(reach**2 * (z + 1) / 2) - exact).max()))

    series = 2 * chebyshev.chebvander(nodes, HIGHEST).T @ values.T / _POINTS
    series[0] /= 2
    polynomials = [measured(series[: degree + 1].T.copy(), np.ones(1)) for degree in range(2, HIGHEST + 1)]
    quotients = [
        measured(*_quotient(nodes, values, n + more, n)) for n in range(3, DENOMINATOR + 1) for more in (0, 1, 2)
    ]
    return (*polynomials, *quotients)


def _quotient(z: Array, values: Array, m: int, n: int) -> tuple[Array, Array]:
    """Numerators of degree m and one denominator of degree n by iterated linear least squares."""
    V, W = chebyshev.chebvander(z, m), chebyshev.chebvander(z, n)
    q: Array = np.ones(z.size)
    below: Array = np.ones(1)
    solution: Array = np.zeros(0)
    for _ in range(_ITERATIONS):
        rows = np.zeros((3, z.size, 3 * (m + 1) + n))
        for i, value in enumerate(values):
            rows[i, :, i * (m + 1) : (i + 1) * (m + 1)] = V / q[:, None]
            rows[i, :, 3 * (m + 1) :] = -(value / q)[:, None] * W[:, 1:]
        found = np.linalg.lstsq(rows.reshape(-1, rows.shape[-1]), (values / q).ravel(), rcond=None)[0]
        solution = np.asarray(found, dtype=np.float64)
        below = np.concatenate([np.ones(1), solution[3 * (m + 1) :]])
        q = np.asarray(W @ below, dtype=np.float64)
    return solution[: 3 * (m + 1)].reshape(3, m + 1), below
