"""Coexisting attractors of one operating point: many start states, one batch, gathered, each with evidence and basin."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from whirlmap.analysis.attractors import on_orbit, on_set, scales
from whirlmap.analysis.evidence import LEAST
from whirlmap.analysis.lyapunov import mean_and_error
from whirlmap.analysis.points import TANGENT_STEPS, cyclic_states, make_ensemble, run_attributes, tangent_steps
from whirlmap.analysis.regime import regime
from whirlmap.analysis.returns import settle_and_record
from whirlmap.analysis.settling import POOL, Settling
from whirlmap.analysis.tangent_run import run_with_section
from whirlmap.errors import RangeError, nearest
from whirlmap.integrate.accuracy import doubtful
from whirlmap.integrate.ensemble import Ensemble, cores
from whirlmap.integrate.equilibrium import start_states
from whirlmap.integrate.system import System
from whirlmap.kernels.routine import LANES
from whirlmap.results.regime import Regime
from whirlmap.results.schema import names_coordinate, regime_variable, status_variable, variable, with_attributes
from whirlmap.results.status import Status
from whirlmap.sweep.points import POOLS, Labelling, points_dataset

Array = NDArray[np.float64]
Progress = Callable[[int], None]

#: Section points by which a run that does not return is known to be on an attractor, and those of the attractor itself.
RECORD, TRACE = 32, 2048
#: Starts that do not return which are labelled together at most.
MOST_AT_ONCE = 1024
#: How far the default box reaches beyond the motion from the default start: its range times this, about its middle.
WIDER = 2.0
#: Starts, the first ones, whose steps per T are chosen by the accuracy, settled; all take the most that one of them needs.
PILOT = 64
#: Section points of each attractor that the Dataset keeps.
KEPT = 512
#: What starts come to that reach no attractor.
OUTCOMES = (Regime.contact, Regime.diverged, Regime.undecided)


def attractors(
    system: System,
    *,
    starts: int | ArrayLike = 256,
    box: Mapping[str, tuple[float, float]] | None = None,
    seed: int = 0,
    settling: Settling | None = None,
    lyapunov: int = 512,
    steps: int | None = None,
    accuracy: float | None = None,
    method: str | None = None,
    workers: int | None = None,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Find the attractors of one operating point that many start states lead to.

    Parameters
    ----------
    starts : int or array, shape (state, start)
        How many start states are drawn at random from the box, or the start states themselves, all at phase zero.
    box : mapping of state to (low, high), optional
        Where starts are drawn, uniformly; the other states keep the system's start values. Without any box all states
        are drawn from `default_box`.
    seed : int
        Of the drawing.
    settling : Settling, optional
        Transient, windows and tolerance.
    lyapunov : int
        Common periods over which each attractor's largest exponent is measured and its section judged, at least 256.
    steps, accuracy, method, workers
        As in `make_ensemble`.
    progress : callable, optional
        Called with the number of starts x periods T done since the last call.

    Returns
    -------
    xr.Dataset
        Over ``attractor``, numbered from 1 by falling share: the variables of `label_points` (``regime``, ``period_T``,
        extremes, ...) with the exponent of periodic ones as well, ``vote(indicator, attractor)`` and the numbers behind
        it (see `regime`), ``starts``, ``share`` and ``share_error``, ``section(attractor, member, state)``: its points at
        phase zero of the common period, at most `KEPT`, NaN beyond. Over ``outcome`` (contact, diverged, undecided):
        ``outcome_starts``, ``outcome_share``, ``outcome_share_error``. Over ``start``: ``start_state(state, start)``,
        ``attractor_of`` (0: none), ``start_regime``, ``start_status``.

    Raises
    ------
    RangeError
        Where a state is unknown, a box is empty, or starts have another shape.

    Notes
    -----
    1. All starts settle as one batch. Those that return are on the same orbit where their states at phase zero agree with
       a point of it to `whirlmap.analysis.attractors.SAME_POINT` of the range; angles are compared modulo their period.
    2. Of those that do not return, `LANES` and then twice as many each time are labelled (`label_points`). Those that come
       out chaotic or quasi-periodic are traced over `TRACE` common periods, and the others are on the same attractor where
       `RECORD` of their section points lie on the trace (`on_set`). What is left is labelled in turn, to the last start.
    3. The label of every attractor comes from one more run with all indicators. A start that ends in contact or diverges,
       or whose label is undecided, has no attractor, and is counted as such.

    The error of a share is that of a binomial share after Laplace, sqrt(p (1 - p) / (n + 3)) with p = (k + 1) / (n + 2):
    it is not zero where all starts agree. An attractor of share p is missed by n starts with probability (1 - p)^n.
    An orbit that is unstable, or whose basin is thinner than the starts, is not seen; a chaotic transient longer
    than settling and exponent's run is taken for an attractor. Orbits closer than the tolerances named are one.
    """
    settling = settling or Settling()
    if not LEAST <= lyapunov <= 10_000_000:
        raise RangeError(f"lyapunov must lie between {LEAST} and 10000000 common periods, not {lyapunov}")
    labelling = Labelling(settling, lyapunov, steps, accuracy, method, workers)
    drawn = isinstance(starts, int | np.integer)
    if drawn:
        x = draw_starts(system, int(starts), default_box(system, labelling) if box is None else box, seed)  # type: ignore[arg-type]
    else:
        if box is not None:
            raise RangeError("box: found one, expected none where the start states themselves are given")
        x = np.array(starts, dtype=float)
        if x.ndim != 2 or x.shape[0] != system.model.dimension or not x.shape[1] or not np.isfinite(x).all():
            raise RangeError(
                f"starts have shape {x.shape}, expected {system.model.dimension} states ({' '.join(system.states)}) by"
                " one or more starts, all finite"
            )
    labelling, doubts = _one_step(system, labelling, x, progress)
    found = _Search(system, labelling, x, progress).run()
    ds = _dataset(system, labelling, found, x, progress)
    if doubts:
        ds.attrs["accuracy_not_met"] = doubts
    return ds.assign_attrs({"seed": seed} if drawn else {})


