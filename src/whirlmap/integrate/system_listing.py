"""Listing of a system for a terminal or a notebook: its numbers, and where they come from."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

from whirlmap.equations.model import Model
from whirlmap.results.listing import Listing, Rows


def system_listing(
    case: str,
    model: Model,
    values: Mapping[str, Any],
    notes: Mapping[str, str],
    start: Mapping[str, float],
    times: str,
    inputs: Sequence[Rows],
) -> Listing:
    """List the switches, states, times and parameters of a system; dimensional inputs as details.

    Parameters
    ----------
    times : str
        Its periods in a sentence.
    """
    switches = ", ".join(f"{name} = {choice}" for name, choice in model.switches.items())
    begin = ", ".join(f"{name} = {value:.6g}" for name, value in start.items())
    facts = [
        f"switches: {switches}" if switches else "",
        f"states: {' '.join(s.name for s in model.states)}",
        times,
        f"start: {begin}" if begin else "",
    ]
    parameters = [(p.name, _number(values[p.name]), p.unit, p.meaning, notes.get(p.name, "")) for p in model.parameters]
    return Listing(
        f"System {case or model.name}: model {model.name}",
        [fact for fact in facts if fact],
        [
            *(replace(rows, details=True) for rows in inputs),
            Rows("Parameters", ("name", "value", "unit", "meaning", "where it comes from"), parameters),
        ],
    )


def _number(value: Any) -> str:
    return str(value) if isinstance(value, Fraction) else f"{float(value):.6g}"
