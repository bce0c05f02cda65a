"""Models: immutable declarations of a system's equations, without anything about their computation."""

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from itertools import islice, product
from typing import TYPE_CHECKING, Literal, TypeVar

from sympy import Expr, Symbol, sympify

from whirlmap.equations import hints
from whirlmap.equations.declaration import parts, refuse_contradictions
from whirlmap.equations.pieces import Table
from whirlmap.equations.quantities import Parameter, State
from whirlmap.errors import ModelError, nearest
from whirlmap.results.listing import Listed, Listing, Rows

if TYPE_CHECKING:
    from whirlmap.equations.groups import Groups


@dataclass(frozen=True)
class Section:
    """Where an unforced model is cut: the surface ``surface = 0``, crossed in one direction, once per turn."""

    surface: Expr
    direction: Literal["rising", "falling"]


@dataclass(frozen=True)
class Output:
    """A quantity computed from states and parameters, with unit, meaning and measure (see `Quantity`)."""

    expression: Expr
    unit: str
    meaning: str
    measure: str = ""


@dataclass(frozen=True)
class Stop:
    """An end of the run: the first time at which ``gap`` has fallen to zero.

    ``reachable`` is false where physics forbids the event for these parameters (a plain film at its wall): a step that
    gets there anyway was too long, and is redone with shorter ones.
    """

    gap: Expr
    meaning: str
    reachable: Expr = field(default_factory=lambda: sympify(1))


@dataclass(frozen=True)
class Switching:
    """A surface at which the equations change their form: a tooth leaves its flank, a journal meets the wall.

    ``surface`` (of states, parameters and time) is positive on one side. It is declared so that its crossings can be listed
    and counted by name (`whirlmap.surface_crossings`); ``jumps`` tells the reader that the rates jump there and do not only
    have a kink. Steps find every such surface in the equations themselves, declared or not.
    """

    surface: Expr
    meaning: str
    jumps: bool = False


