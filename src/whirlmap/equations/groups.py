"""Dimensionless groups: how a model's parameters follow from dimensional inputs.

A family of models may carry `Groups`: the inputs that an engineer has, declared like parameters, and an
expression of them for each parameter that follows from them. The expressions are SymPy, so that `show` prints
them and a test can check that a change of units leaves them alone. They are evaluated in exact arithmetic on
the numbers as written, and rounded once.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from functools import lru_cache
from math import inf, nan
from sys import float_info

from sympy import Expr, Rational, Symbol, sympify

from whirlmap.equations import group_checks as checks
from whirlmap.equations.model import Model
from whirlmap.equations.parts import Output
from whirlmap.equations.quantities import Parameter

Switches = Mapping[str, str]


@dataclass(frozen=True)
class Route:
    """Another way to give an input, as data sheets have it: a viscosity by its ISO VG grade.

    Attributes
    ----------
    target : Parameter
        The input that follows.
    reads : tuple of Parameter
        Inputs that it follows from; giving the first one chooses this way.
    follow : callable
        ``follow(*values) -> value`` in the declared units.
    rule : str
        What it is, with its source.
    held : mapping of Parameter to Parameter
        Inputs among ``reads`` that say for which operation the first one is given, such as the speed at which a power
        counts, each with the input that says nothing else. They keep the value that they have where the first one is given,
        whatever a later layer makes of them.
    """

    target: Parameter
    reads: tuple[Parameter, ...]
    follow: Callable[..., Fraction | float]
    rule: str
    held: Mapping[Parameter, Parameter] = field(default_factory=dict)

    @property
    def key(self) -> str:
        """Name of the input that chooses this way."""
        return self.reads[0].name

    @property
    def names(self) -> frozenset[str]:
        """Names of all inputs that it may follow from."""
        return frozenset(q.name for q in (*self.reads, *self.held.values()))


@dataclass(frozen=True)
class Bearing:
    """What a film law assumes of a bearing is judged by: inputs that say how large it is and which oil is in it.

    Attributes
    ----------
    R, L, c, mu, rho : Parameter
        Radius, length, radial clearance, viscosity and density of the oil. The density changes no parameter.
    spin : Expr or int
        Speed of the journal over the clock's; 0 for a damper.
    eccentricity : str
        Name of the model's output that is the eccentricity of the journal.
    psi : Expr or int
        Permeability 12 Phi H/c^3 of its ring; 0 for a plain bearing.
    """

    R: Parameter
    L: Parameter
    c: Parameter
    mu: Parameter
    rho: Parameter
    spin: Expr | int
    eccentricity: str
    psi: Expr | int = 0


@dataclass(frozen=True)
class Groups:
    """Dimensional inputs of a family of models, and what follows from them.

    Attributes
    ----------
    inputs : tuple of Parameter
        Dimensional inputs with unit, meaning and limits. One with ``order=True`` is a count, a whole number.
    declare : callable
        ``declare(switches) -> {parameter: expression}`` of inputs, and of other parameters of the mapping.
    quantities : callable
        ``quantities(switches) -> {name: Output}``: dimensional results worth showing (natural frequency,
        speeds), in inputs and parameters.
    units : mapping of str to Expr
        What the model's units are worth, in inputs and parameters: ``force`` [N], ``length`` [m], ``speed`` of the clock
        [rad/s], and ``rotation``, the speed of the first shaft at s = 1 [rad/s].
    bearings : callable
        ``bearings(switches) -> {name: Bearing}``.
    routes : tuple of Route
        Other ways to give some inputs. An input is given in one way alone.
    shared : mapping of str to tuple of str
        Names that stand for several inputs of the same value: ``R`` for ``R_1`` and ``R_2``.
    sections : mapping of str to tuple of str
        Tables of a case file, ``[bearings]``, and the inputs that may stand in each; parameters may stand in any.
    speed : Parameter, optional
        The input that is the model's speed in other words: ``speed=1500 rpm``.
    operation : tuple of str
        Inputs that say how the machine is run; they need not change any parameter.
    checks : tuple of callables
        ``check(inputs) -> str``: what is wrong with a set of inputs; empty where nothing is.

    Raises
    ------
    ModelError
        A measure that there is not, or a name of what is no input.
    """

    inputs: tuple[Parameter, ...]
    declare: Callable[[Switches], Mapping[Parameter, Expr]]
    quantities: Callable[[Switches], Mapping[str, Output]] = lambda _: {}
    units: Mapping[str, Expr] = field(default_factory=dict)
    bearings: Callable[[Switches], Mapping[str, Bearing]] = lambda _: {}
    routes: tuple[Route, ...] = ()
    shared: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    sections: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    speed: Parameter | None = None
    operation: tuple[str, ...] = ()
    checks: tuple[Callable[[Mapping[str, Fraction]], str], ...] = ()

    def __post_init__(self) -> None:
        """Refuse names that nothing would ever read."""
        inputs = [q.name for q in self.inputs]
        checks.refuse_measures(self.units)
        for name, several in self.shared.items():
            checks.refuse_no_inputs(inputs, f"shared[{name!r}]", several)
        for name, inside in self.sections.items():
            checks.refuse_no_inputs([*inputs, *self.shared], f"sections[{name!r}]", inside)
        checks.refuse_no_inputs(inputs, "operation", self.operation)
        checks.refuse_no_inputs(inputs, "speed", [self.speed.name] if self.speed else ())
        for route in self.routes:
            checks.refuse_no_inputs(inputs, f"the route to {route.target.name}", {route.target.name, *route.names})

    def refuse_unknown(self, model: Model) -> None:
        """Refuse what these say of a model that it does not have.

        Raises
        ------
        ModelError
            A symbol that is neither an input nor a parameter; a role or a bearing of what there is not.
        """
        inputs, switches = [q.name for q in self.inputs], model.switches
        known, results = {*inputs, *(p.name for p in model.parameters)}, self.quantities(switches)
        bearings = self.bearings(switches)
        checks.refuse_results(model.name, results, bearings)
        checks.refuse_symbols(model.name, known, "the result", {name: o.expression for name, o in results.items()})
        checks.refuse_symbols(model.name, known, "the unit of", self.units)
        checks.refuse_bearings(model.name, inputs, model.outputs, bearings)

    def input(self, name: str) -> Parameter | None:
        """Return the input of that name, or None."""
        return next((q for q in self.inputs if q.name == name), None)

    def expressions(self, switches: Switches) -> dict[str, Expr]:
        """Expression of each parameter that follows from the inputs, by name."""
        return dict(_declared(self.declare, tuple(sorted(switches.items())))[0])

    def reads(self, switches: Switches) -> dict[str, frozenset[str]]:
        """Names that the expression of each parameter reads."""
        return _declared(self.declare, tuple(sorted(switches.items())))[1]

    def fed_by(
        self, name: str, switches: Switches, explicit: frozenset[str] = frozenset(), routes: Iterable[Route] = ()
    ) -> frozenset[str]:
        """Names of the parameters that change with an input, directly or not; ``explicit`` ones are fixed.

        ``routes`` are the ways in which other inputs are given.
        """
        reads = self.reads(switches)
        start = {name} | {r.target.name for r in routes if name in r.names}
        fed: set[str] = set()
        while True:
            more = {g for g, names in reads.items() if g not in explicit | fed and names & (fed | start)}
            if not more:
                return frozenset(fed)
            fed |= more

    def missing(self, name: str, switches: Switches, known: frozenset[str]) -> list[str]:
        """Names that the expression of a parameter needs and that do not follow from what is known."""
        expression = self.expressions(switches)[name]
        lacking: list[str] = []
        for symbol in sorted(expression.free_symbols, key=str):
            if symbol.name in known:
                continue
            follows = symbol.name in self.expressions(switches)
            lacking += self.missing(symbol.name, switches, known) if follows else [symbol.name]
        return lacking

    def evaluate(
        self, name: str, switches: Switches, values: Mapping[str, Fraction | float]
    ) -> tuple[Fraction | float, str]:
        """Evaluate the expression of a parameter.

        Parameters
        ----------
        name : str
            Name of the parameter.
        values : mapping of str to Fraction or float
            Inputs in their declared units, and parameters that are given explicitly, which win over their
            group.

        Returns
        -------
        value : Fraction or float
            A Fraction where the result is rational.
        expression : str
            What was evaluated.
        """
        expressions = self.expressions(switches)
        exact = expressions[name]
        while missing := [q for q in exact.free_symbols if q.name not in values]:
            exact = exact.xreplace({q: expressions[q.name] for q in missing})
        return value_of(exact, values), str(expressions[name])


@lru_cache(maxsize=64)
def _declared(
    declare: Callable[[Switches], Mapping[Parameter, Expr]], switches: tuple[tuple[str, str], ...]
) -> tuple[dict[str, Expr], dict[str, frozenset[str]]]:
    """Expression of each group, and the names that it reads."""
    expressions = {p.name: sympify(e) for p, e in declare(dict(switches)).items()}
    return expressions, {g: frozenset(q.name for q in e.free_symbols) for g, e in expressions.items()}


def value_of(expression: Expr, values: Mapping[str, Fraction | float]) -> Fraction | float:
    """Evaluate an expression: exactly where all is rational, else to 30 digits and rounded to a float.

    A result that is no number (a division by zero, a root of a negative number) is NaN, one beyond the floats infinite.
    """
    numbers: dict[Symbol, Expr] = {}
    for symbol in expression.free_symbols:
        value = Fraction(values[symbol.name])
        numbers[symbol] = Rational(value.numerator, value.denominator)
    result = expression.xreplace(numbers)
    if result.is_finite is False or result.is_real is False:
        return nan
    if abs(result) > float_info.max:
        return inf if result > 0 else -inf
    if isinstance(result, Rational):
        return Fraction(int(result.p), int(result.q))
    return float(result.evalf(30))
