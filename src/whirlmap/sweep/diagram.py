"""Bifurcation diagrams: the section of a system against one parameter, every point labelled."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from whirlmap.analysis.lyapunov import mean_and_error
from whirlmap.analysis.points import cyclic_states, make_ensemble, run_attributes, tangent_steps
from whirlmap.analysis.regime import regime
from whirlmap.analysis.returns import Returns, settle_and_record
from whirlmap.analysis.saltation import refuse_jumps
from whirlmap.analysis.settling import Settling
from whirlmap.analysis.tangent_run import run_with_section
from whirlmap.errors import RangeError
from whirlmap.integrate.accuracy import Verdict, doubtful
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.system import System
from whirlmap.results.regime import Regime
from whirlmap.results.schema import names_coordinate, regime_variable, status_variable, variable, with_attributes

Array = NDArray[np.float64]
Follow = Literal["up", "down", "both"]

#: A motion that contracts is given the time to shrink by this before it is tested once more, but no more than so many
#: times the length of its exponent's run.
SHRINK, PATIENCE = 1e-9, 4


@dataclass(frozen=True)
class _Measured:
    """One direction of a diagram, before it becomes a Dataset."""

    returns: Returns
    status: NDArray[np.int8]
    end_time: Array
    exponent: Array
    exponent_error: Array
    confidence: Array
    winding: Array
    start_found: NDArray[np.bool_]
    steps: NDArray[np.int64]
    step_error: Array
    step_verdict: NDArray[np.int8]


def bifurcation_diagram(
    system: System,
    parameter: str,
    values: ArrayLike,
    *,
    follow: Follow | None = None,
    settling: Settling | None = None,
    lyapunov: int = 0,
    steps: int | None = None,
    accuracy: float | None = None,
    method: str | None = None,
    workers: int | None = None,
    progress: Callable[[int], None] | None = None,
) -> xr.Dataset:
    """Section of every state against one parameter, with status, regime and amplitude of every point.

    Parameters
    ----------
    parameter : str
        Name of the varied parameter.
    values : array_like, shape (point,)
        Its values, ascending.
    follow : {"up", "down", "both"}, optional
        Carry the state along, each point starting from the end of its neighbour, upwards, downwards or both (then
        the Dataset has a dimension ``direction``). Absent: every point starts cold, and all run together.
    settling : Settling, optional
        Transient, windows and tolerance.
    lyapunov : int
        Common periods over which every point that is not periodic has its largest exponent measured, and its section
        recorded; zero: none. From 256 on the points are also labelled quasi-periodic or chaotic where the evidence
        decides (`regime`), with 1000 and more rarely undecided.

    Returns
    -------
    xr.Dataset
        ``section(parameter, period, state)`` once per T; ``regime``, ``status``, ``period_T`` (in T), ``period_common``,
        ``return_distance``, ``lyapunov``, ``lyapunov_error``, ``confidence``, ``winding``, ``end_time`` (parameter);
        ``minimum``, ``maximum``, ``mean``, ``rms`` (parameter, quantity) of states and outputs over all steps of the record.

    Notes
    -----
    Following is a chain by its nature, one point after the other; it shows hysteresis, and is slower than a cold start.
    A point that ends in contact or diverges hands on the default start of the next.
    """
    settling = settling or Settling()
    points = np.atleast_1d(np.asarray(values, dtype=float))
    if points.ndim != 1 or points.size < 1 or np.any(np.diff(points) <= 0) or not np.isfinite(points).all():
        raise RangeError(f"values of {parameter!r} must be finite and ascend")
    if follow is not None and follow not in ("up", "down", "both"):
        raise RangeError(f"follow is up, down or both, not {follow!r}")
    if not 0 <= lyapunov <= 10_000_000:
        raise RangeError(f"lyapunov must lie between 0 and 10000000 common periods, not {lyapunov}")
    if lyapunov:
        refuse_jumps(system.model, "a Lyapunov exponent")
    run = _Run(system, parameter, settling, lyapunov, steps, accuracy, method, workers, progress)
    if follow is None:
        measured, ensemble = run.cold(points)
        ds = _dataset(system, parameter, points, measured)
    else:
        parts = []
        for way in ("up", "down") if follow == "both" else (follow,):
            measured, ensemble = run.chain(points, downwards=way == "down")
            parts.append(_dataset(system, parameter, points, measured).assign_coords(direction=way))
        ds = parts[0] if len(parts) == 1 else xr.concat(parts, "direction", join="exact", coords="minimal", compat="equals")
    facts = {
        "varied": parameter, "follow": follow or "none", "transient": settling.transient, "most": settling.most,
        "tolerance": settling.tolerance, "common_multiple": ensemble.common_multiple, "lyapunov_periods": lyapunov,
    }  # fmt: skip
    attributes = run_attributes(system, ensemble, **facts)
    if doubts := doubtful(ds["step_verdict"].values):
        attributes["accuracy_not_met"] = doubts
    return with_attributes(ds, attributes)


@dataclass(frozen=True)
class _Run:
    """What all points of a diagram share."""

    system: System
    parameter: str
    settling: Settling
    lyapunov: int
    steps: int | None
    accuracy: float | None
    method: str | None
    workers: int | None
    progress: Callable[[int], None] | None

    def cold(self, points: Array, starts: Array | None = None) -> tuple[_Measured, Ensemble]:
        """Measure points, each from its own start."""
        ensemble, found = make_ensemble(
            self.system, {self.parameter: points}, starts=starts, steps=self.steps, accuracy=self.accuracy,
            method=self.method, workers=self.workers,
        )  # fmt: skip
        returns = settle_and_record(ensemble, self.settling, cyclic=cyclic_states(self.system), progress=self.progress)
        exponent, error, winding = (np.full(points.size, np.nan) for _ in range(3))
        confidence = np.where(returns.regime == Regime.undecided, 0.0, 1.0)
        open_points = np.flatnonzero(returns.regime == Regime.undecided)
        open_points = open_points[ensemble.running[open_points]]
        if self.lyapunov and open_points.size:
            tangent, _ = make_ensemble(
                self.system, {self.parameter: points[open_points]}, starts=ensemble.x[:, open_points],
                steps=tangent_steps(ensemble)[open_points], method=ensemble.method.name, tangents=1, workers=self.workers,
            )  # fmt: skip
            rates, section = run_with_section(
                tangent, self.lyapunov, align=max(self.lyapunov // 10, 5), progress=self.progress
            )
            mean, spread = mean_and_error(rates[:, 0])
            exponent[open_points], error[open_points] = mean, spread
            judged = regime(
                tangent.status, np.zeros(open_points.size, dtype=np.int64), exponent=mean, exponent_error=spread,
                duration=self.lyapunov * tangent.common_multiple * tangent.period, section=section,
                cyclic=cyclic_states(self.system),
            )  # fmt: skip
            label = returns.regime.copy()
            # A point that reaches contact only now has no time of contact: it stays undecided.
            label[open_points] = np.where(tangent.running, judged["regime"].values, Regime.undecided)
            confidence[open_points] = np.where(tangent.running, judged["confidence"].values, 0.0)
            winding[open_points] = judged["winding"].values
            returns = replace(returns, regime=label)
            contracts = open_points[(label[open_points] == Regime.undecided) & (mean < -3 * spread)]
            returns = self._given_time(ensemble, returns, contracts, exponent)
            confidence[returns.regime == Regime.periodic] = 1.0
        return _Measured(
            returns, ensemble.status, ensemble.end_time, exponent, error, confidence, winding, found, ensemble.point_steps,
            ensemble.step_error, ensemble.step_verdict,
        ), ensemble  # fmt: skip

    def _given_time(self, ensemble: Ensemble, returns: Returns, points: NDArray[np.intp], exponent: Array) -> Returns:
        """Test points once more whose motion contracts but has not returned, after the time that this takes."""
        if not points.size:
            return returns
        part = ensemble.subset(points)
        common = part.common_multiple * part.period
        extra = min(int(np.max(np.log(SHRINK) / (exponent[points] * common))) + 1, PATIENCE * self.lyapunov)
        later = replace(self.settling, transient=extra)
        again = settle_and_record(part, later, cyclic=cyclic_states(self.system), progress=self.progress)
        ensemble.absorb(part, points)
        joined = {}
        for name in ("section", "regime", "period", "multiple", "distance", "waited"):
            joined[name] = getattr(returns, name).copy()
            joined[name][..., points] = getattr(again, name)
        extremes = {k: v.copy() for k, v in returns.extremes.items()}
        for k, v in again.extremes.items():
            extremes[k][..., points] = v
        return replace(returns, **joined, extremes=extremes)

    def chain(self, points: Array, *, downwards: bool) -> tuple[_Measured, Ensemble]:
        """Measure points one after the other, each from the end of the one before."""
        order = range(points.size - 1, -1, -1) if downwards else range(points.size)
        starts: Array | None = None
        made: dict[int, _Measured] = {}
        for i in order:
            made[i], ensemble = self.cold(points[i : i + 1], starts)
            starts = ensemble.x.copy() if ensemble.running[0] else None
        return _joined([made[i] for i in range(points.size)]), ensemble


def _joined(parts: list[_Measured]) -> _Measured:
    first = parts[0]
    returns = replace(
        first.returns,
        **{
            name: np.concatenate([getattr(p.returns, name) for p in parts], axis=-1)
            for name in ("section", "regime", "period", "multiple", "distance", "waited")
        },
        extremes={k: np.concatenate([p.returns.extremes[k] for p in parts], axis=-1) for k in first.returns.extremes},
    )
    rest = {
        name: np.concatenate([getattr(p, name) for p in parts])
        for name in (
            "status", "end_time", "exponent", "exponent_error", "confidence", "winding", "start_found", "steps",
            "step_error", "step_verdict",
        )
    }  # fmt: skip
    return _Measured(returns, **rest)


def _dataset(system: System, parameter: str, points: Array, m: _Measured) -> xr.Dataset:
    model, r = system.model, m.returns
    rows = [*system.states, *model.outputs]
    declared = model.parameter(parameter)
    data: dict[str, Any] = {
        "section": variable(
            (parameter, "period", "state"), r.section.transpose(2, 0, 1), "1", "section point, once per T",
            unit_of_each=" ".join(s.unit for s in model.states),
        ),
        "status": status_variable(parameter, m.status),
        "regime": regime_variable(parameter, r.regime),
        "period_T": variable(parameter, r.period, "T", "smallest return, 0 where none was found"),
        "period_common": variable(parameter, r.multiple, "1", "smallest return in common periods, 0 where none"),
        "return_distance": variable(parameter, r.distance, "1", "return distance over the range of each state"),
        "lyapunov": variable(parameter, m.exponent, "1/time", "largest Lyapunov exponent of points that do not return"),
        "lyapunov_error": variable(parameter, m.exponent_error, "1/time", "one standard error of it, from block means"),
        "confidence": variable(parameter, m.confidence, "1", "share of the indicators asked that speak for the regime"),
        "winding": variable(parameter, m.winding, "1", "rotation number of the section of points that do not return"),
        "end_time": variable(parameter, m.end_time, "time", "time at which the run ended early"),
        "start_found": variable(parameter, m.start_found.astype(np.int8), "1", "whether the default start exists"),
        "settled_after": variable(parameter, r.waited, "1", "common periods run before the record"),
        "steps": variable(parameter, m.steps, "1/T", "steps per T"),
        "step_error": variable(parameter, m.step_error, "1", "measured error over one common period"),
        "step_verdict": variable(
            parameter, m.step_verdict, "1", "whether the steps meet the accuracy",
            flag_values=[int(v) for v in Verdict], flag_meanings=" ".join(v.name for v in Verdict),
        ),
    }  # fmt: skip
    for name, meaning in (
        ("minimum", "smallest value"), ("maximum", "largest value"), ("mean", "mean"), ("rms", "rms about the mean"),
    ):  # fmt: skip
        data[name] = variable((parameter, "quantity"), r.extremes[name].T, "1", f"{meaning} over the record")
    return xr.Dataset(
        data,
        coords={
            parameter: variable(parameter, points, declared.unit, declared.meaning),
            "period": np.arange(1, r.section.shape[0] + 1),
            "state": names_coordinate("state", system.states, "state"),
            "quantity": names_coordinate("quantity", rows, "state or output"),
        },
    )
