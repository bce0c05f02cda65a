"""Assumptions of its model that a machine strains, said beside every verdict."""

from collections.abc import Iterable, Mapping, Sequence
from itertools import product
from types import MappingProxyType
from typing import Any

from whirlmap.assumptions.strained import repeated
from whirlmap.cli.common.messages import say
from whirlmap.integrate.system import System


def say_assumptions(system: System, ends: Mapping[str, Sequence[float]] = MappingProxyType({})) -> list[str]:
    """Say on standard error which assumptions of the model are strained, as `show` does, and return these texts.

    ``ends`` are the first and the last value of every parameter that was swept: all their combinations count.
    """
    points: list[dict[str, Any]] = [dict(zip(ends, map(float, v), strict=True)) for v in product(*ends.values())]
    return say_strains([system.replace(**at) for at in points])


def say_strains(systems: Iterable[System]) -> list[str]:
    """Say on standard error which assumptions any of these systems strains, and return these texts."""
    texts = repeated(systems)
    for text in texts:
        say(f"assumption strained: {text}")
    return texts
