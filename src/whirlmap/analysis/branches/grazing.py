"""Orbits that touch a declared switching without crossing it: where a contact of each turn begins or ends.

The height of the orbit over the surface is sampled at its steps; about each of its extremes a polynomial of degree 7 through
8 samples gives the extreme itself. An orbit grazes where an extreme vanishes. Its own steps show whether that happens
between two orbits; the place is found with 512 samples in each T. The orbit has no kink there, so that the polynomial is
exact to rounding.
"""

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.branches.bracketing import located
from whirlmap.analysis.branches.corrector import Ask, Corrected, Lost
from whirlmap.analysis.branches.events import Event, StepTooLongError
from whirlmap.analysis.branches.periodic_orbits import PeriodicOrbits
from whirlmap.analysis.branches.segments import Lanes
from whirlmap.equations.quantities import t
from whirlmap.kernels.lowering.formulas import Formula, numpy_function

Array = NDArray[np.float64]

#: Samples in each T with which a grazing orbit is located.
SAMPLES = 512
#: Samples through which a polynomial goes.
POINTS = 8
#: Part of a return by which an extreme may move between neighbouring points, and height over its range that is none.
MOVES, TOUCHES = 0.1, 1e-8


@dataclass(frozen=True)
class Extreme:
    """An extreme of the height over a surface: its phase in returns, its value, and whether it is a maximum."""

    phase: float
    value: float
    maximum: bool


def grazings_between(a: Corrected, b: Corrected) -> Generator[Ask, Corrected | Lost, list[Event]]:
    """Grazing orbits between two points of a branch: of each surface the first.

    An orbit over many turns has as many contacts, which begin one after the other within a narrow range: what begins or ends
    within one step counts as ``contacts`` of one event.

    Raises
    ------
    StepTooLongError
        One that is not found.
    """
    orbits = a.equations
    if not isinstance(orbits, PeriodicOrbits) or not orbits.system.model.switchings:
        return []
    events: list[Event] = []
    own = zip(orbits.system.model.switchings, extremes(a, 0), extremes(b, 0), strict=True)
    for k, (name, before, after) in enumerate(own):
        pairs = [(one, other) for one in before if (other := _like(after, one)) is not None]
        changed = [(one.value / (one.value - other.value), one) for one, other in pairs if one.value * other.value < 0]
        if not changed:
            continue
        test = _height(k, min(changed, key=lambda each: each[0])[1])
        if not test(a) * test(b) < 0:  # it was the error of the coarse samples
            continue
        at = yield from located(a, b, test)
        if at is None:
            raise StepTooLongError
        events.append(Event("grazing", at, name, len(changed)))
    return events


def _height(surface: int, like: Extreme) -> Callable[[Corrected], float]:
    def test(c: Corrected) -> float:
        found = _like(extremes(c, SAMPLES)[surface], like)
        return np.nan if found is None else found.value

    return test


def _like(among: list[Extreme], one: Extreme) -> Extreme | None:
    """The nearest extreme of the same kind."""
    same = [e for e in among if e.maximum == one.maximum]
    away = [abs((e.phase - one.phase + 0.5) % 1 - 0.5) for e in same]
    return same[int(np.argmin(away))] if same and min(away) <= MOVES else None


def extremes(c: Corrected, samples: int) -> list[list[Extreme]]:
    """Extremes of an orbit's height over each declared switching, with so many samples in each T at least."""
    assert isinstance(c.equations, PeriodicOrbits)
    surfaces = [q.surface for q in c.equations.system.model.switchings.values()]
    return [extremes_of(row) for row in heights(c, samples, "switchings", surfaces)]


def extremes_of(row: Array) -> list[Extreme]:
    """Extremes of samples at equal times of one return, each by the polynomial about it."""
    before, after = np.roll(row, 1), np.roll(row, -1)
    found = []
    for maximum, sign in ((True, 1.0), (False, -1.0)):
        for k in np.flatnonzero((sign * row >= sign * before) & (sign * row > sign * after)):
            phase, value = _refined(row, int(k))
            found.append(Extreme(phase, value, maximum))
    return found


def heights(c: Corrected, least: int, role: str, surfaces: Sequence[Any]) -> Array:
    """Height of an orbit over surfaces at equal times of one return, shape (surface, sample).

    The times are those of its steps, or of a fraction of them, at ``least`` so many in each T. ``role`` names the surfaces
    among those of the model.
    """
    orbits = c.equations
    assert isinstance(orbits, PeriodicOrbits)
    model, runs = orbits.system.model, Lanes.of([c.point])
    finer = max(-(-least // orbits.steps), 1)
    e = orbits.ensemble(runs, finer=finer)
    x = np.concatenate([runs.x[None], orbits.run(e, runs, save=True)])[:-1]
    samples = x.shape[0] * x.shape[2]
    x = x.transpose(1, 2, 0).reshape(model.dimension, samples)
    duration = float(e.period[0]) * (orbits.periods or runs.share[0])
    time = duration * np.arange(samples) / samples
    values = orbits.columns(c.point.free[:, None])[:, 0]
    of = numpy_function(model, role, lambda: Formula([t, model.states, model.parameters], surfaces))
    return np.stack([np.broadcast_to(np.asarray(row, dtype=float), time.shape) for row in of(time, list(x), list(values))])


def _refined(row: Array, k: int) -> tuple[float, float]:
    """Phase and value of an extreme near a sample."""
    place = np.arange(POINTS) - (POINTS - 1) // 2
    curve = np.polynomial.Polynomial(np.linalg.solve(np.vander(place, increasing=True), row[(k + place) % row.size]))
    slope, bend, at = curve.deriv(), curve.deriv(2), 0.0
    for _ in range(20):
        if bend(at) == 0:
            break
        step = slope(at) / bend(at)
        at -= step
        if not abs(at) <= 2:
            return k / row.size, float(row[k])
        if abs(step) < 1e-13:
            break
    return (k + at) / row.size % 1.0, float(curve(at))
