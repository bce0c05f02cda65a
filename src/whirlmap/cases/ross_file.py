"""Rotors as ROSS saves them (`rotor.save`): shaft elements, disks, bearings and point masses, read without ROSS.

ROSS is a finite-element code for rotors. Its file has a table for each element, called by its type and its tag, such as
``["ShaftElement_Shaft Element 0"]``; numbers are in SI. What whirlmap has no equation for is refused by its name.
"""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from whirlmap.errors import CaseError

#: Major versions whose files are known.
VERSIONS = ("2",)
#: Types of elements that are read.
TYPES = ("ShaftElement", "DiskElement", "BearingElement", "PointMass")
#: What a shaft element must say for the elements of whirlmap to be the same.
SAME: Mapping[str, Any] = {
    "axial_force": 0, "torque": 0, "shear_effects": True, "rotary_inertia": True, "gyroscopic": True,
    "shear_method_calc": "cowper", "alpha": 0, "beta": 0,
}  # fmt: skip
DIRECTIONS = ("xx", "xy", "yx", "yy")


@dataclass(frozen=True)
class RossElement:
    """A cylinder: length, outer and inner diameter [m], E, G [Pa], rho [kg/m^3]."""

    L: float
    d: float
    d_i: float
    E: float
    G: float
    rho: float


@dataclass(frozen=True)
class RossDisk:
    """A disk, or a point mass on the shaft: its tag, node, mass [kg] and inertias [kg m^2]."""

    tag: str
    node: int
    m: float
    I_d: float = 0.0
    I_p: float = 0.0


@dataclass(frozen=True)
class RossBearing:
    """Stiffness and damping between two nodes: coefficients by key, one for each frequency [rad/s], or one alone."""

    tag: str
    node: int
    link: int | None
    frequency: tuple[float, ...]
    coefficients: Mapping[str, tuple[float, ...]]


@dataclass(frozen=True)
class RossRotor:
    """A rotor of a ROSS file: elements from the first node on, disks, bearings, and masses beside the shaft by node."""

    elements: tuple[RossElement, ...]
    disks: tuple[RossDisk, ...]
    bearings: tuple[RossBearing, ...]
    masses: Mapping[int, float]


def read_ross(file: Path) -> RossRotor:
    """Read a rotor that ROSS saved.

    Parameters
    ----------
    file : Path

    Returns
    -------
    RossRotor

    Raises
    ------
    CaseError
        No such file, no TOML, another version; an element of another type, or one that says what whirlmap does not compute
        (cones, layers, axial forces, added masses); naming file, table and key.
    """
    return _Reader(file).rotor()


