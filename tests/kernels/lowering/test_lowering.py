"""From declarations to straight-line code: every kind of term, against NumPy written by hand."""

import numpy as np
import pytest
import sympy as sp

from contest.scalar_code import code
from whirlmap.equations import Model, Parameter, State, cbrt, cos, pi, sign, sin, sqrt, t, when
from whirlmap.errors import ModelError
from whirlmap.integrate.system import System
from whirlmap.kernels.lowering.formulas import HoistedFunction
from whirlmap.kernels.lowering.lower import Hoisted, hoist, split_harmonics, straight
from whirlmap.kernels.lowering.powers import inverse, power, root, split_powers

x, v, w = (State(n, "1", n) for n in ("x", "v", "w"))
a, b, omega, nu, chi = (Parameter(n, "1", n) for n in ("a", "b", "omega", "nu", "chi"))
c0, s0, c1, s1 = (sp.Symbol(n, real=True) for n in ("c0", "s0", "c1", "s1"))


def model(equations, parameters=(a, b, omega, nu, chi), harmonics=(), **more):
    used = set().union(*(sp.sympify(e).free_symbols for e in (*equations.values(), *harmonics)))
    return Model("sink", tuple(equations), tuple(p for p in parameters if p in used), equations, harmonics=harmonics, **more)


# --- harmonics ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("term", "expected"),
    [
        (cos(omega * t), c0),
        (sin(omega * t), s0),
        (cos(-omega * t), c0),
        (sin(-omega * t), -s0),
        (cos(2 * nu * t), c1),
        (sin(omega * t + chi), s0 * cos(chi) + c0 * sin(chi)),
        (cos(omega * t - chi), c0 * cos(chi) + s0 * sin(chi)),
        (cos(chi - omega * t), c0 * cos(chi) + s0 * sin(chi)),
        (sin(chi - 2 * nu * t), c1 * sin(chi) - s1 * cos(chi)),
        (cos(omega * (t + a)), c0 * cos(a * omega) - s0 * sin(a * omega)),
        (x * cos(omega * t) ** 2, x * c0**2),
    ],
)
def test_harmonics_are_rotations_of_the_declared_ones(term, expected):
    got = split_harmonics(term, [omega, 2 * nu])
    assert sp.expand(got - expected) == 0


@pytest.mark.parametrize(
    ("term", "word"),
    [
        (cos(3 * omega * t), "not declared"),
        (cos(omega * t**2), "linear in time"),
        (t * x, "sines and cosines"),
        (sp.exp(-t), "sines and cosines"),
    ],
)
def test_time_in_any_other_way_is_refused(term, word):
    with pytest.raises(ModelError, match=word):
        split_harmonics(term, [omega])


def test_time_without_harmonics_is_refused_at_the_declaration():
    with pytest.raises(ModelError, match="declares no harmonics"):
        model({x: cos(omega * t)})


# --- hoisting ----------------------------------------------------------------------------------------------


def test_what_depends_on_parameters_alone_leaves_the_kernel():
    hoisted = Hoisted((a, b, omega))
    got = hoist(-2 * a / sqrt(b) * x + sp.exp(a * b) * sin(x) + a + omega**2, hoisted)
    assert not got.free_symbols & {a, b, omega}
    assert len(hoisted.expressions) == 3  # one coefficient each for x and sin x, and the constant
    values = np.array([[2.0, 3.0], [4.0, 9.0], [0.5, 0.1]])
    numbers = HoistedFunction.of(hoisted.parameters, hoisted.expressions).evaluate(values)
    back = got.subs({x: 0.7, **{q: numbers[i, 1] for i, q in enumerate(hoisted.symbols)}})
    assert float(back) == pytest.approx(-6 / 3 * 0.7 + np.exp(27) * np.sin(0.7) + 3.01, rel=1e-14)


def test_equal_expressions_share_one_input():
    hoisted = Hoisted((a, b))
    hoist(a / b * x, hoisted)
    hoist(a / b * v + x**2, hoisted)
    assert len(hoisted.symbols) == 1


def test_numbers_stay_in_the_code():
    hoisted = Hoisted((a,))
    assert hoist(3 * x / 7, hoisted) == 3 * x / 7
    assert hoisted.expressions == []
    assert HoistedFunction.of(hoisted.parameters, []).evaluate(np.zeros((1, 4))).shape == (0, 4)


# --- powers ------------------------------------------------------------------------------------------------

QUARTERS = [sp.Rational(n, 4) for n in range(-13, 14) if n]


@pytest.mark.parametrize("exponent", QUARTERS, ids=str)
def test_powers_by_quarters(exponent):
    text = code(split_powers((1 + x) ** exponent))
    assert "**" not in text
    got = eval(text, {"x": 0.7, "sqrt": np.sqrt})
    assert got == pytest.approx(1.7 ** float(exponent), rel=4e-16 * 16)  # a dozen roundings at most


@pytest.mark.parametrize("exponent", [sp.Rational(1, 3), sp.Float(0.7), a, -a, x])
def test_other_powers_are_left_to_the_c_library(exponent):
    assert split_powers(x**exponent) == power(x, exponent)
    assert split_powers(x ** sp.Float(1.5)) == split_powers(x ** sp.Rational(3, 2)) == x * root(x)


