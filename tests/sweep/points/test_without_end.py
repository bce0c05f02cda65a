"""Rest, drift and growth, with their rates, against closed forms; and poles, against event location in SciPy."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from sympy import Abs, Piecewise, sin, sqrt, tan

from whirlmap.analysis.diagnosis.diagnosis import diagnose
from whirlmap.analysis.diagnosis.diagnosis_json import verdict_json
from whirlmap.equations import Model, Parameter, Section, State, cos, t
from whirlmap.integrate.system import System
from whirlmap.kernels.lowering.poles import poles
from whirlmap.results.regime import Regime
from whirlmap.results.status import Status
from whirlmap.sweep.points.label_points import label_points

x, v = State("x", "1", "x", start=1.0), State("v", "1", "v")
a, b, c, e, k, w = (Parameter(n, "1", n) for n in "abcekw")
LINEAR = Model(
    name="linear", states=(x, v), parameters=(c, e, w), harmonics=(w,), swing=(x,),
    equations={x: v, v: -x - c * v + e * cos(w * t)},
)  # fmt: skip


def labelled(model, vary, values=None, **options):
    system = System(model, {p.name: 1.0 for p in model.parameters} | (values or {}))
    ds = label_points(system, {n: np.asarray(q, dtype=float) for n, q in vary.items()}, **{"lyapunov": 1024, **options})
    return ds, [Regime(int(r)).label for r in ds["regime"].values]


@cache
def mathieu(length=1.0, time=1.0):
    q, p, o = State("x", "m", "x", start=length), State("v", "m/s", "v"), Parameter("O", "1/s", "O", above=0)
    return Model(
        name="mathieu", states=(q, p), parameters=(a, o), harmonics=(o,), swing=(q,),
        equations={q: p, p: -0.2 / time * p - (1 - 2 * a * cos(o * t)) * q / time**2},
    )  # fmt: skip


def mathieu_rate(q):
    """Floquet exponent of x'' + 0.2 x' + (1 - 2 q cos 2t) x = 0."""
    one = [
        solve_ivp(lambda t, y: [y[1], -0.2 * y[1] - (1 - 2 * q * np.cos(2 * t)) * y[0]], (0, np.pi), start,
                  method="DOP853", rtol=1e-12, atol=1e-14).y[:, -1]
        for start in ((1, 0), (0, 1))
    ]  # fmt: skip
    return np.log(np.abs(np.linalg.eigvals(np.array(one).T)).max()) / np.pi


@pytest.mark.parametrize(("length", "time"), [(1.0, 1.0), (1e-9, 1.0), (1e3, 1.0)])
def test_parametric_motion_dies_away_or_grows_from_its_threshold_on(length, time):
    q = [0.0, 0.1, 0.2, 0.2004, 0.2005, 0.201, 0.21]  # the threshold is 0.200437
    ds, labels = labelled(mathieu(length, time), {"a": q}, {"O": 2 / time})
    assert labels == 4 * ["at-rest"] + 3 * ["growing"]
    assert ds["growth_rate"].values == pytest.approx([mathieu_rate(one) for one in q], rel=1e-4, abs=5e-8)
    assert (ds["period_T"].values == 0).all() and (ds["confidence"].values == 1).all()


def test_fast_growth_reaches_the_bound_and_is_growth_still():
    ds, labels = labelled(mathieu(), {"a": [0.25, 0.3, 0.4]}, {"O": 2.0})
    assert labels == 3 * ["growing"] and ds["status"].values[-1] == Status.diverged
    assert ds["growth_rate"].values == pytest.approx([mathieu_rate(q) for q in (0.25, 0.3, 0.4)], rel=1e-2)


X, Y, U, V = State("X", "1", "X", start=0.01), State("Y", "1", "Y"), State("U", "1", "U"), State("V", "1", "V")


def cross_coupled(forced):
    """A rotor in linear bearings of stiffness 1, damping c and cross coupling k; its threshold is k = c."""
    more = {"harmonics": (w,)} if forced else {"section": Section(Y, "rising"), "typical_time": 6.28}
    push = e * cos(w * t) if forced else 0
    return Model(
        name="rotor", states=(X, Y, U, V), parameters=(k, c, *((e, w) if forced else ())), swing=(X,),
        equations={X: U, Y: V, U: -c * U - X - k * Y + push, V: -c * V - Y + k * X}, **more,
    )  # fmt: skip


@pytest.mark.parametrize(("forced", "unbalance"), [(True, 0.3), (True, 0.0), (False, 0.0)])
def test_cross_coupling_makes_a_rotor_grow_from_its_threshold_on(forced, unbalance):
    at = [0.15, 0.2005, 0.201, 0.21]
    values = {"c": 0.2, **({"e": unbalance, "w": 1.7} if forced else {})}
    ds, labels = labelled(cross_coupled(forced), {"k": at}, values, lyapunov=4096)
    assert labels == ["periodic" if unbalance else "at-rest", *3 * ["growing"]]
    truth = [np.roots([1, 0.2, 1 - 1j * one]).real.max() for one in at]
    assert ds["growth_rate"].values[1:] == pytest.approx(truth[1:], rel=1e-2)
    if not unbalance:
        assert ds["growth_rate"].values[0] == pytest.approx(truth[0], rel=1e-6)


