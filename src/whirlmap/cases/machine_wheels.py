"""Wheels of a machine from parts: what several meshes say of one wheel agrees."""

from collections.abc import Sequence
from math import isclose

from whirlmap.cases.machine_tables import PartTable
from whirlmap.machines.parts.teeth import Teeth
from whirlmap.units import read

#: Relative difference of one module in two units, which is rounding.
SAME = 1e-9


def refuse_two_modules(tables: Sequence[PartTable], meshes: Sequence[Teeth]) -> None:
    """Refuse two modules of one wheel: of one shaft, station and number of teeth.

    Raises
    ------
    CaseError
        At the second mesh.
    """
    wheels: dict[tuple[str, int, float], tuple[str, float]] = {}
    for table, mesh in zip(tables, meshes, strict=True):
        for wheel, key in ((mesh.driver, "z_driver"), (mesh.driven, "z_driven")):
            if "module" not in table.numbers:
                continue
            given = ((table.numbers[name], unit) for name, unit in ((key, "1"), ("module", "m")))
            z, module = (float(read(one.value, unit, given=one.unit)) for one, unit in given)
            other, first = wheels.setdefault((wheel.shaft, wheel.station, z), (mesh.name, module))
            if not isclose(first, module, rel_tol=SAME):
                raise table.fault("module", f"found two modules on one wheel of {z:g} teeth, for mesh {other} has another;"
                                            " expected one")  # fmt: skip
