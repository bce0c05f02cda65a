"""A support: a mass on springs, linear and cubic, and dampers, which carries bearings."""

from dataclasses import dataclass
from typing import Any

from sympy import Expr

from whirlmap.equations.quantities import Parameter, State
from whirlmap.machines.fields import ABOVE, AT_LEAST, Field, Number, Text
from whirlmap.machines.parts.part import Coupled, Declared
from whirlmap.machines.scale import LENGTH, RATE, Scale, f, s

#: Keys that stand for one of x and one of y.
BOTH = {"k": ("k_x", "k_y"), "k3": ("k3_x", "k3_y"), "c": ("c_x", "c_y")}
FIELDS: tuple[Field, ...] = (
    Text("name", "name of the support", required=True),
    Number("m", "kg", "mass", required=True, limits=ABOVE),
    Number("k_x", "N/m", "stiffness along x", required=True, limits=ABOVE),
    Number("k_y", "N/m", "stiffness along y", required=True, limits=ABOVE),
    Number("k3_x", "N/m^3", "cubic stiffness along x", limits=AT_LEAST),
    Number("k3_y", "N/m^3", "cubic stiffness along y", limits=AT_LEAST),
    Number("c_x", "N*s/m", "damping along x", zero=True, limits=AT_LEAST),
    Number("c_y", "N*s/m", "damping along y", zero=True, limits=AT_LEAST),
)
KEYS = {one.key: one for one in FIELDS if isinstance(one, Number)}


@dataclass(frozen=True)
class Support:
    """One support, or each of several identical ones that move alike.

    Attributes
    ----------
    name : str
    given : frozenset of str
        Keys that the case gives.
    bearings : tuple of str
        Bearings that it carries.
    """

    name: str
    given: frozenset[str]
    bearings: tuple[str, ...]

    def _symbol(self, letter: str, meaning: str, latex: str = "", **limits: Any) -> Parameter:
        latex = rf"{latex or letter}_\mathrm{{{self.name}}}" if letter else ""
        return Parameter(f"{letter}_{self.name}", "1", f"{meaning} of support {self.name}", latex=latex, **limits)

    @property
    def nu(self) -> Parameter:
        """Mass over m_0."""
        return self._symbol("nu", "mass over m_0", r"\nu", above=0)

    def kappa(self, axis: str) -> Parameter:
        """Stiffness over K_0."""
        return self._symbol(f"kappa_{axis}", f"stiffness along {axis} over K_0,", r"\kappa", above=0)

    def a(self, axis: str) -> Parameter:
        """Cubic stiffness, over the mass as the paper's alpha."""
        return self._symbol(f"a_{axis}", f"cubic stiffness along {axis}, k3 c_0^2/(K_0 nu),", "a", at_least=0)

    def xi(self, axis: str) -> Parameter:
        """Damping over that of the reference rotor."""
        return self._symbol(f"xi_{axis}", f"damping along {axis}, c/(2 m_0 omega_0),", r"\xi", at_least=0)

    def groups(self, scale: Scale) -> dict[Parameter, Expr]:
        """Mass, stiffnesses and damping over those of the reference shaft."""
        own = {key: one.parameter(f"support.{self.name}") for key, one in KEYS.items()}
        made: dict[Parameter, Expr] = {self.nu: own["m"] / scale.m_0}
        for axis in "xy":
            made[self.kappa(axis)] = own[f"k_{axis}"] / scale.K_0
            if f"k3_{axis}" in self.given:
                made[self.a(axis)] = own[f"k3_{axis}"] * scale.c_0**2 / (scale.K_0 * self.nu)
            if f"c_{axis}" in self.given:
                made[self.xi(axis)] = own[f"c_{axis}"] / (2 * scale.m_0 * scale.omega_0)
        return made

    @property
    def centre(self) -> tuple[State, State]:
        """Displacement."""
        x, y = (
            State(f"{axis}_{self.name}", LENGTH, f"support {self.name} along {axis}, over c_0", measure="length")
            for axis in "xy"
        )
        return x, y

    @property
    def rate(self) -> tuple[State, State]:
        """Its rate."""
        vx, vy = (
            State(f"v{axis}_{self.name}", RATE, f"rate of {axis}_{self.name}, per clock radian", measure="velocity")
            for axis in "xy"
        )
        return vx, vy

    def unknowns(self) -> tuple[State, ...]:
        """Displacement and rate."""
        return (*self.centre, *self.rate)

    def couple(self, coupled: Coupled) -> None:
        """Its position."""
        coupled.positions[self.name], coupled.velocities[self.name] = self.centre, self.rate

    def rates(self, coupled: Coupled) -> dict[State, Expr]:
        """Newton's law: what reaches it through film, spring and wall is the force of the shafts, (38)-(41) of the paper."""
        made: dict[State, Expr] = {}
        for plane, (axis, q, v) in enumerate(zip("xy", self.centre, self.rate, strict=True)):
            total = -self.kappa(axis) / (self.nu * s**2) * q
            if f"c_{axis}" in self.given:
                total -= 2 * self.xi(axis) / (self.nu * s) * v
            if f"k3_{axis}" in self.given:
                total -= self.a(axis) / s**2 * q**3
            for bearing in self.bearings:
                total += coupled.loads[bearing][plane] / (self.nu * s**2)
            if axis == "y":
                total -= f / s**2
            made |= {q: v, v: total}
        return made

    def declare(self, coupled: Coupled) -> Declared:  # noqa: ARG002 (the same for all parts)
        """Its centre as a body."""
        return Declared(bodies={self.name: self.centre})
