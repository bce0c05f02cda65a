"""Models: immutable declarations of a system's equations, without anything about their computation."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, TypeVar

from sympy import Expr, Symbol, sympify

from whirlmap.equations import declaration
from whirlmap.equations.parts import Film, Journal, OfBearing, Output, Section, Stop, Switching
from whirlmap.equations.pieces import Table
from whirlmap.equations.quantities import Parameter, State, t
from whirlmap.errors import ModelError, counted, nearest
from whirlmap.results.listing import Listed, Listing, Rows, brackets


@dataclass(frozen=True, eq=False, repr=False)
class Model(Listed):
    """States, parameters and one expression for the rate of each state.

    Attributes
    ----------
    name : str
        Name in case files and on the command line.
    states : tuple of State
        In their declared order, which is the order of every array.
    parameters : tuple of Parameter
        In their declared order.
    equations : mapping of State to Expr
        Rate of each state, in states, parameters and time `t`.
    harmonics : tuple of Expr
        Angular frequencies of every harmonic of time that the equations contain, in parameters only. They count
        even where their amplitude is zero. Empty for an unforced model.
    defaults : mapping of Parameter to Expr
        Parameters that follow from others unless they are given.
    outputs : mapping of str to Output
        What is recorded beside the states.
    stops : mapping of str to Stop
        Events that end a run, by the name of the status they give.
    switchings : mapping of str to Switching
        Surfaces at which the equations change their form.
    films : mapping of str to Film
        Films that carry a load at rest; nothing is integrated from them.
    teeth : Expr, optional
        Deflection of the teeth, of states, parameters and time: positive while the driving flanks press on each other.
    section, typical_time
        For unforced models: where to cut, and a time in which the state changes by its own size (about a turn).
    start : "states" or "equilibrium"
        Whether a run starts from the states' own start values, or from the static equilibrium with all forcing off.
    start_where_none : mapping of State to float
        Added to the states' start values where no equilibrium is found.
    near_equilibrium : callable, optional
        ``near_equilibrium(values) -> states``, arrays by name: where the search for the equilibrium begins, before it is
        tried from ``start_where_none``. States that are left out are zero.
    equilibrium : mapping of State to Expr
        The static equilibrium in parameters, where the rates have no derivative at it, so that it is not found from them.
        States that are left out are zero; empty for all other models.
    bound : float, optional
        A state beyond this has diverged. Where absent, one that has grown far beyond any motion that could be seen has
        (`whirlmap.integrate.scales.limits`), whatever the units are.
    tables : tuple of Table
        Tables that the equations use.
    plain : mapping of Parameter to callable
        ``plain[psi](model) -> Model`` at ``psi = 0``: the same model with a closed form in place of a table.
    checks : tuple of callables
        ``check(values) -> str``: what is wrong with a whole set of values, empty where nothing is.
    switches : mapping of str to str
        The choices that made this model out of its family.
    clocks : mapping of str to Expr
        Named angular frequencies, for spectra and for counting turns: "mesh", "pinion", "gear".
    swing : tuple of State
        The displacements that a diagram of this model shows first.
    bodies : mapping of str to tuple of State
        Coordinates of each part that moves, for the names and shapes of modes and their sense of whirl: x and y of a centre,
        or one of a torsion.
    stations : mapping of str to (str, str)
        Names of the states or outputs along x and y at places where a probe may be; the centres of bodies where empty.
    speed : Parameter, optional
        The speed, which all frequencies of the machine are proportional to: what `speeds` judges and `campbell` counts by.
    angular_acceleration : mapping of State to Expr, optional
        What a changing speed adds to the rate of each state, over its relative rate of change (d omega/dt)/omega^2: forces
        of unbalances, and the change of a clock that time is counted in. States that are left out have none; None where it
        is not declared, so that no run-up can be computed. See `whirlmap.equations.run_up`.
    alike : tuple of tuple of State
        States whose sizes are compared with each other beside those that the expressions add up: the coordinates of a
        machine from parts, each of which has a factor of its own in every sum.
    journals : mapping of str to Journal
        Journals by their bearing, for orbits in their clearance.
    unbalances : mapping of str to Parameter
        Eccentricities of centres of mass over the clearance, by the rotor's name; ``"rotor, plane"`` where it has several.
    assumptions : str
        Which assumptions `whirlmap.assumptions` judges beside those of bearings.
    sources : tuple of str
        Keys of `references.bib`.
    """

    name: str
    states: tuple[State, ...]
    parameters: tuple[Parameter, ...]
    equations: Mapping[State, Expr]
    harmonics: tuple[Expr, ...] = ()
    defaults: Mapping[Parameter, Expr] = field(default_factory=dict)
    outputs: Mapping[str, Output] = field(default_factory=dict)
    stops: Mapping[str, Stop] = field(default_factory=dict)
    switchings: Mapping[str, Switching] = field(default_factory=dict)
    films: Mapping[str, Film] = field(default_factory=dict)
    teeth: Expr | None = None
    section: Section | None = None
    typical_time: Expr | float = 1.0
    start: Literal["states", "equilibrium"] = "states"
    start_where_none: Mapping[State, float] = field(default_factory=dict)
    near_equilibrium: Callable[[Mapping[str, Any]], Mapping[str, Any]] | None = None
    equilibrium: Mapping[State, Expr] = field(default_factory=dict)
    bound: float | None = None
    tables: tuple[Table, ...] = ()
    plain: Mapping[Parameter, Callable[[], "Model"]] = field(default_factory=dict)
    checks: tuple[Callable[[Mapping[str, float]], str], ...] = ()
    switches: Mapping[str, str] = field(default_factory=dict)
    clocks: Mapping[str, Expr] = field(default_factory=dict)
    swing: tuple[State, ...] = ()
    bodies: Mapping[str, tuple[State, ...]] = field(default_factory=dict)
    stations: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    speed: Parameter | None = None
    angular_acceleration: Mapping[State, Expr] | None = None
    alike: tuple[tuple[State, ...], ...] = ()
    journals: Mapping[str, Journal] = field(default_factory=dict)
    unbalances: Mapping[str, Parameter] = field(default_factory=dict)
    assumptions: str = ""
    sources: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Refuse a declaration that contradicts itself, or that nothing could compute, naming the symbol."""
        declaration.refuse_collections(
            self.name, states=self.states, parameters=self.parameters, harmonics=self.harmonics, swing=self.swing,
        )  # fmt: skip
        declaration.refuse_names(self.name, self.states, self.parameters, self.outputs)
        declaration.refuse_equations(self.name, self.states, self.equations)
        declaration.refuse_outputs(self.name, self.outputs)
        declaration.refuse_roles(self.name, self.speed, self.swing, self.bodies, self.journals, self.unbalances)
        declaration.refuse_stations(self.name, self.stations, [*(s.name for s in self.states), *self.outputs])
        declaration.refuse_expressions(self.name, self.expressions(), self.states, self.parameters, self.tables)
        if not self.forced and any(sympify(e).has(t) for e in self.equations.values()):
            raise ModelError(f"model {self.name!r} uses time but declares no harmonics: add harmonics=(...)")
        read = self.read()
        declaration.refuse_unread(self.name, [p.name for p in self.parameters if p not in read])

    @property
    def forced(self) -> bool:
        """Whether time appears in the equations."""
        return bool(self.harmonics)

    @property
    def dimension(self) -> int:
        """Number of states."""
        return len(self.states)

    def state(self, name: str) -> State:
        """Return the state of that name, or raise `ModelError`."""
        return _by_name(self.states, name, self.name, "state")

    def parameter(self, name: str) -> Parameter:
        """Return the parameter of that name, or raise `ModelError`."""
        return _by_name(self.parameters, name, self.name, "parameter")

    def listing(self) -> Listing:
        """Its equations and parameters, for a terminal and a notebook."""
        facts = [f"switches: {', '.join(f'{name} = {choice}' for name, choice in self.switches.items())}"]
        facts += [f"forced at {', '.join(map(str, self.harmonics))}" if self.forced else "unforced"]
        facts += [f"not declared: {words}"] if (words := brackets(self.not_declared())) else []
        equations = [(s.name, s.unit, s.meaning, str(self.equations[s])) for s in self.states]
        parameters = [(p.name, p.unit, p.meaning) for p in self.parameters]
        outputs = [(name, o.unit, o.meaning) for name, o in self.outputs.items()]
        return Listing(
            f"Model {self.name}: {counted(self.dimension, 'state')}, {counted(len(self.parameters), 'parameter')}",
            facts if self.switches else facts[1:],
            [
                Rows("Equations", ("state", "unit", "meaning", "rate"), equations),
                Rows("Parameters", ("name", "unit", "meaning"), parameters),
                Rows("Outputs", ("name", "unit", "meaning"), outputs, details=True),
            ],
        )

    def outputs_of(self, role: OfBearing) -> dict[str, str]:
        """Names of the outputs that have a role, by the bearing of each."""
        return {output.bearing: name for name, output in self.outputs.items() if output.role == role}

    @property
    def velocities(self) -> dict[str, str]:
        """The state that is the rate of another, by the name of that other: names of positions and of their velocities."""
        rates = [(s.name, self.equations[s]) for s in self.states]
        return {name: rate.name for name, rate in rates if isinstance(rate, State)}

    def roles(self) -> dict[str, Any]:
        """Names by their roles, as plain data: what a result says to those who draw it."""
        quantities = (*self.states, *self.parameters)
        found = {
            "speed": self.speed.name if self.speed else "",
            "bodies": {body: [q.name for q in found] for body, found in self.bodies.items()},
            "journals": {bearing: [q.name for q in j.u] for bearing, j in self.journals.items()},
            "eccentricities": self.outputs_of("eccentricity"),
            "velocities": self.velocities,
            "symbols": {q.name: q.latex for q in quantities if q.latex},
        }
        return {role: names for role, names in found.items() if names}

    def not_declared(self) -> dict[str, str]:
        """Roles that this model does not declare, and what is not to be had without each."""
        return {role: lacking for role, lacking, declared in (
            ("speed", "no safe speeds", self.speed),
            ("bodies", "no names and no sense of whirl of modes", self.bodies),
            ("journals", "no orbit in its clearance", self.journals),
            ("eccentricity", "no film thickness, no assumptions judged", self.outputs_of("eccentricity")),
            ("load", "no bearing loads", self.outputs_of("load")),
        ) if not declared}  # fmt: skip

    def expressions(self) -> dict[str, list[Any]]:
        """Every expression of this model, by the part of the declaration where it stands."""
        journals = [journal.u for journal in self.journals.values()]
        of_journals = [e for j in self.journals.values() for e in (j.spin, j.clearance)]
        of_films = [e for k in self.films.values() for e in (*k.u, k.psi, k.spin, k.strength, k.clearance)]
        return {
            "the equations": list(self.equations.values()),
            "the harmonics": list(self.harmonics),
            "the defaults": list(self.defaults.values()),
            "the outputs": [o.expression for o in self.outputs.values()],
            "the stops": [e for s in self.stops.values() for e in (s.gap, s.reachable)],
            "the switchings": [q.surface for q in self.switchings.values()],
            "the films": of_films,
            "the teeth": [] if self.teeth is None else [self.teeth],
            "the clocks": list(self.clocks.values()),
            "the roles": [*filter(None, [self.speed]), *self.unbalances.values(), *of_journals],
            "the coordinates": [*self.swing, *(q for u in (*self.bodies.values(), *journals, *self.alike) for q in u)],
            "the equilibrium": list(self.equilibrium.values()),
            "the angular acceleration": list((self.angular_acceleration or {}).values()),
            "the section": [self.section.surface] if self.section else [],
            "the typical time": [self.typical_time],
        }

    def read(self) -> frozenset[Parameter]:
        """Parameters that an equation, a harmonic, an output, a stop, a default or another part of this model reads."""
        used: set[Symbol] = set()
        for where, expressions in self.expressions().items():
            for expression in () if where == "the roles" else expressions:
                used |= sympify(expression).free_symbols
        return frozenset(p for p in self.parameters if p in used)


Named = TypeVar("Named", State, Parameter)


def _by_name(known: tuple[Named, ...], name: str, model: str, kind: str) -> Named:
    for quantity in known:
        if quantity.name == name:
            return quantity
    names = [q.name for q in known]
    raise ModelError(f"model {model!r} has no {kind} {name!r}.{nearest(name, names)}\n  {kind}s: {', '.join(names)}")
