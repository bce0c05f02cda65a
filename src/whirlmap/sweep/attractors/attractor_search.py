"""Search for coexisting attractors: many start states in one batch, grouped by the attractor that they reach.

1. Starts that return are gathered into orbits, closed by Newton's method.
2. The others are on an attractor that is known where they converge to its orbit, or their points lie on its trace. What is
   left is labelled, 8 starts and then twice as many each time; those that come out chaotic or quasi-periodic are traced.
3. What has no label then settles on while it approaches a known orbit, and is traced.
4. Sets are compared with each other, by their traces and where these differ by longer ones.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.labels.labelled_points import PATIENCE
from whirlmap.analysis.labels.labelling import measure
from whirlmap.analysis.labels.same_attractor import on_set
from whirlmap.analysis.motion.ensembles import cyclic_states, make_ensemble
from whirlmap.analysis.periodic_orbits.arrivals import arrivals
from whirlmap.analysis.periodic_orbits.closed_orbit import FAR, ClosedOrbit, closed_orbits, flows_into, nearest_return
from whirlmap.analysis.steady.pool import POOL
from whirlmap.analysis.steady.returns import settle_and_record
from whirlmap.integrate.division import cores
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.system import System
from whirlmap.kernels.writing.routine import LANES
from whirlmap.options.computed import Labelling
from whirlmap.options.execution import Execution
from whirlmap.progress import tell
from whirlmap.results.regime import Regime
from whirlmap.results.status import Status
from whirlmap.sweep.attractors.known_attractors import Found, KnownAttractors
from whirlmap.sweep.attractors.repeat_time import repeat_of_forcing
from whirlmap.sweep.attractors.start_states import repeated
from whirlmap.sweep.diagrams.in_batches import FIRST
from whirlmap.sweep.interruptible import batches
from whirlmap.sweep.points.label_points import POOLS

Array = NDArray[np.float64]
Starts = NDArray[np.intp]

#: Section points by which a run that does not return is known to be on an attractor, and those of the attractor itself; how
#: many times as many of two that differ.
RECORD, TRACE, LONGER = 32, 2048, 4
#: Starts that do not return which are labelled together at most.
MOST_AT_ONCE = 1024
#: Times that orbits are closed once a search is interrupted, each some tenths of a second.
LAST = 4
#: Labels of runs that reach no attractor.
ENDLESS = (Regime.drifting, Regime.growing, Regime.not_settled)


class Search:
    """Settles all starts, and gathers them into attractors."""

    def __init__(self, system: System, labelling: Labelling, execution: Execution, starts: Array) -> None:
        self.system, self.labelling, self.execution, self.progress = system, labelling, execution, execution.progress
        self.cyclic, self.starts = cyclic_states(system), starts
        self.together = LANES * (execution.workers or cores())  # starts traced as one batch
        n = starts.shape[1]
        self.every = 1  # T after which the equations are the same, known once runs have settled
        self.records: dict[int, Array] = {}  # section points of the starts that do not return
        self.known = KnownAttractors(system)
        self.judged = np.zeros(n, dtype=bool)
        self.x = starts.copy()
        self.multiple = np.zeros(n, dtype=np.int64)
        self.found = Found(
            np.zeros(n, dtype=np.int8), np.full(n, -1), [], [], np.full(n, Regime.undecided, dtype=np.int8)
        )  # fmt: skip

    def run(self) -> Found:
        """Gather all starts; `KeyboardInterrupt` leaves what was ``found`` until then."""
        self._settle()
        f, block = self.found, LANES
        forced = self.system.model.forced
        while True:
            left = self._left()
            returned = left[self.multiple[left] > 0] if forced else left[:0]
            if returned.size:
                self._gather(returned)
                continue
            waiting = left[~self.judged[left]]
            if not waiting.size:
                break
            self._label(waiting[:block])
            block = min(2 * block, MOST_AT_ONCE)
        self._settle_on()
        self._trace_rest()
        self._join_sets()
        return f

    def gather_some(self) -> None:
        """Gather starts that have settled and return, for a moment: what an interrupted search does last."""
        for _ in range(LAST if self.system.model.forced else 0):
            left = self._left()
            returned = left[(self.multiple[left] > 0) & (left < self.found.settled)]
            if returned.size:
                self._gather(returned)

    @property
    def gathered(self) -> NDArray[np.bool_]:
        """Which starts have come to an attractor, or ended, shape (start,)."""
        f = self.found
        came = (f.of >= 0) | (f.status != Status.ok) | np.isin(f.outcome, ENDLESS)
        return np.asarray(came & (np.arange(came.size) < f.settled))

    def _left(self) -> Starts:
        """Starts that run and have no attractor yet."""
        return np.flatnonzero((self.found.of < 0) & (self.found.status == Status.ok))

    def _settle(self) -> None:
        """Settle all starts in batches."""
        n, block = self.x.shape[1], LANES * (self.execution.workers or cores())
        settling = replace(self.labelling.settling, keep=1)
        for place in batches(n, first=FIRST * block, most=POOLS * POOL * block):
            batch = np.arange(place.start, place.stop)
            tell(self.progress, "begin", n - place.start, settling.transient + settling.first_window)
            ensemble = self.ensemble(self.starts[:, batch])
            returns = settle_and_record(ensemble, settling, cyclic=self.cyclic, progress=self.progress)
            self.multiple[batch], self.x[:, batch] = returns.multiple, ensemble.x
            self.found.status[batch] = ensemble.status
            if not place.start:
                self.every = repeat_of_forcing(self.system, ensemble.x[:, ensemble.running])
            open_ones = np.flatnonzero(ensemble.running & ((returns.multiple == 0) | (not self.system.model.forced)))
            if open_ones.size:
                saved = self._advance(ensemble, RECORD, open_ones)
                self.records |= {int(batch[k]): saved[:, :, i] for i, k in enumerate(open_ones)}
                self.found.status[batch], self.x[:, batch] = ensemble.status, ensemble.x
            self.found.settled = place.stop
            tell(self.progress, "settled", batch.size, 0, 0)

    def _advance(self, ensemble: Ensemble, count: int, members: Starts | None = None) -> Array:
        """Run for so many section points, shape (time, state, member)."""
        every = self.every
        return ensemble.advance(count * every, members=members, save_periods=every, progress=self.progress).saved

    def ensemble(self, x: Array) -> Ensemble:
        """Start states on the operating point, as integrated everywhere in this search."""
        ensemble, _ = make_ensemble(
            self.system, repeated(self.system, x.shape[1]), starts=x, integration=self.labelling.integration,
            execution=self.execution,
        )  # fmt: skip
        return ensemble

    def _gather(self, returned: Starts) -> None:
        """Give starts that return to the orbits that are known; close the orbits of the next that are on none."""
        self.found.of[returned] = self.known.orbit_at(self.x[:, returned])
        returned = returned[self.found.of[returned] < 0]
        if not returned.size:
            return
        m = int(self.multiple[returned[0]])
        these = returned[self.multiple[returned] == m][: self.together]
        for start, orbit in zip(these, self._closed(these, self.multiple[these]), strict=True):
            known = self.known.same_orbit(orbit)
            if known is not None:
                self.found.of[start] = known
            else:
                self._take_orbit(orbit, np.array([start]), m)

    def _closed(self, starts: Starts, multiple: NDArray[np.int64], far: float = FAR) -> list[ClosedOrbit]:
        return closed_orbits(
            self.ensemble(self.x[:, starts]), multiple, every=self.every, tolerance=self.labelling.settling.tolerance,
            cyclic=self.cyclic, far=far,
        )  # fmt: skip

    def _take_orbit(self, orbit: ClosedOrbit, members: Starts, multiple: int) -> None:
        """Make an orbit a new attractor, with the open starts into which it flows."""
        number = len(self.found.representative)
        self.known.orbits[number] = orbit
        self._take(members, orbit.points[0], multiple)
        self._take_arrivals(number)

    def _take_arrivals(self, number: int) -> None:
        """Give open starts to an orbit into which their records flow."""
        left = self._open()
        if left.size:
            records = np.stack([self.records[int(i)] for i in left], axis=2)
            self.found.of[left[flows_into(records, self.known.orbits[number], self.cyclic)]] = number

    def _open(self) -> Starts:
        """Starts that have a record and no attractor."""
        left = np.array(list(self.records), dtype=np.intp)
        left = left[(self.found.of[left] < 0) & (self.found.status[left] == Status.ok)]
        return left[(self.multiple[left] == 0) | (not self.system.model.forced)]

    def _label(self, chosen: Starts) -> None:
        """Label starts that do not return, and take all those that lie on the sets that these trace."""
        measured, ensemble = measure(
            self.system, repeated(self.system, chosen.size), self.labelling, self.execution, starts=self.x[:, chosen]
        )
        label, forced = measured.returns.regime, self.system.model.forced
        self.judged[chosen] = True
        self.x[:, chosen], self.multiple[chosen] = ensemble.x, measured.returns.multiple
        self.found.status[chosen] = ensemble.status
        f = self.found
        traced = np.isin(label, (Regime.chaotic, Regime.quasi_periodic, Regime.locked))
        traced |= ((label == Regime.periodic) & (not forced)) | (label == Regime.at_rest)
        f.outcome[chosen] = np.where(np.isin(label, ENDLESS), label, Regime.undecided)
        waiting = np.flatnonzero(ensemble.running & traced)
        while waiting.size:
            # As many as a block of lanes holds cost what one does; few more, for the first traces may hold all others.
            now, waiting = waiting[: self.together], waiting[self.together :]
            for k, trace in zip(now, self._traces(chosen[now], TRACE), strict=True):
                if f.of[chosen[k]] < 0 and np.isfinite(trace).all():
                    self._collect(int(chosen[k]), trace, label[k] != Regime.chaotic, int(measured.returns.multiple[k]))
            waiting = waiting[f.of[chosen[waiting]] < 0]

    def _collect(self, start: int, trace: Array, smooth: bool, multiple: int) -> None:
        """Give a start to what its trace comes to, or make it a new set with all starts that lie on it."""
        f = self.found
        into = self.known.comes_to(trace, smooth)
        if into is not None:  # it came there later than its record
            f.of[start] = into
            return
        left = self._open()
        left = left[left != start]
        if left.size:
            records = np.stack([self.records[int(i)] for i in left], axis=2)
            left = left[on_set(records, trace, self.cyclic, smooth=smooth, scale=self.known.scale_of(trace))]
        self.known.traces[len(f.representative)] = trace, smooth
        self._take(np.append(left, start), self.x[:, start], multiple)

    def _settle_on(self) -> None:
        """Run on what has no label while it approaches an orbit, for the time that contraction is given at most.

        Besides the known orbits that is one to which Newton's method leads from one of these runs: where all contract
        slowly none may have settled. It counts once a run converges to it.
        """
        f = self.found
        left = self._without_label()
        if not left.size or not self.system.model.forced:
            return
        some = left[np.linspace(0, left.size - 1, min(self.together, left.size)).astype(int)]
        rows = self.system.strobe // self.every
        multiple = np.array([nearest_return(self.records.get(int(k)), rows, self.cyclic) for k in some])
        near = zip(self._closed(some, multiple, far=np.inf), multiple, strict=True)
        likely = [(orbit, int(m)) for orbit, m in near if orbit.closed and self.known.same_orbit(orbit) is None]
        numbers, orbits = list(self.known.orbits), [*self.known.orbits.values(), *(orbit for orbit, _ in likely)]
        if not orbits:
            return
        most = PATIENCE * self.labelling.longest(self.system.strobe) // self.every
        into = np.full(left.size, -1)
        for part in np.array_split(np.arange(left.size), -(-left.size // MOST_AT_ONCE)):
            ensemble = self.ensemble(self.x[:, left[part]])
            into[part] = arrivals(
                ensemble, orbits, every=self.every, most=most, cyclic=self.cyclic, progress=self.progress
            )  # fmt: skip
            self.x[:, left[part]], f.status[left[part]] = ensemble.x, ensemble.status
        known = (into >= 0) & (into < len(numbers))
        f.of[left[known]] = np.array([*numbers, -1])[into[known]]
        for number, (orbit, m) in enumerate(likely, start=len(numbers)):
            members = left[into == number]
            same = self.known.same_orbit(orbit) if members.size else None
            if same is not None:  # two of these runs led to one orbit
                f.of[members] = same
            elif members.size:
                self._take_orbit(orbit, members, m)

    def _without_label(self) -> Starts:
        left = self._left()
        return left[~np.isin(self.found.outcome[left], ENDLESS)]

    def _trace_rest(self) -> None:
        """Give starts that no label was found for to the set that they trace."""
        left = self._without_label()
        for first in range(0, left.size if self.known.traces else 0, self.together):
            these = left[first : first + self.together]
            for start, trace in zip(these, self._traces(these, TRACE), strict=True):
                into = self.known.comes_to(trace, smooth=False)
                self.found.of[start] = -1 if into is None else into

    def _join_sets(self) -> None:
        """Make sets one that their traces, or where these differ longer ones, do not tell apart."""
        sets = list(self.known.traces)
        if len(sets) < 2:
            return
        sets = self._joined(sets, [self.known.traces[n][0] for n in sets])
        if len(sets) > 1:
            ensemble = self.ensemble(np.stack([self.found.representative[n] for n in sets], axis=1))
            self._joined(sets, list(np.moveaxis(self._advance(ensemble, (LONGER + 1) * TRACE)[TRACE:], 2, 0)))
        self._renumber()

    def _joined(self, sets: list[int], traces: list[Array]) -> list[int]:
        """Give the starts of each set to the first one that its trace agrees with; returns those that are left."""
        kept: list[int] = []
        for number, trace in zip(sets, traces, strict=True):
            known = {n: (traces[sets.index(n)], self.known.traces[n][1]) for n in kept}
            into = self.known.comes_to(trace, self.known.traces[number][1], known)
            if into is None:
                kept.append(number)
            else:
                self.found.of[self.found.of == number] = into
        return kept

    def _renumber(self) -> None:
        """Forget attractors that have no starts any more."""
        f = self.found
        kept = [n for n in range(len(f.representative)) if (f.of == n).any()]
        new = {old: n for n, old in enumerate(kept)}
        f.of = np.array([new.get(int(n), -1) for n in f.of], dtype=np.int64)
        f.representative, f.multiple = [f.representative[n] for n in kept], [f.multiple[n] for n in kept]
        self.known.renumber(new)

    def _traces(self, starts: Starts, count: int) -> Array:
        """Section points of long runs from where starts stand now, shape (start, time, state)."""
        return np.moveaxis(self._advance(self.ensemble(self.x[:, starts]), count), 2, 0)

    def _take(self, members: Starts, state: Array, multiple: int) -> None:
        f, number = self.found, len(self.found.representative)
        f.multiple.append(multiple)
        f.representative.append(state.copy())
        f.of[members] = number  # last of all: Ctrl-C may come in between
