"""Data that the paper's claims are judged by: labelled diagrams of many parameter sets at once, as plain arrays.

A reproduction judges one set with many speeds, a search thousands of sets with a few speeds each; both use these arrays.
Arrays have the shape (set, psi, speed), or (set, psi) at the speed of Figures 6 and 7.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.labels.votes import BREATHING
from whirlmap.results.regime import WITHOUT_BOUND, Regime

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

#: Permeabilities of Figures 2 to 5, and the speed of Figures 6 and 7.
PSI = (0.0, 1e-4, 1e-3, 0.1)
S_ORBIT = 3.27
#: Coordinates of Figures 6 and 7, with the figure's number.
ORBITS = {"yp": 6, "y2": 7}


@dataclass(frozen=True)
class Orbits:
    """The operating points of Figures 6 and 7, arrays of shape (set, psi).

    Attributes
    ----------
    regime : array of int
    exponent, error : array
        Largest Lyapunov exponent; NaN where it was not measured.
    lines, broadband : array
        Spectral lines of y_p above the floor, and the share of power beside them; NaN where no spectrum was taken.
    dimension : mapping of coordinate to (D2, error)
        In the plane (y, y'); NaN where there is none.
    least : float
        Smallest exponent that is growth.
    """

    regime: NDArray[np.int8]
    exponent: Array
    error: Array
    lines: Array
    broadband: Array
    dimension: Mapping[str, tuple[Array, Array]]
    least: float = 0.0


@dataclass(frozen=True)
class Labelled:
    """Labelled diagrams at the four permeabilities of `PSI`; speeds are the paper's.

    Attributes
    ----------
    s : array, shape (speed,)
    regime, period : array of int, shape (set, psi, speed)
        `Regime`, and the return in T.
    exponent, error : array
        Largest Lyapunov exponent of points that do not return; NaN elsewhere.
    amplitude : array
        Peak-to-peak of y_p; NaN where the run ended.
    slowness : array
        How long a point took to settle, over the longest wait, in [0, 1]: slow means close to another motion. It moves
        scores, never a verdict.
    forced : int
        T in the common period of the forcing: 8 in the paper's clock.
    least : float
        Smallest exponent that is growth (`least_exponent`).
    orbits : Orbits
    """

    s: Array
    regime: NDArray[np.int8]
    period: NDArray[np.int64]
    exponent: Array
    error: Array
    amplitude: Array
    slowness: Array
    forced: int
    least: float
    orbits: Orbits = field(repr=False)

    @cached_property
    def kinds(self) -> dict[str, Mask]:
        """Kind of each point: returns with the forcing or otherwise, is non-periodic (of three kinds), or ended.

        A point is chaotic here where it is labelled so, or where it is undecided, does not return, and its largest exponent
        lies three standard errors above zero and above `least`.
        """
        returns = np.isin(self.regime, (Regime.periodic, Regime.at_rest))
        open_motion = np.isin(self.regime, (Regime.undecided, Regime.not_settled))
        grows = open_motion & positive(self.exponent, self.error, self.least)
        return {
            "with the forcing": returns & (self.period == self.forced),
            "periodic otherwise": returns & (self.period != self.forced),
            "quasi-periodic": self.regime == Regime.quasi_periodic,
            "chaotic": (self.regime == Regime.chaotic) | grows,
            "undecided": open_motion & ~grows,
            "contact": self.regime == Regime.contact,
            "diverged": np.isin(self.regime, WITHOUT_BOUND),
        }

    @cached_property
    def open(self) -> Mask:
        """Points that run on without a return."""
        k = self.kinds
        return k["quasi-periodic"] | k["chaotic"] | k["undecided"]

    @cached_property
    def ended(self) -> Mask:
        """Points that end in contact or diverge."""
        return self.kinds["contact"] | self.kinds["diverged"]

    def between(self, low: float, high: float) -> Mask:
        """Speeds in a window (closed, to rounding), shape (speed,)."""
        return (self.s >= low - 1e-9) & (self.s <= high + 1e-9)

    def share(self, wanted: Mask, where: Mask) -> Array:
        """Share of the speeds of a window at which something is so; the last axis is the speed."""
        return np.asarray((wanted & where).sum(axis=-1) / max(int(where.sum()), 1), dtype=float)

    def credit(self, wanted: str) -> Array:
        """How close each point is to what a claim wants of it, in [0, 1]: 1 where it is so.

        Only to lead a search where nothing holds yet. A motion counts by its distance in kind from the wanted one, an
        undecided one by its exponent in standard errors, a periodic one by how slowly it settled. Kinds that no claim of the
        paper asks for have no nearness: 1 or 0.
        """
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            z = np.clip(np.nan_to_num(self.exponent / self.error, nan=0.0), -30, 30)
            rising = 1 / (1 + np.exp(-z))
        worth: dict[str, Any] = {
            "chaotic": {
                "chaotic": 1.0, "undecided": 0.4 + 0.5 * rising, "quasi-periodic": 0.5, "periodic otherwise": 0.35,
                "with the forcing": 0.25 * self.slowness, "contact": 0.05, "diverged": 0.0,
            },
            "with the forcing": {
                "with the forcing": 1.0, "periodic otherwise": 0.6, "quasi-periodic": 0.4,
                "undecided": 0.5 - 0.2 * rising, "chaotic": 0.1, "contact": 0.05, "diverged": 0.0,
            },
            "open": {
                "chaotic": 1.0, "undecided": 1.0, "quasi-periodic": 1.0, "periodic otherwise": 0.4,
                "with the forcing": 0.3 * self.slowness, "contact": 0.05, "diverged": 0.0,
            },
        }.get(wanted, {wanted: 1.0})  # fmt: skip
        out: Array = np.zeros(self.regime.shape)
        for name, mask in self.kinds.items():
            out = np.asarray(np.where(mask, worth.get(name, 0.0), out))
        return out


def least_exponent(periods: int, period: float) -> float:
    """Smallest exponent that counts as growth, measured over so many periods T.

    The total growth must exceed ln(periods) + 3, as in `whirlmap.analysis.labels.votes`. That also keeps out motion that
    grows without bound: where neither the transient nor this run met the bound, it has grown by less.
    """
    return (math.log(periods) + BREATHING) / (periods * period)


def positive(exponent: Array, error: Array, least: float) -> Mask:
    """Exponents that lie three standard errors above zero, and above the least that is growth."""
    with np.errstate(invalid="ignore"):
        return np.asarray((exponent > 3 * error) & (exponent > least))


def median_of(values: Array, where: Mask) -> Array:
    """Median over the last axis of the finite values where ``where`` holds; NaN where there is none."""
    picked = np.sort(np.where(where & np.isfinite(values), values, np.nan), axis=-1)  # NaN sorts to the end
    count = np.isfinite(picked).sum(axis=-1)
    low = np.take_along_axis(picked, np.maximum((count - 1) // 2, 0)[..., None], axis=-1)[..., 0]
    high = np.take_along_axis(picked, np.minimum(count // 2, picked.shape[-1] - 1)[..., None], axis=-1)[..., 0]
    return np.asarray(np.where(count > 0, (low + high) / 2, np.nan))
