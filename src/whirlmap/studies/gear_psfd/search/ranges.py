"""The search space: plausible ranges of every group that the paper does not give, and a space-filling design."""

import hashlib
import json
import tomllib
from dataclasses import asdict, dataclass
from functools import cache
from importlib.resources import files
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.stats import qmc

from whirlmap.errors import ModelError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Range:
    """Range of one group, and why."""

    name: str
    low: float
    high: float
    scale: Literal["log", "linear"]
    why: str

    def __post_init__(self) -> None:
        """Refuse a range that is none."""
        if self.scale not in ("log", "linear") or not self.low < self.high or (self.scale == "log" and self.low <= 0):
            raise ModelError(f"ranges.toml: {self.name}: expected low < high, scale log or linear, and log above zero")

    def at(self, u: ArrayLike) -> Array:
        """Value at a place u in [0, 1] of the range."""
        place = np.asarray(u, dtype=float)
        if self.scale == "log":
            return np.asarray(self.low * (self.high / self.low) ** place)
        return np.asarray(self.low + (self.high - self.low) * place)

    def place(self, value: ArrayLike) -> Array:
        """Place in [0, 1] of a value; the reverse of `at`."""
        v = np.asarray(value, dtype=float)
        if self.scale == "log":
            return np.asarray(np.log(v / self.low) / np.log(self.high / self.low))
        return np.asarray((v - self.low) / (self.high - self.low))


@cache
def ranges() -> tuple[Range, ...]:
    """All ranges, in the order of the design's columns."""
    text = files("whirlmap.studies.gear_psfd").joinpath("ranges.toml").read_text(encoding="utf-8")
    return tuple(Range(name, **entry) for name, entry in tomllib.loads(text).items())


def digest(chosen: tuple[Range, ...]) -> str:
    """Hash of ranges: a search with others is another search."""
    numbers = [{k: v for k, v in asdict(r).items() if k != "why"} for r in chosen]
    return hashlib.sha256(json.dumps(numbers).encode()).hexdigest()[:16]


def design(chosen: tuple[Range, ...], first: int, count: int, *, seed: int | tuple[int, ...]) -> Array:
    """Parameter sets number ``first`` to ``first + count`` of a space-filling design, shape (group, set).

    A Sobol sequence, scrambled from the seed. Its first n points fill the space for every n, best for powers of two, so
    that blocks of 512 nest: more sets are added and none is thrown away.
    """
    sequence = qmc.Sobol(len(chosen), scramble=True, rng=np.random.default_rng(seed))
    if first:
        sequence.fast_forward(first)
    places = sequence.random(1 << max(count - 1, 0).bit_length())[:count]  # drawn by powers of two, as SciPy wants
    return np.stack([r.at(places[:, k]) for k, r in enumerate(chosen)])
