"""A coupling: a torsional spring and damper between a shaft and a machine that turns uniformly, a driver or a load."""

from dataclasses import dataclass

from sympy import Expr

from whirlmap.equations.quantities import Parameter, State
from whirlmap.machines.fields import AT_LEAST, Field, Number, Station, Text
from whirlmap.machines.parts.part import Coupled, Declared
from whirlmap.machines.scale import Scale, s

FIELDS: tuple[Field, ...] = (
    Text("name", "name of the coupling", required=True),
    Text("shaft", "shaft that it turns with", required=True),
    Station("at", "station of the shaft", required=False),
    Number("k_t", "N*m/rad", "torsional stiffness", required=True, limits=AT_LEAST),
    Number("c_t", "N*m*s/rad", "torsional damping", limits=AT_LEAST),
)
KEYS = {one.key: one for one in FIELDS if isinstance(one, Number)}


@dataclass(frozen=True)
class Coupling:
    """One coupling; its twist under the transmitted torque is taken off, for arcs are from the loaded rest.

    Attributes
    ----------
    name, shaft : str
    station : int
    given : frozenset of str
    base : Expr
        Base radius of the shaft's arcs [m].
    """

    name: str
    shaft: str
    station: int
    given: frozenset[str]
    base: Expr

    @property
    def kappa(self) -> Parameter:
        """Stiffness."""
        meaning = f"torsional stiffness of coupling {self.name}, k_t/(K_0 R_b^2)"
        return Parameter(f"kappa_t_{self.name}", "1", meaning, latex=rf"\kappa_\mathrm{{{self.name}}}", at_least=0)

    @property
    def xi(self) -> Parameter:
        """Damping."""
        meaning = f"torsional damping of coupling {self.name}, c_t/(2 m_0 omega_0 R_b^2)"
        return Parameter(f"xi_t_{self.name}", "1", meaning, latex=rf"\xi_\mathrm{{{self.name}}}", at_least=0)

    def groups(self, scale: Scale) -> dict[Parameter, Expr]:
        """Stiffness and damping on the base circle."""
        own = {key: one.parameter(f"coupling.{self.name}") for key, one in KEYS.items()}
        made: dict[Parameter, Expr] = {self.kappa: own["k_t"] / (scale.K_0 * self.base**2)}
        if "c_t" in self.given:
            made[self.xi] = own["c_t"] / (2 * scale.m_0 * scale.omega_0 * self.base**2)
        return made

    def unknowns(self) -> tuple[State, ...]:
        """None."""
        return ()

    def couple(self, coupled: Coupled) -> None:
        """Its moment on the rotation of the shaft."""
        q, rate = coupled.motions[self.shaft].arc(self.station)
        moment = -self.kappa * q
        if "c_t" in self.given:
            moment -= 2 * self.xi * s * rate
        coupled.moments.setdefault(self.shaft, []).append((self.station, moment))

    def rates(self, coupled: Coupled) -> dict[State, Expr]:  # noqa: ARG002 (the same for all parts)
        """None."""
        return {}

    def declare(self, coupled: Coupled) -> Declared:  # noqa: ARG002 (the same for all parts)
        """Nothing else."""
        return Declared()
