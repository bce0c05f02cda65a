"""Run-up and coast-down: a model whose speed changes at a constant rate, and truly, with its angular acceleration.

The speed becomes a state, and the phase of the forcing the time. Two kinds of model are told apart by their harmonics.

*Time counted by the clock* (harmonics do not contain the speed s): tau is the phase of the clock, and
d tau/dt = omega = s omega_0. Positions and their rates per radian of the clock have q' = v, and dq/dt = omega v, so that
d2q/dt2 = omega^2 (v' + (omega'/omega) v): beside the forces at the present speed, v' has the term -lambda v with
lambda = omega'/omega = (d omega/dt)/omega^2.

*Time of its own* (every harmonic is a number times the speed Omega): with the phase phi, d phi/dt = Omega, every rate is
divided by Omega and Omega t becomes phi; v stays dq/dt and has no term of the clock.

In both an unbalance at phase phi adds its angular acceleration: the acceleration of a mass at e (cos phi, sin phi) is
-e (d phi/dt)^2 (cos phi, sin phi) - e (d2 phi/dt2) (sin phi, -cos phi). `Model.angular_acceleration` declares all terms in
lambda. A constant acceleration d omega/dt = a omega_0^2 gives lambda = a/s^2, and the speed by the phase: s' = a/s.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache, partial

from sympy import Expr, sympify

from whirlmap.equations.model import Model
from whirlmap.equations.quantities import Parameter, State, t
from whirlmap.errors import ModelError

#: Name of the parameter that is the acceleration.
ACCELERATION = "run_up_acceleration"


def counts_by_clock(model: Model, name: str) -> bool:
    """Whether time of a model is counted by the clock whose speed a parameter is; else harmonics are multiples of it.

    Raises
    ------
    ModelError
        The model is not forced, its parameter is no speed of its forcing, or it does not say what an acceleration adds.
    """
    speed, harmonics = model.parameter(name), [sympify(w) for w in model.harmonics]
    if not harmonics:
        raise ModelError(f"model {model.name!r} is not forced: it has no speed that could change")
    if model.angular_acceleration is None:
        raise ModelError(
            f"model {model.name!r} does not declare what an angular acceleration adds to its rates (angular_acceleration),"
            " as that of the gear pair with free rotation or as printed; expected one that does"
        )
    by_clock = not any(w.has(speed) for w in harmonics)
    if by_clock and speed != model.speed:
        raise ModelError(f"model {model.name!r}: {name} is not its speed, expected {model.speed}")
    if not by_clock and any((w / speed).simplify().has(speed) for w in harmonics):
        raise ModelError(f"model {model.name!r}: not every frequency of its forcing is a multiple of {name}")
    return by_clock


@lru_cache(maxsize=32)
def running_up(model: Model, name: str) -> Model:
    """Declare a model whose speed is a state that changes at a constant rate.

    Parameters
    ----------
    model : Model
    name : str
        Its speed: a parameter.

    Returns
    -------
    Model
        Time is the phase of the forcing. The last state is the speed, of the same name; the parameter `ACCELERATION` is
        (d omega/dt)/omega_0^2, or d Omega/dt.

    Raises
    ------
    ModelError
        As `counts_by_clock`.

    Notes
    -----
    The derivation stands at the top of this file. Roles of linear analysis (films, the equilibrium) are left out: there is
    neither at a changing speed.
    """
    by_clock, speed = counts_by_clock(model, name), model.parameter(name)
    now = State(name, speed.unit, speed.meaning, latex=speed.latex, measure=speed.measure)
    a = Parameter(ACCELERATION, "1", f"rate of change of {name}, over the unit of time squared")
    rate = 1 if by_clock else speed  # d phi/d(model's time)
    present = {speed: now} | ({} if by_clock else {t: t / now})

    def at_present(e: Expr | int | float) -> Expr:
        return sympify(e).xreplace(present)

    added = model.angular_acceleration or {}
    equations = {
        state: at_present((e + a / speed**2 * added.get(state, 0)) / rate) for state, e in model.equations.items()
    } | {now: a / now}  # fmt: skip

    def per_phase(w: Expr | int) -> Expr:
        return sympify(w) if by_clock else (sympify(w) / speed).simplify()

    return replace(
        model,
        states=(*model.states, now),
        parameters=(*(p for p in model.parameters if p != speed), a),
        equations=equations,
        harmonics=tuple(per_phase(w) for w in model.harmonics),
        clocks={clock: per_phase(w) for clock, w in model.clocks.items()},
        outputs={key: replace(o, expression=at_present(o.expression)) for key, o in model.outputs.items()},
        stops={key: replace(o, gap=at_present(o.gap), reachable=at_present(o.reachable)) for key, o in model.stops.items()},
        switchings={key: replace(o, surface=at_present(o.surface)) for key, o in model.switchings.items()},
        teeth=None if model.teeth is None else at_present(model.teeth),
        films={}, start="states", start_where_none={}, near_equilibrium=None, equilibrium={}, checks=(), speed=None,
        angular_acceleration=None,
        plain={p: partial(_plain, form, name) for p, form in model.plain.items()},
    )  # fmt: skip


def _plain(form: Callable[[], Model], name: str) -> Model:
    """The closed form of a model, with the speed as a state."""
    return running_up(form(), name)