def test_forced_motion_that_contracts_slowly_is_no_torus():
    _, labels = labelled(cross_coupled(True), {"k": [0.195, 0.1995]}, {"c": 0.2, "e": 0.3, "w": 1.7})
    assert labels[0] == "periodic" and labels[1] in ("periodic", "undecided")


def test_growth_in_proportion_to_time_has_the_rate_zero():
    ds, labels = labelled(LINEAR, {"c": [0.0]}, {"e": 1.0, "w": 1.0})  # x = t/2 sin t
    assert labels == ["growing"] and ds["growth_rate"].values[0] == 0
    assert ds["drift_rate"].values[0] == pytest.approx(0.5, rel=1e-4) and ds["drift_state"].values[0] == 1


def test_a_beat_and_a_slow_saturation_do_not_grow():
    _, labels = labelled(LINEAR, {"w": [1.0001]}, {"e": 1.0, "c": 0.0})  # undamped, one beat takes 10 000 T
    assert labels[0] in ("undecided", "quasi-periodic")
    small = State("x", "1", "x", start=1e-3)
    cycle = Model(
        name="cycle", states=(small, v), parameters=(a, w), harmonics=(w,),
        equations={small: v, v: a * (1 - small**2) * v - small},
    )  # fmt: skip
    _, labels = labelled(cycle, {"a": [1e-4, 3e-4, 1e-3]}, {"w": 1.7})
    assert set(labels) <= {"undecided", "quasi-periodic"}


def test_falling_and_sliding_bodies_drift():
    fall = Model(
        name="fall", states=(x, v), parameters=(c, w), harmonics=(w,), equations={x: v, v: -c * v - 9.81 + cos(w * t)}
    )  # fmt: skip
    ds, labels = labelled(fall, {"c": [0.01, 0.1, 1.0]})
    assert labels == 3 * ["drifting"] and (ds["drift_state"].values == 0).all()
    assert ds["drift_rate"].values == pytest.approx([-981, -98.1, -9.81], rel=1e-3)
    bounded = replace(fall, bound=1e6)
    ds, labels = labelled(bounded, {"c": [0.01, 0.1, 1.0]})
    assert labels == 3 * ["drifting"] and ds["status"].values.tolist() == [Status.diverged, Status.ok, Status.ok]
    angle = State("x", "1", "x")
    washboard = Model(
        name="washboard", states=(angle,), parameters=(e, b, w), harmonics=(w,),
        equations={angle: e - sin(angle) + b * cos(w * t)},
    )  # fmt: skip
    ds, labels = labelled(washboard, {"e": [0.5, 1.5, 3.0]}, {"b": 0.0})
    assert labels == ["at-rest", "drifting", "drifting"]
    assert ds["drift_rate"].values[1:] == pytest.approx([np.sqrt(1.25), np.sqrt(8)], rel=1e-3)


def test_an_angle_that_goes_round_does_not_drift_and_a_slow_approach_neither():
    angle = State("x", "1", "x", cyclic=2 * np.pi)
    turning = Model(
        name="turning", states=(angle,), parameters=(e, b, w), harmonics=(w,),
        equations={angle: e - sin(angle) + b * cos(w * t)},
    )  # fmt: skip
    assert labelled(turning, {"e": [1.5]}, {"b": 0.0})[1] == ["quasi-periodic"]
    far = Model(name="far", states=(x,), parameters=(e, w), harmonics=(w,), equations={x: -e * (x - 1e4)})
    ds, labels = labelled(far, {"e": [1e-5, 1e-3, 1e-2]}, {"w": 6.28})
    assert labels[1:] == 2 * ["at-rest"] and labels[0] != "drifting"
    assert ds["growth_rate"].values[1:] == pytest.approx([-1e-3, -1e-2], rel=1e-6)


def test_rest_needs_a_place_that_attracts_at_all_phases():
    well = Model(
        name="well", states=(x, v), parameters=(c,), section=Section(v, "rising"), typical_time=4.0,
        equations={x: v, v: -c * v + x - x**3},
    )  # fmt: skip
    ds, labels = labelled(well, {"c": [0.1, 0.5, 2.0]}, starts=np.array([[2.0, 2, 2], [0, 0, 0]]))
    assert labels == 3 * ["at-rest"] and ds["growth_rate"].values == pytest.approx([-0.05, -0.25, -1.0], rel=1e-6)
    top = Model(name="top", states=(x, v), parameters=(c, w), harmonics=(w,), equations={x: v, v: -c * v + sin(x)})
    assert labelled(top, {"c": [0.1]}, starts=np.zeros((2, 1)))[1] == ["undecided"]  # on top, where nothing stays
    tiny = {"e": [1e-7, 1e-9]}
    # Small beside the start, but forced.
    assert labelled(LINEAR, tiny, {"w": 1.3, "c": 0.3}, lyapunov=0)[1] == 2 * ["periodic"]


