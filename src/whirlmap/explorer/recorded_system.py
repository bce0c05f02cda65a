"""The system that a result was computed from, made anew from the provenance that the result carries."""

import json
from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from whirlmap.errors import CaseError, InputError, WhirlmapError
from whirlmap.integrate.loading import load, pieces
from whirlmap.integrate.system import System

#: Attributes that the provenance of a result must hold.
NEEDED = ("case", "model_hash", "parameters", "switches", "start")


def recorded_system(attributes: Mapping[str, Any], source: str, case: str | None = None) -> System:
    """Load the system of a result from its attributes.

    Parameters
    ----------
    attributes : mapping
        Of a Dataset that whirlmap made.
    source : str
        What messages call it: the name of the file.
    case : str, optional
        Name or path of its case, where that is no stock case, or lies elsewhere now.

    Returns
    -------
    System
        With the model and every number that the result was computed with.

    Raises
    ------
    InputError
        The attributes are not those of a result, its case is not found, or is another one now: the message names the
        numbers that differ.
    """
    missing = [name for name in NEEDED if name not in attributes]
    if missing:
        raise InputError(f"{source}: found no {', '.join(missing)} in its attributes, expected a result of whirlmap")
    name = case or str(attributes["case"])
    wanted: dict[str, dict[str, Any]] = json.loads(attributes["parameters"])
    start: dict[str, float] = json.loads(attributes["start"])
    changes: dict[str, Any] = {}
    try:
        system = load(name)
        known = system.model.switches
        changes |= {k: v for k, v in json.loads(attributes["switches"]).items() if known.get(k) != v}
        system = load(name, start=start, **changes)
        for inputs in (True, False):
            changes |= _differences(system, wanted, inputs=inputs)
            system = load(name, start=start, **changes)
    except WhirlmapError as error:
        hint = "" if case else "\n  --case CASE says where its case is"
        raise CaseError(f"{source}: its case {name!r} cannot be loaded as it was: {error}{hint}") from None
    differ = [key for key in wanted if key in system.parameters and not _same(system.values[key], wanted[key]["value"])]
    if pieces(system).model_hash != attributes["model_hash"]:
        differ.append("the equations")
    if differ:
        raise CaseError(
            f"{source}: the case {name!r} is another one now: {', '.join(differ)} differ from what this was computed with"
        )
    return system


def _differences(system: System, wanted: Mapping[str, Mapping[str, Any]], *, inputs: bool) -> dict[str, Any]:
    """Changes that give a system its recorded numbers: those of its inputs, or those of its parameters."""
    changes: dict[str, Any] = {}
    given = system.machine.inputs if system.machine else {}
    for name, entry in wanted.items():
        if inputs and name in given and not _same(given[name].value, entry["value"]):
            unit = "" if entry["unit"] == "1" else f" {entry['unit']}"
            changes[name] = f"{entry['value']!r}{unit}" if unit else entry["value"]
        elif not inputs and name in system.parameters and not _same(system.values[name], entry["value"]):
            changes[name] = entry["value"]
    return changes


def _same(one: Any, other: Any) -> bool:
    return float(one) == float(Fraction(other) if isinstance(other, str) else other)
