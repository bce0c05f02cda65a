"""What every part answers, in three passes: unknowns; coupled variables, which are forces; rates.

A part is plain data with these methods, and inherits nothing. The passes are those of PyBaMM: all unknowns are known before
the first force is written, and all forces before the first rate.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Protocol

from sympy import Expr, Integer

from whirlmap.equations.parts import Film, Journal, Output, Stop, Switching
from whirlmap.equations.pieces import Table
from whirlmap.equations.quantities import Parameter, State
from whirlmap.machines.scale import Scale

Vector = tuple[Expr, Expr]
ZERO: Vector = (Integer(0), Integer(0))


class Motion(Protocol):
    """Motion of a shaft at its stations, over c_0 and, of rates, per radian of the clock."""

    def displacement(self, station: int) -> Vector:
        """Displacement of the shaft's modes across its axis."""
        ...

    def velocity(self, station: int) -> Vector:
        """Its rate."""
        ...

    def arc(self, station: int) -> tuple[Expr, Expr]:
        """Arc of the reference base circle from uniform rotation, along the rotation, and its rate; zero without torsion."""
        ...


@dataclass
class Coupled:
    """Variables that parts share while a model is assembled.

    Attributes
    ----------
    motions : mapping of str to Motion
        By the shaft.
    positions : mapping of str to (Expr, Expr)
        Centre of each support, by its name; ground is "".
    velocities : mapping of str to (Expr, Expr)
        Their rates.
    journals : mapping of str to (Expr, Expr)
        Position of each journal in space.
    forces : mapping of str to list of (station, (Expr, Expr))
        On each shaft, over K_0 c_0.
    accelerated : mapping of str to list of (station, (Expr, Expr))
        Forces on each shaft that an angular acceleration adds, over its relative rate (see `Model.angular_acceleration`).
    moments : mapping of str to list of (station, Expr)
        On the rotation of each shaft, over K_0 c_0 and its base radius, along the rotation.
    loads : mapping of str to (Expr, Expr)
        Force of the shaft on each bearing, or on one of two that are alike, over K_0 c_0.
    """

    motions: dict[str, Motion] = field(default_factory=dict)
    positions: dict[str, Vector] = field(default_factory=lambda: {"": ZERO})
    velocities: dict[str, Vector] = field(default_factory=lambda: {"": ZERO})
    journals: dict[str, Vector] = field(default_factory=dict)
    forces: dict[str, list[tuple[int, Vector]]] = field(default_factory=dict)
    accelerated: dict[str, list[tuple[int, Vector]]] = field(default_factory=dict)
    moments: dict[str, list[tuple[int, Expr]]] = field(default_factory=dict)
    loads: dict[str, Vector] = field(default_factory=dict)


@dataclass
class Declared:
    """What a part adds to the declaration of the model beside its equations: see `Model`."""

    harmonics: list[Expr] = field(default_factory=list)
    defaults: dict[Parameter, Expr | int] = field(default_factory=dict)
    outputs: dict[str, Output] = field(default_factory=dict)
    stops: dict[str, Stop] = field(default_factory=dict)
    switchings: dict[str, Switching] = field(default_factory=dict)
    films: dict[str, Film] = field(default_factory=dict)
    journals: dict[str, Journal] = field(default_factory=dict)
    bodies: dict[str, tuple[State, ...]] = field(default_factory=dict)
    stations: dict[str, tuple[str, str]] = field(default_factory=dict)
    unbalances: dict[str, Parameter] = field(default_factory=dict)
    clocks: dict[str, Expr] = field(default_factory=dict)
    swing: list[State] = field(default_factory=list)
    teeth: list[Expr] = field(default_factory=list)
    tables: list[Table] = field(default_factory=list)
    checks: list[Callable[[Mapping[str, float]], str]] = field(default_factory=list)
    start_where_none: dict[State, float] = field(default_factory=dict)
    sources: list[str] = field(default_factory=list)


class Part(Protocol):
    """The three passes, and what they read."""

    def groups(self, scale: Scale) -> dict[Parameter, Expr]:
        """Parameters of the part, each as an expression of inputs."""
        ...

    def unknowns(self) -> tuple[State, ...]:
        """States of the part."""
        ...

    def couple(self, coupled: Coupled) -> None:
        """Add its motion, and its forces on shafts and supports, to what is shared."""
        ...

    def rates(self, coupled: Coupled) -> dict[State, Expr]:
        """Rate of each of its unknowns."""
        ...

    def declare(self, coupled: Coupled) -> Declared:
        """What else it adds to the model."""
        ...
