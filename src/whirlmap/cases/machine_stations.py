"""Stations of the shafts of a machine file: elements, and the places at which parts stand on them."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from decimal import Decimal
from itertools import pairwise
from pathlib import Path
from typing import Any

from whirlmap.cases.machine_tables import PartTable
from whirlmap.cases.matrix_file import read_matrices
from whirlmap.cases.ross_file import read_ross
from whirlmap.errors import CaseError, nearest
from whirlmap.machines.beams import MATERIALS, Element, Material
from whirlmap.machines.matrices import ShaftMatrices
from whirlmap.machines.parts import rotor
from whirlmap.machines.shafts import ROTOR, Disk
from whirlmap.units import read

#: Two stations are one where they are nearer than this part of the shaft's length.
SAME = 1e-9
#: Diameter over length with which a shaft of matrices is drawn.
NOMINAL = 0.05


@dataclass
class Stations:
    """Elements of every shaft, and where its parts stand.

    Attributes
    ----------
    by_kind : mapping of str to list of PartTable
    elements : dict of str to list of Element
        By the shaft; empty for a lumped rotor.
    written : dict of str to list of float
        Ends of the elements as the file has them, before distances divided some [m].
    disks : dict of str to list of Disk
        Disks of shafts that a file of another program holds, at their stations there.
    matrices, names : dict
        Matrices of shafts that are given by these, and names of their stations.
    """

    by_kind: Mapping[str, list[PartTable]]
    elements: dict[str, list[Element]] = field(default_factory=dict)
    written: dict[str, list[float]] = field(default_factory=dict)
    disks: dict[str, list[Disk]] = field(default_factory=dict)
    matrices: dict[str, ShaftMatrices] = field(default_factory=dict)
    names: dict[str, tuple[str, ...]] = field(default_factory=dict)

    def of(self, kind: str) -> list[PartTable]:
        """Tables of one kind."""
        return self.by_kind.get(kind, [])

    def shaft(self, table: PartTable, key: str = "shaft") -> str:
        """Name of the shaft that a part is on."""
        known = [one.name for one in self.of("shaft")]
        name = table.texts[key]
        if name not in known:
            raise table.fault(key, f"found the shaft {name!r}, expected one of {', '.join(known)}.{nearest(name, known)}")
        return name


    def read_elements(self, table: PartTable) -> list[Element]:
        """Beam elements of a shaft; none of a lumped rotor."""
        listed = table.values.get("elements")
        if "file" in table.texts:
            return self._from_file(table)
        if listed is None:
            table.needs(("m", "K"), "no elements", rotor.FIELDS)
            return []
        for key in ("m", "K", "J"):
            if table.has(key):
                raise table.fault(key, f"found {key} beside elements, from which it follows; expected one of them")
        if not isinstance(listed, list) or not listed or not all(isinstance(one, Mapping) for one in listed):
            raise table.fault("elements", 'found no list of elements, expected elements = [ { L = "120 mm", d = "70 mm" } ]')
        made = list[Element]()
        for number, one in enumerate(listed, start=1):
            piece = PartTable("shaft", table.name, one, table.sources)
            piece.take(rotor.ELEMENT)
            L, d, d_i = piece.fixed["L"], piece.fixed["d"], piece.fixed.get("d_i", 0.0)
            if d_i >= d:
                raise table.fault("elements", f"found d_i = {d_i * 1e3:g} mm and d = {d * 1e3:g} mm in element {number},"
                                              " expected an inner diameter below the outer one")  # fmt: skip
            pieces, own = piece.whole("n", 1, 1), {"E", "G", "nu", "rho", "material"} & {*piece.fixed, *piece.texts}
            material = self._material(piece if own else table)
            made += [Element(L / pieces, d, d_i, material)] * pieces
        return made

    def _from_file(self, table: PartTable) -> list[Element]:
        """Beam elements of a shaft that ROSS saved, with its disks and without its bearings; or stations of matrices."""
        for key in ("elements", "m", "K", "J", "material", "E", "G", "nu", "rho"):
            if table.has(key):
                raise table.fault(key, f"found {key} beside file, from which it follows; expected one of them")
        place = Path(table.sources[0].file).parent / table.texts["file"]
        if place.suffix not in (".toml", ".npz"):
            raise table.fault("file", f"found {place.name!r}, expected a rotor of ROSS (.toml) or matrices (.npz)")
        if place.suffix == ".npz":
            return self._from_matrices(table, place)
        try:
            rotor = read_ross(place)
        except CaseError as error:
            raise table.fault("file", str(error)) from None
        self.disks[table.name] = [
            Disk(f"{table.name}_disk_{i}", d.node, d.m, d.I_d, d.I_p) for i, d in enumerate(rotor.disks, start=1)
        ]
        return [Element(e.L, e.d, e.d_i, Material(e.E, e.G, e.rho)) for e in rotor.elements]

    def _from_matrices(self, table: PartTable, place: Path) -> list[Element]:
        """Pieces between the stations of matrices, which say where those are and nothing else."""
        try:
            self.matrices[table.name], z, self.names[table.name] = read_matrices(place)
        except CaseError as error:
            raise table.fault("file", str(error)) from None
        return [Element(b - a, NOMINAL * z[-1], 0.0, MATERIALS["steel"]) for a, b in pairwise(z)]

    def _material(self, table: PartTable) -> Material:
        name, own = table.texts.get("material"), table.fixed
        if name is not None:
            if name not in MATERIALS:
                raise table.fault("material", f"found the material {name!r}, expected {', '.join(MATERIALS)}, or E,"
                                              " nu (or G) and"
                                              f" rho.{nearest(name, MATERIALS)}")  # fmt: skip
            given = [key for key in ("E", "G", "nu", "rho") if key in own]
            if given:
                raise table.fault(given[0], f"found {given[0]} beside material = {name!r}, expected one of them")
            return MATERIALS[name]
        table.needs(("E", "rho"), "no material", rotor.FIELDS)
        if ("G" in own) == ("nu" in own):
            raise table.fault("", f"found {'both' if 'G' in own else 'neither'} of G and nu, expected one of them")
        return Material(own["E"], own["G"] if "G" in own else own["E"] / (2 * (1 + own["nu"])), own["rho"])

    def station(self, table: PartTable, shaft: str, value: Any, key: str = "at", *, lumped: int = ROTOR) -> int:
        """Number of a station of a shaft; a distance between two ends divides the element there.

        All distances of a machine are read before any number of a station is used: see `divide`.
        """
        elements = self.elements[shaft]
        if not elements:
            if value is not None:
                raise table.fault(key, f"found the station {value!r} on the lumped rotor {shaft}, which has none to choose")
            return lumped
        if value is None:
            raise table.fault("", f"found no {key}, expected a station of shaft {shaft}, 0 to"
                                  f" {len(self.written[shaft]) - 1}, or a"
                                  ' distance from its first end such as "120 mm"')  # fmt: skip
        if value in self.names.get(shaft, ()):
            return self.names[shaft].index(value)
        if isinstance(value, int) and not isinstance(value, bool):
            last = len(self.written[shaft]) - 1
            if not 0 <= value <= last:
                raise table.fault(key, f"found station {value} on shaft {shaft}, expected 0 to {last}")
            place = self.written[shaft][value]
        else:
            place = self._distance(table, shaft, value, key)
        ends = [0.0]
        for e in elements:
            ends.append(ends[-1] + e.L)
        return min(range(len(ends)), key=lambda i: abs(ends[i] - place))

    def _distance(self, table: PartTable, shaft: str, value: Any, key: str) -> float:
        if isinstance(value, bool) or not isinstance(value, str | Mapping):
            raise table.fault(key, f"found {value!r}, expected the number of a station or a distance with its unit")
        text, unit = (value.get("value"), value.get("unit")) if isinstance(value, Mapping) else (value, None)
        if not isinstance(text, str | int | float | Decimal):
            raise table.fault(key, f"found {value!r}, expected the number of a station or a distance with its unit")
        try:
            place = float(read(text, "m", given=unit))
        except CaseError as error:
            raise table.fault(key, f"{error} (distance from the first end of shaft {shaft})") from None
        length = sum(e.L for e in self.elements[shaft])
        if not -SAME * length <= place <= length * (1 + SAME):
            raise table.fault(
                key, f"found {place * 1e3:g} mm on shaft {shaft}, expected 0 to its length of {length * 1e3:g} mm"
            )
        return place

    def divide(self) -> None:
        """Read the elements of all shafts, and divide those in which a part stands at a distance."""
        for table in self.of("shaft"):
            self.elements[table.name] = self.read_elements(table)
            self.written[table.name] = [0.0]
            for e in self.elements[table.name]:
                self.written[table.name].append(self.written[table.name][-1] + e.L)
        for kind in ("disk", "bearing", "unbalance", "coupling", "rub"):
            for table in self.of(kind):
                self._divide_at(table, self.shaft(table), table.values.get("at"))
                if kind == "coupling" and "to" in table.texts:
                    self._divide_at(table, self.shaft(table, "to"), table.values.get("at_to"), "at_to")
        for table in self.of("mesh"):
            at = table.values.get("at")
            if at is not None and (not isinstance(at, list) or len(at) != 2):
                raise table.fault("at", f"found {at!r}, expected two stations: of the driver and of the driven shaft")
            for key, value in zip(("driver", "driven"), at or (None, None), strict=True):
                self._divide_at(table, self.shaft(table, key), value)

    def _divide_at(self, table: PartTable, shaft: str, value: Any, key: str = "at") -> None:
        elements = self.elements[shaft]
        if not elements or value is None or isinstance(value, int) or value in self.names.get(shaft, ()):
            return
        place, begin = self._distance(table, shaft, value, key), 0.0
        length = sum(e.L for e in elements)
        for i, e in enumerate(elements):
            if begin + SAME * length < place < begin + e.L - SAME * length:
                if shaft in self.matrices:
                    raise table.fault(key, f"found {place * 1e3:g} mm on shaft {shaft}, where its matrices have no station")
                ahead = Element(place - begin, e.d, e.d_i, e.material)
                elements[i : i + 1] = [ahead, Element(e.L - ahead.L, e.d, e.d_i, e.material)]
                return
            begin += e.L
