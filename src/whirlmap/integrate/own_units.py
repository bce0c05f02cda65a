"""Ranges and values with units in the model's own numbers: ``speed=500 rpm:6000 rpm:50`` as a range of s."""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from whirlmap.equations.quantities import Quantity
from whirlmap.errors import CaseError, InputError, RangeError, nearest
from whirlmap.integrate.dimensions import WRITTEN, Dimensions
from whirlmap.integrate.ranges import Range, read_numbers
from whirlmap.integrate.system import System
from whirlmap.units import factor

#: Plain values of s beyond this, of a machine whose s is a speed, were meant in rpm: no rotor runs at twenty times the speed
#: that its frequencies are counted in.
MOST_S = 20.0
#: Plain lengths beyond this, in clearances of a machine with dimensions, were meant in a unit: no limit of vibration and no
#: start of a rotor is ten clearances.
MOST_CLEARANCES = 10.0


def in_parameters(system: System, found: Range, option: str = "--vary") -> Range:
    """A range in the model's own numbers: one with units is converted, a speed becomes s.

    Raises
    ------
    InputError
        A unit that the parameter does not have, or none where one is needed.
    RangeError
        A name that is no parameter, and no speed.
    """
    rotation = float(Dimensions(system).worth("rotation"))
    name = as_parameter(system, found.name) if math.isfinite(rotation) else found.name
    refuse_input(system, name, option)
    refuse_unknown(system, name, option)
    if not found.unit:
        _refuse_without_unit(system, found, rotation, option)
        return found
    size = size_of(system, system.model.parameter(name), found.unit, option)
    return replace(found, name=name, start=found.start * size, stop=found.stop * size, unit="")


def in_own_units(
    system: System, name: str, values: "ArrayLike | Range", option: str = "values"
) -> tuple[str, NDArray[np.float64]]:
    """Values of a parameter in the model's own numbers: its name, which of a speed is that of the parameter, and an array.

    Parameters
    ----------
    values : array_like, Range or str
        Numbers in the parameter's unit; texts with a unit, ``["500 rpm", "600 rpm"]``; a `Range`, or the text of one.
    option : str
        What messages call it.

    Raises
    ------
    InputError
        A unit that the parameter does not have, or none where one is needed.
    RangeError
        What is no number; with a unit, or as a range, a name that is no parameter and no speed.
    """
    if isinstance(values, str) and ":" in values:
        values = Range.parse(f"{name}={values}", option)
    if isinstance(values, Range):
        found = in_parameters(system, values, option)
        return found.name, found.values
    numbers, unit = read_numbers(name, values)
    own = as_parameter(system, name)
    if own in system.parameters and not unit:
        if own != name:
            raise InputError(f'{option}: found {name} without a unit, expected speeds with their unit, such as "500 rpm"')
        return name, numbers
    refuse_input(system, own, option)
    refuse_unknown(system, own, option)
    return own, numbers * size_of(system, system.model.parameter(own), unit, option)


def state_values(system: System, name: str, values: "ArrayLike | Range", option: str) -> NDArray[np.float64]:
    """Values of a state in the model's own numbers; they may have a unit, and be a `Range` or the text of one.

    Raises
    ------
    InputError
        As `in_state`.
    RangeError
        What is no number.
    """
    if isinstance(values, str) and ":" in values:
        values = Range.parse(f"{name}={values}", option)
    if isinstance(values, Range):
        return in_states(system, values, option).values
    numbers, unit = read_numbers(name, values)
    return numbers * in_state(system, name, 1.0, unit, option) if unit else numbers


def in_states(system: System, found: Range, option: str) -> Range:
    """A range of start values in the model's own numbers; see `in_state`."""
    start, stop = (in_state(system, found.name, end, found.unit, option) for end in (found.start, found.stop))
    return replace(found, start=start, stop=stop, unit="")


def in_state(system: System, name: str, value: float, unit: str, option: str) -> float:
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
        return value * size_of(system, state, unit, option)
    if state.measure == "length" and abs(value) > MOST_CLEARANCES and Dimensions(system).known:
        raise InputError(
            f"{option}: found {name}={value:g} without a unit, which is {value:g} clearances, expected a length with its"
            f' unit, as in "{name}=20 um"'
        )
    return value


def size_of(system: System, quantity: Quantity, unit: str, option: str) -> float:
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


def _refuse_without_unit(system: System, found: Range, rotation: float, option: str) -> None:
    if not math.isfinite(rotation):
        return
    ends, name = f"{found.start:g}:{found.stop:g}", speed_input(system) or "speed"
    expected = f'speeds with their unit, as in "{name}=500 rpm:6000 rpm'
    expected += ':50"' if option == "--vary" else '"'
    if found.name == speed_input(system):
        raise InputError(f"{option}: found {found.name}={ends} without units, expected {expected}")
    if found.name == system.speed and found.stop > MOST_S:
        rpm = found.stop * rotation * 30 / math.pi
        raise InputError(
            f"{option}: found {found.name}={ends}, which are speeds up to {rpm:.3g} rpm, expected values of {found.name}, or"
            f" {expected}"
        )


def refuse_unknown(system: System, name: str, option: str) -> None:
    """Refuse a name that is no parameter."""
    if name not in system.parameters:
        inputs = system.machine.inputs if system.machine else {}
        raise RangeError(
            f"{option}: {system.model.name} has no parameter {name!r}.{nearest(name, [*system.parameters, *inputs])}"
            f"\n  parameters: {' '.join(system.parameters)}"
            + (f"\n  dimensional inputs: {' '.join(inputs)}" if inputs else "")
        )


def refuse_input(system: System, name: str, option: str) -> None:
    """Say which parameters can be varied in place of a dimensional input."""
    if system.machine and name in system.machine.inputs:
        fed = [p for p, note in system.notes.items() if note.startswith("group:") and name in _words(note)]
        hint = f"; it feeds {', '.join(fed)}" if fed else ""
        raise RangeError(
            f"{option}: found the dimensional input {name!r} (only --vary of bifurcation, map and improve takes those),"
            f" expected a dimensionless parameter{hint}"
            f"\n  parameters: {' '.join(system.parameters)}"
        )


def _words(text: str) -> list[str]:
    return "".join(c if c.isalnum() or c == "_" else " " for c in text).split()


def speed_input(system: System) -> str:
    """Name of the dimensional input that is the speed in other words; empty where the case has none."""
    return system.machine.speed_input if system.machine else ""


def as_parameter(system: System, name: str) -> str:
    """The model's speed for the dimensional input that is the speed, any other name as it is."""
    return system.speed if system.speed and name == speed_input(system) else name


def refuse_twice(system: System, names: set[str], found: Range) -> None:
    """Refuse a parameter that is both set and varied, by whichever of its names."""
    for name in sorted(names):
        if as_parameter(system, name) == as_parameter(system, found.name):
            raise RangeError(f"{name}: found it in --set and in --vary, expected it in one of them")
