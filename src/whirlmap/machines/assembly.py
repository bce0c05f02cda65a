"""Assembly: from the parts of a machine to its `Model`, in three passes (unknowns, coupled variables, rates)."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from sympy import Expr, Integer, Min, Rational, pi, sqrt, sympify

from whirlmap.equations.groups import Bearing
from whirlmap.equations.model import Model
from whirlmap.equations.parts import Output
from whirlmap.equations.quantities import Parameter, State
from whirlmap.machines.parts.coefficients import CoefficientBearing
from whirlmap.machines.parts.contact import Rub
from whirlmap.machines.parts.coupling import Coupling
from whirlmap.machines.parts.journal import JournalBearing
from whirlmap.machines.parts.part import Coupled, Declared, Part
from whirlmap.machines.parts.rotor import Rotor, quantity, speed_over_clock
from whirlmap.machines.parts.support import Support
from whirlmap.machines.parts.teeth import Teeth
from whirlmap.machines.parts.unbalance import Unbalance
from whirlmap.machines.scale import Scale, f, s
from whirlmap.machines.train import Train
from whirlmap.models.operation import g, speed

AnyBearing = JournalBearing | CoefficientBearing
#: Unit of lengths of a machine without any clearance [m]; nothing in it depends on the choice.
WITHOUT_CLEARANCE = Rational(1, 10**4)


@dataclass(frozen=True)
class Machine:
    """A machine as its parts, without the numbers that vary.

    Attributes
    ----------
    reference : str
        The shaft whose speed is given.
    rotors, bearings, coefficients, supports, meshes, unbalances, couplings, rubs : tuple of parts
        ``bearings`` have films, ``coefficients`` are bearings by their stiffness and damping.
    train : Train
        Speeds by the teeth.
    """

    reference: str
    rotors: tuple[Rotor, ...]
    bearings: tuple[JournalBearing, ...]
    coefficients: tuple[CoefficientBearing, ...]
    supports: tuple[Support, ...]
    meshes: tuple[Teeth, ...]
    unbalances: tuple[Unbalance, ...]
    couplings: tuple[Coupling, ...]
    rubs: tuple[Rub, ...]
    train: Train = field(compare=False)  # follows from the meshes

    @property
    def parts(self) -> tuple[Part, ...]:
        """All of them; each couples to those before it."""
        return (
            *self.rotors, *self.supports, *self.bearings, *self.coefficients, *self.meshes, *self.unbalances,
            *self.couplings, *self.rubs,
        )  # fmt: skip

    @property
    def supporting(self) -> tuple[AnyBearing, ...]:
        """Bearings with films, and those by coefficients."""
        return (*self.bearings, *self.coefficients)

    @property
    def scale(self) -> Scale:
        """What its numbers are counted in."""
        by_shaft = sorted(self.bearings, key=lambda b: b.shaft != self.reference)
        c_0 = by_shaft[0].inputs()["c"] if by_shaft else WITHOUT_CLEARANCE
        return Scale(c_0, quantity(self.reference, "m"), quantity(self.reference, "K"))

    def groups(self) -> dict[Parameter, Expr]:
        """Every parameter as an expression of inputs and of other parameters."""
        scale = self.scale
        clock = speed_over_clock(self.reference)  # 1: the reference shaft, unless another clock is asked for
        made: dict[Parameter, Expr] = {s: speed / (clock * scale.omega_0), f: g / (scale.omega_0**2 * scale.c_0)}
        for rotor in self.rotors:
            made[rotor.r] = Integer(1) if rotor.r == clock else clock * self.train.speeds[rotor.name]
        for mesh in self.meshes:
            driver = speed_over_clock(mesh.driver.shaft)
            made[mesh.r] = mesh.sense * driver * mesh.inputs()["z_driver"]
        for part in self.parts:
            made |= part.groups(scale)
        return made

    def quantities(self) -> dict[str, Output]:
        """Dimensional results."""
        scale, clock = self.scale, s * self.scale.omega_0
        made = {
            "omega_0": Output(scale.omega_0, "rad/s", "speed at which s = 1, sqrt(K_0/m_0)", role="unit_speed"),
            "force_unit": Output(scale.force, "N", "unit of forces, K_0 c_0"),
        }
        for rotor in self.rotors:
            meaning = f"speed of {rotor.name}; negative where it turns clockwise"
            made[f"speed_{rotor.name}"] = Output(
                rotor.r * clock, "rad/s", meaning, role="shaft_speed" if rotor.name == self.reference else ""
            )
        for mesh in self.meshes:
            made[f"frequency_{mesh.name}"] = Output(mesh.r * clock, "rad/s", f"tooth-passing frequency of mesh {mesh.name}")
        for b in self.bearings:
            own = b.inputs()
            slender = own["L"] / (2 * own["R"])
            made[f"slenderness_{b.name}"] = Output(
                slender, "1", f"length over diameter of bearing {b.name}; short is below 0.25"
            )
            if b.kind == "damper":
                made[f"film_damping_{b.name}"] = Output(
                    pi * b.lubricant * own["R"] * own["L"] ** 3 / (2 * own["c"] ** 3), "N*s/m",
                    f"damping of the film of bearing {b.name} at the centre",
                )  # fmt: skip
            if b.film != "short":
                made[f"ring_{b.name}"] = Output(
                    pi * own["H"] / own["L"], "1",
                    f"pi H/L of bearing {b.name}; psi is too large by about a third of its square",
                    role="ring", bearing=b.name,
                )  # fmt: skip
        return made | self._on_cages()

    def _on_cages(self) -> dict[str, Output]:
        """Natural frequencies of lumped rotors that only squirrel cages hold, which no linear analysis can give."""
        made = {}
        for rotor in self.rotors:
            mine = [b for b in self.bearings if b.shaft == rotor.name]
            if rotor.shaft.lumped and mine and all(b.kind == "damper" and "k_c" in b.given for b in mine):
                held = sum((b.alike * b.inputs()["k_c"] for b in mine), Integer(0))
                made[f"omega_cage_{rotor.name}"] = Output(
                    sqrt(held / quantity(rotor.name, "m")), "rad/s",
                    f"natural frequency of {rotor.name}, rigid, on its squirrel cages", role="natural_frequency",
                )  # fmt: skip
        return made

    def judged(self) -> dict[str, Bearing]:
        """Bearings whose film law's assumptions are judged."""
        return {b.name: b.bearing() for b in self.bearings}


