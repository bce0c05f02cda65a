"""Ranges of a varied parameter, as they are written on the command line: ``s=0.3:4:600`` or ``psi=1e-5:1:50:log``."""

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from whirlmap.errors import RangeError

#: More points than this in one range are a slip of the pen.
MOST_POINTS = 100_000_000


@dataclass(frozen=True)
class Range:
    """Values of one parameter, ascending.

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
    def parse(cls, text: str) -> "Range":
        """Read ``name=start:stop:count`` or ``name=start:stop:count:log``."""
        form = "name=start:stop:count or name=start:stop:count:log, as in s=0.3:4:600"
        name, equals, rest = text.partition("=")
        parts = rest.split(":")
        if not equals or not name.strip() or len(parts) not in (3, 4):
            raise RangeError(f"cannot read the range {text!r}: expected {form}")
        if len(parts) == 4 and parts[3] != "log":
            raise RangeError(f"cannot read the range {text!r}: after the count only 'log' may stand, not {parts[3]!r}")
        try:
            start, stop = float(parts[0]), float(parts[1])
        except ValueError:
            written = all(re.match(r"\s*[-+.]?\d", part) for part in parts[:2])
            why = " without units (inputs with units are varied by improve)" if written else ""
            fault = f"start and stop must be numbers{why}; expected {form}"
            raise RangeError(f"cannot read the range {text!r}: {fault}") from None
        try:
            count = int(parts[2])
        except ValueError:
            raise RangeError(f"cannot read the range {text!r}: count {parts[2]!r} is not a whole number") from None
        return cls(name.strip(), start, stop, count, len(parts) == 4)

    @property
    def values(self) -> NDArray[np.float64]:
        """The values, shape (count,)."""
        make = np.geomspace if self.log else np.linspace
        return np.asarray(make(self.start, self.stop, self.count), dtype=float)

    def rest(self, done: int) -> str:
        """Write the range of the values behind the first ``done``, of the last two where fewer are left."""
        first = min(done, self.count - 2)
        start, stop = self.values[[first, -1]].tolist()
        return f"{self.name}={start!r}:{stop!r}:{self.count - first}{':log' if self.log else ''}"
