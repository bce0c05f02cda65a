"""Branches that are hard to follow, each against a truth of its own: no wrong event, no silent end, no endless run."""

import numpy as np
import pytest
from tests.sweep.branches.exact_systems import cubic_rotor, forced_hopf
from tests.sweep.branches.hostile_systems import (
    Omega,
    dry_friction,
    fold_of_cycles,
    growing_cycle,
    mirrored,
    one_sided_spring,
    oscillator_with_stop,
    pushed_to_a_stop,
    stretched,
    two_frequencies,
    unforced_amplitude,
    v,
    x,
)
from tests.sweep.branches.test_exact_branches import ends, found, kinds

import whirlmap
from whirlmap import continue_orbit
from whirlmap.analysis.branches import orbit_steps
from whirlmap.equations import Model, Parameter, Section, State, cos, sin, t, when
from whirlmap.errors import RangeError
from whirlmap.integrate.system import System

#: Each run is bounded in time.
pytestmark = pytest.mark.timeout(240)


def fold_of_the_hopf_oscillator(g):
    """Detunings d > 0 of the folds: 2 rho^2 (1 - rho) = g^2, d^2 = -1 + 4 rho - 3 rho^2."""
    rho = np.roots([2, -2, 0, g * g]).real
    square = -1 + 4 * rho - 3 * rho**2
    return np.sort(np.sqrt(square[(rho > 0) & (square > 0)]))


def peak_reaches_one(F, zeta=0.1):
    """Frequencies at which F/|1 - Omega^2 + 2 i zeta Omega| = 1, ascending."""
    return np.sort(np.sqrt(np.roots([1, 4 * zeta * zeta - 2, 1 - F * F]).real))


def test_an_isola_is_closed_and_followed_once():
    """g^2 = 0.04 < 4/27: a loop about rho = 1, apart from the branch at small rho."""
    ds = continue_orbit(forced_hopf(g=0.2, Omega=2.0), "Omega", (1.0, 3.0), begin=2.0)
    assert ends(ds) == [["closed", "closed"]]
    assert kinds(ds) == ["fold", "fold"]
    (d,) = fold_of_the_hopf_oscillator(0.2)
    np.testing.assert_allclose(np.sort(found(ds, "fold")[0]), [2 - d, 2 + d], rtol=1e-9)
    points = np.column_stack([ds["Omega"].values, ds["section"].values[:, 0]])
    rho = (points[:, 1:] ** 2).sum(axis=1)
    np.testing.assert_allclose(rho * ((1 - rho) ** 2 + (points[:, 0] - 2) ** 2), 0.04, rtol=1e-9)
    # The first point closes the line, and is the only one that is there twice.
    np.testing.assert_allclose(points[-1], points[0], atol=1e-9)
    apart = np.abs(points[:-1, None] - points[None, :-1]).max(axis=2) + np.eye(len(points) - 1)
    assert apart.min() > 1e-6


@pytest.mark.parametrize("longest", [0.02, 0.3])
@pytest.mark.parametrize(("beyond", "events"), [(-1e-4, []), (-1e-9, []), (1e-5, ["fold", "fold"])])
def test_a_branch_that_leaves_the_range_ends_there(beyond, events, longest):
    """The upper fold of the cubic rotor lies just beyond the range, where the branch ends, or just within."""
    fold = 1.295061081428043
    ds = continue_orbit(cubic_rotor(Omega=0.6), "Omega", (0.6, fold + beyond), longest=longest)
    assert ends(ds) == [["range", "range"]]
    assert kinds(ds) == events
    omega = ds["Omega"].values
    assert omega.min() == 0.6
    assert omega.max() == fold + beyond
    square = (ds["section"].values[:, 0, :2] ** 2).sum(axis=1)
    left = square * ((1 + 0.1 * square - omega**2) ** 2 + (0.1 * omega) ** 2)
    np.testing.assert_allclose(left, 0.04 * omega**4, rtol=1e-9)


