"""Free parameters of a branch: parameters of the model, or dimensional inputs from which its parameters follow."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.motion.ensembles import parameter_values
from whirlmap.equations.quantities import Parameter
from whirlmap.errors import CaseError, InputError, RangeError
from whirlmap.integrate.orders import orders_vary
from whirlmap.integrate.own_units import size_of
from whirlmap.integrate.ranges import Range, number_and_unit
from whirlmap.integrate.system import System
from whirlmap.integrate.varied_inputs import VariedInputs, input_of
from whirlmap.sweep.parameters.axis import is_input, read_axis
from whirlmap.units import read

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Varied:
    """One free parameter and its range.

    Attributes
    ----------
    name : str
        As it is called in results: the model's parameter, or the dimensional input.
    given : str
        As it was called.
    low, high : float
        Ends of the range, in the numbers of ``name``.
    unit : str
        In which it was given; that of the parameter where none was.
    size : float
        One of that unit, in the numbers of ``name``.
    meaning : str
    """

    name: str
    given: str
    low: float
    high: float
    unit: str
    size: float
    meaning: str

    @classmethod
    def of(
        cls, system: System, name: str, ends: str | Range | Sequence[Any], option: str = "--vary", *, beside: bool = False
    ) -> "Varied":
        """Read a range: two numbers, two texts with units, or ``"START:STOP"``.

        Raises
        ------
        InputError, RangeError
            Not two ends, or ends that do not ascend; a unit that the quantity does not have, or none where it needs one.
        """
        if not isinstance(ends, Range):
            parts = ends.split(":") if isinstance(ends, str) else [str(end) for end in ends]
            if len(parts) != 2:
                raise RangeError(
                    f"{option}: found {name}={ends if isinstance(ends, str) else ':'.join(parts)}, expected"
                    f" {name}=START:STOP, without a number of points: a branch takes steps of its own"
                )
            for part in parts:
                try:
                    number_and_unit(part)
                except CaseError:
                    found = f"{name}={':'.join(parts)}"
                    raise RangeError(f"{option}: found {found}, expected {name}=START:STOP, two numbers") from None
            ends = Range.parse(f"{name}={parts[0]}:{parts[1]}:2", option)
        own, numbers, unit = read_axis(system, name, ends, option, beside=beside)
        low, high = numbers.tolist()
        if is_input(system, own, beside=beside):
            declared = input_of(system, own)
            assert declared is not None
            return cls(own, name, low, high, unit or declared.unit, 1.0, declared.meaning)
        parameter = system.model.parameter(own)
        size = size_of(system, parameter, ends.unit, option) if ends.unit else 1.0
        return cls(own, name, low, high, ends.unit or parameter.unit, size, parameter.meaning)

    def shown(self, value: float) -> float:
        """A value in the unit in which the range was given."""
        return value / self.size

    def read(self, value: float | str, option: str = "--from") -> float:
        """A value within the range, which may have a unit, in the numbers of ``name``.

        Raises
        ------
        InputError, RangeError
            Another unit, no unit beside a range with one, or a value beyond the range.
        """
        number, unit = number_and_unit(value) if isinstance(value, str) else (float(value), "")
        if unit and unit != self.unit:
            raise InputError(f"{option}: found {value}, expected it in {self.unit}, as the range")
        if not unit and isinstance(value, str) and self.size != 1.0:
            raise InputError(f"{option}: found {value} without a unit, expected one, as in {number:g} {self.unit}")
        found = number * self.size if unit or isinstance(value, str) else number
        if not self.low <= found <= self.high:
            raise RangeError(
                f"{option}: found {number:g}, expected a value of {self.given} from {self.shown(self.low):g} to"
                f" {self.shown(self.high):g}"
            )
        return found


@dataclass(frozen=True)
class FreeParameters:
    """Values of all parameters as functions of one or two free ones.

    Attributes
    ----------
    system : System
    varied : tuple of Varied
    """

    system: System
    varied: tuple[Varied, ...]

    def __post_init__(self) -> None:
        """Refuse parameters along which no orbit could be followed.

        Raises
        ------
        RangeError
            One that changes the ratio of two frequencies of the forcing, or an input that cannot be varied.
        """
        if self._follows is not None:
            self._follows.check()
        ends = np.array([[v.low, v.high] for v in self.varied])
        columns = self.following(ends)
        parameter_values(self.system, columns)
        if orders_vary(self.system.model, columns):
            names = " and ".join(v.given for v in self.varied)
            raise RangeError(f"{names} changes the ratio of two frequencies of the forcing: no orbit keeps its period")

    @cached_property
    def _follows(self) -> VariedInputs | None:
        """Parameters that follow from the dimensional inputs among the free ones."""
        beside = len(self.varied) > 1
        inputs = [v for v in self.varied if is_input(self.system, v.name, beside=beside)]
        if not inputs:
            return None
        others = [v.name for v in self.varied if v not in inputs]
        return VariedInputs(
            self.system, {v.name: v.unit for v in inputs}, {v.name: (v.low, v.high) for v in inputs}, others
        )

    def following(self, free: Array) -> dict[str, Array]:
        """Parameters that change with the free ones, at free parameters of shape (free, point)."""
        follows = self._follows
        inputs = follows.units if follows is not None else {}
        rows = dict(zip((v.name for v in self.varied), free, strict=True))
        own = {name: row for name, row in rows.items() if name not in inputs}
        return own | (follows({name: rows[name] for name in inputs}) if follows is not None else {})

    def columns(self, free: Array) -> Array:
        """Values of all parameters, shape (parameter, point), at free parameters, shape (free, point)."""
        return parameter_values(self.system, self.following(free))

    def at(self, *free: float) -> dict[str, Array]:
        """Parameters that change with the free ones, at one point."""
        return self.following(np.array(free)[:, None])

    def allowed(self, free: Array) -> NDArray[np.bool_]:
        """Which points the model takes."""
        good = np.isfinite(free).all(axis=0)
        for varied, row in zip(self.varied, free, strict=True):
            declared = self._declared(varied)
            low, high = self._in_declared_units(varied)
            there = low + (row - varied.low) * (high - low) / (varied.high - varied.low)
            good = good & np.array([not declared.fault(float(value)) for value in there])
        return np.asarray(good)

    def _declared(self, varied: Varied) -> Parameter:
        if self._follows is not None and varied.name in self._follows.units:
            found = input_of(self.system, varied.name)
            assert found is not None
            return found
        return self.system.model.parameter(varied.name)

    def _in_declared_units(self, varied: Varied) -> tuple[float, float]:
        """Ends of a range in the unit in which the limits of the quantity are declared."""
        if self._follows is None or varied.name not in self._follows.units or not varied.unit:
            return varied.low, varied.high
        unit = self._declared(varied).unit
        low, high = (float(read(f"{end!r} {varied.unit}", unit)) for end in (varied.low, varied.high))
        return low, high

    @property
    def widths(self) -> Array:
        """Widths of the ranges."""
        return np.array([v.high - v.low for v in self.varied])
