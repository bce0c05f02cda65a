"""A machine file that extends another: its tables over those of the other, part by part."""

from collections.abc import Mapping
from typing import Any


def merged(base: Mapping[str, Any], own: Mapping[str, Any]) -> dict[str, Any]:
    """Tables of both; a part with the name of one there is says what changes of it, any other is added."""
    made = dict(base)
    for kind, value in own.items():
        before = base.get(kind)
        if isinstance(value, list) and isinstance(before, list):
            made[kind] = _parts(before, value)
        elif isinstance(value, Mapping) and isinstance(before, Mapping):
            made[kind] = {**before, **value}
        else:
            made[kind] = value
    return made


def _parts(base: list[Any], own: list[Any]) -> list[Any]:
    made = list(base)
    names = [one.get("name") if isinstance(one, Mapping) else None for one in base]
    for one in own:
        name = one.get("name") if isinstance(one, Mapping) else None
        if name is not None and name in names:
            place = names.index(name)
            made[place] = {**made[place], **one}
        else:
            made.append(one)
    return made
