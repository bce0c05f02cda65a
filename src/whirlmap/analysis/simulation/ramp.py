"""A speed that changes at a constant rate: its ends, its duration, and the speed and time at a phase."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.equations.run_up import counts_by_clock
from whirlmap.errors import ModelError, RangeError
from whirlmap.integrate.dimensions import Dimensions
from whirlmap.integrate.own_units import in_own_units
from whirlmap.integrate.system import System
from whirlmap.units import read

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Ramp:
    """A speed that changes at a constant rate, from ``begin`` to ``end`` in the model's own numbers.

    Attributes
    ----------
    name : str
        The parameter that is the speed.
    begin, end : float
    duration : float
        In units of the time that ``acceleration`` is over.
    unit : float
        That unit of time in seconds; NaN where it is not known.
    """

    name: str
    begin: float
    end: float
    duration: float
    unit: float

    @property
    def acceleration(self) -> float:
        """Rate of change of the speed."""
        return (self.end - self.begin) / self.duration

    @property
    def phase(self) -> float:
        """Phase that passes [rad]."""
        return self.duration * (self.begin + self.end) / 2

    def speed(self, phase: Array) -> Array:
        """Speed at a phase: its square is linear in the phase, for d(s^2/2)/d phase is the acceleration."""
        return np.asarray(np.sqrt(np.maximum(self.begin**2 + 2 * self.acceleration * phase, 0.0)))

    def elapsed(self, phase: Array) -> Array:
        """Time that has passed at a phase."""
        return (self.speed(phase) - self.begin) / self.acceleration


def ramp_of(system: System, name: str, begin: Any, end: Any, time: float | str) -> Ramp:
    """Read the ends of a run-up and its duration.

    Raises
    ------
    RangeError
        Ends that are equal or not positive, a duration that is not; a unit of time where the case has none.
    InputError
        A unit that the speed does not have.
    """
    name, ends = in_own_units(system, name, [begin, end])
    first, last = map(float, ends)
    try:
        by_clock = counts_by_clock(system.model, name)
    except ModelError as error:
        raise RangeError(str(error)) from None
    if not (np.isfinite(ends).all() and first > 0 and last > 0 and first != last):
        raise RangeError(f"run-up: found {name} from {begin} to {end}, expected two different speeds above zero")
    for value in (first, last):
        change: dict[str, Any] = {name: value}
        system.replace(**change)  # refuses what the model cannot take
    worth = float(Dimensions(system).worth("speed"))
    unit = float(system.values[name]) / worth if by_clock and np.isfinite(worth) else float("nan")
    try:
        length = float(time)
    except ValueError:
        if not np.isfinite(unit):
            raise RangeError(
                f"time: found {time!r}, expected a number in the model's own time: the case has no seconds"
            ) from None
        length = float(read(str(time), "s")) / unit
    else:
        if np.isfinite(unit):
            raise RangeError(f'time: found {time} without a unit, expected one, as in "{time} s"')
    if not (np.isfinite(length) and length > 0):
        raise RangeError(f"time: found {time}, expected a duration above zero")
    return Ramp(name, first, last, length, unit)
