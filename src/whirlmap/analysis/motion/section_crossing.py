"""Crossings of an unforced model's section, located within steps as exactly as these are."""

from collections.abc import Callable
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from whirlmap.equations.model import Model
from whirlmap.errors import RangeError
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.kernels.lowering.formulas import Formula, numpy_function
from whirlmap.kernels.methods import Method
from whirlmap.kernels.running.lanes import blocked, lane_kernel, unblocked

Array = NDArray[np.float64]
Points = NDArray[np.intp]

#: Steps of the search for a zero at most (each halves the bracket at least once in two), and part of a step to which a zero
#: is known.
SEARCH, EXACT = 100, 1e-15
#: Numbers of states that are kept at once while crossings are sought.
KEPT = 2_000_000


def surface_of(model: Model) -> Callable[[Array, Array], Array]:
    """Height over the section, positive behind it, as a function of states (state, ...) and parameters.

    Raises
    ------
    RangeError
        Where the model declares no section.
    """
    place = model.section
    if place is None:
        raise RangeError(f"{model.name} is not forced and declares no section: add section=Section(...)")
    height_of = numpy_function(model, "section", lambda: Formula([model.states, model.parameters], [place.surface]))
    sign = 1.0 if place.direction == "rising" else -1.0
    return lambda x, values: sign * np.asarray(height_of(list(x), list(values))[0])


def crossings(
    model: Model, values: Array, x: Array, h: Array, method: Method, *, gone: int = 0
) -> tuple[Array, Array]:
    """Locate every crossing of the model's section in recorded trajectories.

    Parameters
    ----------
    values : array, shape (parameter, point)
    x : array, shape (step, state, point)
        States after every step, the first one included.
    h : array, shape (point,)
        Step.
    method : Method
        With which the steps were taken.
    gone : int
        Steps before the first row of ``x``.

    Returns
    -------
    points : array, shape (crossing, state, point)
        In the order of time; rows beyond a point's last crossing are NaN.
    times : array, shape (crossing, point)
        From ``gone`` steps before the first row of ``x``.

    Raises
    ------
    RangeError
        Where the model declares no section.

    Notes
    -----
    Between the ends of a step the motion is a shorter step of the same method from its beginning, so that a crossing is as
    exact as the steps. Its zero is found by false position, where the end that stays counts half [Dowell and Jarratt 1971].
    """
    surface = surface_of(model)
    height = surface(np.moveaxis(x, 1, 0), values[:, None, :])
    height = np.broadcast_to(height, (x.shape[0], x.shape[2]))
    step, point = np.nonzero((height[:-1] <= 0) & (height[1:] > 0))
    count = np.bincount(point, minlength=x.shape[2])
    order = np.lexsort((step, point))
    step, point = step[order], point[order]
    found, part = _located(model, values[:, point], x[step, :, point].T, h[point], height[step, point],
                           height[step + 1, point], surface, method)  # fmt: skip
    row = np.arange(step.size) - np.repeat(np.cumsum(count) - count, count)
    points = np.full((int(count.max(initial=0)), x.shape[1], x.shape[2]), np.nan)
    times = np.full((points.shape[0], x.shape[2]), np.nan)
    points[row, :, point] = found.T
    times[row, point] = (gone + step + part) * h[point]
    return points, times


