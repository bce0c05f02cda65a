"""Power-law thinning of a film: a gap that closes as a power of time and reaches no steady state, such as in oil whip.

A journal that whirls at half the speed of its shaft turns with the mean speed of its film, which then carries nothing: the
eccentricity creeps to one, about as one less a multiple of t^-1/2 (the stock rotor: t^-0.68 after 260 T, t^-0.5 after
16 000), and no time settles it. Towards a limit the local power d ln(gap) / d ln(t) falls to zero; of a film that goes on
thinning it stands.
"""

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.indicators.birkhoff import rotation_numbers
from whirlmap.analysis.indicators.section_coordinates import largest_extents, moving_coordinates
from whirlmap.equations.model import Model
from whirlmap.integrate.step_retry import stop_function

Array = NDArray[np.float64]

#: Parts of a record whose gaps must fall from each to the next, and least section points in each.
PARTS, LEAST = 8, 2
#: The gap has fallen to this part of the largest one since the start.
THIN = 0.1
#: Powers that count, and the part of the power in the first half of the record that the second half keeps.
POWERS, KEEPS = (0.2, 3.0), 0.5


def thinning_power(model: Model, values: Array, section: Array, begin: float, widest: float) -> float:
    """Power of time with which the narrowest gap of a motion falls; NaN where it does not, or the model has no gap.

    Parameters
    ----------
    values : array, shape (parameter,)
    section : array, shape (time, state)
        Section points, one after each common period.
    begin : float
        Common periods since the start of the motion at the first of them.
    widest : float
        Largest gap since the start.
    """
    gaps = narrowest_gap(model, values, section)
    length = len(gaps) // PARTS
    if length < LEAST or not np.isfinite(gaps).all() or not (gaps > 0).all():
        return np.nan
    gaps = gaps[-PARTS * length :].reshape(PARTS, length)
    times = begin + len(section) - PARTS * length + (np.arange(PARTS) + 0.5) * length
    size = np.log(gaps.mean(axis=1))
    if not ((np.diff(size) < 0).all() and gaps[-1].mean() < THIN * widest):
        return np.nan
    slope = np.polynomial.polynomial.polyfit(np.log(times), size, 1)[1]
    half = PARTS // 2
    early, late = ((size[b] - size[a]) / np.log(times[b] / times[a]) for a, b in ((0, half), (half - 1, PARTS - 1)))
    return float(slope) if POWERS[0] <= -slope <= POWERS[1] and late <= KEEPS * early else np.nan


def turning(section: Array, cyclic: dict[int, float] | None) -> float:
    """Rotation number of section points, shape (time, state), however few; NaN where they do not go round a curve."""
    columns, moves = moving_coordinates(section[:, :, None], cyclic)
    if moves.sum() < 2:
        return np.nan
    return rotation_numbers(*largest_extents(columns))[0].number


def narrowest_gap(model: Model, values: Array, section: Array) -> Array:
    """Narrowest gap at every section point, shape (time,); infinite where the model has none."""
    if not model.stops:
        return np.full(len(section), np.inf)
    rows = stop_function(model, "gap")(list(section.T), [np.full(len(section), v) for v in values])
    return np.min([np.broadcast_to(np.asarray(row, dtype=float), (len(section),)) for row in rows], axis=0)
