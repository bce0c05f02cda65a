"""Keys of a machine file: what each table may say, and what counts as zero where it does not."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from whirlmap.cases.machine_tables import PartTable
from whirlmap.machines.fields import ABOVE, AT_LEAST, Choice, Field, Number, Text
from whirlmap.machines.parts import coefficients, contact, coupling, journal, rotor, support, teeth, unbalance
from whirlmap.models.lubricant import KELVIN
from whirlmap.models.operation import OPERATION, g, speed

OPERATING: tuple[Field, ...] = (
    Text("reference", "the shaft whose speed is given"),
    Choice("torsion", ("none", "free"), "shafts that turn uniformly, or whose rotation counts"),
    *(Number(q.name, q.unit, q.meaning, limits=AT_LEAST if q is g else ABOVE) for q in (speed, g, *OPERATION)),
)
OIL: tuple[Field, ...] = (
    Text("name", "name of the lubricant"),
    Number("mu", "Pa*s", "viscosity of the lubricant", limits=ABOVE),
    Number("VG", "1", "ISO VG grade", limits=ABOVE),
    Number("VI", "1", "viscosity index"),
    Number("nu_40", "m^2/s", "kinematic viscosity at 40 degC", limits=ABOVE),
    Number("nu_100", "m^2/s", "kinematic viscosity at 100 degC", limits=ABOVE),
    Number("T_oil", "degC", "temperature of the film", limits={"above": -KELVIN}),
    Number("rho", "kg/m^3", "density of the lubricant at its temperature", limits=ABOVE),
)
#: Tables of parts, and their fields.
KINDS: Mapping[str, Sequence[Field]] = {
    "shaft": rotor.FIELDS, "disk": rotor.DISK, "bearing": journal.FIELDS, "support": support.FIELDS, "mesh": teeth.FIELDS,
    "unbalance": unbalance.FIELDS, "coupling": coupling.FIELDS, "rub": contact.FIELDS, "lubricant": OIL,
}  # fmt: skip
#: Keys that stand for several.
BOTH = {"support": support.BOTH}
HEAD = ("model", "extends", "description", "start")
#: What a number belongs to that need not be there: damping of a spring that a coupling does not have is none.
BESIDE = {"c_t": "k_t", "c_r": "k_r"}


def fields_of(kind: str, values: Mapping[str, Any]) -> Sequence[Field]:
    """Fields of a table of a part: a bearing by its coefficients has others than one with a film."""
    by_coefficients = kind == "bearing" and values.get("kind") == "coefficients"
    return coefficients.FIELDS if by_coefficients else KINDS[kind]


def dotted(raw: Mapping[str, Any], key: str) -> list[str]:
    """Names under which a key of the parts of a file is reached: ``shaft.pinion.modes``."""
    found = list[str]()
    for kind in KINDS:
        listed = raw.get(kind)
        for i, one in enumerate(listed if isinstance(listed, list) else (), start=1):
            if any(field.key == key for field in fields_of(kind, one)):
                found.append(f"{kind}.{one.get('name', f'{kind}_{i}')}.{key}")
    return found


def left_out(by_kind: Mapping[str, Sequence[PartTable]]) -> Iterator[tuple[str, str, str]]:
    """Numbers that count as zero because the file does not give them."""
    for kind, tables in by_kind.items():
        for table in tables:
            rows = table.values.get("table")
            given = {key for row in rows for key in row} if kind == "bearing" and isinstance(rows, list) else set()
            for one in fields_of(kind, table.values):
                if not isinstance(one, Number) or not one.zero or table.has(one.key) or one.key in given:
                    continue
                if one.key not in BESIDE or table.has(BESIDE[one.key]):
                    yield kind, table.name, one.key
