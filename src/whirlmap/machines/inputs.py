"""Dimensional inputs of a machine from parts: their names, other ways to give them, and the units of its numbers."""

from collections.abc import Mapping
from fractions import Fraction

from sympy import Expr

from whirlmap.equations.groups import Groups, Route
from whirlmap.equations.quantities import Parameter
from whirlmap.machines.assembly import Machine
from whirlmap.machines.fields import Number
from whirlmap.machines.parts import coefficients, contact, coupling, journal, rotor, support, teeth, unbalance
from whirlmap.machines.parts.rotor import quantity, speed_over_clock
from whirlmap.machines.scale import s
from whirlmap.models.lubricant import by_grade, by_two_points
from whirlmap.models.operation import OPERATION, g, range_fault, speed, speed_max

#: Keys of an oil that are inputs.
OIL = ("VG", "VI", "nu_40", "nu_100", "T_oil")


def groups_of(machine: Machine, oils: Mapping[str, tuple[Parameter, Parameter]]) -> Groups:
    """Inputs of a machine, and how its parameters follow from them.

    Parameters
    ----------
    machine : Machine
    oils : mapping of str to (Parameter, Parameter)
        Viscosity and density of each lubricant.
    """
    made = machine.groups()
    scale = machine.scale
    of_parts = _of_parts(machine)
    of_oils = {name: _oil(mu, rho) for name, (mu, rho) in oils.items()}
    inputs = [
        *of_parts,
        *(q for pair in oils.values() for q in pair),
        *(q for own in of_oils.values() for q in own.values()),
    ]
    routes = [route for name, (mu, rho) in oils.items() for route in _viscosity(mu, rho, of_oils[name])]
    return Groups(
        inputs=(speed, g, *OPERATION, *inputs),
        declare=lambda _: made,
        quantities=lambda _: machine.quantities(),
        bearings=lambda _: machine.judged(),
        units={
            "force": scale.force, "length": scale.c_0, "speed": s * scale.omega_0,
            "rotation": speed_over_clock(machine.reference) * scale.omega_0,
        },
        routes=(*routes, *_unbalances(machine), *_torques(machine)),
        shared=_shared(of_parts),
        speed=speed,
        operation=tuple(q.name for q in OPERATION),
        checks=(range_fault,),
    )  # fmt: skip


def _of_parts(machine: Machine) -> list[Parameter]:
    made: list[Parameter] = []
    kinds = (
        ("shaft", machine.rotors, rotor.FIELDS), ("bearing", machine.bearings, journal.FIELDS),
        ("bearing", machine.coefficients, coefficients.FIELDS),
        ("support", machine.supports, support.FIELDS), ("mesh", machine.meshes, teeth.FIELDS),
        ("unbalance", machine.unbalances, unbalance.FIELDS), ("coupling", machine.couplings, coupling.FIELDS),
        ("rub", machine.rubs, contact.FIELDS),
    )  # fmt: skip
    for kind, parts, fields in kinds:
        for part in parts:
            numbers = [one for one in fields if isinstance(one, Number) and not one.fixed]
            made += [one.parameter(f"{kind}.{part.name}") for one in numbers]
    return made


def _oil(mu: Parameter, rho: Parameter) -> dict[str, Parameter]:  # noqa: ARG001
    """Inputs of an oil beside its viscosity and density."""
    part = mu.name.removesuffix(".mu")
    units = {"VG": "1", "VI": "1", "nu_40": "m^2/s", "nu_100": "m^2/s", "T_oil": "degC"}
    words = ("ISO VG grade", "viscosity index", "kinematic viscosity at 40 degC", "kinematic viscosity at 100 degC",
             "temperature of the film")  # fmt: skip
    return {
        key: Parameter(f"{part}.{key}", units[key], f"{meaning} of {part.replace('.', ' ')}")
        for key, meaning in zip(OIL, words, strict=True)
    }


def _viscosity(mu: Parameter, rho: Parameter, own: Mapping[str, Parameter]) -> list[Route]:
    """Ways in which data sheets give the viscosity of an oil."""
    grade = (own["VG"], own["VI"], own["T_oil"], rho)
    points = (own["nu_40"], own["nu_100"], own["T_oil"], rho)
    return [
        Route(mu, grade, by_grade, "Walther's equation, ASTM D341, with the index of ASTM D2270"),
        Route(mu, points, by_two_points, "Walther's equation, ASTM D341"),
    ]


def _unbalances(machine: Machine) -> list[Route]:
    made = []
    for part in machine.unbalances:
        own, m = part.inputs(), quantity(part.shaft, "m")
        ratio, teeth_read = _speed(machine, part.shaft)
        made.append(Route(own["U"], (own["e"], m), lambda e, m: e * m, "U = e m"))

        def by_grade_of_balance(
            G: Fraction, m: Fraction, fastest: Fraction, *z: Fraction, ratio: Expr = ratio,
            names: tuple[Parameter, ...] = teeth_read,
        ) -> Fraction:  # fmt: skip
            at = abs(ratio.xreplace({q: _exact(v) for q, v in zip(names, z, strict=True)}))
            return G * m / (fastest * Fraction(int(at.p), int(at.q)))

        rule = "U = m G/omega at speed_max, ISO 21940-11"
        made.append(Route(own["U"], (own["G"], m, speed_max, *teeth_read), by_grade_of_balance, rule))
    return made


def _torques(machine: Machine) -> list[Route]:
    made = []
    for part in machine.meshes:
        own = part.inputs()
        ratio, teeth_read = _speed(machine, part.driver.shaft)

        def by_power(
            P: Fraction, at_speed: Fraction, *z: Fraction, ratio: Expr = ratio, names: tuple[Parameter, ...] = teeth_read
        ) -> Fraction:
            at = abs(ratio.xreplace({q: _exact(v) for q, v in zip(names, z, strict=True)}))
            return P / (at_speed * Fraction(int(at.p), int(at.q)))

        reads = (own["P"], speed_max, *teeth_read)
        made.append(Route(own["T"], reads, by_power, "T = P/omega of the driver", {speed_max: own["speed_P"]}))
    return made


def _exact(value: Fraction | float) -> Expr:
    from sympy import Rational

    exact = Fraction(value)
    return Rational(exact.numerator, exact.denominator)


def _speed(machine: Machine, shaft: str) -> tuple[Expr, tuple[Parameter, ...]]:
    """Speed of a shaft over that of the reference, and the numbers of teeth that it follows from."""
    ratio = machine.train.speeds[shaft]
    return ratio, tuple(sorted((q for q in ratio.free_symbols if isinstance(q, Parameter)), key=str))


def _shared(inputs: list[Parameter]) -> dict[str, tuple[str, ...]]:
    """Names that stand for several inputs: ``bearing.c`` for the clearance of all, ``support.base.k`` for x and y."""
    made: dict[str, tuple[str, ...]] = {}
    parts: dict[str, list[str]] = {}
    for q in inputs:
        kind, name, key = q.name.split(".")
        parts.setdefault(f"{kind}.{key}", []).append(q.name)
        if kind == "support":
            for short, both in support.BOTH.items():
                if key in both:
                    parts.setdefault(f"support.{name}.{short}", []).append(q.name)
                    parts.setdefault(f"support.{short}", []).append(q.name)
    for short, names in parts.items():
        if len(names) > 1:
            made[short] = tuple(names)
    return made
