"""Speeds, limits and tolerances of a machine as they are written on the command line."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from whirlmap.cli.common.assignments import assignments
from whirlmap.cli.common.ranges import MOST_CLEARANCES, MOST_S
from whirlmap.errors import CaseError, InputError, RangeError, nearest
from whirlmap.integrate.loading import load
from whirlmap.sweep.speeds.safe_speeds import shaft_speed
from whirlmap.units import read

if TYPE_CHECKING:
    from whirlmap.integrate.system import System


def given(system: "System", name: str) -> float | None:
    """An input of the case in SI units, or None."""
    found = (getattr(system.details, "inputs", None) or {}).get(name)
    return None if found is None else float(found.value)


def _read(text: str, unit: str, option: str) -> float:
    try:
        return float(read(text, unit))
    except CaseError as error:
        raise InputError(f"{option}: {error}") from None


def limit_of(system: "System", text: str | None) -> float:
    """The limit in the model's length."""
    clearance = given(system, "c")
    if text is None:
        limit = given(system, "limit")
        if limit is None or clearance is None:
            raise InputError(f'--limit: {system.case} has none of its own; expected one, as in --limit "20 um"')
        return limit / clearance
    try:
        plain = float(text)
    except ValueError:
        if clearance is None:
            raise InputError(
                f"--limit: found {text!r}, but {system.case} has no dimensions; expected a number of its lengths"
            ) from None
        return _read(text, "m", "--limit") / clearance
    if clearance is not None and plain > MOST_CLEARANCES:
        raise InputError(
            f'--limit: found {text} without a unit, which is {text} clearances, expected a length with its unit, as in'
            ' "20 um"'
        )
    return plain


def range_of(system: "System", text: str | None) -> tuple[float, float]:
    """The range in values of s."""
    scale = shaft_speed(system)
    if text is None:
        low, high = given(system, "speed_min"), given(system, "speed_max")
        if low is None or high is None:
            raise InputError(f'--range: {system.case} has none of its own; expected one, as in --range "500 rpm:6000 rpm"')
        return low / scale, high / scale
    parts = [part.strip() for part in text.split(":")]
    if len(parts) != 2:
        raise InputError(f'--range: found {text!r}, expected LOW:HIGH, as in "500 rpm:6000 rpm" or 0.5:4')
    ends = []
    for part in parts:
        try:
            ends.append(float(part))
        except ValueError:
            if not scale == scale:
                raise InputError(
                    f"--range: found {part!r}, but {system.case} has no dimensions; expected values of s"
                ) from None
            ends.append(_read(part, "rad/s", "--range") / scale)
        else:
            if scale == scale and ends[-1] > MOST_S:
                rpm = ends[-1] * scale * 30 / math.pi
                raise InputError(
                    f'--range: found {text!r} without units, which are values of s up to {rpm:.3g} rpm, expected speeds with'
                    ' their unit, as in "500 rpm:6000 rpm"'
                )
    if not 0 < ends[0] < ends[1]:
        raise RangeError(f"--range: found {text!r}, expected two positive speeds, the lower one first")
    return ends[0], ends[1]


def tolerances_of(texts: Sequence[str] | None) -> dict[str, float]:
    """Half widths of ranges over their middle, by name."""
    found = {}
    for name, text in assignments(texts, "--tolerance").items():
        try:
            half = float(text.removesuffix("%")) / (100 if text.endswith("%") else 1)
        except ValueError:
            half = -1.0
        if not 0 < half < 1:
            raise InputError(f"--tolerance: found {name}={text}, expected a share between 0 and 100 %, as in c=5%")
        found[name] = half
    return found


def drawn_machines(
    system: "System", case: str, changes: dict[str, str], tolerances: dict[str, float], count: int, seed: int, limit: float
) -> tuple[list["System"], list[float]]:  # fmt: skip
    """Machines drawn evenly from the ranges of their inputs, and the limit of each in its own clearances."""
    inputs = getattr(system.details, "inputs", None) or {}
    for name in tolerances:
        if name not in inputs and name not in system.parameters:
            raise InputError(
                f"--tolerance: {system.case} is not given {name!r}.{nearest(name, [*inputs, *system.parameters])}"
                f"\n  inputs: {' '.join(inputs)}\n  parameters: {' '.join(system.parameters)}"
            )
    random, clearance = np.random.default_rng(seed), given(system, "c")
    machines, limits = [], []
    for _ in range(count):
        changed: dict[str, Any] = dict(changes)
        for name, half in tolerances.items():
            factor = 1 + half * random.uniform(-1, 1)
            if name in inputs:
                changed[name] = f"{inputs[name].value * factor!r} {inputs[name].parameter.unit}"
            else:
                changed[name] = float(system.values[name]) * factor
        machine = load(case, start=dict(system.start), **changed)
        machines.append(machine)
        own = given(machine, "c")
        limits.append(limit * clearance / own if clearance and own else limit)
    return machines, limits