def _one_step(
    system: System, labelling: Labelling, starts: Array, progress: Progress | None
) -> tuple[Labelling, str | None]:
    """Choose the steps per T that all starts take, and say where they do not meet the accuracy.

    With steps of their own, starts on one orbit would settle on as many slightly different ones, as integrated.
    """
    if labelling.steps is not None or not system.model.forced:
        return labelling, None
    some = starts[:, :PILOT]
    ensemble, _ = make_ensemble(
        system, _repeated(system, some.shape[1]), starts=some, accuracy=labelling.accuracy, method=labelling.method,
        workers=labelling.workers,
    )  # fmt: skip
    settle_and_record(ensemble, replace(labelling.settling, keep=1), cyclic=cyclic_states(system), progress=progress)
    steps = int(max(ensemble.point_steps.max(), TANGENT_STEPS))
    return replace(labelling, steps=steps, accuracy=None), doubtful(ensemble.step_verdict) or None


def default_box(system: System, labelling: Labelling) -> dict[str, tuple[float, float]]:
    """Box of start states about the motion from the default start: `WIDER` times its range, angles whole turns.

    Raises
    ------
    RangeError
        Where that run ends early, or does not move: then nothing says how large a box should be.
    """
    measured, _ = labelling.measure(system, _repeated(system, 1))
    low, high = (measured.returns.extremes[k][: system.model.dimension, 0] for k in ("minimum", "maximum"))
    if not np.isfinite(low).all() or not (high > low).any():
        raise RangeError(
            f"{system.case}: the run from the default start does not move, or ends early, so it gives no box of start"
            " states; give one for the states of interest, as in x=-2:2"
        )
    half = WIDER * (high - low) / 2
    out = dict(zip(system.states, zip((low + high) / 2 - half, (low + high) / 2 + half, strict=True), strict=True))
    for k, period in cyclic_states(system).items():
        out[system.states[k]] = (-period / 2, period / 2)
    return {name: (float(a), float(b)) for name, (a, b) in out.items()}


