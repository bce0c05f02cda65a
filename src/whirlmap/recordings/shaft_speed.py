"""Speed of a shaft beside a signal: from a text, or from a column with values or one pulse per turn."""

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from whirlmap.errors import CaseError, InputError, RangeError
from whirlmap.recordings.table import Array, Table, find_column
from whirlmap.units import factor

_SPEED = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)(?:\s*([a-zA-Z/]\S*)|\s+(1/\S+))\s*")


@dataclass(frozen=True)
class ShaftSpeed:
    """How a shaft turns during a signal.

    Attributes
    ----------
    at : array, shape (known,)
        Samples of the signal at which the angle is known, ascending; they need not be whole numbers.
    turns : array, shape (known,)
        Angle there [turns].
    """

    at: Array
    turns: Array

    @classmethod
    def constant(cls, per_sample: float, samples: int) -> "ShaftSpeed":
        """One speed, in turns per sample, during so many samples."""
        return cls(np.array([0.0, samples]), np.array([0.0, per_sample * samples]))

    @classmethod
    def of_values(cls, at: Array, per_sample: Array) -> "ShaftSpeed":
        """Speeds, in turns per sample, at some samples."""
        steps = np.diff(at) * (per_sample[1:] + per_sample[:-1]) / 2
        return cls(np.asarray(at, dtype=float), np.r_[0.0, np.cumsum(steps)])

    def per_sample(self, first: int, last: int) -> float | None:
        """Mean speed from one sample to another [turns per sample]; None where it is known in less than half of them."""
        begin, end = max(first, float(self.at[0])), min(last, float(self.at[-1]))
        if 2 * (end - begin) < last - first:
            return None
        passed = np.interp([begin, end], self.at, self.turns)
        return abs(float(passed[1] - passed[0])) / (end - begin)


def speed_column(table: Table, wanted: str) -> int:
    """Position of the column that ``--speed`` names; a number that is no column is a speed without its unit."""
    try:
        return find_column(table, wanted, "--speed")
    except InputError:
        try:
            float(wanted)
        except ValueError:
            pass
        else:
            raise InputError(
                f"--speed: found {wanted!r}, a number without a unit that is no column either, expected a speed such as"
                f" '{wanted.strip()} rpm' or '{wanted.strip()} Hz', or a column"
            ) from None
        raise


def shaft_speed(
    table: Table, position: int, at: NDArray[np.int64], values: Array, rate: float | None, notices: list[str]
) -> ShaftSpeed:
    """Angle of a shaft from a column with the speed, or with one pulse per turn, at some samples of the signal."""
    column = table.columns[position]
    title = column.title or f"column {position + 1}"
    known = np.isfinite(values)
    at, values = at[known], values[known]
    if column.unit and column.unit not in ("V", "mV", "1"):
        if rate is None or at.size < 2:
            raise RangeError(f"--speed: found {at.size} speeds in {title!r} and the rate {rate}, expected both")
        turns = values * turns_per(column.unit, title)
        if np.ptp(turns) > 0.01 * abs(turns.mean()):
            notices.append(
                f"the speed in {title!r} varies from {turns.min():.6g} to {turns.max():.6g} turns per second: its mean "
                "is taken"
            )
        return ShaftSpeed.of_values(at.astype(float), turns / rate)
    high = values > (values.max() + values.min()) / 2
    rises = np.flatnonzero(high[1:] & ~high[:-1])
    if rate is None or rises.size < 3:
        raise RangeError(
            f"--speed: found no unit and {rises.size} pulses in {title!r}, expected a unit such as [rpm], or pulses"
        )
    spread = np.diff(at[rises])
    if np.ptp(spread) > max(2.0, 0.02 * float(spread.mean())):
        notices.append(
            f"the pulses in {title!r} come every {spread.min()} to {spread.max()} samples: their mean is taken as the turn"
        )
    return ShaftSpeed(at[rises].astype(float), np.arange(rises.size, dtype=float))


def speed_of(text: str) -> float | None:
    """Turns per second of a text such as ``1480 rpm``; None where it is no number with a unit.

    Raises
    ------
    RangeError
        The unit is none of speed, or the speed is zero.
    """
    found = _SPEED.fullmatch(text)
    if not found:
        return None
    speed = abs(float(found[1])) * turns_per(found[2] or found[3], f"--speed {text}")
    if speed == 0:
        raise RangeError(f"--speed: found {text!r}, expected a speed that is not zero")
    return speed


def turns_per(unit: str, where: str) -> float:
    """Turns per second in one unit of speed; Hz, 1/s and 1/min count turns here."""
    if unit in ("Hz", "1/s"):
        return 1.0
    if unit in ("1/min", "/min"):
        return 1 / 60
    try:
        return float(factor(unit, "turn/s"))
    except CaseError:
        raise RangeError(f"--speed: found the unit {unit!r} in {where}, expected one of speed, such as rpm or Hz") from None
