"""Basins of attraction: the attractor that every start state of a two-dimensional slice leads to."""

from collections.abc import Mapping
from typing import Unpack

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from whirlmap.errors import RangeError, counted, nearest
from whirlmap.integrate.own_units import state_values
from whirlmap.integrate.system import System
from whirlmap.options.computed import LABELLING, Labelling
from whirlmap.options.execution import EXECUTION, Execution
from whirlmap.options.taking import LabellingParts
from whirlmap.results.memory import refuse_memory
from whirlmap.results.schema import variable
from whirlmap.sweep.attractors.attractors import attractors
from whirlmap.sweep.attractors.start_states import start_values
from whirlmap.sweep.interruptible import Work, in_parts


@in_parts("basins")
def basins(
    system: System,
    grid: Mapping[str, ArrayLike],
    *,
    labelling: Labelling = LABELLING,
    execution: Execution = EXECUTION,
    **_given: Unpack[LabellingParts],
) -> Work:
    """Find the attractor of every start state on a grid over two states, the others at their start values.

    Parameters
    ----------
    system : System
        Its values and start states count.
    grid : mapping of state to array
        Two states and their values, ascending; texts with a unit, ``["-20 um", "20 um"]``, or the text of a range.
    labelling : Labelling, optional
        How points are measured; or its parts as keywords, ``settling``, ``lyapunov``, ``method``, ``steps``, ``accuracy``.
    execution : Execution, optional
        How it is run, which changes no number; or its parts as keywords, ``workers``, ``progress``.

    Returns
    -------
    xr.Dataset
        As of `attractors`, but ``attractor_of``, ``start_regime`` and ``start_status`` are over the two states, and
        there is no ``start_state``; ``share`` is that of the slice. Its error is that of as many starts drawn at random,
        an upper bound for a grid whose basins are wider than its cells.

    ``basins.parts`` gives the `Work`, as of `attractors`.

    Raises
    ------
    RangeError
        Unless the grid has two states of the model, each with two or more values that ascend.
    InputError
        A unit that a state does not have.

    Notes
    -----
    Starts are the points of the grid, at phase zero, in one batch; what is the same attractor, `attractors` says. A
    boundary is known to one cell, and a fractal one is not resolved by any grid.
    """
    if len(grid) != 2:
        found = f"{counted(len(grid), 'state')} ({' '.join(grid) or 'none'})"
        raise RangeError(f"grid: found {found}, expected two, as in x and v")
    axes = {}
    for name, given in grid.items():
        if name not in system.states:
            raise RangeError(
                f"grid: {system.model.name} has no state {name!r}.{nearest(name, system.states)}"
                f"\n  states: {' '.join(system.states)}"
            )
        axes[name] = values = state_values(system, name, given, "grid")
        if values.ndim != 1 or values.size < 2 or not np.isfinite(values).all() or np.any(np.diff(values) <= 0):
            raise RangeError(f"grid of {name!r}: expected two or more finite values that ascend")
    (first, a), (second, b) = axes.items()
    refuse_memory("the basins", a.size * b.size * (3 * system.model.dimension + 40))
    x = np.repeat(start_values(system)[:, None], a.size * b.size, axis=1)
    x[system.states.index(first)] = np.repeat(a, b.size)
    x[system.states.index(second)] = np.tile(b, a.size)
    search = attractors.parts(system, starts=x, labelling=labelling, execution=execution)

    def gather(work: Work) -> xr.Dataset | None:
        found = search.dataset
        work.done = search.done
        if found is None:
            return None
        ds = found.drop_vars("start_state")
        for name in ("attractor_of", "start_regime", "start_status"):
            ds[name] = ((first, second), ds[name].values.reshape(a.size, b.size), ds[name].attrs)
        states = {s.name: s for s in system.model.states}
        return ds.assign_coords({n: variable(n, v, states[n].unit, states[n].meaning) for n, v in axes.items()})

    return Work(search.total, lambda _: iter(search), gather)
