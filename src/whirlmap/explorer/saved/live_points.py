"""What a page needs to compute the motion of any point of a grid by itself: kernels, inputs, start states, tables.

Every number that a kernel takes is computed here, by the functions that compute it for this processor's kernels; the page
only looks it up. So it holds no formulas, and a point's motion begins from the same bits as in Python.

What would make the file too large is thinned out: every second, fourth, ... value of an axis stays, and the page shows the
nearest point that is left.
"""

from collections.abc import Mapping
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.motion.ensembles import parameter_values
from whirlmap.analysis.simulation.time_series import SAMPLES
from whirlmap.equations.model import Model
from whirlmap.errors import RangeError
from whirlmap.explorer.saved.packing import Packing
from whirlmap.integrate.division import variants
from whirlmap.integrate.equilibrium import start_states
from whirlmap.integrate.harmonics import periods
from whirlmap.integrate.orders import order_groups
from whirlmap.integrate.scales import limits
from whirlmap.integrate.system import System
from whirlmap.kernels.lowering.poles import pole_guards
from whirlmap.kernels.lowering.tabulate import entries
from whirlmap.kernels.methods import method as method_named
from whirlmap.kernels.running.lanes import UNKNOWN, kernel_inputs
from whirlmap.kernels.webassembly.browser_kernel import BrowserKernel, browser_kernel
from whirlmap.kernels.writing.advancing import ARGUMENTS
from whirlmap.kernels.writing.event_location import pieces
from whirlmap.kernels.writing.marching import EVALUATE, MARCH
from whirlmap.sweep.parameters.space import Space

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

#: Bytes of numbers that a page holds for its live points, before they are compressed.
MOST = 4_000_000
#: Values along each axis from which it is seen on which axes a number depends.
PROBED = 5


def live_points(
    system: System, space: Space, *, method: str = "dop853", steps: int | Integers = SAMPLES, most: int = MOST
) -> tuple[dict[str, Any], bytes]:
    """Pack what the motions of a grid's points need.

    Parameters
    ----------
    system : System
    space : Space
        Axes of the grid; it has no random draws.
    method : str
        Integration method.
    steps : int or array of int
        Steps per T, of all points or of each, over the grid of the space.
    most : int
        Bytes of numbers; where there would be more, values of the axes are left out.

    Returns
    -------
    description : dict
        As ``live_motion.js`` reads it.
    data : bytes

    Raises
    ------
    ModelError
        The model cannot run in a browser.
    RangeError
        The space has random draws.

    Notes
    -----
    A step that fails is redone in shorter ones, as in Python, and the end of a run is located. Only the reason for an end is
    not told: a page knows that from the map or diagram around it.
    """
    if space.tolerances:
        raise RangeError("points of random draws cannot be live: expected a grid over one or two parameters")
    axes, thinning = _thinned(system, space, method, most)
    every = np.broadcast_to(np.asarray(steps, dtype=np.int64), space.shape)
    own_steps = every[tuple(slice(None, None, t) for t in thinning)]
    values, starts = _points(system, space, axes)
    shape, points = tuple(axis.size for axis in axes.values()), values.shape[1]
    packing, model = Packing(), system.model

    def over_grid(rows: Array) -> Array:
        return rows.reshape(-1, *shape)

    orders = np.zeros((2 * len(model.harmonics), points))
    for group in order_groups(system, values, space.names):
        column = [*(o.numerator for o in group.orders), *(o.denominator for o in group.orders)]
        orders[:, group.members] = np.array(column, dtype=float)[:, None]
    period = periods(model, values)
    bounds = limits(model, period, starts)
    which = np.zeros(points)
    described = []
    for number, (form, members) in enumerate(variants(model, values)):
        which[members] = number
        kernel = browser_kernel(form, method_named(method))
        inputs = kernel_inputs(form, kernel.source, values[:, members], bounds[:, members])
        whole = np.zeros(points, dtype=np.intp)  # points of other variants repeat the first of this one
        whole[members] = np.arange(members.size)
        described.append(
            {
                "locked": packing.add(kernel.locked), "free": packing.add(kernel.free),
                "tables": packing.doubles(inputs.tables), "nodes": kernel.source.nodes, "sizes": _sizes(kernel),
                "singular": bool(pole_guards(form)),
                "inputs": packing.rows(over_grid(inputs.p[:, whole])),
                "offsets": packing.rows(over_grid(inputs.offsets[:, whole].astype(float))),
            }
        )  # fmt: skip
    description = {
        "axes": [{"name": name, "values": axis.tolist()} for name, axis in axes.items()],
        "states": list(system.states), "outputs": list(model.outputs), "forced": model.forced, "method": method,
        "steps": packing.rows(own_steps[None].astype(float)), "unknown_side": UNKNOWN, "thinned": thinning,
        "pieces": packing.rows(pieces(own_steps)[None].astype(float)),
        "arguments": {"advance": list(ARGUMENTS), "march": list(MARCH), "evaluate": list(EVALUATE)},
        "start": packing.rows(over_grid(starts)), "period": packing.rows(over_grid(period[None])),
        "orders": packing.rows(over_grid(orders)), "variant": packing.rows(over_grid(which[None])), "variants": described,
    }  # fmt: skip
    data, description["numbers"] = packing.packed()
    return description, data


