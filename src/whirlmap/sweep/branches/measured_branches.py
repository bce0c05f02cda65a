"""What is measured of the points of branches once they are followed: multipliers down to the smallest, extremes, errors."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.branches.corrector import Corrected
from whirlmap.analysis.branches.equilibria import Equilibria
from whirlmap.analysis.branches.event_curves import EventCurve
from whirlmap.analysis.branches.orbit_steps import in_segments, step_error
from whirlmap.analysis.branches.periodic_orbits import PeriodicOrbits
from whirlmap.analysis.branches.segments import Lanes
from whirlmap.analysis.branches.unknowns import Unknowns
from whirlmap.analysis.variational.periodic_schur import eigenvalues_of_products
from whirlmap.integrate.ensemble import LANES
from whirlmap.kernels.running.reference import reference_outputs
from whirlmap.sweep.points.extremes import EXTREMES

Array = NDArray[np.float64]

#: Largest change of a logarithm of a modulus, over the larger of it and one, with which segments and steps are short enough,
#: and most times that each are doubled.
CLOSE, DOUBLINGS, REFINED = 1e-9, 8, 3
#: Orbits that are measured together, and segments of them that are run at a time with all tangent vectors.
BATCH, MOST_LANES = 8 * LANES, 512


@dataclass(frozen=True)
class Numbers:
    """Numbers of one point.

    Attributes
    ----------
    log_modulus, argument : array, shape (multiplier,)
    log_error : array, shape (multiplier,)
        Change of the logarithms with the last doubling of the steps.
    extremes : mapping of str to array, shape (state and output,)
        Those of `EXTREMES`.
    step_error : float
        What twice the steps change at the ends of the segments, over the sizes of the states.
    section : array, shape (period, state)
        States at each T, the first at phase zero; of cycles and at rest the first alone.
    duration : float
        Time of one return; zero at rest.
    steps : int
        Steps per T, or in one return of a cycle; zero at rest.
    """

    log_modulus: Array
    argument: Array
    log_error: Array
    extremes: Mapping[str, Array]
    step_error: float
    section: Array
    duration: float
    steps: int


class Measuring:
    """Measures points, each once: some of them already while branches are followed, so that who stops need not wait."""

    def __init__(self) -> None:
        self._known: dict[int, tuple[Corrected, Numbers]] = {}  # with the point, so that no other has its identity

    def __call__(self, points: Sequence[Corrected]) -> list[Numbers]:
        """Numbers of points, those of the same equations computed together."""
        kinds: dict[tuple[Any, ...], list[Corrected]] = {}
        for p in self.missing(points):
            kinds.setdefault((*p.equations.key, len(p.point.x)), []).append(p)
        for same in kinds.values():
            for first in range(0, len(same), BATCH):
                some = same[first : first + BATCH]
                for p, found in zip(some, _measured(some), strict=True):
                    self._known[id(p)] = p, found
        return [self._known[id(p)][1] for p in points]

    def missing(self, points: Sequence[Corrected]) -> list[Corrected]:
        """Points that were not measured yet."""
        return list({id(p): p for p in points if id(p) not in self._known}.values())


def _measured(points: Sequence[Corrected]) -> list[Numbers]:
    """Measure points of the same equations; those of a curve of events as the orbits that they are."""
    equations, own = points[0].equations, [p.point for p in points]
    if isinstance(equations, EventCurve):
        equations = equations.orbits
    if isinstance(equations, PeriodicOrbits):
        found, extremes = multipliers(equations, points), _extremes(equations, points)
        section, errors = _once_per_T(equations, own), step_error(equations, own, [p.linear.weights for p in points])
        durations, steps = equations.durations(own), equations.steps
    else:
        assert isinstance(equations, Equilibria)
        logs, angles = (np.array([p.exponents[i] for p in points]) for i in (0, 1))
        found, extremes = (logs, angles, np.zeros_like(logs)), _at_rest(equations, points)
        section, errors = [p.x for p in own], np.full(len(own), np.nan)
        durations, steps = np.zeros(len(own)), 0
    return [
        Numbers(
            found[0][k], found[1][k], found[2][k], {name: extremes[name][:, k] for name in EXTREMES}, float(errors[k]),
            section[k], float(durations[k]), steps,
        )
        for k in range(len(points))
    ]


def multipliers(orbits: PeriodicOrbits, points: Sequence[Corrected]) -> tuple[Array, Array, Array]:
    """Logarithms of moduli, arguments, and the error of the former, each of shape (point, multiplier).

    Notes
    -----
    As in `floquet_multipliers`: the orbits are cut into segments whose matrices are never multiplied [lust2001]. Segments
    are doubled until no logarithm of a modulus changes by more than `CLOSE` of the larger of itself and one, then the steps;
    the error is the last change.
    """
    now = [p.point for p in points]
    logs, angles = _exponents(orbits, now)
    for _ in range(DOUBLINGS):
        count = 2 * len(now[0].x)
        if orbits.steps_of_return % count:
            break
        now = in_segments(orbits, now, count)
        finer, angles = _exponents(orbits, now)
        change, logs = _change(finer, logs), finer
        if change.max() <= CLOSE:
            break
    error = np.full_like(logs, np.inf)
    for _ in range(REFINED):
        orbits = replace(orbits, steps=2 * orbits.steps)
        finer, angles = _exponents(orbits, now)
        change, logs = _change(finer, logs), finer
        stalled = not (change < error).any()
        error = change * np.maximum(1.0, np.abs(np.where(np.isfinite(logs), logs, 1.0)))
        if change.max() <= CLOSE or stalled:
            break
    return logs, angles, error


def _change(finer: Array, before: Array) -> Array:
    """Change of logarithms, over the larger of themselves and one."""
    same = np.isneginf(finer) & np.isneginf(before)
    with np.errstate(invalid="ignore"):
        apart = np.abs(finer - before) / np.maximum(1.0, np.abs(finer))
    return np.where(same, 0.0, np.nan_to_num(apart, nan=np.inf))


def _exponents(orbits: PeriodicOrbits, points: Sequence[Unknowns]) -> tuple[Array, Array]:
    each = max(MOST_LANES // len(points[0].x), 1)
    found = [linear for k in range(0, len(points), each) for linear in orbits.linear(points[k : k + each])]
    if orbits.periods:
        return eigenvalues_of_products(np.stack([linear.matrices for linear in found]))
    logs, angles = eigenvalues_of_products(np.stack([orbits.across(linear) for linear in found]))
    return logs[:, :-1], angles[:, :-1]


def _once_per_T(orbits: PeriodicOrbits, points: Sequence[Unknowns]) -> list[Array]:
    """States of orbits at each T from phase zero on, shape (period, state) of each; of cycles the first alone."""
    if not orbits.periods:
        return [p.x[:1] for p in points]
    places = [np.arange(orbits.periods) * len(p.x) // orbits.periods for p in points]
    orbit = np.repeat(np.arange(len(points)), orbits.periods)
    place, share = np.concatenate(places), np.array([len(p.x) for p in points])[orbit]
    runs = Lanes(
        np.concatenate([p.x[at] for p, at in zip(points, places, strict=True)]).T,
        np.stack([p.free for p in points], axis=1)[:, orbit], orbit, place, share, np.full(orbit.size, np.nan),
    )  # fmt: skip
    e = orbits.ensemble(runs)
    beyond = np.tile(np.arange(orbits.periods), len(points)) * share - orbits.periods * place  # parts of a T
    e.advance(beyond, parts=share)
    return [e.x[:, orbit == k].T for k in range(len(points))]


def _extremes(orbits: PeriodicOrbits, points: Sequence[Corrected]) -> dict[str, Array]:
    """Extremes, mean and rms over one return of each orbit, of states and outputs, from those of its segments."""
    runs = Lanes.of([p.point for p in points])
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
