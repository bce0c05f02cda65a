"""Diagrams in batches, so that Ctrl-C keeps the finished ones.

The numbers do not depend on the batches: points never see each other, and a chain hands its state on from one batch to the
next.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Unpack

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from whirlmap.analysis.labels.measured import NUMBERS
from whirlmap.analysis.motion.ensembles import parameter_values
from whirlmap.analysis.motion.record_length import record_periods
from whirlmap.equations.model import Model
from whirlmap.integrate.division import cores
from whirlmap.integrate.orders import order_groups, orders_vary
from whirlmap.integrate.ranges import Range
from whirlmap.integrate.system import System
from whirlmap.kernels.writing.routine import LANES
from whirlmap.options.computed import LABELLING, Labelling, Settling
from whirlmap.options.execution import EXECUTION, Execution
from whirlmap.options.taking import LabellingParts, takes_options
from whirlmap.results.memory import refuse_memory
from whirlmap.results.status import Status
from whirlmap.sweep.diagrams.diagram import Follow, bifurcation_diagram, kept_states, select_states
from whirlmap.sweep.diagrams.hysteresis import with_hysteresis
from whirlmap.sweep.interruptible import Work, batches
from whirlmap.sweep.parameters.axis import Axis
from whirlmap.sweep.points.point_variables import doubts

Array = NDArray[np.float64]

#: Blocks of lanes in a batch at most, and in the first one, for each worker.
BATCH, FIRST = 32, 4

#: Points of a chain in one batch at most; a chain walks them one by one.
CHAIN = 16

#: Values that stand at points which an interrupted sweep did not reach, in variables that cannot hold NaN.
NOT_REACHED = {number.name: int(number.absent) for number in NUMBERS if not np.isnan(number.absent)}


@takes_options()
def diagram_in_batches(
    system: System,
    parameter: str,
    values: ArrayLike | Range | Axis,
    *,
    follow: Follow | None = None,
    states: Sequence[str] | None = None,
    batch: int | None = None,
    labelling: Labelling = LABELLING,
    execution: Execution = EXECUTION,
    **_given: Unpack[LabellingParts],
) -> Work:
    """Bifurcation diagram as work in batches: whoever iterates may stop, and keeps what is finished.

    Parameters
    ----------
    batch : int, optional
        Points in a batch; where absent as many as take some seconds (`interruptible.batches`), `BATCH` blocks of lanes for
        each worker at most, or `CHAIN` where the state is followed.

    Other parameters are those of `bifurcation_diagram`, and so is the Dataset. Where a sweep in both
    directions was interrupted on its way down, points not reached have ``status`` failed.
    """
    axis = Axis.of(system, parameter, values, "values")
    parameter, points = axis.name, axis.values
    # This refuses now what the last batch would meet.
    groups = order_groups(system, parameter_values(system, axis.columns), axis.columns)
    common = max(group.strobe for group in groups)
    ways: tuple[Any, ...] = ("up", "down") if follow == "both" else (follow,)
    block = LANES * (execution.workers or cores())
    size = batch or (BATCH * block if follow is None else CHAIN)
    first = batch or (FIRST * block if follow is None else 1)
    even = system.model.forced and not orders_vary(system.model, axis.columns)
    if follow is not None and not even:
        first = size = points.size  # the last row of its section is not the state at the end of each record
    refuse_memory(
        "the diagram", 2 * len(ways) * points.size * max(record_periods(g.orders, labelling.settling.keep) for g in groups)
        * len(kept_states(system, states))
        + min(size, points.size) * 2 * labelling.settling.most * common * system.model.dimension,
    )  # fmt: skip
    options = {"labelling": labelling, "execution": execution}
    kept = kept_states(system, states)
    sweeps = [
        _Sweep(parameter, points.size, backwards=way == "down", even=even) for way in ways
    ]  # fmt: skip

    def parts(work: Work) -> Iterator[int]:
        for way, sweep in zip(ways, sweeps, strict=True):
            for part in _parts(system, axis, way, (first, size), kept, options):
                sweep.take(part)
                yield work.done + part.sizes[parameter]

    def gather(work: Work) -> xr.Dataset | None:
        ds = _joined(sweeps, parameter, points, follow, system.model)
        if ds is not None and "direction" in ds.dims:
            ds = with_hysteresis(ds, system, parameter)
        if ds is not None and not work.complete:
            ds.attrs["incomplete"] = f"interrupted after {work.done} of {work.total} points"
        return ds

    return Work(points.size * len(ways), parts, gather)


def _parts(
    system: System, axis: Axis, way: Follow | None, sizes: tuple[int, int], kept: list[str],
    options: dict[str, Any],
) -> Iterator[xr.Dataset]:  # fmt: skip
    now, count = system, axis.values.size
    every = kept if way is None else system.states  # a chain goes on from the whole state
    for place in batches(count, first=sizes[0], most=sizes[1]):
        part = axis.take(slice(count - place.stop, count - place.start) if way == "down" else place)
        ds = bifurcation_diagram(now, axis.name, part, follow=way, states=every, **options)
        yield ds if way is None else select_states(ds, system, kept)
        if way is not None and place.stop < count:
            last = ds.isel({axis.name: 0 if way == "down" else -1})
            state = last["section"].isel(period=-1).values
            ran = int(last["status"]) == Status.ok
            now = _from(system, state) if ran else system


def _from(system: System, x: Array) -> System:
    """Return the system, started from these states."""
    return system.replace(start=dict(zip(system.states, x.tolist(), strict=True)))


class _Sweep:
    """Parts of a sweep in one direction, written where they belong as they come: a large diagram is not in memory twice.

    Sections of unforced models, and of points with different common periods, differ in length. Such parts are kept, and
    joined at the end with NaN where one is shorter.
    """

    def __init__(self, dim: str, total: int, *, backwards: bool, even: bool) -> None:
        self.dim, self.total, self.backwards, self.even = dim, total, backwards, even
        self.done, self.parts, self.attrs = 0, list[xr.Dataset](), dict[Any, Any]()
        self._whole: dict[Any, tuple[Any, NDArray[Any], dict[Any, Any]]] = {}
        self._rest, self._beside = xr.Dataset(), list[str]()  # coordinates along the dimension, other than its own

    def take(self, part: xr.Dataset) -> None:
        """Take over the next part."""
        count = part.sizes[self.dim]
        if not self.done:
            self.attrs = part.attrs  # it began where the user said
            along = {name: v for name, v in part.variables.items() if self.dim in v.dims}
            self._rest = part.drop_vars(list(along))
            self._beside = [str(name) for name in part.coords if name in along and name != self.dim]
            if self.even:
                self._whole = {k: (v.dims, np.empty((self.total, *v.shape[1:]), v.dtype), v.attrs) for k, v in along.items()}
        first = self.total - self.done - count if self.backwards else self.done
        for name, (dims, whole, _) in self._whole.items():
            assert dims[0] == self.dim, name
            whole[first : first + count] = part.variables[name].values
        if not self.even:
            self.parts.insert(0 if self.backwards else len(self.parts), part)
        self.done += count

    def dataset(self) -> xr.Dataset | None:
        """Give what is finished; None where nothing is."""
        if not self.done:
            return None
        if self.parts:
            return _concat(self.parts, self.dim) if len(self.parts) > 1 else self.parts[0]
        first = self.total - self.done if self.backwards else 0
        made = {name: (dims, v[first : first + self.done], attrs) for name, (dims, v, attrs) in self._whole.items()}
        coordinate = made.pop(self.dim)
        return self._rest.assign(made).assign_coords({self.dim: coordinate}).set_coords(self._beside)


def _joined(
    sweeps: list[_Sweep], parameter: str, points: Array, follow: Follow | None, model: Model
) -> xr.Dataset | None:
    made = [ds for sweep in sweeps if (ds := sweep.dataset()) is not None]
    if not made:
        return None
    ds = made[0]
    if len(made) > 1:
        if made[1].sizes[parameter] < points.size:
            meta = {name: v.attrs for name, v in made[1].variables.items()}
            beside = {name: ds.variables[name] for name in ds.coords if ds[name].dims == (parameter,)}
            made[1] = made[1].reindex({parameter: ds[parameter]}, fill_value=_fill(made[1])).assign_coords(beside)
            for name, own in meta.items():
                made[1][name].attrs = own
        ds = _concat(made, "direction")
    kept = {k: v for k, v in sweeps[0].attrs.items() if k not in ("accuracy_not_met", "grazing")}
    ds.attrs = kept | {"follow": follow or "none"} | doubts(ds, model)
    return ds


def _fill(ds: xr.Dataset) -> dict[Any, Any]:
    return {name: NOT_REACHED.get(str(name), np.nan) for name in ds.data_vars}


def _concat(parts: list[xr.Dataset], dim: str) -> xr.Dataset:
    """Join along a dimension; sections that differ in length are filled with NaN."""
    joined: xr.Dataset = xr.concat(
        parts, dim=dim, join="outer", data_vars="minimal" if dim != "direction" else "all", coords="minimal",
        compat="equals", combine_attrs="override",
    )  # fmt: skip
    return joined


def expected_periods(
    system: System, points: int, settling: Settling, vary: Mapping[str, ArrayLike] | None = None
) -> int:
    """Periods T that a diagram takes at least, over all points: what a progress bar begins with.

    ``vary`` are the varied parameters, where frequencies may be among them.
    """
    each = settling.transient + min(settling.first_window, 2 * settling.most)
    groups = order_groups(system, parameter_values(system, vary or {}), vary or {})
    repeats = points // sum(g.members.size for g in groups)  # sweeps up and down
    return repeats * sum(g.members.size * (each * g.strobe + record_periods(g.orders, settling.keep)) for g in groups)
