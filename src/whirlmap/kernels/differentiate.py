"""The Jacobian of straight-line code, by forward differentiation of its assignments.

Differentiating the whole expressions and sharing subexpressions afterwards takes SymPy a minute for a film read from a
table; going through assignments that are shared already takes a second, and gives the shorter code. Derivatives are taken
by *seeds*: the states, and every assignment that is a linear form of states with constant coefficients (a shaft's
deflection), so that the parts of a linear form are not differentiated one by one. Along a single direction there is one
seed, the direction itself.
"""

from collections.abc import Mapping
from dataclasses import replace

from sympy import DiracDelta, Expr, Integer, Symbol, sympify

from whirlmap.kernels.lower import Hoisted, Read, Straight, inverse, root, split_powers

Slopes = dict[Symbol, Expr]


def jacobian_code(
    lines: Straight, variables: list[Symbol], hoisted: Hoisted
) -> tuple[Straight, dict[tuple[int, int], Expr]]:
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
    entries : dict of (row, column) to Expr
        All non-zero entries; numbers, kernel inputs, or the expression that the code computes.
    """
    writer = _Forward({v: {v: Integer(1)} for v in variables}, hoisted, forms=True)
    for step in lines.steps:
        writer.read(step) if isinstance(step, Read) else writer.assign(*step)
    entries: dict[tuple[int, int], Expr] = {}
    for i, result in enumerate(lines.results):
        by_variable: Slopes = {}
        for seed, slope in writer.slopes(result).items():
            for variable, weight in writer.linear.get(seed, {seed: Integer(1)}).items():
                by_variable[variable] = by_variable.get(variable, Integer(0)) + weight * slope
        for j, variable in enumerate(variables):
            entry = by_variable.get(variable, Integer(0))
            if entry != 0:
                entries[i, j] = writer.hoist(entry)
    moving = [e for e in entries.values() if e.free_symbols and e not in hoisted.symbols]
    return _needed(Straight(tuple(writer.steps), (*lines.results, *moving))), entries


#: The seed of derivatives along one direction.
DIRECTION = Symbol("direction", real=True)


def along_code(lines: Straight, variables: list[Symbol], direction: list[Symbol], hoisted: Hoisted) -> Straight:
    """Differentiate straight-line code along one direction.

    Parameters
    ----------
    direction : list of Symbol
        Names of the direction's components, in the order of the variables.

    Returns
    -------
    Straight
        Its results are those of the code, then the derivative of each. For one direction this costs half of the Jacobian
        and its product with the direction; from about five directions on, the Jacobian is cheaper.
    """
    seeds: dict[Symbol, Slopes] = {v: {DIRECTION: d} for v, d in zip(variables, direction, strict=True)}
    writer = _Forward(seeds, hoisted, forms=False)
    for step in lines.steps:
        writer.read(step) if isinstance(step, Read) else writer.assign(*step)
    slopes = [writer.slopes(result).get(DIRECTION, Integer(0)) for result in lines.results]
    return _needed(Straight(tuple(writer.steps), (*lines.results, *slopes)))


class _Forward:
    """Derivatives of assignments by seeds, each put into an assignment of its own unless it is trivial."""

    def __init__(self, by_seed: dict[Symbol, Slopes], hoisted: Hoisted, *, forms: bool) -> None:
        self.hoisted = hoisted
        self.steps: list[tuple[Symbol, Expr] | Read] = []
        self.variables = set(by_seed)
        self.by_seed = by_seed
        self.linear: dict[Symbol, Slopes] = {}
        self.forms = forms
        self.count = 0

    def assign(self, symbol: Symbol, e: Expr) -> None:
        """Take over an assignment, and differentiate it."""
        self.steps.append((symbol, e))
        weights = self._linear_form(e) if self.forms else {}
        if weights and len(weights) > 1:
            self.linear[symbol], self.by_seed[symbol] = weights, {symbol: Integer(1)}
            return
        slopes = {seed: self._name(slope) for seed, slope in self.slopes(e).items()}
        if slopes:
            self.by_seed[symbol] = slopes

    def read(self, step: Read) -> None:
        """Take over a table reading, with the derivatives of its outputs by its coordinates."""
        outputs = list(step.outputs)
        for output, orders, symbol in step.outputs:
            slopes: Slopes = {}
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

    def slopes(self, e: Expr) -> Slopes:
        """Derivatives of an expression by every seed that it depends on (chain rule over its symbols)."""
        out: Slopes = {}
        for symbol in sorted(e.free_symbols & set(self.by_seed), key=str):
            partial = self._name(_derivative(e, symbol))
            for seed, inner in self.by_seed[symbol].items():
                out[seed] = out.get(seed, Integer(0)) + partial * inner
        return {seed: slope for seed, slope in out.items() if slope != 0}

    def _linear_form(self, e: Expr) -> Slopes:
        """Weights of the states in a linear form with constant coefficients; empty where it is none."""
        out: Slopes = {}
        for symbol in e.free_symbols:
            weight = e.diff(symbol)
            parts = {symbol: Integer(1)} if symbol in self.variables else self.linear.get(symbol)
            if parts is None or not weight.is_number:
                return {}
            for variable, inner in parts.items():
                out[variable] = out.get(variable, Integer(0)) + weight * inner
        return out

    def hoist(self, e: Expr) -> Expr:
        """The kernel input that an expression of inputs alone becomes; any other expression as it is."""
        inputs = dict(zip(self.hoisted.symbols, self.hoisted.expressions, strict=True))
        constant = bool(e.free_symbols) and e.free_symbols <= set(inputs)
        return self.hoisted.symbol(e.xreplace(inputs)) if constant else e

    def _name(self, e: Expr) -> Expr:
        if e.is_number or e.is_Symbol or (-e).is_Symbol:
            return e
        e = self.hoist(e)
        if e.is_Symbol:
            return e
        symbol = Symbol(f"v{self.count}", real=True)
        self.count += 1
        self.steps.append((symbol, e))
        return symbol


def _derivative(e: Expr, symbol: Symbol) -> Expr:
    """Derivative by a symbol, square roots and reciprocals kept in the form that is printed."""
    calls = [a for a in e.atoms(root, inverse) if a.has(symbol)]
    if not calls:
        return _printable(e.diff(symbol))
    stand_in = {call: Symbol(f"call{i}", real=True) for i, call in enumerate(calls)}
    outermost = e.xreplace(stand_in)
    back: Mapping[Expr, Expr] = {s: call for call, s in stand_in.items()}
    total = outermost.diff(symbol).xreplace(back)
    for call, s in stand_in.items():
        outer = outermost.diff(s).xreplace(back)
        if outer != 0:
            inner = inverse(call) / 2 if isinstance(call, root) else -(call**2)
            total += outer * inner * _derivative(call.args[0], symbol)
    return _printable(total)


def _printable(derivative: Expr) -> Expr:
    """The derivative on either side of a jump (that of ``sign`` is zero), its powers split as in the code before it."""
    return split_powers(sympify(derivative).replace(DiracDelta, lambda *_: Integer(0)))


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
