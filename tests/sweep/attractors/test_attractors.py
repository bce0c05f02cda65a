"""Coexisting attractors and their basins, where symmetry or known_values.md says what they are."""

import numpy as np
import pytest
import xarray as xr
from scipy.integrate import solve_ivp
from tests.independent.dead_zone import DeadZone

import whirlmap
from whirlmap.errors import RangeError
from whirlmap.options.computed import Labelling
from whirlmap.results.regime import Regime
from whirlmap.sweep.attractors.attractor_search import Search
from whirlmap.sweep.attractors.attractors import attractors
from whirlmap.sweep.attractors.basins import basins
from whirlmap.sweep.attractors.start_states import default_box, draw_starts

BOX = {"x": (-2.0, 2.0), "v": (-2.0, 2.0)}
SHORT = whirlmap.Settling(transient=60, most=8)


@pytest.fixture(scope="module")
def duffing():
    return whirlmap.load("duffing", gamma=0.2)


@pytest.fixture(scope="module")
def twins(duffing):
    """At gamma = 0.2 two orbits coexist, each the mirror of the other half a period later."""
    return attractors(duffing, starts=300, box=BOX, seed=3, settling=SHORT, lyapunov=256)


def test_two_mirrored_orbits_share_the_plane(duffing, twins):
    assert twins.sizes["attractor"] == 2
    assert (twins["regime"] == Regime.periodic).all() and (twins["period_T"] == 1).all()
    np.testing.assert_allclose(twins["mean"][0], -twins["mean"][1], atol=1e-5)
    np.testing.assert_allclose(twins["maximum"][0], -twins["minimum"][1], atol=1e-5)
    # The exponents of each sum to -delta, and a complex pair makes both equal: -0.15.
    np.testing.assert_allclose(twins["lyapunov"], -0.15, atol=0.003)
    assert float(twins["starts"].sum()) == 300 and int(twins["outcome_starts"].sum()) == 0
    assert (twins["attractor_of"] > 0).all() and np.all(np.diff(twins["starts"]) <= 0)


def test_a_start_and_its_mirror_half_a_period_later_reach_opposite_orbits(duffing, twins):
    """If z(t) is a motion, so is -z(t + T/2): its start is -z(T/2), integrated here by SciPy."""
    first = twins["start_state"].values[:, :60]
    omega, delta, gamma = (float(duffing.values[n]) for n in ("omega", "delta", "gamma"))

    def rates(t, z):
        x, v = z
        return [v, gamma * np.cos(omega * t) - delta * v + x - x**3]

    half = np.array([solve_ivp(rates, (0, np.pi / omega), z, rtol=1e-10, atol=1e-12).y[:, -1] for z in first.T])
    mirrored = attractors(duffing, starts=-half.T, settling=SHORT, lyapunov=256)
    sign = np.sign(twins["mean"].sel(quantity="x").values)[twins["attractor_of"].values[:60] - 1]
    other = np.sign(mirrored["mean"].sel(quantity="x").values)[mirrored["attractor_of"].values - 1]
    assert set(sign) == {-1.0, 1.0}
    np.testing.assert_array_equal(sign, -other)


def test_shares_have_the_binomial_error(twins):
    k, n = twins["starts"].values, 300
    p = (k + 1) / (n + 2)
    np.testing.assert_allclose(twins["share"], k / n)
    np.testing.assert_allclose(twins["share_error"], np.sqrt(p * (1 - p) / (n + 3)))
    assert (twins["outcome_share_error"] > 0).all()  # nobody saw one, which does not make it impossible


def test_a_share_and_its_error_hold_for_other_draws(duffing, twins):
    again = attractors(duffing, starts=300, box=BOX, seed=4, settling=SHORT, lyapunov=256)
    left, right = (float(ds["share"].values[np.argmax(ds["mean"].sel(quantity="x").values)]) for ds in (twins, again))
    assert left != right and abs(left - right) < 4 * np.hypot(*(float(d["share_error"][0]) for d in (twins, again)))


def test_a_search_is_repeatable_to_the_bit_on_any_number_of_threads(duffing, twins):
    again = attractors(duffing, starts=300, box=BOX, seed=3, settling=SHORT, lyapunov=256, workers=1)
    xr.testing.assert_identical(again.drop_attrs(), twins.drop_attrs())


