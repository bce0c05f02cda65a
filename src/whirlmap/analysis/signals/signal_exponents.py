"""Rosenstein's and Kantz's exponents of a recorded signal, with the choice of their parameters."""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from whirlmap.analysis.signals.kantz import kantz_exponent
from whirlmap.analysis.signals.neighbour_divergence import is_flow, resolved
from whirlmap.analysis.signals.rosenstein import rosenstein_exponent

#: Most samples whose neighbours are followed.
LONGEST = 48_000
#: Swings over which neighbours are followed.
FOLLOWED = 12


def signal_exponents(
    x: NDArray[np.float64], *, dimension: int, lag: int, swing: int, rate: float
) -> tuple[dict[str, xr.Dataset], int]:
    """Exponents of a signal by both methods.

    Parameters
    ----------
    x : array, shape (time,)
    dimension, lag : int
        Delay embedding.
    swing : int
        Samples per swing.
    rate : float
        Samples per unit of time.

    Returns
    -------
    exponents : dict
        ``rosenstein`` and ``kantz``, as these functions give them.
    factor : int
        Their steps for one sample of ``x``.

    Notes
    -----
    A smooth signal is interpolated to 40 samples per swing and smoothed over a quarter swing
    (`neighbour_divergence.resolved`); its vectors span half a swing at most, for longer ones hold growth already, and
    neighbours nearer than twice the distance by which noise parts equal points do not count: those that are, are near by
    chance.
    """
    part, least, factor, flow = x[:LONGEST], 0.0, 1, is_flow(x)
    if flow:
        part, factor, noise = resolved(part, swing)
        across = max(dimension - 1, 1)
        least = 2 * noise * np.sqrt(2 * across)
        lag = max(min(lag * factor, factor * swing // (2 * across)), 1)
    steps = min(FOLLOWED * factor * swing, part.size // 4)
    both = {"rosenstein": rosenstein_exponent, "kantz": kantz_exponent}
    found = {
        name: method(
            part, dimension=dimension, lag=lag, theiler=factor * swing, steps=steps, flow=flow, rate=factor * rate,
            least_distance=least,
        )
        for name, method in both.items()
    }  # fmt: skip
    return found, factor
