"""Crossings of an unforced model's section, located between steps."""

import numpy as np
from numpy.typing import NDArray

from whirlmap.equations.model import Model
from whirlmap.errors import RangeError
from whirlmap.kernels.formulas import Formula, numpy_function
from whirlmap.kernels.reference import reference_rates

Array = NDArray[np.float64]

#: Bisections of a step: the bracket shrinks below rounding.
BISECTIONS = 60


def crossings(model: Model, values: Array, x: Array, h: Array) -> tuple[Array, Array]:
    """Locate every crossing of the model's section in recorded trajectories.

    Parameters
    ----------
    values : array, shape (parameter, point)
    x : array, shape (step, state, point)
        States after every step, the first one included.
    h : array, shape (point,)
        Step.

    Returns
    -------
    points : array, shape (crossing, state, point)
        In the order of time; rows beyond a point's last crossing are NaN.
    times : array, shape (crossing, point)
        From the first row of ``x``.

    Raises
    ------
    RangeError
        Where the model declares no section.

    Notes
    -----
    The zero of the surface on the cubic Hermite interpolant of the step, by bisection: fourth order, as RK4.
    """
    place = model.section
    if place is None:
        raise RangeError(f"{model.name} is not forced and declares no section: add section=Section(...)")
    height_of = numpy_function(model, "section", lambda: Formula([model.states, model.parameters], [place.surface]))

    def surface(x: list[Array], values: list[Array]) -> Array:
        return np.asarray(height_of(x, values)[0])

    sign = 1.0 if place.direction == "rising" else -1.0
    height = sign * surface(list(np.moveaxis(x, 1, 0)), list(values))
    step, point = np.nonzero((height[:-1] <= 0) & (height[1:] > 0))
    a, b, v, dt = x[step, :, point].T, x[step + 1, :, point].T, values[:, point], h[point]
    rates = reference_rates(model)
    fa, fb = dt * rates(0.0, a, v), dt * rates(0.0, b, v)

    def hermite(u: Array) -> Array:
        w = 1 - u
        return (1 + 2 * u) * w**2 * a + u * w**2 * fa + u**2 * (3 - 2 * u) * b - u**2 * w * fb

    low, high = np.zeros(step.size), np.ones(step.size)
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        below = sign * surface(list(hermite(middle)), list(v)) <= 0
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    count = np.bincount(point, minlength=x.shape[2])
    order = np.lexsort((step, point))
    row = np.arange(step.size) - np.repeat(np.cumsum(count) - count, count)
    points = np.full((int(count.max(initial=0)), x.shape[1], x.shape[2]), np.nan)
    times = np.full((points.shape[0], x.shape[2]), np.nan)
    points[row, :, point[order]] = hermite(low)[:, order].T
    times[row, point[order]] = ((step + low) * dt)[order]
    return points, times
