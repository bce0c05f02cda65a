"""Values of one or two design parameters compared: the widest safe window of speed, and the largest amplitude.

1. Every combination of the values is a machine of its own, made from the case, so that all groups follow a changed input.
2. All machines are judged at the same speeds of the first shaft, from cold starts (`judge_machines`).
3. Once more, at values between the neighbours of the design with the widest window, and of the one with the lowest worst
   amplitude.
4. These two designs are judged in run-up and run-down as well. Where that makes another design the best, so is this one.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any, Unpack

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from whirlmap.errors import RangeError, counted, nearest
from whirlmap.integrate.division import cores
from whirlmap.integrate.own_units import in_own_units
from whirlmap.integrate.ranges import Range, read_numbers
from whirlmap.integrate.system import System
from whirlmap.kernels.writing.routine import LANES
from whirlmap.options.computed import LABELLING, Labelling
from whirlmap.options.execution import EXECUTION, Execution
from whirlmap.options.taking import LabellingParts
from whirlmap.results.schema import variable
from whirlmap.sweep.diagrams.in_batches import BATCH
from whirlmap.sweep.interruptible import Work, batches, in_parts
from whirlmap.sweep.parameters.engineering import number_of_limit
from whirlmap.sweep.speeds.designs import judge_machines
from whirlmap.sweep.speeds.safe_speeds import refuse_speeds
from whirlmap.sweep.speeds.verdicts import Judge, Verdict, clearance, shaft_speed, speed_of
from whirlmap.sweep.speeds.windows import widest_window

Array = NDArray[np.float64]

#: Parts of the distance to a neighbouring value in the refinement, for one and for two parameters.
PARTS = {1: 4, 2: 2}


@in_parts("improve")
def improve(
    make: Callable[..., System],
    vary: Mapping[str, ArrayLike],
    speeds: ArrayLike,
    limit: float | str,
    *,
    units: Mapping[str, str] | None = None,
    refine: bool = True,
    follow: bool = True,
    quantity: str | None = None,
    labelling: Labelling = LABELLING,
    execution: Execution = EXECUTION,
    **_given: Unpack[LabellingParts],
) -> Work:
    """Compare values of one or two design parameters by what they do to the safe speeds.

    Parameters
    ----------
    make : callable
        ``make(**changes) -> System``, as ``functools.partial(whirlmap.load, "gear-psfd/machine")``; without changes the
        machine as it is, whose ``s`` and length count.
    vary : mapping of str to array
        Values, ascending, of one or two parameters or dimensional inputs; texts with a unit, ``["60 um", "80 um"]``, or the
        text of a range, ``"60um:120um:5"``.
    speeds : array_like, shape (s,)
        Values of ``s`` of the machine as it is, as of `safe_speeds`; every design runs at the same speed of the first shaft
        [rad/s].
    limit : float or str
        Largest peak-to-peak displacement that is allowed, in clearances of the machine as it is, or with its unit.
    units : mapping of str to str, optional
        Units of the dimensional inputs whose values are plain numbers.
    refine : bool
        Whether values around the best are tried as well.
    follow : bool
        Whether the best designs are judged in run-up and run-down too.
    quantity : str, optional
        As in `safe_speeds`.
    labelling : Labelling, optional
        How points are measured; or its parts as keywords, ``settling``, ``lyapunov``, ``method``, ``steps``, ``accuracy``.
    execution : Execution, optional
        How it is run, which changes no number; or its parts as keywords, ``workers``, ``progress``.

    Returns
    -------
    xr.Dataset
        Over ``design``, in the order tried: the varied parameters as coordinates, ``refined``, ``followed`` (judged in
        run-up and run-down), ``window_start``, ``window_end``, ``window_width`` of the widest safe window, ``safe_share``
        of the speeds, ``worst_amplitude`` over the speeds (NaN where a run did not reach its end), ``ended`` (how many),
        ``front`` (no other design is better in width and amplitude both). Over ``(design, s)``: ``verdict``, ``amplitude``.
        Speeds are values of ``s``, lengths clearances, of the machine as it is. ``attrs["widest"]`` and ``attrs["calmest"]``
        are the numbers of the two best designs; ``calmest`` is -1 where no design ran at all speeds.

    Raises
    ------
    RangeError
        None or more than two parameters; values that do not ascend; speeds that do not ascend or are not positive; a limit
        that is not positive; the speed or a number of teeth as a parameter; a unit of what is not varied, or a second one.
    InputError
        A unit where the case has no dimensions, or none where it needs one.

    Notes
    -----
    A window ends where the amplitude crosses the limit, linear between two speeds, or at the last safe speed where the next
    one is forbidden by its motion. What is narrower than the spacing of the speeds is not seen. Coexisting motions are
    sought in the best designs alone, so that the others may look better than they are, never worse. ``improve.parts`` gives
    the `Work` in batches of designs: who stops keeps those that are finished.
    """
    system = make()
    axes, units = _axes(vary, units or {})
    _refuse_axes(axes, system)
    _, at = in_own_units(system, speed_of(system), speeds, "speeds")
    limit = number_of_limit(system, limit)
    refuse_speeds(at, limit)
    judge = Judge(system, quantity, labelling, execution)
    trial = _Trial(make, tuple(axes), units, at, limit, judge)
    most = max(BATCH * LANES * (execution.workers or cores()) // at.size, 1)
    designs: list[xr.Dataset] = []  # each with one design
    given = wanted = int(np.prod([v.size for v in axes.values()]))
    stage = "the values given"

    def parts(work: Work) -> Iterator[int]:
        nonlocal stage, wanted
        for part in trial.in_batches(list(product(*axes.values())), most, refined=False):
            designs.extend(part)
            yield work.done + len(part)
        if refine:
            stage = "the values around the best"
            more = _around(_joined(designs), axes)
            work.total = wanted = given + len(more)
            for part in trial.in_batches(more, most, refined=True):
                designs.extend(part)
                yield work.done + len(part)
        stage = "the run-up and run-down of the best"
        while follow and (best := [i for i in _best(_joined(designs)) if not designs[i]["followed"].item()]):
            work.total = work.done + len(best)
            for i in best:
                designs[i] = trial.followed(designs[i])
                yield work.done + 1
        stage = ""
        work.total = work.done

    def gather(work: Work) -> xr.Dataset | None:
        if not designs:
            return None
        ds = _joined(designs)
        ds["front"] = variable("design", _front(ds), "1", "1 where no other design is better in width and amplitude both")
        rpm = shaft_speed(system) * 30 / np.pi
        if np.isfinite(rpm):
            ds = ds.assign_coords(rpm=(system.speed, at * rpm, {"units": "rpm", "long_name": "speed of the first shaft"}))
        ds = ds.assign_attrs(limit=limit, varied=" ".join(axes), widest=widest(ds), calmest=calmest(ds))
        if stage:
            work.total = max(work.total, work.done + 1)
            ds.attrs["incomplete"] = f"interrupted in {stage}, after {min(work.done, wanted)} of {counted(wanted, 'design')}"
        return ds

    return Work(given, parts, gather)


def _axes(vary: Mapping[str, ArrayLike], units: Mapping[str, str]) -> tuple[dict[str, Array], dict[str, str]]:
    """Values of each design parameter, and the units of those that have one."""
    for name in units:
        if name not in vary:
            raise RangeError(f"units: found {name!r}, which is not varied.{nearest(name, vary)} Varied: {' '.join(vary)}")
    axes, found = {}, dict(units)
    for name, values in vary.items():
        if isinstance(values, str) and ":" in values:
            parsed = Range.parse(f"{name}={values}", "vary")
            axes[name], unit = parsed.values, parsed.unit
        else:
            axes[name], unit = read_numbers(name, values)
        if unit and found.setdefault(name, unit) != unit:
            raise RangeError(f"{name}: found the unit {unit!r} in its values and {found[name]!r} in units, expected one")
    return axes, found


def _refuse_axes(axes: Mapping[str, Array], system: System) -> None:
    if not 1 <= len(axes) <= 2:
        raise RangeError(f"found {counted(len(axes), 'design parameter')}, expected one or two")
    for name, values in axes.items():
        if name in (speed_of(system), system.machine and system.machine.speed_input):
            raise RangeError(f"{name!r} is the speed, which every design runs through: it is no design parameter")
        if values.ndim != 1 or values.size < 2 or not np.isfinite(values).all() or np.any(np.diff(values) <= 0):
            raise RangeError(f"values of {name!r} must be finite and ascend, and be two or more")


def _around(ds: xr.Dataset, axes: Mapping[str, Array]) -> list[tuple[float, ...]]:
    """Designs between the neighbours of the best ones, without those that were tried."""
    known = set(zip(*(ds[name].values.tolist() for name in axes), strict=True))
    finer = {d for i in _best(ds) for d in product(*(_between(v, float(ds[n][i]), len(axes)) for n, v in axes.items()))}
    return sorted(finer - known)


def _joined(designs: Sequence[xr.Dataset]) -> xr.Dataset:
    return xr.concat(designs, "design", data_vars="minimal", coords="minimal", compat="override", combine_attrs="override")


def _best(ds: xr.Dataset) -> list[int]:
    return list(dict.fromkeys(i for i in (widest(ds), calmest(ds)) if i >= 0))


def widest(ds: xr.Dataset) -> int:
    """Number of the design with the widest window; of equals, the one with the lower worst amplitude."""
    worst = np.where(np.isfinite(ds["worst_amplitude"].values), ds["worst_amplitude"].values, np.inf)
    return int(np.lexsort((worst, -ds["window_width"].values))[0])


def calmest(ds: xr.Dataset) -> int:
    """Number of the design with the lowest worst amplitude; -1 where no design ran at all speeds."""
    worst = ds["worst_amplitude"].values
    return int(np.nanargmin(worst)) if np.isfinite(worst).any() else -1


@dataclass(frozen=True)
class _Trial:
    """What all designs share."""

    make: Callable[..., System]
    names: tuple[str, ...]
    units: Mapping[str, str]
    at: Array
    limit: float
    judge: Judge

    def in_batches(
        self, designs: list[tuple[float, ...]], most: int, *, refined: bool
    ) -> Iterator[list[xr.Dataset]]:
        """Judge designs from cold starts, batch by batch, each a Dataset of its own."""
        for place in batches(len(designs), first=1, most=most):
            part = designs[place]
            ds = self.run(part, refined=refined, follow=False)
            yield [ds.isel(design=[i]) for i in range(len(part))]

    def followed(self, one: xr.Dataset) -> xr.Dataset:
        """Judge a design in run-up and run-down as well."""
        return self.run([tuple(one[n].item() for n in self.names)], refined=bool(one["refined"].item()), follow=True)

    def run(self, designs: list[tuple[float, ...]], *, refined: bool, follow: bool) -> xr.Dataset:
        """Judge designs."""
        machines = [self.make(**{n: self._text(n, v) for n, v in zip(self.names, d, strict=True)}) for d in designs]
        lengths = np.array([clearance(m) for m in machines]) / clearance(self.judge.system)
        lengths = np.where(np.isfinite(lengths), lengths, 1.0)
        j = self.judge
        judged = judge_machines(
            j.system, machines, self.at, self.limit / lengths, quantity=j.quantity, follow=follow, labelling=j.labelling,
            execution=j.execution,
        )  # fmt: skip
        ds = judged.rename(machine="design")
        ds["amplitude"] = ds["amplitude"].copy(data=ds["amplitude"].values * lengths[:, None])
        swing, safe = ds["amplitude"].values, ds["verdict"].values == Verdict.safe
        ended = ~np.isfinite(swing)
        spans = np.array([
            widest_window(self.at, s, v, self.limit) for s, v in zip(swing, ds["verdict"].values, strict=True)
        ])  # fmt: skip
        worst = np.where(ended.any(axis=1), np.nan, np.where(ended, 0, swing).max(axis=1))
        for name, values, meaning in (
            ("window_start", spans[:, 0], "first speed ratio of the widest safe window"),
            ("window_end", spans[:, 1], "last speed ratio of the widest safe window"),
            ("window_width", np.nan_to_num(spans[:, 1] - spans[:, 0]), "width of the widest safe window"),
            ("safe_share", safe.mean(axis=1), "share of the speeds that are safe"),
            ("worst_amplitude", worst, "largest peak to peak over all speeds"),
            ("ended", ended.sum(axis=1), "speeds at which the run did not reach its end"),
            ("refined", np.full(len(designs), int(refined)), "1 where the design was tried in the refinement"),
            ("followed", np.full(len(designs), int(follow)), "1 where it was judged in run-up and run-down as well"),
        ):  # fmt: skip
            ds[name] = variable("design", values, "1", meaning)
        for k, name in enumerate(self.names):
            unit = self.units.get(name, "1")
            ds = ds.assign_coords({name: variable("design", [d[k] for d in designs], unit, name)})
        return ds

    def _text(self, name: str, value: float) -> Any:
        return f"{float(value)!r} {self.units[name]}" if name in self.units else float(value)


def _between(values: Array, best: float, parameters: int) -> list[float]:
    """Values between the neighbours of the best one, itself among them."""
    i, parts = int(np.flatnonzero(values == best)[0]), PARTS[parameters]
    even = values.size > 2 and values[0] > 0 and np.allclose(np.diff(np.log(values)), np.log(values[1] / values[0]))
    space = np.geomspace if even else np.linspace
    out = [best]
    for j in (i - 1, i + 1):
        if 0 <= j < values.size:
            out += space(best, values[j], parts + 1)[1:-1].tolist()
    return sorted(out)


def _front(ds: xr.Dataset) -> NDArray[np.int8]:
    width = ds["window_width"].values
    worst = np.where(np.isfinite(ds["worst_amplitude"].values), ds["worst_amplitude"].values, np.inf)
    no_worse = (width[:, None] >= width) & (worst[:, None] <= worst)
    better = (width[:, None] > width) | (worst[:, None] < worst)
    return np.asarray(~(no_worse & better).any(axis=0), dtype=np.int8)