def test_powers_of_one_base_share_root_and_reciprocal():
    """(1+x^2)^(-5/2), ^(3/2) and 1/(1+x^2): one root, and reciprocals of no more than root and base."""
    q = 1 + x**2
    lines = straight(model({x: q ** sp.Rational(-5, 2) + q ** sp.Rational(3, 2) + 1 / q}), [
        q ** sp.Rational(-5, 2) + q ** sp.Rational(3, 2) + 1 / q], Hoisted(()))  # fmt: skip
    everything = [step[1] for step in lines.steps] + list(lines.results)
    assert sum(len(e.atoms(root)) for e in everything) == 1
    assert sum(len(e.atoms(inverse)) for e in everything) <= 2


# --- all kinds of terms through the compiled kernel --------------------------------------------------------

SINK = model(
    {
        x: v + a * cos(omega * t + chi) - b * sin(-2 * nu * t) + x * cos(omega * t) / 5,
        v: when(x > a, x - a, when(x < -b, x + b)) - (1 + x**2) ** sp.Rational(-5, 2) * cbrt(b)
        + (2 + v) ** sp.Rational(3, 4) - (2 + v) ** sp.Rational(-1, 4) / 3 + pi / 7
        + sp.Rational(2, 3) * x**4,
        w: sign(x) * sp.exp(-(w**2)) + abs(v) + sp.log(3 + w) + sp.atan2(x, 2 + w) + sp.tanh(w)
        + sin(x * v) - x**8 / 9 + sp.atan(w) + sign(-a),
    },
    harmonics=(omega, 2 * nu),
)  # fmt: skip
VALUES = {"a": 0.3, "b": 0.45, "omega": 1.7, "nu": 0.6, "chi": 0.9}


def by_hand(time, y):
    X, V, W = y
    A, B, om, n, ph = (VALUES[k] for k in ("a", "b", "omega", "nu", "chi"))
    zone = np.where(X > A, X - A, np.where(X < -B, X + B, 0.0))
    return np.array([
        V + A * np.cos(om * time + ph) + B * np.sin(2 * n * time) + X * np.cos(om * time) / 5,
        zone - (1 + X**2) ** -2.5 * B ** (1 / 3)
        + (2 + V) ** 0.75 - (2 + V) ** -0.25 / 3
        + np.pi / 7 + 2 / 3 * X**4,
        np.sign(X) * np.exp(-(W**2)) + abs(V) + np.log(3 + W) + np.arctan2(X, 2 + W) + np.tanh(W)
        + np.sin(X * V) - X**8 / 9 + np.arctan(W) - 1.0,
    ])  # fmt: skip


def test_every_kind_of_term_is_what_numpy_says():
    sink = System(SINK, VALUES)
    y = np.random.default_rng(3).uniform(-1, 1, (3, 70))  # more than two blocks of lanes
    expected = by_hand(2.3, y)
    np.testing.assert_allclose(sink.reference_rhs(2.3, y), expected, rtol=0, atol=4e-15)
    np.testing.assert_allclose(sink.rhs(2.3, y), expected, rtol=0, atol=1e-14)  # a few roundings of order one
    np.testing.assert_array_equal(sink.rhs(2.3, y[:, 5]), sink.rhs(2.3, y)[:, 5])


def test_jacobian_of_every_kind_of_term():
    """Against differences, away from switches; dry friction jumps, and its slope on either side is zero."""
    sink = System(SINK, VALUES)
    y = np.random.default_rng(4).uniform(-0.9, 0.9, (3, 40))
    y = y[:, (np.abs(y[0] - 0.3) > 0.02) & (np.abs(y[0] + 0.45) > 0.02) & (np.abs(y[:2]) > 0.02).all(axis=0)]
    h, columns = 1e-3, []
    for j in range(3):
        e = h * np.eye(3)[:, j : j + 1]
        f = [sink.reference_rhs(2.3, y + n * e) for n in (-3, -2, -1, 1, 2, 3)]
        columns.append((-f[0] + 9 * f[1] - 45 * f[2] + 45 * f[3] - 9 * f[4] + f[5]) / (60 * h))
    np.testing.assert_allclose(sink.jacobian(2.3, y), np.stack(columns, axis=1), rtol=0, atol=1e-9)


def test_a_function_that_cannot_be_lowered_is_named():
    with pytest.raises(ModelError, match="gamma"):
        System(model({x: sp.gamma(x)}, (a,)), {"a": 1.0}).rhs(0.0, [0.1])


def test_a_guarded_term_without_default_is_refused():
    with pytest.raises(ModelError, match="default"):
        code(sp.Piecewise((x, x > 0)))


def test_roots_and_reciprocals_of_numbers_are_not_mpmaths():
    """SymPy looks functions up in mpmath by name, and mpmath.root wants two arguments: this broke a Jacobian."""
    assert float(root(sp.Float(2.25)).evalf()) == 1.5
    assert float(inverse(sp.Float(4.0)).evalf()) == 0.25
    assert (root(sp.Integer(2)) > 1) == True  # noqa: E712 (SymPy's own truth)
    assert sp.simplify(root(x).diff(x) - inverse(root(x)) / 2) == 0
    assert sp.simplify(inverse(x).diff(x) + inverse(x) ** 2) == 0
