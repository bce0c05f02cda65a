"""A shaft: its modes in both planes, its rotation where torsion counts, and its force on journals.

The equations of a mode k are those of docs/parts.md, over m_0 c_0 (clock speed)^2::

    nu mu_k x_k'' + nu r sum_j g_kj y_j' + ... = (-kappa l_k x_k + forces)/s^2

with mass mu_k, stiffness l_k and gyroscopic g_kj over the shaft's own mass and stiffness, which are numbers of the kernel.
"""

from dataclasses import dataclass

import numpy as np
from sympy import Abs, Expr, Integer, sqrt

from whirlmap.equations.parts import Output
from whirlmap.equations.quantities import Parameter, State
from whirlmap.machines.fields import ABOVE, AT_LEAST, Field, Number, Other, Text
from whirlmap.machines.parts.part import ZERO, Coupled, Declared, Vector
from whirlmap.machines.reduction import mode_names
from whirlmap.machines.scale import LENGTH, RATE, Scale, f, linear_form, number, s
from whirlmap.machines.shafts import Reduced, Shaft, reduced_numbers

FIELDS: tuple[Field, ...] = (
    Text("name", "name of the shaft", required=True),
    Text("material", "material by name, steel"),
    Number("E", "Pa", "Young's modulus", fixed=True, limits=ABOVE),
    Number("G", "Pa", "shear modulus", fixed=True, limits=ABOVE),
    Number("nu", "1", "Poisson's ratio", fixed=True, limits={"at_least": 0, "below": 0.5}),
    Number("rho", "kg/m^3", "density", fixed=True, limits=ABOVE),
    Other("elements", "beam elements from the first end: L, d, d_i, n equal pieces, and a material of their own"),
    Text("file", "file of a rotor that ROSS saved (.toml), or of matrices of a free shaft (.npz)"),
    Number("m", "kg", "mass, with disks", limits=ABOVE),
    Number("K", "N/m", "stiffness m omega^2 of the lowest bending mode on rigid bearings", limits=ABOVE),
    Number("J", "kg*m^2", "polar inertia, with disks", limits=ABOVE),
    Number("C", "N*s/m", "external damping, spread like the mass", zero=True, limits=AT_LEAST),
    Number("zeta", "1", "damping ratio of the elastic modes", zero=True, limits=AT_LEAST),
    Other("modes", "elastic modes to keep in a plane"),
)
ELEMENT: tuple[Field, ...] = (
    Number("L", "m", "length of an element", required=True, fixed=True, limits=ABOVE),
    Number("d", "m", "outer diameter of an element", required=True, fixed=True, limits=ABOVE),
    Number("d_i", "m", "inner diameter of an element", fixed=True, limits=AT_LEAST),
    Text("material", "its material, where it is not that of the shaft"),
    Number("E", "Pa", "Young's modulus of an element", fixed=True, limits=ABOVE),
    Number("G", "Pa", "shear modulus of an element", fixed=True, limits=ABOVE),
    Number("nu", "1", "Poisson's ratio of an element", fixed=True, limits={"at_least": 0, "below": 0.5}),
    Number("rho", "kg/m^3", "density of an element", fixed=True, limits=ABOVE),
    Other("n", "equal pieces that it is divided into"),
)
DISK: tuple[Field, ...] = (
    Text("name", "name of the disk"),
    Text("shaft", "shaft that it is on", required=True),
    Other("at", "station", required=True),
    Number("m", "kg", "mass of a disk", required=True, fixed=True, limits=ABOVE),
    Number("I_d", "kg*m^2", "diametral inertia of a disk", fixed=True, zero=True, limits=AT_LEAST),
    Number("I_p", "kg*m^2", "polar inertia of a disk", fixed=True, zero=True, limits=AT_LEAST),
)
#: Part of uniform rotation in a twisting mode below which it is none: they are orthogonal to it.
ROUNDING = 1e-9
#: What frequencies of twisting are over.
OMEGA_0_2 = Parameter("omega_0_2", "1", "omega_0^2 in rad^2/s^2: what squares of twisting frequencies are over", above=0)
OF_SHAFT = {one.key: one for one in FIELDS if isinstance(one, Number)}


def quantity(shaft: str, key: str) -> Parameter:
    """An input of a shaft: ``shaft.pinion.m``. Mass, stiffness and inertia of a shaft of elements follow from those."""
    return OF_SHAFT[key].parameter(f"shaft.{shaft}")


