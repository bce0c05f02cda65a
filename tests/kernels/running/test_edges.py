"""Corners of the kernels: what is no number is seen anywhere, steps without lanes cost nothing, tables are what they say."""

import numpy as np
import pytest
import sympy as sp

from whirlmap.equations import Model, Parameter, Section, State, magnitude
from whirlmap.equations.pieces import Table
from whirlmap.errors import ModelError
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.system import System
from whirlmap.kernels.methods import RK4
from whirlmap.kernels.running.lanes import HarmonicTables, blocked, lane_kernel
from whirlmap.kernels.writing.routine import LANES
from whirlmap.models import family
from whirlmap.results.status import Status

angle, v = State("angle", "rad", "angle", cyclic=2 * np.pi), State("v", "1", "v")
a, b = Parameter("a", "1", "a"), Parameter("b", "1", "b")


def sines(parameter, u):
    return (np.sin(parameter * u),)


TABLE = Table("wave", ("u",), ("f",), sines, sines, lambda p: (np.linspace(-2, 2, 9),), 6)


def model(name, rate, **more):
    used = tuple(p for p in (a, b) if rate.has(p))
    return Model(name, (angle, v), used, {angle: rate, v: sp.Integer(-1)}, **more)


def test_a_cyclic_state_that_is_no_number_ends_its_point():
    """The angle's rate is sqrt(v), and v falls below zero at 0.5: no other state notices."""
    system = System(model("blind-angle", sp.sqrt(v)), {"a": 1.0, "b": 1.0})
    e = Ensemble(system.model, system.vector[:, None], np.array([[0.0], [0.5]]), orders=(), steps=10)
    saved = e.advance(2, save_every=1).saved[..., 0]
    assert e.status[0] != Status.ok
    assert np.isfinite(e.x).all()
    assert 0.4 <= e.end_time[0] <= 0.6
    assert np.isfinite(saved[:4]).all() and np.isnan(saved[6:]).all()


def test_a_cyclic_state_has_no_bound():
    system = System(Model("far-angle", (angle, v), (), {angle: sp.Integer(10) ** 9, v: -v}), {})
    e = Ensemble(system.model, system.vector[:, None], np.array([[0.0], [0.5]]), orders=(), steps=10)
    e.advance(3)
    assert e.status[0] == Status.ok and e.x[0, 0] == pytest.approx(3e9)


def test_a_table_is_read_at_one_parameter():
    with pytest.raises(ModelError, match="table 'wave' is read at a and at b"):
        System(model("two", TABLE(a, v)[0] + TABLE(b, v)[0], tables=(TABLE,)), {"a": 1.0, "b": 2.0}).rhs(0.0, [0.0, 0.5])


def test_a_tables_parameter_is_a_parameter():
    with pytest.raises(ModelError, match=r"table 'wave' is read at 2\*a"):
        System(model("twice", TABLE(2 * a, v)[0], tables=(TABLE,)), {"a": 1.0, "b": 2.0}).rhs(0.0, [0.0, 0.5])


def test_a_table_that_is_not_read_is_refused():
    with pytest.raises(ModelError, match="'wave'"):
        System(model("unread", v, tables=(TABLE,)), {"a": 1.0, "b": 2.0}).rhs(0.0, [0.0, 0.5])


def run(system, x, *, first, last, active, sentinel=0.0, count=0):
    """Call ``advance`` of a locked kernel for one block; working memory is filled with a number before."""
    kernel = lane_kernel(system.plain_model(), RK4, slopes="jacobian" if count else "none", kind="locked")
    y = blocked(x)
    flags = {name: np.array(value, dtype=np.int64).reshape(1, 1, LANES) for name, value in (
        ("first", first), ("last", last), ("active", active), ("failed", [-1] * LANES), ("cause", [0] * LANES),
        ("save_every", [1000] * LANES), ("orth_every", [1] * LANES), ("pieces", [8] * LANES))}  # fmt: skip
    work = kernel.work()
    work[:] = sentinel
    per_T, events = np.full(LANES, 20), max(last)
    h = np.full((1, 1, LANES), system.period / 20)
    inputs = kernel.inputs(np.repeat(system.vector[:, None], LANES, axis=1)).blocks(np.arange(LANES))
    waves = HarmonicTables.of(system.orders, per_T, kernel.source.nodes)
    begin = waves.begin(per_T, np.zeros(LANES, dtype=np.int64), np.broadcast_to(first, LANES))
    kernel.advance(
        blocks=1, count=count, y=y, h=h, **inputs, waves=waves.table, begin=blocked(begin),
        **{name: blocked(rows) for name, rows in waves.rows(per_T).items()}, **flags, saves=0,
        saved=np.empty(0), events=events, growth=np.zeros(events * count * LANES), folded=0,
        sums=np.empty(0), reached=np.zeros(LANES), tally=np.zeros(2 * LANES), work=work,
    )  # fmt: skip
    return y[0], work


