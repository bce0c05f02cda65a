"""Checks of a machine's operating data: numbers that the model accepts, but that are outside of the usual range."""

from collections.abc import Iterator

from whirlmap.assumptions.violation import Facts, Violation
from whirlmap.units import convert, read

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


def rated_speed(facts: Facts) -> Iterator[Violation]:
    """A power that is given for a speed at which the machine is not run, as where that is the speed of another shaft."""
    settled = facts.system.machine
    if settled is None:
        return
    for target, how in settled.followed.items():
        for held, at in how.route.held.items():
            if held.name not in ("speed_min", "speed_max") or at.name not in how.reads:
                continue
            written, value = settled.case.given.get("speed"), settled.given[at.name]
            of_case = [float(read(written.value, "rad/s", given=written.unit))] if written else []
            known = [*of_case, *(settled.given[name] for name in ("speed_min", "speed_max") if name in settled.given)]
            if known and not min(known) * (1 - ROUNDING) <= value <= max(known) * (1 + ROUNDING):
                low, high, rpm = (convert(w, "rad/s", "rpm") for w in (min(known), max(known), value))
                yield Violation(
                    at.name, value, max(known),
                    f"{how.route.key} is given for {rpm:.5g} rpm, and the case is written for {low:.5g} to {high:.5g} rpm."
                    f" {at.name} is a speed of the shaft whose speed is swept and not of another shaft; {target} is"
                    f" {high / rpm:.3g} times that of the same power at {high:.5g} rpm.",
                )  # fmt: skip


def speeds(facts: Facts) -> Iterator[Violation]:
    """What the speeds of any machine violate."""
    yield from speed_range(facts)
    yield from rated_speed(facts)
