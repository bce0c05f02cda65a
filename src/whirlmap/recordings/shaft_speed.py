"""Speed of a shaft from a column of a file: values with a unit of speed, or one pulse per turn."""

import numpy as np

from whirlmap.errors import CaseError, InputError, RangeError
from whirlmap.recordings.table import Array, Table, find_column
from whirlmap.units import factor


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


def shaft_speed(table: Table, at: int, values: Array, rate: float | None, notices: list[str]) -> float:
    """Turns per second of a column with the speed, or with one pulse per turn."""
    column = table.columns[at]
    title = column.title or f"column {at + 1}"
    values = values[np.isfinite(values)]
    if column.unit and column.unit not in ("V", "mV", "1"):
        turns = values * turns_per(column.unit, title)
        if np.ptp(turns) > 0.01 * abs(turns.mean()):
            notices.append(
                f"the speed in {title!r} varies from {turns.min():.6g} to {turns.max():.6g} turns per second: its mean "
                "is taken"
            )
        return abs(float(turns.mean()))
    high = values > (values.max() + values.min()) / 2
    rises = np.flatnonzero(high[1:] & ~high[:-1])
    if rate is None or rises.size < 3:
        raise RangeError(
            f"--speed: found no unit and {rises.size} pulses in {title!r}, expected a unit such as [rpm], or pulses"
        )
    spread = np.diff(rises)
    if np.ptp(spread) > max(2.0, 0.02 * float(spread.mean())):
        notices.append(
            f"the pulses in {title!r} come every {spread.min()} to {spread.max()} samples: their mean is taken as the turn"
        )
    return float(rate * (rises.size - 1) / (rises[-1] - rises[0]))


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
