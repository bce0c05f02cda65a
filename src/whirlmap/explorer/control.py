"""Quantities that a page can change (axes, inputs of the case, parameters of the model), and the system at their values."""

import math
import re
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from sympy import sympify

from whirlmap.errors import InputError, nearest
from whirlmap.integrate.dimensions import Dimensions
from whirlmap.integrate.loading import changed
from whirlmap.integrate.system import System
from whirlmap.sweep.parameters.axis import is_input
from whirlmap.units import read, split

#: Values of quantities, in their own unit, and words of switches, by name.
Values = Mapping[str, float | str]
#: How far a slider goes on either side of a value, as a factor.
REACH = 4.0
#: Ratio of two values beyond which they are the ends of a logarithmic axis.
WIDE = 30.0


@dataclass(frozen=True)
class Control:
    """One quantity.

    Attributes
    ----------
    name, symbol, meaning, unit : str
        ``unit`` is that of the values: "1" of a parameter in the model's own numbers.
    value, low, high : float
        Of the case, and the ends of its slider.
    log : bool
        Whether the slider is logarithmic.
    shown_unit, shown_size
        Unit in which its numbers are written, and how many of it one of ``unit`` is: rpm of a speed s.
    """

    name: str
    symbol: str
    meaning: str
    unit: str
    value: float
    low: float
    high: float
    log: bool = False
    shown_unit: str = "1"
    shown_size: float = 1.0


def controls_of(system: System, axes: Mapping[str, tuple[Sequence[float], str]]) -> dict[str, Control]:
    """Quantities of a system that can be changed, axes first.

    Parameters
    ----------
    axes : mapping of str to (values, unit)
        Of the map; the unit of a parameter is "1".
    """
    found: dict[str, Control] = {}
    inputs = dict(system.machine.inputs) if system.machine else {}
    for name, (values, unit) in axes.items():
        low, high = float(values[0]), float(values[-1])
        log = _in_ratios(values)
        middle = math.sqrt(low * high) if log else (low + high) / 2
        if is_input(system, name, beside=len(axes) > 1):
            meaning = inputs[name].parameter.meaning if name in inputs else name
            found[name] = Control(name, symbol_text(system, name), meaning, unit, middle, low, high, log, unit)
        else:
            value = float(system.values[name])
            value = value if low <= value <= high else middle
            found[name] = _parameter(system, name, value, low, high, log=log)
    own = sorted(inputs.items(), key=lambda item: item[1].parameter.unit == "1")  # pure numbers, as of teeth, last
    for name, given in own:
        if name not in found and not (system.speed in found and system.machine and name == system.machine.speed_input):
            p = given.parameter
            low, high, log = _reach(given.value, p)
            symbol, (written, size) = symbol_text(system, name), _written_in(given.written, p.unit)
            found[name] = Control(name, symbol, p.meaning, p.unit, given.value, low, high, log, written, size)
    for p in system.model.parameters:
        if p.name in found or p.order or (p.name != system.speed and system.notes.get(p.name, "").startswith("group")):
            continue  # groups follow from the inputs
        value = float(system.values[p.name])
        low, high, log = _reach(value, p)
        found[p.name] = _parameter(system, p.name, value, low, high, log=log)
    return found


def _in_ratios(values: Sequence[float]) -> bool:
    """Whether values stand in equal ratios, not in equal differences; of two, whether the ratio is large."""
    x = np.asarray(values, dtype=float)
    if x[0] <= 0:
        return False
    if x.size < 3:
        return bool(x[-1] / x[0] > WIDE)
    return bool(np.ptp(np.diff(np.log(x))) * (x[-1] - x[0]) < np.ptp(np.diff(x)) * np.log(x[-1] / x[0]))


def _parameter(system: System, name: str, value: float, low: float, high: float, *, log: bool) -> Control:
    p = system.model.parameter(name)
    shown = Dimensions(system).quantity(name)
    size = float(shown.size)
    return Control(name, symbol_text(system, name), p.meaning, "1", value, low, high, log, shown.unit, size)


def _written_in(text: str, unit: str) -> tuple[str, float]:
    """The unit in which an input was written, as rpm, and how many of it are one of its declared unit."""
    written = split(text, unit)[1].strip()
    if not written:
        return unit, 1.0
    zero, one = (read(f"{number} {written}", unit) for number in (0, 1))
    return (unit, 1.0) if zero else (written, float(1 / one))  # degrees Celsius have a zero of their own


def _reach(value: float, p: Any) -> tuple[float, float, bool]:
    """Ends of a slider about a value, within the limits of its parameter."""
    low, high = sorted((value / REACH, value * REACH)) if value else (0.0, 1.0)
    floor = p.above if p.above is not None else p.at_least
    if not value and (floor is None or floor < 0):
        low = -1.0
    if p.below is not None and high >= p.below:
        high = math.nextafter(p.below, -math.inf) if p.below > value else value
    return low, high, value > 0


def symbol_text(system: System, name: str) -> str:
    """A quantity's symbol as plain text with Greek letters: ``xi_m`` as ξ_m, ``u1x`` as u_1x."""
    quantities = (*system.model.states, *system.model.parameters)
    latex = next((q.latex for q in quantities if q.name == name), "")
    if latex:
        text = re.sub(r"\\([A-Za-z]+)", lambda word: _greek(word[1]), latex)
        return re.sub(r"\\?[{}$ ]", "", text)
    head, _, index = name.partition("_")
    if not index and _greek(head) == head and 1 < len(head) <= 3 and name in system.states:
        head, index = head[0], head[1:]
    return f"{_greek(head)}_{index}" if index else _greek(head)


def _greek(word: str) -> str:
    """The letter of a Greek name, else the word."""
    name = {"lambda": "lamda", "eps": "epsilon", "varepsilon": "epsilon"}.get(word.lower(), word.lower())
    size = "CAPITAL" if word[:1].isupper() else "SMALL"
    try:
        return unicodedata.lookup(f"GREEK {size} LETTER {name}") if len(word) > 1 else word
    except KeyError:
        return word


def system_at(system: System, controls: Mapping[str, Control], values: Values) -> System:
    """The system with other values of some of its quantities, and other choices of its switches.

    Raises
    ------
    InputError
        A name that is none of them, a value that the model or the case cannot take, or a switch that changes the states.
    """
    changes = changes_of(system, controls, values)
    rules = [sympify(rule) for rule in system.model.defaults.values()]
    followed = {q.name for rule in rules for q in rule.free_symbols}
    if set(changes) <= set(system.parameters) - followed:
        return system.replace(**changes)  # nothing follows: a tenth of the time of loading the case once more
    made = changed(system, **changes)
    if (made.states, list(made.model.outputs)) != (system.states, list(system.model.outputs)):
        words = {name: value for name, value in values.items() if isinstance(value, str)}
        said = ", ".join(f"{name} = {word}" for name, word in words.items())
        options = " ".join(f"--set {name}={word}" for name, word in words.items())
        raise InputError(f"{said}: the model has other states there: explore {system.case} with {options}")
    return made


def changes_of(system: System, controls: Mapping[str, Control], values: Values) -> dict[str, Any]:
    """The same values as `whirlmap.load` takes them: numbers of parameters, words of switches, texts with unit of inputs."""
    changes: dict[str, Any] = {}
    for name, value in values.items():
        if isinstance(value, str):
            changes[name] = value
            continue
        if name not in controls:
            raise InputError(f"{name!r} is none of the quantities that can be changed.{nearest(name, controls)}")
        unit = controls[name].unit
        changes[name] = value if name in system.parameters or unit == "1" else f"{value!r} {unit}"
    return changes
