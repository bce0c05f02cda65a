"""The teeth of a mesh: one spring and damper between two shafts, isotropic or along the line of action.

Its laws are those of `models.mesh`, with parameters of this mesh's own. The force W acts on the driven shaft, and its
opposite on the driver, along the direction phi_m in which the driver's teeth push: ahead of their motion for a positive
torque. See docs/parts.md.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from sympy import Abs, Expr, Integer, cos, pi, sin

from whirlmap.equations.parts import Switching
from whirlmap.equations.quantities import Parameter, State, t
from whirlmap.machines.fields import ABOVE, AT_LEAST, Choice, Field, Number, Other, Text
from whirlmap.machines.parts.part import Coupled, Declared
from whirlmap.machines.scale import Scale, s
from whirlmap.machines.train import driving
from whirlmap.models import mesh

FIELDS: tuple[Field, ...] = (
    Text("name", "name of the mesh", required=True),
    Text("driver", "driving shaft", required=True),
    Text("driven", "driven shaft", required=True),
    Other("at", "stations of the driver and of the driven shaft"),
    Other("z", "teeth of the driver and of the driven wheel", required=True),
    Choice(
        "kind", ("line", "isotropic"), "along the line of action with a torque, or the paper's, without direction or load"
    ),
    Choice("stiffness", ("constant", "fourier", "rectangular"), "constant, a Fourier series, or one pair of teeth and two"),
    Choice("backlash", ("none", "dead_zone"), "teeth without play, or that leave each other inside a dead zone"),
    Number("z_driver", "1", "teeth of the driver", limits={"above": 0, "order": True}),
    Number("z_driven", "1", "teeth of the driven wheel", limits={"above": 0, "order": True}),
    Number("module", "m", "transverse module of the teeth", limits=ABOVE),
    Number("alpha", "rad", "transverse pressure angle", limits={"at_least": 0, "below": float(pi / 2)}),
    Number("beta_c", "rad", "direction from the driver to the driven shaft, from x"),
    Number("K_m", "N/m", "mesh stiffness", required=True, limits=AT_LEAST),
    Number("C_m", "N*s/m", "mesh damping", zero=True, limits=AT_LEAST),
    Number("e_TE", "m", "static transmission error", zero=True),
    Number("T", "N*m", "torque into the driver along its rotation; negative where the driven shaft drives"),
    Number("P", "W", "power from the driver at speed_P; negative where the driven shaft drives"),
    Number("speed_P", "rad/s", "speed of the reference shaft for which P is given; speed_max where absent", limits=ABOVE),
    Number("j_n", "m", "backlash along the line of action", limits=ABOVE),
    *(Number(p.name, p.unit, p.meaning) for p in (mesh.v_1, mesh.v_2, mesh.v_3, mesh.chi_1, mesh.chi_2, mesh.chi_3)),
    Number("CR", "1", "contact ratio of spur teeth", limits={"above": 1, "below": 2}),
    Number("v_m", "1", "step between one pair and two, over the mean mesh stiffness", limits=AT_LEAST),
    Number("chi_m", "rad", "mesh phase at which two pairs are half through"),
)
#: What is wrong with a whole set of values.
Check = Callable[[Mapping[str, float]], str]
KEYS = {one.key: one for one in FIELDS if isinstance(one, Number)}


@dataclass(frozen=True)
class Wheel:
    """One of the two wheels: its shaft and station, its base radius, and that on which arcs of the shaft are measured."""

    shaft: str
    station: int
    base: Expr
    reference: Expr

    def ratio(self, mesh: str) -> Expr:
        """Base radius over that of the shaft's arcs."""
        if self.base == self.reference:
            return Integer(1)
        meaning = f"base radius of {self.shaft} in mesh {mesh} over that of its arcs"
        return Parameter(f"rho_{mesh}_{self.shaft}", "1", meaning, above=0)


