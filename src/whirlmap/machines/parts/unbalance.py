"""An unbalance: a mass off the axis at a station, in its plane, with its phase."""

from dataclasses import dataclass

from sympy import Expr, cos, sin

from whirlmap.equations.quantities import Parameter, State, t
from whirlmap.machines.fields import AT_LEAST, Field, Number, Station, Text
from whirlmap.machines.parts.part import Coupled, Declared
from whirlmap.machines.parts.rotor import mass_ratio, quantity, speed_over_clock
from whirlmap.machines.scale import Scale, s

FIELDS: tuple[Field, ...] = (
    Text("name", "name of the unbalance"),
    Text("shaft", "shaft that it is on", required=True),
    Station("at", "station of the shaft", required=False),
    Number("U", "kg*m", "unbalance, mass times eccentricity", limits=AT_LEAST),
    Number("e", "m", "eccentricity of the shaft's whole mass", limits=AT_LEAST),
    Number("G", "m/s", "balance quality grade, e omega at the highest speed of the shaft", limits=AT_LEAST),
    Number("phase", "rad", "angle of the unbalance at time zero, from x to y"),
)
KEYS = {one.key: one for one in FIELDS if isinstance(one, Number)}


@dataclass(frozen=True)
class Unbalance:
    """One plane of unbalance.

    Attributes
    ----------
    name, shaft : str
    station : int
    given : frozenset of str
    """

    name: str
    shaft: str
    station: int
    given: frozenset[str]

    @property
    def b(self) -> Parameter:
        """Eccentricity of the shaft's mass over c_0."""
        meaning = f"unbalance {self.name}, U/(m c_0) with the mass of {self.shaft}"
        return Parameter(f"b_{self.name}", "1", meaning, latex=rf"b_\mathrm{{{self.name}}}", measure="length", at_least=0)

    @property
    def chi(self) -> Parameter:
        """Phase."""
        return Parameter(f"chi_{self.name}", "rad", f"phase of unbalance {self.name}", latex=rf"\chi_\mathrm{{{self.name}}}")

    def inputs(self) -> dict[str, Parameter]:
        """Its inputs by their keys."""
        return {key: one.parameter(f"unbalance.{self.name}") for key, one in KEYS.items()}

    def groups(self, scale: Scale) -> dict[Parameter, Expr]:
        """Eccentricity and phase."""
        own = self.inputs()
        made: dict[Parameter, Expr] = {self.b: own["U"] / (quantity(self.shaft, "m") * scale.c_0)}
        return made | ({self.chi: own["phase"]} if "phase" in self.given else {})

    def unknowns(self) -> tuple[State, ...]:
        """None."""
        return ()

    def couple(self, coupled: Coupled) -> None:
        """A force that turns with the shaft, U omega^2."""
        r = speed_over_clock(self.shaft)
        angle = r * t + (self.chi if "phase" in self.given else 0)
        size = mass_ratio(self.shaft) * self.b * r**2 * s**2
        coupled.forces.setdefault(self.shaft, []).append((self.station, (size * cos(angle), size * sin(angle))))
        lag = mass_ratio(self.shaft) * self.b * r * s**2
        coupled.accelerated.setdefault(self.shaft, []).append((self.station, (lag * sin(angle), -lag * cos(angle))))

    def rates(self, coupled: Coupled) -> dict[State, Expr]:  # noqa: ARG002 (the same for all parts)
        """None."""
        return {}

    def declare(self, coupled: Coupled) -> Declared:  # noqa: ARG002 (the same for all parts)
        """Its size, which is to be small against a clearance."""
        return Declared(unbalances={f"{self.shaft}, {self.name}": self.b})
