"""A journal in its bearing, or the ring of a squeeze-film damper: massless, between the shaft and a support.

The force of the shaft on the journal is known from the positions of both; the film law answers with the journal's velocity,
seen from half its spin: M w = load/(Gamma s), w over the bearing's own clearance.
"""

from dataclasses import dataclass
from typing import Any

from sympy import Expr, Integer, sign, sqrt

from whirlmap.equations.groups import Bearing
from whirlmap.equations.parts import Film, Journal, Output, Stop, Switching
from whirlmap.equations.quantities import Parameter, State
from whirlmap.films.law import FilmLaw, film_law, permeability_fault
from whirlmap.machines.fields import ABOVE, AT_LEAST, Choice, Field, Number, Other, Station, Text
from whirlmap.machines.parts.part import Coupled, Declared
from whirlmap.machines.parts.rotor import speed_over_clock
from whirlmap.machines.scale import LENGTH, Scale, s
from whirlmap.models import rub

FIELDS: tuple[Field, ...] = (
    Text("name", "name of the bearing", required=True),
    Text("shaft", "shaft that turns in it", required=True),
    Station("at", "station of the shaft", required=False),
    Choice(
        "kind",
        ("journal", "damper", "coefficients"),
        "a journal that turns; the ring of a squeeze-film damper, which does not; or by stiffness and damping",
    ),
    Choice(
        "film",
        ("short", "porous", "printed"),
        "short bearing, with a porous ring, or with h^3 dropped as the paper prints it",
    ),
    Choice(
        "arc", ("positive", "fixed"), "Guembel film, where the pressure is positive; or half-Sommerfeld film, fixed at 0..pi"
    ),
    Choice(
        "contact", ("stop", "rub", "ignore"), "whether contact ends the run, is a rub, or is ignored (film = printed alone)"
    ),
    Number("R", "m", "radius", required=True, limits=ABOVE, twice=("D", "d", "D_j", "d_j", "diameter")),
    Number("L", "m", "length", required=True, limits=ABOVE),
    Number("c", "m", "radial clearance", required=True, limits=ABOVE, twice=("C_d", "c_d", "Cd", "diametral_clearance")),
    Number("H", "m", "wall thickness of the porous ring", limits=AT_LEAST),
    Number("Phi", "m^2", "permeability of the porous ring", limits=AT_LEAST),
    Number("k_c", "N/m", "centring spring", limits=AT_LEAST),
    Number("K_r", "N/m", "stiffness of the wall against a rubbing journal", limits=AT_LEAST),
    Number("h_r", "m", "film thickness at which the surfaces touch", limits=ABOVE),
    Number("mu_r", "1", "dry friction coefficient of the rubbing journal", limits=AT_LEAST),
    Text("lubricant", "its lubricant, where there are several"),
    Text("support", "support that carries it; ground where absent"),
    Other("two_alike", "2: it stands for two identical bearings in identical supports that move alike"),
)
KEYS = {one.key: one for one in FIELDS if isinstance(one, Number)}


