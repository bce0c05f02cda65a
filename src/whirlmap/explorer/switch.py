"""Switches of a case, which choose terms of its model by a word: each is a list in the page."""

from collections.abc import Sequence
from dataclasses import dataclass

from whirlmap.integrate.system import System


@dataclass(frozen=True)
class Switch:
    """One switch.

    Attributes
    ----------
    name, meaning : str
    value : str
        Of the case.
    choices : sequence of str
    """

    name: str
    meaning: str
    value: str
    choices: Sequence[str]


def switches_of(system: System) -> dict[str, Switch]:
    """Switches of a system's case; none of a model that has no case."""
    if system.machine is None:
        return {}
    family, values = system.machine.case.family, system.machine.switches
    return {
        name: Switch(name, family.meanings.get(name, ""), values[name], choices)
        for name, choices in family.switches.items()
        if name in values and len(choices) > 1
    }
