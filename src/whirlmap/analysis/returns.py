"""Settle many operating points and say which of them are periodic, and after how many T.

1. Run the transient.
2. Record a window of common periods and look for a return after m of them, m up to half of the window.
3. Points that return are done; for the others the window doubles, until m has been tried up to 64. As the window moves
   on while it grows, a slow transient also gets more time.
4. From all points, record the section once per T for the diagram, with extremes over every step. In periodic points it
   then gives the smallest number of T.

An unforced model is cut at its declared section instead, and the return is counted in crossings; its windows are as many
typical times as would be common periods.

The tolerance is relative to each state's range over the last recorded stretch (`periodicity.return_multiple`).
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.crossing import crossings
from whirlmap.analysis.periodicity import period_in_T, return_multiple
from whirlmap.errors import RangeError
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.results.regime import Regime
from whirlmap.results.status import Status

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass(frozen=True)
class Settling:
    """How long to wait and how sure to be.

    Attributes
    ----------
    transient : int
        Common periods that are run before anything is looked at.
    first_window : int
        Common periods of the first window; a return is sought up to half of it.
    most : int
        Largest return that is sought, in common periods.
    keep : int
        Least number of T that are recorded once settled; at least two common periods are.
    tolerance : float
        Largest difference that counts as a return, relative to the range of each state.
    """

    transient: int = 100
    first_window: int = 8
    most: int = 64
    keep: int = 64
    tolerance: float = 1e-6

    def __post_init__(self) -> None:
        """Refuse counts that make no sense, naming the one."""
        for name, least in (("transient", 0), ("first_window", 2), ("most", 1), ("keep", 1)):
            value = getattr(self, name)
            if not least <= value <= 10_000_000:
                raise RangeError(f"{name} must lie between {least} and 10000000, not {value}")
        if not 0 < self.tolerance < 1:
            raise RangeError(f"tolerance must lie between 0 and 1, not {self.tolerance}")


@dataclass(frozen=True)
class Returns:
    """Section and label of every operating point; arrays end in the point axis.

    Attributes
    ----------
    section : array, shape (period, state, point)
        Once per T, in the order of time; NaN where a point has ended.
    regime : array of int
        `Regime`: periodic, contact, diverged or undecided.
    period, multiple : array of int
        Smallest return in T, and in common periods; of an unforced model both in crossings. 0 where there is none.
    distance : array
        The return distance that decided.
    extremes : dict of arrays, shape (row, point)
        Of every state and output over the recorded stretch.
    """

    section: Array
    regime: NDArray[np.int8]
    period: Integers
    multiple: Integers
    distance: Array
    extremes: dict[str, Array]


def settle_and_record(
    ensemble: Ensemble,
    settling: Settling,
    *,
    cyclic: dict[int, float] | None = None,
    progress: Callable[[int], None] | None = None,
) -> Returns:
    """Run the four steps above on an ensemble, in place."""
    common, steps = ensemble.common_multiple, ensemble.steps
    n = ensemble.points
    if settling.transient:
        ensemble.advance(settling.transient * common, progress=progress)
    multiple, distance = np.zeros(n, dtype=np.int64), np.full(n, np.nan)
    scale = np.full((ensemble.model.dimension, n), np.nan)
    window = min(settling.first_window, 2 * settling.most)
    left = np.flatnonzero(ensemble.running)
    while left.size:
        part = ensemble.subset(left)
        points, size = _window(part, window, progress)
        ensemble.absorb(part, left)
        alive = np.flatnonzero(part.running)
        most = min(window, points.shape[0]) // 2
        if alive.size and most:
            found = return_multiple(
                points[:, :, alive], scale=_positive(size[:, alive]), tolerance=settling.tolerance, most=most, cyclic=cyclic
            )  # fmt: skip
            multiple[left[alive]] = found["multiple"].values
            distance[left[alive]] = found["distance"].values
            scale[:, left] = size
        left = left[part.running & (multiple[left] == 0)]
        if window >= 2 * settling.most:
            break
        window = min(2 * window, 2 * settling.most)
    kept = common * max(-(-settling.keep // common), 2)
    segment = ensemble.advance(kept, save_every=steps, extremes=True, progress=progress)
    assert segment.extremes is not None
    forced = ensemble.model.forced
    period = _periods_in_T(segment.saved, multiple, scale, common, settling, cyclic) if forced else multiple.copy()
    multiple = np.where(ensemble.running, multiple, 0)
    period = np.where(ensemble.running, period, 0)
    return Returns(segment.saved, _labels(ensemble, multiple), period, multiple, distance, segment.extremes)


def _window(ensemble: Ensemble, window: int, progress: Callable[[int], None] | None) -> tuple[Array, Array]:
    """Section points of the next window, (period, state, point), and the range of every state over it."""
    common, n = ensemble.common_multiple, ensemble.model.dimension
    forced = ensemble.model.forced
    begin = ensemble.x.copy()
    every = common * ensemble.steps if forced else 1
    segment = ensemble.advance(window * common, save_every=every, extremes=True, progress=progress)
    assert segment.extremes is not None
    size = (segment.extremes["maximum"] - segment.extremes["minimum"])[:n]
    if forced:
        return segment.saved, size
    x = np.concatenate([begin[None], segment.saved])
    points, times = crossings(ensemble.model, ensemble.values, x, ensemble.period / ensemble.steps)
    shared = int(np.isfinite(times).sum(axis=0)[ensemble.running].min(initial=points.shape[0]))
    return points[:shared], size


def _positive(size: Array) -> Array:
    """Ranges, with those of states that do not move at all made one: their differences are zero anyway."""
    return np.where(size > 0, size, 1.0)


def _periods_in_T(
    section: Array, multiple: Integers, scale: Array, common: int, settling: Settling, cyclic: dict[int, float] | None
) -> Integers:
    """Smallest return in T; a return longer than the recorded stretch is the whole multiple of the common period."""
    out = multiple * common
    fits = np.flatnonzero((multiple > 0) & (out <= section.shape[0]) & np.isfinite(section[-1]).all(axis=0))
    if fits.size and common > 1:
        found = period_in_T(
            section[:, :, fits], multiple[fits], common_over_T=common, scale=_positive(scale[:, fits]),
            tolerance=10 * settling.tolerance, cyclic=cyclic,
        )  # fmt: skip
        out[fits] = np.where(found["period"].values > 0, found["period"].values, out[fits])
    return out


def _labels(ensemble: Ensemble, multiple: Integers) -> NDArray[np.int8]:
    label = np.where(multiple > 0, Regime.periodic, Regime.undecided)
    label = np.where(ensemble.status == Status.contact, Regime.contact, label)
    return np.where(ensemble.status == Status.diverged, Regime.diverged, label).astype(np.int8)
