"""Steady-state search for many operating points: which are periodic, after how many T, with sections and extremes recorded.

The steps of each point meet the asked accuracy (`settling_accurately`); forced points are searched by `settling`, unforced
ones by `settling_unforced`. Then all points record their section once per T for the diagram; in periodic points it gives the
smallest number of T. Extremes: `record_extremes`.

The tolerance is relative to each state's range (`periodicity.return_multiple`).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.motion.record_extremes import empty_extremes, extremes_of_record
from whirlmap.analysis.motion.record_length import record_periods
from whirlmap.analysis.steady.periodicity import period_in_T
from whirlmap.analysis.steady.settled import Settled
from whirlmap.analysis.steady.settling import Settling
from whirlmap.analysis.steady.settling_accurately import settle_accurately
from whirlmap.analysis.trends.film_thinning import narrowest_gap, thinning_power, turning
from whirlmap.analysis.trends.goes_on import drift_goes_on
from whirlmap.analysis.trends.rest import ROUNDING, carried, rate_of_rest, resting_places
from whirlmap.analysis.trends.trend import trend
from whirlmap.analysis.trends.trend_labels import approach_to_rest
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.results.regime import Regime
from whirlmap.results.status import Status

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Points that are recorded in one batch.
RECORDED = 4096


@dataclass(frozen=True)
class Returns:
    """Section and label of every operating point; arrays end in the point axis.

    Attributes
    ----------
    section : array, shape (period, kept state, point)
        Once per T, in the order of time; NaN where a point has ended.
    regime : array of int
        `Regime`: periodic, at rest, contact, diverged or undecided; drifting or growing, also beyond the bound.
    period, multiple : array of int
        Smallest return in T, and in common periods; of an unforced model both in crossings. 0 where there is none.
    distance : array
        The return distance that decided; NaN where a forced point ended.
    waited : array of int
        Common periods that each point ran before the record (of an unforced model: typical times).
    accelerated : array of bool
        Whether its convergence was accelerated (`acceleration`).
    growth : array
        Rate of the amplitude per unit of time: of what grows (zero where in proportion to time), and of small motions about
        a place of rest; NaN elsewhere.
    drift : array, shape (state, point)
        Speed of the section of each state per unit of time where the motion drifts, or grows in proportion to time; zero
        elsewhere.
    thinning, turning : array
        Power of time with which the narrowest gap falls where a film thins without settling, and the rotation number there;
        NaN elsewhere.
    extremes : dict of arrays, shape (row, point)
        Of every state and output over the recorded stretch.
    """

    section: Array
    regime: NDArray[np.int8]
    period: Integers
    multiple: Integers
    distance: Array
    waited: Integers
    accelerated: NDArray[np.bool_]
    growth: Array
    drift: Array
    thinning: Array
    turning: Array
    extremes: dict[str, Array]


def settle_and_record(
    ensemble: Ensemble,
    settling: Settling,
    *,
    longest: Integers | None = None,
    kept: Sequence[int] | None = None,
    cyclic: dict[int, float] | None = None,
    progress: Callable[[int], None] | None = None,
) -> Returns:
    """Run the steady-state search on an ensemble and record it, in place.

    Parameters
    ----------
    longest : array of int, shape (point,), optional
        Common periods (of an unforced model: typical times) after which each point is given up, instead of
        `Settling.longest`; what they are more or less is its transient.
    kept : sequence of int, optional
        States whose section is returned; all of them where absent. The search for the smallest return sees them all.
    """
    longest = np.full(ensemble.points, settling.longest) if longest is None else longest
    start = ensemble.x.copy()
    settled = settle_accurately(ensemble, settling, longest, cyclic, progress)
    return record(ensemble, settled, settling, start=start, kept=kept, cyclic=cyclic, progress=progress)


def record(
    ensemble: Ensemble,
    settled: Settled,
    settling: Settling,
    *,
    start: Array | None = None,
    kept: Sequence[int] | None = None,
    cyclic: dict[int, float] | None = None,
    progress: Callable[[int], None] | None = None,
) -> Returns:
    """Record and label points after the steady-state search, in place.

    Parameters
    ----------
    settled : Settled
        How they did.
    start : array, shape (state, point), optional
        Where they began; where they are now where absent.
    kept
        As in `settle_and_record`.
    """
    start = ensemble.x.copy() if start is None else start
    common, forced = ensemble.strobe, ensemble.model.forced
    periods = record_periods(ensemble.orders, settling.keep)
    rows = list(range(ensemble.model.dimension) if kept is None else kept)
    section = np.full((periods, len(rows), ensemble.points), np.nan)
    multiple = np.where(ensemble.running, settled.multiple, 0)
    period, extremes = multiple.copy(), empty_extremes(ensemble)
    ensemble.crossings[:], ensemble.grazings[:] = 0, 0  # of the record alone
    drift, nears = np.zeros((ensemble.model.dimension, ensemble.points)), np.full(ensemble.points, np.nan)
    shape = (periods // common, *drift.shape) if ensemble.model.stops else (0, 0, 0)
    whole = np.full(shape, np.nan)  # once per common period
    for first in range(0, ensemble.points, RECORDED):  # a section of all states is held for these alone
        members = np.arange(first, min(first + RECORDED, ensemble.points))
        saved, found = section_and_extremes(ensemble, members, multiple[members], periods, progress)
        section[:, :, members] = saved[:, rows]
        if ensemble.model.stops:
            whole[:, :, members] = saved[common - 1 :: common]
        for name, values in found.items():
            extremes[name][:, members] = values
        multiple[members] = np.where(ensemble.running[members], multiple[members], 0)
        drift[:, members] = np.where(multiple[members] == 0, trend(saved[common - 1 :: common], cyclic).drift, 0.0)
        open_ = np.flatnonzero((multiple[members] == 0) & ensemble.running[members] & (not forced))
        if open_.size:
            at = members[open_]
            nears[at] = approach_to_rest(ensemble, at, saved[:, :, open_], settled.moved[:, at], cyclic)
        if forced:
            period[members] = _periods_in_T(
                saved, multiple[members], settled.scale[:, members], common, settling, cyclic
            )
    thinning, turn = settled.thinning.copy(), settled.turning.copy()
    for p in np.flatnonzero((multiple == 0) & ensemble.running) if ensemble.model.stops and forced else ():
        thinning[p] = _thins(ensemble, int(p), whole[:, :, p], int(settled.waited[p]), start[:, p])
        turn[p] = turning(whole[:, :, p], cyclic) if np.isfinite(thinning[p]) else np.nan
    growth = _rest(ensemble, settled, extremes, settling.tolerance)
    growth = np.where(np.isnan(growth), nears, growth)
    drift[:, ~np.isnan(growth)] = 0.0  # rounding of what rests may add up
    rests, repels = growth < np.inf, np.isposinf(growth)
    beyond = ensemble.status == Status.diverged
    time = common * ensemble.period
    growth = np.where(beyond, settled.growth / time, np.where(np.isinf(growth), np.nan, growth))
    drift, swells = _drift(ensemble, drift)
    drift, growth[swells] = np.where(beyond, settled.drift / time, drift), 0.0
    multiple[rests | repels] = 0
    period = np.where(multiple > 0, period, 0)
    label = _labels(ensemble, multiple)  # undecided where a motion rests though the smallest disturbance grows
    label[rests], label[drift.any(axis=0)], label[swells | (growth > 0)] = Regime.at_rest, Regime.drifting, Regime.growing
    label[np.isfinite(thinning) & (label == Regime.undecided)] = Regime.not_settled
    return Returns(
        section, label, period, multiple, settled.distance, settled.waited, settled.accelerated, growth, drift, thinning,
        turn, extremes,
    )  # fmt: skip


def section_and_extremes(
    ensemble: Ensemble, members: NDArray[np.intp], multiple: Integers, periods: int, progress: Callable[[int], None] | None
) -> tuple[Array, dict[str, Array]]:
    """Section of all states, once per T, and extremes of so many T of some points, which end there."""
    found = extremes_of_record(ensemble, members, multiple, periods, progress)
    return ensemble.advance(periods, members=members, save_periods=1, progress=progress).saved, found


def _thins(ensemble: Ensemble, point: int, section: Array, waited: int, start: Array) -> float:
    """Power of time with which the gap of one point falls over its record."""
    values = ensemble.values[:, point]
    widest = narrowest_gap(ensemble.model, values, np.vstack([start, section]))
    return thinning_power(ensemble.model, values, section, waited, float(widest.max()))


def _rest(ensemble: Ensemble, settled: Settled, extremes: dict[str, Array], tolerance: float) -> Array:
    """Rate at which motion dies away in points at rest; NaN in others, infinite where the place repels.

    Zero where dry friction holds a motion: it slides on the surface of its velocity, and in a whole record no state moves by
    more than rounding of how far it has moved, of where it is, or of how far it would be carried if it were let go. Beside
    that place it would be held as well.
    """
    growth = np.full(ensemble.points, np.nan)
    states = slice(ensemble.model.dimension)
    ranges = (extremes["maximum"] - extremes["minimum"])[states]
    with np.errstate(invalid="ignore"):
        still = ranges <= tolerance * settled.moved + ROUNDING * np.abs(extremes["mean"][states])
    slides = np.flatnonzero(ensemble.sliding & ensemble.running)
    if slides.size:
        reach = np.fmax(carried(ensemble, slides), np.fmax(settled.moved, np.abs(extremes["mean"][states]))[:, slides])
        growth[slides[(ranges[:, slides] <= ROUNDING * reach).all(axis=0)]] = 0.0
    points = np.flatnonzero(still.all(axis=0) & ensemble.running & np.isnan(growth))
    if points.size:
        x, there = resting_places(ensemble, points, ranges[:, points], settled.moved[:, points])
        points, x = points[there], x[:, there]
    if points.size:
        growth[points] = rate_of_rest(ensemble, points, x)
    return growth


def _drift(ensemble: Ensemble, drift: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Speeds per unit of time of the sections' drifts that go on, and where the amplitude drifts and not the mean."""
    points = np.flatnonzero(drift.any(axis=0) & ensemble.running)
    out, swells = np.zeros_like(drift), np.zeros(ensemble.points, dtype=bool)
    if points.size:
        goes, means = drift_goes_on(ensemble, points, drift[:, points])
        swells[points[goes & ~means]] = True
        on = points[goes]
        out[:, on] = drift[:, on] / (ensemble.strobe * ensemble.period[on])
    return out, swells