def _sizes(kernel: BrowserKernel) -> dict[str, int]:
    sizes = kernel.source.sizes
    names = ("states", "outputs", "inputs", "surfaces", "work")
    return {**{name: getattr(sizes, name) for name in names}, "free_work": kernel.free_work}


def _points(system: System, space: Space, axes: Mapping[str, Array]) -> tuple[Array, Array]:
    """Parameters and start states of a grid's points, shape (parameter or state, point)."""
    thin = Space(axes, inputs=space.inputs)
    index = tuple(i.ravel() for i in np.indices(thin.shape))
    values = parameter_values(system, thin.columns(index))
    starts, _ = start_states(system.model, values)
    for name, value in system.start.items():
        starts[system.states.index(name)] = value
    return values, starts


def _thinned(system: System, space: Space, method: str, most: int) -> tuple[dict[str, Array], list[int]]:
    """Axes with as many of their values as a page has room for: every so many of each."""
    thinning = [1] * len(space.axes)
    size = _size(system, space, method)
    while size(thinning) > most and max(space.shape) > max(thinning):
        fewer = [[t * (2 if k == axis else 1) for k, t in enumerate(thinning)] for axis in range(len(thinning))]
        thinning = min(fewer, key=size)
    return {name: axis[::t] for (name, axis), t in zip(space.axes.items(), thinning, strict=True)}, thinning


def _size(system: System, space: Space, method: str) -> Any:
    """Bytes of numbers as a function of how far each axis is thinned out, from a few values of each axis."""
    few = {name: axis[np.unique(np.linspace(0, axis.size - 1, PROBED).astype(int))] for name, axis in space.axes.items()}
    values, starts = _points(system, space, few)
    shape, model = tuple(axis.size for axis in few.values()), system.model
    depends: list[tuple[bool, ...]] = []
    for form, members in variants(model, values):
        source = browser_kernel(form, method_named(method)).source
        rows = [source.hoisted.evaluate(values[:, members]), starts[:, members], periods(model, values[:, members])[None]]
        whole = np.zeros(values.shape[1], dtype=np.intp)
        whole[members] = np.arange(members.size)
        for row in np.concatenate(rows)[:, whole].reshape(-1, *shape):
            depends.append(tuple(bool(np.ptp(row, axis=k).any()) for k in range(row.ndim)))
    tables = _tables(model, values, shape)

    def size(thinning: list[int]) -> int:
        counts = [-(-n // t) for n, t in zip(space.shape, thinning, strict=True)]
        each = [(8, on) for on in depends] + tables
        return sum(bytes_ * prod(n for n, own in zip(counts, on, strict=True) if own) for bytes_, on in each)

    return size


def _tables(model: Model, values: Array, shape: tuple[int, ...]) -> list[tuple[int, tuple[bool, ...]]]:
    """Bytes of each film table at one value of its parameter, and the axes on which that depends."""
    out = []
    for form, members in variants(model, values):
        index = {q.name: i for i, q in enumerate(form.parameters)}
        names = browser_kernel(form, method_named("dop853")).source.tables
        for table in form.tables:
            parameter = names[table.name]
            row = values[index[parameter]] if isinstance(parameter, str) else np.full(values.shape[1], parameter)
            largest = entries(table, float(row[members].min())).nbytes
            on = tuple(bool(np.ptp(row.reshape(shape), axis=k).any()) for k in range(len(shape)))
            out.append((largest, on))
    return out
