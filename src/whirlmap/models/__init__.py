"""Rotor systems and textbook oscillators, one declaration per file."""

from whirlmap.equations import Family
from whirlmap.errors import CaseError, nearest
from whirlmap.models.duffing import DUFFING
from whirlmap.models.gear_backlash import GEAR_BACKLASH
from whirlmap.models.gear_pair_machine import GEAR_PAIR_MACHINE
from whirlmap.models.jeffcott_machine import JEFFCOTT_MACHINE
from whirlmap.models.lorenz import LORENZ
from whirlmap.models.pendulum import PENDULUM
from whirlmap.models.roessler import ROESSLER
from whirlmap.models.van_der_pol import VAN_DER_POL

#: Every stock model, by name.
FAMILIES: dict[str, Family] = {
    family.name: family
    for family in (GEAR_PAIR_MACHINE, JEFFCOTT_MACHINE, GEAR_BACKLASH, DUFFING, PENDULUM, VAN_DER_POL, LORENZ, ROESSLER)
}


def family(name: str) -> Family:
    """Return the stock model of that name, or raise `CaseError` with the nearest one."""
    if name not in FAMILIES:
        raise CaseError(
            f"there is no model {name!r}.{nearest(name, FAMILIES)}\n  models: {', '.join(sorted(FAMILIES))}"
        )
    return FAMILIES[name]
