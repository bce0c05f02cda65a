"""Following branches of periodic orbits and equilibria against a parameter: `continue_orbit`."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, Literal, Unpack

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from whirlmap.analysis.branches.corrector import Ask, Lost, along_parameter, correct
from whirlmap.analysis.branches.events import Event
from whirlmap.analysis.branches.switching import APART, doubled
from whirlmap.analysis.branches.tracing import EDGE, Limits, Trace, apart_in_halves, stepping, trace
from whirlmap.errors import RangeError
from whirlmap.integrate.loading import pieces
from whirlmap.integrate.ranges import Range
from whirlmap.integrate.system import System
from whirlmap.options.computed import LABELLING, Labelling
from whirlmap.options.execution import EXECUTION, Execution
from whirlmap.options.taking import LabellingParts
from whirlmap.results.provenance import provenance
from whirlmap.results.schema import with_attributes
from whirlmap.sweep.branches.branch import Branch, rises
from whirlmap.sweep.branches.branch_dataset import dataset
from whirlmap.sweep.branches.free_parameters import FreeParameters, Varied
from whirlmap.sweep.branches.seeds import SAME, Beginning, Seed, finished
from whirlmap.sweep.interruptible import Work, in_parts

Array = NDArray[np.float64]
Direction = Literal["up", "down", "both"]

#: Starts from which coexisting motions are sought.
STARTS = 256
#: Error of the segments of orbits that steps are chosen for.
ACCURACY = 1e-12
#: Times the accuracy that an error between the points at which it is checked may be without a word.
ROUGH = 100.0


@in_parts("continue")
def continue_orbit(
    system: System,
    parameter: str,
    values: str | Range | Sequence[Any],
    *,
    begin: float | str | None = None,
    period: int | None = None,
    direction: Direction = "both",
    orbit: Mapping[str, float] | Sequence[float] | None = None,
    seeds: xr.Dataset | None = None,
    coexisting: bool = False,
    starts: int = STARTS,
    doublings: int = 0,
    points: int = 2000,
    longest: float = 0.02,
    labelling: Labelling = LABELLING,
    execution: Execution = EXECUTION,
    **_given: Unpack[LabellingParts],
) -> Work:
    """Follow branches of periodic orbits, or of equilibria, against one parameter, stable or not.

    Parameters
    ----------
    system : System
        Its values and start states count.
    parameter : str
        Name of the varied parameter, or of a dimensional input of the case.
    values : (start, stop), or str
        The range: two numbers, two texts with a unit, or ``"START:STOP"``.
    begin : float or str, optional
        Value at which the branch begins; the start of the range where absent.
    period : int, optional
        T of one return (of an unforced cycle: crossings of its section); that of the settled motion where absent.
    direction : {"up", "down", "both"}
        In which the branch is followed from its first point.
    orbit : mapping of state to number, or sequence, optional
        A state near the orbit at phase zero, of an unforced model near the equilibrium (near the cycle, where a period is
        given), from which Newton's method begins instead of from the settled motion.
    seeds : xr.Dataset, optional
        A labelled diagram or map with the section of all states, whose point at ``begin`` is the first orbit.
    coexisting : bool
        Whether all periodic attractors at ``begin`` are followed (`attractors`).
    starts : int
        Start states from which these are sought.
    doublings : int
        How many successive period doublings are followed onto their doubled branches.
    points : int
        Most points of a branch in each direction.
    longest : float
        Longest step, in units of the range and of the sizes of the states.
    labelling : Labelling, optional
        How the settled motion is found; or its parts as keywords. ``accuracy`` is also the largest error of the segments
        of an orbit, 1e-12 where absent.
    execution : Execution, optional
        How it is run, which changes no number; or its parts as keywords, ``workers``, ``progress``.

    Returns
    -------
    xr.Dataset
        Over ``point``, branch after branch: the parameter, ``branch_of``, ``arclength``, ``section(point, period, state)``,
        ``stable``, ``unstable``, ``log_modulus(point, multiplier)`` and ``argument``, extremes of states and outputs as in
        diagrams, ``steps``, ``segments``, ``step_error``, ``duration``. Over ``branch``: ``kind``, ``period_T``,
        ``first_point``, ``end(branch, side)``. Over ``event``: ``event_kind``, ``event_branch``, the parameter as
        ``event_NAME``, ``event_section``, ``event_log_modulus``, ``event_argument``, ``event_surface``.

    Raises
    ------
    RangeError
        An unknown parameter or state, a range that does not ascend, a parameter that changes the ratio of two frequencies of
        the forcing; no periodic motion to begin with, or none that Newton's method finds.
    InputError
        A unit that the quantity does not have.

    Notes
    -----
    Multiple shooting on the stroboscopic map of a forced model, on the declared section of an unforced one, followed by
    pseudo-arclength [keller1977]; the step follows Newton's iterations and the angle of the tangents. Monodromy matrices are
    those of the tangent dynamics; only the derivative by the parameter is a difference, on which no solution depends.
    Folds, branch points, period doublings, Neimark-Sacker and Hopf points and grazing orbits are located between corrected
    points of the branch. Not followed: tori, the branches that cross at a branch point, orbits that slide along a surface
    (the end is ``kink``). Two events of one kind within one step cancel and are not seen: ``longest`` makes steps shorter.

    References
    ----------
    [keller1977] pseudo-arclength. [lust2001] small multipliers. [chandrupatla1997] roots between two points.
    """
    if direction not in ("up", "down", "both"):
        raise RangeError(f"direction is up, down or both, not {direction!r}")
    if sum((orbit is not None, seeds is not None, coexisting)) > 1:
        raise RangeError("a branch begins from a given orbit, from a file, or from the attractors: give one of them")
    for name, count, least in (("points", points, 2), ("doublings", doublings, 0), ("starts", starts, 1)):
        if not least <= count <= 1_000_000:
            raise RangeError(f"{name} must lie between {least} and 1000000, not {count}")
    if period is not None and not 1 <= period <= 4096:
        raise RangeError(f"period must lie between 1 and 4096 T, not {period}")
    if not 1e-6 <= longest <= 1:
        raise RangeError(f"longest must lie between 1e-6 and 1, not {longest}")
    varied = Varied.of(system, parameter, values)
    free = FreeParameters(system, (varied,))
    value = varied.low if begin is None else varied.read(begin)
    accuracy = labelling.integration.accuracy or ACCURACY
    first = Beginning(free, (value,), labelling, execution, accuracy)
    limits = Limits(np.array([varied.low]), np.array([varied.high]), longest, points, accuracy)
    run = Branches(limits, direction, doublings)

    def parts(work: Work) -> Iterator[int]:
        if orbit is not None:
            found = first.given(orbit, period)
        elif seeds is not None:
            found = first.of_dataset(seeds)
        else:
            found = first.coexisting(starts) if coexisting else first.settled(period)
        for done in run.follow(found):
            if execution.progress:
                execution.progress(1)
            work.total = max(work.total, done + 1)
            yield done
        work.total = max(work.done, 1)
        yield work.total

    def gather(work: Work) -> xr.Dataset | None:
        if not run.branches:
            return None
        ds = dataset(system, (varied,), run.branches)
        facts = {
            "begin": value, "direction": direction, "doublings": doublings, "longest": longest, "accuracy": accuracy,
        }  # fmt: skip
        return with_attributes(ds, attributes(system, (varied,), run.branches, work, ds, accuracy) | facts)

    return BranchWork(run, parts, gather)


def attributes(
    system: System, varied: Sequence[Varied], branches: Sequence[Branch], work: Work, ds: xr.Dataset, accuracy: float
) -> dict[str, Any]:
    """Attributes of a Dataset of branches: where it comes from, what was varied, and what stopped each."""
    steps = "chosen for each orbit: see steps"
    origin = provenance(pieces(system), method="dop853", steps_per_period=steps, citations=("prince1981", "keller1977"))
    facts: dict[str, Any] = {
        "varied": " ".join(v.name for v in varied), "given": " ".join(v.given for v in varied),
        "unit_given": " ".join(v.unit or "1" for v in varied), "size_given": [v.size for v in varied],
        "range": [end for v in varied for end in (v.low, v.high)],
        "why": "; ".join(f"branch {k + 1}: {' | '.join(b.reasons())}" for k, b in enumerate(branches)),
    }  # fmt: skip
    doubts = sorted(set().union(*(b.doubts() for b in branches)))
    rough = ds["step_error"].values > ROUGH * accuracy
    if rough.any():
        doubts.append(f"the steps of {rough.sum()} points leave errors up to {ds['step_error'].values[rough].max():.1g}")
    if doubts:
        facts["doubts"] = "; ".join(doubts)
    if not work.complete:
        facts["incomplete"] = f"interrupted after {len(ds['point'])} points"
    return {**origin, **facts}


class BranchWork(Work):
    """Work that follows branches, which can be asked for as they are."""

    def __init__(self, found: "Branches", parts: Any, gather: Any) -> None:
        super().__init__(1, parts, gather)
        self.found = found


@dataclass
class Branches:
    """Branches that are followed, those of one generation side by side."""

    limits: Limits
    direction: Direction
    doublings: int
    branches: list[Branch] = field(default_factory=list)

    def follow(self, seeds: Sequence[Seed]) -> Iterator[int]:
        """Follow all branches, then those that doubled from them; gives the number of points so far."""
        new = [self._branch(seed) for seed in seeds]
        for generation in range(self.doublings + 1):
            self.branches += new
            for _ in stepping([run for branch in new for run in self._runs(branch)]):
                yield sum(len(b.points()) for b in self.branches)
            self._drop_repeated()
            if generation < self.doublings:
                new = [b for branch in new if branch in self.branches for b in self._doubled(branch)]
        self._drop_repeated()

    def events(self, kind: str) -> list[Event]:
        """Events of one kind, branch after branch."""
        return [e for branch in self.branches for _, e in branch.events() if e.kind == kind]

    def _branch(self, seed: Seed) -> Branch:
        down, up = (Trace([seed.at]) if self.direction in (way, "both") else None for way in ("down", "up"))
        edge = np.abs(seed.at.value - np.concatenate([self.limits.low, self.limits.high])).min() <= EDGE * self.limits.width
        return Branch(seed, down, up, begins="range" if edge else "start")

    def _runs(self, branch: Branch) -> list[Any]:
        sign = rises(branch.seed.at)
        halves = branch.halves
        return [
            trace(part, sign * way, self.limits, halves=halves)
            for part, way in ((branch.down, -1.0), (branch.up, 1.0)) if part is not None
        ]  # fmt: skip

    def _doubled(self, branch: Branch) -> list[Branch]:
        """Branches of doubled orbits from the period doublings of one."""
        out = []
        for _, event in branch.events():
            if event.kind != "period-doubling":
                continue
            for apart in APART:
                ask, halves = doubled(event, apart)
                (c,) = correct([ask])
                if isinstance(c, Lost):
                    continue
                distance = float(apart_in_halves(c) @ halves)
                if distance < apart / 2 or self.limits.outside(c.point).size:
                    continue
                away = 1.0 if c.tangent / c.linear.sizes @ ask.normal > 0 else -1.0
                seed = Seed(finished(c, self.limits.accuracy), 2 * branch.seed.period, c.point.x[:1].T)
                up = away * rises(seed.at) > 0
                part = Trace([seed.at])
                out.append(Branch(seed, None if up else part, part if up else None, begins="closed", halves=halves))
                break
        return out

    def _drop_repeated(self) -> None:
        """Drop branches whose first point lies on an earlier one."""
        kept: list[Branch] = []
        for branch in self.branches:
            if not any(_lies_on(branch.seed, other) for other in kept):
                kept.append(branch)
        self.branches[:] = kept


def _lies_on(seed: Seed, branch: Branch) -> bool:
    """Whether a point lies on a branch: whether the branch, at the same parameter, is at one of its phases."""
    if branch.seed.period != seed.period or branch.kind == "equilibrium" != (seed.period == 0):
        return False
    points = branch.points()
    for a, b in pairwise(points):
        if a.point.x.shape != b.point.x.shape or not min(a.value, b.value) <= seed.at.value <= max(a.value, b.value):
            continue
        part = (seed.at.value - a.value) / (b.value - a.value) if b.value != a.value else 0.0
        between = a.point.vector + part * (b.point.vector - a.point.vector)
        found = correct([Ask(a.equations, a.point.of(between), along_parameter(a.point), a.linear.sizes)])[0]
        if isinstance(found, Lost):
            continue
        n = found.point.x.shape[1]
        apart = np.abs(seed.phases - found.point.x[0][:, None]) / found.linear.weights[:n, None]
        if (apart.max(axis=0) < SAME).any():
            return True
    return False
