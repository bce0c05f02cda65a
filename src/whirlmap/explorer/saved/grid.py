"""The points of a map, a diagram or a case for which a page holds what their motions need."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.motion.ensembles import parameter_values
from whirlmap.integrate.equilibrium import start_states
from whirlmap.integrate.system import System
from whirlmap.sweep.parameters.space import Space

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Grid:
    """Every so many of the points of a space, or the one point of a system where nothing varies.

    Attributes
    ----------
    system : System
    space : Space, optional
        All points; absent where nothing varies.
    thinning : tuple of int
        How far each axis is thinned out: 1 keeps all of its values.
    """

    system: System
    space: Space | None
    thinning: tuple[int, ...]

    @cached_property
    def axes(self) -> dict[str, Array]:
        """Values that are kept, by the name of what varies."""
        if self.space is None:
            return {}
        return {name: axis[::t] for (name, axis), t in zip(self.space.axes.items(), self.thinning, strict=True)}

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values along each axis."""
        return tuple(axis.size for axis in self.axes.values())

    @cached_property
    def kept(self) -> Space | None:
        """The points that are kept."""
        return None if self.space is None else Space(self.axes, inputs=self.space.inputs)

    @cached_property
    def values(self) -> Array:
        """Parameters, shape (parameter, point); the last axis fastest."""
        if self.kept is None:
            return self.system.vector[:, None]
        return parameter_values(self.system, self.kept.columns(tuple(i.ravel() for i in np.indices(self.shape))))

    @cached_property
    def starts(self) -> Array:
        """Start states, shape (state, point)."""
        x, _ = start_states(self.system.model, self.values)
        for name, value in self.system.start.items():
            x[self.system.states.index(name)] = value
        return x

    @property
    def varied(self) -> tuple[str, ...]:
        """Parameters that differ between points."""
        return () if self.space is None else tuple(self.space.names)

    def over(self, rows: Array) -> Array:
        """Rows over points, shape (row, point), over the grid: (row, axis...)."""
        return rows.reshape(-1, *self.shape)

    def thinned(self, full: NDArray[Any]) -> NDArray[Any]:
        """What is kept of an array whose last dimensions are all points of the space."""
        every: Any = (..., *(slice(None, None, t) for t in self.thinning))
        return np.asarray(full[every])
