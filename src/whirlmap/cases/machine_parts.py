"""Parts of a machine from the tables of its file: shafts with disks, bearings, supports, meshes, unbalances, couplings."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from sympy import Expr, Integer, cos

from whirlmap.cases.machine_bearings import Bearings
from whirlmap.cases.machine_stations import Stations
from whirlmap.cases.machine_tables import PartTable, defaults
from whirlmap.cases.machine_wheels import refuse_two_modules
from whirlmap.equations.quantities import Parameter
from whirlmap.errors import CaseError
from whirlmap.machines.assembly import AnyBearing, Machine
from whirlmap.machines.parts import coefficients, contact, coupling, journal, rotor, support, teeth, unbalance
from whirlmap.machines.shafts import ROTOR, Disk, Shaft, reduced_numbers
from whirlmap.machines.train import Link, Train, train

#: Dimensional inputs of a mesh that the train reads, by their keys.
OF_TRAIN = ("z_driver", "z_driven", "beta_c", "T")


@dataclass
class Tables:
    """Tables of a machine file by their kind, and what they say together.

    Attributes
    ----------
    by_kind : mapping of str to list of PartTable
    reference : str
    torsion : bool
        Whether the rotation of shafts counts.
    oils : mapping of str to (Parameter, Parameter)
        Viscosity and density of each lubricant.
    highest : float
        Highest speed of the reference shaft [rad/s].
    """

    by_kind: Mapping[str, list[PartTable]]
    reference: str
    torsion: bool
    oils: Mapping[str, tuple[Parameter, Parameter]]
    highest: float

    @cached_property
    def stations(self) -> Stations:
        """Elements and stations of the shafts."""
        return Stations(self.by_kind)

    def of(self, kind: str) -> list[PartTable]:
        """Tables of one kind."""
        return self.by_kind.get(kind, [])

    def shaft(self, table: PartTable, key: str = "shaft") -> str:
        """Name of the shaft that a part is on."""
        return self.stations.shaft(table, key)

    def station(self, table: PartTable, shaft: str, value: Any, *, lumped: int = ROTOR) -> int:
        """Number of a station of a shaft."""
        return self.stations.station(table, shaft, value, lumped=lumped)

    # --- all of it -----------------------------------------------------------------------------------------

    def machine(self) -> Machine:
        """Read all parts.

        Raises
        ------
        CaseError
            Whatever is wrong with one of them, naming file, table and key.
        """
        self.stations.divide()
        links = [self._link(table) for table in self.of("mesh")]
        try:
            turning = train(self.reference, [one.name for one in self.of("shaft")], links, self._joints())
        except CaseError as error:
            kind, _, rest = str(error).partition(" ")
            name = rest.split(":")[0].split(" ")[0]
            at = next(one for one in self.of(kind) if one.name == name)
            raise at.fault("", str(error).partition(": ")[2]) from None
        reader = Bearings(self.stations, self.oils, [one.name for one in self.of("support")])
        found = [reader.bearing(table) for table in self.of("bearing")]
        # the one that lengths are over comes first
        bearings = tuple(sorted(found, key=lambda b: b.shaft != self.reference))
        meshes = tuple(self._mesh(table, turning) for table in self.of("mesh"))
        refuse_two_modules(self.of("mesh"), meshes)
        couplings = tuple(self._coupling(table) for table in self.of("coupling"))
        self._refuse_free_rotation(couplings)
        fastest = self._fastest(turning)
        unbalances = tuple(self._unbalance(table) for table in self.of("unbalance"))
        rubs = tuple(self._rub(table, reader) for table in self.of("rub"))
        rotors = tuple(
            self._rotor(table, bearings, meshes, (*unbalances, *rubs), couplings, fastest) for table in self.of("shaft")
        )  # fmt: skip
        supports = tuple(
            support.Support(t.name, frozenset(t.numbers), tuple(b.name for b in (*bearings, *rubs) if b.support == t.name))
            for t in self.of("support")
        )
        for table, one in zip(self.of("support"), supports, strict=True):
            if not any(b.support == one.name for b in bearings):
                raise table.fault("", "found no bearing that names this support, expected one")
            if len(one.bearings) > 1 and any(b.alike > 1 for b in bearings if b.name in one.bearings):
                raise table.fault("", "found several bearings on this support, one of which stands for two alike;"
                                      " expected each of"
                                      " the two to have a support of its own")  # fmt: skip
        films = tuple(b for b in bearings if isinstance(b, journal.JournalBearing))
        by_coefficients = tuple(b for b in bearings if isinstance(b, coefficients.CoefficientBearing))
        return Machine(
            self.reference, rotors, films, by_coefficients, supports, meshes, unbalances, couplings, rubs, turning
        )

    def _fastest(self, turning: Train) -> float:
        numbers: dict[Any, Any] = {}
        for table in self.of("mesh"):
            for key in ("z_driver", "z_driven"):
                numbers[Parameter(f"mesh.{table.name}.{key}", "1", "", order=True)] = table.numbers[key].value
        return self.highest * max(abs(float(speed.xreplace(numbers))) for speed in turning.speeds.values())

    def _link(self, table: PartTable) -> Link:
        own = {key: teeth.KEYS[key].parameter(f"mesh.{table.name}") for key in OF_TRAIN}
        driver, driven = self.shaft(table, "driver"), self.shaft(table, "driven")
        if driver == driven:
            raise table.fault("driven", f"found the shaft {driven!r} as driver and driven, expected two shafts")
        line = table.texts.get("kind", "line") == "line"
        zero: Expr = Integer(0)
        return Link(
            table.name, driver, driven, own["z_driver"], own["z_driven"],
            own["beta_c"] if line else zero, own["T"] if line else Integer(1),
        )  # fmt: skip

    def _mesh(self, table: PartTable, turning: Train) -> teeth.Teeth:
        texts = defaults(teeth.FIELDS) | table.texts
        if texts["kind"] == "line":
            table.needs(("module", "alpha", "beta_c"), "kind = line", teeth.FIELDS)
            if not {"T", "P"} & set(table.numbers):
                raise table.fault("", 'found neither T nor P, expected the torque or the power, as in P = "60 kW"')
            needed = {"fourier": ("v_1",), "rectangular": ("CR",)}.get(texts["stiffness"], ())
            table.needs(needed, f"stiffness = {texts['stiffness']}", teeth.FIELDS)
            if texts["backlash"] == "dead_zone":
                table.needs(("j_n",), "backlash = dead_zone", teeth.FIELDS)
        else:
            for key in ("stiffness", "backlash"):
                if texts[key] != defaults(teeth.FIELDS)[key]:
                    raise table.fault(key, f"found {table.texts[key]!r} with kind = isotropic, expected kind = line:"
                                           " the isotropic mesh has no line of action to act along")  # fmt: skip
        at = table.values.get("at") or (None, None)
        driver, driven = (
            teeth.Wheel(shaft, self.station(table, shaft, value), self.base(table.name, way), self.reference_base(shaft))
            for way, shaft, value in zip(
                ("driver", "driven"), (table.texts["driver"], table.texts["driven"]), at, strict=True
            )
        )
        return teeth.Teeth(
            table.name, driver, driven, texts["kind"], texts["stiffness"], texts["backlash"], frozenset(table.numbers),
            turning.senses[driver.shaft], self.torsion and texts["kind"] == "line", turning.phases[table.name],
        )  # fmt: skip

    @staticmethod
    def base(mesh: str, way: str) -> Expr:
        """Base radius of a wheel, of inputs."""
        own = {key: one.parameter(f"mesh.{mesh}") for key, one in teeth.KEYS.items()}
        return own["module"] * own[f"z_{way}"] * cos(own["alpha"]) / 2

    def reference_base(self, shaft: str, passed: tuple[str, ...] = ()) -> Expr:
        """Base radius on which arcs of a shaft are measured: that of its first mesh along the line of action.

        ``passed`` are couplings on the way to it.
        """
        for table in self.of("mesh"):
            if table.texts.get("kind", "line") == "line":
                for way in ("driver", "driven"):
                    if table.texts[way] == shaft:
                        return self.base(table.name, way)
        for name, first, second in self._joints():  # arcs of a shaft without teeth are on the circle of its neighbour
            if shaft in (first, second) and name not in passed:
                found = self.reference_base(second if shaft == first else first, (*passed, name))
                if found != 0:
                    return found
        return Integer(0)

    def _unbalance(self, table: PartTable) -> unbalance.Unbalance:
        if not {"U", "e", "G"} & set(table.numbers):
            raise table.fault("", 'found none of U, e and G, expected one, as in U = "30 g*mm"')
        shaft = self.shaft(table)
        station = self.station(table, shaft, table.values.get("at"))
        return unbalance.Unbalance(table.name, shaft, station, frozenset(table.numbers))

    def _rub(self, table: PartTable, reader: Bearings) -> contact.Rub:
        shaft = self.shaft(table)
        station = self.station(table, shaft, table.values.get("at"))
        if any(one.texts["shaft"] == shaft and one.texts.get("kind") != "coefficients"
               and self.stations.elements[shaft]
               and self.station(one, shaft, one.values.get("at")) == station for one in self.of("bearing")):
            raise table.fault("at", f"found a rub at a journal of shaft {shaft}, expected a station of its own, or"
                                    " contact = \"rub\" of that bearing")  # fmt: skip
        return contact.Rub(table.name, shaft, station, frozenset(table.numbers), reader.support(table))

    def _joints(self) -> list[tuple[str, str, str]]:
        """Couplings of two shafts: name, and both shafts."""
        made = []
        for table in (one for one in self.of("coupling") if "to" in one.texts):
            shaft, other = self.shaft(table), self.shaft(table, "to")
            if shaft == other:
                raise table.fault("to", f"found the shaft {other!r} at both ends, expected two shafts")
            made.append((table.name, shaft, other))
        return made

    def _coupling(self, table: PartTable) -> coupling.Coupling:
        shaft, to, given = self.shaft(table), table.texts.get("to", ""), frozenset(table.numbers)
        if not {"k_t", "k_r"} & given:
            raise table.fault("", 'found neither k_t nor k_r, expected a stiffness, as in k_t = "1e4 N*m/rad"')
        if "c_t" in given:
            table.needs(("k_t",), "c_t", coupling.FIELDS)
        if not self.torsion and "k_t" in given:
            raise table.fault("", 'found a coupling of shafts that turn uniformly, expected torsion = "free" in [operation]')
        if self.torsion and to:
            table.needs(("k_t",), 'torsion = "free"', coupling.FIELDS)
        if "k_t" in given and self.reference_base(shaft) == 0:
            raise table.fault("shaft", f"found a coupling on shaft {shaft}, which has no teeth along a line of action")
        if "k_t" in given and to and self.reference_base(to) != self.reference_base(shaft):
            raise table.fault("to", f"found teeth on both shafts, {shaft} and {to}, expected torsion between shafts of which"
                                    " one has teeth: arcs of both are counted on its base circle")  # fmt: skip
        if not to and table.values.get("at_to") is not None:
            raise table.fault("at_to", "found a station of another shaft, and no shaft in to; expected both")
        station = self.station(table, shaft, table.values.get("at"))
        other = self.stations.station(table, to, table.values.get("at_to"), "at_to") if to else 0
        return coupling.Coupling(table.name, shaft, station, given, self.reference_base(shaft), to, other)

    def _refuse_free_rotation(self, couplings: Sequence[coupling.Coupling]) -> None:
        if self.torsion and not any("k_t" in one.given and not one.to for one in couplings):
            at = self.of("mesh") or self.of("shaft")
            raise at[0].fault(
                "", 'found torsion = "free" without a coupling, expected one: nothing holds the common rotation'
            )
        if self.torsion and not any(self.reference_base(one.name) != 0 for one in self.of("shaft")):
            raise self.of("shaft")[0].fault(
                "", 'found torsion = "free" without teeth along a line of action, expected a mesh'
            )

    def _rotor(
        self, table: PartTable, bearings: Sequence[AnyBearing], meshes: Sequence[teeth.Teeth],
        pressing: Sequence[unbalance.Unbalance | contact.Rub], couplings: Sequence[coupling.Coupling], fastest: float,
    ) -> rotor.Rotor:  # fmt: skip
        name = table.name
        on_it = [b for b in bearings if b.shaft == name]
        mine = [b for b in on_it if isinstance(b, journal.JournalBearing)]
        by_coefficients = [b for b in on_it if isinstance(b, coefficients.CoefficientBearing)]
        if not on_it:
            raise table.fault("", "found no bearing on this shaft, expected one")
        for i, b in enumerate(on_it):
            if any(other.station == b.station for other in on_it[:i]):
                at = next(t for t in self.of("bearing") if t.name == b.name)
                raise at.fault("at", f"found a second bearing at one station of shaft {name}, expected stations of"
                                     " their own, or"
                                     " two_alike = 2")  # fmt: skip
        disks = [replace(d, station=self.station(table, name, d.station)) for d in self.stations.disks.get(name, ())]
        for one in (t for t in self.of("disk") if t.texts["shaft"] == name):
            if not self.stations.elements[name]:
                raise one.fault("shaft", f"found a disk on the lumped rotor {name}, expected its mass in m")
            own = one.fixed
            disks.append(
                Disk(one.name, self.station(one, name, one.values["at"]), own["m"], own.get("I_d", 0.0), own.get("I_p", 0.0))
            )
        wheels = [w for m in meshes for w in (m.driver, m.driven) if w.shaft == name]
        pressed = {w.station for w in wheels} | {one.station for one in pressing if one.shaft == name}
        pressed |= {at for c in couplings if {"k_r", "c_r"} & c.given for on, at, _ in c.ends() if on == name}
        pressed |= {b.station for b in by_coefficients}
        turning = self.torsion and self.reference_base(name) != 0
        held = {at for c in couplings for on, at, _ in c.ends() if on == name}
        twisted = {w.station for w in wheels} | held if turning else set()
        if turning and not self.stations.elements[name]:
            table.needs(("J",), 'torsion = "free"', rotor.FIELDS)
        if turning and name in self.stations.matrices:
            raise table.fault("file", 'found matrices with torsion = "free", expected elements: they say nothing of torsion')
        modes = table.whole("modes", 0, 0) if "modes" in table.values else None
        shaft = Shaft(
            name, tuple(self.stations.elements[name]), tuple(disks), modes, fastest, tuple(sorted(pressed)),
            tuple(sorted(twisted)), tuple(b.station for b in mine), held=tuple(b.station for b in by_coefficients),
            given=self.stations.matrices.get(name),
        )  # fmt: skip
        try:
            shaft = shaft.settled()
            reduced_numbers(shaft)
        except CaseError as error:
            raise table.fault("modes" if modes is not None else "elements", str(error)) from None
        shown = [(d.name, d.station) for d in disks]
        shown += [(f"{m.name}_{name}", w.station) for m in meshes for w in (m.driver, m.driven) if w.shaft == name]
        return rotor.Rotor(
            shaft, frozenset(table.numbers), tuple(b.name for b in mine), tuple(b.alike for b in mine),
            self.reference_base(name) if turning else None, tuple(shown),
        )  # fmt: skip