@pytest.mark.parametrize("longest", [pytest.param(0.1, marks=pytest.mark.slow), 1.0])
def test_two_folds_near_a_cusp_are_seen_with_long_steps(longest):
    """Both folds of the forced Hopf oscillator at g = 0.45, and the cusp of their curve."""
    ds = continue_orbit(forced_hopf(g=0.45, Omega=2.05), "Omega", (2.0, 3.0), begin=2.05, longest=longest)
    assert kinds(ds) == ["fold", "fold"]
    np.testing.assert_allclose(np.sort(found(ds, "fold")[0]) - 2, fold_of_the_hopf_oscillator(0.45), rtol=1e-9)
    z = 0.45 / (np.max(np.roots([1, -2, 1 + 0.05**2, -(0.45**2)]).real) - 1 + 0.05j)
    vary = {"Omega": (2.0, 3.0), "g": (0.3, 0.7)}
    curve = whirlmap.event_curve(
        forced_hopf(g=0.45), vary, "fold", begin=2.05, orbit=(z.real, z.imag), longest=longest
    )
    k = kinds(curve).index("cusp")
    assert curve["event_Omega"].values[k] - 2 == pytest.approx(np.sqrt(1 / 3), rel=1e-9)
    assert curve["event_g"].values[k] == pytest.approx(np.sqrt(8 / 27), rel=1e-9)


@pytest.mark.parametrize(("largest", "smallest"), [(1e8, 1e-12), (1.9, 1e-30), (1e8, 1e-30)])
def test_multipliers_of_any_size(largest, smallest):
    """Linear: exp(2 pi a/Omega) and exp(-2 pi b/Omega), to 1e-8 of themselves."""
    a, b, omega = np.log(largest) / (2 * np.pi), -np.log(smallest) / (2 * np.pi), 0.9
    p, q = -a / (a * a + omega**2), -omega / (b * b + omega**2)
    system = stretched(a=a, b=b)
    ds = continue_orbit(system, "Omega", (0.9, 1.2), begin=omega, orbit=(p + q / 2, -p / 3 + q))
    assert ends(ds) == [["range", "range"]]
    assert kinds(ds) == []
    T = 2 * np.pi / ds["Omega"].values
    np.testing.assert_allclose(ds["log_modulus"].values, np.column_stack([a * T, -b * T]), rtol=0, atol=1e-8)
    assert ds["steps"].values.max() <= 512  # rounding that a long segment stretches asks for no more of them


@pytest.mark.parametrize("F", [0.5, 0.2, 0.1990174])
def test_orbits_that_graze(F):
    """The linear orbit reaches the wall at both sides of the resonance; at last these lie within one step."""
    ds = continue_orbit(one_sided_spring(F=F), "Omega", (0.3, 1.6))
    np.testing.assert_allclose(np.sort(found(ds, "grazing")[0]), peak_reaches_one(F), rtol=1e-9)
    assert set(kinds(ds)) <= {"grazing", "fold"}


def test_just_below_the_wall_nothing_grazes():
    """The peak of the resonance stays 1e-5 below the wall."""
    assert kinds(continue_orbit(one_sided_spring(F=0.19899549), "Omega", (0.3, 1.6))) == []


@pytest.mark.parametrize(
    ("start", "longest"), [((0.5, 0.0), 0.02), pytest.param((0.5, 0.4), 0.02, marks=pytest.mark.slow), ((0.5, 0.4), 0.5)]
)
def test_a_pitchfork_is_a_branch_point_and_no_fold(start, longest):
    """y = 0 loses its stability at the mean of x^2, 1/(2 (1 + Omega^2)) = 1/4; the other branch turns there.

    From the other branch the equations are singular along the first one, and rounding grows: 1e-8 was measured with short
    steps, 5e-8 to 1.2e-6 with long ones, whatever the accuracy.
    """
    ds = continue_orbit(mirrored(mu=0.5), "mu", (0.0, 0.5), begin=0.5, orbit=start, longest=longest)
    assert kinds(ds) == ["branch-point"]
    other = 1e-7 if longest < 0.1 else 5e-6
    assert found(ds, "branch-point")[0][0] == pytest.approx(0.25, abs=other if start[1] else 1e-10)
    y = ds["section"].values[:, 0, 1]
    assert (np.abs(y[[0, -1]]) > 0.1).all() == bool(start[1])
    assert y[0] * y[-1] <= 0


