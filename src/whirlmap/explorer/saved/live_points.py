"""What a page needs to compute the motion of any point of a grid by itself: kernels, inputs, start states, tables.

Every number that a kernel takes is computed here, by the functions that compute it for this processor's kernels; the page
only looks it up. So it holds no formulas, and a point's motion begins from the same bits as in Python.

What would make the file too large is thinned out: every second, fourth, ... value of an axis stays, and the page shows the
nearest point that is left.
"""

from collections.abc import Callable
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.simulation.time_series import SAMPLES
from whirlmap.errors import RangeError
from whirlmap.explorer.saved.grid import Grid
from whirlmap.explorer.saved.packing import Packing
from whirlmap.integrate.division import variants
from whirlmap.integrate.harmonics import periods
from whirlmap.integrate.orders import order_groups
from whirlmap.integrate.scales import limits
from whirlmap.integrate.system import System
from whirlmap.kernels.lowering.poles import pole_guards
from whirlmap.kernels.lowering.tabulate import entries
from whirlmap.kernels.methods import Method
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
MOST = 5_000_000
#: Values along each axis from which it is seen on which axes a number depends; bytes of each point beside those numbers.
PROBED, BESIDE = 5, 4


def live_points(
    system: System, space: Space | None, *, method: str = "dop853", steps: int | Integers = SAMPLES, most: int = MOST,
    more: Callable[[Grid, Packing], dict[str, Any]] = lambda _grid, _packing: {},
) -> tuple[dict[str, Any], bytes]:  # fmt: skip
    """Pack what the motions of a grid's points need.

    Parameters
    ----------
    system : System
    space : Space, optional
        Axes of the grid; it has no random draws. The system's own point alone where absent.
    method : str
        Integration method.
    steps : int or array of int
        Steps per T, of all points or of each, over the grid of the space.
    most : int
        Bytes of numbers; where there would be more, values of the axes are left out.
    more : callable
        ``more(grid, packing) -> dict``: packs what else a page holds of the points that are kept, and describes it.

    Returns
    -------
    description : dict
        As ``live_motion.js`` reads it.
    data : bytes

    Raises
    ------
    NoBrowserKernelError
        The model cannot run in a browser.
    RangeError
        The space has random draws.

    Notes
    -----
    A step that fails is redone in shorter ones, as in Python, and the end of a run is located. Only the reason for an end is
    not told: a page knows that from the map or diagram around it.
    """
    if space is not None and space.tolerances:
        raise RangeError("points of random draws cannot be live: expected a grid over one or two parameters")
    chosen, packing = method_named(method), Packing()
    grid = Grid(system, space, () if space is None else _thinning(system, space, chosen, most))
    own_steps = grid.thinned(np.asarray(steps, dtype=np.int64)) if np.ndim(steps) else np.full(grid.shape, steps, np.int64)
    values, starts, points = grid.values, grid.starts, grid.values.shape[1]
    model = system.model
    orders = np.zeros((2 * len(model.harmonics), points))
    for group in order_groups(system, values, grid.varied):
        column = [*(o.numerator for o in group.orders), *(o.denominator for o in group.orders)]
        orders[:, group.members] = np.array(column, dtype=float)[:, None]
    period = periods(model, values)
    bounds = limits(model, period, starts)
    which, described = np.zeros(points), []
    for number, (form, members) in enumerate(variants(model, values)):
        which[members] = number
        kernel = browser_kernel(form, chosen)
        inputs = kernel_inputs(form, kernel.source, values[:, members], bounds[:, members])
        place = np.zeros(points, dtype=np.intp)  # points of other variants repeat the first of this one
        place[members] = np.arange(members.size)
        described.append(
            {
                "locked": packing.add(kernel.locked), "free": packing.add(kernel.free),
                "tables": packing.doubles(inputs.tables), "nodes": kernel.source.nodes, "sizes": _sizes(kernel),
                "singular": bool(pole_guards(form)), "inputs": packing.rows(grid.over(inputs.p[:, place])),
                "offsets": packing.rows(grid.over(inputs.offsets[:, place].astype(float))),
            }
        )  # fmt: skip
    description = {
        "axes": [{"name": name, "values": axis.tolist()} for name, axis in grid.axes.items()],
        "states": list(system.states), "outputs": list(model.outputs), "method": method,
        "steps": packing.rows(own_steps[None].astype(float)), "unknown_side": UNKNOWN, "thinned": list(grid.thinning),
        "pieces": packing.rows(pieces(own_steps.reshape(-1)).reshape(1, *grid.shape).astype(float)),
        "arguments": {"advance": list(ARGUMENTS), "march": list(MARCH), "evaluate": list(EVALUATE)},
        "start": packing.rows(grid.over(starts)), "period": packing.rows(grid.over(period[None])),
        "orders": packing.rows(grid.over(orders)) if orders.size else [], "variants": described,
        "variant": packing.rows(grid.over(which[None])), **more(grid, packing),
    }  # fmt: skip
    data, description["numbers"] = packing.packed()
    return description, data


def _sizes(kernel: BrowserKernel) -> dict[str, int]:
    sizes = kernel.source.sizes
    names = ("states", "outputs", "inputs", "surfaces", "work")
    return {**{name: getattr(sizes, name) for name in names}, "free_work": kernel.free_work}


def _thinning(system: System, space: Space, method: Method, most: int) -> tuple[int, ...]:
    """How far the axes are thinned out so that a page has room for what is left."""
    size, thinning = _size(system, space, method), (1,) * len(space.axes)
    while size(thinning) > most and any(t < n for t, n in zip(thinning, space.shape, strict=True)):
        fewer = [tuple(t * (2 if k == axis else 1) for k, t in enumerate(thinning)) for axis in range(len(thinning))]
        thinning = min(fewer, key=size)
    return thinning


def _size(system: System, space: Space, method: Method) -> Callable[[tuple[int, ...]], int]:
    """Bytes of numbers as a function of how far each axis is thinned out, from a few values of each axis."""
    few = {name: axis[np.unique(np.linspace(0, axis.size - 1, PROBED).astype(int))] for name, axis in space.axes.items()}
    grid = Grid(system, Space(few, inputs=space.inputs), (1,) * len(few))
    values, model = grid.values, system.model
    always = np.concatenate([grid.starts, periods(model, values)[None]])
    rows: list[tuple[int, Array]] = [(8, row) for row in grid.over(always)]
    for form, members in variants(model, values):
        source = browser_kernel(form, method).source
        place = np.zeros(values.shape[1], dtype=np.intp)
        place[members] = np.arange(members.size)
        rows += [(8, row) for row in grid.over(source.hoisted.evaluate(values[:, members])[:, place])]
        index = {q.name: i for i, q in enumerate(form.parameters)}
        for table in form.tables:
            parameter = source.tables[table.name]
            row = values[index[parameter]] if isinstance(parameter, str) else np.full(values.shape[1], parameter)
            rows.append((entries(table, float(row[members].min())).nbytes, grid.over(row[None])[0]))
    depends = [(BESIDE, [True] * len(few))]
    depends += [(size, [bool(np.ptp(row, axis=k).any()) for k in range(row.ndim)]) for size, row in rows]

    def size(thinning: tuple[int, ...]) -> int:
        counts = [-(-n // t) for n, t in zip(space.shape, thinning, strict=True)]
        return sum(each * prod(n for n, own in zip(counts, on, strict=True) if own) for each, on in depends)

    return size
