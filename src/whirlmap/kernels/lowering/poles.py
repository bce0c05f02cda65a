"""Poles of a model: denominators of its equations that vanish at some state, where a rate grows without bound.

A step may jump over a pole and end at finite numbers behind it, as though nothing had been there. So the sign of such a
denominator must be the same at both ends of a step. Poles are found numerically, from a fixed set of states and
parameter values: along lines of all magnitudes the first change of sign of a denominator is located, and it is a pole
if a rate grows towards it. That leaves out denominators that never vanish (``x^2 + a^2``), zeros that the numerator
shares (``sin(x)/x``), and those behind a closed gap, where the run has ended before (the films at an eccentricity of one).
"""

from collections.abc import Callable, Iterator, Sequence
from copy import copy
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sympy import Abs, Add, Expr, Max, Min, Mul, Piecewise, Pow, Symbol, cos, sign, sqf_list, sympify, tan

from whirlmap.equations.model import Model
from whirlmap.equations.pieces import tabulated
from whirlmap.equations.quantities import Parameter, t
from whirlmap.kernels.lowering.formulas import array_function

Array = NDArray[np.float64]

#: Sets of parameter values, and lines for each of them and for each magnitude of the states, along which zeros are sought.
SETS, LINES, MAGNITUDES = 4, 6, np.logspace(-12, 9, 22)
#: Places on a line, in units of the magnitude.
PLACES = np.linspace(-4.0, 4.0, 60)
#: Distances from a zero, over the magnitude, and growth of a rate from each to the next that makes it a pole.
NEAR, GROWS = (1e-6, 1e-8, 1e-10), 2.0
#: A gap below this at a pole ends the run before it.
CLOSED = 1e-3
#: Largest polynomial, in operations, that is split into factors.
SPLIT = 12


@lru_cache(maxsize=32)
def poles(model: Model) -> tuple[Expr, ...]:
    """Denominators of the equations that vanish at poles, each once."""
    lines = _Lines(model)
    return tuple(base for base, rates in _candidates(model).items() if _is_pole(model, lines, base, rates))


def pole_guards(model: Model) -> list[Expr]:
    """For every pole what must keep its sign: the denominator, or one where parameters make its numerators zero."""
    out = []
    for base in poles(model):
        terms = [e for rate in model.equations.values() for e in Add.make_args(sympify(rate)) if base in _denominators(e)]
        there = sign(Add(*(Abs(_strength(e, model)) for e in terms)))
        out.append(there * base + 1 - there)
    return out


def _strength(term: Expr, model: Model) -> Expr:
    """Product of a term's factors that hold parameters alone."""
    alone = set(model.parameters)
    return Mul(*(factor for factor in Mul.make_args(term) if factor.free_symbols and factor.free_symbols <= alone))


def _candidates(model: Model) -> dict[Expr, list[Expr]]:
    """Smooth denominators that hold states and no time, with the rates that hold them."""
    states = set(model.states)
    out: dict[Expr, list[Expr]] = {}
    for state in model.states:
        rate = sympify(model.equations[state])
        for base in dict.fromkeys(_denominators(rate)):
            if base.free_symbols & states and not base.has(t, tabulated, Abs, sign, Piecewise, Max, Min):
                out.setdefault(base, []).append(rate)
    return out


def _denominators(rate: Expr) -> Iterator[Expr]:
    for power in sorted(rate.atoms(Pow), key=str):
        if power.exp.could_extract_minus_sign():
            yield from _factors(power.base)
    for call in sorted(rate.atoms(tan), key=str):
        yield cos(call.args[0])


def _factors(base: Expr) -> Iterator[Expr]:
    """Factors of a denominator, for a zero of even order changes no sign."""
    if isinstance(base, Add) and base.is_polynomial() and base.count_ops() < SPLIT:
        parts = sqf_list(base)[1]
        if any(order > 1 for _, order in parts):
            yield from (part for part, _ in parts)
            return
    for factor in base.args if isinstance(base, Mul) else (base,):
        yield factor.base if isinstance(factor, Pow) else factor


