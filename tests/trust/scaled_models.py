"""The same systems in other units: lengths times L, time times tau, both parameters, so that one kernel serves all scales.

``scaled(model, powers)`` rewrites a model so that its state s is L^a tau^b times the one of the original, at time tau t;
``powers`` gives (a, b) for each state. Nothing but the numbers changes: labels stay, lengths scale by L, exponents by 1/tau.
"""

from dataclasses import replace

from sympy import sympify

from whirlmap.equations import Parameter, Section, State, Stop, t

L = Parameter("L", "1", "scale of lengths", above=0)
tau = Parameter("tau", "1", "scale of time", above=0)


def scaled(model, powers):
    """The model with scales as parameters."""
    size = {s: L ** powers[s.name][0] * tau ** powers[s.name][1] for s in model.states}
    new = {s: State(s.name, s.unit, s.meaning, start=s.start, cyclic=s.cyclic) for s in model.states}

    def rewritten(expression):
        return sympify(expression).subs({t: t / tau, **{s: new[s] / size[s] for s in model.states}}, simultaneous=True)

    scales = (L, tau) if any(a for a, _ in powers.values()) else (tau,)  # angles have no length
    section = model.section and Section(rewritten(model.section.surface), model.section.direction)
    return replace(
        model, name=f"scaled_{model.name}", states=tuple(new.values()), parameters=(*model.parameters, *scales),
        equations={new[s]: size[s] / tau * rewritten(model.equations[s]) for s in model.states},
        harmonics=tuple(w / tau for w in model.harmonics), section=section, typical_time=model.typical_time * tau,
        stops={n: Stop(rewritten(stop.gap), stop.meaning) for n, stop in model.stops.items()}, switchings={}, teeth=None,
        clocks={}, outputs={}, swing=(new[model.swing[0]],) if model.swing else (),
    )  # fmt: skip


def size_of(powers, name, length, time):
    a, b = powers[name]
    return length**a * time**b


OSCILLATOR = {"x": (1, 0), "v": (1, -1)}
ANGLE = {"x": (0, 0), "v": (0, -1)}
THREE = {"x": (1, 0), "y": (1, 0), "z": (1, 0)}
ROTOR = {"x": (1, 0), "y": (1, 0), "vx": (1, -1), "vy": (1, -1)}
