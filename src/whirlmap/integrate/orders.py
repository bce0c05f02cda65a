"""Orders of the harmonics at many operating points: which points have a common period of the same length.

Steps are locked to the forcing, so points that run together share the orders of their harmonics over the fastest one. Where
the ratio of two frequencies depends on a varied parameter, points are grouped by their orders, and each group is run as an
ensemble of its own.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sympy import sympify

from whirlmap.equations.model import Model
from whirlmap.errors import RangeError
from whirlmap.integrate.harmonics import common_multiple, frequencies, nearest_order, strobe
from whirlmap.integrate.system import System

Array = NDArray[np.float64]


@dataclass(frozen=True)
class OrderGroup:
    """Points with the same orders: their indices, and the orders of the harmonics over the fastest."""

    members: NDArray[np.intp]
    orders: tuple[Fraction, ...]

    @property
    def common_multiple(self) -> int:
        """Number of T in the common period."""
        return common_multiple(self.orders)

    @property
    def strobe(self) -> int:
        """Number of T between section points that show returns."""
        return strobe(self.orders)


def orders_vary(model: Model, names: Iterable[str]) -> bool:
    """Whether the ratio of two harmonics' frequencies depends on one of these parameters, or on one that follows it."""
    return _orders_vary(model, frozenset(names))


@lru_cache(maxsize=256)
def _orders_vary(model: Model, names: frozenset[str]) -> bool:
    moving = names | {
        p.name for p, rule in model.defaults.items() if names & {q.name for q in sympify(rule).free_symbols}
    }  # fmt: skip
    first, *others = [sympify(w) for w in model.harmonics] or [None]
    return any(moving & {q.name for q in (w / first).simplify().free_symbols} for w in others)


def order_groups(system: System, values: Array, varied: Iterable[str]) -> list[OrderGroup]:
    """Divide points by the orders of their harmonics.

    Parameters
    ----------
    values : array, shape (parameter, point)
    varied : iterable of str
        Parameters that differ between points.

    Returns
    -------
    list of OrderGroup
        In the order of their common periods. One group where no order depends on what is varied.

    Raises
    ------
    RangeError
        All frequencies of a point are zero.
    """
    varied, points = tuple(varied), values.shape[1]
    if not orders_vary(system.model, varied):
        return [OrderGroup(np.arange(points), system.orders)]
    rates = frequencies(system.model, values)
    fastest = np.abs(rates).max(axis=0)
    if not np.all(fastest > 0):
        raise RangeError(f"{system.model.name}: every declared harmonic has frequency zero, so there is no period T")
    distinct, index = np.unique(rates / fastest, return_inverse=True)
    exact = [nearest_order(float(ratio)) for ratio in distinct]
    index = index.reshape(rates.shape)
    known = {order: number for number, order in enumerate(dict.fromkeys(exact))}
    codes = np.array([known[order] for order in exact])[index]
    rows, of = np.unique(codes, axis=1, return_inverse=True)
    fractions: list[Any] = list(known)
    groups = [
        OrderGroup(np.flatnonzero(of.ravel() == k), tuple(fractions[code] for code in row)) for k, row in enumerate(rows.T)
    ]  # fmt: skip
    return sorted(groups, key=lambda group: group.common_multiple)