def first_drift(drift: Array) -> tuple[Integers, Array]:
    """Index of the first state of each point that drifts, -1 where none does, and its speed, NaN where none does."""
    moves = drift.any(axis=0)
    first = (drift != 0).argmax(axis=0)
    speed = np.take_along_axis(drift, first[None], axis=0)[0]
    return np.where(moves, first, -1), np.where(moves, speed, np.nan)


def _periods_in_T(
    section: Array, multiple: Integers, scale: Array, common: int, settling: Settling, cyclic: dict[int, float] | None
) -> Integers:
    """Smallest return in T; a return longer than the recorded stretch is the whole multiple of the common period."""
    out = multiple * common
    fits = np.flatnonzero((multiple > 0) & (out <= section.shape[0]) & np.isfinite(section[-1]).all(axis=0))
    if fits.size and common > 1:
        found = period_in_T.find(
            section[:, :, fits], multiple[fits], common_over_T=common, scale=scale[:, fits],
            tolerance=10 * settling.tolerance, cyclic=cyclic, alike=False,
        )  # fmt: skip
        out[fits] = np.where(found["period"] > 0, found["period"], out[fits])
    return out


def _labels(ensemble: Ensemble, multiple: Integers) -> NDArray[np.int8]:
    label = np.where(multiple > 0, Regime.periodic, Regime.undecided)
    label = np.where(ensemble.status == Status.contact, Regime.contact, label)
    return np.where(ensemble.status == Status.diverged, Regime.diverged, label).astype(np.int8)
