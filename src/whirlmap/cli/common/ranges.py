"""Ranges of parameters as they are written on the command line, with or without units: ``speed=500 rpm:6000 rpm:50``."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from whirlmap.cli.common.assignments import assignments, brackets
from whirlmap.errors import CaseError, InputError, RangeError, nearest
from whirlmap.integrate.dimensions import WRITTEN, Dimensions
from whirlmap.sweep.parameters.ranges import Range
from whirlmap.units import factor, split

if TYPE_CHECKING:
    from whirlmap.equations.quantities import Quantity
    from whirlmap.integrate.system import System

#: Plain values of s beyond this, of a machine whose s is a speed, were meant in rpm: no rotor runs at twenty times the speed
#: that its frequencies are counted in.
MOST_S = 20.0
#: Plain lengths beyond this, in clearances of a machine with dimensions, were meant in a unit: no limit of vibration and no
#: start of a rotor is ten clearances.
MOST_CLEARANCES = 10.0
#: Dimensional input that is s in other words, and the parameter that it stands for.
SPEED = {"speed": "s"}


def read_range(text: str, option: str = "--vary") -> tuple["Range", str]:
    """Read ``name=start:stop:count[:log]`` whose ends may have a unit; the numbers stay in that unit.

    Raises
    ------
    RangeError
        Where the text has another form, or the ends have different units.
    """
    name, equals, rest = (part.strip() for part in text.partition("="))
    parts = rest.split(":")
    try:
        ends = [split(part) for part in parts[:2]] if equals and len(parts) in (3, 4) else []
    except CaseError:
        ends = []  # what is wrong with it is said by the range itself
    units = {unit for _, unit in ends}
    if len(units) > 1:
        raise RangeError(f"{option}: found {text!r}, expected the same unit on both ends, as in c=40um:60um:5")
    unit = units.pop() if units else ""
    if unit:
        text = f"{name}={':'.join([*(repr(float(value)) for value, _ in ends), *parts[2:]])}"
    return Range.parse(text), unit


def read_brackets(texts: Sequence[str] | None, option: str) -> dict[str, tuple["Range", str]]:
    """Read ``name=low:high`` texts of a repeatable option, whose ends may have a unit.

    Raises
    ------
    InputError, RangeError
        As `brackets` and `read_range`.
    """
    found = {}
    for name, text in assignments(texts, option).items():
        try:
            found[name] = read_range(f"{name}={text}:2", option)
        except RangeError:
            brackets([f"{name}={text}"], option)  # says what is wrong with it as a bracket
            raise
    return found


def in_parameters(system: "System", found: "Range", unit: str, option: str = "--vary") -> "Range":
    """A range in the model's own numbers: one with units is converted, a speed becomes s.

    Raises
    ------
    InputError
        A unit that the parameter does not have, or none where one is needed.
    RangeError
        A name that is no parameter, and no speed.
    """
    name, rotation = SPEED.get(found.name, found.name), float(Dimensions(system).worth("rotation"))
    if found.name in SPEED and not math.isfinite(rotation):
        name = found.name
    refuse_input(system, name, option)
    if name not in system.parameters:
        raise RangeError(
            f"{option}: {system.model.name} has no parameter {name!r}.{nearest(name, system.parameters)}"
            f"\n  parameters: {' '.join(system.parameters)}"
        )
    if not unit:
        _refuse_without_unit(found, rotation, option)
        return found
    size = _size_of(system, system.model.parameter(name), unit, option)
    return replace(found, name=name, start=found.start * size, stop=found.stop * size)


def in_states(system: "System", found: "Range", unit: str, option: str) -> "Range":
    """A range of start values in the model's own numbers; see `in_state`."""
    start, stop = (in_state(system, found.name, end, unit, option) for end in (found.start, found.stop))
    return replace(found, start=start, stop=stop)


def in_state(system: "System", name: str, value: float, unit: str, option: str) -> float:
    """A value of a state in the model's own numbers; what is no state is left to who reads it.

    Raises
    ------
    InputError
        A unit that the state does not have; or none, where the number is no sensible one of clearances.
    """
    state = next((s for s in system.model.states if s.name == name), None)
    if state is None:
        return value
    if unit:
        return value * _size_of(system, state, unit, option)
    if state.measure == "length" and abs(value) > MOST_CLEARANCES and Dimensions(system).known:
        raise InputError(
            f"{option}: found {name}={value:g} without a unit, which is {value:g} clearances, expected a length with its"
            f' unit, as in "{name}=20 um"'
        )
    return value


def _size_of(system: "System", quantity: "Quantity", unit: str, option: str) -> float:
    """How many of the model's own units of a quantity a unit is."""
    measure, known = quantity.measure, quantity.measure in WRITTEN
    if (not known and quantity.unit == "1") or (known and not math.isfinite(Dimensions(system).worth(measure))):
        raise InputError(f"{option}: {quantity.name} has no dimension in {system.case}, found the unit {unit!r}")
    try:
        if not known:
            return float(factor(unit, quantity.unit))
        return float(factor(unit, WRITTEN[measure][0])) / float(Dimensions(system).worth(measure))
    except CaseError as error:
        raise InputError(f"{option} {quantity.name}: {error}") from None


def _refuse_without_unit(found: "Range", rotation: float, option: str) -> None:
    if not math.isfinite(rotation):
        return
    ends, expected = f"{found.start:g}:{found.stop:g}", 'speeds with their unit, as in "speed=500 rpm:6000 rpm'
    expected += ':50"' if option == "--vary" else '"'
    if found.name in SPEED:
        raise InputError(f"{option}: found {found.name}={ends} without units, expected {expected}")
    if found.name == "s" and found.stop > MOST_S:
        rpm = found.stop * rotation * 30 / math.pi
        raise InputError(
            f"{option}: found s={ends}, which are speeds up to {rpm:.3g} rpm, expected values of s, or {expected}"
        )


def refuse_input(system: "System", name: str, option: str) -> None:
    """Say which parameters can be varied in place of a dimensional input."""
    if name in getattr(system.details, "inputs", {}):
        fed = [p for p, note in system.notes.items() if note.startswith("group:") and name in _words(note)]
        hint = f"; it feeds {', '.join(fed)}" if fed else ""
        raise RangeError(
            f"{option}: found the dimensional input {name!r} (improve varies those), expected a dimensionless"
            f" parameter{hint}"
            f"\n  parameters: {' '.join(system.parameters)}"
        )


def _words(text: str) -> list[str]:
    return "".join(c if c.isalnum() or c == "_" else " " for c in text).split()


def refuse_twice(names: set[str], found: "Range") -> None:
    """Refuse a parameter that is both set and varied, by whichever of its names."""
    for name in sorted({found.name, SPEED.get(found.name, found.name), *(k for k, v in SPEED.items() if v == found.name)}):
        if name in names:
            raise RangeError(f"{name}: found it in --set and in --vary, expected it in one of them")
