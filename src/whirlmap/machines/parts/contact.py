"""A rub: a shaft that touches its casing, a seal or a labyrinth at a station, with dry friction.

Beyond its clearance the casing pushes the shaft back with a linear stiffness, and the surface, which slides with the
rotation, is held back by dry friction::

    N = K_r (r - clearance),      F = -N r/|r| - mu_r N (direction of the sliding surface),      r > clearance

The surface slides with the rotation: its speed R Omega is far above that of the shaft's centre, so that the direction of
friction does not reverse. The force has a kink where contact begins, and no jump. Source: Chu and Zhang 1998 [chu1998].
"""

from dataclasses import dataclass
from typing import Any

from sympy import Expr, sign, sqrt

from whirlmap.equations.parts import Output, Switching
from whirlmap.equations.quantities import Parameter, State
from whirlmap.machines.fields import ABOVE, AT_LEAST, Field, Number, Station, Text
from whirlmap.machines.parts.part import Coupled, Declared, Vector
from whirlmap.machines.parts.rotor import speed_over_clock
from whirlmap.machines.scale import Scale
from whirlmap.models import rub

FIELDS: tuple[Field, ...] = (
    Text("name", "name of the rub", required=True),
    Text("shaft", "shaft that touches", required=True),
    Station("at", "station of the shaft", required=False),
    Number("clearance", "m", "radial clearance between shaft and casing", required=True, limits=ABOVE),
    Number("K_r", "N/m", "stiffness of the casing", required=True, limits=AT_LEAST),
    Number("mu_r", "1", "dry friction coefficient of shaft on casing", zero=True, limits=AT_LEAST),
    Text("support", "support that carries the casing; ground where absent"),
)
KEYS = {one.key: one for one in FIELDS if isinstance(one, Number)}


@dataclass(frozen=True)
class Rub:
    """One place at which a shaft may touch.

    Attributes
    ----------
    name, shaft : str
    station : int
    given : frozenset of str
    support : str
        Empty for ground.
    """

    name: str
    shaft: str
    station: int
    given: frozenset[str]
    support: str

    def _symbol(self, letter: str, meaning: str, latex: str, **limits: Any) -> Parameter:
        latex = rf"{latex}_\mathrm{{{self.name}}}"
        return Parameter(f"{letter}_{self.name}", "1", f"{meaning} of rub {self.name}", latex=latex, **limits)

    @property
    def gamma(self) -> Parameter:
        """Clearance over c_0."""
        return self._symbol("gamma", "clearance over c_0", r"\gamma", above=0)

    @property
    def kappa(self) -> Parameter:
        """Stiffness of the casing over K_0."""
        return self._symbol("kappa_r", "stiffness of the casing over K_0,", r"\kappa", at_least=0)

    @property
    def mu(self) -> Parameter:
        """Friction coefficient."""
        return self._symbol("mu_r", "dry friction coefficient", r"\mu", at_least=0)

    def groups(self, scale: Scale) -> dict[Parameter, Expr]:
        """Clearance, stiffness and friction."""
        own = {key: one.parameter(f"rub.{self.name}") for key, one in KEYS.items()}
        made = {self.gamma: own["clearance"] / scale.c_0, self.kappa: own["K_r"] / scale.K_0}
        return made | ({self.mu: own["mu_r"]} if "mu_r" in self.given else {})

    def unknowns(self) -> tuple[State, ...]:
        """None."""
        return ()

    def displacement(self, coupled: Coupled) -> Vector:
        """Shaft from the centre of its casing, over c_0."""
        (x, y), (x_0, y_0) = coupled.motions[self.shaft].displacement(self.station), coupled.positions[self.support]
        return x - x_0, y - y_0

    def force(self, coupled: Coupled) -> Vector:
        """Force on the shaft, over K_0 c_0."""
        friction = self.mu if "mu_r" in self.given else 0
        own = {rub.eps_r: self.gamma, rub.kappa_r: self.kappa, rub.mu_r: friction}
        f_x, f_y = rub.wall_force(*self.displacement(coupled), sign(speed_over_clock(self.shaft)))
        return f_x.xreplace(own), f_y.xreplace(own)

    def couple(self, coupled: Coupled) -> None:
        """Its force on the shaft, and the opposite one on its support."""
        f_x, f_y = self.force(coupled)
        coupled.forces.setdefault(self.shaft, []).append((self.station, (f_x, f_y)))
        coupled.loads[self.name] = (-f_x, -f_y)

    def rates(self, coupled: Coupled) -> dict[State, Expr]:  # noqa: ARG002 (the same for all parts)
        """None."""
        return {}

    def declare(self, coupled: Coupled) -> Declared:
        """How far it is from touching, its force, and the surface of contact."""
        (x, y), (f_x, f_y) = self.displacement(coupled), self.force(coupled)
        away = sqrt(x**2 + y**2)
        return Declared(
            outputs={
                f"gap_{self.name}": Output(self.gamma - away, "1", f"gap of rub {self.name}, over c_0", "length"),
                f"force_{self.name}": Output(
                    sqrt(f_x**2 + f_y**2), "1", f"force of rub {self.name}, over K_0 c_0", "force"
                ),
            },
            switchings={f"rub_{self.name}": Switching(away - self.gamma, f"the shaft rubs at {self.name}")},
            sources=["chu1998"],
        )
