"""How many attractors there are, where symmetry, a shift in time or an exact solution says it."""

import numpy as np
import pytest
from sympy import Rational

import whirlmap
from whirlmap.equations import Model, Parameter, State, cos, t
from whirlmap.integrate.system import System
from whirlmap.options.computed import Integration, Labelling
from whirlmap.options.execution import Execution
from whirlmap.results.regime import Regime
from whirlmap.sweep.attractors.attractor_search import Search
from whirlmap.sweep.attractors.attractors import attractors
from whirlmap.sweep.attractors.repeat_time import repeat_of_forcing
from whirlmap.sweep.attractors.start_states import draw_starts

BOX = {"x": (-2.0, 2.0), "v": (-2.0, 2.0)}
SHORT = whirlmap.Settling(transient=60, most=8)


def same_parts(one, other):
    """Whether two lists of numbers divide the starts in the same way."""
    pairs = set(zip(one, other, strict=True))
    return len(pairs) == len(set(one)) == len(set(other))


@pytest.fixture(scope="module")
def mirrored_chaos():
    """In one well each: the mirror of the other half a period later."""
    system = whirlmap.load("duffing", gamma=0.3)
    starts = draw_starts(system, 200, BOX, 0)
    return system, starts, attractors(system, starts=starts, settling=SHORT, lyapunov=512)


def test_two_mirrored_strange_attractors_are_two(mirrored_chaos):
    _, _, ds = mirrored_chaos
    assert ds["regime"].values.tolist() == [Regime.chaotic] * 2 and int(ds["starts"].sum()) == 200
    left, right = ds["mean"].sel(quantity="x").values
    assert abs(left + right) < 0.01 * abs(left - right)


def test_the_order_of_the_starts_does_not_matter(mirrored_chaos):
    system, starts, ds = mirrored_chaos
    order = np.random.default_rng(1).permutation(starts.shape[1])
    again = attractors(system, starts=starts[:, order], settling=SHORT, lyapunov=512)
    assert same_parts(again["attractor_of"].values, ds["attractor_of"].values[order])


def test_one_strange_attractor_over_both_wells_is_one():
    """Also just behind the parameter at which the two met, where motion stays in a well for many periods."""
    for gamma in (0.305, 0.5):
        ds = attractors(whirlmap.load("duffing", gamma=gamma), starts=400, box=BOX, settling=SHORT, lyapunov=512)
        assert ds.sizes["attractor"] == 1 and int(ds["starts"][0]) == 400, gamma


@pytest.mark.parametrize(("gamma", "many"), [(0.5, 1), (0.3, 2)])
def test_sets_that_a_search_took_for_several_are_joined(gamma, many):
    """Every tenth start of each attractor is given to another one, with a trace of its own."""
    system = whirlmap.load("duffing", gamma=gamma)
    starts = draw_starts(system, 80, BOX, 0)
    search = Search(system, Labelling(SHORT, 512, Integration(steps=24)), Execution(), starts)
    found = search.run()
    assert len(found.representative) == many
    for number in range(many):
        some = np.flatnonzero(found.of == number)[::10]
        found.of[some] = len(found.representative)
        search.known.traces[len(found.representative)] = search._traces(some[:1], 2048)[0], False
        found.representative.append(search.x[:, some[0]])
        found.multiple.append(0)
    before = search.x.copy()
    search._join_sets()
    assert len(found.representative) == len(search.known.traces) == many and set(found.of) == set(range(many))
    e = search.ensemble(before)
    right = e.advance(500, save_periods=1).saved[:, 0].mean(axis=0) > 0
    assert many == 1 or same_parts(found.of, right)


@pytest.mark.slow
def test_a_whole_slice_of_one_strange_attractor_is_one():
    grid = {name: np.linspace(-2, 2, 200) for name in ("x", "v")}
    ds = whirlmap.basins(whirlmap.load("duffing"), grid)
    assert ds.sizes["attractor"] == 1 and (ds["attractor_of"] == 1).all()


def test_an_orbit_met_at_all_of_its_phases_is_one():
    """The orbit of 5 T of gamma = 0.37 is its own mirror; starts stand on each of its five points."""
    system = whirlmap.load("duffing", gamma=0.37)
    first = attractors(system, starts=1, settling=SHORT, lyapunov=256)
    points = first["section"].values[0, :5].T
    ds = attractors(system, starts=points, settling=SHORT, lyapunov=256)
    assert ds["period_T"].values.tolist() == [5] and ds["starts"].values.tolist() == [5]


def two_clocks(weak):
    """Duffing's oscillator with a second forcing of half the frequency, of 2 T where gamma = 0.28."""
    x, v = State("x", "1", "displacement"), State("v", "1", "velocity")
    w, g, b = Parameter("w", "1", "frequency", above=0), Parameter("g", "1", "forcing"), Parameter("b", "1", "weak forcing")
    rates = {x: v, v: g * cos(w * t) + b * cos(w * t / 2) - Rational(3, 10) * v + x - x**3}
    model = Model("two_clocks", (x, v), (w, g, b), rates, harmonics=(w, w / 2), swing=(x,))
    return System(model, {"w": 1.2, "g": 0.28, "b": weak})