@dataclass(frozen=True)
class Film:
    """A fluid film of the short-bearing law between a journal that spins and its bearing, for its linear coefficients.

    ``u`` is the journal relative to the bearing over the clearance, ``psi`` the permeability, ``spin`` the journal's speed
    over the clock's, positive from x to y, and ``strength`` is A times the clock's speed, over the model's unit of force.
    """

    u: tuple[State, State]
    psi: Expr | int
    spin: Expr | int
    strength: Expr


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
        Coordinates of each part that moves, for the names and shapes of modes: two of a centre, or one of a torsion.
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
    equilibrium: Mapping[State, Expr] = field(default_factory=dict)
    bound: float | None = None
    tables: tuple[Table, ...] = ()
    plain: Mapping[Parameter, Callable[[], "Model"]] = field(default_factory=dict)
    checks: tuple[Callable[[Mapping[str, float]], str], ...] = ()
    switches: Mapping[str, str] = field(default_factory=dict)
    clocks: Mapping[str, Expr] = field(default_factory=dict)
    swing: tuple[State, ...] = ()
    bodies: Mapping[str, tuple[State, ...]] = field(default_factory=dict)
    sources: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Refuse a declaration that contradicts itself, naming the symbol."""
        refuse_contradictions(self)

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
        equations = [(s.name, s.unit, s.meaning, str(self.equations[s])) for s in self.states]
        parameters = [(p.name, p.unit, p.meaning) for p in self.parameters]
        outputs = [(name, o.unit, o.meaning) for name, o in self.outputs.items()]
        return Listing(
            f"Model {self.name}: {self.dimension} states, {len(self.parameters)} parameters",
            facts if self.switches else facts[1:],
            [
                Rows("Equations", ("state", "unit", "meaning", "rate"), equations),
                Rows("Parameters", ("name", "unit", "meaning"), parameters),
                Rows("Outputs", ("name", "unit", "meaning"), outputs, details=True),
            ],
        )

    def read(self) -> frozenset[Parameter]:
        """Parameters that an equation, a harmonic, an output, a stop, a default or another part of this model reads."""
        used: set[Symbol] = set()
        for expressions in parts(self).values():
            for expression in expressions:
                used |= sympify(expression).free_symbols
        return frozenset(p for p in self.parameters if p in used)


#: Choices of switches that `Family.symbols` declares at most.
TRIED = 64

Named = TypeVar("Named", State, Parameter)


def _by_name(known: tuple[Named, ...], name: str, model: str, kind: str) -> Named:
    for quantity in known:
        if quantity.name == name:
            return quantity
    names = [q.name for q in known]
    raise ModelError(f"model {model!r} has no {kind} {name!r}.{nearest(name, names)}\n  {kind}s: {', '.join(names)}")


@dataclass(frozen=True, repr=False)
class Family(Listed):
    """Models that differ by declared switches, so that their difference can be read in one place.

    Attributes
    ----------
    name : str
        Name of the model in case files.
    declare : callable
        ``declare(**switches) -> Model``.
    switches : mapping of str to tuple of str
        Choices for each switch, the default first; a callable default depends on the switches before it.
    meanings : mapping of str to str
        What each switch chooses.
    groups : Groups, optional
        Dimensional inputs, and the parameters that follow from them.
    vocabulary : tuple of Parameter
        Parameters that only some of the models have. Needed where the switches have more choices together than are
        worth declaring (`TRIED`); found by declaring all of them otherwise.
    absent : mapping of str to str
        Beginnings of words for what users look for and the model does not have, and a sentence that says so.
    """

    name: str
    declare: Callable[..., Model]
    switches: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    meanings: Mapping[str, str] = field(default_factory=dict)
    default: Callable[[Mapping[str, str]], Mapping[str, str]] = lambda _: {}
    groups: "Groups | None" = None
    vocabulary: tuple[Parameter, ...] = ()
    absent: Mapping[str, str] = field(default_factory=dict)
    _made: dict[tuple[tuple[str, str], ...], Model] = field(default_factory=dict, repr=False, compare=False)

    def model(self, **chosen: str) -> Model:
        """Declare the model for these switches; those that are not given take their defaults.

        Raises
        ------
        ModelError
            Where a switch or a choice is unknown.
        """
        for name, value in chosen.items():
            if name not in self.switches:
                raise ModelError(f"model {self.name!r} has no switch {name!r}.{self.hint(name, self.switches, value)}")
            if value not in self.switches[name]:
                allowed = " | ".join(self.switches[name])
                raise ModelError(
                    f"switch {name!r} of {self.name!r} cannot be {value!r}; it is one of {allowed}."
                    f"{hints.of_choice(self, name, value)}"
                )
        settled = {name: choices[0] for name, choices in self.switches.items()}
        settled |= self.default(settled | chosen)
        settled |= chosen
        key = tuple(sorted(settled.items()))
        if key not in self._made:  # equal switches are the same object, so that kernels are found again
            self._made[key] = self.declare(**settled)
        return self._made[key]

    def listing(self) -> Listing:
        """Its switches, for a terminal and a notebook."""
        rows = [(name, " | ".join(choices), self.meanings.get(name, "")) for name, choices in self.switches.items()]
        return Listing(f"Family {self.name}", (), [Rows("Switches", ("name", "choices, default first", "meaning"), rows)])

    def hint(self, name: str, known: Iterable[str], value: object = "") -> str:
        """Say that the model lacks what an unknown name or its value asks for, else suggest the nearest known name."""
        asked = re.findall(r"[a-z]+", f"{name} {value}".casefold().replace("_", " "))
        for word in asked:
            for begins, sentence in self.absent.items():
                if word.startswith(begins) if len(begins) > 1 else word == begins and "_" not in name:
                    return f" {sentence[:1].upper()}{sentence[1:]}."
        return nearest(name, known)

    def symbols(self) -> frozenset[str]:
        """Names of the parameters of all its models, whatever the switches."""
        found = {p.name for p in (*self.model().parameters, *self.vocabulary)}
        for choices in islice(product(*self.switches.values()), 0 if self.vocabulary else TRIED):
            try:
                found |= {p.name for p in self.model(**dict(zip(self.switches, choices, strict=True))).parameters}
            except ModelError:  # a combination that the family itself refuses
                continue
        return frozenset(found)
