"""Assumptions of its model that a machine violates, said beside every verdict."""

from collections.abc import Iterable, Mapping
from itertools import product
from types import MappingProxyType
from typing import Any

from whirlmap.assumptions.violations import repeated
from whirlmap.cli.common.messages import say
from whirlmap.integrate.loading import changed
from whirlmap.integrate.system import System


def say_assumptions(
    system: System, ends: Mapping[str, Any] = MappingProxyType({}), units: Mapping[str, str] = MappingProxyType({})
) -> list[str]:
    """Say on standard error which assumptions of the model are violated, as `show` does, and return these texts.

    ``ends`` are the first and the last value of all that was swept: all their combinations count. ``units`` are those of the
    dimensional inputs among them.
    """
    points: list[dict[str, Any]] = [dict(zip(ends, map(float, v), strict=True)) for v in product(*ends.values())]
    inputs = [{name: f"{at.pop(name)!r} {unit}".strip() for name, unit in units.items()} for at in points]
    bases = [changed(system, **texts) if texts else system for texts in inputs]
    return say_violations([base.replace(**at) for base, at in zip(bases, points, strict=True)])


def say_violations(systems: Iterable[System]) -> list[str]:
    """Say on standard error which assumptions any of these systems violates, and return these texts."""
    texts = repeated(systems)
    for text in texts:
        say(f"assumption violated: {text}")
    return texts
