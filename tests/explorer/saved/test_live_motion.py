"""Motions that a saved page computes by itself, against Python's: every stock case, endings, retried steps, phases."""

from fractions import Fraction

import numpy as np
import pytest
from sympy import Integer, cos
from tests.explorer.saved.node import motions, needs_node

import whirlmap
from whirlmap.cases import names
from whirlmap.equations import Model, Parameter, State, Stop, t
from whirlmap.explorer.saved.live_points import live_points
from whirlmap.integrate.system import System
from whirlmap.results.status import Status
from whirlmap.sweep.parameters.space import space_of

pytestmark = needs_node

#: Values that make stock cases periodic where their own are not, or where they need more than 100 steps per T.
PERIODIC = {
    "duffing": {"gamma": 0.29}, "pendulum": {"g": 0.9}, "lorenz": {"rho": 10.0}, "roessler": {"c": 2.5},
    "gear-psfd/intended": {"psi": 1e-3}, "jeffcott": {"s": 2.0},
}  # fmt: skip
#: Steps per T where 100 are too few: there two starts that differ by 1e-13 part by half of the range within 20 T in Python.
STEPS = {"machines/flexible-on-dampers": 256}
T20 = {"transient": 0, "periods": 20}
#: What is compared: 1e-9 of each state's own range is wanted, and rounding alone is a thousandth of that.
WANTED = 1e-9
#: Cases with states that move by less than 1e-7 of their size: doubles do not resolve 1e-9 of their range. They may differ
#: by four times what a start that differs in the last place makes in Python (4e-9).
ROUNDED = {"machines/geared-turbo-set": 4.0}
#: One with a film in closed form, one with a film table, and one with surfaces at which the rates have a kink.
FEW = ("jeffcott", "gear-psfd/intended", "gear_backlash")


def varied(system):
    """An axis of two values: the system's speed, or its first parameter that is no order of a harmonic."""
    name = system.speed or next(p.name for p in system.model.parameters if not p.order)
    value = float(system.values[name])
    return {name: np.array([value, 1.01 * value if value else 0.01])}


def worst(series, motion):
    """Largest difference of the states, each over its range over the motion."""
    x = series["x"].values
    x = x[np.isfinite(x).all(axis=1)]
    assert x.shape == motion["x"].shape
    size = np.ptp(x, axis=0)
    return np.max(np.abs(motion["x"] - x)[:, size > 0] / size[size > 0])


def rounding(system, series):
    """What a start that differs in the last place makes of the motion."""
    start = np.nextafter(series["x"].values[0], np.inf)
    begin = dict(zip(system.states, start.tolist(), strict=True))
    return worst(series, {"x": whirlmap.simulate(system.replace(start=begin), periods=20, steps=100)["x"].values})


def compared(cases):
    systems = [whirlmap.load(name, **PERIODIC.get(name, {})) for name in cases]
    axes = [varied(system) for system in systems]
    found = motions([
        (system, axis, {name: values[0] for name, values in axis.items()}, T20, {"steps": STEPS.get(case, 100)})
        for case, system, axis in zip(cases, systems, axes, strict=True)
    ])  # fmt: skip
    for name, system, motion in zip(cases, systems, found, strict=True):
        series = whirlmap.simulate(system, periods=20, steps=STEPS.get(name, 100))
        assert motion["ended"] is None
        wanted = ROUNDED[name] * rounding(system, series) if name in ROUNDED else WANTED
        assert worst(series, motion) < wanted < 1e-7, name
        np.testing.assert_allclose(motion["turn"], series["turn"].values, rtol=1e-14)
        if series.sizes["output"]:
            size = np.abs(series["outputs"].values).max(axis=0)
            assert np.max(np.abs(motion["outputs"] - series["outputs"].values) / np.where(size > 0, size, 1)) < WANTED


def test_motions_in_the_browser_are_those_of_python():
    compared(FEW)


@pytest.mark.slow
@pytest.mark.parametrize("case", names())
def test_every_stock_case_moves_in_the_browser_as_in_python(case):
    compared([case])


# --- a model of its own: endings, retried steps, phases --------------------------------------------------------------

x, v = State("x", "1", "position"), State("v", "1", "velocity")
a, w, o = (Parameter(name, "1", name, order=name == "o") for name in "awo")
PUSHED = {x: v, v: a * cos(w * t) + 0.3 * cos(o * w * t) - 0.1 * v}


def pushed(*, order="1/3", **declared):
    model = Model("pushed", (x, v), (a, w, o), PUSHED, harmonics=(w, o * w), **declared)
    return System(model, {"a": 0.5, "w": 1.3, "o": Fraction(order)})