def test_the_speed_in_rpm_is_given_in_rpm_and_kept_in_own_numbers():
    """The threshold of a rig: the same point against its own speed."""
    rig = whirlmap.load("machines/jeffcott-rig")
    ds = continue_orbit(rig, "speed", "4000 rpm:9000 rpm")
    name = str(ds.attrs["varied"])
    assert ends(ds) == [["range", "range"]]
    (value,) = found(ds, "neimark-sacker")[0]
    size = float(np.atleast_1d(ds.attrs["size_given"])[0])
    assert (ds.attrs["given"], ds.attrs["unit_given"]) == ("speed", "rpm")
    np.testing.assert_allclose(ds[name].values[[0, -1]] / size, [4000, 9000], rtol=1e-12)
    own = continue_orbit(rig, name, (4000 * size, 9000 * size))
    assert found(own, "neimark-sacker")[0][0] == pytest.approx(value, rel=1e-9)


def test_a_forcing_without_common_period_is_refused():
    """cos(Omega t) + cos(sqrt(2) Omega t): no orbit closes, and it is said."""
    with pytest.raises(RangeError, match="no common period"):
        continue_orbit(two_frequencies(), "Omega", (0.5, 1.5), orbit=(0.5,))


def test_sliding_without_sticking_has_the_multipliers_of_the_jumps():
    """Den Hartog's oscillator at f = 0.2, Omega = 0.7; SciPy with events, differences of the map: -0.583089 +- 0.288451i."""
    ds = continue_orbit(dry_friction(), "Omega", (0.65, 0.75), begin=0.7)
    k = int(np.abs(ds["Omega"].values - 0.7).argmin())
    np.testing.assert_allclose(ds["section"].values[k, 0], [1.88885275, 0.29410056], atol=2e-8)
    multipliers = np.exp(ds["log_modulus"].values[k] + 1j * ds["argument"].values[k])
    truth = [-0.58308899 + 0.28845122j, -0.58308899 - 0.28845122j]
    np.testing.assert_allclose(multipliers, truth, atol=1e-6)


def test_twice_the_segments_give_the_same_events(monkeypatch):
    """Folds of the cubic rotor with 8 and with 16 segments."""
    few = continue_orbit(cubic_rotor(Omega=1.0), "Omega", (1.0, 1.5))
    monkeypatch.setattr(orbit_steps, "LANES", 2 * orbit_steps.LANES)
    monkeypatch.setattr(orbit_steps, "WIDEST", 2 * orbit_steps.WIDEST)
    many = continue_orbit(cubic_rotor(Omega=1.0), "Omega", (1.0, 1.5))
    assert many["segments"].values.max() == 2 * few["segments"].values.max()
    assert kinds(few) == kinds(many)
    np.testing.assert_allclose(many["event_Omega"].values, few["event_Omega"].values, rtol=1e-10)


@pytest.mark.slow
def test_a_cycle_whose_section_moves_with_the_parameter_is_followed_to_its_homoclinic_end():
    """Lorenz' unstable cycle ends in the homoclinic orbit of the origin at rho = 13.926557; the end is said."""
    near = {"begin": 20.0, "period": 1, "orbit": (1.7555102308, 2.189519035, 11.755379157)}
    ds = continue_orbit(whirlmap.load("lorenz"), "rho", (13.5, 20.0), points=300, **near)
    down, up = ends(ds)[0]
    assert up == "range"
    assert down == "steps"
    assert 13.92655 < ds["rho"].values.min() < 14.0
    assert kinds(ds) == []
    assert (np.diff(ds["duration"].values) < 0).all()


@pytest.mark.slow
def test_a_cycle_that_grows_without_bound_ends_in_words():
    """Radius 1/sqrt(mu), duration 2 pi: it is followed as far as there are points, and that is said."""
    near = {"begin": 1.0, "orbit": (1.0, 0.0), "period": 1}
    ds = continue_orbit(growing_cycle(), "mu", (-0.5, 1.0), points=300, **near)
    assert ends(ds) == [["steps", "range"]]
    assert "300 points" in ds.attrs["why"] or "shortest step" in ds.attrs["why"]
    mu = ds["mu"].values
    assert mu.min() > 0
    seen = mu > 1e-3  # nearer to 0 the differences by mu, of 1e-6 of the range, reach beyond the pole
    assert seen.sum() > 50
    np.testing.assert_allclose(ds["section"].values[seen, 0, 0] ** -2, mu[seen], rtol=1e-9)
    np.testing.assert_allclose(ds["duration"].values, 2 * np.pi, rtol=1e-9)


