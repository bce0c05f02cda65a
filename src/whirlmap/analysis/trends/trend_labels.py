"""Labels of non-periodic motion whose section changes steadily: at rest, growing or drifting, each with its rate."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.trends.goes_on import drift_goes_on, growth_goes_on
from whirlmap.analysis.trends.rest import rate_of_rest, resting_places
from whirlmap.analysis.trends.trend import PARTS, trend
from whirlmap.equations.model import Model
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.scales import scales
from whirlmap.results.regime import Regime

Array = NDArray[np.float64]
Points = NDArray[np.intp]

#: Part of the size of a state (`scales`) below which its spread is rounding.
STILL = 1e-3
#: Part of a rate by which two measurements of it may differ.
AGREE = 0.2


@dataclass(frozen=True)
class Trends:
    """Steady changes of the sections of some points, arrays that end in the point axis.

    Attributes
    ----------
    growth : array, shape (point,)
        Rate of the amplitude per unit of time; NaN where it does not change steadily.
    drift : array, shape (state, point)
        Speed of the mean per unit of time; zero where it does not move steadily.
    centre, reach : array, shape (state, point)
        Middle of the first part of the section, and its remaining distance, at its rate, to the limit.
    exponent, error : array, shape (point,)
        Largest Lyapunov exponent; NaN where it is not known.
    """

    growth: Array
    drift: Array
    centre: Array
    reach: Array
    exponent: Array
    error: Array

    @classmethod
    def of(
        cls, model: Model, period: Array, section: Array, time: Array, exponent: Array, error: Array,
        cyclic: Mapping[int, float] | None,
    ) -> "Trends":  # fmt: skip
        """Trends of points from their sections, shape (row, state, point), ``time`` between rows; ``period`` is T."""
        least = STILL * scales(model, period, np.ptp(section, axis=0), np.abs(section).max(axis=0))
        seen = trend(section, dict(cyclic or {}), least)
        first = section[: max(len(section) // PARTS, 1)]
        low, high = first.min(axis=0), first.max(axis=0)
        with np.errstate(divide="ignore", invalid="ignore"):
            reach = (high - low) / -np.expm1(-np.abs(seen.growth) * max(len(first) - 1, 1))
        return cls(seen.growth / time, seen.drift / time, (low + high) / 2, reach, exponent, error)


@dataclass(frozen=True)
class Endless:
    """Labels of some points: at rest, drifting, growing, else undecided; with the rates, as in `Returns`."""

    regime: NDArray[np.int8]
    growth: Array
    drift: Array


def approach_to_rest(
    ensemble: Ensemble, points: Points, record: Array, moved: Array, cyclic: Mapping[int, float] | None
) -> Array:
    """Rate at which unforced motions, read once per typical time, approach an equilibrium from one side; NaN in others.

    A node need not be crossed by any section, and a slow one is not reached in any record.

    Parameters
    ----------
    record : array, shape (time, state, points)
        States once per typical time, the last of them where the points are.
    moved : array, shape (state, points)
        Range of each state since the start.

    Returns
    -------
    array, shape (points,)
        Largest real part of the eigenvalues there, per unit of time.

    Notes
    -----
    The record's amplitude must fall at that rate (`label_trends`). Where it has hardly changed, it moves at a constant
    speed, which must be the rate times the remaining distance.
    """
    period, unknown = ensemble.period[points], np.full(points.size, np.nan)
    trends = Trends.of(ensemble.model, period, record, period, unknown, unknown, cyclic)
    drift = trends.drift.copy()
    trends.drift[:] = 0.0
    trends.growth[trends.growth > 0] = np.nan  # whether it grows for ever its section says
    rate = label_trends(ensemble, points, trends, moved).growth
    moves = np.flatnonzero(drift.any(axis=0))
    if moves.size:
        way = moved[:, moves]
        x, there = resting_places(ensemble, points[moves], way, way, np.full_like(way, np.inf))
        moves, x = moves[there], x[:, there]
    if moves.size:
        slow, speed = rate_of_rest(ensemble, points[moves], x), drift[:, moves]
        left = x - ensemble.x[:, points[moves]]
        with np.errstate(invalid="ignore"):
            agrees = (np.abs(speed + slow * left) <= AGREE * np.abs(speed)) | (speed == 0)
        rests = (slow < 0) & agrees.all(axis=0)
        rate[moves[rests]] = slow[rests]
    return rate


def label_trends(ensemble: Ensemble, points: Points, trends: Trends, moved: Array) -> Endless:
    """Label points whose trend goes on for ever.

    Parameters
    ----------
    ensemble : Ensemble
        Where the sections begin; stays as it is.
    points : array of int
        Its points that the trends are of, in their order.
    moved : array, shape (state, points)
        Range of each state of the motion.

    Notes
    -----
    Rest: an equilibrium is there at all phases, and small motions about it die away as fast as the section does. Growth: the
    tangent vector grows as the amplitude does, and so do copies of the motion up to the bound (`goes_on`). Drift: copies
    drift on as well; growth too where the section drifts but not the mean, at the rate 0.
    """
    out = Endless(
        np.full(points.size, Regime.undecided, dtype=np.int8), np.full(points.size, np.nan), np.zeros_like(trends.drift)
    )
    with np.errstate(invalid="ignore"):
        apart = np.abs(trends.growth - trends.exponent) > AGREE * np.abs(trends.growth) + 3 * trends.error
        falls, rises = np.flatnonzero(trends.growth < 0), np.flatnonzero((trends.growth > 0) & ~apart)
    if falls.size:
        reach = moved[:, falls] + (1 + AGREE) * trends.reach[:, falls]
        x, there = resting_places(ensemble, points[falls], moved[:, falls], moved[:, falls], reach)
        falls, x = falls[there], x[:, there]
    if falls.size:
        rate = rate_of_rest(ensemble, points[falls], x)
        rests = (rate < 0) & (np.abs(rate - trends.growth[falls]) <= AGREE * np.abs(rate))
        out.regime[falls[rests]], out.growth[falls[rests]] = Regime.at_rest, rate[rests]
    if rises.size:
        on = rises[growth_goes_on(ensemble, points[rises], trends.centre[:, rises], trends.growth[rises])]
        rate = np.where(np.isfinite(trends.exponent), trends.exponent, trends.growth)  # the more accurate one
        out.regime[on], out.growth[on] = Regime.growing, rate[on]
    moves = np.flatnonzero(trends.drift.any(axis=0))
    if moves.size:
        time = ensemble.strobe * ensemble.period[points[moves]]
        goes, means = drift_goes_on(ensemble, points[moves], trends.drift[:, moves] * time)
        out.regime[moves[goes]] = np.where(means, Regime.drifting, Regime.growing)[goes]
        out.growth[moves[goes & ~means]] = 0.0  # in proportion to time
        out.drift[:, moves[goes]] = trends.drift[:, moves[goes]]
    return out