def test_a_shift_by_T_makes_orbits_one_where_T_is_a_period_of_all_forcing():
    """The orbits of 2 T in one well, T apart. The common period is 2 T: each return to themselves after one.

    Without the second forcing they are one motion, begun at another T; with it the forcing is not the same after T, and
    they are two that differ.
    """
    counts = []
    for weak in (0.0, 0.001):
        system = two_clocks(weak)
        ds = attractors(system, starts=60, box={"x": (0.5, 1.5), "v": (-0.5, 0.5)}, settling=SHORT, lyapunov=256)
        assert system.common_multiple == 2 and int(ds["starts"].sum()) == 60
        assert (ds["period_T"].values == 2).all()
        right = ds["mean"].sel(quantity="x").values > 0
        counts.append(int(right.sum()))
    assert counts == [1, 2]
    x = np.ones((2, 3))
    assert [repeat_of_forcing(two_clocks(b), x) for b in (0.0, 1e-6, 0.1)] == [1, 2, 2]


def beside(apart):
    """u follows y, and differs by ``apart`` z, where z goes to 1 or to -1: two orbits as far apart as one likes."""
    y, u = State("y", "1", "y"), State("u", "1", "u")
    e, w = Parameter("e", "1", "distance", above=0), Parameter("w", "1", "frequency", above=0)
    z = (u - y) / e
    rates = {y: cos(w * t) - y, u: cos(w * t) - y + e * (z - z**3)}
    model = Model("beside", (y, u), (e, w), rates, harmonics=(w,), swing=(y,))
    return System(model, {"e": apart, "w": 1.0})


@pytest.mark.parametrize("apart", [1e-2, 3e-5])
def test_two_orbits_close_to_each_other_are_two(apart):
    y = np.zeros(40)
    z = np.where(np.arange(40) % 3 == 0, -0.5, 0.5)
    ds = attractors(beside(apart), starts=np.stack([y, y + apart * z]), settling=SHORT, lyapunov=256)
    assert ds.sizes["attractor"] == 2
    assert same_parts(ds["attractor_of"].values, (z > 0).astype(int))


def test_every_start_of_the_dead_zone_has_the_orbit_that_a_plain_run_comes_to():
    """That of 8 T lies about that of 4 T, and attracts slowly: for one return it looks like an approach to the other."""
    system = whirlmap.load("gear_backlash", Omega=1.0, zeta=0.05, F_ah=0.2)
    starts = draw_starts(system, 96, {"x": (-3, 3), "v": (-2, 2)}, 0)
    ds = attractors(system, starts=starts)
    alike = Labelling(lyapunov=0, integration=Integration(steps=int(ds["steps"][0])))
    plain = Search(system, alike, Execution(), starts).ensemble(starts)
    plain.advance(2000)
    end = plain.x.copy()
    later = plain.advance(8, save_periods=1).saved
    returns = (np.abs(later - end) < 1e-6).all(axis=1)
    np.testing.assert_array_equal(ds["period_T"].values[ds["attractor_of"].values - 1], 1 + returns.argmax(axis=0))


def linear(damping):
    """x'' + 2 damping x' + x = cos(w t): one orbit, for whatever start."""
    x, v = State("x", "1", "x"), State("v", "1", "v")
    d, w = Parameter("d", "1", "damping"), Parameter("w", "1", "frequency", above=0)
    model = Model("linear", (x, v), (d, w), {x: v, v: cos(w * t) - 2 * d * v - x}, harmonics=(w,), swing=(x,))
    return System(model, {"d": damping, "w": 0.8})


@pytest.mark.parametrize("damping", [1e-3, 1e-4, 1e-5])
def test_slow_contraction_to_one_orbit_is_one_attractor(damping):
    """e of contraction takes 127 to 12 700 T: without short cuts no run has settled after 188, or is given the time."""
    settling = whirlmap.Settling(transient=60, accelerate=False)
    ds = attractors(linear(damping), starts=24, box=BOX, settling=settling, lyapunov=256)
    assert ds["period_T"].values.tolist() == [1] and ds["starts"].values.tolist() == [24]
    swing = 2 / np.abs(1 - 0.64 + 1.6j * damping)
    np.testing.assert_allclose(ds["peak_to_peak"].sel(quantity="x"), swing, rtol=1e-5)


def test_settled_and_unsettled_runs_are_on_one_orbit():
    amplitude = 1 / (1 - 0.64 + 1.6e-3j)
    starts = draw_starts(linear(1e-3), 8, BOX, 0)
    starts[:, 0] = amplitude.real, (0.8j * amplitude).real
    ds = attractors(linear(1e-3), starts=starts, settling=whirlmap.Settling(transient=60, accelerate=False), lyapunov=256)
    assert ds["period_T"].values.tolist() == [1] and ds["starts"].values.tolist() == [8]


def driven_wells():
    """A van der Pol oscillator on a torus shakes a mass that stays in one of two wells: two tori."""
    x, v, y, u = (State(n, "1", n) for n in ("x", "v", "y", "u"))
    w = Parameter("w", "1", "frequency", above=0)
    rates = {x: v, v: y / 40 - v / 2 + x - x**3, y: u, u: cos(w * t) / 2 + (1 - y**2) * u / 2 - y}
    model = Model("driven_wells", (x, v, y, u), (w,), rates, harmonics=(w,), swing=(x, y))
    return System(model, {"w": 1.7})


def test_two_tori_are_two_and_each_is_one():
    ds = attractors(driven_wells(), starts=48, box=dict.fromkeys("xvyu", (-2.0, 2.0)), settling=SHORT, lyapunov=1024)
    assert ds["regime"].values.tolist() == [Regime.quasi_periodic] * 2 and int(ds["starts"].sum()) == 48
    left, right = ds["mean"].sel(quantity="x").values
    assert left * right < 0
