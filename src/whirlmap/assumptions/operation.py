"""Checks of a machine's operating data: numbers that the model accepts, but that are outside of the usual range."""

from collections.abc import Iterator

from whirlmap.assumptions.violation import Facts, Violation
from whirlmap.units import convert

#: Speeds are compared with the ends of a range that were read from text.
ROUNDING = 1e-9


def unbalance(facts: Facts) -> Iterator[Violation]:
    """A centre of mass that lies further out than the journal can move."""
    for rotor, parameter in facts.system.model.unbalances.items():
        name, value = parameter.name, facts.values[parameter.name]
        if value >= 1.0:
            yield Violation(
                f"unbalance_{name}", value, 1.0,
                f"The centre of mass of the {rotor} is {value:.3g} clearances off its axis ({name}): a rotor is balanced to"
                " a small part of the clearance.",
            )  # fmt: skip


def speed_range(facts: Facts) -> Iterator[Violation]:
    """Speeds outside of those for which the case was written."""
    per_s = facts.shaft_speed
    if per_s is None:
        return
    for name, end, s in (("speed_min", "lowest", facts.values[facts.system.speed]), ("speed_max", "highest", facts.s)):
        value, limit = per_s * s, facts.inputs.get(name)
        if limit is None:
            continue
        outside = value < limit * (1 - ROUNDING) if name == "speed_min" else value > limit * (1 + ROUNDING)
        if outside:
            rpm, bound = (convert(w, "rad/s", "rpm") for w in (value, limit))
            yield Violation(
                name, value, limit,
                f"The machine is run at {rpm:.5g} rpm; the {end} speed for which the case was written is {bound:.5g} rpm.",
            )  # fmt: skip
