"""Steps where they are needed: at a stop that is reached late, before an end that is believed, along all of a return."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from whirlmap.analysis.motion.endings import restarted
from whirlmap.analysis.motion.ensembles import make_ensemble
from whirlmap.analysis.steady.returns import settle_and_record
from whirlmap.analysis.steady.settling import Settling
from whirlmap.equations import Model, Output, Parameter, State, cos, sin, sqrt, t, when
from whirlmap.integrate.accuracy import StepVerdict
from whirlmap.integrate.system import System
from whirlmap.results.regime import Regime
from whirlmap.results.status import Status
from whirlmap.sweep.points.label_points import label_points

x, v = State("x", "1", "x"), State("v", "1", "v")
y, w = State("y", "1", "y"), State("w", "1", "rate of y")
d, k, A, O = (Parameter(n, "1", n) for n in ("d", "k", "A", "O"))

#: x'' + d x' + x + k max(x - 1, 0) = A cos(O t): the wall is a hundred times as stiff as the spring, and not met at first.
STOP = Model(
    "stop", (x, v), (d, k, A, O), {x: v, v: A * cos(O * t) - d * v - x - k * when(x > 1, x - 1, 0)}, harmonics=(O,),
    swing=(x,),
)  # fmt: skip


def settled_by_scipy(O_, periods=200):
    """Largest and smallest x of the settled motion, piece by piece from wall to wall."""

    def rates(time, s, touching):
        return s[1], 0.8 * np.cos(O_ * time) - 0.1 * s[1] - s[0] - (100 * (s[0] - 1) if touching else 0)

    def wall(time, s, touching):
        return s[0] - 1

    wall.terminal = True
    period, time, s, touching, seen = 2 * np.pi / O_, 0.0, np.zeros(2), False, []
    while time < periods * period:
        wall.direction = -1 if touching else 1
        run = solve_ivp(rates, (time, periods * period), s, "DOP853", rtol=1e-11, atol=1e-13, events=wall, args=(touching,))
        keep = run.t > (periods - 4) * period
        seen.append(run.y[0][keep])
        time, s = run.t[-1], run.y[:, -1]
        if run.status == 1:
            touching = not touching
            s[0] = 1.0
            time, s = time, s
    return np.concatenate(seen)


@pytest.mark.parametrize("O_", [0.7, 1.2])
def test_a_stiff_stop_that_is_reached_after_some_periods(O_):
    """Chosen in the first period its steps end in "diverged" or "chaos"; it is periodic(1)."""
    system = System(STOP, {"d": 0.1, "k": 100.0, "A": 0.8, "O": O_})
    ds = label_points(system, {"O": [O_]}, lyapunov=1024)
    assert Regime(int(ds["regime"][0])) is Regime.periodic
    assert int(ds["period_T"][0]) == 1
    exact = settled_by_scipy(O_)
    got = ds["maximum"].sel(quantity="x").values[0]
    assert got == pytest.approx(exact.max(), abs=2e-3)


def rub():
    zeta, kc, mu, gap, e, W = (Parameter(n, "1", n) for n in ("zeta", "kc", "mu", "gap", "e", "W"))
    r = sqrt(x**2 + y**2)
    N = when(r > gap, kc * (1 - gap / sqrt(r**2 + 1e-12)), 0)
    model = Model(
        "rub", (x, y, v, w), (zeta, kc, mu, gap, e, W, O),
        {
            x: v, y: w, v: -2 * zeta * v - x - N * (x - mu * y) + e * O**2 * cos(O * t),
            w: -2 * zeta * w - y - N * (mu * x + y) + e * O**2 * sin(O * t) - W,
        },
        harmonics=(O,), outputs={"r": Output(r, "1", "radius")}, swing=(x, y),
    )  # fmt: skip
    values = {"zeta": 0.05, "kc": 25.0, "mu": 0.1, "gap": 1.0, "e": 0.3, "W": 0.1, "O": 0.9}
    return System(model, values)


def test_a_rotor_that_starts_to_rub_does_not_diverge():
    """Six steps per T do for the free rotor; at the stator they let it grow to 1e274. It stays below 1.064."""
    ensemble, _ = make_ensemble(rub())
    assert ensemble.point_steps[0] <= 8
    settle_and_record(ensemble, Settling(transient=30, most=8))
    assert ensemble.status[0] == Status.ok
    assert ensemble.point_steps[0] > 8
    seen = ensemble.advance(20, extremes=True).extremes
    assert seen["maximum"][4, 0] < 1.064


def test_a_blow_up_of_the_method_itself_is_no_divergence():
    """A wall 1e7 times as stiff as the spring: with any steps of the ladder up to 512 the method explodes there."""
    system = System(STOP, {"d": 0.1, "k": 1e7, "A": 0.8, "O": 0.7})
    ds = label_points(system, {"O": [0.7]}, lyapunov=0, settling=Settling(transient=10, most=4))
    assert Regime(int(ds["regime"][0])) is not Regime.diverged
    assert int(ds["step_verdict"][0]) != StepVerdict.met or int(ds["status"][0]) == Status.ok


def test_a_true_divergence_is_still_one():
    """x'' + x' / 10 + x - x^3 = A cos t escapes from its well."""
    model = Model("escape", (x, v), (A, O), {x: v, v: A * cos(O * t) - v / 10 - x + x**3}, harmonics=(O,), swing=(x,))
    system = System(model, {"A": 0.6, "O": 1.0})
    ds = label_points(system, {"A": [0.05, 0.6, 0.9]}, lyapunov=0)
    assert [Regime(r).label for r in ds["regime"].values] == ["periodic", "diverged", "diverged"]

    def far(time, s):
        return abs(s[0]) - 1e4

    far.terminal = True
    run = solve_ivp(
        lambda time, s: (s[1], 0.6 * np.cos(time) - s[1] / 10 - s[0] + s[0] ** 3), (0, 100), [0, 0], "DOP853", rtol=1e-11,
        events=far,
    )  # fmt: skip
    assert ds["end_time"].values[1] == pytest.approx(run.t[-1], abs=0.2)


