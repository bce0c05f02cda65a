"""Compiled expressions give the float of `value_of`, to the bit."""

import random
from fractions import Fraction

import pytest
import sympy as sp

from whirlmap.equations import exact_values
from whirlmap.equations.exact_values import float_function
from whirlmap.equations.groups import value_of

a, b, c = sp.symbols("a b c", real=True)
HALF = sp.Rational(1, 2)
COMPILED = [
    a * b / c**3, sp.sqrt(a / b) * c, a + b * c - HALF, sp.pi * a * b, sp.sqrt(a) * sp.sqrt(b) ** 3 / c**2,
    sp.sqrt(a + b / c),
    1 / sp.sqrt(a * b), sp.cos(HALF) * a, sp.sqrt(2) * a, sp.Abs(a - b) * c, sp.sign(a - b) * sp.sqrt(c), sp.sqrt(a) + b,
    sp.sqrt(a) - sp.sqrt(b), sp.cos(a) * b + sp.pi / 2 - c, sp.tan(a - b) / sp.cos(c), sp.log(a) * b, sp.atan(a) - b**4,
    sp.exp(a) / c, sp.sin(a) * sp.sqrt(sp.cos(b / 4)),
]  # fmt: skip
LEFT = [sp.sin(sp.sqrt(a)), sp.Max(a, b), a ** sp.Rational(1, 3), sp.Piecewise((a, a > b), (b, True))]


def draws(seed, count=60):
    chance = random.Random(seed)
    for k in range(count):
        digits = (1, 3, 16)[k % 3]  # few digits give roots that are exact, and ties
        yield {n: Fraction(str(round(chance.uniform(0, 2), digits))) + Fraction(1, 10**digits) for n in "abc"}


@pytest.mark.parametrize("expression", COMPILED + LEFT, ids=str)
def test_floats_are_those_of_sympy(expression):
    found = float_function(expression)
    for values in draws(3):
        assert found(values) == float(value_of(expression, values)), values


@pytest.mark.parametrize("expression", COMPILED, ids=str)
def test_sympy_is_not_asked(expression, monkeypatch):
    found, values = float_function(expression), {"a": Fraction(7, 5), "b": Fraction(3, 10), "c": Fraction(11, 10)}
    expected = float(value_of(expression, values))
    monkeypatch.setattr(exact_values, "value_of", None)
    assert found(values) == expected


@pytest.mark.parametrize(
    ("expression", "values"),
    [
        (sp.sqrt(a) - sp.sqrt(b), {"a": Fraction(2), "b": Fraction(2)}),  # zero, which no digits show
        (sp.sqrt(a) - b, {"a": Fraction(2), "b": Fraction(15241578750190521, 10777523421101760)}),
        (sp.sqrt(a) * b, {"a": Fraction(1, 4), "b": Fraction(2**54 + 1, 2**54)}),  # a tie of two floats
        (1 / a, {"a": Fraction(0)}), (sp.sqrt(a), {"a": Fraction(-1)}),
        (sp.sqrt(a) / b, {"a": Fraction(2), "b": Fraction(0)}),
        (a**3 * sp.sqrt(b), {"a": Fraction(10) ** 120, "b": Fraction(2)}),  # beyond the floats
        (a**3 * sp.sqrt(b), {"a": Fraction(10) ** -105, "b": Fraction(2)}),  # with few bits left
        (sp.sign(a - sp.sqrt(b)), {"a": Fraction(2), "b": Fraction(4)}), (sp.cos(a), {"a": Fraction(10) ** 20}),
        (sp.log(a), {"a": Fraction(1)}), (sp.log(a), {"a": Fraction(-1)}), (sp.tan(a), {"a": Fraction(0)}),
    ],
)  # fmt: skip
def test_edges_are_sympys(expression, values):
    found, expected = float_function(expression)(values), float(value_of(expression, values))
    assert found == expected or (found != found and expected != expected)