def start_values(system: System) -> Array:
    """The system's start state, shape (state,)."""
    x, _ = start_states(system.model, system.vector[:, None])
    for name, value in system.start.items():
        x[system.states.index(name)] = value
    return np.asarray(x[:, 0])


def draw_starts(system: System, count: int, box: Mapping[str, tuple[float, float]], seed: int) -> Array:
    """Start states drawn uniformly from a box, shape (state, start)."""
    if not 1 <= count <= 10_000_000:
        raise RangeError(f"starts must lie between 1 and 10000000, not {count}")
    if not box:
        raise RangeError("box: found no state, expected at least one, as in x=-2:2")
    for name, (low, high) in box.items():
        if name not in system.states:
            raise RangeError(
                f"box: {system.model.name} has no state {name!r}.{nearest(name, system.states)}"
                f"\n  states: {' '.join(system.states)}"
            )
        if not (np.isfinite([low, high]).all() and low <= high):
            raise RangeError(f"box of {name!r}: found {low:g} to {high:g}, expected finite numbers that ascend")
    x = np.repeat(start_values(system)[:, None], count, axis=1)
    random = np.random.default_rng(seed)
    for name in system.states:  # in the order of the states, whatever the order of the box
        if name in box:
            x[system.states.index(name)] = random.uniform(*box[name], count)
    return x


def _repeated(system: System, count: int) -> dict[str, Array]:
    """The system's own operating point, so many times."""
    return {system.parameters[0]: np.full(count, system.vector[0])}


@dataclass
class _Found:
    """What a search holds; arrays over the starts."""

    status: NDArray[np.int8]
    of: NDArray[np.int64]  # number of the attractor from 0, -1 none
    representative: list[Array]  # a state on each attractor, at phase zero
    multiple: list[int]  # its return in common periods, 0 where none


