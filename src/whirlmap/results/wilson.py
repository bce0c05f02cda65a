"""Wilson's confidence interval of a proportion."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

#: Quantile of a 95 % interval.
Z = 1.959964


def wilson_interval(count: ArrayLike, n: float) -> tuple[Array, Array]:
    """Wilson's 95 % interval of a share ``count / n`` (Wilson 1927, J. Am. Stat. Assoc. 22, 209).

    Parameters
    ----------
    count : array
        How often, from 0 to ``n``.
    n : float
        Out of how many, at least one. No whole number where it is what draws that are not independent are worth.

    Returns
    -------
    low, high : arrays, shape like ``count``
        Exactly 0 where nothing was counted, exactly 1 where everything was.
    """
    hits = np.asarray(count)
    p, z2 = hits / n, Z**2
    centre = (p + z2 / (2 * n)) / (1 + z2 / n)
    half = Z / (1 + z2 / n) * np.sqrt(p * (1 - p) / n + z2 / (4 * n**2))
    return np.where(hits == 0, 0.0, centre - half), np.where(hits == n, 1.0, centre + half)
