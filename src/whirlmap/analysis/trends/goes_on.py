"""Unbounded growth and drift: verified by copies of the motion that start further out.

A transient grows or creeps for a while and ends on a large attractor; an unbounded motion behaves in the same way at
every size. So copies of the motion are started at 10, 100, ... times its present distance, up to the bound of the model, and
every one of them must go on at least half as fast as the one before. That takes a few windows of time for all copies
together, where running to the bound would take ln(bound) / rate.
"""

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.trends.trend import spread
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.results.status import Status

Array = NDArray[np.float64]
Points = NDArray[np.intp]

#: Most copies of one motion, each ten times as far out as the one before; none is nearer to the bound than this.
COPIES, ROOM = 32, 0.1
#: Part of the rate that every copy must keep.
KEEPS = 0.5
#: Growth of a copy that its window is long enough for, and shortest and longest window, in common periods.
GROWN, SHORTEST, LONGEST = 0.1, 16, 512
#: Common periods over which a drift is measured, and copies of a motion that drifts: further out it would drown in rounding.
DRIFTED, DISTANCES = 8, 5


def growth_goes_on(ensemble: Ensemble, points: Points, centre: Array, growth: Array) -> NDArray[np.bool_]:
    """Whether growing motions grow at every size up to the bound.

    Parameters
    ----------
    ensemble : Ensemble
        Stays as it is; at phase zero.
    points : array of int
        Which of its points grow.
    centre : array, shape (state, points)
        What they grow away from.
    growth : array, shape (points,)
        Rate per unit of time.
    """
    out = np.zeros(points.size, dtype=bool)
    common = ensemble.strobe
    time = common * ensemble.period[points]
    windows = np.clip(2 ** np.ceil(np.log2(GROWN / (growth * time))), SHORTEST, LONGEST).astype(np.int64)
    away = ensemble.x[:, points] - centre
    for window in np.unique(windows):
        these = np.flatnonzero(windows == window)
        copies, of = _copies(ensemble, points[these], centre[:, these], away[:, these])
        copies.advance(int(window) * common)
        sizes = []
        for _ in range(2):
            kind: Literal[False, "between"] = False if ensemble.model.forced else "between"
            segment = copies.advance(int(window) * common, save_periods=common, extremes=kind)
            # Strobed, a forced motion shows its free part alone; without a forcing there is no phase to strobe at.
            whole = segment.extremes
            ranges = None if whole is None else (whole["maximum"] - whole["minimum"])[: ensemble.model.dimension]
            sizes.append(spread(segment.saved) if ranges is None else ranges)
        moves = (sizes[0] > 0) & (sizes[1] > 0)
        larger = np.log(np.divide(sizes[1], sizes[0], out=np.ones_like(sizes[0]), where=moves)).sum(axis=0)
        larger /= np.maximum(moves.sum(axis=0), 1)
        rate = larger / (window * time[these][of])
        rate[copies.status == Status.diverged] = np.inf
        out[these] = _all_keep(rate, growth[these], of, copies.status)
    return out


def drift_goes_on(ensemble: Ensemble, points: Points, drift: Array) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Whether motions whose section drifts drift on as fast at every place up to the bound.

    Parameters
    ----------
    drift : array, shape (state, points)
        Speed of the section's mean of each state per common period; zero in those that do not drift.

    Returns
    -------
    on : array of bool, shape (points,)
        Whether the section drifts on.
    moves : array of bool, shape (points,)
        Whether the mean over all times drifts with it. Where it does not, the amplitude grows in proportion to time, as at
        a resonance without damping.
    """
    common = ensemble.strobe
    length = DRIFTED * common
    x = ensemble.x[:, points]
    copies, of = _copies(ensemble, points, x - DRIFTED * drift, DRIFTED * drift, DISTANCES)
    copies.advance(length)
    section, mean = [], []
    for _ in range(2):
        found = copies.advance(length, extremes=True).extremes
        assert found is not None
        section.append(copies.x.copy())
        mean.append(found["mean"][: ensemble.model.dimension])
    whole, one = np.ones(points.size), drift[:, of]
    on, moves = (_all_keep(_share(then, now, one), whole, of, copies.status) for then, now in (section, mean))
    return on, moves


def _share(then: Array, now: Array, drift: Array) -> Array:
    """Least speed of the states that drift, over the speed that they are said to have."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.where(drift != 0, (now - then) / (DRIFTED * drift), np.inf).min(axis=0))


def _copies(
    ensemble: Ensemble, points: Points, centre: Array, away: Array, decades: int = COPIES
) -> tuple[Ensemble, NDArray[np.int64]]:
    """Copies of points further out, and which of the points each is a copy of; the first of each is the point itself."""
    x, of = [], []
    for k in range(points.size):
        for decade in range(decades):
            copy = centre[:, k] + 10.0**decade * away[:, k]
            if decade and not (np.abs(copy) / ensemble.limits[:, points[k]]).sum() < ROOM:
                break
            x.append(copy)
            of.append(k)
    index = np.array(of, dtype=np.int64)
    at = points[index]
    made = Ensemble(
        ensemble.model, ensemble.values[:, at], np.array(x).T, orders=ensemble.orders, steps=ensemble.point_steps[at],
        method=ensemble.method, workers=ensemble.workers, turn=ensemble.period[at], beyond=ensemble.limits[:, at],
    )  # fmt: skip
    return made, index


def _all_keep(rate: Array, wanted: Array, of: NDArray[np.int64], status: NDArray[np.int8]) -> NDArray[np.bool_]:
    """Whether all copies of each point go on, and none comes to another end than the bound."""
    out = np.ones(wanted.size, dtype=bool)
    for k in range(wanted.size):
        least = wanted[k]
        for j in np.flatnonzero(of == k):
            ends = status[j] not in (Status.ok, Status.diverged)
            out[k] &= not ends and rate[j] >= KEEPS * least
            least = min(rate[j], least)
    return out
