"""Checks of a model's declaration: contradictions, reserved names, symbols and functions that cannot be computed."""

import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any

from sympy import Basic, Symbol, sympify

from whirlmap.equations import allowed, names
from whirlmap.equations.parts import OF_BEARING, Journal, Output
from whirlmap.equations.pieces import Table
from whirlmap.equations.quantities import Parameter, State, t
from whirlmap.errors import ModelError

#: What to do where an output is meant to depend on time.
OUTPUT_OF_TIME = (
    " Make the output of the part without t, and multiply by the rest in Python: a time series (`whirlmap.simulate`) has the"
    " coordinate time"
)


def refuse_collections(model: str, **given: Any) -> None:
    """Refuse one symbol where several are listed, as in ``harmonics=w`` for ``harmonics=(w,)``."""
    for name, value in given.items():
        if isinstance(value, Basic):
            raise ModelError(f"model {model!r}: {name} is the symbol {value}, expected a list: write {name}=({value},)")


def refuse_names(model: str, states: Sequence[State], parameters: Sequence[Parameter], outputs: Iterable[str]) -> None:
    """Refuse a name that is given twice, or that something else has."""
    listed = [q.name for q in (*states, *parameters)]
    twice = sorted({name for name in listed if listed.count(name) > 1})
    if twice:
        raise ModelError(f"model {model!r} declares {', '.join(twice)} more than once")
    for kind, quantities in (("state", states), ("parameter", parameters)):
        for q in quantities:
            if found := names.fault(q.name):
                raise ModelError(
                    f"model {model!r}: the {kind} {q.name!r} {found}; expected another name, such as"
                    f" {re.sub(r'[^0-9A-Za-z_]', '_', q.name) + '_0'!r}"
                )
    for name in outputs:
        if name in (s.name for s in states):
            raise ModelError(f"model {model!r}: the output {name!r} has the name of a state; expected another name")


def refuse_outputs(model: str, outputs: Mapping[str, Output]) -> None:
    """Refuse a role that no output can have, one without its bearing, and one that two outputs have of a bearing."""
    seen: dict[tuple[str, str], str] = {}
    for name, output in outputs.items():
        if not output.role and not output.bearing:
            continue
        if output.role not in OF_BEARING:
            raise ModelError(
                f"model {model!r}: the output {name!r} has the role {output.role!r}, expected one of"
                f" {' | '.join(OF_BEARING)}, and the bearing that it is of"
            )
        if not output.bearing:
            raise ModelError(f"model {model!r}: the output {name!r} is the {output.role} of no bearing: add bearing=\"...\"")
        other = seen.setdefault((output.role, output.bearing), name)
        if other != name:
            raise ModelError(
                f"model {model!r}: the outputs {other!r} and {name!r} are both the {output.role} of bearing"
                f" {output.bearing!r}, expected one"
            )


def refuse_equations(model: str, states: Sequence[State], equations: Collection[State]) -> None:
    """Refuse states without an equation, and equations of what is no state."""
    if set(equations) != set(states):
        missing = [s.name for s in states if s not in equations]
        extra = [s.name for s in equations if s not in states]
        raise ModelError(
            f"model {model!r} needs one equation for each state:"
            f" without equation {missing or 'none'}, not a state {extra or 'none'}"
        )


def refuse_roles(
    model: str, speed: Any, swing: Iterable[Any], bodies: Mapping[str, Any], journals: Mapping[str, Any],
    unbalances: Iterable[str],
) -> None:  # fmt: skip
    """Refuse roles of another kind than they have; whether their symbols are the model's is asked of all expressions."""
    if speed is not None and not isinstance(speed, Parameter):
        raise ModelError(f"model {model!r}: speed is {speed}, expected one of its parameters")
    for symbol in swing:
        if not isinstance(symbol, State):
            raise ModelError(f"model {model!r}: swing names {symbol}, which is no state")
    for name, body in bodies.items():
        if not 1 <= len(set(body)) == len(body) or not all(isinstance(q, State) for q in body):
            raise ModelError(f"model {model!r}: bodies[{name!r}] is {body}, expected its coordinates: states, each once")
    for name, journal in journals.items():
        if not (isinstance(journal, Journal) and len(journal.u) == 2 and all(isinstance(q, State) for q in journal.u)):
            raise ModelError(
                f"model {model!r}: journals[{name!r}] is {journal}, expected Journal((x, y), spin) with two states"
            )
    for name in unbalances:
        if bodies and name.partition(", ")[0] not in bodies:
            raise ModelError(f"model {model!r}: unbalances names {name!r}, expected a body: {' '.join(bodies)}")


def refuse_stations(model: str, stations: Mapping[str, Sequence[str]], known: Sequence[str]) -> None:
    """Refuse stations that are not two names of states or outputs."""
    for name, pair in stations.items():
        if len(pair) != 2 or not set(pair) <= set(known):
            raise ModelError(f"model {model!r}: stations[{name!r}] is {pair}, expected the names of two states or outputs")


def refuse_expressions(
    model: str,
    expressions: Mapping[str, Sequence[Any]],
    states: Iterable[Symbol],
    parameters: Iterable[Symbol],
    tables: Iterable[Table],
) -> None:
    """Refuse what cannot be computed, and symbols that are not the model's.

    Parameters
    ----------
    expressions : mapping of str to sequence
        Those of `Model.expressions`, by the part of the declaration where they stand.
    """
    states, parameters = set(states), set(parameters)
    places = {Symbol(table.name) for table in tables}
    with_time = {"the equations", "the switchings", "the teeth", "the angular acceleration"}
    of_parameters = {"the harmonics", "the defaults", "the clocks", "the equilibrium", "the typical time", "the roles"}
    for where, some in expressions.items():
        if found := allowed.fault(some):
            raise ModelError(f"model {model!r}: {where} cannot be used: {found}")
        known = parameters | (set() if where in of_parameters else states) | ({t} if where in with_time else set())
        known |= places if where == "the equations" else set()
        for expression in some:
            for symbol in sorted(sympify(expression).free_symbols - known, key=str):
                if symbol == t:
                    of = "parameters only" if where in of_parameters else "states and parameters"
                    raise ModelError(
                        f"model {model!r}: {where} use the time t, expected functions of {of}."
                        + (OUTPUT_OF_TIME if where == "the outputs" else "")
                    )
                raise ModelError(
                    f"model {model!r}: {where} use {symbol.name!r}, which is neither a state nor one of its"
                    " parameters: add it to parameters=(...)"
                )


def refuse_unread(model: str, unread: Sequence[str]) -> None:
    """A parameter that nothing reads could neither be given (it would have no effect) nor left out (it has no value)."""
    if unread:
        raise ModelError(
            f"model {model!r} declares {', '.join(unread)}, but reads {'it' if len(unread) == 1 else 'them'} nowhere:"
            " a value would have no effect; remove from parameters=(...), or use in an equation or an output"
        )
