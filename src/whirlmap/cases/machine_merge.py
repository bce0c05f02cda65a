"""A machine file that extends another: its tables over those of the other, part by part."""

from collections.abc import Mapping
from typing import Any

from whirlmap.cases.machine_keys import fields_of


def merged(base: Mapping[str, Any], own: Mapping[str, Any]) -> dict[str, Any]:
    """Tables of both; a part with the name of one there is says what changes of it, any other is added.

    A bearing that becomes one of another kind keeps what both kinds have: a table of coefficients replaces a film.
    """
    made = dict(base)
    for kind, value in own.items():
        before = base.get(kind)
        if isinstance(value, list) and isinstance(before, list):
            made[kind] = _parts(kind, before, value)
        elif isinstance(value, Mapping) and isinstance(before, Mapping):
            made[kind] = {**before, **value}
        else:
            made[kind] = value
    return made


def _parts(kind: str, base: list[Any], own: list[Any]) -> list[Any]:
    made = list(base)
    names = [one.get("name") if isinstance(one, Mapping) else None for one in base]
    for one in own:
        name = one.get("name") if isinstance(one, Mapping) else None
        if name is not None and name in names:
            place = names.index(name)
            made[place] = {**suiting(kind, made[place], {**made[place], **one}), **one}
        else:
            made.append(one)
    return made


def suiting(kind: str, values: Mapping[str, Any], chosen: Mapping[str, Any]) -> dict[str, Any]:
    """Those values of a part that a part as ``chosen`` has keys for: a bearing by coefficients has no radius."""
    if kind != "bearing":
        return dict(values)
    known = {one.key for one in fields_of(kind, chosen)}
    return {key: value for key, value in values.items() if key in known}
