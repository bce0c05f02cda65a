"""Steps and segments that hold the accuracy of an orbit: as many as it needs, and no more."""

from collections.abc import Generator, Sequence
from dataclasses import replace
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.branches.corrector import Ask, Corrected, Lost, along_parameter, correct
from whirlmap.analysis.branches.periodic_orbits import LONGEST, PeriodicOrbits
from whirlmap.analysis.branches.segments import Lanes
from whirlmap.analysis.branches.unknowns import Unknowns
from whirlmap.analysis.periodic_orbits.newton import wrapped
from whirlmap.kernels.writing.routine import LANES

Array = NDArray[np.float64]

#: Steps per T of orbits, or per return, that are tried.
STEPS = (16, 32, 48, 64, 96, 128, 192, 256, 384, 512, 768, 1024, 1536, 2048, 3072, 4096, 8192)
#: States of all segments up to which an orbit takes as many segments as a block has lanes, for these cost the same. Beyond,
#: the dense solver of NumPy starts threads, which cost more than they gain.
WIDEST = 96
#: Part of an error to which two more rungs of steps must bring it at least; else the fewest steps are taken that
#: do about as well: what is left is rounding, and differs from orbit to orbit. A larger error is none: a fast state is not
#: stable with so few steps.
HELPS, ROUNDED = 0.5, 1e-4
#: Part of an error of tangent vectors that counts as one of the orbit.
OF_TANGENTS = 0.01
#: Tangent vectors whose error counts beside the orbit's.
TANGENTS = 2
#: An error so much smaller than asked for allows fewer steps.
SPARE = 1e-3
#: Least size of a state along a branch, over that at its first point.
LEAST = 0.1


def coarser(b: Corrected, accuracy: float) -> Corrected:
    """The same point to go on from with fewer steps, where its own hold far more than the accuracy."""
    orbits = b.equations
    if not isinstance(orbits, PeriodicOrbits) or b.step_error is None or b.step_error > SPARE * accuracy:
        return b
    fewer = [s for s in STEPS if s < orbits.steps and s * max(orbits.periods, 1) % len(b.point.x) == 0]
    return replace(b, equations=replace(orbits, steps=fewer[-1]), step_error=None) if fewer else b


def fine_enough(
    b: Corrected, accuracy: float, *, stays: bool = False
) -> Generator[Ask, Corrected | Lost, tuple[Corrected, set[str]]]:
    """The same point with segments and steps that hold its accuracy, and what could not be had.

    Segments come first: what rounding becomes in one that stretches too much, no step takes away. ``stays``: the free
    parameter stays, where else the point may move across the branch.
    """
    doubts: set[str] = set()
    b = yield from _in_segments(b)
    tried: list[tuple[float, Corrected]] = []
    while isinstance(orbits := b.equations, PeriodicOrbits):
        # An orbit at rest is exact with any steps, and its multipliers are not. Beside a kink they change with the orbit.
        tangents = 0 if orbits.has_surfaces else min(TANGENTS, b.point.x.shape[1])
        error = float(step_error(orbits, [b.point], [b.linear.weights], tangents=tangents)[0])
        b = replace(b, step_error=error)
        if error <= accuracy:
            break
        tried.append((error, b))
        if len(tried) > 2 and error > HELPS * tried[-3][0] and error < ROUNDED:
            least = min(each for each, _ in tried)
            b = next(c for each, c in tried if each <= least / HELPS**2)
            break
        more = [s for s in STEPS if s > orbits.steps and s * max(orbits.periods, 1) % len(b.point.x) == 0]
        if not more:
            doubts.add("the accuracy is not met with the most steps")
            break
        normal = along_parameter(b.point) if stays else b.tangent / b.linear.sizes
        found = yield Ask(replace(orbits, steps=more[0]), b.point, normal, b.linear.sizes)
        if isinstance(found, Lost):
            doubts.add("the accuracy is not met with the steps of the point before")
            break
        b = found
    return replace((yield from _in_segments(b)), step_error=b.step_error), doubts


def with_more_steps(a: Corrected, b: Corrected) -> Generator[Ask, Corrected | Lost, Corrected | None]:
    """A point with the steps of a later one, where these are more; else None."""
    one, other = a.equations, b.equations
    if not isinstance(one, PeriodicOrbits) or not isinstance(other, PeriodicOrbits) or other.steps <= one.steps:
        return None
    if other.steps_of_return % len(a.point.x):
        return None
    found = yield Ask(replace(one, steps=other.steps), a.point, a.tangent / a.linear.sizes, a.linear.sizes)
    return None if isinstance(found, Lost) else found


