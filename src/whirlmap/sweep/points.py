"""Labels of operating points anywhere in parameter space: what diagrams, maps and draws are made of.

The numbers of a point depend on its own parameters and start alone: not on the points computed with it, their number or
order, nor on the number of threads.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from whirlmap.analysis.lyapunov import BLOCKS
from whirlmap.analysis.open_points import OpenPoints, judge_open_points
from whirlmap.analysis.points import cyclic_states, make_ensemble, parameter_values, run_attributes
from whirlmap.analysis.returns import Returns, settle_and_record
from whirlmap.analysis.settling import POOL, Settling
from whirlmap.analysis.unbounded import Trends, label_trends
from whirlmap.errors import RangeError
from whirlmap.integrate.ensemble import Ensemble, cores
from whirlmap.integrate.orders import order_groups
from whirlmap.integrate.system import System
from whirlmap.kernels.routine import LANES
from whirlmap.results.regime import Regime
from whirlmap.results.schema import names_coordinate, variable, with_attributes
from whirlmap.sweep.measured import RETURNS, Measured, joined
from whirlmap.sweep.point_variables import doubts, points_dataset, shared_common_multiple

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Progress = Callable[[int], None]

#: A motion that contracts is given the time to shrink by this until it is given up, but no more than so many
#: times the length of its exponent's run.
SHRINK, PATIENCE = 1e-9, 4

#: Batches that `label_points` works through hold so many pools of lanes: enough that few lanes wait for the last point.
POOLS = 2


@dataclass(frozen=True)
class Labelling:
    """How points are measured: the options of `label_points`, and the states whose section is kept."""

    settling: Settling
    lyapunov: int
    steps: int | None = None
    accuracy: float | None = None
    method: str | None = None
    workers: int | None = None
    kept: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Refuse a length of the exponent's run that gives no error."""
        if not (self.lyapunov == 0 or BLOCKS <= self.lyapunov <= 10_000_000):
            raise RangeError(f"lyapunov must be 0, or from {BLOCKS} to 10000000 common periods, not {self.lyapunov}")

    def measure(
        self,
        system: System,
        values: Mapping[str, ArrayLike],
        *,
        starts: Array | None = None,
        progress: Progress | None = None,
    ) -> tuple[Measured, Ensemble]:
        """Measure points, each from its own start.

        Returns
        -------
        measured : Measured
        ensemble : Ensemble
            Stands where the points were left. Where the common periods of points differ, those of one length are measured
            together, and this is the ensemble of the longest.
        """
        columns = {name: np.atleast_1d(np.asarray(v, dtype=float)) for name, v in values.items()}
        groups = order_groups(system, parameter_values(system, columns), columns)
        parts = []
        for group in groups:
            at = group.members
            some = {name: column[at] for name, column in columns.items()}
            begin = None if starts is None else starts[:, at]
            measured, ensemble = self._measure(system, some, begin, progress)
            parts.append(measured)
        return (parts[0] if len(parts) == 1 else joined(parts, [group.members for group in groups])), ensemble

    def _measure(
        self, system: System, values: Mapping[str, Array], starts: Array | None, progress: Progress | None
    ) -> tuple[Measured, Ensemble]:
        """Measure points that have the same orders of harmonics."""
        cyclic = cyclic_states(system)
        ensemble, start_found = make_ensemble(
            system, values, starts=starts, steps=self.steps, accuracy=self.accuracy, method=self.method, workers=self.workers
        )
        returns = self._returns(ensemble, None, cyclic, progress)
        found = OpenPoints.none(ensemble.model.dimension, ensemble.points)
        found.regime[:], found.confidence[:] = returns.regime, np.where(returns.regime == Regime.undecided, 0.0, 1.0)
        open_points = np.flatnonzero((returns.regime == Regime.undecided) & ensemble.running)
        if self.lyapunov and open_points.size:
            running = self._judge(system, values, ensemble, open_points, found, cyclic, progress, contraction_ends=True)
            returns = _label_trends(ensemble, returns, open_points, found)
            undecided = found.regime[open_points] == Regime.undecided
            contracting = undecided & (found.exponent < -3 * found.error)[open_points] & running
            contracting = open_points[contracting]
            if contracting.size:
                returns = self._given_time(ensemble, returns, contracting, found.exponent, cyclic, progress)
            found.regime[contracting] = returns.regime[contracting]
            found.confidence[contracting] = np.where(returns.regime[contracting] == Regime.undecided, 0.0, 1.0)
            again = contracting[
                (found.regime == Regime.undecided)[contracting] & (found.periods < self.lyapunov)[contracting]
                & ensemble.running[contracting]
            ]  # fmt: skip
            if again.size:  # they stopped early for an orbit that is not there
                self._judge(system, values, ensemble, again, found, cyclic, progress, contraction_ends=False)
                returns = _label_trends(ensemble, returns, again, found)
        found.winding[:] = np.where(found.regime == Regime.not_settled, returns.turning, found.winding)
        return Measured(
            replace(returns, regime=found.regime), ensemble.status, ensemble.end_time, found.exponent, found.error,
            found.periods, found.confidence, found.winding, start_found, ensemble.point_steps, ensemble.step_error,
            ensemble.step_verdict, ensemble.grazings.astype(np.int64), np.full(ensemble.points, ensemble.common_multiple),
            np.where(ensemble.running, ensemble.x, np.nan),
        ), ensemble  # fmt: skip

    def _returns(
        self, ensemble: Ensemble, longest: Integers | None, cyclic: dict[int, float], progress: Progress | None
    ) -> Returns:
        names = [s.name for s in ensemble.model.states]
        kept = [names.index(name) for name in self.kept]
        return settle_and_record(ensemble, self.settling, longest=longest, kept=kept, cyclic=cyclic, progress=progress)

    def _judge(
        self,
        system: System,
        values: Mapping[str, ArrayLike],
        ensemble: Ensemble,
        points: NDArray[np.intp],
        found: OpenPoints,
        cyclic: dict[int, float],
        progress: Progress | None,
        *,
        contraction_ends: bool,
    ) -> NDArray[np.bool_]:
        """Judge points by a run with a tangent vector, into ``found``; returns which of them run to its end."""
        tangent, _ = make_ensemble(
            system, {name: np.atleast_1d(np.asarray(v, dtype=float))[points] for name, v in values.items()},
            starts=ensemble.x[:, points], steps=ensemble.point_steps[points], method=ensemble.method.name,
            tangents=1, workers=self.workers, turn=ensemble.period[points],
        )  # fmt: skip
        judged = judge_open_points(tangent, self.lyapunov, cyclic, progress, contraction_ends=contraction_ends)
        for name in ("exponent", "error", "periods", "winding", "growth", "drift", "centre", "reach"):
            getattr(found, name)[..., points] = getattr(judged, name)
        # A point that reaches contact only now has no time of contact: it stays undecided.
        found.regime[points] = np.where(tangent.running, judged.regime, Regime.undecided)
        found.confidence[points] = np.where(tangent.running, judged.confidence, 0.0)
        return tangent.running

    def _given_time(
        self,
        ensemble: Ensemble,
        returns: Returns,
        points: NDArray[np.intp],
        exponent: Array,
        cyclic: dict[int, float],
        progress: Progress | None,
    ) -> Returns:
        """Settle points on whose motion contracts but has not returned, for the time that this takes at most.

        The time of each is a power of two of common periods: points of like exponents are looked at together.
        """
        needed = np.log(SHRINK) / (exponent[points] * (ensemble.common_multiple * ensemble.period)[points])
        extra = np.minimum(2 ** np.ceil(np.log2(np.maximum(needed, 1))), PATIENCE * self.lyapunov).astype(np.int64)
        joined: dict[str, Any] = {name: getattr(returns, name).copy() for name in RETURNS}
        extremes = {k: v.copy() for k, v in returns.extremes.items()}
        part = ensemble.subset(points)
        # Steps chosen anew move the orbit by their error, from which it settles in a part of this time.
        longest = extra + extra // 4 + self.settling.longest - self.settling.transient
        again = self._returns(part, longest, cyclic, progress)
        ensemble.absorb(part, points)
        for name, values in joined.items():
            values[..., points] = getattr(again, name) + (values[points] if name == "waited" else 0)
        for name, values in extremes.items():
            values[..., points] = again.extremes[name]
        return replace(returns, **joined, extremes=extremes)


