"""Ranges of a varied quantity, as they are written: ``s=0.3:4:600``, ``psi=1e-5:1:50:log`` or ``c=40um:80um:50``."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from whirlmap.errors import CaseError, RangeError
from whirlmap.units import split

#: More points than this in one range are a slip of the pen.
MOST_POINTS = 100_000_000


@dataclass(frozen=True)
class Range:
    """Values of one quantity, ascending, in a unit; in the model's own numbers where that is empty.

    Raises
    ------
    RangeError
        Where the range is empty, reversed, not finite, or logarithmic through zero.
    """

    name: str
    start: float
    stop: float
    count: int
    log: bool = False
    unit: str = ""

    def __post_init__(self) -> None:
        """Refuse a range that cannot be walked."""
        where = f"range of {self.name!r}"
        for word, value in (("start", self.start), ("stop", self.stop)):
            if not np.isfinite(value):
                raise RangeError(f"{where}: {word} must be a finite number, not {value}")
        if not 2 <= self.count <= MOST_POINTS:
            raise RangeError(f"{where}: count must lie between 2 and {MOST_POINTS}, not {self.count}")
        if self.stop <= self.start:
            hint = " (ranges ascend: swap them)" if self.stop < self.start else ""
            raise RangeError(f"{where}: stop {self.stop:g} must be above start {self.start:g}{hint}")
        if self.log and self.start <= 0:
            raise RangeError(f"{where}: a logarithmic range needs a start above zero, not {self.start:g}")

    @classmethod
    def parse(cls, text: str, option: str = "--vary") -> "Range":
        """Read ``name=start:stop:count`` or ``name=start:stop:count:log``; the ends may have a unit."""
        form = "name=start:stop:count or name=start:stop:count:log, as in s=0.3:4:600"
        name, equals, rest = text.partition("=")
        parts = [part.strip() for part in rest.split(":")]
        if not equals or not name.strip() or len(parts) not in (3, 4):
            raise RangeError(f"cannot read the range {text!r}: expected {form}")
        if len(parts) == 4 and parts[3] != "log":
            raise RangeError(f"cannot read the range {text!r}: after the count only 'log' may stand, not {parts[3]!r}")
        try:
            (start, unit), (stop, other) = map(number_and_unit, parts[:2])
        except CaseError:
            raise RangeError(f"cannot read the range {text!r}: start and stop must be numbers; expected {form}") from None
        if unit != other:
            raise RangeError(f"{option}: found {text!r}, expected the same unit on both ends, as in c=40um:60um:5")
        try:
            count = int(parts[2])
        except ValueError:
            raise RangeError(f"cannot read the range {text!r}: count {parts[2]!r} is not a whole number") from None
        return cls(name.strip(), start, stop, count, len(parts) == 4, unit)

    @property
    def values(self) -> NDArray[np.float64]:
        """The values, shape (count,)."""
        make = np.geomspace if self.log else np.linspace
        return np.asarray(make(self.start, self.stop, self.count), dtype=float)

    def rest(self, done: int) -> str:
        """Write the range of the values behind the first ``done``, of the last two where fewer are left."""
        first = min(done, self.count - 2)
        start, stop = self.values[[first, -1]].tolist()
        ends = ":".join(f"{end!r}{self.unit}" for end in (start, stop))
        return f"{self.name}={ends}:{self.count - first}{':log' if self.log else ''}"


def number_and_unit(text: str) -> tuple[float, str]:
    """Read a number that may have a unit; `CaseError` where it is none."""
    try:
        return float(text), ""
    except ValueError:
        number, unit = split(text)
        return float(number), unit


def numbers_and_unit(name: str, texts: Sequence[str]) -> tuple[list[float], str]:
    """Read numbers that have one unit, or none.

    Raises
    ------
    RangeError
        A text is no number, or their units differ.
    """
    try:
        read = [number_and_unit(text) for text in texts]
    except CaseError as error:
        raise RangeError(f"values of {name!r}: {error}") from None
    units = {unit for _, unit in read}
    if len(units) > 1:
        raise RangeError(f"values of {name!r}: found the units {', '.join(sorted(units))}, expected one")
    return [number for number, _ in read], units.pop()


def read_numbers(name: str, values: ArrayLike) -> tuple[NDArray[np.float64], str]:
    """Read one or many numbers, or texts of numbers that have one unit: their values as an array, and the unit.

    Raises
    ------
    RangeError
        As `numbers_and_unit`.
    """
    try:
        return np.atleast_1d(np.asarray(values, dtype=float)), ""
    except (TypeError, ValueError):
        texts = np.atleast_1d(np.asarray(values, dtype=object))  # lists of different lengths stay what they are
        numbers, unit = numbers_and_unit(name, [str(text) for text in texts.ravel()])
        return np.array(numbers).reshape(texts.shape), unit


def plain_numbers(name: str, values: ArrayLike) -> NDArray[np.float64]:
    """Read numbers of what has no unit, one or many.

    Raises
    ------
    RangeError
        What is no number; a number with a unit.
    """
    numbers, unit = read_numbers(name, values)
    if unit:
        raise RangeError(f"values of {name!r}: found the unit {unit!r}, expected numbers without one")
    return numbers
