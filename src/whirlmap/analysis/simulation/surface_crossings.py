"""Times at which a series crosses discontinuity surfaces of its model: loss of tooth contact, begin of rub."""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from whirlmap.equations.model import Model
from whirlmap.equations.quantities import t
from whirlmap.errors import RangeError
from whirlmap.integrate.system import System
from whirlmap.kernels.lowering.formulas import Formula, numpy_function
from whirlmap.kernels.running.reference import reference_rates

Array = NDArray[np.float64]

#: Bisections of a sample interval: the bracket shrinks below rounding.
BISECTIONS = 60


def surface_crossings(system: System, series: xr.Dataset) -> xr.Dataset:
    """Locate where a time series crosses the declared surfaces of its model.

    Parameters
    ----------
    system : System
        Whose model declares the surfaces (`Switching`).
    series : xr.Dataset
        What `whirlmap.simulate` returns for this system: ``x(time, state)``.

    Returns
    -------
    xr.Dataset
        ``height(surface, time)``, the surface's value at each sample, positive where the named thing holds (flanks touch);
        ``share(surface)``, the share of the time for which it does; ``count(surface)`` of crossings into it;
        ``event_time(event)``, ``event_surface(event)`` (index) and ``event_rising(event)``, in the order of time.

    Raises
    ------
    RangeError
        Where the model declares no such surface, or the series is of another model.

    Notes
    -----
    A crossing is the zero of the surface on the cubic Hermite interpolant between two samples, by bisection, to the
    third order of their distance (the rates have a kink at the crossing itself). Two crossings between neighbouring
    samples are not seen: sample finely. Shares are exact between the crossings that were found.

    References
    ----------
    [hairer1993] cubic Hermite interpolation between the steps.
    """
    model = system.model
    if not model.switchings:
        raise RangeError(
            f"{model.name} with these switches declares no discontinuity surface: expected one, as in"
            " Model(switchings={\"wall\": Switching(x - 1, \"touches the wall\")})"
        )
    if [str(s) for s in series["state"].values] != [s.name for s in model.states]:
        raise RangeError(f"the time series is not one of {model.name} with these switches: it has other states")
    good = np.isfinite(series["x"].values).all(axis=1)
    time, x = series["time"].values[good], series["x"].values[good].T
    if time.size < 2:
        raise RangeError("a time series with fewer than two samples has no crossings")
    plain = system.plain_model()
    height = _heights(model, system.vector, time, x)
    place, sample = np.nonzero((height[:, :-1] > 0) != (height[:, 1:] > 0))
    when = _located(plain, system.vector, time, x, place, sample, height[place, sample + 1] > 0)
    rising = height[place, sample + 1] > 0
    order = np.argsort(when, kind="stable")
    names = list(model.switchings)
    share = [_share(time, height[k], np.sort(when[place == k])) for k in range(len(names))]
    count = [int((rising & (place == k)).sum()) for k in range(len(names))]
    meanings = "; ".join(f"{name}: {q.meaning}" for name, q in model.switchings.items())
    return xr.Dataset(
        {
            "height": (("surface", "time"), height, {"units": "1", "long_name": "value of the surface, positive inside"}),
            "share": ("surface", share, {"units": "1", "long_name": "share of the time inside"}),
            "count": ("surface", count, {"units": "1", "long_name": "crossings into it"}),
            "event_time": ("event", when[order], {"units": "time", "long_name": "time of the crossing"}),
            "event_surface": ("event", place[order], {"units": "1", "long_name": "index of the surface"}),
            "event_rising": ("event", rising[order].astype(np.int8), {"units": "1", "long_name": "1 into it, 0 out of it"}),
        },
        coords={"surface": ("surface", names, {"units": "1", "long_name": meanings}), "time": time},
    )


def _heights(model: Model, values: Array, time: Array, x: Array) -> Array:
    """Value of each surface, shape (surface, sample)."""
    surfaces = [q.surface for q in model.switchings.values()]
    of = numpy_function(model, "switchings", lambda: Formula([t, model.states, model.parameters], surfaces))
    return np.stack([np.broadcast_to(np.asarray(row, dtype=float), time.shape) for row in of(time, list(x), list(values))])


def _located(
    model: Model, values: Array, time: Array, x: Array, place: NDArray[np.intp], sample: NDArray[np.intp],
    rising: NDArray[np.bool_],
) -> Array:  # fmt: skip
    """Times of crossings between each given sample and the next."""
    if not sample.size:
        return np.empty(0)
    dt = time[sample + 1] - time[sample]
    a, b = x[:, sample], x[:, sample + 1]
    rates = reference_rates(model, tables="read" if model.tables else "exact")
    fa, fb = dt * rates(time[sample], a, values[:, None]), dt * rates(time[sample + 1], b, values[:, None])

    def inside(u: Array) -> NDArray[np.bool_]:
        w = 1 - u
        y = (1 + 2 * u) * w**2 * a + u * w**2 * fa + u**2 * (3 - 2 * u) * b - u**2 * w * fb
        return np.asarray(_heights(model, values, time[sample] + u * dt, y)[place, np.arange(u.size)] > 0)

    low, high = np.zeros(sample.size), np.ones(sample.size)
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        before = inside(middle) != rising
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    out: Array = time[sample] + low * dt
    return out


def _share(time: Array, height: Array, when: Array) -> float:
    """Share of the time for which the surface is positive: it changes its sign at the given times alone."""
    edges = np.concatenate([time[:1], when, time[-1:]])
    lengths = np.diff(edges)
    first = 0 if height[0] > 0 else 1
    return float(lengths[first::2].sum() / (time[-1] - time[0]))
