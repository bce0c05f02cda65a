"""Listing of a system for a terminal or a notebook: its numbers, and where they come from."""

from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from whirlmap.errors import RangeError
from whirlmap.results.listing import Listing, Rows

if TYPE_CHECKING:
    from whirlmap.integrate.system import System


def system_listing(system: "System") -> Listing:
    """List the switches, states, times and parameters of a system; dimensional inputs as details."""
    model = system.model
    switches = ", ".join(f"{name} = {choice}" for name, choice in model.switches.items())
    start = ", ".join(f"{name} = {value:.6g}" for name, value in system.start.items())
    facts = [
        f"switches: {switches}" if switches else "",
        f"states: {' '.join(system.states)}",
        _times(system),
        f"start: {start}" if start else "",
    ]
    parameters = [
        (p.name, _number(system.values[p.name]), p.unit, p.meaning, system.notes.get(p.name, "")) for p in model.parameters
    ]
    inputs = system.details.listing().tables if system.details else ()
    return Listing(
        f"System {system.case or model.name}: model {model.name}",
        [fact for fact in facts if fact],
        [
            *(replace(rows, details=True) for rows in inputs),
            Rows("Parameters", ("name", "value", "unit", "meaning", "where it comes from"), parameters),
        ],
    )


def _times(system: "System") -> str:
    if not system.model.forced:
        return f"unforced, typical time {system.period:.6g}"
    try:
        period = system.period
    except RangeError as error:  # all frequencies are zero: such a system can be had, and is to be seen too
        return str(error)
    together = f"common period {system.common_multiple} T" if system.repeats else "no common period"
    return f"period T = {period:.6g}, {together}"


def _number(value: Any) -> str:
    return str(value) if isinstance(value, Fraction) else f"{float(value):.6g}"
