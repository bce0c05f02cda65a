"""The time after which the equations repeat: by which shifts in time solutions are mapped to solutions."""

import numpy as np
from numpy.typing import NDArray

from whirlmap.integrate.system import System

Array = NDArray[np.float64]

#: States, and times at each, at which the rates are compared.
STATES, TIMES = 64, 8
#: Part of the largest rate of each state by which rates may differ: phases of long common periods are good to this.
ALIKE = 1e-9


def repeat_of_forcing(system: System, x: Array) -> int:
    """Find the least number of T after which the equations are the same.

    Parameters
    ----------
    x : array, shape (state, run)
        States that the motion visits: in others a harmonic may act that does not act there.

    Returns
    -------
    int
        A divisor of the common period's number of T, and that number unless a harmonic has no amplitude; 1 of an unforced
        model, and where the forcing has no common period.

    Notes
    -----
    A shift by this time, and by multiples of it, takes every motion to a motion; a shift by T does only where this is 1.
    """
    whole = system.strobe if system.model.forced else 1
    if whole == 1 or not x.shape[1]:
        return whole
    some = x[:, np.linspace(0, x.shape[1] - 1, min(STATES, x.shape[1])).astype(int)]
    times = system.common_period * np.random.default_rng(3).uniform(size=TIMES)
    here = np.stack([system.rhs(time, some) for time in times])
    size = np.abs(here).max(axis=(0, 2))[:, None]
    for shift in (d for d in range(1, whole) if whole % d == 0):
        there = np.stack([system.rhs(time + shift * system.period, some) for time in times])
        if (np.abs(there - here) <= ALIKE * size).all():
            return shift
    return whole
