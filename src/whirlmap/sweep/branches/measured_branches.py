"""What is measured of the points of branches once they are followed: multipliers down to the smallest, extremes, errors."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.branches.corrector import Corrected
from whirlmap.analysis.branches.equilibria import Equilibria
from whirlmap.analysis.branches.periodic_orbits import PeriodicOrbits
from whirlmap.analysis.branches.unknowns import Unknowns
from whirlmap.analysis.variational.periodic_schur import eigenvalues_of_products
from whirlmap.integrate.ensemble import LANES
from whirlmap.kernels.running.reference import reference_outputs
from whirlmap.sweep.points.extremes import EXTREMES

Array = NDArray[np.float64]

#: Largest change of a logarithm of a modulus, over the larger of it and one, with which segments are short enough, and most
#: times that segments and steps are doubled.
CLOSE, DOUBLINGS = 1e-9, 6
#: Orbits that are measured together.
BATCH = 8 * LANES


@dataclass(frozen=True)
class Numbers:
    """Numbers of many points.

    Attributes
    ----------
    log_modulus, argument : array, shape (point, multiplier)
    log_error : array, shape (point, multiplier)
        Change of the logarithms with the last doubling of segments and steps.
    extremes : dict of arrays, shape (state and output, point)
        Those of `EXTREMES`.
    step_error : array, shape (point,)
        What twice the steps change at the ends of the segments, over the sizes of the states.
    """

    log_modulus: Array
    argument: Array
    log_error: Array
    extremes: dict[str, Array]
    step_error: Array


def numbers(points: Sequence[Corrected]) -> Numbers:
    """Measure points; those of the same equations are computed together."""
    count = len(points)
    widest = max(len(p.exponents[0]) for p in points)
    model = points[0].equations.system.model  # type: ignore[attr-defined]
    rows = model.dimension + len(model.outputs)
    log, angle, error = (np.full((count, widest), np.nan) for _ in range(3))
    step_error, extremes = np.full(count, np.nan), {name: np.full((rows, count), np.nan) for name in EXTREMES}
    kinds: dict[tuple[int, int], list[int]] = {}
    for k, p in enumerate(points):
        kinds.setdefault((id(p.equations), len(p.point.x)), []).append(k)
    for members in kinds.values():
        for first in range(0, len(members), BATCH):
            at = members[first : first + BATCH]
            some = [points[k] for k in at]
            width = len(some[0].exponents[0])
            equations = some[0].equations
            if isinstance(equations, PeriodicOrbits):
                found = multipliers(equations, some)
                here = _extremes(equations, some)
                step_error[at] = equations.step_error([p.point for p in some], [p.linear.weights for p in some])
            else:
                assert isinstance(equations, Equilibria)
                logs, angles = (np.array([p.exponents[i] for p in some]) for i in (0, 1))
                found, here = (logs, angles, np.zeros_like(logs)), _at_rest(equations, some)
            for whole, part in zip((log, angle, error), found, strict=True):
                whole[at, :width] = part
            for name in EXTREMES:
                extremes[name][:, at] = here[name]
    return Numbers(log, angle, error, extremes, step_error)


def multipliers(orbits: PeriodicOrbits, points: Sequence[Corrected]) -> tuple[Array, Array, Array]:
    """Logarithms of moduli, arguments, and the last change of the former, each of shape (point, multiplier).

    Notes
    -----
    As in `floquet_multipliers`: the orbits are cut into segments whose matrices are never multiplied; segments and steps are
    doubled until no logarithm of a modulus changes by more than `CLOSE` of the larger of itself and one [lust2001].
    """
    now = [p.point for p in points]
    logs, angles = _exponents(orbits, now)
    error = np.full_like(logs, np.inf)
    left = np.arange(len(points))
    for _ in range(DOUBLINGS):
        orbits = replace(orbits, steps=2 * orbits.steps)
        now = orbits.divided(now, 2 * len(now[0].x))
        finer, angles[left] = _exponents(orbits, now)
        change = np.abs(finer - logs[left])
        change[np.isneginf(finer) & np.isneginf(logs[left])] = 0.0
        stalled = ~(change < error[left]).any(axis=1)
        logs[left], error[left] = finer, change
        done = np.asarray(stalled | (change <= CLOSE * np.maximum(1.0, np.abs(finer))).all(axis=1))
        now = [p for p, stop in zip(now, done, strict=True) if not stop]
        left = left[~done]
        if not left.size:
            break
    return logs, angles, error


def _exponents(orbits: PeriodicOrbits, points: Sequence[Unknowns]) -> tuple[Array, Array]:
    found = orbits.linear(points)
    if orbits.periods:
        return eigenvalues_of_products(np.stack([linear.matrices for linear in found]))
    logs, angles = eigenvalues_of_products(np.stack([orbits.across(linear) for linear in found]))
    return logs[:, :-1], angles[:, :-1]


def _extremes(orbits: PeriodicOrbits, points: Sequence[Corrected]) -> dict[str, Array]:
    """Extremes, mean and rms over one return of each orbit, of states and outputs, from those of its segments."""
    runs = orbits.lanes([p.point for p in points])
    found = orbits.extremes(orbits.ensemble(runs), runs, between=True)
    count = len(points)
    shares = [found[name].reshape(found[name].shape[0], count, -1) for name in ("minimum", "maximum", "mean", "rms")]
    low, high, mean, rms = shares
    whole = mean.mean(axis=2)
    spread = np.sqrt((rms**2 + (mean - whole[:, :, None]) ** 2).mean(axis=2))
    return {"minimum": low.min(axis=2), "maximum": high.max(axis=2), "mean": whole, "rms": spread}


def _at_rest(equations: Equilibria, points: Sequence[Corrected]) -> dict[str, Array]:
    x = np.concatenate([p.point.x for p in points]).T
    values = equations.columns(np.stack([p.point.free for p in points], axis=1))
    rows = np.concatenate([x, np.asarray(reference_outputs(equations.system.model)(x, values)).reshape(-1, x.shape[1])])
    return {"minimum": rows, "maximum": rows, "mean": rows, "rms": np.zeros_like(rows)}
