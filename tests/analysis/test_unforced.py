"""Unforced models: steps by accuracy, typical times that are wrong, stiff cycles, crossings as exact as the steps."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import whirlmap
from whirlmap.analysis.diagnosis.diagnosis import diagnose
from whirlmap.analysis.diagnosis.diagnosis_json import verdict_json
from whirlmap.analysis.motion.ensembles import make_ensemble
from whirlmap.analysis.motion.section_crossing import crossings
from whirlmap.equations import Model, Parameter, Section, State
from whirlmap.integrate.accuracy import StepVerdict
from whirlmap.integrate.system import System
from whirlmap.kernels.methods import DOP853, RK4
from whirlmap.results.regime import Regime
from whirlmap.sweep.points.label_points import label_points

x, v = State("x", "1", "x", start=2.0), State("v", "1", "v")
mu = Parameter("mu", "1", "mu")
#: Periods of van der Pol's oscillator, by SciPy's DOP853 at 1e-13 with event location.
PERIOD = {1.0: 6.6632868593231, 10.0: 19.0783695696}


def van_der_pol(stiffness, time):
    model = Model(
        "vdp", (x, v), (mu,), {x: v, v: mu * (1 - x**2) * v - x}, section=Section(x, "rising"), typical_time=time, swing=(x,)
    )
    return System(model, {"mu": stiffness})


@pytest.mark.parametrize("time", [6.28, 6.28e3, 6.28e-3])
def test_a_typical_time_may_be_wrong_by_a_thousand(time):
    for stiffness in (1.0, 10.0):
        system = van_der_pol(stiffness, time)
        ds = label_points(system, {"mu": [stiffness]}, lyapunov=0)
        assert Regime(int(ds["regime"][0])) is Regime.periodic
        assert int(ds["period_T"][0]) == 1
        assert int(ds["step_verdict"][0]) == StepVerdict.met
        assert ds["step_error"].values[0] <= 1e-9
        assert ds["maximum"].sel(quantity="x").values[0] == pytest.approx({1.0: 2.00862, 10.0: 2.01429}[stiffness], abs=2e-3)


def test_the_period_of_a_stiff_cycle():
    found = diagnose(van_der_pol(10.0, 6.28), max_periods=64)
    verdict = verdict_json(found)
    assert (verdict["regime"], verdict["period"]) == ("periodic", 1)
    assert found.attrs["period_T_time"] == pytest.approx(PERIOD[10.0], rel=1e-9)
    floquet = verdict["indicators"]["floquet"]
    assert floquet["trivial_error"] < 1e-6 and floquet["closure"] < 1e-6


def test_what_is_too_stiff_is_said():
    found = diagnose(van_der_pol(1000.0, 1614.4), max_periods=16)
    verdict = verdict_json(found)
    assert verdict["regime"] in ("undecided", "periodic")
    assert verdict["regime"] == "periodic" or "stiff" in found.attrs["accuracy_not_met"]


def test_multipliers_count_only_where_the_orbit_closes():
    """A damped oscillator at rest has no time direction: whatever its multipliers are, they are not those of a cycle."""
    c, place = Parameter("c", "1", "c"), Parameter("x0", "1", "x0")
    model = Model(
        "damped", (x, v), (c, place), {x: v, v: -c * v - (x - place)}, section=Section(v, "falling"), typical_time=6.28,
        swing=(x,),
    )  # fmt: skip
    system = System(model, {"c": 0.1, "x0": 1000.0}, {"x": 2000.0})
    verdict = verdict_json(diagnose(system, max_periods=64))
    assert verdict["indicators"].get("floquet", {"vote": "none"})["vote"] == "none"
    assert verdict["regime"] == "at-rest"


def test_an_accuracy_is_taken_for_unforced_models():
    lorenz = whirlmap.load("lorenz")
    counts = [make_ensemble(lorenz, accuracy=a)[0].steps for a in (1e-4, 1e-7, 1e-10)]
    assert counts[0] < counts[1] < counts[2]


@pytest.mark.parametrize(("method", "steps", "error"), [(DOP853, 24, 1e-7), (DOP853, 96, 2e-12), (RK4, 400, 1e-7)])
def test_crossings_are_as_exact_as_the_steps(method, steps, error):
    """The errors are those of the steps, which add up; a cubic between steps of T/24 is wrong by 1e-4."""
    system = van_der_pol(1.0, PERIOD[1.0])
    e, _ = make_ensemble(system, steps=steps, method=method.name)
    start = e.x.copy()
    states = np.concatenate([start[None], e.advance(3, save_every=1).saved])
    points, times = crossings(system.model, e.values, states, e.period / steps, method)

    def up(time, s):
        return s[0]

    up.direction = 1
    run = solve_ivp(
        lambda time, s: (s[1], (1 - s[0] ** 2) * s[1] - s[0]), (0, 3 * PERIOD[1.0]), start[:, 0], "DOP853", rtol=1e-13,
        atol=1e-14, events=up,
    )  # fmt: skip
    np.testing.assert_allclose(times[:, 0], run.t_events[0], rtol=0, atol=10 * error)
    np.testing.assert_allclose(points[:, 1, 0], run.y_events[0][:, 1], rtol=0, atol=30 * error)
    assert np.abs(points[:, 0, 0]).max() < 1e-13


def test_crossings_do_not_depend_on_company():
    lorenz = whirlmap.load("lorenz")
    rho = np.linspace(20, 40, 11)
    together = label_points(lorenz, {"rho": rho}, lyapunov=256)
    alone = label_points(lorenz, {"rho": rho[[3, 8]]}, lyapunov=256)
    for name in ("regime", "period_T", "lyapunov", "maximum", "steps"):
        np.testing.assert_array_equal(alone[name].values, together[name].values[[3, 8]])


def test_roessler_cycle_with_a_wrong_clock():
    """The one-loop cycle at c = 2.5, whose loops take 5.7489."""
    system = whirlmap.load("roessler", c=2.5)
    for factor in (1, 300):
        wrong = System(replace(system.model, typical_time=5.9 * factor), system.values)
        ds = label_points(wrong, {"c": [2.5]}, lyapunov=0)
        assert int(ds["period_T"][0]) == 1


@pytest.mark.parametrize(("threshold", "period"), [(2.81, 1), (3.805, 2), (4.1, 4)])
def test_an_approach_that_alternates_is_no_longer_cycle(threshold, period):
    """Multipliers of -0.985, -0.946 and -0.822, by SciPy's DOP853 at 1e-12 and Newton's method on the return map."""
    ds = label_points(whirlmap.load("roessler"), {"c": [threshold]}, lyapunov=0)
    assert (Regime(int(ds["regime"][0])), int(ds["period_T"][0])) == (Regime.periodic, period)


def test_means_of_a_cycle_are_those_of_whole_turns():
    """The cycle is symmetric; its typical time is no part of a turn."""
    ds = label_points(van_der_pol(1.0, 6.28), {"mu": [1.0, 3.0]}, lyapunov=0)
    assert (np.abs(ds["mean"].values[:, :2]) <= 1e-9 * ds["peak_to_peak"].values[:, :2]).all()
