"""Choice of the steps per T of each point: the lowest rung of a ladder of steps that meets the asked accuracy.

The error of a rung is measured, not estimated from the method: the largest difference, at the ends of all T of one common
period, between a run with that rung's steps and a run with the next one's. The lowest rung whose error is small enough is
the point's own: it depends on its model, parameters, start and the asked accuracy alone, never on its neighbours.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from whirlmap.equations.model import Model
from whirlmap.errors import counted
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.rung_runs import RungRuns

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Steps per T that are tried.
LADDER = (6, 8, 10, 12, 16, 20, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512, 768, 1024)
#: More of them for models without forcing: a relaxation cycle passes its fast turn in a small part of T.
BEYOND = (1536, 2048, 3072, 4096, 6144, 8192)
RUNGS = LADDER + BEYOND

#: A divergence is believed where all rungs up to so many times more steps find it.
DIVERGES = 4
#: Where the error falls by less than this from a rung to the one at least twice as high, the method has lost its order.
STALLED = 4.0
#: The same at the end of the ladder, where no method that keeps its order falls as slowly.
SLOW = 8.0
#: The rung from which on a lost order is believed: below it the steps may only be too long for any order to show.
BELIEVED = 48
#: Steps of a point whose method has lost its order: between steps a corner moves by their error, and with 64 of them that
#: shakes a periodic orbit of the dead zone by 2e-4, which its tangent vector takes for chaos.
KINKED = 256


class StepVerdict(IntEnum):
    """Whether a point's steps meet the asked accuracy."""

    met = 0
    nonsmooth = 1
    stiff = 2

    def advice(self, model: Model) -> str:
        """What the verdict means, and what to try; a model without a fixed film arc is told nothing about arcs."""
        fixed = model.switches.get("arc") == "fixed"
        near, instead = (" (with the fixed film arc, close to the bearing's centre)", "the arc of positive pressure, or ")
        return {
            StepVerdict.met: "the asked accuracy is met",
            StepVerdict.nonsmooth: "the error falls slowly with the steps: the right-hand side is not smooth along this"
            f" orbit{near if fixed else ''}; try {instead if fixed else ''}less accuracy",
            StepVerdict.stiff: "the highest rung of the ladder is not enough: the system is too stiff here for an explicit"
            " method; try more steps by hand, less stiffness, or a lower accuracy",
        }[self]


def doubtful(verdicts: NDArray[np.int8], model: Model) -> str:
    """Say how many points do not meet the accuracy, and what to try; empty where all do."""
    counts = {v: int((verdicts == v).sum()) for v in StepVerdict if v != StepVerdict.met}
    every = counted(verdicts.size, "point")
    return "; ".join(f"{count} of {every}: {v.advice(model)}" for v, count in counts.items() if count)


@dataclass(frozen=True)
class Rungs:
    """Steps of every point.

    Attributes
    ----------
    steps : array of int, shape (point,)
        Steps per T.
    error : array, shape (point,)
        Measured error of these steps over one common period; NaN where no two rungs could be compared.
    verdict : array of int, shape (point,)
        `StepVerdict`.
    first : array, shape (point,)
        Error of the rung that was tried first.
    size : array, shape (state, point)
        Size of the motion that was tried (`motion_sizes`).
    """

    steps: Integers
    error: Array
    verdict: NDArray[np.int8]
    first: Array
    size: Array


