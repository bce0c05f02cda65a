"""A coupling: springs and dampers between a shaft and another one, or a driver or a load that turns uniformly.

It holds the rotation (torsion), the displacement across the axis (lateral), or both. Two coupled shafts turn at one speed;
what turns uniformly stands still across the axis.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from sympy import Expr

from whirlmap.equations.quantities import Parameter, State
from whirlmap.machines.fields import AT_LEAST, Field, Number, Station, Text
from whirlmap.machines.parts.part import ZERO, Coupled, Declared
from whirlmap.machines.scale import Scale, s

FIELDS: tuple[Field, ...] = (
    Text("name", "name of the coupling", required=True),
    Text("shaft", "shaft that it turns with", required=True),
    Station("at", "station of the shaft", required=False),
    Text("to", "the other shaft; a driver or a load that turns uniformly where absent"),
    Station("at_to", "station of the other shaft", required=False),
    Number("k_t", "N*m/rad", "torsional stiffness", limits=AT_LEAST),
    Number("c_t", "N*m*s/rad", "torsional damping", zero=True, limits=AT_LEAST),
    Number("k_r", "N/m", "lateral stiffness", limits=AT_LEAST),
    Number("c_r", "N*s/m", "lateral damping", zero=True, limits=AT_LEAST),
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
        Base radius of the arcs of both shafts [m].
    to : str
        The other shaft; empty for a machine that turns uniformly.
    at_to : int
    """

    name: str
    shaft: str
    station: int
    given: frozenset[str]
    base: Expr
    to: str = ""
    at_to: int = 0

    def ends(self) -> Iterator[tuple[str, int, int]]:
        """Shaft, station and sign of each end in the deflection of the coupling."""
        yield self.shaft, self.station, 1
        if self.to:
            yield self.to, self.at_to, -1

    def _symbol(self, letter: str, latex: str, meaning: str) -> Parameter:
        meaning = meaning.format(f"coupling {self.name}")
        return Parameter(f"{letter}_{self.name}", "1", meaning, latex=rf"{latex}_\mathrm{{{self.name}}}", at_least=0)

    @property
    def kappa(self) -> Parameter:
        """Torsional stiffness."""
        return self._symbol("kappa_t", r"\kappa", "torsional stiffness of {}, k_t/(K_0 R_b^2)")

    @property
    def xi(self) -> Parameter:
        """Torsional damping."""
        return self._symbol("xi_t", r"\xi", "torsional damping of {}, c_t/(2 m_0 omega_0 R_b^2)")

    @property
    def kappa_r(self) -> Parameter:
        """Lateral stiffness."""
        return self._symbol("kappa_r", r"\kappa", "lateral stiffness of {}, k_r/K_0")

    @property
    def xi_r(self) -> Parameter:
        """Lateral damping."""
        return self._symbol("xi_r", r"\xi", "lateral damping of {}, c_r/(2 m_0 omega_0)")

    def groups(self, scale: Scale) -> dict[Parameter, Expr]:
        """Stiffness and damping, of the torsion on the base circle."""
        own = {key: one.parameter(f"coupling.{self.name}") for key, one in KEYS.items()}
        damping = 2 * scale.m_0 * scale.omega_0
        every = {
            "k_t": (self.kappa, scale.K_0 * self.base**2), "c_t": (self.xi, damping * self.base**2),
            "k_r": (self.kappa_r, scale.K_0), "c_r": (self.xi_r, damping),
        }  # fmt: skip
        return {parameter: own[key] / unit for key, (parameter, unit) in every.items() if key in self.given}

    def unknowns(self) -> tuple[State, ...]:
        """None."""
        return ()

    def _law(self, stiff: str, damped: str, stiffness: Parameter, damping: Parameter, q: Expr, rate: Expr) -> Expr:
        force = -stiffness * q if stiff in self.given else 0 * q
        return force - 2 * damping * s * rate if damped in self.given else force

    def couple(self, coupled: Coupled) -> None:
        """Its moment on the rotation of both shafts, and its force across them."""
        arcs, places, rates = [ZERO, ZERO], [ZERO, ZERO], [ZERO, ZERO]
        for i, (shaft, station, _) in enumerate(self.ends()):
            motion = coupled.motions[shaft]
            arcs[i], places[i], rates[i] = motion.arc(station), motion.displacement(station), motion.velocity(station)
        if "k_t" in self.given:
            (q, v), (q_to, v_to) = arcs
            moment = self._law("k_t", "c_t", self.kappa, self.xi, q - q_to, v - v_to)
            for shaft, station, sign in self.ends():
                coupled.moments.setdefault(shaft, []).append((station, sign * moment))
        if {"k_r", "c_r"} & self.given:
            f_x, f_y = (
                self._law("k_r", "c_r", self.kappa_r, self.xi_r, places[0][i] - places[1][i], rates[0][i] - rates[1][i])
                for i in (0, 1)
            )
            for shaft, station, sign in self.ends():
                coupled.forces.setdefault(shaft, []).append((station, (sign * f_x, sign * f_y)))

    def rates(self, coupled: Coupled) -> dict[State, Expr]:  # noqa: ARG002 (the same for all parts)
        """None."""
        return {}

    def declare(self, coupled: Coupled) -> Declared:  # noqa: ARG002 (the same for all parts)
        """Nothing else."""
        return Declared()
