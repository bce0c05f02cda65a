"""Loading: from a case or a model to a system that is ready to integrate."""

from collections.abc import Mapping
from fractions import Fraction
from functools import lru_cache
from pathlib import Path
from typing import Any

from sympy import sympify

from whirlmap.cases import Case, read, resolve
from whirlmap.cases.case import start_values
from whirlmap.equations.family import Family
from whirlmap.equations.identity import Known, expression_digest
from whirlmap.equations.model import Model
from whirlmap.errors import CaseError, RangeError, nearest
from whirlmap.integrate.harmonics import exact_order
from whirlmap.integrate.system import System
from whirlmap.references import key_of, references
from whirlmap.results.provenance import Pieces, model_hash


def load(
    case: str | Path | Case | Family | Model, /, *, start: Mapping[str, Any] | None = None, **changes: Any
) -> System:
    """Load a case as a system.

    Parameters
    ----------
    case : str, Path, Case, Family or Model
        Name of a stock case (`whirlmap.cases.names`), path of a TOML file, or a model of your own, whose
        parameters are then all given as changes.
    start : mapping of str to number, optional
        Start values that replace the case's and the model's.
    **changes : number or str
        Dimensionless symbols (``s=2.5``, ``r_p="1/4"``), dimensional inputs with their units
        (``mu="0.03 Pa*s"``, ``speed="1500 rpm"``) and switches (``edition="literal"``). A changed input
        recomputes its groups; a symbol that is given wins over its group.

    Returns
    -------
    System
        ``notes`` say where each value comes from; ``machine`` is the `Resolved` case with its inputs.

    Raises
    ------
    CaseError
        Naming what was found, what was expected and the nearest valid name.
    RangeError
        For a start value of an unknown state, or a start at which the run has ended already (a journal
        outside of its bearing).
    ModelError
        For switches that do not go together.

    Notes
    -----
    The file is read, units are checked, inputs become groups, and switches choose the model; nothing is compiled yet. A
    file that ``extends`` another takes what it does not give from there. Start values are at phase zero of all harmonics.
    """
    found = _case(case)
    settled = resolve(found, changes)
    for name in found.start:
        if name not in (states := [s.name for s in settled.model.states]):
            raise CaseError(
                f"{found.path}: start: found the state {name!r}, expected one of {' '.join(states)}."
                f"{nearest(name, states)}"
            )
    orders = {p.name for p in settled.model.parameters if p.order}
    values = {name: _order(v, name) if name in orders else float(v) for name, v in settled.values.items()}
    system = System(
        model=settled.model,
        values=values,
        start={**found.start, **start_values(start or {})},
        case=found.name,
        notes=dict(settled.notes),
        machine=settled,
    )
    _refuse_ended(system)
    return system


def changed(system: System, **changes: Any) -> System:
    """Load the case of a system once more, with further changes, as of `load`.

    Parameters that were replaced since it was loaded keep their values, as symbols that are given do.
    """
    settled = system.machine
    if settled is None:
        return system.replace(**changes)
    again = load(settled.case, start=dict(system.start), **{**settled.changes, **changes})
    since = {name: value for name, value in system.values.items() if value != settled.values[name] and name not in changes}
    return again.replace(**since)


def _refuse_ended(system: System) -> None:
    """Refuse a given start that lies behind one of the model's stops."""
    if not system.start:
        return  # the model's own start; an equilibrium is not known yet
    model = system.model
    point = {s: system.start.get(s.name, s.start) for s in model.states}
    point |= {p: float(system.values[p.name]) for p in model.parameters}
    for name, stop in model.stops.items():
        if float(sympify(stop.gap).subs(point)) <= 0:
            given = ", ".join(f"{state} = {value:g}" for state, value in system.start.items())
            raise RangeError(
                f"start {given}: {stop.meaning} there already ({name}), expected a start before that"
            )


def _case(case: str | Path | Case | Family | Model) -> Case:
    if isinstance(case, Case):
        return case
    if isinstance(case, Family):
        return Case(case.name, None, case)
    if isinstance(case, Model):
        return Case(case.name, None, Family(case.name, lambda: case))
    return read(case)


def _order(value: Any, name: str) -> Any:
    exact = exact_order(value, name)
    return float(value) if exact is None else exact


def pieces(system: System) -> Pieces:
    """Describe a system as plain data, for `whirlmap.results.provenance.provenance`."""
    model, settled = system.model, system.machine
    parameters: dict[str, dict[str, Any]] = {
        p.name: _entry(system.values[p.name], p.unit, system.notes.get(p.name, "")) for p in model.parameters
    }
    case_hash, roles = "", model.roles()
    values = {p: float(system.values[p.name]) for p in model.parameters}
    differing = {name: journal.clearance for name, journal in model.journals.items() if journal.clearance != 1}
    if differing:
        roles["clearances"] = {name: float(sympify(e).subs(values)) for name, e in differing.items()}
    if settled:
        case_hash = settled.case.digest
        for name, given in settled.inputs.items():
            parameters[name] = _entry(given.value, given.parameter.unit, given.note)
            if given.parameter.latex:
                roles.setdefault("symbols", {})[name] = given.parameter.latex
    sources = [entry["source"] for entry in parameters.values()]
    cited = [key_of(source) for source in sources if source.startswith("source:")]
    return Pieces(
        model=model.name,
        model_hash=_model_hash(model),
        case=system.case,
        case_hash=case_hash,
        parameters=parameters,
        switches=dict(model.switches),
        start=dict(system.start),
        roles=roles,
        citations=tuple(dict.fromkeys([*model.sources, *(key for key in cited if key in references())])),
    )


@lru_cache(maxsize=64)
def _model_hash(model: Model) -> str:
    known: Known = {}
    named = [(state.name, expression_digest(model.equations[state], known)) for state in model.states]
    named += [(f"output {name}", expression_digest(output.expression, known)) for name, output in model.outputs.items()]
    named += [(f"stop {name}", expression_digest(stop.gap, known)) for name, stop in model.stops.items()]
    named += [("parameters", " ".join(p.name for p in model.parameters))]
    return model_hash(named)


def _entry(value: Any, unit: str, source: str) -> dict[str, Any]:
    exact = isinstance(value, Fraction) and value.denominator != 1
    return {"value": str(value) if exact else float(value), "unit": unit, "source": source}