def test_the_orbits_of_the_dead_zone_are_those_of_its_exact_solution():
    """known_values.md lists 2 T and 4 T, of two starts; a third one of 8 T attracts, though slowly."""
    system = whirlmap.load("gear_backlash", Omega=1.0, zeta=0.05, F_ah=0.2)
    ds = attractors(system, starts=96, box={"x": (-3, 3), "v": (-2, 2)}, lyapunov=1024)
    assert sorted(ds["period_T"].values) == [2, 4, 8] and int(ds["starts"].sum()) == 96
    assert "accuracy_not_met" not in ds.attrs  # contacts are located, so that few steps do
    exact = DeadZone(0.05, 0.1, 0.2, 1.0)
    largest = {2: 0.533488, 4: 0.482153, 8: 0.898125}  # moduli of the multipliers
    for k, period in enumerate(ds["period_T"].values.astype(int)):
        here = ds["section"].values[k, 0]
        orbit, multipliers = exact.orbit(here, period)
        np.testing.assert_allclose(here, orbit, atol=1e-5)
        found = whirlmap.floquet_multipliers(system, orbit, period * system.period)
        assert float(found["closure"]) < 1e-9
        value = found["real"].values + 1j * found["imaginary"].values
        np.testing.assert_allclose(np.sort_complex(value), np.sort_complex(multipliers), atol=1e-9)
        assert np.abs(multipliers).max() == pytest.approx(largest[period], abs=1e-6)
        assert np.prod(multipliers).real == pytest.approx(np.exp(-0.1 * period * exact.period))  # Liouville


def test_there_is_no_orbit_of_16_T_in_the_dead_zone():
    """With 256 steps one appears 8e-4 beside that of 8 T; from there the exact map goes to the latter."""
    exact = DeadZone(0.05, 0.1, 0.2, 1.0)
    near = np.array([-0.02840, 0.36090])  # of the orbit of 16 T, as integrated
    orbit, multipliers = exact.orbit(near, 16)
    np.testing.assert_allclose(exact.turn(orbit, 8)[0], orbit, atol=1e-9)
    assert np.abs(multipliers).max() == pytest.approx(0.898125**2, abs=1e-5)
    assert np.abs(exact.turn(near, 64)[0] - orbit).max() < 0.5 * np.abs(near - orbit).max()


def test_the_exact_solution_is_one():
    """Against an integrator that knows nothing of the pieces."""
    exact = DeadZone(0.05, 0.1, 0.2, 1.0)

    def rates(t, z):
        x, v = z
        return [v, 0.1 + 0.2 * np.cos(t) - 0.1 * v - (x - 1 if x > 1 else x + 1 if x < -1 else 0.0)]

    end = solve_ivp(rates, (0, 6 * np.pi), [1.1, 0.0], method="DOP853", rtol=1e-12, atol=1e-13, max_step=0.01).y[:, -1]
    after, tangent = exact.turn([1.1, 0.0], 3)
    np.testing.assert_allclose(after, end, atol=1e-8)
    around = [exact.turn(np.array([1.1, 0.0]) + 1e-6 * e, 3)[0] - exact.turn(np.array([1.1, 0.0]) - 1e-6 * e, 3)[0]
              for e in np.eye(2)]  # fmt: skip
    np.testing.assert_allclose(tangent, np.transpose(around) / 2e-6, atol=1e-5)


def test_rotations_of_the_pendulum_are_gathered_modulo_a_turn():
    ds = attractors(whirlmap.load("pendulum", g=1.35), starts=64, settling=SHORT, lyapunov=256)
    assert ds["period_T"].values.tolist() == [1, 1]
    # One turn per T either way round: mean rates are +- omega.
    np.testing.assert_allclose(np.sort(ds["mean"].sel(quantity="v")), [-2 / 3, 2 / 3], atol=1e-4)


def test_one_strange_attractor_and_one_torus_are_one_each():
    for case, kind in ((whirlmap.load("duffing", gamma=0.5), Regime.chaotic),
                       (whirlmap.load("van_der_pol", omega=1.387), Regime.quasi_periodic)):  # fmt: skip
        ds = attractors(case, starts=100, lyapunov=512)
        assert ds["regime"].values.tolist() == [kind] and int(ds["starts"][0]) >= 97, case.case


