"""Settle many operating points, say which of them are periodic, and after how many T, and record their sections.

Forced models settle as `settling` says. Where the steps follow an asked accuracy, the settled motion is asked again whether
they meet it, over the whole of its return: a point that needs more of them settles on with these (the start says little of a
whirl that has grown since), and a point that has ended is run again with more (`endings`). Where the accuracy is not met, a
return is one to the error of the steps.
Then all points record their section once per T for the diagram; in periodic points it gives the smallest number of T.
Extremes are those of cubics between steps (`Ensemble.advance`), over one return, or the whole record where nothing
returns. The steps are `FINER` times shorter than the accuracy asks for, and no longer than T/`EXTREMES_STEPS`: a peak is
then missed by less than 1e-5 of the range.

An unforced model runs its transient, and is then cut at its declared section; the return is counted in crossings. Windows
are as many typical times as would be common periods, each twice the one before, for the points that have not returned.

The tolerance is relative to each state's range (`periodicity.return_multiple`).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.crossing import run_with_crossings, turns_of
from whirlmap.analysis.endings import confirm_ends, confirm_growth, restarted
from whirlmap.analysis.goes_on import drift_goes_on
from whirlmap.analysis.periodicity import period_in_T, return_multiple
from whirlmap.analysis.rest import ROUNDING, rate_of_rest, resting_places
from whirlmap.analysis.settling import Settled, Settling, settle
from whirlmap.analysis.thinning import narrowest_gap, thinning_power, turning
from whirlmap.analysis.trend import trend
from whirlmap.integrate.accuracy import LADDER, Verdict, choose_steps
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.evaluation import Evaluator
from whirlmap.integrate.scales import FLOOR, scales
from whirlmap.integrate.system import periods as periods_of
from whirlmap.integrate.turns import with_turns
from whirlmap.kernels.surfaces import sided
from whirlmap.results.regime import Regime
from whirlmap.results.status import Status

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Steps per T from which extremes are read: so many times those of the point, and no fewer than this.
FINER, EXTREMES_STEPS = 6, 32
#: The latter where rates kink or jump: a contact is far shorter than T, and located corners let few steps carry it.
KINKED_EXTREMES = 4 * EXTREMES_STEPS
#: How often a point may be given more steps after it has settled.
MORE_STEPS = 3
#: Common periods of a settled motion over which its steps are checked: of one that returns at most, of one that does not.
CHECKED, OPEN = 8, 4
#: Error of its steps from which a settled motion is not that of the equations: the point begins anew, with more of them.
LOST = 1e-2
#: Error over the accuracy up to which an open motion goes on with more steps as it is: so little is not why it does not
#: return.
SLACK = 10.0
#: Crossings of the section by which an unforced motion's turns are timed, typical times in which they are sought at most,
#: and how many times longer or shorter than a turn a typical time may be.
TURNS, SOUGHT, FAR_OFF = 4, 65_536, 2.0
#: Motion in a typical time, over the size of a state, below which rounding moves the times of crossings: no turns are timed.
STILL = 1e-6
#: Steps with which points are confirmed whose method has lost its order.
CONFIRMED = LADDER[-1]
#: T of an unforced motion that left its limits that are looked at, at most.
LAST = 512
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
        Whether its approach was cut short (`acceleration`).
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
    """Settle an ensemble and record it, in place.

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
    settled = _settle_accurately(ensemble, settling, longest, cyclic, progress)
    common, forced = ensemble.common_multiple, ensemble.model.forced
    periods = common * max(-(-settling.keep // common), 2)
    rows = list(range(ensemble.model.dimension) if kept is None else kept)
    section = np.full((periods, len(rows), ensemble.points), np.nan)
    multiple = np.where(ensemble.running, settled.multiple, 0)
    period, extremes = multiple.copy(), _empty_extremes(ensemble)
    ensemble.crossings[:], ensemble.grazings[:] = 0, 0  # of the record alone
    drift = np.zeros((ensemble.model.dimension, ensemble.points))
    least = KINKED_EXTREMES if sided(ensemble.model).surfaces else EXTREMES_STEPS
    shape = (periods // common, *drift.shape) if ensemble.model.stops else (0, 0, 0)
    whole = np.full(shape, np.nan)  # once per common period
    for first in range(0, ensemble.points, RECORDED):  # a section of all states is held for these alone
        members = np.arange(first, min(first + RECORDED, ensemble.points))
        fine = ensemble.subset(members, steps=np.maximum(FINER * ensemble.point_steps[members], least))
        saved = ensemble.advance(periods, members=members, save_periods=1, progress=progress).saved
        section[:, :, members] = saved[:, rows]
        if ensemble.model.stops:
            whole[:, :, members] = saved[common - 1 :: common]
        for name, values in _extremes(fine, multiple[members], periods, progress).items():
            extremes[name][:, members] = values
        multiple[members] = np.where(ensemble.running[members], multiple[members], 0)
        drift[:, members] = np.where(multiple[members] == 0, trend(saved[common - 1 :: common], cyclic).drift, 0.0)
        if forced:
            period[members] = _periods_in_T(
                saved, multiple[members], settled.scale[:, members], common, settling, cyclic
            )
    thinning, turn = settled.thinning.copy(), settled.turning.copy()
    for p in np.flatnonzero((multiple == 0) & ensemble.running) if ensemble.model.stops and forced else ():
        thinning[p] = _thins(ensemble, int(p), whole[:, :, p], int(settled.waited[p]), start[:, p])
        turn[p] = turning(whole[:, :, p], cyclic) if np.isfinite(thinning[p]) else np.nan
    growth = _rest(ensemble, settled, extremes, settling.tolerance)
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


def _thins(ensemble: Ensemble, point: int, section: Array, waited: int, start: Array) -> float:
    """Power of time with which the gap of one point falls over its record."""
    values = ensemble.values[:, point]
    widest = narrowest_gap(ensemble.model, values, np.vstack([start, section]))
    return thinning_power(ensemble.model, values, section, waited, float(widest.max()))


def _rest(ensemble: Ensemble, settled: Settled, extremes: dict[str, Array], tolerance: float) -> Array:
    """Rate at which motion dies away in points at rest; NaN in others, infinite where the place repels.

    Zero where dry friction holds a motion: it slides on the surface of its velocity, and there no state moves by more than
    rounding in a whole record. Beside it it would be held as well.
    """
    growth = np.full(ensemble.points, np.nan)
    states = slice(ensemble.model.dimension)
    ranges = (extremes["maximum"] - extremes["minimum"])[states]
    with np.errstate(invalid="ignore"):
        still = ranges <= tolerance * settled.moved + ROUNDING * np.abs(extremes["mean"][states])
    points = np.flatnonzero(still.all(axis=0) & ensemble.running)
    if points.size:
        x, there = resting_places(ensemble, points, ranges[:, points], settled.moved[:, points])
        points, x = points[there], x[:, there]
    if points.size:
        growth[points] = rate_of_rest(ensemble, points, x)
    held = (ranges <= ROUNDING * np.fmax(settled.moved, np.abs(extremes["mean"][states]))).all(axis=0)
    growth[held & ensemble.sliding & ensemble.running & np.isnan(growth)] = 0.0
    return growth


def _drift(ensemble: Ensemble, drift: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Speeds per unit of time of the sections' drifts that go on, and where the amplitude drifts and not the mean."""
    points = np.flatnonzero(drift.any(axis=0) & ensemble.running)
    out, swells = np.zeros_like(drift), np.zeros(ensemble.points, dtype=bool)
    if points.size:
        goes, means = drift_goes_on(ensemble, points, drift[:, points])
        swells[points[goes & ~means]] = True
        on = points[goes]
        out[:, on] = drift[:, on] / (ensemble.common_multiple * ensemble.period[on])
    return out, swells


def first_drift(drift: Array) -> tuple[Integers, Array]:
    """Index of the first state of each point that drifts, -1 where none does, and its speed, NaN where none does."""
    moves = drift.any(axis=0)
    first = (drift != 0).argmax(axis=0)
    speed = np.take_along_axis(drift, first[None], axis=0)[0]
    return np.where(moves, first, -1), np.where(moves, speed, np.nan)


def _empty_extremes(ensemble: Ensemble) -> dict[str, Array]:
    """Extremes, mean and rms of every state and output, shape (row, point), of which nothing is known yet."""
    rows = ensemble.model.dimension + len(ensemble.model.outputs)
    return {name: np.full((rows, ensemble.points), np.nan) for name in ("minimum", "maximum", "mean", "rms")}


def _extremes(
    fine: Ensemble, multiple: Integers, kept: int, progress: Callable[[int], None] | None
) -> dict[str, Array]:
    """Extremes, mean and rms of all rows: over one return of the points that return, over the record of the others."""
    out = _empty_extremes(fine)
    length = np.where((multiple > 0) & fine.model.forced, np.minimum(multiple * fine.common_multiple, kept), kept)
    for periods in np.unique(length):
        members = np.flatnonzero(length == periods)
        found = fine.advance(int(periods), members=members, extremes="between", progress=progress).extremes
        assert found is not None
        for name, values in found.items():
            out[name][:, members] = values
    return out


def _settle_accurately(
    ensemble: Ensemble, settling: Settling, longest: Integers, cyclic: dict[int, float] | None,
    progress: Callable[[int], None] | None,
) -> Settled:  # fmt: skip
    """Settle, and settle on with more steps where the settled motion, or what lies before an end, needs them."""
    how = _settle_forced if ensemble.model.forced else _settle_unforced

    def settle(part: Ensemble, members: NDArray[np.intp]) -> None:
        again = how(part, settling, longest[members], cyclic, progress)
        again.accelerated[:] |= settled.accelerated[members]
        settled.take(again, members)

    def begin_anew(part: Ensemble, members: NDArray[np.intp]) -> None:
        settled.forget(members)
        settle(part, members)

    def settle_on(part: Ensemble, members: NDArray[np.intp]) -> None:
        start, began = part.x.copy(), part.turns.copy()
        settle(part, members)
        if part.accuracy is not None:
            again = lambda anew, which: begin_anew(anew, members[which])  # noqa: E731
            confirm_growth(part, start, began, again, lambda: settled.moved[:, members])
            believed = np.isfinite(settled.thinning[members])
            confirm_ends(part, start, began, again, believed)
        if part is not ensemble:
            ensemble.absorb(part, members)

    settled, everything = Settled.none(ensemble), np.arange(ensemble.points)
    start, began = ensemble.x.copy(), ensemble.turns.copy()
    settle_on(ensemble, everything)
    if not ensemble.model.forced:
        _beyond(ensemble, settled, start, began, cyclic)
    if ensemble.accuracy is None:
        return settled
    # Points that did not return are asked too: steps that are too long may be why. One that returned has settled.
    left = everything
    for _ in range(MORE_STEPS):
        left = left[ensemble.running[left]]
        steps, first = _steps_of_settled(ensemble, left, settled.multiple, progress)
        more = steps > ensemble.point_steps[left]
        left, steps, first = left[more], steps[more], first[more]
        if not left.size:
            break
        lost = first > LOST
        on = ~lost & (settled.multiple[left] == 0) & (first <= SLACK * ensemble.accuracy)
        for which, how_on in ((on, "stays"), (~lost & ~on, "settles"), (lost, "begins")):
            here = left[which]
            if not here.size:
                continue
            part = ensemble.subset(here, steps=steps[which])
            if how_on == "stays":
                ensemble.absorb(part, here)
                continue
            if how_on == "begins":
                settled.forget(here)
                part = restarted(ensemble, here, start, began, steps[which])
            settle_on(part, here)
    # What steps are so wrong about has no return that could be believed.
    settled.multiple[ensemble.step_error > LOST] = 0
    return settled


def _steps_of_settled(
    ensemble: Ensemble, members: NDArray[np.intp], multiple: Integers, progress: Callable[[int], None] | None
) -> tuple[Integers, Array]:
    """Steps that settled points need, and the error of those that they took.

    They are asked over all of the common periods that they return after, up to `CHECKED`; where they do not, over `OPEN`.
    Those whose method has lost its order are confirmed with `CONFIRMED` steps, and their error is that of fewer ones.
    Errors and verdicts of the ensemble are set.
    """
    assert ensemble.accuracy is not None
    steps, first = ensemble.point_steps[members].copy(), np.zeros(members.size)
    # Few different numbers of sections, for points with the same are tried together: 1, `OPEN` and `CHECKED`.
    sections = np.where(multiple[members] == 1, 1, np.where(multiple[members] <= OPEN, OPEN, CHECKED))
    met = ensemble.step_verdict[members] == Verdict.met
    for count in np.unique(sections[met]):
        at = np.flatnonzero(met & (sections == count))
        here: NDArray[np.intp] = members[at]
        how: dict[str, Any] = {"sections": int(count)}
        if not ensemble.model.forced:
            at = at[_moves(ensemble, members[at])]
            here, how = members[at], {"span": OPEN, **({"observe": turns_of} if ensemble.model.section else {})}
        rungs = choose_steps(ensemble, ensemble.accuracy, members=here, least=steps[at], progress=progress, **how)
        ensemble.step_error[here], ensemble.step_verdict[here] = rungs.error, rungs.verdict
        steps[at], first[at] = np.maximum(steps[at], rungs.steps), rungs.first
    rough = np.flatnonzero(ensemble.step_verdict[members] == Verdict.nonsmooth)
    steps[rough] = np.maximum(steps[rough], CONFIRMED)
    there = rough[ensemble.point_steps[members[rough]] >= CONFIRMED]
    if there.size:
        here = members[there]
        last = np.full(here.size, LADDER[-2])
        tried = choose_steps(ensemble, ensemble.accuracy, members=here, least=last, progress=progress)
        ensemble.step_error[here] = tried.error
    return steps, first


def _settle_forced(
    ensemble: Ensemble, settling: Settling, longest: Integers, cyclic: dict[int, float] | None,
    progress: Callable[[int], None] | None,
) -> Settled:  # fmt: skip
    return settle(ensemble, settling, longest=longest, wide=_wide(ensemble, settling), cyclic=cyclic, progress=progress)


def _wide(ensemble: Ensemble, settling: Settling) -> Array:
    """How much wider than asked the tolerance of each point is: a return is no finer than the error of the steps.

    Steps that were given have no error that is known: the tolerance stays as asked.
    """
    if ensemble.accuracy is None:
        return np.ones(ensemble.points)
    return np.asarray(np.fmax(np.fmin(ensemble.step_error, LOST) / settling.tolerance, 1.0))


def _settle_unforced(
    ensemble: Ensemble, settling: Settling, longest: Integers, cyclic: dict[int, float] | None,
    progress: Callable[[int], None] | None,
) -> Settled:  # fmt: skip
    settled = Settled.none(ensemble)
    transient = longest - settling.longest + settling.transient
    running = np.flatnonzero(ensemble.running)
    first = ensemble.subset(running).advance(1, extremes=True).extremes  # how far the states move before they settle
    assert first is not None
    ranges = (first["maximum"] - first["minimum"])[: ensemble.model.dimension]
    settled.moved[:, running] = np.fmax(ranges, 0.0)
    _learn_turns(ensemble, running, SOUGHT, settled, progress)
    _run_transient(ensemble, np.flatnonzero(ensemble.running), transient, settled, progress)
    _learn_turns(ensemble, np.flatnonzero(ensemble.running), TURNS + 1, settled, progress)
    wide = _wide(ensemble, settling)
    window = min(settling.first_window, 2 * settling.most)
    left = np.flatnonzero(ensemble.running)
    while left.size:
        begin, section = ensemble.subset(left), ensemble.subset(left)
        points, times, _ = run_with_crossings(section, window, progress=progress)
        extremes = begin.advance(window, extremes=True, progress=progress).extremes
        assert extremes is not None
        ensemble.absorb(section, left)
        settled.scale[:, left] = sizes_of(ensemble, left, extremes) * wide[left]
        ranges = (extremes["maximum"] - extremes["minimum"])[: ensemble.model.dimension]
        settled.moved[:, left] = np.fmax(settled.moved[:, left], ranges)
        settled.waited[left] += window
        count = np.where(ensemble.running[left], np.isfinite(times).sum(axis=0), 0)
        for shared in np.unique(count[count > 1]):  # each point is judged by all of its crossings, whatever others have
            columns = np.flatnonzero(count == shared)
            these = left[columns]
            found = return_multiple.find(
                points[:shared][:, :, columns], scale=settled.scale[:, these], tolerance=settling.tolerance,
                most=int(min(window, shared)) // 2, cyclic=cyclic, alike=False,
            )  # fmt: skip
            settled.multiple[these], settled.distance[these] = found["multiple"], found["distance"] * wide[these]
        left = left[ensemble.running[left] & (settled.multiple[left] == 0)]
        if window >= 2 * settling.most:
            break
        window = min(2 * window, 2 * settling.most)
    return settled


def _run_transient(
    ensemble: Ensemble, members: NDArray[np.intp], transient: Integers, settled: Settled,
    progress: Callable[[int], None] | None,
) -> None:  # fmt: skip
    for times in np.unique(transient[members][transient[members] > 0]):
        these = members[transient[members] == times]
        ensemble.advance(int(times), members=these, progress=progress)
    settled.waited[members] += transient[members]


def _beyond(
    ensemble: Ensemble, settled: Settled, start: Array, began: Integers, cyclic: dict[int, float] | None
) -> None:
    """See whether points of an unforced model that left their limits had grown or drifted there steadily."""
    points = np.flatnonzero(ensemble.status == Status.diverged)
    if not points.size:
        return
    part = restarted(ensemble, points, start, began, ensemble.point_steps[points])
    whole = np.minimum(ensemble.end_time[points] / part.period, LAST).astype(np.int64)
    for count in np.unique(whole[whole > 0]):
        at = np.flatnonzero(whole == count)
        seen = trend(part.advance(int(count), members=at, save_periods=1).saved, cyclic)
        settled.growth[points[at]], settled.drift[:, points[at]] = seen.growth, seen.drift


def _learn_turns(
    ensemble: Ensemble, left: NDArray[np.intp], most: int, settled: Settled, progress: Callable[[int], None] | None
) -> None:
    """Give points whose typical time is far from that of a turn the latter, in place, with steps for it.

    Turns are timed between crossings of the section. A point is run on, twice as long each time, until it has met `TURNS` of
    them, or for ``most`` typical times: what has not turned by then keeps its own.
    """
    if ensemble.model.section is None:
        return
    start, length = ensemble.x.copy(), TURNS + 1
    left = left[_moves(ensemble, left)]  # what is at rest crosses by rounding
    while left.size and length <= most:
        turn = _time_turns(ensemble, left, length, settled, progress)
        ratio = turn / ensemble.period[left]
        own = np.abs(ensemble.period[left] / periods_of(ensemble.model, ensemble.values[:, left]) - 1) > 0  # timed before
        with np.errstate(invalid="ignore"):
            wrong = (ratio < 1 / FAR_OFF) | (ratio > FAR_OFF) | (own & np.isfinite(ratio))
        here = left[wrong]
        if here.size:
            steps = np.maximum(np.ceil(ensemble.point_steps[here] * ratio[wrong]), 1).astype(np.int64)
            part = with_turns(ensemble.subset(here, steps=steps), turn[wrong])
            # Its steps were chosen for parts of another time: what they led to may be their own.
            part.put(np.arange(here.size), start[:, here])
            ensemble.absorb(part, here)
        known = left[np.isfinite(turn)]
        if known.size and ensemble.accuracy is not None:
            least = np.where(wrong[np.isfinite(turn)], LADDER[0], ensemble.point_steps[known])
            rungs = choose_steps(
                ensemble, ensemble.accuracy, members=known, least=least, span=OPEN, observe=turns_of, progress=progress
            )
            part = ensemble.subset(known, steps=rungs.steps)
            part.step_error[:], part.step_verdict[:] = rungs.error, rungs.verdict
            ensemble.absorb(part, known)
        left = left[np.isnan(turn) & ensemble.running[left] & _moves(ensemble, left)]
        length *= 2


def _time_turns(
    ensemble: Ensemble, members: NDArray[np.intp], periods: int, settled: Settled, progress: Callable[[int], None] | None
) -> Array:
    """Run points on, in place, and time their turns, shape (member,); NaN where they cross fewer than `TURNS` times."""
    run = ensemble.subset(members)
    _, times, _ = run_with_crossings(run, periods, progress=progress)
    ensemble.absorb(run, members)
    settled.waited[members] += periods
    count = np.isfinite(times).sum(axis=0)
    turn = np.full(members.size, np.nan)
    for k in np.flatnonzero((count >= TURNS) & run.running):
        turn[k] = (times[count[k] - 1, k] - times[0, k]) / (count[k] - 1)
    return turn


def _moves(ensemble: Ensemble, members: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Whether the rates still carry a state anywhere in a typical time, beyond rounding."""
    x, period = ensemble.x[:, members], ensemble.period[members]
    evaluate = Evaluator.of(ensemble.model, ensemble.values[:, members], jacobian=False)
    rates = np.abs(evaluate(0.0, x, np.arange(members.size))[0])
    size = scales(ensemble.model, period, np.zeros_like(x), np.abs(x)) / FLOOR
    return np.asarray((rates * period > STILL * size).any(axis=0))


def check_steps(ensemble: Ensemble, progress: Callable[[int], None] | None = None) -> bool:
    """Give points the steps that their motion asks for where they stand, in place; returns whether any took more."""
    if ensemble.accuracy is None:
        return False
    members = np.flatnonzero(ensemble.running)
    steps, _ = _steps_of_settled(ensemble, members, np.zeros(ensemble.points, dtype=np.int64), progress)
    more = steps > ensemble.point_steps[members]
    if more.any():
        here = members[more]
        ensemble.absorb(ensemble.subset(here, steps=steps[more]), here)
    return bool(more.any())


def sizes_of(ensemble: Ensemble, members: NDArray[np.intp], extremes: dict[str, Array], share: float = FLOOR) -> Array:
    """Sizes of the states of some points over a recorded stretch (`scales`); NaN where a point has ended."""
    low, high = (extremes[name][: ensemble.model.dimension] for name in ("minimum", "maximum"))
    magnitude = np.maximum(np.abs(low), np.abs(high))
    return scales(ensemble.model, ensemble.period[members], high - low, magnitude, share=share)


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
