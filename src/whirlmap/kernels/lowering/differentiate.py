"""The Jacobian of straight-line code, by forward differentiation of its assignments.

Differentiating the whole expressions and sharing subexpressions afterwards takes SymPy a minute for a film read from a
table; going through assignments that are shared already takes a second, and gives the shorter code. Derivatives are taken
by *seeds*: the states, and every assignment that is a linear form of states with constant coefficients (a shaft's
deflection), so that the parts of a linear form are not differentiated one by one. A form of `WIDE` states or more may have
parameters in its coefficients: the deflection of teeth between two shafts of many modes acts on each of them, and the
entries by the states would be the product of their numbers. An assignment that depends on several
seeds and serves several others (the square of the eccentricity) is an intermediate seed: what depends on it is
differentiated by it alone, and the chain rule is applied once at the end. A directional derivative has one seed, the
direction itself.

Two rules save a tenth of the operations in a film's derivatives. A sum inside of a product is differentiated as one term.
A product of roots and reciprocals is differentiated logarithmically: its derivative is the product times the sum of its
factors' *rates*, each factor's derivative over the factor itself.
"""

from collections import Counter
from dataclasses import replace

from sympy import Add, Expr, Integer, Mul, Piecewise, Symbol

from whirlmap.kernels.lowering.derivative import base_and_exponent, derivative
from whirlmap.kernels.lowering.guards import Guards
from whirlmap.kernels.lowering.lower import Hoisted, Read, Straight
from whirlmap.kernels.lowering.powers import inverse, root

Gradient = dict[Symbol, Expr]


#: States of a linear form from which its coefficients may contain parameters.
WIDE = 8
#: Derivatives of results: by number of the result, and by seed.
Entries = dict[tuple[int, Symbol], Expr]
#: Linear forms of states: by seed, the weight of each state, a number or a kernel input.
Forms = dict[Symbol, Gradient]


def jacobian_code(
    lines: Straight, variables: list[Symbol], hoisted: Hoisted
) -> tuple[Straight, Entries, Forms]:
    """Differentiate straight-line code.

    Parameters
    ----------
    lines : Straight
    variables : list of Symbol
        Names of the states in the code, in declared order.
    hoisted : Hoisted
        Entries that depend on parameters alone become kernel inputs here.

    Returns
    -------
    code : Straight
        The given code with the assignments of the derivatives; its results are those of the code, then the entries that
        depend on the state, in the order of those entries. One pass through the lanes gives both.
    entries : Entries
        All that are not zero; numbers, kernel inputs, or the expression that the code computes.
    forms : Forms
        The seeds among them that are no states.
    """
    writer = _Forward({v: {v: Integer(1)} for v in variables}, hoisted, lines, uses=_uses(lines))
    for step in lines.steps:
        writer.read(step) if isinstance(step, Read) else writer.assign(*step)
    entries: Entries = {}
    for i, result in enumerate(lines.results):
        for seed, slope in writer.by_last_seeds(result).items():
            entries[i, seed] = writer.hoist(slope)
    moving = [e for e in entries.values() if e.free_symbols and e not in hoisted.places]
    forms = {seed: writer.linear[seed] for _, seed in entries if seed in writer.linear}
    return _needed(Straight(tuple(writer.steps), (*lines.results, *moving))), entries, forms


#: The seed of directional derivatives (Jacobian-vector products).
DIRECTION = Symbol("direction", real=True)


def along_code(lines: Straight, variables: list[Symbol], direction: list[Symbol], hoisted: Hoisted) -> Straight:
    """Differentiate straight-line code in one direction: a Jacobian-vector product.

    Parameters
    ----------
    direction : list of Symbol
        Names of the direction's components, in the order of the variables.

    Returns
    -------
    Straight
        Its results are those of the code, then the derivative of each. For one direction this costs four fifths of the
        Jacobian and its product with the direction; for two, the Jacobian is cheaper.
    """
    seeds: dict[Symbol, Gradient] = {v: {DIRECTION: d} for v, d in zip(variables, direction, strict=True)}
    writer = _Forward(seeds, hoisted, lines)
    for step in lines.steps:
        writer.read(step) if isinstance(step, Read) else writer.assign(*step)
    slopes = [writer.slopes(result).get(DIRECTION, Integer(0)) for result in lines.results]
    return _needed(Straight(tuple(writer.steps), (*lines.results, *slopes)))


