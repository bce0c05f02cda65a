"""Many start states settled as one batch, and gathered into the attractors that they come to."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.attractors import on_orbit, on_set
from whirlmap.analysis.points import cyclic_states, make_ensemble
from whirlmap.analysis.returns import settle_and_record
from whirlmap.analysis.settling import POOL
from whirlmap.integrate.ensemble import Ensemble, cores
from whirlmap.integrate.scales import scales
from whirlmap.integrate.system import System
from whirlmap.kernels.routine import LANES
from whirlmap.results.regime import Regime
from whirlmap.results.status import Status
from whirlmap.analysis.labels.labelling import Labelling
from whirlmap.sweep.points import POOLS
from whirlmap.sweep.starts import repeated

Array = NDArray[np.float64]
Progress = Callable[[int], None]

#: Section points by which a run that does not return is known to be on an attractor, and those of the attractor itself.
RECORD, TRACE = 32, 2048
#: Starts that do not return which are labelled together at most.
MOST_AT_ONCE = 1024


@dataclass
class Found:
    """What a search holds; arrays over the starts."""

    status: NDArray[np.int8]
    of: NDArray[np.int64]  # number of the attractor from 0, -1 none
    representative: list[Array]  # a state on each attractor, at phase zero
    multiple: list[int]  # its return in common periods, 0 where none
    outcome: NDArray[np.int8]  # drifting, growing or not settled, else undecided


class Search:
    """Settles all starts, and gathers them into attractors."""

    def __init__(self, system: System, labelling: Labelling, starts: Array, progress: Progress | None) -> None:
        self.system, self.labelling, self.progress = system, labelling, progress
        self.cyclic, self.starts = cyclic_states(system), starts
        self.together = LANES * (labelling.workers or cores())  # starts traced as one batch
        n = starts.shape[1]
        self.records: dict[int, Array] = {}  # section points of the starts that do not return
        self.traces: dict[int, tuple[Array, bool]] = {}  # of the attractors that do not return, and whether smooth
        self.orbits: dict[int, tuple[Array, Array]] = {}  # of those that do: points at phase zero, and scales
        self.judged = np.zeros(n, dtype=bool)
        self.x = starts.copy()
        self.multiple = np.zeros(n, dtype=np.int64)
        self.found = Found(
            np.zeros(n, dtype=np.int8), np.full(n, -1), [], [], np.full(n, Regime.undecided, dtype=np.int8)
        )  # fmt: skip

    def run(self) -> Found:
        """Gather all starts."""
        self._settle()
        f, block = self.found, LANES
        forced = self.system.model.forced
        while True:
            left = np.flatnonzero((f.of < 0) & (f.status == Status.ok))
            returned = left[self.multiple[left] > 0] if forced else left[:0]
            if returned.size:
                self._gather(returned)
                continue
            waiting = left[~self.judged[left]]
            if not waiting.size:
                break
            self._label(waiting[:block])
            block = min(2 * block, MOST_AT_ONCE)
        return f

    def _settle(self) -> None:
        """Settle all starts, in batches that a pool holds."""
        n = self.x.shape[1]
        size = POOLS * POOL * LANES * (self.labelling.workers or cores())
        settling = replace(self.labelling.settling, keep=1)
        for first in range(0, n, size):
            batch = np.arange(first, min(first + size, n))
            ensemble = self.ensemble(self.starts[:, batch])
            returns = settle_and_record(ensemble, settling, cyclic=self.cyclic, progress=self.progress)
            self.multiple[batch], self.x[:, batch] = returns.multiple, ensemble.x
            self.found.status[batch] = ensemble.status
            open_ones = np.flatnonzero(ensemble.running & ((returns.multiple == 0) | (not self.system.model.forced)))
            if open_ones.size:
                common = ensemble.strobe
                saved = ensemble.advance(
                    RECORD * common, members=open_ones, save_periods=common, progress=self.progress
                ).saved
                self.records |= {int(batch[k]): saved[:, :, i] for i, k in enumerate(open_ones)}
                self.found.status[batch], self.x[:, batch] = ensemble.status, ensemble.x

    def ensemble(self, x: Array) -> Ensemble:
        """Start states on the operating point, as integrated everywhere in this search."""
        o = self.labelling
        ensemble, _ = make_ensemble(
            self.system, repeated(self.system, x.shape[1]), starts=x, steps=o.steps, accuracy=o.accuracy, method=o.method,
            workers=o.workers,
        )  # fmt: skip
        return ensemble

    def _gather(self, returned: NDArray[np.intp]) -> None:
        """Give starts that return to the orbits that are known; make the first that is on none a new one."""
        for number, (points, scale) in self.orbits.items():
            same = on_orbit(self.x[:, returned], points, scale, self.cyclic)
            self.found.of[returned[same]] = number
            returned = returned[~same]
        if not returned.size:
            return
        first, rows = int(returned[0]), slice(self.system.model.dimension)
        m = int(self.multiple[first])
        ensemble = self.ensemble(self.x[:, [first]])
        common = ensemble.strobe
        orbit = ensemble.advance(m * common, save_periods=common, extremes=True)
        assert orbit.extremes is not None
        low, high = (orbit.extremes[name][rows] for name in ("minimum", "maximum"))
        self.orbits[len(self.found.representative)] = orbit.saved[:, :, 0], self._scale(low, high)
        self._take(returned[:1], self.x[:, first], m)

    def _label(self, chosen: NDArray[np.intp]) -> None:
        """Label starts that do not return, and take all those that lie on the sets that these trace."""
        measured, ensemble = self.labelling.measure(
            self.system, repeated(self.system, chosen.size), starts=self.x[:, chosen], progress=self.progress
        )
        label, forced = measured.returns.regime, self.system.model.forced
        self.judged[chosen] = True
        self.x[:, chosen], self.multiple[chosen] = ensemble.x, measured.returns.multiple
        self.found.status[chosen] = ensemble.status
        f = self.found
        traced = (label == Regime.chaotic) | (label == Regime.quasi_periodic)
        traced |= ((label == Regime.periodic) & (not forced)) | (label == Regime.at_rest)
        endless = np.isin(label, (Regime.drifting, Regime.growing, Regime.not_settled))
        f.outcome[chosen] = np.where(endless, label, Regime.undecided)
        waiting = np.flatnonzero(ensemble.running & traced)
        while waiting.size:
            # As many as a block of lanes holds cost what one does; few more, for the first traces may hold all others.
            now, waiting = waiting[: self.together], waiting[self.together :]
            for k, trace in zip(now, self._traces(chosen[now]), strict=True):
                if f.of[chosen[k]] < 0 and np.isfinite(trace).all():
                    self._collect(int(chosen[k]), trace, label[k] != Regime.chaotic, int(measured.returns.multiple[k]))
            waiting = waiting[f.of[chosen[waiting]] < 0]

    def _collect(self, start: int, trace: Array, smooth: bool, multiple: int) -> None:
        """Give a start to the known set that its trace ends on, or make it a new one with all starts that lie on it."""
        f = self.found
        last = trace[-RECORD:, :, None]
        known = [
            n for n, (t, kind) in self.traces.items()
            if on_set(last, t, self.cyclic, smooth=kind, scale=self._scale_of(t))[0]
        ]  # fmt: skip
        if known:  # it came there later than its record
            f.of[start] = known[0]
            return
        left = np.array([i for i in self.records if i != start], dtype=np.intp)
        left = left[(f.of[left] < 0) & (f.status[left] == Status.ok)]
        left = left[(self.multiple[left] == 0) | (not self.system.model.forced)]
        if left.size:
            records = np.stack([self.records[int(i)] for i in left], axis=2)
            left = left[on_set(records, trace, self.cyclic, smooth=smooth, scale=self._scale_of(trace))]
        self.traces[len(f.representative)] = trace, smooth
        self._take(np.append(left, start), self.x[:, start], multiple)

    def _traces(self, starts: NDArray[np.intp]) -> Array:
        """Section points of long runs from where starts stand now, shape (start, time, state)."""
        ensemble = self.ensemble(self.x[:, starts])
        common = ensemble.strobe
        saved = ensemble.advance(TRACE * common, save_periods=common, progress=self.progress).saved
        return np.moveaxis(saved, 2, 0)

    def _scale(self, low: Array, high: Array) -> Array:
        """What differences of states are divided by, from their extremes, shape (state, 1)."""
        model, period = self.system.model, np.array([self.system.period])
        return scales(model, period, high - low, np.maximum(np.abs(low), np.abs(high)))[:, 0]

    def _scale_of(self, trace: Array) -> Array:
        return self._scale(trace.min(axis=0)[:, None], trace.max(axis=0)[:, None])

    def _take(self, members: NDArray[np.intp], state: Array, multiple: int) -> None:
        f = self.found
        f.of[members] = len(f.representative)
        f.representative.append(state.copy())
        f.multiple.append(multiple)
