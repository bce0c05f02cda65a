"""Linear forms of many states with parameters in their coefficients, as teeth have them between shafts of many modes."""

import numpy as np
from sympy import Symbol, lambdify

from whirlmap.analysis.variational.monodromy import monodromies
from whirlmap.equations import Model, Parameter, State, cos, t
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.evaluation import Evaluator
from whirlmap.integrate.system import System
from whirlmap.kernels.lowering.differentiate import WIDE, jacobian_code
from whirlmap.kernels.lowering.lower import Hoisted, local_name, straight
from whirlmap.kernels.methods import DOP853

MODES = WIDE + 2
a, b, k = Parameter("a", "1", "a"), Parameter("b", "1", "b"), Parameter("k", "1", "k")
x, v = ([State(f"{name}{i}", "1", name, start=0.1 * (i % 3)) for i in range(MODES)] for name in "xv")


def toothed():
    """x_i'' = -(i + 1) x_i - v_i/10 - a_i F, F = k (1 + cos(t)/5) d + d^3/50, d the form sum a_i x_i, a_i = a + b^i."""
    weights = [a + b**i for i in range(MODES)]
    d = sum(weight * q for weight, q in zip(weights, x, strict=True))
    force = k * (1 + cos(t) / 5) * d + d**3 / 50
    rates = dict(zip(x, v, strict=True))
    rates |= {v[i]: -(i + 1) * x[i] - v[i] / 10 - weights[i] * force for i in range(MODES)}
    model = Model(name="toothed", states=(*x, *v), parameters=(a, b, k), harmonics=(1,), equations=rates, swing=(x[0],))
    return System(model, {"a": 0.3, "b": 0.8, "k": 0.7})


def test_the_jacobian_of_a_wide_form_is_that_of_its_parts():
    system, time = toothed(), 0.7
    model = system.model
    exact = [[model.equations[row].diff(q) for q in model.states] for row in model.states]
    at = np.random.default_rng(2).normal(size=(model.dimension, 5))
    numbers = [*system.vector, time]
    for j in range(5):
        expected = np.array(lambdify([*model.states, *model.parameters, t], exact)(*at[:, j], *numbers))
        found = system.jacobian(time, at)[:, :, j]
        assert np.abs(found - expected).max() < 1e-13 * np.abs(expected).max()


def test_it_counts_once_and_not_for_every_pair_of_states():
    model = toothed().model
    hoisted = Hoisted(model.parameters)
    names = [Symbol(local_name(s), real=True) for s in model.states]
    lines = straight(model, [model.equations[s] for s in model.states], hoisted)
    _, entries, forms = jacobian_code(lines, names, hoisted)
    assert max(len(weights) for weights in forms.values()) == MODES
    assert len(entries) <= 4 * MODES < MODES * MODES


def test_tangent_vectors_through_it_are_the_differences_of_neighbours():
    system = toothed()
    n = system.model.dimension
    start = np.array([[float(s.start)] for s in system.model.states])
    e = Ensemble(system.model, system.vector[:, None], start, orders=system.orders, steps=64, method=DOP853)
    matrix = monodromies(e, np.arange(1), np.ones(1, dtype=np.int64), start).matrix[0]
    near = np.repeat(start, 2 * n, axis=1) + 1e-5 * np.hstack([np.eye(n), -np.eye(n)])
    values = np.repeat(system.vector[:, None], 2 * n, axis=1)
    around = Ensemble(system.model, values, near, orders=system.orders, steps=64, method=DOP853)
    around.advance(1)
    differences = (around.x[:, :n] - around.x[:, n:]) / 2e-5
    assert np.abs(matrix - differences).max() < 1e-8 * np.abs(differences).max()


def test_the_trace_alone_is_that_of_the_whole_jacobian():
    system = toothed()
    at = np.random.default_rng(3).normal(size=(system.model.dimension, 7))
    evaluate, points = Evaluator.of(system.model, system.vector[:, None], jacobian=True), np.zeros(7, dtype=np.intp)
    whole = np.einsum("iij->j", evaluate(0.4, at, points)[1])
    assert np.abs(evaluate.trace(0.4, at, points) - whole).max() < 1e-14 * np.abs(whole).max()