def test_diagnosis_tells_rest_growth_and_drift_with_their_rates():
    for q, regime in ((0.2, "at-rest"), (0.201, "growing"), (0.4, "growing")):
        said = verdict_json(diagnose.find(System(mathieu(), {"a": q, "O": 2.0})))
        assert said["regime"] == regime and said["period"] is None and said["drift_rate"] is None
        assert said["growth_rate"] == pytest.approx(mathieu_rate(q), rel=1e-2)
    fall = Model(
        name="fall", states=(x, v), parameters=(c, w), harmonics=(w,), equations={x: v, v: -c * v - 9.81 + cos(w * t)}
    )  # fmt: skip
    said = verdict_json(diagnose.find(System(fall, {"c": 0.1, "w": 1.0})))
    assert (said["regime"], said["drift_state"], said["period"]) == ("drifting", "x", None)
    assert said["drift_rate"] == pytest.approx(-98.1, rel=1e-6)
    damped = Model(
        name="damped", states=(x, v), parameters=(c, a), section=Section(v, "falling"), typical_time=6.28,
        equations={x: v, v: -c * v - (x - a)},
    )  # fmt: skip
    found = diagnose.find(System(damped, {"c": 0.1, "a": 1000.0}, start={"x": 2000.0}))
    said = verdict_json(found)
    assert said["regime"] == "at-rest" and found["x"][-1, 0] == pytest.approx(1000) and said["period"] is None
    assert said["amplitude"]["x"]["peak_to_peak"] < 1e-6 and said["growth_rate"] == pytest.approx(-0.05, rel=1e-6)


def test_denominators_with_a_zero_on_the_way_are_poles():
    y = State("y", "1", "y")
    of = {
        1 / (1.2 - x) ** 2: [1.2 - x], a / (b - x): [b - x], 1 / (1e-9 - x): [1e-9 - x], 1 / (x**2 - 2 * x + 1): [x - 1],
        1 / x**3: [x], 1 / (x - y): [x - y],
        Piecewise((1 / x, (x > 0) & (a > 0)), (y, True)): [x],
        1 / (x**2 + 1): [], 1 / sqrt(x**2 + a**2 + 1): [], sin(x) / x: [], v / Abs(v): [], 1 / (2 + sin(x)): [], a / b: [],
    }  # fmt: skip
    for term, wanted in of.items():
        rates = {x: v, v: term - x, y: -y + a + b}
        made = Model(name="m", states=(x, v, y), parameters=(a, b), equations=rates, section=Section(x, "rising"))
        assert list(poles(made)) == wanted, term
    swings = Model(name="m", states=(x, v), parameters=(), equations={x: v, v: tan(x)}, section=Section(x, "rising"))
    assert list(poles(swings)) == [cos(x)]


def actuator(sign):
    """Plate of an electrostatic actuator: pulled in for strong fields; with the other sign it is pushed off the wall."""
    z = State("z", "1", "z")
    return Model(
        name="actuator", states=(z, v), parameters=(a, e, w), harmonics=(w,),
        equations={z: v, v: -0.1 * v - z + sign * a / (1.2 - z) ** 2 + e * cos(w * t)},
    )  # fmt: skip


def test_a_pole_ends_the_run_when_it_is_reached_and_is_named():
    fields = [0.1, 0.25, 0.3, 0.5]
    ds, labels = labelled(actuator(1), {"a": fields}, {"e": 1e-4}, lyapunov=0)
    assert labels == ["periodic", *3 * ["diverged"]]
    for field, end in zip(fields[1:], ds["end_time"].values[1:], strict=True):
        def close(_, y):
            return 1.2 - y[0] - 1e-7
        close.terminal = True
        run = solve_ivp(lambda s, y, f=field: [y[1], -0.1 * y[1] - y[0] + f / (1.2 - y[0]) ** 2 + 1e-4 * np.cos(s)],
                        (0, 50), (0, 0), method="DOP853", rtol=1e-10, atol=1e-12, events=close)  # fmt: skip
        assert end == pytest.approx(run.t_events[0][0], rel=1e-3)
    said = verdict_json(diagnose.find(System(actuator(1), {"a": 0.3, "e": 0.1, "w": 1.0})))
    assert said["regime"] == said["status"] == "diverged" and said["end_reason"] == "1.2 - z = 0"


def test_a_pole_that_pushes_back_is_not_passed():
    ds, _ = labelled(actuator(-1), {"a": [1e-2, 0.1]}, {"e": 0.8}, lyapunov=0, steps=512)
    assert (ds["status"].values == Status.ok).all() and (ds["maximum"].sel(quantity="z").values < 1.2).all()
