"""Where branches begin: phases, sweeps in both directions, attractors that lie on one branch, and inputs that are none."""

import numpy as np
import pytest

import whirlmap
from whirlmap.analysis.branches.limits import Limits
from whirlmap.equations import Model, Parameter, Section, State, cos, t
from whirlmap.errors import RangeError
from whirlmap.integrate.system import System
from whirlmap.options.computed import LABELLING
from whirlmap.options.execution import EXECUTION
from whirlmap.sweep.branches.following import Branches
from whirlmap.sweep.branches.free_parameters import FreeParameters, Varied
from whirlmap.sweep.branches.seeds import Beginning

x, v = State("x", "1", "displacement"), State("v", "1", "its rate")
g, w = Parameter("g", "1", "forcing"), Parameter("w", "1", "frequency", above=0)
#: Its forcing repeats after 2 T: the state at T is another one than at 0.
TWO_TONES = Model(
    name="two_tones", states=(x, v), parameters=(g, w), harmonics=(w, w / 2),
    equations={x: v, v: g * (cos(w * t) + cos(w * t / 2)) - v / 2 - x - x**3 / 4},
)  # fmt: skip


def test_a_point_of_a_diagram_is_taken_at_phase_zero(monkeypatch):
    """Newton's method would come from the other phase as well; what it is given must be the orbit already."""
    system = System(TWO_TONES, {"g": 0.3, "w": 1.4})
    assert system.common_multiple == 2
    ds = whirlmap.bifurcation_diagram(system, "g", np.linspace(0.2, 0.4, 5), states=["x", "v"])
    given, orbits = [], Beginning.orbits
    monkeypatch.setattr(Beginning, "orbits", lambda self, guesses, n: given.extend(guesses) or orbits(self, guesses, n))
    branch = whirlmap.continue_orbit(system, "g", (0.2, 0.4), begin=0.3, seeds=ds)
    monkeypatch.undo()
    (guess,) = given
    at = int(np.abs(branch["g"].values - 0.3).argmin())
    exact = branch["section"].values[at]
    np.testing.assert_allclose(guess, exact[0], atol=1e-4)
    assert np.abs(exact[1] - exact[0]).max() > 0.1  # half a common period later it is another state
    assert branch["period_T"].values.tolist() == [2]


def test_both_sweeps_of_a_diagram_begin_branches_and_one_branch_is_kept_once():
    system = whirlmap.load("duffing", delta=0.05, alpha=1, beta=0.1, gamma=0.18)
    ds = whirlmap.bifurcation_diagram(system, "omega", [1.0, 1.1, 1.2, 1.25, 1.3], follow="both", states=["x", "v"])
    branch = whirlmap.continue_orbit(system, "omega", (0.9, 1.4), begin=1.2, seeds=ds)
    assert branch.sizes["branch"] == 1 and branch.sizes["event"] == 2  # both motions lie on it


def test_equilibria_that_lie_on_one_branch_are_one_branch():
    """The two places of rest of Lorenz' convection are joined through the pitchfork at rho = 1."""
    free = FreeParameters(whirlmap.load("lorenz"), (Varied.of(whirlmap.load("lorenz"), "rho", (0.5, 15.0)),))
    first = Beginning(free, (10.0,), LABELLING, EXECUTION, 1e-12)
    run = Branches(Limits(np.array([0.5]), np.array([15.0])), "both", 0)
    for _ in run.follow([*first.given((5, 5, 9), None), *first.given((-5, -5, 9), None)]):
        pass
    assert [branch.kind for branch in run.branches] == ["equilibrium"]


def test_a_range_that_is_none_is_named_as_it_was_given():
    system = whirlmap.load("duffing")
    with pytest.raises(RangeError, match=r"found gamma=a:b, expected gamma=START:STOP, two numbers"):
        whirlmap.continue_orbit(system, "gamma", "a:b")
    with pytest.raises(RangeError, match="a number that is not finite"):
        whirlmap.continue_orbit(system, "gamma", (0.2, 0.3), orbit=(1.0, float("nan")))


def test_an_orbit_that_is_asked_to_return_too_late_has_its_smallest_period():
    """The motion of 1 T returns after 2 T and 6 T as well; it is one branch of 1 T all the same."""
    system = whirlmap.load("duffing", delta=0.05, alpha=1, beta=0.1, gamma=0.18)
    exact = whirlmap.continue_orbit(system, "omega", (0.9, 0.95), points=2)["section"].values[0, 0]
    for period in (2, 6):
        branch = whirlmap.continue_orbit(system, "omega", (0.9, 0.95), orbit=exact, period=period, points=2)
        assert branch["period_T"].values.tolist() == [1]
        np.testing.assert_allclose(branch["section"].values[0, 0], exact, rtol=1e-9)
    system = whirlmap.load("duffing", gamma=0.28)
    doubled = whirlmap.continue_orbit(system, "gamma", (0.28, 0.281), points=2)
    exact = doubled["section"].values[0, 0]
    again = whirlmap.continue_orbit(system, "gamma", (0.28, 0.281), orbit=exact, period=4, points=2)
    assert doubled["period_T"].values.tolist() == again["period_T"].values.tolist() == [2]


def test_a_cycle_that_is_asked_to_cross_too_often_has_its_smallest_number_of_crossings():
    free = Model(
        name="free", states=(x, v), parameters=(g,), equations={x: v, v: g * (1 - x**2) * v - x},
        section=Section(x, "rising"), typical_time=1,
    )  # fmt: skip
    branch = whirlmap.continue_orbit(System(free, {"g": 1.0}), "g", (1.0, 1.1), orbit=(0.0, 2.0), period=3, points=2)
    assert branch["period_T"].values.tolist() == [1]
    assert abs(branch["duration"].values[0] - 6.6632868593) < 1e-8  # the period at mu = 1


@pytest.mark.slow
def test_a_machine_whose_films_are_fast_is_followed_with_steps_that_hold():
    """With 32 to 192 steps per T its films are not stable: such orbits closed on nothing, or had a false period doubling."""
    system = whirlmap.load("machines/flexible-on-dampers")
    ds = whirlmap.continue_orbit(system, "speed", ("9900 rpm", "10200 rpm"), begin="10000 rpm", longest=0.2)
    assert not ds.sizes["event"] and "the end of the range | the end of the range" in ds.attrs["why"]
    assert ds["stable"].values.all() and (ds["steps"].values > 192).all() and ds["step_error"].values.max() < 1e-10
    diagram = whirlmap.bifurcation_diagram(system, "speed", ["9900 rpm", "10200 rpm"])
    assert (diagram["period_T"].values == 1).all()
    here = ds["peak_to_peak"].values[[0, -1]]
    np.testing.assert_allclose(here, diagram["peak_to_peak"].values, rtol=1e-4, atol=1e-6)
