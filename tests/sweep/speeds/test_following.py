"""Run-up and run-down: which coexisting motions they meet, where windows beside these end, and what tells motions apart."""

import numpy as np
import pytest
import xarray as xr
from scipy.integrate import solve_ivp

from whirlmap.equations import Model, Parameter, State, cos, t
from whirlmap.integrate.system import System
from whirlmap.results.regime import Regime
from whirlmap.sweep.diagrams.diagram import bifurcation_diagram
from whirlmap.sweep.speeds.arriving import arriving
from whirlmap.sweep.speeds.designs import judge_machines, safe_probability
from whirlmap.sweep.speeds.improve import improve
from whirlmap.sweep.speeds.run_up_and_down import joined, motions_met, unseen
from whirlmap.sweep.speeds.safe_speeds import safe_speeds
from whirlmap.sweep.speeds.verdicts import Judge, Verdict, verdicts
from whirlmap.sweep.speeds.windows import PARTS, ROUNDS


def hardening(d=0.1):
    """x'' + d x' + x + 0.5 x^3 = 0.3 cos(s t), from rest: between two folds a large and a small motion coexist."""
    x, v = State("x", "1", "displacement"), State("v", "1", "velocity")
    s, damping = Parameter("s", "1", "speed", above=0), Parameter("d", "1", "damping", above=0)
    rates = {x: v, v: 0.3 * cos(s * t) - damping * v - x - x**3 / 2}
    model = Model("hardening", (x, v), (s, damping), rates, harmonics=(s,), clocks={"shaft": s}, swing=(x,), speed=s)
    return System(model, {"s": 1.0, "d": d})


@pytest.fixture(scope="module")
def system():
    return hardening()


def test_runs_up_and_down_find_coexisting_motions(system):
    """Behind the peak of the large motion a cold start and the run down are small; the run up is not."""
    at = np.linspace(1.0, 2.2, 13)
    cold, followed = (safe_speeds(system, at, 1.5, follow=f) for f in (False, True))
    safe = cold["verdict"].values == Verdict.safe
    coexisting = followed["verdict"].values == Verdict.coexisting
    assert 1 <= coexisting.sum() < safe.sum()  # some of the safe speeds, and the fastest ones are safe in any case
    assert safe[coexisting].all() and followed["verdict"].values[-1] == Verdict.safe
    np.testing.assert_array_equal(followed["verdict"].values[~safe], cold["verdict"].values[~safe])
    np.testing.assert_array_equal(followed["motions"].values >= 1 + coexisting, True)
    assert [Verdict(v).name for v in np.unique(followed["other"].values[coexisting])] == ["amplitude"]
    assert carried_up(at[: np.flatnonzero(coexisting)[0] + 1]) > 1.5 > cold["amplitude"].values[coexisting].max()


def carried_up(speeds, last=100):
    """Peak to peak at the last of these speeds, after so many T there, by SciPy, the state carried along at phase zero."""
    state = [0.0, 0.0]
    for s in speeds:
        def rates(t, y, s=s):
            return [y[1], 0.3 * np.cos(s * t) - y[1] / 10 - y[0] - y[0] ** 3 / 2]

        period = 2 * np.pi / s
        turns = last if s == speeds[-1] else 100
        state = solve_ivp(rates, (0, turns * period), state, "DOP853", rtol=1e-9, atol=1e-9).y[:, -1]
    turn = solve_ivp(rates, (0, period), state, "DOP853", rtol=1e-9, atol=1e-9, t_eval=np.linspace(0, period, 400)).y[0]
    return np.ptp(turn)


def test_a_run_up_and_a_run_down_point_by_point_meet_nothing_else(system):
    """Every motion of the two chains is among those that were met side by side."""
    at = np.linspace(1.0, 2.2, 25)
    met = motions_met(Judge(system), {"s": at}, np.full(at.size, 1.5), at.size)
    both = bifurcation_diagram(system, "s", at, follow="both")
    for way in ("up", "down"):
        swings = both["peak_to_peak"].sel(direction=way, quantity="x").values
        for k, swing in enumerate(swings):
            known = met["amplitude"].values[met["place"].values == k]
            assert np.abs(known / swing - 1).min() < 0.01, (way, at[k])
    up = verdicts(both["regime"].sel(direction="up"), both["peak_to_peak"].sel(direction="up", quantity="x"), 1.5)
    followed, cold = (safe_speeds(system, at, 1.5, follow=f)["verdict"].values for f in (True, False))
    assert (up == Verdict.amplitude).sum() > (cold == Verdict.amplitude).sum()
    assert (followed[up == Verdict.amplitude] != Verdict.safe).all()


def test_a_window_ends_where_the_large_motion_does(system):
    """The last speed at which the large motion lives, by SciPy in small steps up; cold starts alone see the window begin
    earlier. So close behind the fold the motion leaves slowly."""
    at = np.linspace(1.0, 2.2, 13)
    starts = [float(safe_speeds(system, at, 1.5, follow=f)["window_start"][-1]) for f in (False, True)]
    spacing = (at[1] - at[0]) / (PARTS + 1) ** ROUNDS
    large = carried_up([*np.arange(1.0, starts[1] - 4 * spacing, 0.05), starts[1] - 4 * spacing])
    gone = carried_up([*np.arange(1.0, starts[1] + 2 * spacing, 0.05), starts[1] + 2 * spacing], last=2000)
    assert large > 1.5 > gone and starts[0] < starts[1] - 10 * spacing