def _label_trends(ensemble: Ensemble, returns: Returns, points: NDArray[np.intp], found: OpenPoints) -> Returns:
    """Label open points that die away, grow or drift for ever, into ``found`` and the returns."""
    parts = (found.growth, found.drift, found.centre, found.reach, found.exponent, found.error)
    ranges = (returns.extremes["maximum"] - returns.extremes["minimum"])[: ensemble.model.dimension, points]
    endless = label_trends(ensemble, points, Trends(*(a[..., points] for a in parts)), ranges)
    known = endless.regime != Regime.undecided
    at = points[known]
    growth, drift = returns.growth.copy(), returns.drift.copy()
    growth[at], drift[:, at] = endless.growth[known], endless.drift[:, known]
    found.regime[at], found.confidence[at] = endless.regime[known], 1.0
    return replace(returns, growth=growth, drift=drift)


def label_points(
    system: System,
    values: Mapping[str, ArrayLike],
    *,
    settling: Settling | None = None,
    lyapunov: int = 256,
    steps: int | None = None,
    accuracy: float | None = None,
    method: str | None = None,
    workers: int | None = None,
    starts: Array | None = None,
    ends: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Label operating points anywhere in parameter space.

    Parameters
    ----------
    values : mapping of str to array, shape (point,)
        The parameters that differ between points, in any order; all columns of the same length.
    settling : Settling, optional
        Transient, windows and tolerance.
    lyapunov : int
        Common periods over which points that do not return have their largest exponent measured and their section
        recorded, which tells quasi-periodic from chaotic, at most: each point stops when it has a label and the error of
        its exponent is small enough (`open_points.ENOUGH`). Less than 256 section points leave them undecided, 0 measures
        nothing.
    steps, accuracy, method, workers
        As in `make_ensemble`.
    starts : array, shape (state, point), optional
        Start states, at phase zero; the model's default start where absent.
    ends : bool
        Whether to keep the states in which the points were left, at phase zero: starts of others. NaN where a run has ended.
    progress : callable, optional
        Called with the number of points x periods T done since the last call.

    Returns
    -------
    xr.Dataset
        Over ``point``, with the varied parameters as coordinates: ``regime``, ``status``, ``period_T`` (in T),
        ``period_common``, ``return_distance``, ``lyapunov``, ``lyapunov_error``, ``lyapunov_periods``, ``confidence``,
        ``winding``, ``end_time``, ``settled_after``, ``start_found``, ``steps``, ``step_error``, ``step_verdict``,
        ``grazings``; over
        ``(point, quantity)``, states and outputs: ``minimum``, ``maximum``, ``mean``, ``rms``, ``peak_to_peak``; over
        ``(point, bearing)``, where the model has outputs named ``eps``: ``max_eccentricity`` and ``min_film``, in
        clearances, and ``max_load`` where it has outputs named ``load``; with ``ends`` also ``end_state(point, state)``.
        No section is kept.

    Raises
    ------
    RangeError
        Where a name or a value is not the model's, lengths differ, or there is no point.

    Notes
    -----
    The numbers of a point do not depend, by a bit, on the points in its company. Points that ended early have NaN for
    what needs a whole record, and their ``status`` says why.
    """
    columns = {name: np.atleast_1d(np.asarray(v, dtype=float)) for name, v in values.items()}
    if not columns:
        raise RangeError("values: found no parameter, expected at least one, as in {'s': [0.5, 1.0]}")
    for name, column in columns.items():
        if column.ndim != 1 or not column.size or not np.isfinite(column).all():
            raise RangeError(f"values of {name!r} must be a list of one or more finite numbers")
    points = parameter_values(system, columns).shape[1]
    if starts is not None and np.shape(starts) != (system.model.dimension, points):
        raise RangeError(f"starts have shape {np.shape(starts)}, expected {(system.model.dimension, points)}")
    labelling = Labelling(settling or Settling(), lyapunov, steps, accuracy, method, workers)
    size = POOLS * POOL * LANES * (workers or cores())
    parts = []
    for first in range(0, points, size):
        batch = slice(first, first + size)
        measured, ensemble = labelling.measure(
            system, {name: column[batch] for name, column in columns.items()},
            starts=None if starts is None else np.asarray(starts, dtype=float)[:, batch], progress=progress,
        )  # fmt: skip
        part = points_dataset(system, {name: column[batch] for name, column in columns.items()}, measured)
        if ends:
            left = measured.end_state.T
            part["end_state"] = variable(("point", "state"), left, "1", "state at the end of the run, at phase zero")
            part = part.assign_coords(state=names_coordinate("state", system.states, "state"))
        parts.append(part)
    ds = parts[0] if len(parts) == 1 else xr.concat(parts, "point", data_vars="minimal", coords="minimal", join="exact")
    s = labelling.settling
    attributes = run_attributes(
        system, ensemble, varied=" ".join(columns), transient=s.transient, most=s.most, tolerance=s.tolerance,
        lyapunov_periods=lyapunov, **shared_common_multiple(system, columns, ensemble),
    )  # fmt: skip
    attributes.pop("accuracy_not_met", None)  # of the last batch; this is of all
    return with_attributes(ds, attributes | doubts(ds))