def _in_segments(b: Corrected) -> Generator[Ask, Corrected | Lost, Corrected]:
    """The same point in segments that do not stretch too much."""
    while too_long(b):
        finer = yield from divided(b)
        if finer is b:
            break
        b = finer
    return b


def too_long(c: Corrected) -> bool:
    """Whether segments of an orbit stretch too much, or are fewer than the lanes of a block, and few unknowns."""
    orbits = c.equations
    if not isinstance(orbits, PeriodicOrbits) or orbits.steps_of_return % (2 * len(c.point.x)):
        return False
    if len(c.point.x) < LANES and 2 * c.point.x.size <= WIDEST:
        return True
    return bool(np.linalg.norm(c.linear.matrices, axis=(1, 2)).max() > LONGEST)


def divided(b: Corrected) -> Generator[Ask, Corrected | Lost, Corrected]:
    """The same orbit in twice as many segments."""
    orbits, count = b.equations, 2 * len(b.point.x)
    assert isinstance(orbits, PeriodicOrbits)
    (point,) = in_segments(orbits, [b.point], count)
    n = b.point.x.shape[1]
    rest = b.tangent.size - b.point.x.size
    normal, sizes = np.zeros(point.vector.size), np.ones(point.vector.size)
    normal[:n], normal[-rest:] = b.tangent[:n] / b.linear.sizes[:n], b.tangent[-rest:] / b.linear.sizes[-rest:]
    sizes[: count * n], sizes[-rest:] = np.tile(b.linear.sizes[:n] * sqrt(2), count), b.linear.sizes[-rest:]
    found = yield Ask(orbits, point, normal / np.linalg.norm(normal), sizes)
    return b if isinstance(found, Lost) else found


def finished(c: Corrected, accuracy: float) -> tuple[Corrected, set[str]]:
    """A first point with segments and steps that hold the accuracy, and least sizes for its branch; and what is in doubt."""
    run = fine_enough(c, accuracy, stays=True)
    answer: Corrected | Lost | None = None
    while True:
        try:
            (answer,) = correct([run.send(answer)])  # type: ignore[arg-type]  # a generator begins with None
        except StopIteration as stop:
            c, doubts = stop.value
            break
    if isinstance(orbits := c.equations, PeriodicOrbits) and orbits.floor is None:
        c = replace(c, equations=replace(orbits, floor=LEAST * c.linear.weights[: c.point.x.shape[1]]))
    return c, doubts


def step_error(orbits: PeriodicOrbits, points: Sequence[Unknowns], sizes: Sequence[Array], *, tangents: int = 0) -> Array:
    """What twice the steps change at the ends of the segments, at most, over the sizes of the states: shape (point,).

    Where there are ``tangents``, what they change of these counts for a hundredth, over the longest. They begin along
    all states: steps at which a fast one is not stable are seen by them, and not by an orbit that does not move it.
    """
    runs, n = Lanes.of(points), orbits.system.model.dimension
    scale = np.stack([s[:n] for s in sizes], axis=1)[:, runs.orbit]
    coarse, fine = (orbits.ensemble(runs, finer=f, tangents=tangents) for f in (1, 2))
    for e in (coarse, fine):
        e.vectors[:] = scale * np.sign(np.cos(np.pi * np.outer(np.arange(tangents), np.arange(n))))[:, :, None]
        orbits.run(e, runs)
    apart = np.abs(wrapped(coarse.x - fine.x, orbits.cyclic) / scale).max(axis=0)
    if tangents:
        length = np.abs(fine.vectors / scale).max(axis=(0, 1))
        moved = np.abs((coarse.vectors - fine.vectors) / scale).max(axis=(0, 1))
        apart = np.maximum(apart, OF_TANGENTS * moved / np.maximum(length, 1.0))
    apart[~(coarse.running & fine.running)] = np.inf
    return np.array([apart[runs.orbit == k].max() for k in range(len(points))])


def in_segments(orbits: PeriodicOrbits, points: Sequence[Unknowns], segments: int) -> list[Unknowns]:
    """The same orbits in so many segments, a multiple of those that they have."""
    out: list[list[Array]] = [list(p.x) for p in points]
    while len(out[0]) < segments:
        halves = [Unknowns(np.array(x), p.free, p.duration) for x, p in zip(out, points, strict=True)]
        runs = Lanes.of(halves)
        e = orbits.ensemble(runs)
        parts = 2 * runs.share
        if orbits.periods:
            e.advance(np.full(e.points, orbits.periods), parts=parts)
        else:
            e.advance(1, parts=2)
        middle = [e.x[:, runs.orbit == k].T for k in range(len(points))]
        out = [[y for pair in zip(x, m, strict=True) for y in pair] for x, m in zip(out, middle, strict=True)]
    return [Unknowns(np.array(x), p.free, p.duration) for x, p in zip(out, points, strict=True)]
