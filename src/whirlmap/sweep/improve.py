"""Values of one or two design parameters compared: the widest safe window of speed, and the largest amplitude.

1. Every combination of the values is a machine of its own, made from the case, so that all groups follow a changed input.
2. All machines are judged at the same speeds of the first shaft, from cold starts (`judge_machines`).
3. Once more, at values between the neighbours of the design with the widest window, and of the one with the lowest worst
   amplitude.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from whirlmap.errors import RangeError
from whirlmap.integrate.system import System
from whirlmap.results.schema import variable
from whirlmap.sweep.speeds import SPEED, Verdict, clearance, judge_machines, shaft_speed

Array = NDArray[np.float64]

#: Parts of the distance to a neighbouring value in the refinement, for one and for two parameters.
PARTS = {1: 4, 2: 2}


def improve(
    make: Callable[..., System],
    vary: Mapping[str, ArrayLike],
    speeds: ArrayLike,
    limit: float,
    *,
    units: Mapping[str, str] | None = None,
    refine: bool = True,
    quantity: str | None = None,
    **options: Any,
) -> xr.Dataset:
    """Compare values of one or two design parameters by what they do to the safe speeds.

    Parameters
    ----------
    make : callable
        ``make(**changes) -> System``, as ``functools.partial(whirlmap.load, "gear-psfd/machine")``; without changes the
        machine as it is, whose ``s`` and length count.
    vary : mapping of str to array
        Values, ascending, of one or two parameters or dimensional inputs.
    speeds : array_like, shape (s,)
        Values of ``s`` of the machine as it is; every design runs at the same speed of the first shaft [rad/s].
    limit : float
        Largest peak-to-peak displacement that is allowed, in clearances of the machine as it is.
    units : mapping of str to str, optional
        Units of the dimensional inputs among them.
    refine : bool
        Whether values around the best are tried as well.
    quantity : str, optional
        As in `safe_speeds`.
    **options
        Those of `label_points`.

    Returns
    -------
    xr.Dataset
        Over ``design``, in the order tried: the varied parameters as coordinates, ``refined``, ``window_start``,
        ``window_end``, ``window_width`` of the widest safe window, ``safe_share`` of the speeds, ``worst_amplitude`` over
        the speeds (NaN where a run did not reach its end), ``ended`` (how many did not), ``front`` (no other design is
        better in width and amplitude both). Over ``(design, s)``: ``verdict``, ``amplitude``. Speeds are values of ``s``,
        lengths clearances, of the machine as it is. ``attrs["widest"]`` and ``attrs["calmest"]`` are the numbers of the two
        best designs; ``calmest`` is -1 where no design ran at all speeds.

    Raises
    ------
    RangeError
        None or more than two parameters; values that do not ascend; speeds that do not ascend or are not positive; a limit
        that is not positive; the speed or a number of teeth as a parameter.

    Notes
    -----
    A window ends where the amplitude crosses the limit, linear between two speeds, or at the last safe speed where the next
    one is forbidden by its motion. What is narrower than the spacing of the speeds is not seen, and coexisting motions are
    not sought: judge the chosen design with `safe_speeds`.
    """
    at = np.atleast_1d(np.asarray(speeds, dtype=float))
    axes = {name: np.atleast_1d(np.asarray(v, dtype=float)) for name, v in vary.items()}
    if not 1 <= len(axes) <= 2:
        raise RangeError(f"found {len(axes)} design parameters, expected one or two")
    for name, values in axes.items():
        if name in (SPEED, "speed"):
            raise RangeError(f"{name!r} is the speed, which every design runs through: it is no design parameter")
        if values.ndim != 1 or values.size < 2 or not np.isfinite(values).all() or np.any(np.diff(values) <= 0):
            raise RangeError(f"values of {name!r} must be finite and ascend, and be two or more")
    if at.size < 2 or not np.isfinite(at).all() or at[0] <= 0 or np.any(np.diff(at) <= 0):
        raise RangeError("speeds must be positive and ascend, and be two or more")
    if not 0 < limit < np.inf:
        raise RangeError(f"the limit must be a positive length, not {limit:g}")
    trial = _Trial(make, tuple(axes), units or {}, at, limit, {"quantity": quantity, **options}, make())
    ds = trial.run(list(product(*axes.values())), refined=False)
    if refine:
        known = set(zip(*(ds[name].values.tolist() for name in axes), strict=True))
        best = dict.fromkeys(i for i in (widest(ds), calmest(ds)) if i >= 0)
        finer = {d for i in best for d in product(*(_between(v, float(ds[n][i]), len(axes)) for n, v in axes.items()))}
        if more := sorted(finer - known):
            ds = xr.concat([ds, trial.run(more, refined=True)], "design", combine_attrs="override")
    ds["front"] = variable("design", _front(ds), "1", "1 where no other design is better in width and amplitude both")
    rpm = shaft_speed(trial.system) * 30 / np.pi
    if np.isfinite(rpm):
        ds = ds.assign_coords(rpm=(SPEED, at * rpm, {"units": "rpm", "long_name": "speed of the first shaft"}))
    return ds.assign_attrs(limit=limit, varied=" ".join(axes), widest=widest(ds), calmest=calmest(ds))


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
    options: Mapping[str, Any]
    system: System

    def run(self, designs: list[tuple[float, ...]], *, refined: bool) -> xr.Dataset:
        """Judge designs."""
        machines = [self.make(**{n: self._text(n, v) for n, v in zip(self.names, d, strict=True)}) for d in designs]
        lengths = np.array([clearance(m) for m in machines]) / clearance(self.system)
        lengths = np.where(np.isfinite(lengths), lengths, 1.0)
        judged = judge_machines(self.system, machines, self.at, self.limit / lengths, **self.options)
        ds = judged.rename(machine="design")
        ds["amplitude"] = ds["amplitude"].copy(data=ds["amplitude"].values * lengths[:, None])
        swing, safe = ds["amplitude"].values, ds["verdict"].values == Verdict.safe
        ended = ~np.isfinite(swing)
        spans = np.array([
            _widest_window(self.at, s, v, self.limit) for s, v in zip(swing, ds["verdict"].values, strict=True)
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


def _widest_window(at: Array, swing: Array, verdict: NDArray[np.int8], limit: float) -> tuple[float, float]:
    """Ends of the widest run of safe speeds, each drawn out to where the amplitude crosses the limit; NaN without any."""
    safe = np.concatenate([[False], verdict == Verdict.safe, [False]])
    best = (np.nan, np.nan)
    for a, b in zip(np.flatnonzero(safe[1:] & ~safe[:-1]), np.flatnonzero(safe[:-1] & ~safe[1:]) - 1, strict=True):
        low, high = (_crossing(at, swing, verdict, limit, int(i), step) for i, step in ((a, -1), (b, 1)))
        if not high - low <= best[1] - best[0]:
            best = (low, high)
    return best


def _crossing(at: Array, swing: Array, verdict: NDArray[np.int8], limit: float, last: int, step: int) -> float:
    beyond = last + step
    if not 0 <= beyond < at.size or verdict[beyond] != Verdict.amplitude:
        return float(at[last])
    return float(at[last] + (at[beyond] - at[last]) * (limit - swing[last]) / (swing[beyond] - swing[last]))


def _front(ds: xr.Dataset) -> NDArray[np.int8]:
    width = ds["window_width"].values
    worst = np.where(np.isfinite(ds["worst_amplitude"].values), ds["worst_amplitude"].values, np.inf)
    no_worse = (width[:, None] >= width) & (worst[:, None] <= worst)
    better = (width[:, None] > width) | (worst[:, None] < worst)
    return np.asarray(~(no_worse & better).any(axis=0), dtype=np.int8)
