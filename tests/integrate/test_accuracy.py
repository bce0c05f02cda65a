"""The steps that a point chooses for itself: they meet the accuracy, and depend on nothing but the point."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from whirlmap.analysis.motion.ensembles import make_ensemble
from whirlmap.errors import RangeError
from whirlmap.integrate.accuracy import LADDER, StepVerdict, choose_steps
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.integrate.loading import load
from whirlmap.integrate.system import System
from whirlmap.kernels.methods import DOP853, METHODS
from whirlmap.models import family
from whirlmap.results.status import Status

DUFFING = {"delta": 0.2, "alpha": -1, "beta": 1, "gamma": 0.3, "omega": 1.2}


def duffing(count=1, **changes):
    system = System(family("duffing").model(), DUFFING)
    values = np.repeat(system.vector[:, None], count, axis=1)
    for name, column in changes.items():
        values[system.parameters.index(name)] = column
    return Ensemble(system.model, values, np.full((2, count), 0.4), orders=system.orders, steps=6, method=DOP853)


@pytest.mark.parametrize("accuracy", [1e-4, 1e-6, 1e-9])
def test_chosen_steps_meet_the_accuracy_of_an_independent_integrator(accuracy):
    """SciPy's DOP853 on the reference kernel; the gear pair settled first, so that its orbits are large."""
    system = load("gear-psfd/reference").replace(psi=0.0)
    speeds = np.array([1.0, 2.0, 3.5])
    start, _ = make_ensemble(system, {"s": speeds}, accuracy=1e-8)
    start.advance(10 * start.common_multiple)
    assert np.all(np.hypot(*start.x[:2]) > 0.05)  # away from the centre, where the fixed arc is not smooth
    e, _ = make_ensemble(system, {"s": speeds}, starts=start.x, accuracy=accuracy)
    assert np.all(e.step_verdict == StepVerdict.met)
    assert np.all(e.step_error <= accuracy)
    e.advance(e.common_multiple)
    for i, s in enumerate(speeds):
        point = system.replace(s=s)
        exact = solve_ivp(
            lambda t, x, point=point: point.reference_rhs(t, x), (0, point.common_period), start.x[:, i], "DOP853",
            rtol=1e-12, atol=1e-13,
        ).y[:, -1]  # fmt: skip
        assert np.abs(e.x[:, i] - exact).max() < 1.2 * accuracy


def test_a_point_takes_the_lowest_rung_that_is_good_enough():
    e = duffing()
    rungs = choose_steps(e, 1e-7)
    at = LADDER.index(int(rungs.steps[0]))

    def run(steps):
        part = duffing()
        part = part.subset(np.array([0]), steps=steps)
        return part, part.advance(1, extremes=True).extremes

    def error(k):
        """Of position and velocity as one motion: x' = v, so that v T/2 pi counts beside x."""
        (rough, _), (fine, seen) = run(LADDER[k]), run(LADDER[k + 1])
        least, most = (side(seen[name][:2, 0], 0.4) for side, name in ((np.minimum, "minimum"), (np.maximum, "maximum")))
        unit = np.array([1.0, DUFFING["omega"]])
        return (np.abs(rough.x - fine.x)[:, 0] / unit / ((most - least) / unit).max()).max()

    assert error(at) <= 1e-7 < error(at - 1)
    assert rungs.error[0] == pytest.approx(error(at), rel=1e-9)


def test_a_tighter_accuracy_never_takes_fewer_steps():
    e = duffing(40, gamma=np.linspace(0.1, 0.9, 40))
    counts = [choose_steps(e, accuracy).steps for accuracy in (1e-3, 1e-5, 1e-7, 1e-9)]
    assert np.all(np.diff(counts, axis=0) >= 0)
    assert np.all(counts[-1] > counts[0])


def test_steps_of_a_point_do_not_depend_on_its_company():
    gamma = np.linspace(0.1, 0.9, 70)
    together = choose_steps(duffing(70, gamma=gamma), 1e-8)
    assert np.unique(together.steps).size > 1
    shuffled = np.random.default_rng(3).permutation(70)
    again = choose_steps(duffing(70, gamma=gamma[shuffled]), 1e-8)
    np.testing.assert_array_equal(again.steps, together.steps[shuffled])
    np.testing.assert_array_equal(again.error, together.error[shuffled])
    for i in (0, 33, 69):
        alone = choose_steps(duffing(1, gamma=gamma[i]), 1e-8)
        assert alone.steps[0] == together.steps[i]
        assert alone.error[0] == together.error[i]