def assemble(
    machine: Machine, near: Callable[[Mapping[str, Any]], Mapping[str, Any]] | None = None
) -> Model:
    """Write the equations of a machine.

    Parameters
    ----------
    machine : Machine
    near : callable, optional
        Where the search for the static equilibrium begins: see `Model`.

    Returns
    -------
    Model
        Parameters in the order of their groups; states part by part.

    Notes
    -----
    1. Unknowns of all parts.
    2. Coupled variables: motions of shafts at their stations, positions of supports and journals; then forces of meshes,
       unbalances and couplings; then the force of each shaft on its journals, from its residual flexibility.
    3. Rates of all unknowns, and what else each part declares.
    """
    parts = machine.parts
    unknowns = [state for part in parts for state in part.unknowns()]
    coupled = Coupled()
    for part in parts:
        part.couple(coupled)
    for rotor in machine.rotors:
        rotor.press(coupled)
    equations: dict[State, Expr] = {}
    for part in parts:
        equations |= part.rates(coupled)
    told = [part.declare(coupled) for part in parts]
    positions = [q for q in unknowns if not q.name.startswith("v")]
    rates = [q for q in unknowns if q.name.startswith("v")]
    teeth = [e for one in told for e in one.teeth]
    accelerated = _accelerated(machine, coupled, rates)
    read = _read([*equations.values(), *accelerated.values()], told)
    defaults: dict[Any, Any] = _joined(one.defaults for one in told)
    return Model(
        name="machine",
        states=(*positions, *rates),
        parameters=(*(p for p in machine.groups() if p.name in read), *defaults),  # which no input of the file gives
        equations={q: equations[q] for q in (*positions, *rates)},
        harmonics=tuple(e for one in told for e in one.harmonics),
        defaults=defaults,
        outputs=_joined(one.outputs for one in told),
        stops=_joined(one.stops for one in told),
        switchings=_joined(one.switchings for one in told),
        films=_joined(one.films for one in told),
        teeth=Min(*teeth) if teeth else None,
        start="equilibrium",
        near_equilibrium=near,
        start_where_none=_joined(one.start_where_none for one in told),
        bound=1e6,
        tables=tuple({table.name: table for one in told for table in one.tables}.values()),
        checks=tuple(check for one in told for check in one.checks),
        clocks=_joined(one.clocks for one in told),
        swing=tuple(state for one in told for state in one.swing),
        bodies=_joined(one.bodies for one in told),
        stations=_joined(one.stations for one in told),
        alike=(tuple(positions),),
        angular_acceleration=accelerated,
        speed=s,
        journals=_joined(one.journals for one in told),
        unbalances=_joined(one.unbalances for one in told),
        sources=tuple(dict.fromkeys(key for one in told for key in one.sources)),
    )


def _accelerated(machine: Machine, coupled: Coupled, rates: Sequence[State]) -> dict[State, Expr]:
    """What a changing speed adds to rates, over its relative rate: forces, and the change of the clock."""
    forces = _joined(rotor.accelerated(coupled) for rotor in machine.rotors)
    return {v: forces.get(v, Integer(0)) - v for v in rates}


def _joined(some: Iterable[Mapping[Any, Any]]) -> dict[Any, Any]:
    return {key: value for one in some for key, value in one.items()}


def _read(rates: Sequence[Expr], told: Sequence[Declared]) -> frozenset[str]:
    """Names of the symbols that the declaration reads; a group that nothing reads is left out."""
    used: list[Any] = [*rates]
    for one in told:
        used += [*one.harmonics, *one.clocks.values(), *one.teeth, *one.defaults.values()]
        used += [output.expression for output in one.outputs.values()]
        used += [e for stop in one.stops.values() for e in (stop.gap, stop.reachable)]
    return frozenset(symbol.name for e in used for symbol in (sympify(e) if e is not None else Integer(0)).free_symbols)
