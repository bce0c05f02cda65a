"""Sweeps of one of several forcing frequencies: every point has its own common period. Linear systems, so truth is exact."""

from fractions import Fraction
from math import lcm

import numpy as np
import pytest
import sympy as sp
import xarray as xr

from whirlmap import bifurcation_diagram, load, regime_map
from whirlmap.analysis.motion.ensembles import make_ensemble
from whirlmap.analysis.steady.settling import Settling
from whirlmap.equations import Model, Parameter, State, cos, sin, t
from whirlmap.errors import RangeError
from whirlmap.integrate.orders import order_groups, orders_vary
from whirlmap.results.regime import Regime
from whirlmap.sweep.diagrams.in_batches import diagram_in_batches
from whirlmap.sweep.points.label_points import label_points

x, v, y, w = (State(n, "1", n) for n in ("x", "v", "y", "w"))
a, b, c, d, r = (Parameter(n, "1", n) for n in ("a", "b", "c", "d", "r"))
order = Parameter("order", "1", "order of a harmonic", order=True)
SETTLING = Settling(transient=40, keep=16)
FIFTH = sp.Rational(1, 5)


def oscillator(harmonics, force, parameters=(a, b), damping=FIFTH, **more):
    equations = {x: v, v: force - damping * v - x}
    return Model("linear", (x, v), tuple(parameters), equations, harmonics=tuple(harmonics), swing=(x,), **more)


def response(frequency, damping=0.2):
    return 1 / (1 - frequency**2 + 1j * damping * frequency)


TWO = oscillator((a, b), cos(a * t) + cos(b * t) / 2)

#: Model, fixed values, swept parameter and values, frequencies and forces of the terms at one value.
SYSTEMS = {
    "slow one swept": (TWO, {"a": 1.0, "b": 0.5}, "b", [0.4, 0.45, 0.5, 0.55, 0.6], lambda q: [(1, 1), (q, 0.5)]),
    "the swept one becomes the fastest": (
        TWO, {"a": 1.0, "b": 0.5}, "b", [0.75, 1.25, 1.5, 2.0], lambda q: [(1, 1), (q, 0.5)]
    ),
    "both the same": (TWO, {"a": 1.0, "b": 0.5}, "b", [0.8, 1.2], lambda q: [(1, 1), (q, 0.5)]),
    "fast one swept": (TWO, {"a": 2.0, "b": 0.5}, "a", [0.75, 1.0, 1.75], lambda q: [(q, 1), (0.5, 0.5)]),
    "sum and difference": (
        oscillator((a + b, a - b), cos((a + b) * t) + sin((a - b) * t) / 3), {"a": 1.5, "b": 0.5}, "b", [0.25, 0.5, 0.75],
        lambda q: [(1.5 + q, 1), (1.5 - q, 1 / 3)],
    ),
    "three, one swept": (
        oscillator((a, b, c), cos(a * t) + cos(b * t) + cos(c * t), (a, b, c)), {"a": 1.0, "b": 0.5, "c": 0.75}, "c",
        [0.25, 0.6, 0.8], lambda q: [(1, 1), (0.5, 1), (q, 1)],
    ),
    "a multiple of the swept one": (
        oscillator((a, 3 * b), cos(a * t) + sin(3 * b * t)), {"a": 1.0, "b": 0.5}, "b", [0.1, 0.2, 0.25],
        lambda q: [(1, 1), (3 * q, 1)],
    ),
    "an order beside": (
        oscillator((a, order * b), cos(a * t) + cos(order * b * t), (a, b, order)),
        {"a": 1.0, "b": 0.5, "order": Fraction(2, 3)}, "b", [0.3, 0.6, 0.75], lambda q: [(1, 1), (2 * q / 3, 1)],
    ),
    "a frequency that follows": (
        oscillator((a, b), cos(a * t) + cos(b * t) / 2, (a, b, r), defaults={b: a * r}), {"a": 1.0, "r": 0.5}, "r",
        [0.4, 0.5, 0.75], lambda q: [(1, 1), (q, 0.5)],
    ),
    "units of 400 rad/s": (
        oscillator((a, b), 400**2 * (cos(a * t) + cos(b * t) / 2) - (400**2 - 1) * x, damping=80), {"a": 400.0, "b": 200.0},
        "b", [160.0, 180.0, 200.0], lambda q: [(1, 1), (q / 400, 0.5)],
    ),
    "crossed by zero": (
        oscillator((a, b - 1), cos(a * t) + cos((b - 1) * t)), {"a": 1.0, "b": 1.5}, "b", [0.5, 1.0, 1.6],
        lambda q: [(1, 1), (q - 1, 1)],
    ),
}  # fmt: skip


def truth(terms):
    """Standard deviation of x, and the common period in T of the fastest."""
    found = {}
    for frequency, force in terms:
        found[round(abs(frequency), 9)] = found.get(round(abs(frequency), 9), 0) + force
    rms = np.sqrt(sum(abs(force * response(f)) ** 2 / 2 for f, force in found.items() if f > 0))
    fastest = max(found)
    return rms, lcm(*(Fraction(f / fastest).limit_denominator(1000).denominator for f in found))


