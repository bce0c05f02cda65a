"""The points of a sweep: a grid over varied parameters, over random draws, or over both; and its chunks."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from hashlib import sha256
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from whirlmap.analysis.motion.ensembles import parameter_values
from whirlmap.equations.model import Model
from whirlmap.equations.pieces import tabulated
from whirlmap.errors import RangeError
from whirlmap.integrate.system import System
from whirlmap.integrate.varied_inputs import VariedInputs
from whirlmap.results.memory import refuse_points
from whirlmap.results.schema import variable
from whirlmap.sweep.parameters.axis import is_input, read_axis
from whirlmap.sweep.parameters.random_draws import Tolerance, draws

Array = NDArray[np.float64]
Cell = tuple[int, ...]

#: Name of the dimension over random draws.
DRAW = "draw"


@dataclass(frozen=True)
class Space:
    """Axes of a sweep, in the order of its dimensions.

    Attributes
    ----------
    axes : mapping of str to array
        Values of each varied parameter, ascending.
    tolerances : mapping of str to Tolerance
        Parameters drawn at random; they share the last dimension, ``draw``.
    count, seed : int
        Number of draws, and the master seed.
    inputs : VariedInputs, optional
        Those of the axes that are dimensional inputs, in their units.
    """

    axes: Mapping[str, Array]
    tolerances: Mapping[str, Tolerance] = field(default_factory=dict)
    count: int = 0
    seed: int = 0
    inputs: VariedInputs | None = None

    def __post_init__(self) -> None:
        """Refuse axes that cannot be walked."""
        if not self.axes and not self.tolerances:
            raise RangeError("found no varied parameter, expected one or more")
        for name, values in self.axes.items():
            if values.ndim != 1 or values.size < 1 or not np.isfinite(values).all() or np.any(np.diff(values) <= 0):
                raise RangeError(f"values of {name!r} must be finite and ascend")
            if name in self.tolerances:
                raise RangeError(f"{name!r} is both varied and drawn: expected one of them")
        if self.tolerances and not 1 <= self.count <= 1_000_000_000:
            raise RangeError(f"draws must lie between 1 and 1000000000, not {self.count}")
        refuse_points(self.shape)
        if not 0 <= self.seed < 2**63:
            raise RangeError(f"seed must lie between 0 and 2^63, not {self.seed}")

    @property
    def dims(self) -> tuple[str, ...]:
        """Names of the dimensions."""
        return (*self.axes, DRAW) if self.tolerances else tuple(self.axes)

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of points along each."""
        sizes = tuple(values.size for values in self.axes.values())
        return (*sizes, self.count) if self.tolerances else sizes

    @property
    def points(self) -> int:
        """Number of points."""
        return prod(self.shape)

    @property
    def varied(self) -> tuple[str, ...]:
        """What is varied or drawn."""
        return (*self.axes, *self.tolerances)

    @cached_property
    def units(self) -> Mapping[str, str]:
        """Units of the dimensional inputs among the axes."""
        return self.inputs.units if self.inputs else {}

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Every parameter that differs between points."""
        own = [name for name in self.varied if name not in self.units]
        return (*own, *(self.inputs.followers if self.inputs else ()))

    @cached_property
    def drawn(self) -> dict[str, Array]:
        """Values of all draws."""
        return draws(self.tolerances, self.seed, 0, self.count) if self.tolerances else {}

    def columns(self, index: tuple[NDArray[np.intp], ...]) -> dict[str, Array]:
        """Parameters of some points, given their index along each dimension."""
        out = {name: values[i] for (name, values), i in zip(self.axes.items(), index, strict=False)}
        if self.inputs:
            given = {name: out.pop(name) for name in self.units}
            out |= self.inputs(given)
        if self.tolerances:
            first, last = int(index[-1].min()), int(index[-1].max())
            part = draws(self.tolerances, self.seed, first, last - first + 1)
            out |= {name: values[index[-1] - first] for name, values in part.items()}
        return out

    def check(self, system: System) -> None:
        """Refuse now what some chunk would meet later: unknown names, and values beyond a parameter's limits."""
        for name, values in {**self.axes, **self.drawn}.items():
            if name not in self.units:
                parameter_values(system, {name: np.array([values.min(), values.max()])})

    def coordinates(self, system: System) -> dict[str, Any]:
        """Coordinates of a Dataset over the whole space."""
        declared = system.model.parameter
        out: dict[str, Any] = {
            name: variable(name, values, declared(name).unit, declared(name).meaning)
            for name, values in self.axes.items() if name not in self.units
        }  # fmt: skip
        if self.inputs:
            for name, unit in self.units.items():
                out[name] = variable(name, self.axes[name], unit or "1", self.inputs.meaning(name))
            over = tuple(name for name in self.axes if name in self.units)
            grid = np.meshgrid(*(self.axes[name] for name in over), indexing="ij")
            found = self.inputs(dict(zip(over, (axis.ravel() for axis in grid), strict=True)), self.inputs.sizes)
            for name, values in found.items():  # what the units of the others follow from
                out[name] = variable(over, values.reshape(grid[0].shape), declared(name).unit, declared(name).meaning)
        if self.tolerances:
            out[DRAW] = variable(DRAW, np.arange(self.count), "1", "number of the draw")
            for name, values in self.drawn.items():
                unit, meaning = declared(name).unit, declared(name).meaning
                out[name] = variable(DRAW, values, unit, meaning, tolerance=str(self.tolerances[name]))
        return out

    def described(self) -> dict[str, str]:
        """What the space is, in words that can be compared and read."""
        out = {
            f"values of {name}": f"{v[0]:.10g} to {v[-1]:.10g} in {v.size} points, {sha256(v.tobytes()).hexdigest()[:12]}"
            + (f" [{self.units[name]}]" if name in self.units else "")
            for name, v in self.axes.items()
        }
        if self.tolerances:
            out["draws"] = f"{self.count} with seed {self.seed}"
            out |= {f"tolerance of {name}": str(t) for name, t in self.tolerances.items()}
        return out


