"""Random draws of parameters within their tolerances: draw number k depends on no other draw, order or chunk."""

from collections.abc import Mapping
from dataclasses import dataclass
from hashlib import sha256
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from whirlmap.errors import RangeError

Array = NDArray[np.float64]

#: Numbers that the generator gives for each value of its counter; one of them is used.
_WORDS = 4


@dataclass(frozen=True)
class Tolerance:
    """How a parameter scatters.

    Attributes
    ----------
    kind : {"uniform", "normal"}
    first, second : float
        Lowest and highest value of a uniform one, mean and standard deviation of a normal one.
    """

    kind: Literal["uniform", "normal"]
    first: float
    second: float

    def __post_init__(self) -> None:
        """Refuse what does not scatter."""
        if self.kind not in ("uniform", "normal"):
            raise RangeError(f"a tolerance is uniform or normal, not {self.kind!r}")
        if not (np.isfinite(self.first) and np.isfinite(self.second)):
            raise RangeError(f"{self.kind}:{self.first}:{self.second}: expected finite numbers")
        if self.kind == "uniform" and not self.first < self.second:
            raise RangeError(f"uniform:{self.first:g}:{self.second:g}: expected the lowest value before the highest")
        if self.kind == "normal" and not self.second > 0:
            raise RangeError(f"normal:{self.first:g}:{self.second:g}: expected a standard deviation above 0")

    @classmethod
    def parse(cls, text: str, nominal: float) -> "Tolerance":
        """Read ``uniform:LOW:HIGH``, ``normal:MEAN:SPREAD``, or ``uniform:10%`` and ``normal:3%`` about a nominal value."""
        form = "uniform:LOW:HIGH, normal:MEAN:SPREAD, or uniform:10% and normal:3% of the case's value"
        if not isinstance(text, str):
            raise RangeError(f"found the tolerance {text!r}, expected a text: {form}")
        kind, *rest = text.strip().split(":")
        try:
            if len(rest) == 1 and rest[0].endswith("%"):
                share = abs(nominal) * float(rest[0][:-1]) / 100
                first, second = (nominal - share, nominal + share) if kind == "uniform" else (nominal, share)
            else:
                first, second = (float(word) for word in rest)
        except ValueError:
            raise RangeError(f"cannot read the tolerance {text!r}: expected {form}") from None
        return cls(kind, first, second)  # type: ignore[arg-type]  # checked there

    def values(self, share: Array) -> Array:
        """Values at equally distributed numbers from (0, 1)."""
        if self.kind == "uniform":
            return self.first + (self.second - self.first) * share
        from scipy.special import ndtri

        return np.asarray(self.first + self.second * ndtri(share))

    def __str__(self) -> str:
        return f"{self.kind}:{self.first!r}:{self.second!r}"


def draws(tolerances: Mapping[str, Tolerance], seed: int, first: int, count: int) -> dict[str, Array]:
    """Draw parameters, from draw number ``first`` on.

    Returns
    -------
    dict of array, shape (count,)
        By parameter.

    Notes
    -----
    Philox, a generator with a counter: its key comes from the master seed and the parameter's name, its counter is the
    number of the draw. So a draw depends on nothing else, and another tolerance changes none of the others.
    """
    out = {}
    for name, tolerance in tolerances.items():
        key = np.frombuffer(sha256(f"{seed} {name}".encode()).digest()[:16], dtype=np.uint64)
        words = np.random.Philox(key=key, counter=np.array([first, 0, 0, 0], dtype=np.uint64)).random_raw(_WORDS * count)
        out[name] = tolerance.values(((words[::_WORDS] >> np.uint64(11)).astype(float) + 0.5) / 2.0**53)
    return out
