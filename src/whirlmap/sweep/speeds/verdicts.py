"""Verdict on a speed: safe where the motion is periodic and within the limit, and the teeth stay in contact."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from whirlmap.analysis.linear.stations import stations_of
from whirlmap.analysis.motion.ensembles import make_ensemble, parameter_values
from whirlmap.analysis.motion.record_length import MANY, record_periods
from whirlmap.analysis.motion.tooth_contact import tooth_contact
from whirlmap.errors import RangeError, nearest
from whirlmap.integrate.dimensions import Dimensions
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.orders import order_groups
from whirlmap.integrate.system import System
from whirlmap.options.computed import LABELLING, Integration, Labelling
from whirlmap.options.execution import EXECUTION, Execution
from whirlmap.results.regime import WITHOUT_BOUND, Regime
from whirlmap.results.schema import variable
from whirlmap.results.status import flags
from whirlmap.sweep.points.label_points import label_points

Array = NDArray[np.float64]


class Verdict(IntEnum):
    """Whether a speed is safe, else the first reason why not."""

    safe = 0
    amplitude = 1
    separation = 2
    coexisting = 3
    quasi_periodic = 4
    chaotic = 5
    contact = 6
    diverged = 7
    undecided = 8


REASONS = {
    Regime.quasi_periodic: Verdict.quasi_periodic, Regime.chaotic: Verdict.chaotic, Regime.contact: Verdict.contact,
    **dict.fromkeys(WITHOUT_BOUND, Verdict.diverged), Regime.undecided: Verdict.undecided,
    Regime.not_settled: Verdict.undecided,
}  # fmt: skip


@dataclass(frozen=True)
class Judge:
    """How points of one machine, or of several of one model, are judged.

    Attributes
    ----------
    system : System
        What all points share; columns of values replace its own.
    quantity : str, optional
        State or output whose peak-to-peak counts, or a disk, bearing or other station, whose x and y both count; where
        absent the largest of the model's displacements (`Model.swing`, or all stations where it declares none).
    labelling : Labelling
    execution : Execution
    """

    system: System
    quantity: str | None = None
    labelling: Labelling = LABELLING
    execution: Execution = EXECUTION

    @property
    def rows(self) -> list[str]:
        """Quantities whose peak-to-peak counts."""
        model = self.system.model
        known, stations = [*self.system.states, *model.outputs], stations_of(model)
        if self.quantity is None:
            rows = [s.name for s in model.swing] or [axis for pair in stations.values() for axis in pair]
            if not rows:
                raise RangeError(f"{model.name} declares no displacement to judge, expected a quantity: {' '.join(known)}")
            return rows
        if self.quantity in known:
            return [self.quantity]
        if self.quantity in stations:
            return list(stations[self.quantity])
        raise RangeError(
            f"{model.name} has no station, state or output {self.quantity!r}."
            f"{nearest(self.quantity, [*stations, *known])}"
            f"\n  stations: {' '.join(stations) or 'none'}\n  states and outputs: {' '.join(known)}"
        )

    @property
    def not_judged(self) -> list[str]:
        """Stations that do not count; of one whose x or y counts, the other."""
        judged, left = self.rows, list[str]()
        for name, pair in stations_of(self.system.model).items():
            axes = [axis for axis in pair if axis not in judged]
            left += [name] if len(axes) == len(pair) else axes
        return left

    def __call__(self, values: Mapping[str, Array], limits: Array, *, starts: Array | None = None) -> xr.Dataset:
        """Judge points, each from a cold start or from its own.

        Parameters
        ----------
        values : mapping of str to array, shape (point,)
        limits : array, shape (point,)
            Largest peak-to-peak displacement that is allowed, in the model's length.
        starts : array, shape (state, point), optional

        Returns
        -------
        xr.Dataset
            That of `label_points` with ``end_state``, and ``amplitude``, ``tooth_contact`` and ``verdict``.
        """
        ds = label_points(
            self.system, values, starts=starts, ends=True, labelling=self.labelling, execution=self.execution
        )
        swing = ds["peak_to_peak"].sel(quantity=self.rows).max("quantity", skipna=False).values
        touching = self._tooth_contact(values, ds)
        ds["amplitude"] = amplitude_variable("point", swing, self.rows)
        ds["tooth_contact"] = contact_variable("point", touching)
        ds["verdict"] = verdict_variable("point", verdicts(ds["regime"].values, swing, limits, touching))
        return ds

    def _tooth_contact(self, values: Mapping[str, Array], ds: xr.Dataset) -> Array:
        """Share of the time in which the teeth touch: over one return, or 8 turns of the slow harmonic of a locked motion.

        NaN without teeth, and for all other motions.
        """
        regime, out = ds["regime"].values, np.full(ds.sizes["point"], np.nan)
        returns = np.where(regime == Regime.periodic, ds["period_common"].values, 0)
        judged = (returns > 0) | (regime == Regime.locked)
        if self.system.model.teeth is None or not self.system.model.forced or not judged.any():
            return out
        for group in order_groups(self.system, parameter_values(self.system, values), values):
            these = group.members[judged[group.members]]
            if not these.size:
                continue
            some = {name: column[these] for name, column in values.items()}
            ensemble = self.left(some, ds["end_state"].values[these], ds["steps"].values[these])
            ensemble.turns[:] = ds["end_periods"].values[these]
            open_motion = record_periods(ensemble.orders, self.labelling.settling.keep, MANY)
            periods = np.where(returns[these] > 0, returns[these] * group.common_multiple, open_motion)
            out[these] = tooth_contact(ensemble, periods, self.execution.progress)
        return out

    def left(self, values: Mapping[str, Array], ends: Array, steps: NDArray[np.int64]) -> Ensemble:
        """Motions where they were left, states of shape (point, state), with their steps or those of others."""
        integration = Integration(self.labelling.integration.method, steps)
        return make_ensemble(self.system, values, starts=ends.T, integration=integration, execution=self.execution)[0]


def verdicts(regime: ArrayLike, amplitude: ArrayLike, limit: ArrayLike, touching: ArrayLike = np.nan) -> NDArray[np.int8]:
    """Verdict of every point from its regime, its amplitude and the share of the time in which its teeth touch."""
    labels, swing = np.asarray(regime), np.asarray(amplitude)
    parted = np.where(np.less(touching, 1), Verdict.separation, Verdict.safe)
    out = np.where(swing <= limit, parted, Verdict.amplitude)
    for label, why in REASONS.items():
        out = np.where(labels == label, why, out)
    return out.astype(np.int8)


def speed_of(system: System) -> str:
    """Name of the parameter that is the speed, or `RangeError` for a model that declares none."""
    if not system.speed:
        raise RangeError(f"{system.model.name} declares no speed=...: safe speeds are those of a model with one")
    return system.speed


def shaft_speed(system: System) -> float:
    """Speed of the first shaft at ``s = 1`` [rad/s], or NaN for a system without dimensions."""
    return float(Dimensions(system).worth("rotation"))


def force_unit(system: System) -> float:
    """The force [N] that the model's forces are in units of, or NaN for a system without dimensions."""
    return float(Dimensions(system).worth("force"))


def clearance(system: System) -> float:
    """The length [m] that the model's lengths are in units of, or NaN for a system without dimensions."""
    return float(Dimensions(system).worth("length"))


def verdict_variable(dims: Any, values: ArrayLike) -> tuple[Any, ...]:
    """Verdicts, with CF flags."""
    codes = np.asarray(values, dtype=np.int8)
    return variable(dims, codes, "1", "whether the speed is safe, else why not", **flags(Verdict))


def amplitude_variable(dims: Any, values: ArrayLike, rows: Sequence[str]) -> tuple[Any, ...]:
    """Peak to peak of the judged quantities."""
    return variable(dims, values, "1", f"peak to peak of {', '.join(rows)}, the largest", measure="length")


def contact_variable(dims: Any, values: ArrayLike) -> tuple[Any, ...]:
    """Share of the time in which the teeth touch."""
    return variable(dims, values, "1", "share of the time in which the driving flanks press on each other")