def _located(
    model: Model, values: Array, begin: Array, h: Array, below: Array, above: Array,
    surface: Callable[[Array, Array], Array], method: Method,
) -> tuple[Array, Array]:  # fmt: skip
    """State at the zero within each step, just before it, and the part of the step gone."""
    low, high = np.zeros(h.size), np.ones(h.size)
    found = begin.copy()
    if not h.size:
        return found, low
    kernel = lane_kernel(model, method, slopes="none", kind="free")
    inputs = kernel.inputs(values)
    side = np.zeros(h.size, dtype=np.int64)  # which end moved last: -1 the lower, 1 the upper
    left = np.arange(h.size)
    for k in range(SEARCH):
        a, b, fa, fb = low[left], high[left], below[left], above[left]
        with np.errstate(invalid="ignore", divide="ignore"):
            middle = (a * fb - b * fa) / (fb - fa)
        middle = np.where((middle > a) & (middle < b) & (k % 4 < 3), middle, (a + b) / 2)
        run = blocked(kernel.with_sides(begin[:, left]))
        good = np.zeros((run.shape[0], 1, run.shape[2]), dtype=np.int64)
        kernel.march(
            blocks=run.shape[0], count=0, y=run, time=blocked(np.zeros((1, left.size))),
            origin=blocked(np.zeros((1, left.size))), h=blocked((h[left] * middle)[None]),
            **inputs.blocks(left), steps=1, good=good, work=kernel.work(),
        )  # fmt: skip
        x = unblocked(run, left.size)[: model.dimension]
        f = surface(x, values[:, left])
        under = f <= 0  # a step that fails tells nothing of what lies before
        down, up = left[under], left[~under]
        low[down], below[down], found[:, down] = middle[under], f[under], x[:, under]
        high[up], above[up] = middle[~under], f[~under]
        above[down] = np.where(side[down] == -1, above[down] / 2, above[down])
        below[up] = np.where(side[up] == 1, below[up] / 2, below[up])
        side[down], side[up] = -1, 1
        left = left[(high[left] - low[left] > EXACT) & (below[left] != 0)]
        if not left.size:
            break
    return found, low


def turns_of(ensemble: Ensemble, periods: int) -> Array:
    """Times over T at which points cross the section if they run on, shape (crossing, point); the ensemble is not moved."""
    run = ensemble.subset(np.arange(ensemble.points))
    return np.asarray(run_with_crossings(run, periods)[1] / ensemble.period)


def run_with_crossings(
    ensemble: Ensemble, periods: int, members: Points | None = None, progress: Callable[[int], None] | None = None
) -> tuple[Array, Array, Array]:
    """Run points of an unforced model, and find the crossings met.

    Parameters
    ----------
    ensemble : Ensemble
        Advanced in place.
    periods : int
        T (typical times).
    members : array of int, optional
        Indices of the points; all of them where absent.

    Returns
    -------
    points : array, shape (crossing, state, member)
        As in `crossings`.
    times : array, shape (crossing, member)
        From where the points stand now.
    growth : array, shape (period, vector, member)
        Of tangent vectors, as in `Segment`.
    """
    members = np.arange(ensemble.points) if members is None else members
    states = ensemble.model.dimension
    found: list[list[Array]] = [[] for _ in members]
    growth = np.zeros((periods, ensemble.tangents, members.size))
    for steps in np.unique(ensemble.point_steps[members]):
        columns = np.flatnonzero(ensemble.point_steps[members] == steps)
        here = members[columns]
        each = int(max(KEPT // (steps * states * here.size), 1))
        for first in range(0, periods, each):
            begin, some = ensemble.x[:, here].copy(), min(each, periods - first)
            segment = ensemble.advance(some, members=here, save_periods=Fraction(1, int(steps)), progress=progress)
            if ensemble.tangents:
                growth[first : first + some, :, columns] = segment.growth
            x = np.concatenate([begin[None], segment.saved])
            points, times = crossings(
                ensemble.model, ensemble.values[:, here], x, ensemble.period[here] / steps, ensemble.method,
                gone=first * int(steps),
            )  # fmt: skip
            for k, column in enumerate(columns):
                seen = np.isfinite(times[:, k])
                found[column].append(np.concatenate([points[seen, :, k], times[seen, k, None]], axis=1))
    joined = [np.concatenate(parts) for parts in found]
    out = np.full((max(map(len, joined), default=0), states + 1, members.size), np.nan)
    for k, rows in enumerate(joined):
        out[: len(rows), :, k] = rows
    return out[:, :states], out[:, states], growth