def space_of(
    system: System, vary: Mapping[str, Any], tolerances: Mapping[str, Tolerance] | None = None, count: int = 0,
    seed: int = 0, option: str = "vary",
) -> Space:  # fmt: skip
    """Read the axes of a sweep: parameters or dimensional inputs, with values as of `read_axis`.

    Raises
    ------
    InputError, RangeError
        As `read_axis` and `VariedInputs.check`; a quantity that is given twice.
    """
    axes: dict[str, Array] = {}
    units: dict[str, str] = {}
    beside = any(is_input(system, name) for name in vary)
    for written, values in vary.items():
        name, numbers, unit = read_axis(system, written, values, option, beside=beside)
        if name in axes:
            raise RangeError(f"{option}: {name} is given twice: expected each parameter once")
        axes[name] = numbers
        if is_input(system, written, beside=beside):
            units[name] = unit
    inputs = None
    if units:
        fixed = [*(name for name in axes if name not in units), *(tolerances or {})]
        inputs = VariedInputs(system, units, {name: (float(axes[name][0]), float(axes[name][-1])) for name in units}, fixed)
        inputs.check()
    return Space(axes, tolerances or {}, count, seed, inputs)


@dataclass(frozen=True)
class Chunks:
    """Division of a grid into boxes; each box is one task, and one chunk of every array in the store."""

    shape: tuple[int, ...]
    size: tuple[int, ...]

    @property
    def grid(self) -> tuple[int, ...]:
        """Number of chunks along each dimension."""
        return tuple(-(-n // c) for n, c in zip(self.shape, self.size, strict=True))

    @property
    def count(self) -> int:
        """Number of chunks."""
        return prod(self.grid)

    def cell(self, number: int) -> Cell:
        """Place of a chunk in the grid of chunks."""
        return tuple(int(i) for i in np.unravel_index(number, self.grid))

    def box(self, number: int) -> tuple[slice, ...]:
        """Points of a chunk, as slices."""
        return tuple(
            slice(i * c, min((i + 1) * c, n)) for i, c, n in zip(self.cell(number), self.size, self.shape, strict=True)
        )

    def index(self, number: int) -> tuple[NDArray[np.intp], ...]:
        """Points of a chunk, as their index along each dimension, the last dimension first to change."""
        ranges = [np.arange(s.start, s.stop) for s in self.box(number)]
        return tuple(i.ravel() for i in np.meshgrid(*ranges, indexing="ij"))

    def points(self, number: int) -> int:
        """Number of points of a chunk."""
        return prod(s.stop - s.start for s in self.box(number))

    def share(self, part: int, parts: int) -> Iterator[int]:
        """Chunks of share ``part`` of ``parts``, counted from one: every so many-th, so that slow regions are shared."""
        return iter(range(part - 1, self.count, parts))


def chunk_size(space: Space, model: Model, points: int) -> tuple[int, ...]:
    """Shape of chunks of about so many points.

    A chunk is long in a dimension that shares tables: each value of a parameter with tables costs their making.
    """
    dims, shape, costly = space.dims, space.shape, costly_dimensions(space, model)
    size, left = [1] * len(dims), max(points, 1)
    for k in sorted(range(len(dims)), key=lambda k: costly[k]):
        pieces = -(-shape[k] // min(shape[k], left))
        size[k] = -(-shape[k] // pieces)
        left = max(left // size[k], 1)
    return tuple(size)


def costly_dimensions(space: Space, model: Model) -> list[bool]:
    """Which dimensions have a table to be made for every value."""
    tabled = table_parameters(model)
    followed = bool(space.inputs) and bool(tabled & set(space.names))
    return [
        d in tabled or (d == DRAW and bool(tabled & set(space.tolerances))) or (d in space.units and followed)
        for d in space.dims
    ]


def pilot_points(space: Space, model: Model, count: int, tables: int = 4) -> tuple[NDArray[np.intp], ...]:
    """About so many points spread over a space, as their index along each dimension, with few tables among them.

    Chunks hold few tables too: points that had one each would say that all are slow.
    """
    costly = costly_dimensions(space, model)
    shapes = [tuple(n for n, c in zip(space.shape, costly, strict=True) if c == kind) for kind in (True, False)]
    most = (tables, -(-count // tables)) if shapes[0] else (1, count)
    at = [
        np.unique(np.linspace(0, prod(s) - 1, min(n, prod(s))).astype(np.int64)) for s, n in zip(shapes, most, strict=True)
    ]
    outer, inner = (iter(np.unravel_index(flat, s) if s else ()) for flat, s in zip(at, shapes, strict=True))
    return tuple(np.repeat(next(outer), at[1].size) if c else np.tile(next(inner), at[0].size) for c in costly)


def table_parameters(model: Model) -> set[str]:
    """Parameters for whose every value a model's tables are made anew."""
    found = set()
    for rate in model.equations.values():
        for call in getattr(rate, "atoms", lambda _: ())(tabulated):
            coordinates = (len(call.args) - 3) // 2
            found |= {s.name for s in call.args[2 + coordinates].free_symbols}
    return found
