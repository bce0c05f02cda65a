"""What may stand in a table of a part: numbers with a unit, choices, names of other parts, stations."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from whirlmap.equations.quantities import Parameter


@dataclass(frozen=True)
class Number:
    """A number with a unit.

    Attributes
    ----------
    key, unit, meaning : str
    required : bool
    fixed : bool
        Whether it is part of the shape of the machine, from which the numbers of the equations are computed; others are
        inputs of the kernel, which can be varied.
    zero : bool
        Whether every part of its kind has it in truth: one that a file leaves out counts as zero, and `show` says so.
    limits : mapping
        ``above``, ``at_least``, ``below``, ``order``, as of `Parameter`.
    twice : tuple of str
        What people write for twice this number: ``D`` for a radius ``R``.
    """

    key: str
    unit: str
    meaning: str
    required: bool = False
    fixed: bool = False
    zero: bool = False
    limits: Mapping[str, Any] = field(default_factory=dict)
    twice: tuple[str, ...] = ()

    def parameter(self, part: str) -> Parameter:
        """The input of a part, by its dotted name: ``bearing.drive_end.c``."""
        kind, _, name = part.partition(".")
        whose = f" of {kind} {name}" if name else ""
        return Parameter(f"{part}.{self.key}", self.unit, f"{self.meaning}{whose}", **self.limits)


@dataclass(frozen=True)
class Choice:
    """One of some words, the default first."""

    key: str
    choices: tuple[str, ...]
    meaning: str


@dataclass(frozen=True)
class Text:
    """A name: of the part itself, or of another one."""

    key: str
    meaning: str
    required: bool = False


@dataclass(frozen=True)
class Station:
    """A place on a shaft: number of a station, or a distance from its first end."""

    key: str
    meaning: str
    required: bool = True


@dataclass(frozen=True)
class Other:
    """What is read by a rule of its own: a list of elements, two numbers of teeth, a count."""

    key: str
    meaning: str
    required: bool = False


Field = Number | Choice | Text | Station | Other
ABOVE, AT_LEAST = {"above": 0}, {"at_least": 0}
