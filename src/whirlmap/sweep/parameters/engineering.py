"""Speeds, limits and tolerances of a machine as its engineers write them, in the model's own numbers."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from whirlmap.errors import CaseError, InputError, RangeError, nearest
from whirlmap.integrate.dimensions import Dimensions
from whirlmap.integrate.loading import changed
from whirlmap.integrate.own_units import MOST_CLEARANCES, MOST_S
from whirlmap.integrate.system import System
from whirlmap.units import read


def given(system: System, name: str) -> float | None:
    """An input of the case in SI units, or None."""
    found = system.machine.inputs.get(name) if system.machine else None
    return None if found is None else float(found.value)


def clearance_of(system: System) -> float | None:
    """The model's length in m, or None for a case that does not say it."""
    found = float(Dimensions(system).worth("length"))
    return found if math.isfinite(found) else None


def _read(text: str, unit: str, option: str) -> float:
    try:
        return float(read(text, unit))
    except CaseError as error:
        raise InputError(f"{option}: {error}") from None


def limit_of(system: System, text: str | None, option: str = "limit") -> float:
    """A limit of vibration in the model's length.

    Parameters
    ----------
    text : str, optional
        ``"20 um"``, or a number of the model's lengths; where absent the case's own.
    option : str
        What messages call it.

    Raises
    ------
    InputError
        None is known; a length without a unit, or with one where the case has no dimensions.
    """
    clearance = clearance_of(system)
    if text is None:
        limit = given(system, "limit")
        if limit is None or clearance is None:
            raise InputError(f'{option}: {system.case} has none of its own; expected one, as in "20 um"')
        return limit / clearance
    try:
        plain = float(text)
    except ValueError:
        if clearance is None:
            raise InputError(
                f"{option}: found {text!r}, but {system.case} has no dimensions; expected a number of its lengths"
            ) from None
        return _read(text, "m", option) / clearance
    if clearance is not None and plain > MOST_CLEARANCES:
        raise InputError(
            f'{option}: found {text} without a unit, which is {text} clearances, expected a length with its unit, as in'
            ' "20 um"'
        )
    return plain


def number_of_limit(system: System, limit: float | str) -> float:
    """A limit of vibration in the model's length: a number as it is, a text as of `limit_of`.

    Raises
    ------
    InputError
        What is no number; as `limit_of`.
    """
    if isinstance(limit, str):
        return limit_of(system, limit)
    try:
        return float(limit)
    except (TypeError, ValueError):
        expected = 'a number of the model\'s lengths, or a text with a unit, such as "20 um"'
        raise InputError(f"limit: found {limit!r}, expected {expected}") from None


def speeds_of(system: System, text: str | None, option: str = "range") -> tuple[float, float]:
    """The ends of a range of speeds as values of the speed parameter.

    Parameters
    ----------
    text : str, optional
        ``"500 rpm:6000 rpm"`` of the first shaft, or values of s, ``"0.5:4"``; where absent the case's own.
    option : str
        What messages call it.

    Raises
    ------
    InputError
        None is known; speeds without a unit, or with one where the case has no dimensions.
    RangeError
        They do not ascend, or are not positive.
    """
    scale = float(Dimensions(system).worth("rotation"))
    if text is None:
        low, high = given(system, "speed_min"), given(system, "speed_max")
        if low is None or high is None:
            raise InputError(f'{option}: {system.case} has none of its own; expected one, as in "500 rpm:6000 rpm"')
        return low / scale, high / scale
    parts = [part.strip() for part in text.split(":")]
    if len(parts) != 2:
        raise InputError(f'{option}: found {text!r}, expected LOW:HIGH, as in "500 rpm:6000 rpm" or 0.5:4')
    ends = []
    for part in parts:
        try:
            ends.append(float(part))
        except ValueError:
            if not scale == scale:
                raise InputError(
                    f"{option}: found {part!r}, but {system.case} has no dimensions; expected values of {system.speed}"
                ) from None
            ends.append(_read(part, "rad/s", option) / scale)
        else:
            if scale == scale and ends[-1] > MOST_S:
                rpm = ends[-1] * scale * 30 / math.pi
                raise InputError(
                    f"{option}: found {text!r} without units, which are values of {system.speed} up to {rpm:.3g} rpm,"
                    ' expected speeds with their unit, as in "500 rpm:6000 rpm"'
                )
    if not 0 < ends[0] < ends[1]:
        raise RangeError(f"{option}: found {text!r}, expected two positive speeds, the lower one first")
    return ends[0], ends[1]


def drawn_machines(
    system: System, tolerances: Mapping[str, float], count: int, limit: float, *, seed: int = 0, option: str = "tolerances"
) -> tuple[list[System], list[float]]:
    """Machines drawn evenly from the ranges of their inputs, and the limit of each in its own clearances.

    Parameters
    ----------
    tolerances : mapping of str to float
        Half width of the range over its middle, of each dimensional input or parameter that is drawn.
    count, seed : int
        Machines, and the seed of the draws.
    limit : float
        Of the machine as it was meant, in its own clearances: it is the same length for all.
    option : str
        What messages call the tolerances.

    Raises
    ------
    InputError
        A name that the case does not have.
    """
    inputs = system.machine.inputs if system.machine else {}
    for name in tolerances:
        if name not in inputs and name not in system.parameters:
            raise InputError(
                f"{option}: {system.case} is not given {name!r}.{nearest(name, [*inputs, *system.parameters])}"
                f"\n  inputs: {' '.join(inputs)}\n  parameters: {' '.join(system.parameters)}"
            )
    random, clearance = np.random.default_rng(seed), clearance_of(system)
    machines, limits = [], []
    for _ in range(count):
        drawn: dict[str, Any] = {}
        for name, half in tolerances.items():
            factor = 1 + half * random.uniform(-1, 1)
            if name in inputs:
                drawn[name] = f"{inputs[name].value * factor!r} {inputs[name].parameter.unit}"
            else:
                drawn[name] = float(system.values[name]) * factor
        machine = changed(system, **drawn)
        machines.append(machine)
        own = clearance_of(machine)
        limits.append(limit * clearance / own if clearance and own else limit)
    return machines, limits
