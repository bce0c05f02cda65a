"""Many branches side by side, and those that double from them."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, Literal

import numpy as np

from whirlmap.analysis.branches.corrector import Ask, Lost, along_parameter, correct
from whirlmap.analysis.branches.events import Event
from whirlmap.analysis.branches.limits import EDGE, Limits
from whirlmap.analysis.branches.orbit_steps import finished
from whirlmap.analysis.branches.switching import APART, doubled
from whirlmap.analysis.branches.tracing import Trace, apart_in_halves, stepping, trace
from whirlmap.analysis.motion.ensembles import cyclic_states
from whirlmap.analysis.periodic_orbits.newton import wrapped
from whirlmap.sweep.branches.branch import Branch, rises
from whirlmap.sweep.branches.measured_branches import BATCH, Measuring
from whirlmap.sweep.branches.seeds import SAME, Seed

#: Part of a step by which a seed may lie beyond its ends.
EDGES = 1e-6

Direction = Literal["up", "down", "both"]


@dataclass
class Branches:
    """Branches that are followed, those of one generation side by side."""

    limits: Limits
    direction: Direction
    doublings: int
    branches: list[Branch] = field(default_factory=list)
    measuring: Measuring = field(default_factory=Measuring)

    def follow(self, seeds: Sequence[Seed], resumed: Sequence[Branch] = ()) -> Iterator[int]:
        """Follow all branches, then those that doubled from them; gives the number of points so far.

        ``resumed`` are branches that were interrupted before, and go on.
        """
        new = [*(b for b in resumed if b.halves is None), *(self._branch(seed) for seed in seeds)]
        doubled = [b for b in resumed if b.halves is not None]
        for generation in range(self.doublings + 1):
            self.branches += new
            for _ in stepping([run for branch in new for run in self._runs(branch)]):
                points = [p for b in self.branches for p in b.measured_points()]
                if len(self.measuring.missing(points)) >= BATCH:
                    self.measuring(points)
                yield sum(len(b.points()) for b in self.branches)
            self.branches[:] = distinct(self.branches)
            if generation < self.doublings:
                new = [b for branch in new if branch in self.branches for b in self._doubled(branch)]
                # Those of an interrupted run stand for what is found again here, and go on as of their own generation.
                again = [b for b in doubled if any(b.seed.period == one.seed.period for one in new)]
                doubled = [b for b in doubled if b not in again]
                known = [*self.branches, *again]
                new = [*again, *(b for b in new if not any(_lies_on(b.seed, other) for other in known))]
        self.branches[:] = distinct(self.branches)

    def events(self, kind: str) -> list[Event]:
        """Events of one kind, branch after branch."""
        return [e for branch in self.branches for _, e in branch.events() if e.kind == kind]

    def _branch(self, seed: Seed) -> Branch:
        down, up = (Trace([seed.at]) if self.direction in (way, "both") else None for way in ("down", "up"))
        edge = np.abs(seed.at.value - np.concatenate([self.limits.low, self.limits.high])).min() <= EDGE * self.limits.width
        return Branch(seed, down, up, begins="range" if edge else "start")

    def _runs(self, branch: Branch) -> list[Any]:
        sign = rises(branch.seed.at) if branch.upwards is None else branch.upwards
        halves = branch.halves
        return [
            trace(part, sign * way, self.limits, halves=halves)
            for part, way in ((branch.down, -1.0), (branch.up, 1.0)) if part is not None and not part.end
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
                at, doubts = finished(c, self.limits.accuracy)
                half = len(at.point.x) // 2  # either half may come first: they are one orbit
                seed = Seed(at, 2 * branch.seed.period, at.point.x[[0, half]].T)
                up = away * rises(seed.at) > 0
                part = Trace([seed.at], doubts=doubts)
                out.append(Branch(seed, None if up else part, part if up else None, begins="closed", halves=halves))
                break
        return out


def distinct(branches: Sequence[Branch]) -> list[Branch]:
    """Branches but for those whose first point lies on an earlier one."""
    kept: list[Branch] = []
    for branch in branches:
        if not any(_lies_on(branch.seed, other) for other in kept):
            kept.append(branch)
    return kept


def _lies_on(seed: Seed, branch: Branch) -> bool:
    """Whether a point lies on a branch: whether the branch, at the same parameter, is at one of its phases."""
    if branch.seed.period != seed.period:  # 0 of equilibria
        return False
    points = branch.points()
    for a, b in pairwise(points):
        margin = EDGES * abs(b.value - a.value)  # the seed may be the first point itself, but for rounding
        between = min(a.value, b.value) - margin <= seed.at.value <= max(a.value, b.value) + margin
        if a.point.x.shape != b.point.x.shape or not between:
            continue
        part = (seed.at.value - a.value) / (b.value - a.value) if b.value != a.value else 0.0
        guess = a.point.vector + part * (b.point.vector - a.point.vector)
        found = correct([Ask(a.equations, a.point.of(guess), along_parameter(a.point), a.linear.sizes)])[0]
        if isinstance(found, Lost):
            continue
        n = found.point.x.shape[1]
        cyclic = cyclic_states(branch.system)
        apart = np.abs(wrapped(seed.phases - found.point.x[0][:, None], cyclic)) / found.linear.weights[:n, None]
        if (apart.max(axis=0) < SAME).any():
            return True
    return False
