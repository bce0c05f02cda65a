"""Ensembles of operating points of a system, with start states, steps and tolerances: the beginning of every analysis."""

import json
from collections.abc import Mapping
from fractions import Fraction
from typing import Any, Unpack, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sympy import sympify

from whirlmap.equations.model import Model
from whirlmap.errors import RangeError, nearest
from whirlmap.integrate.accuracy import LADDER, choose_steps, doubtful
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.equilibrium import start_states
from whirlmap.integrate.evaluation import Evaluator
from whirlmap.integrate.harmonics import periods
from whirlmap.integrate.loading import pieces
from whirlmap.integrate.orders import order_groups
from whirlmap.integrate.scales import GROWTH, largest_of, likeness, start_sizes, unit_sizes
from whirlmap.integrate.system import System
from whirlmap.integrate.turns import choose_unforced_steps
from whirlmap.kernels.lowering.formulas import HoistedFunction
from whirlmap.kernels.methods import method as method_named
from whirlmap.kernels.running.machine import processor
from whirlmap.kernels.running.root_choice import chosen
from whirlmap.options.computed import INTEGRATION, Integration
from whirlmap.options.execution import EXECUTION, Execution
from whirlmap.options.taking import IntegrationParts, takes_options
from whirlmap.results.provenance import provenance

Array = NDArray[np.float64]

#: Error over one common period that steps are chosen for where the user does not say; of an unforced model over one typical
#: time: its motion slides along its steps, so that their errors are noise in its section points, which return to 1e-6.
ACCURACY, UNFORCED_ACCURACY = 1e-6, 1e-9
#: Least steps per T of tangent vectors where steps are chosen: exponents then sum to the divergence to 1e-6.
TANGENT_STEPS = 16
#: Start states of one perturbed ensemble differ by this part of the sizes of their states, so that they end on one attractor
#: but decorrelate in chaos.
PERTURBATION = 1e-6


#: Phases of the forcing at which the rates at a start are asked.
PHASES = 8


def parameter_values(system: System, vary: Mapping[str, ArrayLike]) -> Array:
    """Values of every parameter at every operating point, shape (parameter, point).

    Raises
    ------
    RangeError
        Where a varied name is unknown, an order of a harmonic, or leaves its limits; where lengths differ; or where a check
        of the model refuses the least or the largest value of one.
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
    _check_ends(system, columns, values)
    return values


def _check_ends(system: System, columns: Mapping[str, Array], values: Array) -> None:
    """Refuse what the model's checks refuse at the least and at the largest of each varied parameter."""
    ends = {int(find(column)) for column in columns.values() for find in (np.argmin, np.argmax)}
    for end in sorted(ends) if system.model.checks else ():
        at = dict(zip(system.parameters, map(float, values[:, end]), strict=True))
        for check in system.model.checks:
            if fault := check(at):
                raise RangeError(fault)


def _follow_defaults(system: System, columns: Mapping[str, Array], values: Array) -> None:
    """Values of parameters whose default is an expression of varied ones."""
    for parameter, rule in system.model.defaults.items():
        follows = {q.name for q in sympify(rule).free_symbols} & set(columns)
        if follows and system.notes.get(parameter.name, "").startswith("default"):
            function = HoistedFunction.of(system.model.parameters, [sympify(rule)])
            values[system.parameters.index(parameter.name)] = function.evaluate(values)[0]