class _Forward:
    """Derivatives of assignments by seeds, each put into an assignment of its own unless it is trivial."""

    def __init__(
        self, by_seed: dict[Symbol, Gradient], hoisted: Hoisted, lines: Straight, *, uses: Counter[Symbol] | None = None
    ) -> None:
        self.hoisted, self.roots, self.guards = hoisted, _roots(lines), Guards(lines)
        self.steps: list[tuple[Symbol, Expr] | Read] = []
        self.variables = set(by_seed)
        self.by_seed = by_seed
        self.linear: dict[Symbol, Gradient] = {}
        self.intermediate: dict[Symbol, Gradient] = {}
        self.rates: dict[Symbol, Gradient] = {}
        self.uses = uses
        self.count = 0

    def assign(self, symbol: Symbol, e: Expr) -> None:
        """Take over an assignment, and differentiate it."""
        self.steps.append((symbol, e))
        weights = self._linear_form(e) if self.uses is not None else {}
        if weights:
            weights = {variable: self.hoist(weight) for variable, weight in weights.items()}
            self.linear[symbol] = weights
            if len(e.free_symbols & set(self.by_seed)) > 1:  # else it is a multiple of a seed that there is
                self.by_seed[symbol] = {symbol: Integer(1)}
                return
        rates = self._rates(e)
        if rates:
            self.rates[symbol] = {seed: self._name(rate) for seed, rate in rates.items()}
            slopes = {seed: self._name(symbol * rate) for seed, rate in self.rates[symbol].items()}
        else:
            slopes = {seed: self._name(slope) for seed, slope in self.slopes(self._parted(e)).items()}
        if self.uses is not None and len(slopes) > 1 and self.uses[symbol] > 1 and symbol not in self.guards.hidden:
            self.intermediate[symbol], slopes = slopes, {symbol: Integer(1)}
        if slopes:
            self.by_seed[symbol] = slopes

    def read(self, step: Read) -> None:
        """Take over a table reading, with the derivatives of its outputs by its coordinates."""
        outputs = list(step.outputs)
        for output, orders, symbol in step.outputs:
            slopes: Gradient = {}
            for axis, coordinate in enumerate(step.coordinates):
                seeds = self.by_seed.get(coordinate, {})
                if not seeds:
                    continue
                raised = tuple(n + (a == axis) for a, n in enumerate(orders))
                slope = Symbol(f"{symbol.name}_{axis}", real=True)
                outputs.append((output, raised, slope))
                for seed, inner in seeds.items():
                    slopes[seed] = slopes.get(seed, Integer(0)) + slope * inner
            self.by_seed[symbol] = slopes
        self.steps.append(replace(step, outputs=tuple(outputs)))
        for _, _, symbol in step.outputs:
            self.by_seed[symbol] = {seed: self._name(e) for seed, e in self.by_seed[symbol].items()}

    def slopes(self, e: Expr) -> Gradient:
        """Derivatives of an expression by every seed that it depends on (chain rule over its symbols)."""
        terms = self.guards.terms(e)
        if terms == [e]:
            return self._by_branch(e)
        e = e.xreplace({term: self._part(term) for term in terms})
        out: Gradient = {}
        for symbol, holding in self._holding(e):
            partial = self._name(derivative(holding, symbol))
            for seed, inner in self.by_seed[symbol].items():
                out[seed] = out.get(seed, Integer(0)) + partial * inner
        return {seed: slope for seed, slope in out.items() if slope != 0}

    def _holding(self, e: Expr) -> list[tuple[Symbol, Expr]]:
        """Symbols of an expression that have derivatives, each with the terms of the sum that hold it."""
        terms: dict[Symbol, list[Expr]] = {}
        for term in Add.make_args(e):
            for symbol in term.free_symbols:
                if symbol in self.by_seed:
                    terms.setdefault(symbol, []).append(term)
        return [(symbol, Add(*terms[symbol])) for symbol in sorted(terms, key=str)]

    def _by_branch(self, e: Piecewise) -> Gradient:
        """Derivatives of a guarded term, branch by branch: an infinite slope is never multiplied by zero."""
        branches = [(self.slopes(pair.expr), pair.cond) for pair in e.args]
        seeds = sorted({seed for slopes, _ in branches for seed in slopes}, key=str)
        chosen = {
            seed: Piecewise(*((self._name(slopes.get(seed, Integer(0))), condition) for slopes, condition in branches))
            for seed in seeds
        }  # fmt: skip
        return {seed: slope for seed, slope in chosen.items() if slope != 0}

    def by_last_seeds(self, e: Expr) -> Gradient:
        """Derivatives of an expression by the states and linear forms, by the chain rule through the intermediate seeds."""
        out = self.slopes(self._parted(e))
        for seed, inner in reversed(self.intermediate.items()):
            if seed in out:
                slope = self._name(out.pop(seed))
                for other, weight in inner.items():
                    out[other] = out.get(other, Integer(0)) + slope * weight
        return {seed: slope for seed, slope in out.items() if slope != 0}

    def _linear_form(self, e: Expr) -> Gradient:
        """Weights of the states in a linear form with any constant; empty where it is none.

        They are numbers, or of `WIDE` states or more expressions of kernel inputs.
        """
        out: Gradient = {}
        for symbol, holding in self._holding(e):
            weight = holding.diff(symbol)
            parts = {symbol: Integer(1)} if symbol in self.variables else self.linear.get(symbol)
            if parts is None or not self._fixed(weight):
                return {}
            for variable, inner in parts.items():
                out[variable] = out.get(variable, Integer(0)) + weight * inner
        return out if len(out) >= WIDE or all(weight.is_number for weight in out.values()) else {}

    def _fixed(self, e: Expr) -> bool:
        """Whether an expression is a number, or one of kernel inputs alone."""
        return all(q in self.hoisted.places for q in e.free_symbols)

    def _parted(self, e: Expr) -> Expr:
        """The expression with assignments of their own for sums inside of products and for factors that have rates."""
        if isinstance(e, Add):
            return e.func(*[self._parted(term) for term in e.args])
        if not isinstance(e, Mul):
            return e
        with_rates = [f for f in e.args if f.free_symbols and self._rate(base_and_exponent(f)[0]) is not None]
        product = Mul(*with_rates)
        others = [f for f in e.args if f not in with_rates]
        sums = [f for f in others if isinstance(f, Add) and not self._linear_form(f)]
        named = [self._part(f) if f in sums else f for f in others]
        return Mul(self._part(product) if self._rates(product) else product, *named)

    def _part(self, e: Expr) -> Expr:
        """The name of a part of an expression, differentiated."""
        if e.is_Symbol:
            return e
        symbol = self._new()
        if self.uses is not None:
            self.uses[symbol] = 2  # an intermediate seed, if it depends on several
        self.assign(symbol, e)
        return symbol

    def _rates(self, e: Expr) -> Gradient:
        """Logarithmic derivatives of a product by seed; empty where no factor is a root or a reciprocal."""
        factors = [base_and_exponent(f) for f in Mul.make_args(e)]
        if not any(isinstance(base, root | inverse) or base in self.rates for base, _ in factors):
            return {}
        out: Gradient = {}
        for base, exponent in factors:
            rate = self._rate(base)
            if rate is None:
                return {}
            for seed, value in rate.items():
                out[seed] = out.get(seed, Integer(0)) + exponent * value
        return out

    def _rate(self, e: Expr) -> Gradient | None:
        """Logarithmic derivatives of a factor by seed, or None if a new division would be needed."""
        if e in self.rates or not e.free_symbols & set(self.by_seed):
            return self.rates.get(e, {})
        inner = e.args[0] if isinstance(e, root | inverse) else e
        if isinstance(e, inverse) and not isinstance(inner, root):
            scale = -e
        elif isinstance(e, inverse):
            inner, scale = inner.args[0], -(e**2) / 2
        elif isinstance(e, root):
            scale = inverse(e) ** 2 / 2
        elif e in self.roots:
            scale = inverse(root(e)) ** 2
        else:
            return None
        return {seed: scale * slope for seed, slope in self.slopes(inner).items()}

    def hoist(self, e: Expr) -> Expr:
        """The kernel input that an expression of inputs alone becomes; any other expression as it is."""
        own = e.free_symbols
        if not own or not self._fixed(e):
            return e
        return self.hoisted.symbol(e.xreplace({q: self.hoisted.expressions[self.hoisted.places[q]] for q in own}))

    def _name(self, e: Expr) -> Expr:
        if e.is_number or e.is_Symbol or (-e).is_Symbol:
            return e
        e = self.hoist(e)
        if e.is_Symbol:
            return e
        symbol = self._new()
        self.steps.append((symbol, e))
        return symbol

    def _new(self) -> Symbol:
        self.count += 1
        return Symbol(f"v{self.count - 1}", real=True)


