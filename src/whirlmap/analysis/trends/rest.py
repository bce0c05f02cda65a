"""Motion at rest or approaching rest: an equilibrium at all phases of the forcing that attracts the motion.

A small motion is no rest by its size alone, for a forced one may be small beside its start. At rest the rates must vanish: a
forced model comes to rest only where its forcing has no amplitude, or is parametric.
"""

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.variational.monodromy import largest_multipliers
from whirlmap.integrate.division import variants
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.equilibrium import equilibrium
from whirlmap.integrate.evaluation import Evaluator

Array = NDArray[np.float64]
Points = NDArray[np.intp]

#: Phases of the common period at which an equilibrium is tried.
PHASES, GOLDEN = 16, (5**0.5 - 1) / 2
#: Rates at an equilibrium over those where the motion is, and where it was or their terms are large, that count as zero.
ZERO, ROUNDING = 1e-6, 1e-12
#: Growth over the time in which the forcing repeats below which an equilibrium does not repel; and over a test run where the
#: forcing does not repeat, for small motions breathe.
NEUTRAL, DIES = 1e-9, -3.0


def resting_places(
    ensemble: Ensemble, points: Points, ranges: Array, moved: Array, reach: Array | None = None
) -> tuple[Array, NDArray[np.bool_]]:
    """Equilibria near which some points are, and whether they are there at all phases.

    Parameters
    ----------
    ensemble : Ensemble
        Stays as it is.
    ranges : array, shape (state, points)
        How far each state moves now: what that does to the rates says what a small one is.
    moved : array, shape (state, points)
        How far each state has moved since the start: what that does to the rates says what their rounding is.
    reach : array, shape (state, points), optional
        How far from the present states equilibria are sought; ``moved`` where absent.

    Returns
    -------
    x : array, shape (state, points)
        The equilibrium that Newton's method finds from the present state; where it finds none near it, that state.
    there : array of bool, shape (points,)
    """
    values, now = ensemble.values[:, points], ensemble.x[:, points]
    place, found = equilibrium(ensemble.model, values, now)
    close = (np.abs(place - now) <= (moved if reach is None else reach) + ROUNDING * np.abs(now)).all(axis=0)
    x = np.where(found & close, place, now)
    there = np.zeros(points.size, dtype=bool)
    sizes = (ZERO, ranges), (ROUNDING, moved)
    times = _times(ensemble, points)
    for form, members in variants(ensemble.model, values):
        evaluate = Evaluator.of(form, values[:, members], jacobian=True)
        here, least = (np.zeros((x.shape[0], members.size)) for _ in range(2))
        local = np.arange(members.size)
        for time in times:
            rates, jacobian = evaluate(time[members], x[:, members], local)
            here = np.maximum(here, np.abs(rates))
            least = np.maximum(least, ROUNDING * np.einsum("ijk,jk->ik", np.abs(jacobian), np.abs(x[:, members])))
            for share, size in sizes:
                away = size[:, members]
                beside = np.abs(evaluate(time[members], x[:, members] + away, local)[0])
                beside = np.maximum(beside, np.einsum("ijk,jk->ik", np.abs(jacobian), away))
                least = np.maximum(least, share * beside)
        there[members] = (here <= least).all(axis=0)
    return x, there


def _times(ensemble: Ensemble, points: Points) -> Array:
    """Times in a common period at which a forced model is evaluated, shape (phase, points)."""
    # Spaced by the golden section: evenly spaced ones would meet a harmonic at few phases of its own.
    phases = np.arange(PHASES if ensemble.model.forced else 1) * GOLDEN % 1
    return np.asarray(phases[:, None] * (ensemble.common_multiple * ensemble.period[points]))


def carried(ensemble: Ensemble, points: Points) -> Array:
    """How far the rates beside a place carry each state in a common period (`Ensemble.strobe`), shape (state, points).

    What keeps a motion where it is, dry friction or a stop, holds against this. It is the rates there times the time, and
    what that does to the rates, so that it counts for a position too, whose own rate is zero.
    """
    values, x = ensemble.values[:, points], ensemble.x[:, points]
    period, times = ensemble.strobe * ensemble.period[points], _times(ensemble, points)
    out = np.zeros_like(x)
    for form, members in variants(ensemble.model, values):
        evaluate, local = Evaluator.of(form, values[:, members], jacobian=True), np.arange(members.size)
        for time in times:
            rates, jacobian = evaluate(time[members], x[:, members], local)
            once = np.abs(rates) * period[members]
            then = np.einsum("ijk,jk->ik", np.abs(jacobian), once) * period[members]
            out[:, members] = np.maximum(out[:, members], once + then)
    return out


def rate_of_rest(ensemble: Ensemble, points: Points, x: Array) -> Array:
    """Rate at which small motions about equilibria change, per unit of time (negative: they die away).

    Parameters
    ----------
    x : array, shape (state, points)
        The equilibria.

    Returns
    -------
    array, shape (points,)
        Infinite where the equilibrium repels, or where that is not known.

    Notes
    -----
    Where the Jacobian does not change with time it is the largest real part of its eigenvalues; else it comes from the
    largest multiplier over a common period, which is no more accurate than the steps. Forcing without a reasonable common
    period has no multipliers: the same number over `Ensemble.rung_periods` gives the rate, where it falls clearly.
    """
    rounds = 1 if ensemble.returns else ensemble.rung_periods
    time = rounds * ensemble.strobe * ensemble.period[points]
    growth = _largest_real_part(ensemble, points, x) * time
    moving = np.isnan(growth)
    if moving.any():
        largest = largest_multipliers(ensemble, points[moving], np.full(moving.sum(), rounds), x[:, moving])
        growth[moving] = np.log(np.maximum(largest, np.finfo(float).tiny))
    most = np.where(moving & (not ensemble.returns), DIES, NEUTRAL)
    return np.asarray(np.where(growth <= most, growth / time, np.inf))


def _largest_real_part(ensemble: Ensemble, points: Points, x: Array) -> Array:
    """Largest real part of the Jacobian's eigenvalues at some states; NaN where the Jacobian changes with time.

    No steps are taken, so that it is right where small motions die away faster than the steps can follow.
    """
    values, out = ensemble.values[:, points], np.full(points.size, np.nan)
    times = _times(ensemble, points)
    for form, members in variants(ensemble.model, values):
        evaluate, local = Evaluator.of(form, values[:, members], jacobian=True), np.arange(members.size)
        whole = np.stack([evaluate(time[members], x[:, members], local)[1] for time in times])
        steady = (np.ptp(whole, axis=0) <= ROUNDING * np.abs(whole).max(axis=0)).all(axis=(0, 1))
        if steady.any():
            matrices = whole[0][:, :, steady].transpose(2, 0, 1)
            out[members[steady]] = np.linalg.eigvals(matrices).real.max(axis=1)
    return out
