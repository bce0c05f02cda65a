"""Exponents and multipliers of systems that contract fast, against eigenvalues; their errors; and the mean divergence."""

import numpy as np
import pytest

import whirlmap
from whirlmap.analysis.diagnosis.diagnosis import diagnose
from whirlmap.analysis.diagnosis.diagnosis_json import verdict_json
from whirlmap.analysis.motion.divergence import mean_divergence, missed
from whirlmap.analysis.motion.ensembles import make_ensemble
from whirlmap.analysis.variational.floquet import floquet_multipliers
from whirlmap.analysis.variational.lyapunov import lyapunov_spectrum
from whirlmap.analysis.variational.tangent_accuracy import FINE, tuned
from whirlmap.equations import Model, Parameter, Section, State, cos, sin, t
from whirlmap.integrate.system import System

w, e = Parameter("w", "1", "w", above=0), Parameter("e", "1", "e")


def linear(matrix, w_value=1.0, e_value=1.0):
    """x' = A x + e cos(w t), whose exponents are the real parts of A's eigenvalues."""
    states = tuple(State(f"x{i}", "1", "x", start=1.0) for i in range(len(matrix)))
    rates = {s: sum(float(a) * q for a, q in zip(row, states, strict=True)) for s, row in zip(states, matrix, strict=True)}
    rates[states[0]] += e * cos(w * t)
    model = Model(name="linear", states=states, parameters=(w, e), harmonics=(w,), equations=rates, swing=states[:1])
    return System(model, {"w": w_value, "e": e_value})


def turned(values, seed=1, *, normal=True):
    rng = np.random.default_rng(seed)
    if normal:
        q = np.linalg.qr(rng.normal(size=(len(values),) * 2))[0]
        return q @ np.diag(values) @ q.T
    basis = np.eye(len(values)) + 0.5 * rng.normal(size=(len(values),) * 2)
    return basis @ np.diag(values) @ np.linalg.inv(basis)


@pytest.mark.parametrize(
    ("values", "period"),
    [([-0.1, -0.5, -30], 1), ([-0.01, -1, -10, -60], 1), ([-0.1, -0.5, -8], 0.05), ([-20, -22], 0.05)],
)
@pytest.mark.parametrize("normal", [True, False])
def test_exponents_far_below_minus_37_over_T_are_right(values, period, normal):
    ds = lyapunov_spectrum(linear(turned(values, normal=normal), period), transient=40, common_periods=48, starts=2)
    found, error = ds["lyapunov"].values, ds["lyapunov_error"].values
    assert found == pytest.approx(values, rel=2e-6, abs=1e-9)
    assert (np.abs(found - values) <= 3 * error + 1e-12 * np.abs(values).max()).all()
    assert float(ds["divergence"]) == pytest.approx(sum(values), rel=1e-12) and float(ds["divergence_error"]) == 0


def test_a_diagnosis_gives_them_too_with_their_divergence():
    said = verdict_json(diagnose.find(linear(turned([-0.1, -0.5, -30]))))
    assert said["lyapunov"] == pytest.approx([-0.1, -0.5, -30], rel=1e-6)
    assert said["divergence"] == pytest.approx(-30.6, rel=1e-12)
    assert said["lyapunov_error"][2] >= abs(said["lyapunov"][2] + 30) / 3


def test_a_record_in_step_with_the_orbit_gives_no_sign_to_a_zero():
    x, v = State("x", "1", "x", start=2.0), State("v", "1", "v")
    one = Parameter("mu", "1", "mu")
    cycle = Model(
        name="vdp", states=(x, v), parameters=(one,), equations={x: v, v: one * (1 - x**2) * v - x},
        section=Section(x, "rising"), typical_time=6.6632868593231,
    )  # fmt: skip
    said = verdict_json(diagnose.find(System(cycle, {"mu": 1.0})))
    assert said["indicators"]["lyapunov"]["vote"] == "zero" and said["lyapunov_error"][0] > abs(said["lyapunov"][0]) / 3
    assert said["divergence"] == pytest.approx(said["lyapunov"][1], abs=1e-6)  # mu <1 - x^2>, as in the literature: -1.05938
    assert said["divergence"] == pytest.approx(-1.059377, abs=1e-5)


def test_rates_that_vary_round_the_period_contract_by_their_mean():
    x, y = State("x", "1", "x", start=1.0), State("y", "1", "y", start=1.0)
    model = Model(
        name="varying", states=(x, y), parameters=(w, e), harmonics=(w,),
        equations={x: -0.3 * x + 0.2 * y + e * cos(w * t), y: -(20 + 15 * sin(w * t)) * y},
    )  # fmt: skip
    system = System(model, {"w": 1.0, "e": 1.0})
    ds = lyapunov_spectrum(system, transient=40, common_periods=48, starts=2)
    assert ds["lyapunov"].values == pytest.approx([-0.3, -20], rel=1e-6)
    ensemble, _ = make_ensemble(system, {"e": [1.0]})
    mean, error = mean_divergence(ensemble, 8)
    assert mean[0] == pytest.approx(-20.3, rel=1e-12) and error[0] < 1e-12


def test_how_vectors_are_carried_is_a_points_own_affair():
    system = linear(turned([-0.1, -0.5, -30]))
    many, _ = make_ensemble(system, {"w": [1.0, 0.2, 3.0]}, tangents=3)
    whole = tuned(many, FINE)
    for k in range(3):
        alone, _ = make_ensemble(system, {"w": [[1.0, 0.2, 3.0][k]]}, tangents=3)
        one = tuned(alone, FINE)
        assert one.ensemble.point_steps[0] == whole.ensemble.point_steps[k]
        assert one.ensemble.point_orth[0] == whole.ensemble.point_orth[k] > 1
        assert np.array_equal(one.error[:, 0], whole.error[:, k])
    plain, _ = make_ensemble(whirlmap.load("duffing"), {"gamma": [0.3]}, tangents=2)
    carried = tuned(plain, FINE)
    assert carried.ensemble.point_orth[0] <= 2 and carried.ensemble.point_steps[0] <= 2 * plain.point_steps[0]


def test_a_sum_that_misses_the_divergence_enlarges_the_errors():
    value, error = np.array([0.5, -2.0]), np.array([0.01, 0.01])
    assert missed(value, error, -1.5, 0.0, 2) == pytest.approx(error)
    assert missed(value, error, -1.9, 0.0, 2) == pytest.approx([0.4, 0.4])
    assert missed(value, error, -5.0, 0.0, 3) == pytest.approx(error)  # the third may be as low as -3.5
    assert missed(value, error, -1.0, 0.0, 3) == pytest.approx([1.25, 1.25])  # and at most -2: the sum at most -3.5
    assert missed(value, error, np.nan, np.nan, 2) == pytest.approx(error)


@pytest.mark.parametrize("normal", [True, False])
def test_multipliers_from_1e8_down_to_1e_minus_80_are_right(normal):
    logs = np.array([8, np.log10(0.5), -12, -80]) * np.log(10)
    system = linear(turned(logs / (2 * np.pi), 7, normal=normal), e_value=0.0)
    ds = floquet_multipliers(system, np.zeros(4), 2 * np.pi)
    assert ds["log_modulus"].values == pytest.approx(logs, abs=1e-8)
    assert (ds["log_modulus_error"].values < 1e-7).all() and not int(ds["stable"])
