"""Kaplan-Yorke (Lyapunov) dimension of a spectrum of exponents, with the error that theirs give it."""

import numpy as np
from numpy.typing import ArrayLike


def kaplan_yorke(spectrum: ArrayLike) -> float | None:
    """Kaplan-Yorke dimension of a spectrum of Lyapunov exponents.

    Parameters
    ----------
    spectrum : array, shape (exponent,)
        Largest first. For a flow include the zero along the trajectory: without it (the list of a forced system
        leaves out the zero of the phase) the dimension is that of the section, one less.

    Returns
    -------
    float or None
        j + (sum of the first j) / |exponent j + 1|, with the largest j whose sum is not negative; 0 where the first
        is negative. None where the sum never falls below zero (the list is too short, or volume grows), or a number
        is not finite.

    Notes
    -----
    [kaplan1979]. An upper bound of the information dimension, equal to it for typical systems (conjecture). Steps by
    one where a sum crosses zero: a periodic orbit whose zero exponent comes out as 1e-9 has dimension 1, as -1e-9 it
    has 0.
    """
    rates = np.asarray(spectrum, dtype=float)
    total = np.cumsum(rates)
    if total.size == 0 or not np.isfinite(total).all():
        return None
    if total[0] < 0:
        return 0.0
    if total[-1] >= 0:
        return None
    j = int(np.flatnonzero(total >= 0)[-1])
    return float(j + 1 + total[j] / abs(rates[j + 1]))


def kaplan_yorke_error(spectrum: ArrayLike, error: ArrayLike) -> float | None:
    """Standard error of `kaplan_yorke` from those of the exponents, taken as independent.

    Returns
    -------
    float or None
        None where the dimension is None; 0 where it is 0. First order in the errors: meaningless where the sum that
        decides j is within its own error of zero.
    """
    rates, spread = np.asarray(spectrum, dtype=float), np.asarray(error, dtype=float)
    dimension = kaplan_yorke(rates)
    if not dimension:
        return dimension
    j = int(np.flatnonzero(np.cumsum(rates) >= 0)[-1])
    below = abs(rates[j + 1])
    return float(np.hypot(np.sqrt((spread[: j + 1] ** 2).sum()), rates[: j + 1].sum() / below * spread[j + 1]) / below)