def _is_pole(model: Model, line: "_Lines", base: Expr, rates: list[Expr]) -> bool:
    if base.is_positive or base.is_negative:
        return False
    with np.errstate(all="ignore"):
        zero, before = line.zeros(base)
        line = line.keep(np.isfinite(zero))
        zero, before = (v[np.isfinite(zero)] for v in (zero, before))
        for stop in model.stops.values():
            closed = line.evaluate(sympify(stop.gap), before) < CLOSED
            line, zero, before = line.keep(~closed), zero[~closed], before[~closed]
        if not zero.size:
            return False
        side = np.sign(before - zero)
        for rate in rates:
            flat = rate.xreplace(dict.fromkeys(rate.atoms(tabulated), sympify(1)))
            size = np.abs(line.evaluate(flat, np.stack([zero + d * side for d in NEAR])))
            if (size[1:] > GROWS * size[:-1]).all(axis=0).any():
                return True
    return False


class _Lines:
    """Lines through the states of a model, each with its own values of the parameters, and its own magnitude."""

    def __init__(self, model: Model) -> None:
        rng = np.random.default_rng(3)
        count = SETS * LINES * MAGNITUDES.size
        size = np.tile(MAGNITUDES, SETS * LINES)
        symbols = [*model.states, *model.parameters, t]
        self.plain = {q: Symbol(f"p{i}") for i, q in enumerate(symbols)}  # a parameter named exp would hide the function
        self.functions: dict[Expr, Callable[..., Sequence[Any]]] = {}
        self.begin, self.along = (size * rng.normal(size=(model.dimension, count)) for _ in range(2))
        values = [np.repeat(_allowed(p, rng), LINES * MAGNITUDES.size) for p in model.parameters]
        self.values = np.array([*values, rng.uniform(0, 10, count)])

    def keep(self, which: NDArray[np.bool_]) -> "_Lines":
        """Some of the lines."""
        made = copy(self)
        made.begin, made.along, made.values = self.begin[:, which], self.along[:, which], self.values[:, which]
        return made

    def evaluate(self, expression: Expr, place: Array) -> Array:
        """An expression at one place of every line, or at many: shape (..., line)."""
        x = [b + place * a for b, a in zip(self.begin, self.along, strict=True)]
        values = [np.broadcast_to(v, place.shape) for v in self.values]  # conditions are joined in arrays of one shape
        (value,) = self._function(expression)(*x, *values)
        return np.broadcast_to(np.asarray(value, dtype=float), place.shape)

    def _function(self, expression: Expr) -> Callable[..., Sequence[Any]]:
        """An expression as a function of arrays, kept: the gaps are asked for at every denominator."""
        if expression not in self.functions:
            plain = expression.xreplace(self.plain)
            self.functions[expression] = array_function(list(self.plain.values()), [plain], share=True)
        return self.functions[expression]

    def zeros(self, base: Expr) -> tuple[Array, Array]:
        """First zero of an expression on every line, and the place before it that was tried; NaN where there is none."""
        function = self._function(base)

        def sign(place: Array) -> Array:
            x = [b + place * a for b, a in zip(self.begin, self.along, strict=True)]
            return np.broadcast_to(np.sign(np.asarray(function(*x, *self.values)[0], dtype=float)), place.shape)

        lines = self.begin.shape[1]
        signs = sign(np.repeat(PLACES[:, None], lines, axis=1))
        changes = signs[1:] * signs[:-1] < 0
        first = changes.argmax(axis=0)
        low, high = PLACES[first], PLACES[first + 1]
        before, side = low.copy(), np.take_along_axis(signs, first[None], axis=0)[0]
        for _ in range(55):
            middle = (low + high) / 2
            same = sign(middle) == side
            low, high = np.where(same, middle, low), np.where(same, high, middle)
        crossed = changes.any(axis=0)
        return np.where(crossed, low, np.nan), np.where(crossed, before, np.nan)


def _allowed(parameter: Parameter, rng: np.random.Generator) -> Array:
    """Values near one that a parameter may have."""
    below = np.inf if parameter.below is None else parameter.below
    least = max(v for v in (parameter.above, parameter.at_least, -np.inf) if v is not None)
    if np.isfinite(below) and np.isfinite(least):
        return np.asarray(rng.uniform(least, below, SETS))
    size = np.exp(rng.uniform(-1, 1, SETS))
    return np.asarray(below - size if np.isfinite(below) and below <= 3 else max(least, 0.0) + size)
