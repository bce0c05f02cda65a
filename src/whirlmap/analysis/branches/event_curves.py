"""Curves of folds, period doublings and Neimark-Sacker points in two parameters: the orbit's equations and one more.

A fold has a singular derivative, a period doubling one of M + I: the smallest singular value is the added equation, written
by bordering, so that it has a derivative [kuznetsov2004, ch. 10]. At a Neimark-Sacker point the product of a pair of
multipliers is one, also where the pair becomes real. The derivatives of the added equation are differences of neighbouring
orbits, all of them in one call; no solution depends on their error.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.branches.periodic_orbits import PeriodicOrbits
from whirlmap.analysis.branches.unknowns import Linear, Unknowns
from whirlmap.results.status import Status

Array = NDArray[np.float64]
Kind = Literal["fold", "period-doubling", "neimark-sacker"]

#: Difference of each unknown on either side, over its size, by which the added equation is differentiated.
DIFFERENCE = 1e-5


@dataclass(frozen=True)
class EventCurve:
    """Events of one kind in two free parameters.

    Attributes
    ----------
    orbits : PeriodicOrbits
        With two free parameters.
    kind : str
    """

    orbits: PeriodicOrbits
    kind: Kind

    @property
    def key(self) -> tuple[Any, ...]:
        """What tells equations whose points may be computed together from others."""
        return self.kind, *self.orbits.key

    def exponents(self, linear: Linear) -> tuple[Array, Array]:
        """Those of the orbits."""
        return self.orbits.exponents(linear)

    def linear(self, points: Sequence[Unknowns], before: Sequence[Linear | None] = ()) -> list[Linear]:
        """The orbits' equations, and the added one as the last."""
        known = [b for b in before if b is not None and b.status == Status.ok]
        reused = len(known) == len(points)
        cut = [Linear(b.residual[:-1], b.jacobian[:-1], b.sizes, b.weights[:-1], b.matrices) for b in known]
        own = self.orbits.linear(points, cut if reused else ())
        slopes = [b.jacobian[-1] for b in known] if reused else self._slopes(points, own)
        out = []
        for point, linear, slope in zip(points, own, slopes, strict=True):
            if linear.status != Status.ok:
                out.append(linear)
                continue
            added = Added.of(self.kind, point, linear)
            out.append(
                Linear(
                    np.append(linear.residual, added.value), np.vstack([linear.jacobian, slope]), linear.sizes,
                    np.append(linear.weights, 1.0), linear.matrices,
                )
            )  # fmt: skip
        return out

    def _slopes(self, points: Sequence[Unknowns], own: Sequence[Linear]) -> list[Array]:
        """Derivative of the added equation by all unknowns of each point.

        A state at the beginning of a segment changes the derivatives of that segment alone, so that the same state of all
        segments is moved at once.
        """
        moved: list[Unknowns] = []
        steps: list[Array] = []
        for point, linear in zip(points, own, strict=True):
            n = point.x.shape[1]
            rest = linear.sizes.size - point.x.size
            unit = np.concatenate([linear.weights[:n], linear.sizes[-rest:]]) * DIFFERENCE
            shift = np.zeros((unit.size, linear.sizes.size))
            for i in range(n):
                shift[i, i : point.x.size : n] = unit[i]
            shift[n:, point.x.size :] = np.diag(unit[n:])
            moved += [point.of(point.vector + sign * row) for row in shift for sign in (1, -1)]
            steps.append(unit)
        known = [linear for linear, unit in zip(own, steps, strict=True) for _ in range(2 * unit.size)]
        near = self.orbits.linear(moved, known)
        out, at = [], 0
        for point, linear, unit in zip(points, own, steps, strict=True):
            here, at = near[at : at + 2 * unit.size], at + 2 * unit.size
            out.append(self._slope(point, linear, unit, here))
        return out

    def _slope(self, point: Unknowns, linear: Linear, unit: Array, near: Sequence[Linear]) -> Array:
        count, n = point.x.shape
        added, slope = Added.of(self.kind, point, linear), np.zeros(linear.sizes.size)
        for j, size in enumerate(unit):
            pair = near[2 * j : 2 * j + 2]
            if j >= n:
                ahead, behind = (added.at(p.jacobian) for p in pair)
                slope[point.x.size + j - n] = (ahead - behind) / (2 * size)
                continue
            for k in range(count):
                rows = [*range(k * n, k * n + n), *(range(count * n, len(linear.jacobian)) if k == 0 else ())]
                values = []
                for p in pair:
                    mixed = linear.jacobian.copy()
                    mixed[rows] = p.jacobian[rows]
                    values.append(added.at(mixed))
                slope[k * n + j] = (values[0] - values[1]) / (2 * size)
        return slope