@pytest.mark.parametrize(
    ("case", "options"),
    [("duffing", {"gamma": 0.5}), ("van_der_pol", {"omega": 1.387}), ("pendulum", {"g": 1.5})],
    ids=["chaos", "torus", "pendulum"],
)
def test_traces_made_together_gather_as_one_after_the_other(case, options):
    system = whirlmap.load(case, **options)
    labelling = Labelling(whirlmap.Settling(transient=30, most=8), 256, whirlmap.Integration(steps=48))
    starts = draw_starts(system, 40, {"x": (-2.0, 2.0), "v": (-2.0, 2.0)}, 5)
    found = []
    for together in (1, 16):
        search = Search(system, labelling, whirlmap.Execution(), starts)
        search.together = together
        found.append((search.run(), search.known.traces))
    (one, traces), (many, traced) = found
    np.testing.assert_array_equal(one.of, many.of)
    np.testing.assert_array_equal(np.stack(one.representative), np.stack(many.representative))
    assert len(traces) == len(traced) and all(np.array_equal(traces[n][0], traced[n][0]) for n in traces)


def test_a_run_that_diverges_is_no_attractor():
    """A softening spring, x'' + 0.3 x' + x - x^3: starts beyond the saddles at +-1 run away."""
    system = whirlmap.load("duffing", alpha=1.0, beta=-1.0, gamma=0.05)
    ds = attractors(system, starts=np.array([[0.1, 3.0, -3.0], [0.0, 3.0, -3.0]]), settling=SHORT, lyapunov=256)
    assert ds["attractor_of"].values.tolist() == [1, 0, 0]
    assert ds["start_regime"].values.tolist() == [Regime.periodic, Regime.diverged, Regime.diverged]
    assert ds["outcome_starts"].sel(outcome="diverged") == 2
    none = attractors(system, starts=np.array([[3.0], [3.0]]), settling=SHORT, lyapunov=256)
    assert none.sizes.get("attractor", 0) == 0 and float(none["outcome_share"].sel(outcome="diverged")) == 1


def test_basins_are_the_attractors_of_their_starts(duffing):
    grid = {"x": np.linspace(-2, 2, 12), "v": np.linspace(-2, 1.5, 9)}
    ds = basins(duffing, grid, settling=SHORT, lyapunov=256)
    assert ds["attractor_of"].dims == ("x", "v") and ds["attractor_of"].shape == (12, 9)
    x, v = np.meshgrid(*grid.values(), indexing="ij")
    same = attractors(duffing, starts=np.stack([x.ravel(), v.ravel()]), settling=SHORT, lyapunov=256)
    np.testing.assert_array_equal(ds["attractor_of"].values.ravel(), same["attractor_of"])
    one = attractors(duffing, starts=np.array([[grid["x"][3]], [grid["v"][7]]]), settling=SHORT, lyapunov=256)
    np.testing.assert_allclose(
        one["mean"].values[0], ds["mean"].sel(attractor=ds["attractor_of"].values[3, 7]), atol=1e-5
    )


def test_the_default_box_is_about_the_motion(duffing):
    box = default_box(duffing, Labelling(SHORT, 0))
    assert box["x"][0] < 0.6 < 1.2 < box["x"][1]
    starts = draw_starts(duffing, 1000, {"v": (-1.0, 0.5)}, 1)
    assert (starts[0] == 1.0).all() and -1 <= starts[1].min() < -0.98 and 0.48 < starts[1].max() <= 0.5


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"box": {"y": (0, 1)}}, "no state 'y'"),
        ({"box": {"x": (1, 0)}}, "ascend"),
        ({"box": {}}, "at least one"),
        ({"starts": 0}, "between 1"),
        ({"starts": np.zeros((3, 4))}, "expected 2 states"),
        ({"starts": np.zeros((2, 4)), "box": BOX}, "expected none"),
        ({"lyapunov": 100}, "between 256"),
    ],
)
def test_what_cannot_be_searched_is_refused(duffing, options, words):
    with pytest.raises(RangeError, match=words):
        attractors(duffing, **options)


@pytest.mark.parametrize(
    ("grid", "words"),
    [
        ({"x": [0, 1]}, "expected two"),
        ({"x": [0, 1], "w": [0, 1]}, "no state 'w'"),
        ({"x": [1, 0], "v": [0, 1]}, "ascend"),
    ],
)
def test_a_grid_that_is_none_is_refused(duffing, grid, words):
    with pytest.raises(RangeError, match=words):
        basins(duffing, grid)