DUFFING = {"delta": 0.2, "alpha": -1, "beta": 1, "gamma": 0.3, "omega": 1.2}


def test_a_block_without_steps_is_not_computed():
    """A run goes on at its mended step, and calls for one block pass the others by."""
    system = System(family("duffing").model(), DUFFING)
    x = np.random.default_rng(0).uniform(-1, 1, (2, LANES))
    y, work = run(system, x, first=[30] * LANES, last=[30] * LANES, active=[1] * LANES, sentinel=7.5)
    np.testing.assert_array_equal(y, x)
    assert (work == 7.5).all()


def test_lanes_enter_at_the_phases_of_their_steps():
    """Lanes that enter at step 13 end as if those 13 steps had been run from where the others then stood."""
    system = System(family("duffing").model(), DUFFING)
    x = np.random.default_rng(1).uniform(-1, 1, (2, LANES))
    none, some, fifty = [0] * LANES, [13] * LANES, [50] * LANES
    begun, _ = run(system, x, first=none, last=some, active=[1] * LANES)
    whole, _ = run(system, x, first=none, last=fifty, active=[1] * LANES)
    late = np.arange(LANES) % 3 == 0
    for first, start in ((np.where(late, 13, 0), np.where(late, begun, x)), (np.full(LANES, 13), begun)):
        got, _ = run(system, start, first=first, last=fifty, active=[1] * LANES)
        np.testing.assert_array_equal(got, whole)


def test_vectors_of_lanes_that_stand_still_are_left_alone():
    """Also those that have grown beyond all numbers: nothing times infinity is not nothing."""
    system = System(family("duffing").model(), DUFFING)
    x = np.random.default_rng(2).uniform(-1, 1, (6, LANES))
    x[2:, 3] = np.inf
    y, _ = run(system, x, first=[0] * LANES, last=[5] * LANES, active=[1, 1, 1, 0, 0, 1, 1, 1], count=2)
    np.testing.assert_array_equal(y[:, 3:5], x[:, 3:5])
    vectors = y[2:, [0, 1, 2, 5, 6, 7]].reshape(2, 2, 6)
    np.testing.assert_allclose(np.einsum("ain,bin->abn", vectors, vectors), np.eye(2)[..., None] * np.ones(6), atol=1e-12)


def test_a_kernel_without_a_function_says_so():
    system = System(family("duffing").model(), DUFFING)
    kernel = lane_kernel(system.plain_model(), RK4, slopes="none", kind="free")
    with pytest.raises(AssertionError, match="advance"):
        kernel.advance  # noqa: B018


HIDING = Parameter("exp", "1", "of the name of a function")


@pytest.mark.parametrize("term", [sp.erf(b), v * magnitude(b), HIDING * sp.exp(v)], ids=str)
def test_a_pole_beside_functions_that_numpy_lacks_or_names_hide(term):
    y, values = State("y", "1", "y"), {b: 0.7, HIDING: 0.4}
    used = tuple(p for p in values if term.has(p))
    pole = Model("pole", (y, v), used, {y: v, v: term - 1 / y}, section=Section(v, "falling"))
    rate = System(pole, {p.name: values[p] for p in used}).rhs(0.0, [0.3, 0.1])[1]
    assert rate == pytest.approx(float(term.replace(magnitude, sp.Abs).subs({v: 0.1, **values})) - 1 / 0.3)