def _roots(lines: Straight) -> set[Expr]:
    """What the code takes square roots of, and so their reciprocals too."""
    expressions = [*(step[1] for step in lines.steps if isinstance(step, tuple)), *lines.results]
    return {call.args[0] for e in expressions for call in e.atoms(root)}


def _uses(lines: Straight) -> Counter[Symbol]:
    """How many assignments, outputs of readings and results depend directly on each symbol."""
    uses: Counter[Symbol] = Counter()
    for step in lines.steps:
        if isinstance(step, Read):
            uses.update({z: len(step.outputs) for z in step.coordinates})
        else:
            uses.update(step[1].free_symbols)
    for result in lines.results:
        uses.update(result.free_symbols)
    return uses


def _needed(lines: Straight) -> Straight:
    """The assignments and outputs that the results depend on."""
    wanted: set[Symbol] = set()
    for result in lines.results:
        wanted |= result.free_symbols
    kept: list[tuple[Symbol, Expr] | Read] = []
    for step in reversed(lines.steps):
        if isinstance(step, Read):
            outputs = tuple(o for o in step.outputs if o[2] in wanted)
            if outputs:
                kept.append(replace(step, outputs=outputs))
                wanted |= set(step.coordinates)
        elif step[0] in wanted:
            kept.append(step)
            wanted |= step[1].free_symbols
    return Straight(tuple(reversed(kept)), lines.results)
