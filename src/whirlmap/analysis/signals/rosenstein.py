"""Largest Lyapunov exponent of a recorded signal from the divergence of nearest neighbours (Rosenstein)."""

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from whirlmap.analysis.signals.divergence_slope import exponent_of
from whirlmap.analysis.signals.neighbour_divergence import FAR, ROUNDING, checked, follow, mean_logarithms, near_passes
from whirlmap.errors import RangeError


def rosenstein_exponent(
    series: ArrayLike,
    *,
    dimension: int,
    lag: int,
    theiler: int,
    steps: int,
    flow: bool,
    rate: float = 1.0,
    least_distance: float = 0.0,
    references: int = 4000,
    tolerance: float = 0.15,
    least_growth: float = 1.0,
    blocks: int = 8,
) -> xr.Dataset:
    """Largest exponent from the mean logarithm of the distance between nearest neighbours.

    Parameters
    ----------
    series : array, shape (time,)
        Evenly spaced samples.
    dimension, lag : int
        Delay embedding.
    theiler : int
        Neighbours less than this number of samples apart do not count; one mean period of a flow, at least.
    steps : int
        Samples over which neighbours are followed.
    flow : bool
        The samples follow a smooth motion in time, as `neighbour_divergence.is_flow` tells, and distances are taken across
        it; False for the points of a map or of a section.
    rate : float
        Samples per unit of time.
    least_distance : float
        Neighbours nearer than this do not count: twice the distance by which noise parts equal points, for those that are
        nearer by chance diverge as the noise does.
    references : int
        Points whose neighbours are followed, evenly spaced.
    tolerance, least_growth
        Of the scaling range, as in `divergence_slope.exponent_of`.
    blocks : int
        Parts of the series whose scatter gives the error.

    Returns
    -------
    xr.Dataset
        ``exponent``, ``exponent_error``, ``divergence(step)`` and ``status``, as `divergence_slope.exponent_of` says. Where
        there is no straight range of growth the answer is ``no-scaling-range``: regular motion, or noise.

    Raises
    ------
    RangeError
        The series is too short, not finite or constant; or an option is out of range.

    Notes
    -----
    [rosenstein1993], each vector's one nearest neighbour outside the Theiler window and the Euclidean distance of the
    vectors averaged in the logarithm, with one difference: the part of the distance along a flow, which does not grow, is
    taken off (`neighbour_divergence`). Pairs that coincide exactly are left out; where most do (a cycle without noise) the
    status is ``neighbours-coincide``. Limits: noise above the small scales hides the range; the growth saturates at
    the size of the attractor, so that few points (below 10^dimension) leave no range.
    """
    x = checked(series)
    if blocks < 2:
        raise RangeError(f"blocks = {blocks}: at least 2.")
    embedded: dict[str, Any] = {"dimension": dimension, "lag": lag, "theiler": theiler, "steps": steps, "flow": flow}
    near = near_passes(x, references=references, wanted=1, least=least_distance, **embedded)
    usual = np.isfinite(near.distance[:, 0]) & (near.distance[:, 0] > ROUNDING * np.abs(x).max())
    own, other = near.own[usual], near.other[usual, 0]
    curves, far = np.full((blocks, steps + 1), np.nan), np.zeros(steps + 1)
    if own.size >= max(near.own.size // 4, 5 * blocks):
        distance = follow(x, own, other, **embedded)
        curves, far = mean_logarithms(distance, blocks), (distance > FAR * near.size).mean(axis=0)
    ds = exponent_of(
        curves, far, rate=rate, tolerance=tolerance, least_growth=least_growth, least_steps=(dimension - 1) * lag
    )
    ds.attrs |= {"algorithm": "rosenstein1993", "dimension": dimension, "lag": lag, "theiler": theiler}
    return ds