@pytest.mark.parametrize("name", SYSTEMS)
def test_every_point_has_its_own_common_period(name):
    model, fixed, swept, values, terms = SYSTEMS[name]
    ds = bifurcation_diagram(load(model, **fixed), swept, values, settling=SETTLING)
    expected = [truth(terms(q)) for q in values]
    assert ds["period_T"].values.tolist() == [period for _, period in expected]
    assert (ds["regime"] == Regime.periodic).all()
    np.testing.assert_allclose(ds["rms"].sel(quantity="x"), [rms for rms, _ in expected], rtol=1e-5)
    assert "common_multiple" not in ds.attrs and (ds["common_multiple"] % ds["period_T"] == 0).all()


def test_a_point_has_the_same_bits_in_other_company():
    system, values = load(TWO, a=1.0, b=0.5), np.array([0.4, 0.45, 0.5, 0.55, 0.6, 0.75, 1.2])
    together = label_points(system, {"b": values}, settling=SETTLING, ends=True)
    for some in ([3], [6, 0], [5, 4, 1]):
        alone = label_points(system, {"b": values[some]}, settling=SETTLING, ends=True)
        for name, array in alone.data_vars.items():
            np.testing.assert_array_equal(array, together[name].isel(point=some), err_msg=str(name))
    one = bifurcation_diagram(system.replace(b=0.55), "b", [0.55], settling=SETTLING)
    many = bifurcation_diagram(system, "b", values, settling=SETTLING)
    rows = one.sizes["period"]
    np.testing.assert_array_equal(one["section"][0], many["section"][3, :rows])
    assert np.isnan(many["section"][0, one.sizes["period"] :]).all()


def test_a_diagram_in_batches_and_both_ways_is_the_diagram_at_once():
    system, values = load(TWO, a=1.0, b=0.5), np.array([0.4, 0.45, 0.5, 0.6])
    whole = bifurcation_diagram(system, "b", values, settling=SETTLING)
    parts = diagram_in_batches(system, "b", values, settling=SETTLING, batch=2).run().dataset
    assert parts is not None
    xr.testing.assert_identical(whole["section"], parts["section"])
    both = diagram_in_batches(system, "b", values, follow="both", settling=SETTLING, batch=2).run().dataset
    assert both is not None
    assert (both["hysteresis"] == 0).all()
    assert both["period_T"].sel(direction="down").values.tolist() == [5, 20, 2, 5]
    np.testing.assert_allclose(both["rms"].sel(direction="up"), whole["rms"], rtol=1e-5)


def test_a_map_over_both_frequencies(tmp_path):
    ds = regime_map(
        load(TWO, a=1.0, b=0.5), {"a": [1.0, 1.5], "b": [0.25, 0.5, 1.0]}, settling=SETTLING, lyapunov=0,
        store=tmp_path / "map",
    )  # fmt: skip
    expected = [[truth([(p, 1), (q, 0.5)]) for q in (0.25, 0.5, 1.0)] for p in (1.0, 1.5)]
    assert ds["common_multiple"].values.tolist() == [[period for _, period in row] for row in expected]
    np.testing.assert_allclose(ds["rms"].sel(quantity="x"), [[rms for rms, _ in row] for row in expected], rtol=1e-5)


@pytest.mark.parametrize("odd", [2**-0.5, 0.5003, 127 / 129])
def test_points_without_a_common_period_of_reasonable_length_are_locked(odd):
    """In one diagram with points that have one; the system is linear."""
    ds = bifurcation_diagram(load(TWO, a=1.0, b=0.5), "b", [0.5, odd])
    at = ds["b"].values.tolist().index(odd)
    assert Regime(int(ds["regime"][at])) == Regime.locked and int(ds["period_T"][at]) == 1
    assert Regime(int(ds["regime"][1 - at])) == Regime.periodic and int(ds["period_T"][1 - at]) == 2


def test_what_needs_one_common_period_refuses_several():
    with pytest.raises(RangeError, match=r"common periods of 2 to 5 T"):
        make_ensemble(load(TWO, a=1.0, b=0.5), {"b": [0.5, 0.6]})


def test_a_base_case_without_a_common_period_can_be_swept_through_ones_that_have_it():
    ds = bifurcation_diagram(load(TWO, a=1.0, b=0.5**0.5), "b", [0.5, 0.6], settling=SETTLING)
    assert ds["period_T"].values.tolist() == [2, 5]


def test_orders_of_stock_models_never_vary():
    assert not orders_vary(load("duffing").model, ["omega", "gamma"])
    system = load("gear-psfd/machine")
    assert not orders_vary(system.model, [p.name for p in system.model.parameters if not p.order])
    assert orders_vary(TWO, ["a"]) and not orders_vary(TWO, ["c"])
    (group,) = order_groups(system, system.vector[:, None], ["s"])
    assert group.orders == system.orders
