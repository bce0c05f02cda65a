"""Suggestions for a name or choice that a model does not have: by its kind, its meaning, or its spelling."""

import re
from collections.abc import Iterable

from whirlmap.equations.family import SHOWN, Family
from whirlmap.equations.model import Model
from whirlmap.equations.quantities import Parameter
from whirlmap.errors import closest
from whirlmap.units import example, is_unit_of


def of_symbol(family: Family, model: Model, name: str, quantities: Iterable[Parameter], value: object = "") -> str:
    """Say what an unknown symbol is instead, or what the model lacks, else which quantities mean it or are spelt so."""
    if name in {s.name for s in model.states}:
        return f" {name} is a state: its start value is given in start, by --start on the command line."
    if name in model.outputs:
        return f" {name} is an output, which follows from the motion."
    if lacking := family.hint(name, (), value):
        return lacking
    known = {q.name: q for q in quantities}
    if measured := next((q for q in known.values() if is_unit_of(name, q.unit)), None):
        return f" {name} is a unit, as in {measured.name} = {example(measured.unit)}."
    near = closest(name, [*known, *family.switches])
    if near is None or near.casefold() != name.casefold():
        words = re.findall(r"[a-z]{4,}", name.casefold().replace("_", " "))
        meant = [q for q in known.values() if any(q.says(word) for word in words)][:SHOWN]
        if len(meant) > 1:
            return f" Did you mean one of {', '.join(f'{q.name!r} ({q.meaning})' for q in meant)}?"
        near = meant[0].name if meant else near
    if near is None:
        return ""
    return f" Did you mean {near!r}?{f' ({known[near].meaning})' if near in known else ''}"
