"""A bearing by its coefficients: stiffness and damping, constant or in a table against the speed of its shaft.

Its force acts on the station of the shaft directly, for it has no journal of its own::

    load = K(Omega) u + C(Omega) du/dt,        u = (station) - (support)

Between the speeds of a table each coefficient follows a monotone cubic (PCHIP), which has no extremes of its own, so that no
damping between two positive ones is negative. Outside of its speeds a table says nothing, and a speed there is refused.
Source: Fritsch and Carlson 1980 [fritsch1980].
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from sympy import Abs, Expr, Float, Integer, Rational

from whirlmap.equations.parts import Output
from whirlmap.equations.pieces import when
from whirlmap.equations.quantities import Parameter, State
from whirlmap.machines.fields import ABOVE, Choice, Field, Number, Other, Station, Text
from whirlmap.machines.parts.part import Coupled, Declared, Vector
from whirlmap.machines.parts.rotor import speed_over_clock
from whirlmap.machines.scale import Scale, s

if TYPE_CHECKING:
    from scipy.interpolate import PchipInterpolator

DIRECTIONS = ("xx", "xy", "yx", "yy")
STIFFNESS = tuple(f"k_{ij}" for ij in DIRECTIONS)
DAMPING = tuple(f"c_{ij}" for ij in DIRECTIONS)
#: What every bearing has; many have no coupling of x and y.
DIRECT = ("k_xx", "k_yy", "c_xx", "c_yy")
COEFFICIENTS: tuple[Number, ...] = (
    *(
        Number(key, "N/m", f"stiffness, force along {key[2]} for a displacement along {key[3]},", zero=key in DIRECT)
        for key in STIFFNESS
    ),
    *(
        Number(key, "N*s/m", f"damping, force along {key[2]} for a velocity along {key[3]},", zero=key in DIRECT)
        for key in DAMPING
    ),
)
FIELDS: tuple[Field, ...] = (
    Text("name", "name of the bearing", required=True),
    Text("shaft", "shaft that turns in it", required=True),
    Station("at", "station of the shaft", required=False),
    Choice("kind", ("coefficients",), "a bearing by its stiffness and damping"),
    *COEFFICIENTS,
    Other("table", "rows of speed and coefficients, the slowest first"),
    Text("support", "support that carries it; ground where absent"),
    Other("two_alike", "2: it stands for two identical bearings in identical supports that move alike"),
)
#: What a row of a table may say; its numbers are part of the equations.
ROW: tuple[Field, ...] = (
    Number("speed", "rad/s", "speed of the shaft in a row of the table", required=True, fixed=True, limits=ABOVE),
    *(Number(one.key, one.unit, one.meaning, fixed=True) for one in COEFFICIENTS),
)
KEYS = {one.key: one for one in COEFFICIENTS}
#: How far beyond the ends of a table a speed may be, over the highest: rounding.
BEYOND = 1e-9


@dataclass(frozen=True)
class CoefficientBearing:
    """One bearing by its coefficients, or each of two identical ones.

    Attributes
    ----------
    name, shaft : str
    station : int
    given : frozenset of str
        Constant coefficients that the case gives.
    speeds : tuple of float
        Speeds of the table [rad/s], ascending; empty for constant coefficients.
    table : tuple of (str, tuple of float)
        Coefficients in the table by their keys, one value for each speed [N/m, N s/m].
    support : str
        Empty for ground.
    alike : int
    """

    name: str
    shaft: str
    station: int
    given: frozenset[str]
    speeds: tuple[float, ...]
    table: tuple[tuple[str, tuple[float, ...]], ...]
    support: str
    alike: int

    def _symbol(self, letter: str, meaning: str, latex: str, **limits: Any) -> Parameter:
        latex = rf"{latex}_\mathrm{{{self.name}}}"
        return Parameter(f"{letter}_{self.name}", "1", f"{meaning} of bearing {self.name}", latex=latex, **limits)

    def constant(self, key: str) -> Parameter:
        """A constant coefficient without dimensions."""
        ij = key[2:]
        if key in STIFFNESS:
            return self._symbol(f"kappa_{ij}", f"stiffness k_{ij}/K_0", rf"\kappa_{{{ij}}}")
        return self._symbol(f"xi_{ij}", f"damping c_{ij}/(2 m_0 omega_0)", rf"\xi_{{{ij}}}")

    @property
    def sigma(self) -> Parameter:
        """Speed at which s = 1, over the highest speed of the table."""
        return self._symbol("sigma", "omega_0 over the highest speed in the table", r"\sigma", above=0)

    @property
    def kappa(self) -> Parameter:
        """Largest stiffness of the table."""
        return self._symbol("kappa", "largest stiffness in the table over K_0,", r"\kappa", at_least=0)

    @property
    def xi(self) -> Parameter:
        """Largest damping of the table."""
        return self._symbol("xi", "largest damping in the table over 2 m_0 omega_0,", r"\xi", at_least=0)

    def _largest(self, keys: tuple[str, ...]) -> float:
        return max((abs(v) for key, values in self.table if key in keys for v in values), default=0.0)

    def groups(self, scale: Scale) -> dict[Parameter, Expr]:
        """Coefficients over those of the scale."""
        part, made = f"bearing.{self.name}", dict[Parameter, Expr]()
        unit = {"k": scale.K_0, "c": 2 * scale.m_0 * scale.omega_0}
        if self.speeds:
            made[self.sigma] = scale.omega_0 / Rational(self.speeds[-1])
            made[self.kappa] = Rational(self._largest(STIFFNESS)) / unit["k"]
            made[self.xi] = Rational(self._largest(DAMPING)) / unit["c"]
            return made
        for key in (*STIFFNESS, *DAMPING):
            if key in self.given:
                made[self.constant(key)] = KEYS[key].parameter(part) / unit[key[0]]
        return made

    # --- coefficients against speed ------------------------------------------------------------------------

    @property
    def at_speed(self) -> Expr:
        """Speed of its shaft over the highest one in the table."""
        return Abs(speed_over_clock(self.shaft)) * s * self.sigma

    @cached_property
    def curves(self) -> "dict[str, PchipInterpolator]":
        """Coefficients over the largest of their kind, against `at_speed`."""
        from scipy.interpolate import PchipInterpolator  # other cases start without it

        knots = np.array(self.speeds) / self.speeds[-1]
        largest = {"k": self._largest(STIFFNESS), "c": self._largest(DAMPING)}
        return {
            key: PchipInterpolator(knots, np.array(values) / largest[key[0]], extrapolate=False)
            for key, values in self.table if any(values)
        }  # fmt: skip

    def coefficient(self, key: str) -> Expr:
        """A coefficient without dimensions, an expression of the speed where there is a table."""
        if not self.speeds:
            return self.constant(key) if key in self.given else Integer(0)
        if key not in self.curves:
            return Integer(0)
        curve, w = self.curves[key], self.at_speed
        pieces = [
            sum((Float(a) * (w - Float(x)) ** n for n, a in enumerate(reversed(curve.c[:, i])) if a), Integer(0))
            for i, x in enumerate(curve.x[:-1])
        ]
        found = pieces[-1]
        for i in reversed(range(len(pieces) - 1)):
            found = when(w < Float(curve.x[i + 1]), pieces[i], found)
        return (self.kappa if key in STIFFNESS else self.xi) * found

    def stiffness(self, of: Callable[[Expr], NDArray[np.float64]]) -> NDArray[np.float64]:
        """Stiffness without dimensions as numbers, shape (point, 2, 2); ``of`` evaluates an expression at the points."""
        return np.stack([of(self.coefficient(key)) for key in STIFFNESS], axis=-1).reshape(-1, 2, 2)

    def damping(self, of: Callable[[Expr], NDArray[np.float64]]) -> NDArray[np.float64]:
        """Damping without dimensions as numbers, shape (point, 2, 2)."""
        return np.stack([of(self.coefficient(key)) for key in DAMPING], axis=-1).reshape(-1, 2, 2)

    def speed_fault(self, values: Mapping[str, float]) -> str:
        """Say that the speed of its shaft is not in the table; empty where it is."""
        if not self.speeds:
            return ""
        sigma = values[self.sigma.name]
        at = abs(values[speed_over_clock(self.shaft).name]) * values[s.name] * sigma
        if self.speeds[0] / self.speeds[-1] - BEYOND <= at <= 1 + BEYOND:
            return ""
        rpm = 30 / np.pi
        low, high = self.speeds[0] * rpm, self.speeds[-1] * rpm
        return (
            f"bearing {self.name}: table: found the speed {at * high:.6g} rpm of shaft {self.shaft}, expected one within the"
            f" table, {low:.6g} to {high:.6g} rpm"
        )

    # --- passes --------------------------------------------------------------------------------------------

    def unknowns(self) -> tuple[State, ...]:
        """None: it has no journal of its own."""
        return ()

    def _load(self, coupled: Coupled) -> Vector:
        """Force of the shaft on one bearing, over K_0 c_0."""
        motion = coupled.motions[self.shaft]
        u = [a - b for a, b in zip(motion.displacement(self.station), coupled.positions[self.support], strict=True)]
        v = [a - b for a, b in zip(motion.velocity(self.station), coupled.velocities[self.support], strict=True)]
        load = []
        for i in "xy":
            total: Expr = Integer(0)
            for j, q, rate in zip("xy", u, v, strict=True):
                total += self.coefficient(f"k_{i}{j}") * q + 2 * s * self.coefficient(f"c_{i}{j}") * rate
            load.append(total)
        return load[0], load[1]

    def couple(self, coupled: Coupled) -> None:
        """Its force on the shaft, and on its support."""
        l_x, l_y = coupled.loads[self.name] = self._load(coupled)
        force = (-self.alike * l_x, -self.alike * l_y)
        coupled.forces.setdefault(self.shaft, []).append((self.station, force))

    def rates(self, coupled: Coupled) -> dict[State, Expr]:  # noqa: ARG002 (the same for all parts)
        """None."""
        return {}

    def declare(self, coupled: Coupled) -> Declared:
        """Its load, and speeds of its table."""
        l_x, l_y = coupled.loads[self.name]
        meaning = f"force of bearing {self.name}, over K_0 c_0"
        size = (l_x**2 + l_y**2) ** Rational(1, 2)
        made = Declared(outputs={f"load_{self.name}": Output(size, "1", meaning, "force", "load", self.name)})
        if self.speeds:
            made.checks, made.sources = [self.speed_fault], ["fritsch1980"]
        return made