@dataclass(frozen=True)
class Added:
    """The added equation near one point, as a function of the orbits' Jacobian.

    Attributes
    ----------
    kind : str
    shape : (int, int)
        Segments and states.
    scale, weights : array
        Sizes of the unknowns and of the equations.
    left, right : array
        Singular vectors of the smallest singular value; null vectors where the event is.
    product : float
        Logarithm of the product of the pair of multipliers, of a Neimark-Sacker point.
    value : float
        What must vanish.
    """

    kind: Kind
    shape: tuple[int, int]
    scale: Array
    weights: Array
    left: Array
    right: Array
    product: float = 0.0
    value: float = 0.0

    @classmethod
    def of(cls, kind: Kind, point: Unknowns, linear: Linear) -> "Added":
        """Set up the equation at a point."""
        square = len(linear.weights)
        made = cls(kind, point.x.shape, linear.sizes[:square], linear.weights, np.zeros(0), np.zeros(0))
        if kind == "neimark-sacker":
            products = np.log(pairs(made.multipliers(linear.jacobian))[0])
            value = float(products[np.abs(products).argmin()])
            return replace(made, product=value, value=value)
        left, values, right = np.linalg.svd(made.matrix(linear.jacobian))
        return replace(made, left=left[:, -1], right=right[-1], value=-float(values[-1]))

    def matrix(self, jacobian: Array) -> Array:
        """What becomes singular, in sizes of unknowns and equations; for doublings the segments close with a plus."""
        count, n = self.shape
        if self.kind == "period-doubling":
            states = count * n
            out = jacobian[:states, :states].copy()
            out[states - n :, :n] += 2 * np.eye(n)
            return np.asarray(out * self.scale[:states] / self.weights[:states, None])
        return np.asarray(jacobian[:, : self.weights.size] * self.scale / self.weights[:, None])

    def multipliers(self, jacobian: Array) -> NDArray[np.complex128]:
        """Multipliers of the orbit from its Jacobian."""
        count, n = self.shape
        product = np.eye(n)
        for k in range(count):
            here = slice(k * n, k * n + n)
            block = jacobian[here, here] + (np.eye(n) if count == 1 else 0.0)
            product = block * self.weights[:n] / self.weights[:n, None] @ product
        return np.linalg.eigvals(product).astype(complex)

    def at(self, jacobian: Array) -> float:
        """The added equation at another Jacobian."""
        if self.kind == "neimark-sacker":
            products = np.log(pairs(self.multipliers(jacobian))[0])
            return float(products[np.abs(products - self.product).argmin()])
        size = self.right.size
        bordered = np.zeros((size + 1, size + 1))
        bordered[:size, :size], bordered[:size, size], bordered[size, :size] = self.matrix(jacobian), self.left, self.right
        last = np.zeros(size + 1)
        last[size] = 1.0
        return float(np.linalg.solve(bordered, last)[size])


def pairs(multipliers: NDArray[np.complex128]) -> tuple[Array, Array]:
    """Products, and half the sums, of all pairs of multipliers that are conjugate, or real and of one sign."""
    products, halves = [], []
    for i, one in enumerate(multipliers):
        for other in multipliers[:i]:
            if one == other.conjugate() or (one.imag == other.imag == 0 and one.real * other.real > 0):
                products.append((one * other).real)
                halves.append((one + other).real / 2)
    return np.array(products or [np.nan]), np.array(halves or [np.nan])
