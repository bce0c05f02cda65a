"""A system as the command line asks for it."""

from collections.abc import Sequence
from typing import Any

from whirlmap.cli.common.assignments import assignments
from whirlmap.errors import CaseError, InputError
from whirlmap.integrate.loading import load
from whirlmap.integrate.own_units import in_state
from whirlmap.integrate.system import System
from whirlmap.units import split


def _in_states(system: System, begin: dict[str, str]) -> dict[str, float | str]:
    """Start values in the model's own numbers; what is no number with a unit stays text, for who says what is wrong."""
    made: dict[str, float | str] = dict(begin)
    for name, text in begin.items():
        try:
            number, unit = split(text)
        except CaseError:
            continue
        value = in_state(system, name, float(number), unit, "--start")
        made[name] = value if unit else text
    return made


def open_system(case: str, changes: Sequence[str] | None, start: Sequence[str] | None) -> System:
    """Load a case with the changes and the start state of the command line; refuse an impossible start."""
    changed, begin = assignments(changes, "--set"), assignments(start, "--start")
    if "start" in changed:
        raise InputError("--set: found start, expected a symbol or a switch; start values are given with --start")

    given: dict[str, Any] = dict(changed)
    system = load(case, start=_in_states(load(case, **given), begin) if begin else None, **given)
    if system.start:
        from whirlmap.sweep.attractors.start_states import refuse_start  # all that labels a motion, which show needs not

        refuse_start(system)
    return system
