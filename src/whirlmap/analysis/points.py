"""Operating points from a system: the ensemble that every analysis starts with."""

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from whirlmap.errors import RangeError, nearest
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.equilibrium import start_states
from whirlmap.integrate.loading import pieces
from whirlmap.integrate.system import System
from whirlmap.kernels.methods import method as method_named
from whirlmap.results.provenance import provenance

Array = NDArray[np.float64]

#: Steps of RK4 per T where the user does not say. Forced: the error after 8 T is about 1e-6 on the gear pair
#: (docs/design.md). Unforced: Lorenz's exponents sum to the divergence to 1e-6.
FORCED_STEPS, UNFORCED_STEPS = 100, 400

#: Start states of one swarm differ by this much of one, so that they end on one attractor but decorrelate in chaos.
SWARM = 1e-6


def default_steps(system: System) -> int:
    """Steps per T (per typical time of an unforced model) that an analysis takes unless it is told."""
    return FORCED_STEPS if system.model.forced else UNFORCED_STEPS


def parameter_values(system: System, vary: Mapping[str, ArrayLike]) -> Array:
    """Values of every parameter at every operating point, shape (parameter, point).

    Raises
    ------
    RangeError
        Where a varied name is unknown, an order of a harmonic, or leaves its limits; or lengths differ.
    """
    columns = {name: np.atleast_1d(np.asarray(values, dtype=float)) for name, values in vary.items()}
    lengths = {name: c.size for name, c in columns.items()}
    if len(set(lengths.values())) > 1:
        raise RangeError(f"varied parameters have different numbers of points: {lengths}")
    values = np.repeat(system.vector[:, None], next(iter(lengths.values()), 1), axis=1)
    for name, column in columns.items():
        if name not in system.parameters:
            raise RangeError(
                f"{system.model.name} has no parameter {name!r}.{nearest(name, system.parameters)}"
                f"\n  parameters: {' '.join(system.parameters)}"
            )
        parameter = system.model.parameter(name)
        if parameter.order:
            raise RangeError(f"{name!r} is the order of a harmonic, a constant of a run: it cannot be varied")
        for value in (column.min(), column.max()):
            fault = parameter.fault(float(value))
            if fault:
                raise RangeError(f"{name} = {value:g} {fault} ({parameter.meaning})")
        values[system.parameters.index(name)] = column
    _follow_defaults(system, columns, values)
    return values


def _follow_defaults(system: System, columns: Mapping[str, Array], values: Array) -> None:
    """Parameters that follow from others by default go on following the varied ones."""
    from sympy import lambdify, sympify

    for parameter, rule in system.model.defaults.items():
        follows = {q.name for q in sympify(rule).free_symbols} & set(columns)
        if follows and system.notes.get(parameter.name, "").startswith("default"):
            function = lambdify([list(system.model.parameters)], sympify(rule), modules="numpy")
            values[system.parameters.index(parameter.name)] = function(list(values))


def make_ensemble(
    system: System,
    vary: Mapping[str, ArrayLike] | None = None,
    *,
    starts: Array | None = None,
    steps: int | None = None,
    method: str = "rk4",
    tangents: int = 0,
    workers: int | None = None,
    swarm: bool = False,
    one_kernel: bool = False,
) -> tuple[Ensemble, NDArray[np.bool_]]:
    """Build the ensemble of a system at one or many operating points.

    Parameters
    ----------
    vary : mapping of str to array, shape (point,)
        Parameters that differ between points.
    starts : array, shape (state, point), optional
        Start states; where absent the model's default starts, with the system's own start values on top.
    one_kernel : bool
        As in `Ensemble`.
    swarm : bool
        Move every start by `SWARM` in its own fixed random direction (zero for the first point).

    Returns
    -------
    ensemble : Ensemble
    found : array of bool, shape (point,)
        Whether each default start was had (see `start_states`).
    """
    steps = default_steps(system) if steps is None else steps
    if not 1 <= steps <= 1_000_000:
        raise RangeError(f"steps per T must lie between 1 and 1000000, not {steps}")
    orders = system.orders
    if orders is None:
        raise RangeError(
            f"{system.model.name}: a harmonic's order is not a ratio p/q with q up to 10000, so steps cannot be locked"
            " to the forcing; give orders as ratios of integers"
        )
    values = parameter_values(system, vary or {})
    if starts is None:
        x, found = start_states(system.model, values)
        for name, value in system.start.items():
            x[system.states.index(name)] = value
    else:
        x, found = np.array(starts, dtype=float), np.ones(values.shape[1], dtype=bool)
    if swarm:
        kicks = np.random.default_rng(7).normal(size=x.shape)
        kicks[:, 0] = 0
        x = x + SWARM * kicks / np.maximum(np.linalg.norm(kicks, axis=0), 1e-300)
    ensemble = Ensemble(
        system.model, values, x, orders=orders, steps=steps, method=method_named(method), tangents=tangents, workers=workers,
        one_kernel=one_kernel,
    )  # fmt: skip
    return ensemble, found


def run_attributes(system: System, ensemble: Ensemble, **settings: Any) -> dict[str, Any]:
    """Attributes that every Dataset of a run carries: where its numbers come from, and the settings by name."""
    origin = provenance(
        pieces(system),
        method=ensemble.method.name,
        steps_per_period=ensemble.steps,
        citations=(ensemble.method.source,),
    )
    cyclic = {s.name: s.cyclic for s in system.model.states if s.cyclic is not None}
    return {**origin, **settings, **({"cyclic": json.dumps(cyclic)} if cyclic else {})}


def cyclic_states(system: System) -> dict[int, float]:
    """Periods of the states that are angles, by index."""
    return {i: s.cyclic for i, s in enumerate(system.model.states) if s.cyclic is not None}