@takes_options()
def make_ensemble(
    system: System,
    vary: Mapping[str, ArrayLike] | None = None,
    *,
    starts: Array | None = None,
    tangents: int = 0,
    perturbed: bool = False,
    turn: Array | None = None,
    ranges: Array | None = None,
    integration: Integration = INTEGRATION,
    execution: Execution = EXECUTION,
    **_given: Unpack[IntegrationParts],
) -> tuple[Ensemble, NDArray[np.bool_]]:
    """Build the ensemble of a system at one or many operating points.

    Parameters
    ----------
    vary : mapping of str to array, shape (point,)
        Parameters that differ between points.
    starts : array, shape (state, point), optional
        Start states; where absent the model's default starts, with the system's own start values on top.
    perturbed : bool
        Move every start by `PERTURBATION` of the sizes of its states (`first_sizes`) in its own fixed random direction (the
        first point stays).

    turn : array, shape (point,), optional
        T of the points of an unforced model, where it is known; the typical time where absent.
    ranges : array, shape (state, point), optional
        Of the states over the motion, in which lengths of tangent vectors are measured; where absent `first_sizes`.
    integration : Integration, optional
        Method, and steps or accuracy (`ACCURACY` or `UNFORCED_ACCURACY` where absent), by which each point's are chosen
        (`whirlmap.integrate.accuracy.choose_steps`, `whirlmap.integrate.turns.choose_unforced_steps`).
    execution : Execution, optional
        How it is run.

    Returns
    -------
    ensemble : Ensemble
    found : array of bool, shape (point,)
        Whether each default start was had (see `start_states`).
    """
    forced, steps, accuracy = system.model.forced, integration.steps, integration.accuracy
    values = parameter_values(system, vary or {})
    orders = _shared_orders(system, values, vary or {})
    if starts is None:
        x, found = start_states(system.model, values)
        for name, value in system.start.items():
            x[system.states.index(name)] = value
    else:
        x, found = np.array(starts, dtype=float), np.ones(values.shape[1], dtype=bool)
    if perturbed:
        kicks = np.random.default_rng(7).normal(size=x.shape)
        kicks[:, 0] = 0
        size = first_sizes(system.model, values, x)
        x = x + PERTURBATION * size * kicks / np.maximum(np.linalg.norm(kicks, axis=0), 1e-300)
    chosen = method_named(integration.method or "dop853")
    usual = ACCURACY if forced else UNFORCED_ACCURACY
    wanted = (usual if accuracy is None else accuracy) if steps is None else None
    options: dict[str, Any] = {"orders": orders, "method": chosen, "accuracy": wanted, "turn": turn}
    options["workers"] = execution.workers
    sizes = None
    if tangents:
        period = periods(system.model, values)
        known = first_sizes(system.model, values, x) if ranges is None else np.nan_to_num(ranges)
        sizes = unit_sizes(system.model, period, known)
    if wanted is None:
        return Ensemble(system.model, values, x, steps=cast(Any, steps), tangents=tangents, sizes=sizes, **options), found
    choose = choose_steps if forced else choose_unforced_steps
    rungs = choose(Ensemble(system.model, values, x, steps=LADDER[0], **options), wanted)
    least = TANGENT_STEPS if tangents else 1
    cyclic = np.array([s.cyclic is not None for s in system.model.states])[:, None]
    options["sizes"] = sizes
    ensemble = Ensemble(system.model, values, x, steps=np.maximum(rungs.steps, least), tangents=tangents, **options)
    ensemble.step_error[:], ensemble.step_verdict[:] = rungs.error, rungs.verdict
    if system.model.bound is None:  # for a start at rest the sizes come from the motion itself
        unknown = ~np.isfinite(ensemble.limits) & np.isfinite(rungs.size) & ~cyclic
        ensemble.limit(np.where(unknown, GROWTH * rungs.size, ensemble.limits))
    return ensemble, found


def _shared_orders(system: System, values: Array, vary: Mapping[str, ArrayLike]) -> tuple[Fraction, ...]:
    """Orders of the harmonics of all points of one ensemble."""
    groups = order_groups(system, values, vary)
    if len(groups) > 1:
        raise RangeError(
            f"{system.model.name}: with {' and '.join(vary)} varied the forcing has common periods of"
            f" {groups[0].common_multiple} to {groups[-1].common_multiple} T, but what is asked for needs one; bifurcation"
            " diagrams and maps can have several, or ask for one point at a time"
        )
    return groups[0].orders


def first_sizes(model: Model, values: Array, x: Array) -> Array:
    """Sizes of the states at a start, shape (state, point): `start_sizes`, and how far the rates carry them in T/2 pi.

    Zero where a state is at rest at zero together with all that are alike to it.
    """
    period, n = periods(model, values), x.shape[1]
    size = start_sizes(model, period, x)
    evaluate = Evaluator.of(model, values, jacobian=False)
    for phase in range(PHASES if model.forced else 1):
        rates = evaluate(phase * period / PHASES, x, np.arange(n))[0]
        size = np.maximum(size, np.where(np.isfinite(rates), np.abs(rates) * period / (2 * np.pi), 0.0))
    like = likeness(model)
    weight = like.weights(period)
    return largest_of(like.group, size * weight) / weight


def tangent_steps(ensemble: Ensemble) -> NDArray[np.int64]:
    """Steps per T with which tangent vectors go on from the points of an ensemble."""
    chosen = ensemble.accuracy is not None
    return np.maximum(ensemble.point_steps, TANGENT_STEPS) if chosen else ensemble.point_steps


def run_attributes(system: System, ensemble: Ensemble, **settings: Any) -> dict[str, Any]:
    """Attributes that every Dataset of a run carries: where its numbers come from, and the settings by name."""
    origin = provenance(
        pieces(system),
        method=ensemble.method.name,
        steps_per_period=ensemble.steps if ensemble.accuracy is None else "chosen for each point by the accuracy: see steps",
        citations=(ensemble.method.source,),
    )
    compiled = {"processor": processor()[0], "roots": str(chosen())}
    cyclic = {s.name: s.cyclic for s in system.model.states if s.cyclic is not None}
    if ensemble.accuracy is not None:
        settings = {"accuracy": ensemble.accuracy, **settings}
        if doubts := doubtful(ensemble.step_verdict, system.model):
            settings["accuracy_not_met"] = doubts
    return {**origin, **compiled, **settings, **({"cyclic": json.dumps(cyclic)} if cyclic else {})}


def cyclic_states(system: System) -> dict[int, float]:
    """Periods of the states that are angles, by index."""
    return {i: s.cyclic for i, s in enumerate(system.model.states) if s.cyclic is not None}
