"""From a model's expressions to straight-line code.

Steps, in this order:

1. normal form: terms with kinks and jumps become ``sign``, ``Abs`` and ``Piecewise``;
2. harmonics: ``cos(omega t + chi)`` becomes the harmonic's own cosine and sine, which kernels take from a table;
3. hoisting: whatever depends on parameters alone is computed once per operating point, outside of the kernel;
4. fractional and negative powers are split so that one square root and one reciprocal serve all of them;
5. common subexpressions are shared.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

from sympy import Abs, Add, Expr, Integer, Mul, Symbol, cos, cse, sin, sympify
from sympy.logic.boolalg import Boolean

from whirlmap.equations.model import Model
from whirlmap.equations.pieces import magnitude, tabulated
from whirlmap.equations.quantities import State, t
from whirlmap.errors import ModelError
from whirlmap.kernels.lowering.normal_form import normal_form
from whirlmap.kernels.lowering.powers import keep_whole, split_powers


@dataclass
class Hoisted:
    """Expressions of parameters alone, in the order in which the kernel reads them."""

    parameters: Sequence[Symbol]
    expressions: list[Expr] = field(default_factory=list)
    symbols: list[Symbol] = field(default_factory=list)
    known: dict[Expr, Symbol] = field(default_factory=dict)
    places: dict[Symbol, int] = field(default_factory=dict)

    def symbol(self, expression: Expr) -> Symbol:
        """Return the symbol that stands for an expression of parameters."""
        if expression not in self.known:
            self.expressions.append(expression)
            made = Symbol(f"q{len(self.symbols)}", real=True)
            self.places[made] = len(self.symbols)
            self.symbols.append(made)
            self.known[expression] = made
        return self.known[expression]


def split_harmonics(expression: Expr, harmonics: Sequence[Expr]) -> Expr:
    """Write every sine and cosine of time in the cosine ``c_i`` and sine ``s_i`` of a declared harmonic.

    Raises
    ------
    ModelError
        Where time appears in any other way.
    """

    def split(call: Any) -> Expr:
        argument = call.args[0].expand()
        rate = argument.coeff(t, 1)
        phase = (argument - rate * t).expand()
        if phase.has(t):
            raise ModelError(f"{call} is not a harmonic: its phase must be linear in time")
        for i, harmonic in enumerate(harmonics):
            sign = 1 if (rate - harmonic).expand() == 0 else -1 if (rate + harmonic).expand() == 0 else 0
            if sign:
                c, s = Symbol(f"c{i}", real=True), sign * Symbol(f"s{i}", real=True)
                if isinstance(call, cos):
                    return c * cos(phase) - s * sin(phase)
                return s * cos(phase) + c * sin(phase)
        raise ModelError(f"{call} uses the frequency {rate}, which is not declared: add it to harmonics=(...)")

    out = sympify(expression).replace(lambda e: isinstance(e, cos | sin) and e.has(t), split)
    if out.has(t):
        raise ModelError(f"time may appear inside sines and cosines only: {expression}")
    return out


def hoist(expression: Expr, hoisted: Hoisted) -> Expr:
    """Replace the largest parts of an expression that depend on parameters alone by kernel inputs."""
    parameters = set(hoisted.parameters)
    decided: dict[Any, bool] = {}

    def constant(e: Any) -> bool:
        if e not in decided:
            decided[e] = e in parameters if isinstance(e, Symbol) else all(map(constant, e.args))
        return decided[e]

    def walk(e: Expr) -> Expr:
        if constant(e):
            return hoisted.symbol(e) if e.free_symbols else e
        if isinstance(e, tabulated):
            head, tail = e.args[: 3 + e.dimensions], [walk(a) for a in e.coordinates]
            return tabulated(*head, *tail)
        if isinstance(e, Add | Mul):
            still = [a for a in e.args if constant(a)]
            moving = [walk(a) for a in e.args if not constant(a)]
            together = e.func(*still)
            if isinstance(e, Mul) and together.free_symbols and together.could_extract_minus_sign():
                moving.append(Integer(-1))  # products that differ in sign alone share the input and the terms around it
                together = -together
            if together.free_symbols:
                together = hoisted.symbol(together)
            return e.func(together, *moving)
        if not e.args:
            return e
        return e.func(*[walk(a) if isinstance(a, Expr) else _walk_condition(a, walk) for a in e.args])

    return walk(expression)


def _walk_condition(e: Any, walk: Any) -> Any:
    if isinstance(e, Expr):
        return walk(e)
    return e.func(*[_walk_condition(a, walk) for a in e.args]) if getattr(e, "args", ()) else e


@dataclass(frozen=True)
class Read:
    """One reading of a table: which table, where, and the names that receive outputs and derivatives."""

    table: str
    coordinates: tuple[Symbol, ...]
    outputs: tuple[tuple[int, tuple[int, ...], Symbol], ...]


@dataclass(frozen=True)
class Straight:
    """Straight-line code: assignments in order, table readings between them, and one result for each expression."""

    steps: tuple[tuple[Symbol, Expr] | Read, ...]
    results: tuple[Expr, ...]

    def names(self) -> set[str]:
        """Names of all inputs that the code reads."""
        made = {step[0] for step in self.steps if isinstance(step, tuple)}
        used: set[Symbol] = set()
        for step in self.steps:
            if isinstance(step, tuple):
                used |= step[1].free_symbols
            else:
                made |= {o[2] for o in step.outputs}
                used |= set(step.coordinates)
        for result in self.results:
            used |= result.free_symbols
        return {s.name for s in used - made}


def straight(model: Model, expressions: Iterable[Expr], hoisted: Hoisted) -> Straight:
    """Lower expressions of a model to straight-line code (the steps of the module's list)."""
    plain = []
    gaps = {sympify(stop.gap) for stop in model.stops.values()}  # positive as long as a run goes on
    for expression in expressions:
        e = split_harmonics(keep_whole(normal_form(expression).replace(magnitude, Abs), gaps), model.harmonics)
        e = hoist(e, hoisted)
        plain.append(_plain_symbols(split_powers(e)))
    readings = sorted({e for p in plain for e in p.atoms(tabulated)}, key=str)
    places: dict[tuple, list] = {}
    for e in readings:
        places.setdefault((e.table_name, e.coordinates), []).append(e)
    names = {e: Symbol(f"f{i}") for i, e in enumerate(readings)}
    coordinates = [c for _, where in places for c in where]
    shared, reduced = cse([*coordinates, *(p.xreplace(names) for p in plain)], symbols=_fresh(), order="none")
    shared, reduced = _conditions_in_place(shared, reduced)
    where, results = reduced[: len(coordinates)], reduced[len(coordinates) :]
    steps = _ordered(list(shared), _reads(places, names, where))
    return Straight(tuple(steps), tuple(results))


def _conditions_in_place(
    shared: list[tuple[Symbol, Any]], reduced: list[Any]
) -> tuple[list[tuple[Symbol, Expr]], list[Expr]]:
    """Shared conditions written out where they are used: an assignment holds numbers, and no truths."""
    truths: dict[Symbol, Any] = {}
    numbers = []
    for symbol, e in shared:
        e = e.xreplace(truths)
        if isinstance(e, Boolean) and not isinstance(e, Symbol):
            truths[symbol] = e
        else:
            numbers.append((symbol, e))
    return numbers, [e.xreplace(truths) for e in reduced]


def local_name(state: State) -> str:
    """Name of a state's local variable; the underscore keeps it apart from every name that the kernels use."""
    return f"{state.name}_"


def _plain_symbols(e: Expr) -> Expr:
    return e.xreplace({s: Symbol(local_name(s), real=True) for s in e.atoms(State)})


def _fresh() -> Iterable[Symbol]:
    i = 0
    while True:
        yield Symbol(f"w{i}", real=True)
        i += 1


def _reads(places: dict, names: dict, where: Sequence[Expr]) -> list[tuple[Read, list[tuple[Symbol, Expr]]]]:
    out, k = [], 0
    for i, ((table, coordinates), calls) in enumerate(places.items()):
        made = [(Symbol(f"z{i}_{j}", real=True), where[k + j]) for j in range(len(coordinates))]
        k += len(coordinates)
        outputs = tuple((e.output, e.orders, names[e]) for e in calls)
        out.append((Read(table, tuple(z for z, _ in made), outputs), made))
    return out


def _ordered(
    shared: list[tuple[Symbol, Expr]], reads: list[tuple[Read, list[tuple[Symbol, Expr]]]]
) -> list[tuple[Symbol, Expr] | Read]:
    """Put table readings as early as their coordinates allow, everything else where its inputs are known."""
    pending_names = {s for s, _ in shared} | {o[2] for r, _ in reads for o in r.outputs}
    done: set[Symbol] = set()
    steps: list[tuple[Symbol, Expr] | Read] = []

    def ready(e: Expr) -> bool:
        return not (e.free_symbols & pending_names) - done

    waiting, waiting_reads = list(shared), list(reads)
    while waiting or waiting_reads:
        before = len(waiting) + len(waiting_reads)
        for item in list(waiting_reads):
            read, made = item
            if all(ready(e) for _, e in made):
                steps += [*made, read]
                done |= {o[2] for o in read.outputs}
                waiting_reads.remove(item)
        rest = []
        for symbol, e in waiting:
            if ready(e):
                steps.append((symbol, e))
                done.add(symbol)
            else:
                rest.append((symbol, e))
        waiting = rest
        if len(waiting) + len(waiting_reads) == before:
            raise ModelError("a table's coordinates depend on its own outputs")
    return steps
