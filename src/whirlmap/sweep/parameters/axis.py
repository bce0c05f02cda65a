"""Axes of diagrams and maps: parameters in the model's own numbers, or dimensional inputs in the unit they are given in."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import isfinite
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from whirlmap.errors import RangeError
from whirlmap.integrate.dimensions import Dimensions
from whirlmap.integrate.own_units import as_parameter, in_parameters, refuse_unknown, size_of, speed_input
from whirlmap.integrate.ranges import Range, read_numbers
from whirlmap.integrate.system import System
from whirlmap.integrate.varied_inputs import VariedInputs, input_of
from whirlmap.results.schema import variable

Array = NDArray[np.float64]


def is_input(system: System, name: str, *, beside: bool = False) -> bool:
    """Whether a name is a dimensional input of the case.

    The speed is none, but the speed parameter in other words; unless it stands ``beside`` another input, with which the unit
    of that parameter may change.
    """
    if name in system.parameters or (
        system.speed and name == speed_input(system) and not beside and isfinite(Dimensions(system).worth("rotation"))
    ):
        return False
    return input_of(system, name) is not None


def read_axis(
    system: System, name: str, values: "ArrayLike | Range", option: str = "vary", *, beside: bool = False
) -> tuple[str, Array, str]:
    """Read what is varied: its name in the results, its values, and their unit; of a parameter its own numbers, without one.

    Parameters
    ----------
    values : array_like, Range or str
        Numbers; texts with a unit, ``["40 um", "50 um"]``; a `Range`, or the text of one, ``"40um:80um:50"``.
    beside : bool
        Whether it stands beside another input: see `is_input`.

    Raises
    ------
    InputError, RangeError
        A unit that the quantity does not have, or none where one is needed; values that do not ascend.
    """
    if isinstance(values, str) and ":" in values:
        values = Range.parse(f"{name}={values}", option)
    if isinstance(values, Range):
        if not is_input(system, name, beside=beside):
            found = in_parameters(system, values, option)
            return found.name, found.values, ""
        return name, values.values, values.unit
    numbers, unit = read_numbers(name, values)
    if numbers.ndim != 1 or numbers.size < 1 or np.any(np.diff(numbers) <= 0) or not np.isfinite(numbers).all():
        raise RangeError(f"values of {name!r} must be finite and ascend")
    if is_input(system, name, beside=beside) or not unit:
        return name, numbers, unit
    name = as_parameter(system, name)
    refuse_unknown(system, name, option)
    return name, numbers * size_of(system, system.model.parameter(name), unit, option), ""


@dataclass(frozen=True)
class Axis:
    """One varied quantity.

    Attributes
    ----------
    name, meaning : str
    values : array, shape (point,)
        Ascending, in the unit.
    unit : str
    columns : mapping of str to array, shape (point,)
        The parameters of the model there: itself, or what follows from a dimensional input.
    """

    name: str
    values: Array
    unit: str
    meaning: str
    columns: Mapping[str, Array]

    @classmethod
    def of(cls, system: System, name: str, values: "ArrayLike | Range | Axis", option: str = "vary") -> "Axis":
        """Read an axis; see `read_axis`.

        Raises
        ------
        InputError, RangeError
            As `read_axis` and `VariedInputs.check`.
        """
        if isinstance(values, Axis):
            return values
        name, numbers, unit = read_axis(system, name, values, option)
        if not is_input(system, name):
            declared = next((p for p in system.model.parameters if p.name == name), None)  # what is none is refused later
            words = (declared.unit, declared.meaning) if declared else ("1", name)
            return cls(name, numbers, *words, {name: numbers})
        follows = VariedInputs(system, {name: unit}, {name: (float(numbers[0]), float(numbers[-1]))})
        follows.check()
        return cls(name, numbers, unit, follows.meaning(name), follows({name: numbers}))

    def take(self, which: Any) -> "Axis":
        """Some of its points."""
        columns = {name: column[which] for name, column in self.columns.items()}
        return replace(self, values=self.values[which], columns=columns)

    def coordinates(self, system: System) -> dict[str, Any]:
        """Itself, and the parameters that follow from it, as coordinates of a Dataset."""
        found: dict[str, Any] = {
            name: variable(self.name, column, system.model.parameter(name).unit, system.model.parameter(name).meaning)
            for name, column in self.columns.items()
        }
        return found | {self.name: variable(self.name, self.values, self.unit or "1", self.meaning)}