@dataclass(frozen=True)
class JournalBearing:
    """One bearing, or each of two identical ones.

    Attributes
    ----------
    name, shaft : str
    station : int
    kind, film, arc, contact : str
        Choices of `FIELDS`.
    given : frozenset of str
        Inputs that the case gives.
    lubricant : Parameter
        Viscosity of its oil.
    density : Parameter
    support : str
        Empty for ground.
    alike : int
    """

    name: str
    shaft: str
    station: int
    kind: str
    film: str
    arc: str
    contact: str
    given: frozenset[str]
    lubricant: Parameter
    density: Parameter
    support: str
    alike: int

    def _symbol(self, letter: str, meaning: str, latex: str = "", **limits: Any) -> Parameter:
        latex = rf"{latex or letter}_\mathrm{{{self.name}}}"
        return Parameter(f"{letter}_{self.name}", "1", f"{meaning} of bearing {self.name}", latex=latex, **limits)

    @property
    def Gamma(self) -> Parameter:
        """Film group of one bearing."""
        return self._symbol("Gamma", "film group at s = 1, mu R L^3 omega_0/(c^2 K_0 c_0),", r"\Gamma", above=0)

    @property
    def gamma(self) -> Parameter:
        """Clearance over c_0."""
        return self._symbol("gamma", "clearance over c_0", r"\gamma", above=0)

    @property
    def psi(self) -> Expr:
        """Permeability of the ring; none without one."""
        if self.film == "short":
            return Integer(0)
        return self._symbol("psi", "permeability 12 Phi H/c^3", r"\psi", at_least=0)

    @property
    def kappa_c(self) -> Parameter:
        """Centring spring."""
        return self._symbol("kappa_c", "centring spring over K_0,", r"\kappa_c", at_least=0)

    @property
    def spin(self) -> Expr:
        """Speed of the journal over the clock's."""
        return Integer(0) if self.kind == "damper" else speed_over_clock(self.shaft)

    @property
    def wall(self) -> dict[Parameter, Parameter]:
        """Parameters of the wall, by those of `models.rub`."""
        return {
            rub.eps_r: self._symbol("eps_r", "eccentricity at which the surfaces touch", r"\varepsilon_r", above=0, below=1),
            rub.kappa_r: self._symbol("kappa_r", "stiffness of the wall c/(K_0 c_0),", r"\kappa_r", at_least=0),
            rub.mu_r: self._symbol("mu_r", "dry friction coefficient", r"\mu_r", at_least=0),
        }

    @property
    def law(self) -> FilmLaw:
        """Its film law; a ring with a permeability of its own has a table of its own."""
        own = "" if self.film == "short" else self.name
        return film_law("printed" if self.film == "printed" else "porous", self.arc, plain=self.film == "short", own=own)

    def inputs(self) -> dict[str, Parameter]:
        """Its inputs by their keys."""
        return {key: one.parameter(f"bearing.{self.name}") for key, one in KEYS.items()}

    def groups(self, scale: Scale) -> dict[Parameter, Expr]:
        """Film group, clearance, permeability, springs and wall."""
        own = self.inputs()
        made: dict[Parameter, Expr] = {
            self.Gamma: self.lubricant * own["R"] * own["L"] ** 3 * scale.omega_0 / (own["c"] ** 2 * scale.force),
            self.gamma: own["c"] / scale.c_0,
        }
        if isinstance(self.psi, Parameter):
            made[self.psi] = 12 * own["Phi"] * own["H"] / own["c"] ** 3
        if "k_c" in self.given:
            made[self.kappa_c] = own["k_c"] / scale.K_0
        if self.contact == "rub":
            eps_r, kappa_r, mu_r = self.wall.values()
            made |= {eps_r: 1 - own["h_r"] / own["c"], kappa_r: own["K_r"] * self.gamma / scale.K_0, mu_r: own["mu_r"]}
        return made

    @property
    def _words(self) -> str:
        return f"{'ring' if self.kind == 'damper' else 'journal'} {self.name}"

    @property
    def _around(self) -> str:
        return "housing" if self.kind == "damper" else "bearing"

    @property
    def u(self) -> tuple[State, State]:
        """Journal relative to its bearing."""
        inside = f"{self._words} in its {self._around}"
        ux, uy = (
            State(f"u{axis}_{self.name}", LENGTH, f"{inside} along {axis}, over c_0", measure="length") for axis in "xy"
        )
        return ux, uy

    @property
    def _in_clearance(self) -> tuple[Expr, Expr]:
        ux, uy = self.u
        return ux / self.gamma, uy / self.gamma

    def unknowns(self) -> tuple[State, ...]:
        """Its journal."""
        return self.u

    def couple(self, coupled: Coupled) -> None:
        """Its position in space: that of the support and its own in it."""
        (x, y), (ux, uy) = coupled.positions[self.support], self.u
        coupled.journals[self.name] = (x + ux, y + uy)

    def film_load(self, coupled: Coupled) -> tuple[Expr, Expr]:
        """Force that the film has to carry, over K_0 c_0: that of the shaft less those of centring spring and wall."""
        (l_x, l_y), (ux, uy) = coupled.loads[self.name], self.u
        if "k_c" in self.given:
            l_x, l_y = l_x - self.kappa_c * ux, l_y - self.kappa_c * uy
        if self.contact == "rub":
            n_x, n_y = (e.xreplace(self.wall) for e in rub.wall_force(*self._in_clearance, sign(self.spin)))
            l_x, l_y = l_x + n_x, l_y + n_y
        return l_x, l_y

    def rates(self, coupled: Coupled) -> dict[State, Expr]:
        """Force balance of the massless journal, (30)-(33) of the paper."""
        ux, uy = self.u
        l_x, l_y = self.film_load(coupled)
        w_x, w_y = self.law.velocity(
            *self._in_clearance, l_x / (self.Gamma * s), l_y / (self.Gamma * s), self.psi, sign(self.spin)
        )
        return {ux: -self.spin * uy / 2 + self.gamma * w_x, uy: self.spin * ux / 2 + self.gamma * w_y}

    def bearing(self) -> Bearing:
        """What film laws assume of it is judged by these inputs."""
        own = self.inputs()
        return Bearing(own["R"], own["L"], own["c"], self.lubricant, self.density, self.spin, f"eps_{self.name}", self.psi)

    def declare(self, coupled: Coupled) -> Declared:
        """Eccentricity, load, contact, film and journal."""
        (ex, ey), (l_x, l_y), name = self._in_clearance, self.film_load(coupled), self.name
        made = Declared(
            outputs={
                f"eps_{name}": Output(sqrt(ex**2 + ey**2), "1", f"eccentricity of {self._words}", "", "eccentricity", name),
                f"load_{name}": Output(
                    sqrt(l_x**2 + l_y**2), "1", f"force of the film of {self._words}, over K_0 c_0", "force", "load", name
                ),
            },
            journals={name: Journal(self.u, self.spin, self.gamma)},
            bodies={self._words: self.u},
            stations={name: (self.u[0].name, self.u[1].name)},
            swing=[self.u[1]],
            tables=list(self.law.tables),
            start_where_none={self.u[0]: 0.1},
            sources=["capone1991", *(["morgan1957"] if self.film == "porous" else [])],
        )
        if self.film != "printed" and self.kind == "journal":
            made.films = {name: Film(self.u, self.psi, self.spin, self.Gamma * s / 2, self.gamma)}
        if isinstance(self.psi, Parameter) and self.film == "porous":
            psi = self.psi.name
            made.checks.append(lambda values: permeability_fault({"psi": values[psi]}))
        if self.contact != "ignore":
            wall = f"{'is pressed through to' if self.contact == 'rub' else 'touches'} its {self._around}"
            reachable = {"short": 0 * s, "porous": self.psi, "printed": Integer(1)}[self.film]
            made.stops = {f"contact_{name}": Stop(1 - ex**2 - ey**2, f"{self._words} {wall}", reachable)}
        if self.contact == "rub":
            touch = sqrt(ex**2 + ey**2) - self.wall[rub.eps_r]
            made.switchings = {f"rub_{name}": Switching(touch, f"{self._words} rubs its {self._around}")}
            made.sources.append("chu1998")
        return made
