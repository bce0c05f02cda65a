"""Checks of a model's declaration: contradictions, reserved names, symbols and functions that cannot be computed."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from sympy import Symbol, sympify

from whirlmap.equations import allowed, names
from whirlmap.equations.quantities import t
from whirlmap.errors import ModelError

if TYPE_CHECKING:
    from whirlmap.equations.model import Model


def parts(model: Model) -> dict[str, list[Any]]:
    """Every expression of a model, by the part of the declaration where it stands."""
    of_films = [e for film in model.films.values() for e in (*film.u, film.psi, film.spin, film.strength)]
    return {
        "the equations": list(model.equations.values()),
        "the harmonics": list(model.harmonics),
        "the defaults": list(model.defaults.values()),
        "the outputs": [o.expression for o in model.outputs.values()],
        "the stops": [e for s in model.stops.values() for e in (s.gap, s.reachable)],
        "the switchings": [q.surface for q in model.switchings.values()],
        "the films": of_films,
        "the teeth": [] if model.teeth is None else [model.teeth],
        "the clocks": list(model.clocks.values()),
        "the equilibrium": list(model.equilibrium.values()),
        "the section": [model.section.surface] if model.section else [],
        "the typical time": [model.typical_time],
    }


def refuse_contradictions(model: Model) -> None:
    """Refuse a declaration that contradicts itself, or that nothing could compute.

    Raises
    ------
    ModelError
        Naming the model, the symbol or the term, and the way out.
    """
    _refuse_names(model)
    if set(model.equations) != set(model.states):
        missing = [s.name for s in model.states if s not in model.equations]
        extra = [s.name for s in model.equations if s not in model.states]
        raise ModelError(
            f"model {model.name!r} needs one equation for each state:"
            f" without equation {missing or 'none'}, not a state {extra or 'none'}"
        )
    states, parameters = set(model.states), set(model.parameters)
    tables = {Symbol(table.name) for table in model.tables}
    with_time = {"the equations", "the switchings", "the teeth"}
    of_parameters = {"the harmonics", "the defaults", "the clocks", "the equilibrium", "the typical time"}
    for where, expressions in parts(model).items():
        if found := allowed.fault(expressions):
            raise ModelError(f"model {model.name!r}: {where} cannot be used: {found}")
        known = parameters | (set() if where in of_parameters else states) | ({t} if where in with_time else set())
        _refuse_unknown(model, where, expressions, known | (tables if where == "the equations" else set()))
    if not model.forced and any(sympify(e).has(t) for e in model.equations.values()):
        raise ModelError(f"model {model.name!r} uses time but declares no harmonics: add harmonics=(...)")
    _refuse_unread(model)


def _refuse_names(model: Model) -> None:
    listed = [q.name for q in (*model.states, *model.parameters)]
    twice = sorted({name for name in listed if listed.count(name) > 1})
    if twice:
        raise ModelError(f"model {model.name!r} declares {', '.join(twice)} more than once")
    for kind, quantities in (("state", model.states), ("parameter", model.parameters)):
        for q in quantities:
            if found := names.fault(q.name):
                raise ModelError(
                    f"model {model.name!r}: the {kind} {q.name!r} {found}; expected another name, such as"
                    f" {re.sub(r'[^0-9A-Za-z_]', '_', q.name) + '_0'!r}"
                )
    for name in model.outputs:
        if name in (s.name for s in model.states):
            raise ModelError(f"model {model.name!r}: the output {name!r} has the name of a state; expected another name")


def _refuse_unknown(model: Model, where: str, expressions: list[Any], known: set[Symbol]) -> None:
    for expression in expressions:
        for symbol in sorted(sympify(expression).free_symbols - known, key=str):
            raise ModelError(
                f"model {model.name!r}: {where} use {symbol.name!r}, which is neither a state nor one of its"
                " parameters: add it to parameters=(...)"
            )


def _refuse_unread(model: Model) -> None:
    """A parameter that nothing reads could neither be given (it would have no effect) nor left out (it has no value)."""
    unread = [p.name for p in model.parameters if p not in model.read()]
    if unread:
        raise ModelError(
            f"model {model.name!r} declares {', '.join(unread)}, but reads {'it' if len(unread) == 1 else 'them'} nowhere:"
            " a value would have no effect; remove from parameters=(...), or use in an equation or an output"
        )
