"""Start states of one operating point: its own, a random box of them, and those at which a run is over already."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from sympy import sympify

from whirlmap.analysis.labels.labelling import measure
from whirlmap.analysis.motion.ensembles import cyclic_states
from whirlmap.errors import RangeError, counted, nearest
from whirlmap.integrate.equilibrium import start_states
from whirlmap.integrate.own_units import state_values
from whirlmap.integrate.system import System
from whirlmap.options.computed import Labelling
from whirlmap.options.execution import EXECUTION, Execution

Array = NDArray[np.float64]
#: Lowest and highest value of a state, with or without a unit.
Ends = tuple[float | str, float | str]

#: How far the default box reaches beyond the motion from the default start: its range times this, about its middle.
WIDER = 2.0


def default_box(system: System, labelling: Labelling, execution: Execution = EXECUTION) -> dict[str, tuple[float, float]]:
    """Box of start states about the motion from the default start: `WIDER` times its range, angles whole turns.

    Raises
    ------
    RangeError
        Where that run ends early, or does not move: then nothing says how large a box should be.
    """
    measured, _ = measure(system, repeated(system, 1), labelling, replace(execution, progress=None))
    low, high = (measured.returns.extremes[k][: system.model.dimension, 0] for k in ("minimum", "maximum"))
    if not np.isfinite(low).all() or not (high > low).any():
        raise RangeError(
            f"{system.case}: the run from the default start does not move, or ends early, so it gives no box of start"
            " states; give one for the states of interest, as in x=-2:2"
        )
    half = WIDER * (high - low) / 2
    out = dict(zip(system.states, zip((low + high) / 2 - half, (low + high) / 2 + half, strict=True), strict=True))
    for k, period in cyclic_states(system).items():
        out[system.states[k]] = (-period / 2, period / 2)
    return {name: (float(a), float(b)) for name, (a, b) in out.items()}


def start_values(system: System) -> Array:
    """The system's start state, shape (state,)."""
    x, _ = start_states(system.model, system.vector[:, None])
    for name, value in system.start.items():
        x[system.states.index(name)] = value
    return np.asarray(x[:, 0])


def box_ends(system: System, box: Mapping[str, Ends]) -> dict[str, tuple[float, float]]:
    """Ends of a box as numbers, in the order of the states, whatever the order of the box."""
    if not box:
        raise RangeError("box: found no state, expected at least one, as in x=-2:2")
    ends: dict[str, tuple[float, float]] = {}
    for name, given in box.items():
        if name not in system.states:
            raise RangeError(
                f"box: {system.model.name} has no state {name!r}.{nearest(name, system.states)}"
                f"\n  states: {' '.join(system.states)}"
            )
        values = state_values(system, name, given, "box")
        if values.shape != (2,):
            raise RangeError(f"box of {name!r}: found {counted(values.size, 'value')}, expected two, (low, high)")
        low, high = values.tolist()
        ends[name] = low, high
        if not (np.isfinite([low, high]).all() and low <= high):
            raise RangeError(f"box of {name!r}: found {low:g} to {high:g}, expected finite numbers that ascend")
    return {name: ends[name] for name in system.states if name in ends}


def draw_starts(system: System, count: int, box: Mapping[str, Ends], seed: int) -> Array:
    """Start states drawn uniformly from a box, shape (state, start)."""
    if not 1 <= count <= 10_000_000:
        raise RangeError(f"starts must lie between 1 and 10000000, not {count}")
    ends = box_ends(system, box)
    x = np.repeat(start_values(system)[:, None], count, axis=1)
    random = np.random.default_rng(seed)
    for name, between in ends.items():
        x[system.states.index(name)] = random.uniform(*between, count)
    return x


def repeated(system: System, count: int) -> dict[str, Array]:
    """The system's own operating point, so many times."""
    return {system.parameters[0]: np.full(count, system.vector[0])}


def refuse_start(system: System) -> None:
    """Refuse a start state that the user gave and at which the run would already be over.

    Raises
    ------
    RangeError
        Naming the states, what holds there already and the quantity behind it.
    """
    if not system.start:
        return
    x, _ = start_states(system.model, system.vector[:, None])
    own = zip(system.model.states, x[:, 0].tolist(), strict=True)
    at = {s: system.start.get(s.name, value) for s, value in own}
    numbers = {**at, **dict(zip(system.model.parameters, system.vector.tolist(), strict=True))}
    for stop in system.model.stops.values():
        gap = sympify(stop.gap)
        if float(gap.subs(numbers)) > 0:
            continue
        where = ", ".join(f"{s.name} = {at[s]:g}" for s in system.model.states if s in gap.free_symbols)
        measures = [
            f"{name} = {float(sympify(o.expression).subs(numbers)):g} ({o.meaning}), which must lie in [0, 1)"
            for name, o in system.model.outputs.items()
            if sympify(o.expression).free_symbols == gap.free_symbols
        ]
        found = measures[0] if measures else f"{gap} = {float(gap.subs(numbers)):g}, which must be above 0"
        raise RangeError(f"start: found {where}, so {found}: {stop.meaning} already")