def test_drawn_machines_run_up_and_down_too(system):
    at = np.linspace(1.0, 2.2, 13)
    alone = safe_speeds(system, at, 1.5)["verdict"].values
    both = judge_machines(system, [system, system], at, [1.5, 1e9], follow=True)["verdict"].values
    np.testing.assert_array_equal(both[0], alone)
    assert (both[1] == Verdict.safe).all()
    chance = safe_probability(system, [system], at, [1.5])
    np.testing.assert_array_equal(chance["probability_of"].sel(why="coexisting").values, alone == Verdict.coexisting)


def motions(place, regime, status, low, high, end=None):
    over = ("point", "quantity")
    n = len(place)
    return xr.Dataset({
        "place": ("point", place), "regime": ("point", regime), "status": ("point", status),
        "minimum": (over, np.transpose([low, low])), "maximum": (over, np.transpose([high, high])),
        "end_state": (("point", "state"), np.zeros((n, 2)) if end is None else end),
        "steps": ("point", np.full(n, 32)), "period_common": ("point", np.ones(n, dtype=np.int64)),
    })  # fmt: skip


def test_motions_are_told_apart_at_each_place(system):
    """Periodic ones by their extremes, to 1 %; all that do not return are one, and so are all that end the same way."""
    met = motions([0, 1], [Regime.periodic, Regime.chaotic], [0, 0], [-1.0, -1.0], [1.0, 1.0])
    found = motions(
        [0, 0, 0, 1, 1, 1, 1],
        [Regime.periodic] * 3 + [Regime.quasi_periodic, Regime.periodic, Regime.contact, Regime.contact],
        [0, 0, 0, 0, 0, 1, 1],
        [-1.001, -2.0, -2.001, -3.0, -1.0, np.nan, np.nan], [1.001, 2.0, 2.001, 3.0, 1.0, np.nan, np.nan],
    )  # fmt: skip
    speeds = {"s": np.array([1.0, 1.2])}
    assert unseen(Judge(system), speeds, found, met).tolist() == [1, 4, 5]
    assert unseen(Judge(system), speeds, found).tolist() == [0, 1, 3, 4, 5]


def test_orbits_with_equal_extremes_are_told_apart():
    """x'' + 0.3 x' - x + x^3 = 0.2 cos(s t): the orbit in the one well is the other's mirror, half a period later."""
    x, v, s = State("x", "1", "displacement"), State("v", "1", "velocity"), Parameter("s", "1", "speed", above=0)
    rates = {x: v, v: cos(s * t) / 5 - 3 * v / 10 + x - x**3}
    wells = System(Model("wells", (x, v), (s,), rates, harmonics=(s,), swing=(x,)), {"s": 1.2})
    judge, at = Judge(wells), {"s": np.full(3, 1.2)}
    found = judge(at, np.ones(3), starts=np.array([[1.0, 1.1, -1.0], [0.0, 0.1, 0.0]]))
    found = found.assign_coords(place=("point", np.zeros(3, dtype=np.int64)))
    for name, k in (("minimum", -1), ("maximum", 1)):
        found[name] = found[name] * 0 + k  # as though the extremes said nothing
    assert unseen(judge, {"s": np.array([1.2])}, found).tolist() == [0, 2]


def test_a_motion_that_has_not_settled_is_the_one_into_which_it_flows(system):
    """At s = 1.4 a small and a large motion coexist. What is left of the approach to one is none of its own."""
    judge, at = Judge(system), {"s": np.array([1.4])}
    whole = motions_met(Judge(system), {"s": np.array([1.2, 1.3, 1.4])}, np.ones(3), 3)
    both = whole.isel(point=np.flatnonzero(whole["place"].values == 2))
    assert both.sizes["point"] == 2 and (both["regime"] == Regime.periodic).all()
    unsettled = both.isel(point=[0, 1]).copy(deep=True)
    unsettled["regime"][:] = Regime.quasi_periodic
    unsettled["end_state"] = unsettled["end_state"] * 1.05
    small = joined(both.isel(point=[0]), unsettled).assign_coords(place=("point", np.zeros(3, dtype=np.int64)))
    assert arriving(judge, at, small, np.ones(3, dtype=bool)).tolist() == [False, True, False]
    assert not arriving(judge, at, small, np.zeros(3, dtype=bool)).any()  # compared before
    all_four = joined(both, unsettled).assign_coords(place=("point", np.zeros(4, dtype=np.int64)))
    assert arriving(judge, at, all_four, np.ones(4, dtype=bool)).tolist() == [False, False, True, True]
    elsewhere = all_four.assign_coords(place=("point", np.array([0, 0, 1, 1])))
    speeds = {"s": np.array([1.4, 1.4])}
    assert not arriving(judge, speeds, elsewhere, np.ones(4, dtype=bool)).any()


def test_the_best_designs_run_up_and_down():
    """From cold starts the second design has the widest window. Run up and down it loses to the first, until that is too."""
    at, designs = np.linspace(1.0, 2.2, 13), {"d": [0.05, 0.1]}
    cold, both = (improve(hardening, designs, at, 1.5, refine=False, follow=f) for f in (False, True))
    wide = cold["window_width"].values
    assert cold["followed"].values.tolist() == [0, 0] and cold.attrs["widest"] == 1
    assert both["followed"].values.tolist() == [1, 1] and both.attrs["widest"] == 1
    assert float(both["window_width"][1]) < wide[0] < wide[1]
    whole = judge_machines(hardening(), [hardening(0.05), hardening(0.1)], at, [1.5, 1.5], follow=True)
    np.testing.assert_array_equal(both["verdict"].values, whole["verdict"].values)
    alone = improve(hardening, {"d": [0.05, 0.6]}, at, 1.5, refine=False)
    assert alone["followed"].values.tolist() == [0, 1]
