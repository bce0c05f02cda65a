"""Equilibria of unforced systems: rates, Jacobians and their eigenvalues, for many points in one call."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.branches.unknowns import Linear, Unknowns
from whirlmap.integrate.division import variants
from whirlmap.integrate.evaluation import Evaluator
from whirlmap.integrate.harmonics import periods
from whirlmap.integrate.scales import FLOOR, largest_of, likeness
from whirlmap.integrate.system import System
from whirlmap.results.status import Status

Array = NDArray[np.float64]

#: Difference of a free parameter on either side, over its size, by which the derivative is taken.
DIFFERENCE = 1e-6


@dataclass(frozen=True)
class Equilibria:
    """Equilibria of a system with free parameters; attributes as those of `PeriodicOrbits`.

    Attributes
    ----------
    system : System
    columns, allowed : callable
    widths : array, shape (free,)
    sizes : array, shape (state,)
        Sizes of the states along the branch, for one that passes through zero.
    """

    system: System
    columns: Callable[[Array], Array]
    allowed: Callable[[Array], NDArray[np.bool_]]
    widths: Array
    sizes: Array

    @property
    def key(self) -> tuple[Any, ...]:
        """What tells equations whose points may be computed together from others."""
        return self.columns, self.sizes.tobytes()

    def linear(self, points: Sequence[Unknowns], before: Sequence[Linear | None] = ()) -> list[Linear]:
        """Rates and their derivatives; see `Equations`, but ``before`` is not used: they cost little."""
        del before
        x = np.concatenate([p.x for p in points]).T
        free = np.stack([p.free for p in points], axis=1)
        rates, jacobians = self._evaluate(x, free)
        by_free = []
        for k, size in enumerate(np.maximum(np.abs(free), self.widths[:, None]) * DIFFERENCE):
            ends = []
            for sign in (1, -1):
                moved = free.copy()
                moved[k] += sign * size
                moved[k] = np.where(self.allowed(moved), moved[k], free[k])
                ends.append((self._evaluate(x, moved)[0], moved[k]))
            by_free.append((ends[0][0] - ends[1][0]) / (ends[0][1] - ends[1][1]))
        period = periods(self.system.model, self.columns(free))
        like = likeness(self.system.model)
        out = []
        for k in range(len(points)):
            weight = like.weights(period[k : k + 1])
            own = np.maximum(np.abs(x[:, k]), self.sizes)[:, None]
            sizes = (largest_of(like.group, own * weight) / weight)[:, 0]
            sizes = np.where(sizes > 0, sizes, FLOOR)
            jacobian = np.concatenate([jacobians[k], np.stack([d[:, k] for d in by_free], axis=1)], axis=1)
            matrix = jacobians[k] * period[k] * (sizes / sizes[:, None])
            good = np.isfinite(rates[:, k]).all() and np.isfinite(jacobian).all()
            status = Status.ok if good else Status.failed
            every = np.concatenate([sizes * sqrt(sizes.size), self.widths])
            out.append(Linear(rates[:, k], jacobian, every, sizes / period[k], matrix[None], status))
        return out

    def _evaluate(self, x: Array, free: Array) -> tuple[Array, Array]:
        """Rates (state, point) and Jacobians (point, state, state)."""
        values = self.columns(free)
        rates, jacobians = np.empty_like(x), np.empty((x.shape[1], x.shape[0], x.shape[0]))
        for form, at in variants(self.system.model, values):
            evaluate = Evaluator.of(form, values[:, at], jacobian=True)
            rates[:, at], dense = evaluate(0.0, x[:, at], np.arange(at.size))
            jacobians[at] = dense.transpose(2, 0, 1)
        return rates, jacobians

    def exponents(self, linear: Linear) -> tuple[Array, Array]:
        """Real and imaginary parts of the eigenvalues times the typical time, largest real part first."""
        if not np.isfinite(linear.matrices).all():
            return np.full(len(linear.sizes), np.nan), np.full(len(linear.sizes), np.nan)
        values = np.linalg.eigvals(linear.matrices[0])
        order = np.lexsort((-values.imag, -values.real))
        return values.real[order], values.imag[order]