def speed_over_clock(shaft: str) -> Parameter:
    """Speed of a shaft over the clock's, positive from x to y."""
    return Parameter(f"r_{shaft}", "1", f"speed of {shaft} over clock speed, negative where it turns clockwise", order=True)


def mass_ratio(shaft: str) -> Parameter:
    """Mass of a shaft over m_0."""
    return Parameter(f"nu_{shaft}", "1", f"mass of {shaft} over m_0", latex=rf"\nu_\mathrm{{{shaft}}}", above=0)


@dataclass(frozen=True)
class Rotor:
    """The modes of one shaft.

    Attributes
    ----------
    shaft : Shaft
    given : frozenset of str
        Inputs that the case gives, of C, zeta.
    bearings : tuple of str
        Its bearings, in the order of `Shaft.bearings`.
    alike : mapping of str to int, as pairs
        Number of identical bearings that each of them stands for.
    base : Expr or None
        Base radius on which arcs of its rotation are measured [m]; None where torsion does not count.
    shown : tuple of (str, int)
        Stations whose displacement is an output, by the name of what is there.
    """

    shaft: Shaft
    given: frozenset[str]
    bearings: tuple[str, ...]
    alike: tuple[int, ...]
    base: Expr | None = None
    shown: tuple[tuple[str, int], ...] = ()

    @property
    def name(self) -> str:
        """Name of the shaft."""
        return self.shaft.name

    @property
    def numbers(self) -> Reduced:
        """Numbers of its modes."""
        return reduced_numbers(self.shaft)

    @property
    def r(self) -> Parameter:
        """Its speed over the clock's."""
        return speed_over_clock(self.name)

    @property
    def nu(self) -> Parameter:
        """Its mass over m_0."""
        return mass_ratio(self.name)

    @property
    def kappa(self) -> Parameter:
        """Its stiffness over K_0."""
        meaning = f"stiffness of {self.name} on rigid bearings over K_0"
        return Parameter(f"kappa_{self.name}", "1", meaning, latex=rf"\kappa_\mathrm{{{self.name}}}", above=0)

    @property
    def xi(self) -> Parameter:
        """External damping."""
        meaning = f"external damping of {self.name}, C/(2 m omega_0)"
        return Parameter(f"xi_{self.name}", "1", meaning, latex=rf"\xi_\mathrm{{{self.name}}}", at_least=0)

    @property
    def zeta(self) -> Parameter:
        """Damping ratio of the elastic modes."""
        return Parameter(f"zeta_{self.name}", "1", f"damping ratio of the elastic modes of {self.name}", at_least=0)

    @property
    def iota(self) -> Parameter:
        """Polar inertia."""
        meaning = f"polar inertia of {self.name}, J/(m_0 R_b^2)"
        return Parameter(f"iota_{self.name}", "1", meaning, latex=rf"\iota_\mathrm{{{self.name}}}", above=0)

    @property
    def radius(self) -> Parameter:
        """Base radius of its arcs."""
        meaning = f"base radius of the arcs of {self.name} over c_0"
        return Parameter(f"rho_{self.name}", "1", meaning, latex=rf"\rho_\mathrm{{{self.name}}}", above=0)

    def groups(self, scale: Scale) -> dict[Parameter, Expr]:
        """Parameters of the modes; the speed follows from the teeth."""
        m, K = quantity(self.name, "m"), quantity(self.name, "K")
        made: dict[Parameter, Expr] = {self.nu: m / scale.m_0, self.kappa: K / scale.K_0}
        if "C" in self.given:
            made[self.xi] = quantity(self.name, "C") / (2 * m * scale.omega_0)
        if "zeta" in self.given:
            made[self.zeta] = quantity(self.name, "zeta")
        if self.base is not None:
            made[self.iota] = quantity(self.name, "J") / (scale.m_0 * self.base**2)
            made[self.radius] = self.base / scale.c_0
            if np.any(self.shaft.twisting.frequency > 0):
                made[OMEGA_0_2] = scale.K_0 / scale.m_0
        return made

    # --- unknowns ------------------------------------------------------------------------------------------

    @property
    def _kinds(self) -> list[tuple[str, str]]:
        """Short and long name of each mode of a plane."""
        short = {"translation": "", "tilt": "t"}
        names = mode_names(self.shaft.reduced)
        return [(short.get(n, n.replace("bending ", "").replace("attachment ", "a")), n) for n in names]

    def coordinates(self, axis: str) -> tuple[State, ...]:
        """Modal coordinates in one plane."""
        return tuple(
            State(f"{axis}{short}_{self.name}", LENGTH, f"{long} of {self.name} along {axis}, over c_0", measure="length")
            for short, long in self._kinds
        )

    def rates_of(self, axis: str) -> tuple[State, ...]:
        """Their velocities."""
        return tuple(
            State(
                f"v{axis}{short}_{self.name}",
                RATE,
                f"rate of {axis}{short}_{self.name}, per clock radian",
                measure="velocity",
            )
            for short, _ in self._kinds
        )

    @property
    def _twists(self) -> list[str]:
        names = mode_names(self.shaft.twisting) if self.base is not None else []
        short = {"translation": ""}
        return [short.get(n, n.replace("bending ", "").replace("attachment ", "a")) for n in names]

    @property
    def arcs(self) -> tuple[State, ...]:
        """Coordinates of the rotation: arcs of the base circle from uniform rotation."""
        meaning = f"arc of {self.name} from uniform rotation, along it, over c_0"
        return tuple(State(f"q{n}_{self.name}", LENGTH, meaning, measure="length") for n in self._twists)

    @property
    def arc_rates(self) -> tuple[State, ...]:
        """Their rates."""
        return tuple(
            State(f"vq{n}_{self.name}", RATE, f"rate of q{n}_{self.name}, per clock radian", measure="velocity")
            for n in self._twists
        )

    def unknowns(self) -> tuple[State, ...]:
        """Coordinates of both planes and of the rotation, then their rates."""
        pairs = zip(self.coordinates("x"), self.coordinates("y"), strict=True)
        rates = zip(self.rates_of("x"), self.rates_of("y"), strict=True)
        return (*(q for pair in pairs for q in pair), *self.arcs, *(v for pair in rates for v in pair), *self.arc_rates)

    # --- coupled -------------------------------------------------------------------------------------------

    def displacement(self, station: int) -> Vector:
        """Displacement of the modes at a station."""
        weights = list(self.numbers.shapes[station])
        return linear_form(weights, list(self.coordinates("x"))), linear_form(weights, list(self.coordinates("y")))

    def velocity(self, station: int) -> Vector:
        """Its rate."""
        weights = list(self.numbers.shapes[station])
        return linear_form(weights, list(self.rates_of("x"))), linear_form(weights, list(self.rates_of("y")))

    def arc(self, station: int) -> tuple[Expr, Expr]:
        """Arc of the rotation at a station, and its rate."""
        if self.base is None:
            return ZERO
        weights = list(self.shaft.twisting.shapes[self.shaft.turning_station(station)])
        return linear_form(weights, list(self.arcs)), linear_form(weights, list(self.arc_rates))

    def couple(self, coupled: Coupled) -> None:
        """Its motion."""
        coupled.motions[self.name] = self

    def press(self, coupled: Coupled) -> None:
        """Forces on its journals: residual stiffness times displacement of the modes less that of the journal."""
        numbers, stations = self.numbers, self.shaft.bearings
        for axis in (0, 1):
            away = [
                self.displacement(station)[axis] - coupled.journals[bearing][axis]
                for station, bearing in zip(stations, self.bearings, strict=True)
            ]
            for row, (bearing, alike) in enumerate(zip(self.bearings, self.alike, strict=True)):
                load = self.kappa * linear_form(list(numbers.residual[row]), away)
                before = coupled.loads.get(bearing, ZERO)
                one = load / alike
                coupled.loads[bearing] = (one, before[1]) if axis == 0 else (before[0], one)

    # --- rates ---------------------------------------------------------------------------------------------

    def rates(self, coupled: Coupled) -> dict[State, Expr]:
        """Equations of motion of the modes, and of the rotation."""
        made: dict[State, Expr] = {}
        for axis, other, sense in (("x", "y", 1), ("y", "x", -1)):
            made |= dict(zip(self.coordinates(axis), self.rates_of(axis), strict=True))
            for k, rate in enumerate(self.rates_of(axis)):
                made[rate] = self._acceleration(coupled, k, axis, other, sense)
        return made | self._turning(coupled)

    def _acceleration(self, coupled: Coupled, k: int, axis: str, other: str, sense: int) -> Expr:
        n, plane, station_of = self.numbers, "xy".index(axis), dict(zip(self.bearings, self.shaft.bearings, strict=True))
        q, v = self.coordinates(axis)[k], self.rates_of(axis)[k]
        own = number(n.mass[k]) * self.nu  # mass of the mode
        total = -number(n.stiffness[k] / n.mass[k]) * self.kappa / (self.nu * s**2) * q
        for bearing, alike in zip(self.bearings, self.alike, strict=True):
            weight = n.shapes[station_of[bearing], k] * alike / n.mass[k]
            total -= number(weight) / (self.nu * s**2) * coupled.loads[bearing][plane]
        for station, force in coupled.forces.get(self.name, []):
            total += number(n.shapes[station, k] / n.mass[k]) / (self.nu * s**2) * force[plane]
        spin = linear_form(list(n.gyroscopic[k] / n.mass[k]), list(self.rates_of(other)))
        total -= sense * self.r * spin
        if "C" in self.given:
            total -= 2 * self.xi / s * v
        if "zeta" in self.given and n.stiffness[k] > 0:
            total -= 2 * self.zeta / s * sqrt(number(n.stiffness[k]) * self.kappa / own) * v
        if axis == "y":
            total -= number(n.weight[k] / n.mass[k]) * f / s**2
        return total

    def accelerated(self, coupled: Coupled) -> dict[State, Expr]:
        """What an angular acceleration adds to the rates of modes beside the change of the clock, over its relative rate.

        Unbalances lag. The gyroscopic moment has no term of its own: the torque that accelerates a disk acts along the
        disk's axis, and its part across the machine's axis is what d(I_p Omega)/dt needs there.
        """
        made: dict[State, Expr] = {}
        for plane, axis in enumerate("xy"):
            for k, rate in enumerate(self.rates_of(axis)):
                total: Expr = Integer(0)
                for station, force in coupled.accelerated.get(self.name, []):
                    weight = number(self.numbers.shapes[station, k] / self.numbers.mass[k])
                    total += weight / (self.nu * s**2) * force[plane]
                made[rate] = total
        if self.base is not None:
            # Arcs are counted from a rotation that gains speed itself: its inertia J |r| domega/dt acts against it.
            modes, (J, _) = self.shaft.twisting, self.shaft.torsion
            for k, rate in enumerate(self.arc_rates):
                part = float(modes.shapes[:, k] @ J.sum(axis=1) / modes.mass[k])
                made[rate] = -number(part if abs(part) > ROUNDING else 0.0) * Abs(self.r) * self.radius
        return made

    def _turning(self, coupled: Coupled) -> dict[State, Expr]:
        made: dict[State, Expr] = dict(zip(self.arcs, self.arc_rates, strict=True))
        if self.base is None:
            return made
        modes, inertia = self.shaft.twisting, self.shaft.inertia
        for k, (q, v) in enumerate(zip(self.arcs, self.arc_rates, strict=True)):
            part = float(modes.mass[k]) / inertia
            total: Expr = Integer(0)
            for station, moment in coupled.moments.get(self.name, []):
                weight = modes.shapes[self.shaft.turning_station(station), k] / part
                total += number(weight) * moment / (self.iota * s**2)
            if modes.frequency[k] > 0:
                square = number(float(modes.frequency[k]) ** 2) / OMEGA_0_2
                total -= square * q / s**2
                if "zeta" in self.given:
                    total -= 2 * self.zeta / s * sqrt(square) * v
            made[v] = total
        return made

    # --- the rest ------------------------------------------------------------------------------------------

    def declare(self, coupled: Coupled) -> Declared:  # noqa: ARG002 (the same for all parts)
        """Bodies, displacement at stations that have a name, and the clock of its rotation."""
        pairs = list(zip(self.coordinates("x"), self.coordinates("y"), strict=True))
        names = [long for _, long in self._kinds]
        made = Declared(harmonics=[self.r], clocks={self.name: self.r})
        made.sources = [] if self.shaft.lumped else ["macneal1971", "rubin1975", "nelson1980", "cowper1966"]
        made.bodies = {
            self.name if name == "translation" else f"{self.name} {name}": pair
            for name, pair in zip(names, pairs, strict=True)
        }
        for arc, n in zip(self.arcs, self._twists, strict=True):
            made.bodies[f"{self.name} torsion{f' {n}' if n else ''}"] = (arc,)
        if self.shaft.lumped:
            x, y = (self.coordinates(axis)[0] for axis in "xy")
            made.swing.append(y)
            made.stations[self.name] = (x.name, y.name)
        for name, station in () if self.shaft.lumped else self.shown:  # a lumped rotor's displacement is a state
            made.stations[name] = (f"x_{name}", f"y_{name}")
            for axis, e in zip("xy", self.displacement(station), strict=True):
                made.outputs[f"{axis}_{name}"] = Output(e, "1", f"{name} along {axis}, over c_0", "length")
        return made