class _Search:
    """Settles all starts, and gathers them into attractors."""

    def __init__(self, system: System, labelling: Labelling, starts: Array, progress: Progress | None) -> None:
        self.system, self.labelling, self.progress = system, labelling, progress
        self.cyclic, self.starts = cyclic_states(system), starts
        n = starts.shape[1]
        self.records: dict[int, Array] = {}  # section points of the starts that do not return
        self.traces: dict[int, tuple[Array, bool]] = {}  # of the attractors that do not return, and whether smooth
        self.orbits: dict[int, tuple[Array, Array]] = {}  # of those that do: points at phase zero, and scales
        self.judged = np.zeros(n, dtype=bool)
        self.x = starts.copy()
        self.multiple = np.zeros(n, dtype=np.int64)
        self.found = _Found(np.zeros(n, dtype=np.int8), np.full(n, -1), [], [])

    def run(self) -> _Found:
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
            ensemble = self._ensemble(self.starts[:, batch])
            returns = settle_and_record(ensemble, settling, cyclic=self.cyclic, progress=self.progress)
            self.multiple[batch], self.x[:, batch] = returns.multiple, ensemble.x
            self.found.status[batch] = ensemble.status
            open_ones = np.flatnonzero(ensemble.running & ((returns.multiple == 0) | (not self.system.model.forced)))
            if open_ones.size:
                common = ensemble.common_multiple
                saved = ensemble.advance(
                    RECORD * common, members=open_ones, save_periods=common, progress=self.progress
                ).saved
                self.records |= {int(batch[k]): saved[:, :, i] for i, k in enumerate(open_ones)}
                self.found.status[batch], self.x[:, batch] = ensemble.status, ensemble.x

    def _ensemble(self, x: Array) -> Ensemble:
        o = self.labelling
        ensemble, _ = make_ensemble(
            self.system, _repeated(self.system, x.shape[1]), starts=x, steps=o.steps, accuracy=o.accuracy, method=o.method,
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
        ensemble = self._ensemble(self.x[:, [first]])
        common = ensemble.common_multiple
        orbit = ensemble.advance(m * common, save_periods=common, extremes=True)
        assert orbit.extremes is not None
        extent = (orbit.extremes["maximum"] - orbit.extremes["minimum"])[rows, 0]
        points = orbit.saved[:, :, 0]
        self.orbits[len(self.found.representative)] = points, scales(points, extent, self.cyclic)
        self._take(returned[:1], self.x[:, first], m)

    def _label(self, chosen: NDArray[np.intp]) -> None:
        """Label starts that do not return, and take all those that lie on the sets that these trace."""
        measured, ensemble = self.labelling.measure(
            self.system, _repeated(self.system, chosen.size), starts=self.x[:, chosen], progress=self.progress
        )
        label, forced = measured.returns.regime, self.system.model.forced
        self.judged[chosen] = True
        self.x[:, chosen], self.multiple[chosen] = ensemble.x, measured.returns.multiple
        self.found.status[chosen] = ensemble.status
        f = self.found
        traced = (label == Regime.chaotic) | (label == Regime.quasi_periodic)
        traced |= (label == Regime.periodic) & (not forced)
        for k in np.flatnonzero(ensemble.running & traced):
            start = int(chosen[k])
            if f.of[start] >= 0:
                continue
            trace = self._trace(start)
            if not np.isfinite(trace).all():
                continue
            last, smooth = trace[-RECORD:, :, None], bool(label[k] != Regime.chaotic)
            known = [n for n, (t, kind) in self.traces.items() if on_set(last, t, self.cyclic, smooth=kind)[0]]
            if known:  # it came there later than its record
                f.of[start] = known[0]
                continue
            left = np.array([i for i in self.records if i != start], dtype=np.intp)
            left = left[(f.of[left] < 0) & (f.status[left] == Status.ok) & ((self.multiple[left] == 0) | (not forced))]
            if left.size:
                records = np.stack([self.records[int(i)] for i in left], axis=2)
                left = left[on_set(records, trace, self.cyclic, smooth=smooth)]
            self.traces[len(f.representative)] = trace, smooth
            self._take(np.append(left, start), self.x[:, start], int(measured.returns.multiple[k]))

    def _trace(self, start: int) -> Array:
        """Section points of a long run from where a start stands now, shape (time, state)."""
        ensemble = self._ensemble(self.x[:, [start]])
        common = ensemble.common_multiple
        return ensemble.advance(TRACE * common, save_periods=common, progress=self.progress).saved[:, :, 0]

    def _take(self, members: NDArray[np.intp], state: Array, multiple: int) -> None:
        f = self.found
        f.of[members] = len(f.representative)
        f.representative.append(state.copy())
        f.multiple.append(multiple)


def _evidence(
    system: System, labelling: Labelling, found: _Found, progress: Progress | None
) -> tuple[xr.Dataset, xr.Dataset, Ensemble]:
    """Variables of `label_points` over the attractors, and the votes of all indicators about each."""
    count = len(found.representative)
    common = system.common_multiple
    keep = max(labelling.settling.keep, 2 * common * max(found.multiple))
    options = replace(labelling, settling=replace(labelling.settling, keep=keep))
    values = _repeated(system, count)
    measured, ensemble = options.measure(system, values, starts=np.stack(found.representative, axis=1), progress=progress)
    ds = points_dataset(system, values, measured).reset_coords(list(values), drop=True).rename(point="attractor")
    tangent, _ = make_ensemble(
        system, values, starts=ensemble.x, steps=tangent_steps(ensemble), method=ensemble.method.name, tangents=1,
        workers=labelling.workers,
    )  # fmt: skip
    rates, record = run_with_section(tangent, labelling.lyapunov, align=max(labelling.lyapunov // 10, 5), progress=progress)
    mean, spread = mean_and_error(rates[:, 0])
    record = record[: np.isfinite(record[:, 0]).all(axis=1).sum()]
    members = record[: min(record.shape[0], KEPT)]
    returned = measured.returns.multiple
    inside = (returned == 0) | (np.arange(members.shape[0])[:, None] < returned)
    ds["section"] = variable(
        ("attractor", "member", "state"), np.where(inside[:, None, :], members, np.nan).transpose(2, 0, 1), "1",
        "section points, once per common period or at crossings", unit_of_each=" ".join(s.unit for s in system.model.states),
    )  # fmt: skip
    judged = regime(
        tangent.status, measured.returns.multiple, exponent=mean, exponent_error=spread,
        duration=labelling.lyapunov * common * tangent.period, section=record, cyclic=cyclic_states(system),
    )  # fmt: skip
    votes = judged.rename(point="attractor").assign(
        lyapunov=variable("attractor", mean, "1/time", "largest Lyapunov exponent"),
        lyapunov_error=variable("attractor", spread, "1/time", "one standard error of it, from block means"),
    )
    return ds, votes, ensemble


def _share(count: NDArray[np.int64], total: int) -> tuple[Array, Array]:
    """Share, and its error after Laplace."""
    p = (count + 1) / (total + 2)
    return count / total, np.sqrt(p * (1 - p) / (total + 3))


def _dataset(system: System, labelling: Labelling, found: _Found, starts: Array, progress: Progress | None) -> xr.Dataset:
    n = starts.shape[1]
    ds = xr.Dataset()
    attributes: dict[str, Any] = {}
    of = found.of
    if found.representative:
        ds, votes, ensemble = _evidence(system, labelling, found, progress)
        attributes = run_attributes(system, ensemble)
        ds = ds.drop_vars(set(ds.data_vars) & set(votes.data_vars)).merge(votes)
        sure = np.flatnonzero(ds["regime"].values != Regime.undecided)  # an attractor is what has a label
        counts = np.bincount(of[of >= 0], minlength=len(found.representative))[sure]
        order = sure[np.argsort(-counts, kind="stable")]
        number = np.zeros(len(found.representative) + 1, dtype=np.int64)
        number[order] = np.arange(1, order.size + 1)
        of = number[of]  # -1 is the last, which is 0
        ds = ds.isel(attractor=order).assign_coords(attractor=np.arange(1, order.size + 1))
    else:
        of = np.zeros(n, dtype=np.int64)
        attributes = run_attributes(system, _Search(system, labelling, starts[:, :1], None)._ensemble(starts[:, :1]))
    label = np.full(n, Regime.undecided, dtype=np.int8)
    if found.representative:
        label[of > 0] = ds["regime"].values[of[of > 0] - 1]
    label[found.status == Status.contact], label[found.status == Status.diverged] = Regime.contact, Regime.diverged
    size = int(ds.sizes.get("attractor", 0))
    counts = np.bincount(of, minlength=size + 1)[1:]
    ended = np.array([(label[of == 0] == r).sum() for r in OUTCOMES])
    for dim, k, prefix, what in (("attractor", counts, "", "attractor"), ("outcome", ended, "outcome_", "outcome")):
        share, error = _share(k, n)
        ds[f"{prefix}starts"] = variable(dim, k, "1", f"starts that came to this {what}")
        ds[f"{prefix}share"] = variable(dim, share, "1", f"share of the starts that came to this {what}")
        ds[f"{prefix}share_error"] = variable(dim, error, "1", "one standard error of it, binomial after Laplace")
    units = " ".join(s.unit for s in system.model.states)
    ds["start_state"] = variable(("state", "start"), starts, "1", "start states", unit_of_each=units)
    ds["attractor_of"] = variable("start", of, "1", "attractor that a start came to, 0 where none")
    ds["start_regime"] = regime_variable("start", label)
    ds["start_status"] = status_variable("start", found.status)
    ds = ds.assign_coords(
        state=names_coordinate("state", system.states, "state"),
        outcome=names_coordinate("outcome", [r.label for r in OUTCOMES], "how starts without an attractor end"),
    )
    s = labelling.settling
    return with_attributes(ds, attributes | {
        "transient": s.transient, "most": s.most, "tolerance": s.tolerance, "lyapunov_periods": labelling.lyapunov,
    })  # fmt: skip