def test_the_whole_return_is_checked():
    """A third subharmonic's fast pass comes in one of three periods: its error is met there as well."""
    system = System(STOP, {"d": 0.02, "k": 4.0, "A": 0.8, "O": 2.6})
    ds = label_points(system, {"O": np.linspace(2.4, 2.8, 9)}, lyapunov=0, settling=Settling(transient=300))
    regular = (ds["regime"].values == Regime.periodic) & (ds["step_verdict"].values == StepVerdict.met)
    assert (ds["step_error"].values[regular] <= 1e-6).all()


def test_a_label_claims_no_more_than_its_steps_allow():
    """Given a loose accuracy, a return is one to that accuracy, and said to be."""
    system = System(STOP, {"d": 0.1, "k": 2.0, "A": 0.8, "O": 0.7})
    ds = label_points(system, {"O": [0.7]}, lyapunov=0, accuracy=1e-3)
    assert int(ds["period_T"][0]) == 1
    assert ds["return_distance"].values[0] <= 1e-3


def test_growth_by_steps_that_are_too_long_is_not_believed():
    """Two masses that meet late: with the steps of the free motion contacts throw them to 1e24, whatever the size."""
    y2, w2 = State("y2", "1", "y2"), State("w2", "1", "rate of y2")
    push = k * when(x - y2 > 1, x - y2 - 1)
    gap = Model(
        "late_gap", (x, y2, v, w2), (A, d, k, O),
        {x: v, y2: w2, v: A * cos(O * t) - d * v - x - push, w2: 2 * (push - d * w2 - y2 / 2)}, harmonics=(O,), swing=(x,),
    )  # fmt: skip
    found = label_points(System(gap, {"A": 1.5, "d": 0.1, "k": 30.0, "O": 0.9}, start={"v": 0.1}), {"O": [0.9]}, lyapunov=0)
    assert found["period_T"].values.tolist() == [1]
    assert np.abs(found["minimum"].values[0, :2] - [-4.946187, -3.510363]).max() < 1e-4  # by event location


def test_runs_that_begin_again_forget_the_sides_of_their_end():
    system = System(STOP, {"A": 0.8, "d": 0.1, "k": 100.0, "O": 1.0})
    ensemble, _ = make_ensemble(system, {"O": [1.0]}, steps=32)
    start, began = ensemble.x.copy(), ensemble.turns.copy()
    fresh = ensemble.subset(np.arange(1)).advance(4, save_periods=1).saved
    ensemble.advance(37)
    again = restarted(ensemble, np.arange(1), start, began, ensemble.point_steps)
    np.testing.assert_array_equal(again.advance(4, save_periods=1).saved, fresh)
