"""What a model declares beside its states and parameters: outputs, ends of a run, surfaces, films, a section."""

from dataclasses import dataclass, field
from typing import Literal, get_args

from sympy import Expr, sympify

from whirlmap.equations.quantities import State, refuse_measure

#: What an output of a model is of its bearing, and what a dimensional result of a case is of the machine: see `Output`.
OfBearing = Literal["eccentricity", "load"]
OfMachine = Literal["unit_speed", "shaft_speed", "natural_frequency", "ring"]
OF_BEARING: tuple[str, ...] = get_args(OfBearing)


@dataclass(frozen=True)
class Section:
    """Where an unforced model is cut: the surface ``surface = 0``, crossed in one direction, once per turn."""

    surface: Expr
    direction: Literal["rising", "falling"]


@dataclass(frozen=True)
class Output:
    """A quantity computed from states and parameters, with unit, meaning and measure (see `Quantity`).

    ``role`` says what it is of the ``bearing`` that it names: the ``eccentricity`` of its journal, in clearances, or the
    ``load``, the force of its film. A dimensional result of `Groups` may be the ``unit_speed`` (of the clock, where the
    speed parameter is 1), the ``shaft_speed`` (of the first shaft), a ``natural_frequency`` (with the films left out) or
    the ``ring`` (pi H/L) of a porous bearing.
    """

    expression: Expr
    unit: str
    meaning: str
    measure: str = ""
    role: OfBearing | OfMachine | Literal[""] = ""
    bearing: str = ""

    def __post_init__(self) -> None:
        """Refuse a measure that there is not."""
        refuse_measure(self.meaning, self.measure)


@dataclass(frozen=True)
class Stop:
    """An end of the run: the first time at which ``gap`` has fallen to zero.

    ``reachable`` is false where physics forbids the event for these parameters (a plain film at its wall): a step that
    gets there anyway was too long, and is redone with shorter ones.
    """

    gap: Expr
    meaning: str
    reachable: Expr = field(default_factory=lambda: sympify(1))


@dataclass(frozen=True)
class Switching:
    """A surface at which the equations change their form: a tooth leaves its flank, a journal meets the wall.

    ``surface`` (of states, parameters and time) is positive on one side. It is declared so that its crossings can be listed
    and counted by name (`whirlmap.surface_crossings`); ``jumps`` tells the reader that the rates jump there and do not only
    have a kink. Steps find every such surface in the equations themselves, declared or not.
    """

    surface: Expr
    meaning: str
    jumps: bool = False


@dataclass(frozen=True)
class Journal:
    """A journal in its bearing: ``u``, its centre relative to the bearing, in the model's length, and its ``spin``.

    ``spin`` is the journal's speed over the clock's, positive from x to y; 0 for a damper. ``clearance`` is that of the
    bearing in the model's length.
    """

    u: tuple[State, State]
    spin: Expr | int
    clearance: Expr | int = 1


@dataclass(frozen=True)
class Film:
    """A fluid film of the short-bearing law between a journal that spins and its bearing, for its linear coefficients.

    ``u`` is the journal relative to the bearing in the model's length, ``psi`` the permeability, ``spin`` the journal's
    speed over the clock's, positive from x to y, ``strength`` is A times the clock's speed, over the model's unit of
    force, and ``clearance`` that of the bearing in the model's length.
    """

    u: tuple[State, State]
    psi: Expr | int
    spin: Expr | int
    strength: Expr
    clearance: Expr | int = 1