@pytest.mark.parametrize("g", [0.0, 1e-9, 0.1])
def test_the_threshold_of_a_linear_rotor_without_unbalance(g, validate):
    """mu = 2 zeta = 0.1, seen as a Neimark-Sacker point of the orbit at rest, or of a small one."""
    ds = continue_orbit(unforced_amplitude(g=g), "mu", (0.0, 0.3))
    located = found(ds, "neimark-sacker")[0]
    validate(f"linear rotor, unbalance {g:g}: mu of the loss of stability", located[0] if located.size else "no event", 0.1,
             tier="exact", source="mu = 2 zeta", within=1e-10)  # fmt: skip
    assert kinds(ds) == ["neimark-sacker"]


def test_a_parameter_at_its_declared_limit():
    """zeta from 0, its least value: no orbit is asked for below; one that begins there goes up."""
    system = whirlmap.load("gear_backlash", zeta=0.05, F_m=0.1, F_ah=0.02, Omega=0.8)
    for begin in (0.1, 0.0):
        ds = continue_orbit(system, "zeta", (0.0, 0.1), begin=begin, orbit=None if begin else (1.1, 0.0))
        assert ends(ds) == [["range", "range"]]
        zeta = ds["zeta"].values
        assert (zeta[0], zeta[-1]) == (0.0, 0.1)
        motion = 0.02 * 0.64 / (0.36 + 2j * zeta * 0.8)  # the teeth stay together: linear about x = 1.1
        np.testing.assert_allclose(ds["section"].values[:, 0, 0], 1.1 + motion.real, rtol=1e-10)
        np.testing.assert_allclose(ds["log_modulus"].values[:, 0], -zeta * 2 * np.pi / 0.8, atol=1e-9)


@pytest.mark.parametrize(("begin", "which"), [(0.4, 0), (1.6, 1)])
def test_contact_ends_a_branch(begin, which):
    """x reaches the stop at 1 where the linear amplitude does."""
    ds = continue_orbit(oscillator_with_stop(Omega=begin), "Omega", (0.4, 1.6), begin=begin)
    assert kinds(ds) == []  # no false branch point where moved parameters run into the stop
    assert ends(ds) == [["range", "contact"] if which == 0 else ["contact", "range"]]


@pytest.mark.parametrize(("begin", "which"), [(0.4, 0), (1.6, 1)])
def test_contact_ends_a_branch_where_it_is(begin, which, validate):
    """The last point is the contact itself."""
    ds = continue_orbit(oscillator_with_stop(Omega=begin), "Omega", (0.4, 1.6), begin=begin)
    last = ds["Omega"].values.max() if which == 0 else ds["Omega"].values.min()
    validate(f"oscillator with a stop, from Omega {begin:g}: Omega at which contact ends the branch", last,
             peak_reaches_one(0.5)[which], tier="exact", source="linear amplitude in closed form", rel=1e-9)  # fmt: skip


def test_an_equilibrium_that_reaches_a_stop_ends_its_branch(validate):
    """x = F reaches 1."""
    ds = continue_orbit(pushed_to_a_stop(), "F", (0.1, 2.0), begin=0.2)
    assert ends(ds) == [["range", "contact"]]
    validate("equilibrium that reaches a stop: force of contact", ds["F"].values[-1], 1.0, tier="exact", source="x = F",
             rel=1e-12)  # fmt: skip


def test_a_pitchfork_of_a_symmetric_pendulum(validate):
    """Beside it the equations are singular: places about it bracket it. Truth: half maps with SciPy's DOP853 at 1e-13."""
    phi, c, F = State("phi", "rad", "angle"), Parameter("c", "1", "damping"), Parameter("F", "1", "forcing")
    model = Model(
        "pendulum_pitchfork", (phi, v), (c, F, Omega), {phi: v, v: F * cos(Omega * t) - c * v - sin(phi)}, harmonics=(Omega,)
    )
    ds = continue_orbit(System(model, {"c": 0.5, "F": 0.5, "Omega": 0.6667}), "F", (0.3, 1.3))
    assert kinds(ds) == ["branch-point"] and ends(ds) == [["range", "range"]]
    validate("symmetric pendulum: force of the pitchfork", ds["event_F"].values[0], 1.00438119914472, tier="independent",
             source="half map with SciPy", rel=1e-9)  # fmt: skip