def choose_steps(
    ensemble: Ensemble,
    accuracy: float,
    *,
    members: NDArray[np.intp] | None = None,
    least: Integers | None = None,
    sections: int = 1,
    span: int = 1,
    observe: Callable[[Ensemble, int], Array] | None = None,
    goes_on: NDArray[np.bool_] | None = None,
    highest: int | None = None,
    progress: Callable[[int], None] | None = None,
) -> Rungs:
    """Find the rung of every point from its present state; the ensemble is not moved.

    Parameters
    ----------
    accuracy : float
        Largest error over one common period (of an unforced model: one typical time), for each state relative to its
        range over it, or to the largest of those that it is alike to (`scales`).
    members : array of int, optional
        Indices of the points; all of them where absent. The result is theirs, in their order.
    least : array of int, optional
        Steps of each of them that are tried first, a rung; the lowest where absent.
    sections : int
        Successive common periods, from the present state on and as they are integrated, over each of which the error counts:
        the largest is met.
    span : int
        Common periods of each run.
    observe : callable, optional
        ``observe(ensemble, periods)`` runs points on and gives numbers of their motion, shape (number, point), whose
        differences count as well: times over T at which a section is crossed, for a motion that stands still between fast
        turns shows its errors there. NaN where there are no more of them.
    goes_on : array of bool, optional
        Members whose motion is known to go on, for it has been run there with more steps: no divergence of them is believed.
    highest : int, optional
        Highest rung; that of `LADDER` where absent, of an unforced model that of `BEYOND`.

    Notes
    -----
    A run on a rung does not redo failed steps: a point that fails on a rung tries the next one. A point that ends in contact
    on two rungs running, at times that differ by less than the accuracy of one T, takes the first; one that diverges, within
    some steps (`ALIKE`) of the same time on all rungs from one to another `DIVERGES` times as high, takes the latter. A
    point that has lost its order goes on to `KINKED` steps, or to the accuracy.
    """
    members = np.arange(ensemble.points) if members is None else members
    n = members.size
    ladder: tuple[int, ...] = LADDER if ensemble.model.forced else RUNGS
    ladder = ladder[: ladder.index(highest) + 1] if highest is not None else ladder
    known = np.zeros(n, dtype=bool) if goes_on is None else goes_on
    first = np.zeros(n, dtype=np.intp)
    if least is not None:
        first = np.searchsorted(ladder[:-1], least).clip(max=len(ladder) - 2)
    steps = np.array(ladder, dtype=np.int64)[first]
    error, verdict = np.full(n, np.nan), np.zeros(n, dtype=np.int8)
    since = np.full(n, np.inf)  # steps from which on all rungs diverge alike
    begun, size = np.full(n, np.nan), np.full((ensemble.model.dimension, n), np.nan)
    running = ensemble.running[members]
    verdict[running] = StepVerdict.stiff
    history, kinked = np.full((len(ladder), n), np.nan), np.zeros(n, dtype=bool)
    runs = RungRuns(ensemble, members, sections, span, observe, progress)
    if least is not None:  # most points meet it with the steps that they have: all of these in two runs
        at = np.flatnonzero(running)
        own, finer = (runs.run(at, np.array(ladder)[first[at] + k]) for k in (0, 1))
        found, away = own.difference(finer)
        met = ~away & (found <= accuracy)
        error[at[met]] = begun[at[met]] = found[met]
        verdict[at[met]], size[:, at[met]] = StepVerdict.met, finer.largest()[:, met]
        running[at[met]] = False
    left, before = np.zeros(0, dtype=np.intp), None
    for i, rung in enumerate(ladder[1:]):
        entering = np.flatnonzero(running & (first == i))
        if entering.size:
            new = runs.run(entering, ladder[i])
            left, before = np.concatenate([left, entering]), new if before is None else before.joined(new)
        if not left.size or before is None:
            continue
        now = runs.run(left, rung)
        found, away = before.difference(now)
        # A method that is unstable diverges at about the same time with any steps, up to those with which it is not.
        since[left] = np.where(away, np.minimum(since[left], ladder[i]), np.inf)
        found[away & (known[left] | (ladder[i] < DIVERGES * since[left]))] = np.inf
        history[i, left] = error[left] = found
        begun[left], size[:, left] = np.where(first[left] == i, found, begun[left]), now.largest()
        steps[left] = ladder[i]
        good = found <= accuracy
        kinked[left] |= _stalled(history[:, left], i)
        stalled = kinked[left] & ~good & (ladder[i] >= KINKED)
        verdict[left[good]], verdict[left[stalled]] = StepVerdict.met, StepVerdict.nonsmooth
        if rung == ladder[-1]:
            rough = ~good & _stalled(history[:, left], i, SLOW)
            verdict[left[rough]] = StepVerdict.nonsmooth
        stay = ~good & ~stalled
        steps[left[stay]] = rung
        left, before = left[stay], now.keep(np.flatnonzero(stay))
    return Rungs(steps, error, verdict, begun, size)


def _stalled(history: Array, i: int, least: float = STALLED) -> NDArray[np.bool_]:
    """Whether the error has fallen by less than that since a rung at most half as high."""
    half = max((j for j in range(i) if 2 * RUNGS[j] <= RUNGS[i]), default=None)
    if half is None or RUNGS[i] < BELIEVED:
        return np.zeros(history.shape[1], dtype=bool)
    slow: NDArray[np.bool_] = history[half] < least * history[i]
    return slow & np.isfinite(history[i])
