"""Rates and Jacobians of many operating points at given states, from the compiled kernel."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from whirlmap.equations.model import Model
from whirlmap.kernels.methods import RK4
from whirlmap.kernels.running.lanes import Inputs, LaneKernel, blocked, lane_kernel, unblocked

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Evaluator:
    """A model at many operating points, ready to be evaluated at any states of any of them.

    Attributes
    ----------
    kernel : LaneKernel
    inputs : Inputs
        Of all points.
    """

    kernel: LaneKernel
    inputs: Inputs

    @classmethod
    def of(cls, model: Model, values: Array, *, jacobian: bool) -> "Evaluator":
        """Prepare points; values of shape (parameter, point)."""
        kernel = lane_kernel(model, RK4, slopes="jacobian" if jacobian else "none", kind="free")
        return cls(kernel, kernel.inputs(values))

    def __call__(
        self, time: ArrayLike, x: Array, points: NDArray[np.intp], *, forced: bool = True
    ) -> tuple[Array, Array]:
        """Evaluate.

        Parameters
        ----------
        time : float, or array of shape (column,)
        x : array, shape (state, column)
        points : array of int, shape (column,)
            Operating point of each column.
        forced : bool
            Whether time acts; where not, every harmonic is zero.

        Returns
        -------
        rates : array, shape (state, column)
        jacobian : array, shape (state, state, column)
            Zero where it was not asked for.
        """
        rates, moving, p = self._evaluate(time, x, points, forced=forced)
        n, columns = x.shape
        dense = np.zeros((n * n, columns))
        place, terms = self._values(p, moving, columns, slice(None))
        np.add.at(dense, place, terms)
        return rates, dense.reshape(n, n, columns)

    def trace(self, time: ArrayLike, x: Array, points: NDArray[np.intp]) -> Array:
        """Trace of the Jacobian, shape (column,), without its other entries."""
        _, moving, p = self._evaluate(time, x, points, forced=True)
        n = x.shape[0]
        on_diagonal = np.flatnonzero(self._terms[0] % (n + 1) == 0)
        return np.asarray(self._values(p, moving, x.shape[1], on_diagonal)[1].sum(axis=0))

    def _values(
        self, p: Array, moving: Array, columns: int, which: slice | NDArray[np.intp]
    ) -> tuple[NDArray[np.intp], Array]:
        """Places of some terms of the Jacobian, and their values, shape (term, column)."""
        place, weight, by, factor = self._terms
        rows = np.concatenate([unblocked(p, columns), unblocked(moving, columns), np.ones((1, columns))])
        return place[which], weight[which][:, None] * rows[by[which]] * rows[factor[which]]

    @cached_property
    def _terms(self) -> tuple[NDArray[np.intp], Array, NDArray[np.intp], NDArray[np.intp]]:
        """Of each term of the Jacobian its place, its number, and two rows of inputs, slots and a last one of ones."""
        source, n = self.kernel.source, self.kernel.source.sizes.states
        slots, ones = source.sizes.inputs, source.sizes.inputs + source.sizes.slots
        place, weight, by, factor = [], [], [], []
        for term in source.entries:
            place.append(term.row * n + term.column)
            weight.append(term.weight * (term.value if term.kind == "constant" else 1.0))
            by.append(ones if term.by < 0 else term.by)
            factor.append(ones if term.kind == "constant" else int(term.value) + (slots if term.kind == "slot" else 0))
        return np.array(place, dtype=np.intp), np.array(weight), np.array(by, np.intp), np.array(factor, np.intp)

    def rates(self, time: ArrayLike, x: Array, points: NDArray[np.intp], *, forced: bool = True) -> Array:
        """Rates alone, bit by bit those of a call."""
        return self._evaluate(time, x, points, forced=forced)[0]

    def _evaluate(
        self, time: ArrayLike, x: Array, points: NDArray[np.intp], *, forced: bool
    ) -> tuple[Array, Array, Array]:
        """Rates; and what the Jacobian is made of: the slots that the kernel fills, and its inputs, in blocks."""
        n, columns = x.shape
        sizes, blocks = self.kernel.source.sizes, self.inputs.blocks(points)
        y = blocked(np.asarray(x, dtype=float))
        dy, moving, o = (np.empty((y.shape[0], rows, y.shape[2])) for rows in (n, sizes.slots, sizes.outputs))
        times = np.broadcast_to(np.asarray(time, dtype=float), (1, columns))
        self.kernel.evaluate(
            blocks=y.shape[0], forced=int(forced), y=y, time=blocked(times), **blocks, dy=dy, jac=moving, o=o,
            work=self.kernel.work(),
        )  # fmt: skip
        return unblocked(dy, columns), moving, blocks["p"]