def test_a_state_that_is_fast_beside_the_orbit_is_lost_and_found_with_more_steps():
    """s' = 100 (x - s) with 32 steps a turn grows beyond all numbers: no traceback, and Duffing's own folds."""
    s, F, R = State("s", "1", "follows x"), Parameter("F", "1", "forcing"), Parameter("R", "1", "rate")
    model = Model(
        "duffing_and_fast", (x, v, s), (F, Omega, R),
        {x: v, v: F * cos(Omega * t) - v / 20 - x - x**3 / 10, s: R * (x - s)}, harmonics=(Omega,),
    )  # fmt: skip
    ds = continue_orbit(System(model, {"F": 0.18, "Omega": 0.8, "R": 100.0}), "Omega", (0.8, 1.6))
    assert kinds(ds) == ["fold", "fold"]
    np.testing.assert_allclose(np.sort(found(ds, "fold")[0]), [1.115700251770920, 1.269601955545893], rtol=1e-9)


def test_an_equilibrium_behind_a_stop_is_none():
    with pytest.raises(RangeError, match="no solution"):
        continue_orbit(pushed_to_a_stop(F=1.5), "F", (1.2, 2.0), begin=1.5, orbit=(1.5, 0.0))


def test_two_branches_of_one_generation_double_each():
    system = whirlmap.load("duffing", delta=0.3, omega=1.2)
    ds = continue_orbit(system, "gamma", (0.2, 0.27), coexisting=True, starts=16, doublings=1)
    assert sorted(ds["period_T"].values.tolist()) == [1, 1, 2, 2]
    again = continue_orbit(system, "gamma", (0.2, 0.27), coexisting=True, starts=16, doublings=1, resume=ds)
    assert again["period_T"].values.tolist() == ds["period_T"].values.tolist()


def test_a_cycle_that_shrinks_to_its_equilibrium_ends_there():
    """Behind the Hopf point it would be followed a second time, as the mirror image of itself."""
    ds = continue_orbit(fold_of_cycles(), "mu", (-0.5, 0.5), begin=0.3, orbit=(1.1, 0.0), period=1)
    assert kinds(ds) == ["fold"] and sorted(ends(ds)[0]) == ["closed", "range"]
    assert "shrinks to an equilibrium" in ds.attrs["why"]
    np.testing.assert_allclose(found(ds, "fold")[0], [-0.25], rtol=1e-9)
    last = int(np.argmin(ds["peak_to_peak"].sel(quantity="x").values))
    assert last in (0, ds.sizes["point"] - 1) and abs(ds["mu"].values[last]) < 1e-6
    assert (ds["section"].values[:, 0, 0] > 0).all()


@pytest.mark.parametrize("F", [1e-1, 1e-3, 1e-6])
def test_a_small_vibration_whose_mean_moves_is_followed_as_fast_as_a_large_one(F):
    """x'' + x'/5 + x = mu + F cos 2t: a straight line, however small F is; its mean is mu."""
    mu, force = Parameter("mu", "1", "load"), Parameter("F", "1", "forcing")
    model = Model("loaded", (x, v), (mu, force), {x: v, v: mu + force * cos(2 * t) - v / 5 - x}, harmonics=(2,))
    ds = continue_orbit(System(model, {"mu": 0.0, "F": F}), "mu", (0.0, 1.0), points=200)
    assert ends(ds) == [["range", "range"]] and kinds(ds) == []
    np.testing.assert_allclose(ds["mean"].sel(quantity="x").values, ds["mu"].values, atol=1e-9)
    np.testing.assert_allclose(ds["peak_to_peak"].sel(quantity="x").values, 2 * F / abs(-3 + 0.4j), rtol=1e-5)


def test_damping_that_jumps_is_no_hopf_point():
    """x'' + c x' + x = F with c = 0.1 for x < 1, else -0.1: eigenvalues jump across the axis, and none lies on it."""
    F = Parameter("F", "1", "load")
    model = Model(
        "jumping_damping", (x, v), (F,), {x: v, v: F - x - when(x < 1, 0.1, -0.1) * v}, section=Section(v, "rising"),
        typical_time=6.28,
    )  # fmt: skip
    ds = continue_orbit(System(model, {"F": 0.5}), "F", (0.4, 1.6), begin=0.5, orbit=(0.5, 0.0))
    assert kinds(ds) == [] and "was not located" in str(ds.attrs)
