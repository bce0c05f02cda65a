"""Steps are checked beyond the start: a motion that wakes up, and asks for more of them, neither ends nor parts from it."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import whirlmap
from whirlmap.analysis.motion.endings import confirm_run
from whirlmap.analysis.simulation import time_series
from whirlmap.equations import Model, Parameter, State, Stop, cos, t
from whirlmap.integrate.system import System
from whirlmap.results.status import Status
from whirlmap.sweep.diagrams.runs_in_parts import simulation_in_stretches

x, v = State("x", "1", "x"), State("v", "1", "v")
A, d, k, w = (Parameter(n, "1", n) for n in ("A", "d", "k", "w"))
#: From rest it is slow and small; it wakes up to a cycle of |x| = 1.9, which is as many times faster as its spring is stiff.
WAKES = Model(
    "wakes", (x, v), (A, d, k, w), {x: v, v: A * cos(w * t) + d * v * (1 - x**2) - x - k * x**3}, harmonics=(w,), swing=(x,)
)


def waking(stiffness):
    return System(WAKES, {"A": 1e-3, "d": 0.5, "k": stiffness, "w": 0.3}, start={"x": 1e-3, "v": 0.0})


def exact(stiffness, times):
    def rates(time, z):
        return [z[1], 1e-3 * np.cos(0.3 * time) + 0.5 * z[1] * (1 - z[0] ** 2) - z[0] - stiffness * z[0] ** 3]

    made = solve_ivp(rates, (0, times[-1]), [1e-3, 0.0], "DOP853", rtol=1e-12, atol=1e-14, dense_output=True)
    return made.sol(times)[0]


@pytest.mark.parametrize("transient", [0, 6])
def test_a_series_takes_more_steps_where_the_motion_asks_for_them(transient):
    """With the steps of its start it "diverges" after three periods."""
    ds = whirlmap.simulate(waking(30.0), periods=12 - transient, transient=transient)
    assert Status(int(ds["status"])) is Status.ok
    assert ds.attrs["steps_per_period"] > 200  # it was needed
    assert ds.sizes["time"] == 100 * (12 - transient) + 1  # and the samples stand where they stood
    truth = exact(30.0, ds["time"].values)
    assert np.ptp(truth) > 3.5  # it has woken up
    np.testing.assert_allclose(ds["x"].sel(state="x"), truth, rtol=0, atol=1e-4)


def test_stretches_change_no_number():
    whole = whirlmap.simulate(waking(30.0), periods=12)
    np.testing.assert_array_equal(simulation_in_stretches(waking(30.0), periods=12).whole()["x"], whole["x"])


def test_what_no_steps_of_the_ladder_follow_is_said():
    ds = whirlmap.simulate(waking(500.0), periods=12)
    assert "too stiff" in ds.attrs["accuracy_not_met"]


@pytest.mark.parametrize("transient", [0, 3])
def test_a_section_goes_on_with_more_steps(transient):
    ds = whirlmap.section(waking(30.0), points=20, transient=transient)
    assert (ds["status"] == Status.ok).all()
    assert np.isfinite(ds["section"]).all()


def test_an_end_is_confirmed_once(monkeypatch):
    """However long the record would have been: SciPy's time of the contact, found by two runs."""
    wall = Model(
        "touches", (x, v), (A, d, w), {x: v, v: A * cos(w * t) + d * v - x}, harmonics=(w,), swing=(x,),
        stops={"contact": Stop(1 - x**2, "the wall is touched")},
    )  # fmt: skip
    asked = []
    monkeypatch.setattr(time_series, "confirm_run", lambda *run: asked.append(run) or confirm_run(*run))
    ds = whirlmap.simulate(System(wall, {"A": 0.1, "d": 0.1, "w": 1.3}), periods=20_000)

    def touch(time, z):
        return 1 - z[0] ** 2

    touch.terminal = True
    made = solve_ivp(
        lambda time, z: [z[1], 0.1 * np.cos(1.3 * time) + 0.1 * z[1] - z[0]], (0, 100), [0.0, 0.0], "DOP853", rtol=1e-12,
        atol=1e-14, events=touch,
    )  # fmt: skip
    assert Status(int(ds["status"])) is Status.contact
    assert float(ds["end_time"]) == pytest.approx(made.t[-1], rel=1e-9)
    assert len(asked) == 1
