"""Sizes that differences are compared with: which states are alike; nothing knows the unit of a length or of time."""

import numpy as np
import pytest
from sympy import Abs

import whirlmap
from whirlmap.analysis.linear.linearisation import linear_analysis
from whirlmap.analysis.motion.ensembles import PERTURBATION, make_ensemble
from whirlmap.equations import Model, Parameter, Section, State, cos, sqrt, t
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.scales import FLOOR, likeness, limits, scales
from whirlmap.integrate.system import System
from whirlmap.results.status import Status

x, y, z = (State(n, "1", n) for n in "xyz")
v, w = State("v", "1", "rate of x"), State("w", "1", "rate of y")
k, omega = Parameter("k", "1", "k"), Parameter("omega", "1", "omega", above=0)

ROTOR = Model(
    "rotor", (x, y, v, w, z), (k, omega),
    {x: v, y: 3 * w, v: -x * (x**2 + y**2) + cos(omega * t), w: -y, z: k * (x - 2 * z)}, harmonics=(omega,),
)  # fmt: skip


def test_which_states_are_alike():
    """A radius makes x and y alike, x' = v makes v its rate; a sum with other factors says nothing of units."""
    like = likeness(ROTOR)
    assert like.coordinate.tolist() == [0, 1, 0, 1, 4]
    assert like.group.tolist() == [0, 0, 0, 0, 4]
    assert like.order.tolist() == [0, 0, 1, 1, 0]
    assert like.factor.tolist() == [1, 1, 1, 3, 1]
    metres = [State(n, "m", n) for n in "ab"]
    apart = Model("apart", tuple(metres), (omega,), {q: cos(omega * t) - q for q in metres}, harmonics=(omega,))
    assert likeness(apart).group.tolist() == [0, 0]


def test_each_state_counts_by_its_own_range_or_by_a_part_of_those_alike():
    period = np.array([np.pi])  # T/2 pi is one half
    extent = np.array([2.0, 0.0, 8.0, 1e-17, 1e-9])[:, None]
    magnitude = np.array([5.0, 0.0, 8.0, 1e-17, 1e-9])[:, None]
    own = scales(ROTOR, period, extent, magnitude)[:, 0]
    # y and its rate w move by rounding only: a part of the largest motion, v T/2 pi = 4, is what they count by
    np.testing.assert_allclose(own, [2.0, 4 * FLOOR, 8.0, 4 * FLOOR / 1.5, 1e-9])
    shared = scales(ROTOR, period, extent, magnitude, share=1.0)[:, 0]
    np.testing.assert_allclose(shared, [4.0, 4.0, 8.0, 4 / 1.5, 1e-9])
    at_rest = scales(ROTOR, period, 0 * extent, np.array([1000.0, 0, 1e-13, 0, 0])[:, None])[:, 0]
    np.testing.assert_allclose(at_rest, [1e-3, 1e-9, 2e-3, 1e-9 / 1.5, 1.0])


@pytest.mark.parametrize("length", [1e-9, 1.0, 1e12])
def test_a_model_without_a_bound_ends_where_it_has_run_away_and_nowhere_else(length):
    """x'' = x grows for ever, x'' = -x swings at any size; both from a start of one unit of length."""
    model = Model("free", (x, v), (k, omega), {x: v, v: k * x + 0 * cos(omega * t)}, harmonics=(omega,))
    values = np.array([[1.0, -1.0], [2.0, 2.0]])
    e = Ensemble(model, values, np.full((2, 2), length), orders=System(model, {"k": 1, "omega": 2}).orders, steps=40)
    np.testing.assert_allclose(limits(model, e.period, e.x)[0], 1e30 * length)
    e.advance(40)
    assert [Status(s) for s in e.status] == [Status.diverged, Status.ok]
    assert e.end_time[0] == pytest.approx(np.log(1e30 / 1.5), abs=np.pi / 40)  # of x and v T/2 pi together


def test_a_blow_up_is_a_divergence_without_any_bound():
    model = Model("blow", (x,), (omega,), {x: x**2 + 0 * cos(omega * t)}, harmonics=(omega,))
    for length in (1e-6, 1.0, 1e6):
        values = np.array([[20 * np.pi * length]])
        orders = System(model, {"omega": 1}).orders
        e = Ensemble(model, values, np.array([[length]]), orders=orders, steps=50)
        e.advance(30)
        assert e.status[0] == Status.diverged
        assert e.end_time[0] * length == pytest.approx(1.0, abs=0.02)


def test_a_perturbed_ensemble_is_as_small_as_its_states():
    system = whirlmap.load("duffing").replace(start={"x": 1e-6, "v": 0.0})
    many = {"gamma": np.full(8, 1e-7)}
    e, _ = make_ensemble(system, many, steps=20, perturbed=True)
    apart = np.abs(e.x - e.x[:, :1]).max()
    assert 0 < apart <= 2 * PERTURBATION  # the declared start is one: that is what the model calls a size
    model = Model("still", (x, v), (k, omega), {x: v, v: k * cos(omega * t) - x - v / 10}, harmonics=(omega,))
    e, _ = make_ensemble(System(model, {"k": 1e-9, "omega": 2.0}), {"k": np.full(8, 1e-9)}, steps=20, perturbed=True)
    assert 0 < np.abs(e.x - e.x[:, :1]).max() < 1e-14


def hertz():
    """A mass on Hertz's contact in SI; rest at (W/K)^(2/3) = 5.2 um."""
    u, r = State("y", "m", "y"), State("v", "m/s", "v")
    K, C, m, W = (Parameter(n, "1", n) for n in ("K", "C", "m", "W"))
    d = (u + Abs(u)) / 2
    model = Model(
        "hertz", (u, r), (K, C, m, W), {u: r, r: (W - C * r - K * d * sqrt(d + 1e-300)) / m}, start="equilibrium",
        swing=(u,), typical_time=0.001, section=Section(r, "rising"),
    )  # fmt: skip
    return System(model, {"K": 8.3687e9, "C": 200.0, "m": 0.6, "W": 100.0})


def test_a_contact_of_micrometres_has_its_own_stiffness():
    found = linear_analysis(hertz())
    depth = (100 / 8.3687e9) ** (2 / 3)
    natural = 1.5 * 8.3687e9 * np.sqrt(depth) / 0.6
    assert found.equilibrium[0] == pytest.approx(depth, rel=1e-12)
    exact = -200 / 1.2 + 1j * np.sqrt(natural - (200 / 1.2) ** 2)
    assert np.abs(found.eigenvalues - exact).min() < 1e-9 * abs(exact)


def test_at_a_kink_both_sides_count():
    """Rest exactly at the corner of max(x, 0): the stiffness is 1 on one side and 3 on the other."""
    model = Model(
        "corner", (x, v), (k,), {x: v, v: -2 * x - Abs(x) - k * v}, start="equilibrium", typical_time=1.0,
        section=Section(v, "rising"), start_where_none={x: 0.1},
    )  # fmt: skip
    found = linear_analysis(System(model, {"k": 0.5}))
    assert found.jacobian[1, 0] == pytest.approx(-2.0, rel=1e-9)
