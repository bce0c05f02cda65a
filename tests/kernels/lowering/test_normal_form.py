"""Kinks and jumps in one form, and slopes where a branch that is not chosen is infinite or no number."""

import numpy as np
import pytest
import sympy as sp
from sympy.logic.boolalg import BooleanFunction

from whirlmap.equations import Model, Parameter, State, cos, t, when
from whirlmap.errors import ModelError
from whirlmap.integrate.system import System
from whirlmap.kernels.lowering.normal_form import normal_form
from whirlmap.kernels.lowering.powers import power, split_powers
from whirlmap.results.status import Status
from whirlmap.sweep.points.label_points import label_points

x, y = State("x", "1", "x"), State("y", "1", "y")
a, omega = Parameter("a", "1", "a"), Parameter("omega", "1", "omega")
THIRD = sp.Rational(1, 3)

TERMS = [
    sp.Max(x, 0), sp.Min(x, y), sp.Max(x, y, 1, a), sp.Min(1, sp.Max(x, -1)), sp.Max(sp.Min(x, y), a * sp.Heaviside(y)),
    sp.Heaviside(x), sp.Heaviside(x, 0), sp.Heaviside(x, 1), sp.Heaviside(x, THIRD) * y, sp.Max(x, 0) ** sp.Rational(3, 2),
    when(sp.Xor(x > 1, y > 0), x, y), when(sp.ITE(x > 1, y > 0, a < 1), x), when(sp.Max(x, y) > 1, x),
    when(x > 0, sp.Max(x, y)), sp.sign(x * y) * sp.Abs(x - y), sp.Max(sp.sqrt(2 + x), sp.log(4 + y)),
]  # fmt: skip


@pytest.mark.parametrize("term", TERMS, ids=str)
def test_the_normal_form_is_equal_everywhere_and_has_three_functions(term):
    made = normal_form(term)
    assert not made.atoms(sp.Max, sp.Min, sp.Heaviside)
    conditions = {c for p in made.atoms(sp.Piecewise) for _, c in p.args}
    assert all(p.args[-1].cond == True for p in made.atoms(sp.Piecewise))  # noqa: E712 (SymPy's own truth)
    parts = {part for c in conditions for part in sp.preorder_traversal(c) if isinstance(part, BooleanFunction)}
    assert all(isinstance(part, sp.And | sp.Or | sp.Not) for part in parts)
    for at in ((-1, 2, 0), (0, 0, 0), (2, 1, 3), (1, 1, 1), (2, -1, 2)):
        place = dict(zip((x, y, a), at, strict=True))
        assert sp.N(made.subs(place) - term.subs(place)) == pytest.approx(0, abs=1e-14), place


def test_what_has_no_kink_is_the_same_object():
    plain = sp.sin(x) * (1 + y**2) ** sp.Rational(-5, 2) + when(x > 1, x - 1)
    assert normal_form(plain) is plain


def test_a_condition_that_is_no_relation_is_refused():
    with pytest.raises(ModelError, match="is not a relation"):
        normal_form(sp.Piecewise((x, sp.Symbol("on")), (0, True)))


def test_relations_that_sympy_turns_over_forever_are_lowered():
    """SymPy's canonical form of a relation alternates between two where both sides begin with a minus in turn."""
    left, right = sp.tan(sp.Rational(1, 2)) - 4 * x, sp.Float(0.7) / (2 + y**2)
    for term in (sp.Min(left, right, sp.tan(y)), when(left <= right, x, y)):
        system = System(Model("turned", (x, y), (), {x: term, y: -y}), {})
        at = {x: 0.2, y: 0.3}
        assert system.rhs(0.0, [0.2, 0.3])[0] == pytest.approx(float(term.subs(at)), rel=1e-14)


# --- powers and guarded terms: right values and slopes at zero and beyond ------------------------------------------

AT_ZERO = [
    x**1.5, x ** sp.Rational(10, 9), x**a, sp.Abs(x) ** 1.5 * sp.sign(x), (x**2 + y**2) ** 1.5, sp.Abs(x) ** 1.25 / (1 + y),
    sp.Abs(x) ** 1.5 + sp.Abs(x) ** 2.5 * y, sp.Max(x, 0) ** 1.5, sp.Max(x, 0) ** a,
]  # fmt: skip


@pytest.mark.parametrize("term", AT_ZERO, ids=str)
def test_powers_above_one_have_slope_zero_at_zero(term):
    """As ``b root(b)`` their slope was zero times infinity: no number where most runs start."""
    system = System(Model("zero", (x, y), (a,), {x: term, y: -a * y}), {"a": 1.3})
    assert system.rhs(0.0, [0.0, 0.0])[0] == system.reference_rhs(0.0, [0.0, 0.0])[0] == 0.0
    np.testing.assert_array_equal(system.jacobian(0.0, [0.0, 0.0]), [[0.0, 0.0], [0.0, -1.3]])