@dataclass(frozen=True)
class Teeth:
    """One mesh.

    Attributes
    ----------
    name : str
    driver, driven : Wheel
    kind, stiffness, backlash : str
        Choices of `FIELDS`.
    given : frozenset of str
    sense : int
        1 where the driver turns from x to y.
    turning : bool
        Whether the rotation of the shafts counts.
    phase : Expr
        Mesh phase at time zero, of inputs.
    """

    name: str
    driver: Wheel
    driven: Wheel
    kind: str
    stiffness: str
    backlash: str
    given: frozenset[str]
    sense: int
    turning: bool
    phase: Expr

    def _symbol(self, letter: str, unit: str, meaning: str, latex: str = "", **more: Any) -> Parameter:
        latex = rf"{latex or letter}_\mathrm{{{self.name}}}"
        return Parameter(f"{letter}_{self.name}", unit, f"{meaning} of mesh {self.name}", latex=latex, **more)

    @property
    def r(self) -> Parameter:
        """Tooth-passing frequency over the clock's speed."""
        return self._symbol("r", "1", "tooth-passing frequency over clock speed", order=True)

    @property
    def Lambda(self) -> Parameter:
        """Mesh stiffness."""
        return self._symbol("Lambda", "1", "stiffness K_m/K_0", r"\Lambda", at_least=0)

    @property
    def xi(self) -> Parameter:
        """Mesh damping."""
        return self._symbol("xi", "1", "damping C_m/(2 m_0 omega_0)", r"\xi", at_least=0)

    @property
    def E(self) -> Parameter:
        """Transmission error."""
        return self._symbol("E", "1", "static transmission error over c_0", measure="length")

    @property
    def theta(self) -> Parameter:
        """Phase at time zero."""
        return self._symbol("theta", "rad", "phase at time zero", r"\theta")

    @property
    def tau(self) -> Parameter:
        """Which flanks touch."""
        return self._symbol("tau", "1", "sign of the torque, 1 where the driver drives or none does,", r"\tau")

    @property
    def own(self) -> dict[Parameter, Parameter]:
        """Parameters of this mesh, by those of `models.mesh`."""
        shared = (mesh.F_0, mesh.phi_m, mesh.v_1, mesh.v_2, mesh.v_3, mesh.chi_1, mesh.chi_2, mesh.chi_3)
        return {
            p: Parameter(
                f"{p.name}_{self.name}", p.unit, f"{p.meaning}, mesh {self.name}", measure=p.measure, above=p.above,
                at_least=p.at_least, below=p.below,
            )
            for p in (*shared, mesh.CR, mesh.v_m, mesh.chi_m, mesh.B_m)
        }  # fmt: skip

    def inputs(self) -> dict[str, Parameter]:
        """Its inputs by their keys."""
        return {key: one.parameter(f"mesh.{self.name}") for key, one in KEYS.items()}

    def groups(self, scale: Scale) -> dict[Parameter, Expr]:
        """Parameters of the mesh; its frequency follows from the teeth."""
        given, own = self.inputs(), self.own
        made: dict[Parameter, Expr] = {self.Lambda: given["K_m"] / scale.K_0}
        if "C_m" in self.given:
            made[self.xi] = given["C_m"] / (2 * scale.m_0 * scale.omega_0)
        if "e_TE" in self.given:
            made[self.E] = given["e_TE"] / scale.c_0
        if self._phased:
            made[self.theta] = self.phase
        if self.kind == "line":
            base = given["module"] * given["z_driver"] * cos(given["alpha"]) / 2
            made[own[mesh.F_0]] = Abs(given["T"]) / (base * scale.force)
            # The flank that pushes: ahead of the driver's motion, or behind it where the driven shaft drives.
            made[own[mesh.phi_m]] = given["beta_c"] + self.sense * driving(given["T"]) * (pi / 2 - given["alpha"])
            reads = mesh.reads(self.stiffness, "none").parameters[2:]
            made |= {own[p]: given[p.name] for p in reads if p.name in self.given}
        if self.backlash == "dead_zone":
            made[own[mesh.B_m]] = given["j_n"] / scale.c_0
        if self.turning:
            made[self.tau] = driving(given["T"])
            for wheel in (self.driver, self.driven):
                if isinstance(ratio := wheel.ratio(self.name), Parameter):
                    made[ratio] = wheel.base / wheel.reference
        return made

    @property
    def _phased(self) -> bool:
        """Whether its phase matters: another mesh is there to be compared with, and something varies with it."""
        return not self.phase.is_zero and ("e_TE" in self.given or self.stiffness != "constant")

    @property
    def angle(self) -> Expr:
        """Mesh phase."""
        return self.r * t + (self.theta if self._phased else 0)

    # --- deflection and force ------------------------------------------------------------------------------

    def _apart(self, coupled: Coupled) -> tuple[tuple[Expr, Expr], tuple[Expr, Expr]]:
        """Driver less driven at the teeth, displacement and rate."""
        p, g = coupled.motions[self.driver.shaft], coupled.motions[self.driven.shaft]
        at_p, at_g = self.driver.station, self.driven.station
        (px, py), (gx, gy) = p.displacement(at_p), g.displacement(at_g)
        (vpx, vpy), (vgx, vgy) = p.velocity(at_p), g.velocity(at_g)
        return (px - gx, py - gy), (vpx - vgx, vpy - vgy)

    def deflection(self, coupled: Coupled) -> tuple[Expr, Expr]:
        """Deflection of the teeth along the line of action over c_0, positive when pressed, and its rate."""
        phi, (d_x, d_y), (v_x, v_y) = self.own[mesh.phi_m], *self._apart(coupled)
        delta = self.own[mesh.F_0] / self.Lambda + cos(phi) * d_x + sin(phi) * d_y
        rate = cos(phi) * v_x + sin(phi) * v_y
        if "e_TE" in self.given:
            delta, rate = delta - self.E * cos(self.angle), rate + self.r * self.E * sin(self.angle)
        if self.turning:
            for wheel, way in ((self.driver, 1), (self.driven, -1)):
                q, v = coupled.motions[wheel.shaft].arc(wheel.station)
                ratio = way * self.tau * wheel.ratio(self.name)
                delta, rate = delta + ratio * q, rate + ratio * v
        return delta, rate

    def pressing(self, coupled: Coupled) -> Expr:
        """Force W along the line of action, over K_0 c_0."""
        delta, rate = self.deflection(coupled)
        k = mesh.stiffness_over_mean(self.stiffness, self.angle)
        W = self.Lambda * (k * mesh.engaged(delta, self.backlash)).xreplace(self.own)
        return W + (2 * self.xi * s * rate if "C_m" in self.given else 0)

    def force(self, coupled: Coupled) -> tuple[Expr, Expr]:
        """Force on the driven shaft, over K_0 c_0."""
        if self.kind == "line":
            W, phi = self.pressing(coupled), self.own[mesh.phi_m]
            return W * cos(phi), W * sin(phi)
        (d_x, d_y), (v_x, v_y) = self._apart(coupled)
        if "e_TE" in self.given:
            c, n = cos(self.angle), sin(self.angle)
            d_x, d_y = d_x - self.E * c, d_y - self.E * n
            v_x, v_y = v_x + self.r * self.E * n, v_y - self.r * self.E * c
        damping = 2 * self.xi * s if "C_m" in self.given else 0
        return damping * v_x + self.Lambda * d_x, damping * v_y + self.Lambda * d_y

    # --- passes --------------------------------------------------------------------------------------------

    def unknowns(self) -> tuple[State, ...]:
        """None."""
        return ()

    def couple(self, coupled: Coupled) -> None:
        """The force on both shafts, and its moment on their rotation but for that of the transmitted torque."""
        f_x, f_y = self.force(coupled)
        coupled.forces.setdefault(self.driven.shaft, []).append((self.driven.station, (f_x, f_y)))
        coupled.forces.setdefault(self.driver.shaft, []).append((self.driver.station, (-f_x, -f_y)))
        if self.turning:
            left = self.tau * (self.pressing(coupled) - self.own[mesh.F_0])
            for wheel, way in ((self.driver, -1), (self.driven, 1)):
                coupled.moments.setdefault(wheel.shaft, []).append((wheel.station, way * wheel.ratio(self.name) * left))

    def rates(self, coupled: Coupled) -> dict[State, Expr]:  # noqa: ARG002 (the same for all parts)
        """None."""
        return {}

    def declare(self, coupled: Coupled) -> Declared:
        """Harmonic, contact of the teeth, and where the force has kinks."""
        made = Declared(harmonics=[self.r], clocks={self.name: self.r})
        if self.kind != "line":
            return made
        delta, _ = self.deflection(coupled)
        made.teeth, made.sources = [delta], ["kahraman1990"]
        own, back = self.own, {known.name: mine.name for known, mine in self.own.items()} | {"Lambda": self.Lambda.name}
        back["T_p"] = self.inputs()["T"].name
        made.defaults = {own[p]: _own(e, own) for p, e in mesh.reads(self.stiffness, self.backlash).defaults.items()
                         if p.name not in self.given}  # fmt: skip
        made.checks = [_check(fault, back) for fault in mesh.faults(self.stiffness, self.backlash)]
        if self.backlash == "dead_zone":
            made.switchings = {
                f"drive_side_{self.name}": Switching(delta, f"the driving flanks of mesh {self.name} touch"),
                f"back_side_{self.name}": Switching(-delta - own[mesh.B_m], f"the back flanks of mesh {self.name} touch"),
            }
        return made


def _check(fault: Check, names: Mapping[str, str]) -> Check:
    """A check of `models.mesh` for the parameters of one mesh, by their names there."""

    def check(values: Mapping[str, float]) -> str:
        said = fault({name: values[own] for name, own in names.items() if own in values})
        for name, own in names.items():
            said = re.sub(rf"\b{name}\b", own, said)
        return said

    return check


def _own(e: Expr | int, own: dict[Parameter, Parameter]) -> Expr:
    return Integer(e) if isinstance(e, int) else e.xreplace(own)