def test_points_of_different_steps_run_as_if_alone():
    gamma = np.linspace(0.1, 0.9, 70)
    steps = choose_steps(duffing(70, gamma=gamma), 1e-8).steps
    whole = duffing(70, gamma=gamma).subset(np.arange(70), steps=steps)
    saved = whole.advance(20, save_periods=1).saved
    for i in (0, 40, 69):
        alone = duffing(1, gamma=gamma[i]).subset(np.array([0]), steps=int(steps[i]))
        np.testing.assert_array_equal(alone.advance(20, save_periods=1).saved[..., 0], saved[..., i])


def test_members_run_as_if_all_ran():
    """Packing some of the points into other blocks changes no bit; the others stand still."""
    gamma = np.linspace(0.1, 0.9, 70)
    whole, part = duffing(70, gamma=gamma), duffing(70, gamma=gamma)
    members = np.array([3, 68, 41, 5])
    begin = part.x.copy()
    expected = whole.advance(6, save_periods=2, extremes=True)
    got = part.advance(6, members=members, save_periods=2, extremes=True)
    np.testing.assert_array_equal(got.saved, expected.saved[..., members])
    np.testing.assert_array_equal(got.extremes["rms"], expected.extremes["rms"][:, members])
    rest = np.setdiff1d(np.arange(70), members)
    np.testing.assert_array_equal(part.x[:, rest], begin[:, rest])
    assert np.all(part.turns[rest] == 0)


def test_an_oscillator_too_fast_for_the_ladder_is_stiff():
    e = duffing(2, alpha=np.array([-1.0, 1e9]))
    rungs = choose_steps(e, 1e-8)
    assert list(rungs.verdict) == [StepVerdict.met, StepVerdict.stiff]
    assert rungs.steps[1] == LADDER[-1]
    assert "stiff" in StepVerdict.stiff.advice(e.model)


def test_only_a_model_with_a_fixed_arc_is_told_about_arcs():
    assert "arc" not in StepVerdict.nonsmooth.advice(load("gear_backlash").model)
    assert "arc" not in StepVerdict.nonsmooth.advice(load("jeffcott", rotor="flexible", arc="positive").model)
    assert "arc of positive pressure" in StepVerdict.nonsmooth.advice(load("jeffcott").model)


def test_orbits_through_the_centre_are_nonsmooth_with_the_fixed_arc():
    """The fixed half film has a kink at the bearing's centre; the arc of positive pressure has none. 96 starts close by."""
    chosen = {}
    for arc in ("fixed", "positive"):
        system = load("gear-psfd/reference", arc=arc).replace(psi=0.0)
        rng = np.random.default_rng(1)
        speeds = {"s": np.full(96, 2.5)}
        x = make_ensemble(system, speeds, steps=16)[0].x.copy()
        x[:4] = rng.uniform(-0.02, 0.02, (4, 96))
        x[4:8] += rng.uniform(-0.3, 0.3, (4, 96))
        chosen[arc], _ = make_ensemble(system, speeds, starts=x, accuracy=1e-9)
    fixed, positive = chosen["fixed"], chosen["positive"]
    rough = fixed.step_verdict == StepVerdict.nonsmooth
    assert 3 < rough.sum() < 48
    assert not (fixed.step_verdict == StepVerdict.stiff).any()
    assert np.all(fixed.step_error[rough] > 1e-9)
    assert np.all(positive.step_verdict == StepVerdict.met)
    assert fixed.point_steps.max() > 3 * positive.point_steps.max()


def test_contact_in_the_first_period_needs_no_endless_ladder():
    system = load("gear-psfd/literal")
    e, _ = make_ensemble(system, {"s": np.array([1.0, 2.0, 3.0])}, accuracy=1e-6)
    e.advance(e.common_multiple * 20)
    assert np.all(e.status != Status.ok)


def test_steps_and_accuracy_exclude_each_other():
    system = load("gear-psfd/reference")
    with pytest.raises(RangeError, match="not both"):
        make_ensemble(system, steps=50, accuracy=1e-6)


def test_every_method_climbs_the_ladder():
    """A lower order needs more steps for the same accuracy."""
    system = load("gear-psfd/reference").replace(psi=0.0, s=3.0)
    counts = {name: make_ensemble(system, method=name, accuracy=1e-5)[0].steps for name in METHODS}
    assert counts["dop853"] < counts["tsit5"] < counts["rk4"]
