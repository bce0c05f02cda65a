"""A resolved case: a model with a value for each parameter, its dimensional inputs, and where each number comes from."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from whirlmap.cases.alternatives import Followed
from whirlmap.cases.case import Case
from whirlmap.cases.reasons import Mark
from whirlmap.equations.groups import Bearing, Groups
from whirlmap.equations.model import Model
from whirlmap.equations.parts import OfMachine, Output
from whirlmap.equations.quantities import Parameter
from whirlmap.results.listing import Listed, Listing, Rows


@dataclass(frozen=True)
class Input:
    """A dimensional input: its value in the declared unit, what was written, and where it comes from."""

    parameter: Parameter
    value: float
    written: str
    note: str


@dataclass(frozen=True, repr=False)
class Resolved(Listed):
    """A model with a value for each of its parameters, and where each value comes from.

    Attributes
    ----------
    case : Case
    model : Model
    switches : mapping of str to str
        Every switch of the model, also those that kept their default.
    values : mapping of str to float or Fraction
        In declared order. Fractions for orders of harmonics that are exact.
    notes : mapping of str to str
        Where each value comes from.
    inputs : mapping of str to Input
        Dimensional inputs, where the case has them.
    given : mapping of str to float
        Every input in its declared unit, also those that change no parameter because the symbols that they feed are given.
    exact : mapping of str to Fraction
        The same, as written.
    quantities : mapping of str to (float, Output)
        Dimensional results worth showing; those whose inputs are not all known are left out.
    marks : mapping of str to Mark
        Numbers that have been changed by hand, and reasons that name a number which is another now.
    changes : mapping of str to value
        What was changed of the case, as it was given.
    followed : mapping of str to Followed
        Inputs that follow from others, as a viscosity from its grade.
    """

    case: Case
    model: Model
    switches: Mapping[str, str]
    values: Mapping[str, float | Fraction]
    notes: Mapping[str, str]
    inputs: Mapping[str, Input]
    given: Mapping[str, float]
    exact: Mapping[str, Fraction]
    quantities: Mapping[str, tuple[float, Output]]
    marks: Mapping[str, Mark] = field(default_factory=dict)
    changes: Mapping[str, Any] = field(default_factory=dict)
    followed: Mapping[str, Followed] = field(default_factory=dict)

    @property
    def groups(self) -> Groups | None:
        """How the model's parameters follow from inputs, where its family says so."""
        return self.case.family.groups

    @property
    def bearings(self) -> Mapping[str, Bearing]:
        """Bearings as the family declares them, by name."""
        return self.groups.bearings(self.switches) if self.groups else {}

    @property
    def speed_input(self) -> str:
        """Name of the input that is the speed in other words; empty where there is none."""
        return self.groups.speed.name if self.groups and self.groups.speed else ""

    def results(self, role: OfMachine) -> dict[str, float]:
        """Dimensional results that have a role, by the bearing of each."""
        return {output.bearing: value for value, output in self.quantities.values() if output.role == role}

    def listing(self) -> Listing:
        """Its dimensional inputs, for a terminal and a notebook."""
        rows = [(name, one.written, one.parameter.meaning, one.note) for name, one in self.inputs.items()]
        return Listing(
            f"Resolved case {self.case.name}: model {self.model.name}",
            [f"values: {', '.join(f'{name} = {float(value):.6g}' for name, value in self.values.items())}"],
            [Rows("Inputs", ("name", "as given", "meaning", "where it comes from"), rows)],
        )