@pytest.mark.parametrize("exponent", [1.5, 0.7, sp.Rational(10, 9), a])
def test_a_negative_base_gives_no_number_and_ends_the_run(exponent):
    rate = -1 - x**exponent + cos(omega * t) / 10
    model = Model("falls", (x,), (a, omega), {x: rate}, harmonics=(omega,), clocks={"a": a})  # a is read in every case
    system = System(model, {"a": 0.3, "omega": 6.0})
    assert np.isnan(system.rhs(0.0, [-0.5])[0])
    ds = label_points(system, {"omega": [6.0]}, starts=np.array([[0.5]]))
    assert ds["status"].item() != Status.ok and 0 < ds["end_time"].item() < 1


def test_zero_and_integer_exponents_given_at_run_time():
    system = System(Model("exponents", (x, y), (a,), {x: x**a, y: y**a}), {"a": 3.0})
    np.testing.assert_allclose(system.rhs(0.0, [-2.0, 0.0]), [-8.0, 0.0])
    np.testing.assert_allclose(system.jacobian(0.0, [-2.0, 0.0]), [[12.0, 0.0], [0.0, 0.0]])


HIDDEN = [
    (when(x > 1, sp.sqrt(x - 1)), 0.0), (when(x > 1, (x - 1) ** 1.5) * y + when(x > 1, y), 0.0),
    (sp.sqrt(sp.Max(x - 1, 0)), 0.0),
    (when(x > 1, sp.log(x - 1), x), 1.0), (when(x > 2, 1 / (x - y), x * y) + 1 / (2 + x - y), None),
    (sp.exp(sp.Min(x, 1)) * when(x > 1, sp.exp(sp.sqrt(x - 1)), x**2), None), (sp.Max(x - 1, 0) ** 0.7 / y + x, 1.0),
]  # fmt: skip


@pytest.mark.parametrize(("term", "slope"), HIDDEN, ids=str)
def test_a_branch_that_is_not_chosen_does_not_reach_the_slopes(term, slope):
    model = Model("hidden", (x, y), (a,), {x: a * term, y: term**2 - a * x * y})
    system = System(model, {"a": 1.0})
    at = np.array([0.5, 0.5])
    got = system.jacobian(0.0, at)
    h = 1e-6
    for j, e in enumerate(h * np.eye(2)):
        difference = (system.reference_rhs(0.0, at + e) - system.reference_rhs(0.0, at - e)) / (2 * h)
        np.testing.assert_allclose(got[:, j], difference, rtol=1e-8, atol=1e-9)
    assert slope is None or got[0, 0] == slope


def test_exponentials_beside_roots_and_reciprocals_have_their_slopes():
    """SymPy's ``as_base_exp`` says that the base of exp(x) is e: in a product with a reciprocal it counted as constant."""
    term = sp.exp(-x) / (1 + y**2)
    system = System(Model("mixed", (x, y), (a,), {x: a * term, y: term**2 - x * y}), {"a": 2.0})
    place = {x: 0.3, y: 0.7}
    expected = [[float(f.diff(q).subs(place)) for q in (x, y)] for f in (2 * term, term**2 - x * y)]
    np.testing.assert_allclose(system.jacobian(0.0, [0.3, 0.7]), expected, rtol=1e-14)


def test_one_condition_in_two_terms():
    """A wall with a spring and a damper; shared conditions are written out where they stand."""
    wall = -2 * when(x > 1, x - 1) - a * when(x > 1, y) - when(sp.And(x > 1, y > 0), y**2) * x
    system = System(Model("wall", (x, y), (a,), {x: y, y: wall - x}), {"a": 0.1})
    X = np.random.default_rng(1).uniform(-2, 3, (2, 50))
    on = X[0] > 1
    force = np.where(on, -2 * (X[0] - 1) - 0.1 * X[1], 0) - np.where(on & (X[1] > 0), X[1] ** 2 * X[0], 0)
    np.testing.assert_allclose(system.rhs(0.0, X)[1], force - X[0], rtol=0, atol=1e-14)


def test_the_exponents_slope_where_the_base_is_zero():
    """0^y is 0 for y > 0, and so is its slope by y: not zero times the logarithm of zero."""
    assert split_powers(x**y) == power(x, y)
    system = System(Model("tower", (x, y), (), {x: x**y, y: -y}), {})
    np.testing.assert_array_equal(system.jacobian(0.0, [0.0, 2.5])[0], [0.0, 0.0])