class _Reader:
    """Reads one file; messages name it."""

    def __init__(self, file: Path) -> None:
        self.file = file
        try:
            self.tables: dict[str, Any] = tomllib.loads(file.read_text(encoding="utf-8"))
        except OSError:
            raise CaseError(f"{file}: found no file that can be read, expected a rotor that ROSS saved") from None
        except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
            raise CaseError(f"{file}: found no TOML, expected a rotor that ROSS saved: {error}") from None

    def fault(self, table: str, key: str, message: str) -> CaseError:
        """An error at a key of a table."""
        return CaseError(f'{self.file}: ["{table}"]{f": {key}" if key else ""}: {message}')

    def rotor(self) -> RossRotor:
        """Read all elements."""
        version = self.tables.get("ross_version")
        if version is None or str(version).split(".")[0] not in VERSIONS:
            found = "no ross_version" if version is None else f"the version {version!r}"
            raise CaseError(
                f"{self.file}: ross_version: found {found}, expected a file that ROSS {' or '.join(VERSIONS)} saved: load it"
                " there, and save it again"
            )
        by_type: dict[str, list[tuple[str, Mapping[str, Any]]]] = {kind: [] for kind in TYPES}
        for name, table in self.tables.items():
            if name in ("ross_version", "parameters") or not isinstance(table, Mapping):
                continue
            kind = name.partition("_")[0]
            if kind not in by_type:
                raise self.fault(name, "", f"found an element of type {kind}, expected one of {', '.join(TYPES)}")
            by_type[kind].append((name, table))
        if not by_type["ShaftElement"]:
            raise CaseError(f"{self.file}: found no shaft element, expected at least one")
        elements = self._shaft(by_type["ShaftElement"])
        disks, masses = [self._disk(*one) for one in by_type["DiskElement"]], dict[int, float]()
        for name, table in by_type["PointMass"]:
            node, m = self._node(name, table), self.number(name, table, "mx")
            if self.number(name, table, "my") != m:
                raise self.fault(name, "my", "found another mass along y than along x, expected one")
            if node <= len(elements):
                disks.append(RossDisk(str(table.get("tag", name)), node, m))
            else:
                masses[node] = masses.get(node, 0.0) + m
        for disk in disks:
            if not 0 <= disk.node <= len(elements):
                raise CaseError(f"{self.file}: disk {disk.tag}: n: found {disk.node}, expected 0 to {len(elements)}")
        bearings = tuple(self._bearing(*one) for one in by_type["BearingElement"])
        return RossRotor(elements, tuple(disks), bearings, masses)

    def number(self, name: str, table: Mapping[str, Any], key: str) -> float:
        """A number of a table."""
        value = table.get(key)
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self.fault(name, key, f"found {'nothing' if value is None else repr(value)}, expected a number")
        return float(value)

    def _node(self, name: str, table: Mapping[str, Any], key: str = "n") -> int:
        value = table.get(key)
        if isinstance(value, bool) or not isinstance(value, int):
            found = "nothing" if value is None else repr(value)
            raise self.fault(name, key, f"found {found}, expected the number of a node")
        return value

    def _shaft(self, tables: list[tuple[str, Mapping[str, Any]]]) -> tuple[RossElement, ...]:
        made: dict[int, RossElement] = {}
        for name, table in tables:
            node = self._node(name, table)
            if node in made:
                raise self.fault(name, "n", f"found a second element at node {node}, expected one layer of elements")
            for key, expected in SAME.items():
                if key in table and table[key] != expected:
                    raise self.fault(name, key, f"found {table[key]!r}, expected {expected!r}, as whirlmap has it")
            for left, right in (("odl", "odr"), ("idl", "idr")):
                if right in table and self.number(name, table, left) != self.number(name, table, right):
                    raise self.fault(name, right, f"found a cone, {left} and {right} differ; expected a cylinder")
            material = table.get("material")
            if not isinstance(material, Mapping):
                raise self.fault(name, "material", "found none, expected its table with E, G_s and rho")
            E, G, rho = (self.number(f"{name}.material", material, key) for key in ("E", "G_s", "rho"))
            L, d, d_i = (self.number(name, table, key) for key in ("L", "odl", "idl"))
            if not (L > 0 and d > d_i >= 0 and E > 0 and G > 0 and rho > 0):
                raise self.fault(name, "", "found a length, a diameter or a material that no shaft has")
            made[node] = RossElement(L, d, d_i, E, G, rho)
        if sorted(made) != list(range(len(made))):
            raise CaseError(f"{self.file}: found shaft elements at nodes {sorted(made)}, expected 0, 1, 2 and so on")
        return tuple(made[node] for node in sorted(made))

    def _disk(self, name: str, table: Mapping[str, Any]) -> RossDisk:
        m, I_d, I_p = (self.number(name, table, key) for key in ("m", "Id", "Ip"))
        if not m > 0:
            raise self.fault(name, "m", f"found {m:g}, expected a mass above zero")
        return RossDisk(str(table.get("tag", name)), self._node(name, table), m, I_d, I_p)

    def _bearing(self, name: str, table: Mapping[str, Any]) -> RossBearing:
        for ij in DIRECTIONS:
            if any(self._many(name, table, f"m{ij}")):
                raise self.fault(name, f"m{ij}", "found an added mass, expected none: bearings have stiffness and damping")
        frequency = self._many(name, table, "frequency")
        found = {f"{q}{ij}": self._many(name, table, f"{q}{ij}") for q in "kc" for ij in DIRECTIONS}
        for key, values in found.items():
            if values and len(values) != max(len(frequency), 1):
                raise self.fault(name, key, f"found {len(values)} values, expected {max(len(frequency), 1)}")
        link = table.get("n_link")
        used = {key: values for key, values in found.items() if any(values)}
        return RossBearing(str(table.get("tag", name)), self._node(name, table), link, frequency, used)

    def _many(self, name: str, table: Mapping[str, Any], key: str) -> tuple[float, ...]:
        value = table.get(key, [])
        listed = value if isinstance(value, list) else [value]
        if not all(isinstance(v, int | float) and not isinstance(v, bool) for v in listed):
            raise self.fault(name, key, f"found {value!r}, expected numbers")
        return tuple(map(float, listed))