def both(system, options, steps=100, **more):
    (motion,) = motions([(system, {"a": np.array([0.5, 0.6])}, {"a": 0.5}, options, {"steps": steps})])
    return motion, whirlmap.simulate(system, steps=steps, **options, **more)


def test_a_run_ends_where_a_gap_closes():
    motion, series = both(pushed(stops={"wall": Stop(1.2 - x, "wall")}), T20)
    assert Status(int(series["status"])) == Status.contact
    late = series["end_time"].item() / series.attrs["period_T"]
    assert abs(motion["ended"]["turn"] - late) < 1e-9
    assert worst(series, motion) < WANTED
    assert len(motion["x"]) < 2001


def test_a_run_ends_where_a_state_leaves_its_bound():
    motion, series = both(pushed(bound=1.5), T20)
    assert Status(int(series["status"])) == Status.diverged
    assert abs(motion["ended"]["turn"] - series["end_time"].item() / series.attrs["period_T"]) < 1e-9


def test_a_step_that_fails_is_redone_in_shorter_ones():
    """Steps of a whole T are unstable here; they end behind a gap that physics does not let close, and are redone."""
    stiff = {x: v, v: a * cos(w * t) + 0.3 * cos(o * w * t) - 64 * x - v}
    model = Model("stiff", (x, v), (a, w, o), stiff, harmonics=(w, o * w),
                  stops={"wall": Stop(1 - x**2, "wall", reachable=Integer(0))})  # fmt: skip
    system = System(model, {"a": 0.5, "w": 1.3, "o": Fraction("1/3")})
    motion, series = both(system, {"transient": 0, "periods": 12}, steps=1)
    fine = whirlmap.simulate(system, periods=12, steps=100, every=100)
    assert motion["ended"] is None
    assert worst(series, motion) < WANTED
    assert np.max(np.abs(motion["x"] - fine["x"].values)) < 1e-3  # and no step of a whole T was taken


@pytest.mark.parametrize("order", ["1/3", "12345/98765", "-3/7", "618033988749/1000000000000"])
def test_harmonics_keep_their_phase_through_a_transient(order):
    motion, series = both(pushed(order=order), {"transient": 7, "periods": 20})
    assert motion["turn"][0] == 7
    assert worst(series, motion) < WANTED


def test_each_point_has_its_own_steps_and_the_nearest_one_is_taken():
    system, axis = pushed(), np.array([0.5, 0.6, 0.8])
    packed = {"steps": np.array([20, 40, 60])}
    found = motions([(system, {"a": axis}, {"a": at}, {"transient": 0, "periods": 3}, packed) for at in (0.1, 0.61, 0.75)])
    assert [m["values"]["a"] for m in found] == [0.5, 0.6, 0.8]
    for m, value, steps in zip(found, axis, (20, 40, 60), strict=True):
        series = whirlmap.simulate(system.replace(a=value), periods=3, steps=steps)
        assert worst(series, m) < WANTED


@pytest.mark.slow
def test_points_are_thinned_out_where_they_would_be_too_large():
    system = whirlmap.load("gear-psfd/intended")
    space = space_of(system, {"s": np.linspace(0.5, 2, 64), "psi": np.geomspace(1e-4, 1e-2, 32)})
    description, data = live_points(system, space, most=200_000)
    counts = [len(axis["values"]) for axis in description["axes"]]
    assert len(data) < 500_000  # kernels beside the numbers
    assert description["thinned"][0] * counts[0] >= 64
    assert counts[0] * counts[1] < 64 * 32
    assert counts[0] > 1
    s, psi = (description["axes"][k]["values"][-1] for k in range(2))
    (motion,) = motions([(system, dict(zip(("s", "psi"), space.axes.values(), strict=True)), {"s": s, "psi": psi},
                          {"transient": 0, "periods": 3}, {"most": 200_000})])  # fmt: skip
    series = whirlmap.simulate(system.replace(s=s, psi=psi), periods=3, steps=100)
    assert worst(series, motion) < WANTED


@pytest.mark.slow
def test_a_plain_film_and_a_porous_one_are_kernels_of_their_own():
    system = whirlmap.load("gear-psfd/intended")
    jobs = [(system, {"psi": np.array([0.0, 1e-3])}, {"psi": psi}, {"transient": 0, "periods": 3}) for psi in (0.0, 1e-3)]
    for motion, psi in zip(motions(jobs), (0.0, 1e-3), strict=True):
        assert worst(whirlmap.simulate(system.replace(psi=psi), periods=3, steps=100), motion) < WANTED
