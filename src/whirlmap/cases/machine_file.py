"""Case files of machines from parts: ``model = "machine"`` and a table for each part.

::

    model = "machine"
    [operation]
    reference = "pinion"                     # the shaft whose speed is given; the others follow from the teeth
    speed = "11000 rpm"
    [[shaft]]
    name = "pinion"
    material = "steel"
    elements = [ { L = "120 mm", d = "70 mm" }, { L = "90 mm", d = "95 mm", d_i = "20 mm" } ]
    [[bearing]]
    name = "drive_end"
    shaft = "pinion"
    at = 0                                   # number of a station, or a distance from the first end
    R = { value = 35, unit = "mm", source = "drawing" }
    ...

Tables become a family of its own for each file: parts with their shape, whose numbers stand in the equations, and inputs
with dotted names, ``bearing.drive_end.c``, which can be changed and varied. docs/parts.md lists all keys.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

from whirlmap.cases.entries import Given
from whirlmap.cases.machine_keys import BOTH, HEAD, KINDS, OIL, OPERATING, dotted, fields_of, left_out
from whirlmap.cases.machine_merge import suiting
from whirlmap.cases.machine_parts import Tables
from whirlmap.cases.machine_tables import NAME, PartTable, Source
from whirlmap.equations.family import Family
from whirlmap.equations.quantities import Parameter
from whirlmap.errors import CaseError, nearest
from whirlmap.machines.assembly import Machine, assemble
from whirlmap.machines.fields import Number
from whirlmap.machines.inputs import groups_of
from whirlmap.machines.parts import rotor
from whirlmap.machines.statics import static_start
from whirlmap.units import read

#: Gravity where a file says none.
GRAVITY = Given("g", "9.81 m/s^2", None, "assumed: standard gravity, rounded, where the file says none")


@dataclass(frozen=True)
class MachineCase:
    """What a machine file says.

    Attributes
    ----------
    family : Family
    machine : Machine
    layer : mapping of str to Given
        Its inputs by their dotted names, and those that follow from the shape of its shafts.
    raw : mapping
        The tables as they were read, to be read again with a change.
    sources : sequence of Source
    left_out : tuple of (str, str, str)
        Kind, name and key of numbers that every such part has, that the file leaves out, and that count as zero.
    """

    family: Family
    machine: Machine
    layer: Mapping[str, Given]
    raw: Mapping[str, Any]
    sources: Sequence[Source]
    left_out: tuple[tuple[str, str, str], ...] = ()

    def changed(self, changes: Mapping[str, Any]) -> "tuple[MachineCase, dict[str, Any]]":
        """Take those changes that only another declaration can have: a diameter, a choice, a part's new key.

        Returns
        -------
        machine : MachineCase
        left : dict
            The changes that are inputs.

        Raises
        ------
        CaseError
            A change of what follows from the shape of a shaft, or as for a file.
        """
        raw, left, others = dict(self.raw), dict(changes), False
        for name, value in changes.items():
            if name in self.layer or (found := _place(raw, name)) is None:
                self._refuse(name)
                continue
            kind, index, key = found
            raw[kind] = _with(raw[kind], index, key, value.written if isinstance(value, Given) else value)
            if key == ["kind"]:
                raw[kind][index] = suiting(kind, raw[kind][index], raw[kind][index])
            del left[name]
            others = True
        return (read_machine(raw, self.sources) if others else self), left

    def _refuse(self, name: str) -> None:
        """Refuse a dotted name of no part, and a change of what follows."""
        given, groups = self.layer.get(name), self.family.groups
        assert groups is not None
        known = [*(q.name for q in groups.inputs), *groups.shared]
        if "." in name and name not in known:
            raise CaseError(f"found {name!r}, which names nothing of this machine, expected kind.part.key, such as"
                            f" {known[-1]}."
                            f"{nearest(name, known)}")  # fmt: skip
        if (places := dotted(self.raw, name)) and name not in (*known, *self.family.symbols(), *self.family.switches):
            every = [f"{shared} for all of these" for shared in groups.shared if shared.endswith(f".{name}")]
            raise CaseError(f"found {name!r}, a key of parts, expected the part as well: {', '.join([*places, *every])}")
        if given is not None and given.note.startswith("follows"):
            raise CaseError(f"{name} follows from the elements and disks of its shaft, expected a change of those, such as"
                            f" {name.rpartition('.')[0]}.elements.1.d")  # fmt: skip


#: Inputs of which one stands for another, so that giving one needs no other declaration.
ALTERNATIVES = {"unbalance": ("U", "e", "G"), "mesh": ("T", "P", "speed_P"), "lubricant": tuple(q.key for q in OIL)}


def _place(raw: Mapping[str, Any], name: str) -> tuple[str, int, list[str]] | None:
    """Kind, number and keys of what a dotted name says in the tables; None for what is an input there or nothing."""
    kind, _, rest = name.partition(".")
    if kind == "operation" or name in ("torsion", "reference"):
        return ("operation", -1, [rest or name]) if (rest or name) in ("torsion", "reference") else None
    part, _, key = rest.partition(".")
    listed = raw.get(kind)
    if kind not in KINDS or not isinstance(listed, list) or not key or key in ALTERNATIVES.get(kind, ()):
        return None
    index = next((i for i, one in enumerate(listed) if one.get("name", f"{kind}_{i + 1}") == part), None)
    return None if index is None else (kind, index, key.split("."))


def _with(tables: Any, index: int, keys: Sequence[str], value: Any) -> Any:
    """Tables with one value replaced: ``elements.2.d`` counts elements from 1."""
    if isinstance(tables, list):
        changed = list(tables)
        changed[index] = _with(changed[index], -1, keys, value)
        return changed
    first, *more = keys
    made = dict(tables)
    if not more:
        made[first] = int(value) if first in ("modes", "two_alike", "n") and str(value).strip().isdigit() else value
        return made
    inside = made.get(first)
    if not isinstance(inside, list) or not more[0].isdigit() or not 1 <= int(more[0]) <= len(inside):
        raise CaseError(f"{'.'.join(keys)}: found no such place in the table, expected {first}.1 to"
                        f" {first}.{len(inside) if isinstance(inside, list) else 0}")  # fmt: skip
    made[first] = _with(inside, int(more[0]) - 1, more[1:], value) if more[1:] else value
    return made


def read_machine(raw: Mapping[str, Any], sources: Sequence[Source]) -> MachineCase:
    """Read the tables of a machine.

    Raises
    ------
    CaseError
        Naming file, line, table and key, what was found and what was expected.
    """
    file = sources[0].file
    for key, value in raw.items():
        if key in HEAD or (key in ("operation", "lubricant") and isinstance(value, Mapping)):
            continue
        if key not in KINDS:
            known = [*KINDS, "operation"]
            raise CaseError(f"{file}: found {key!r}, expected one of {', '.join(known)}.{nearest(key, known)}")
        if not isinstance(value, list):
            raise CaseError(f"{file}: found [{key}], expected [[{key}]], for there may be several")
    if not isinstance(raw.get("operation"), Mapping):
        raise CaseError(f"{file}: found no table [operation], expected one with the speed")
    operation = PartTable("operation", "", raw["operation"], sources, single=True)
    operation.take(OPERATING)
    if "speed" not in operation.numbers:
        raise operation.fault("", 'found no speed, expected one, as in speed = "3000 rpm"')
    by_kind = {kind: _tables(kind, raw.get(kind, []), sources) for kind in KINDS}
    _refuse_alike(by_kind)
    for kind in ("shaft", "bearing"):
        if not by_kind[kind]:
            raise CaseError(f"{file}: found no table [[{kind}]], expected at least one")
    shafts = [one.name for one in by_kind["shaft"]]
    reference = operation.texts.get("reference", shafts[0] if len(shafts) == 1 else None)
    if reference not in shafts:
        found = f"the shaft {reference!r}" if reference else "no reference"
        raise operation.fault("reference" if reference else "", f"found {found}, expected one of {', '.join(shafts)}")
    highest = operation.numbers.get("speed_max", operation.numbers["speed"])
    torsion = operation.texts.get("torsion", "none") == "free"
    tables = Tables(
        by_kind, reference, torsion, _oils(by_kind["lubricant"]), float(read(highest.value, "rad/s", given=highest.unit))
    )
    machine = tables.machine()
    layer = {given.name: given for given in _inputs(operation, by_kind)}
    for one in machine.rotors:
        for name, value in _derived(one):
            layer[name] = value
    family = _family(machine, tuple(tables.oils.items()))
    return MachineCase(family, machine, layer, raw, sources, tuple(left_out(by_kind)))


def _tables(kind: str, listed: Any, sources: Sequence[Source]) -> list[PartTable]:
    single = isinstance(listed, Mapping)
    made = []
    for i, values in enumerate([listed] if single else listed):
        if not isinstance(values, Mapping):
            raise CaseError(f"{sources[0].file}: found {values!r} in {kind}, expected a table")
        name = values.get("name", "" if single else f"{kind}_{i + 1}")
        if not isinstance(name, str) or (name and not NAME.fullmatch(name)):
            raise CaseError(f"{sources[0].file}: [[{kind}]]: name: found {name!r}, expected letters, digits and underscores")
        table = PartTable(kind, name, values, sources, single=single)
        numbered = {k: v for k, v in values.items() if not (kind == "mesh" and k == "z")}
        if kind == "mesh":
            numbered |= _teeth(table)
            table.values = {**numbered, "z": values.get("z")}
        PartTable.take(
            shown := replace(table, values=numbered | ({"z": 0} if kind == "mesh" else {})), fields_of(kind, values),
            BOTH.get(kind),
        )  # fmt: skip
        table.numbers, table.fixed, table.texts = shown.numbers, shown.fixed, shown.texts
        made.append(table)
    return made


def _teeth(table: PartTable) -> dict[str, Any]:
    """Numbers of teeth of both wheels, from the two in z."""
    z: Any = table.values.get("z")
    noted: dict[str, Any] = {}
    if isinstance(z, Mapping):
        noted = {key: z[key] for key in ("source", "assumed") if key in z}
        z = z.get("value")
    if z is None and "z_driver" in table.values:
        return {}
    if (
        not isinstance(z, list)
        or len(z) != 2
        or not all(isinstance(n, int) and not isinstance(n, bool) and n > 0 for n in z)
    ):
        raise table.fault("z" if z is not None else "", f"found z = {z!r}, expected the teeth of the driver and of"
                                                        " the driven wheel,"
                          " as in z = [31, 93]")  # fmt: skip
    given = {k: table.values[k] for k in ("z_driver", "z_driven") if k in table.values}
    return {"z_driver": {"value": z[0], **noted}, "z_driven": {"value": z[1], **noted}, **given}


def _refuse_alike(by_kind: Mapping[str, list[PartTable]]) -> None:
    seen: dict[str, PartTable] = {}
    for tables in by_kind.values():
        for table in tables:
            if table.name and table.name in seen:
                other = seen[table.name]
                raise table.fault("name", f"found {table.name!r}, the name of a {other.kind} too; expected names of"
                                          " their own, for"
                                          " they are parts of symbols")  # fmt: skip
            seen[table.name] = table


def _oils(tables: Sequence[PartTable]) -> dict[str, tuple[Parameter, Parameter]]:
    """Viscosity and density of each lubricant."""
    known = {one.key: one for one in OIL if isinstance(one, Number)}
    made = {}
    for table in tables:
        part = f"lubricant.{table.name}" if table.name else "lubricant"
        made[table.name or "lubricant"] = (known["mu"].parameter(part), known["rho"].parameter(part))
        if not {"mu", "VG", "nu_40"} & set(table.numbers):
            raise table.fault("", "found none of mu, VG and nu_40, expected the viscosity in one of these ways")
    return made


def _inputs(operation: PartTable, by_kind: Mapping[str, list[PartTable]]) -> list[Given]:
    """Inputs as the file gives them."""
    made = [replace(given, name=key) for key, given in operation.numbers.items()]
    if "g" not in operation.numbers:
        made.append(GRAVITY)
    for tables in by_kind.values():
        made += [given for table in tables for given in table.numbers.values()]
    return made


def _derived(one: rotor.Rotor) -> list[tuple[str, Given]]:
    """Mass, stiffness and inertia of a shaft, which follow from its elements and disks."""
    if one.shaft.lumped:
        return []
    rule = "follows: elements and disks of the shaft"
    values = {"m": one.shaft.mass, "K": one.shaft.stiffness}
    if one.shaft.given is None:  # matrices of bending do not say it
        values["J"] = one.shaft.inertia
    made = []
    for key, value in values.items():
        quantity = rotor.quantity(one.name, key)
        made.append((quantity.name, Given(quantity.name, float(f"{value:.12g}"), quantity.unit, rule)))
    return made


@lru_cache(maxsize=32)
def _family(machine: Machine, oils: tuple[tuple[str, tuple[Parameter, Parameter]], ...]) -> Family:
    """The family of one machine; the same parts give the same object, so that its kernels are found again."""
    return Family(
        name="machine",
        declare=lambda: assemble(machine, static_start(machine)),
        groups=groups_of(machine, dict(oils)),
    )
