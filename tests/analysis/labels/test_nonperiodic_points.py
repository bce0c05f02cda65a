"""Points that do not return stop when they are labelled and sure enough, each by itself."""

import numpy as np
import pytest

import whirlmap
from whirlmap.analysis.labels.labelled_points import LabelledPoints
from whirlmap.analysis.labels.nonperiodic_points import ENOUGH
from whirlmap.analysis.labels.regime import Rule
from whirlmap.results.regime import Regime
from whirlmap.sweep.points.label_points import label_points

GAMMA = {"gamma": np.array([0.35, 0.41, 0.45, 0.5, 0.54, 0.58])}


def labelled(values, **options):
    options = {"settling": whirlmap.Settling(transient=200), "lyapunov": 2048} | options
    return label_points(whirlmap.load("duffing"), values, **options)


def test_a_point_stops_by_its_own_error():
    ds = labelled(GAMMA)
    ran = ds["lyapunov_periods"].values
    measured = ran > 0
    assert set(ran[measured].tolist()) <= {256, 512, 1024, 2048}
    assert len(set(ran[measured].tolist())) > 1  # not all as long as each other
    target = np.maximum(ENOUGH[0] * np.abs(ds["lyapunov"]), ENOUGH[1]).values
    early = measured & (ran < 2048)
    assert early.any() and (ds["lyapunov_error"].values[early] <= target[early]).all()


def test_bits_do_not_depend_on_the_company():
    whole = labelled(GAMMA)
    for k in range(GAMMA["gamma"].size):
        alone = labelled({"gamma": GAMMA["gamma"][k : k + 1]})
        for name in ("regime", "lyapunov", "lyapunov_error", "lyapunov_periods", "confidence", "winding"):
            np.testing.assert_array_equal(alone[name].values, whole[name].values[k : k + 1], name)


def test_the_exponent_of_known_chaos_is_within_its_error():
    """known_values.md: 0.1057 +- 0.001 at gamma = 0.5 for delta 0.3, omega 1.2."""
    ds = labelled({"gamma": np.array([0.5])}, lyapunov=16384)
    assert abs(float(ds["lyapunov"][0]) - 0.1057) < 4 * float(ds["lyapunov_error"][0]) + 0.002


WEAKLY_DAMPED = {"alpha": [1.0], "beta": [0.5], "delta": [0.02], "gamma": [0.05], "omega": [2.0]}
SHORT = whirlmap.Settling(transient=20, most=8, accelerate=False)


def test_a_point_that_contracts_needs_no_longer_tangent_run():
    """Its orbit is found by Newton's method instead."""
    ds = labelled(WEAKLY_DAMPED, settling=SHORT)
    assert int(ds["regime"][0]) == Regime.periodic and int(ds["period_T"][0]) == 1
    assert Rule(int(ds["rule"][0])) == Rule.closed_orbit
    assert int(ds["lyapunov_periods"][0]) == 256
    assert float(ds["lyapunov"][0]) == pytest.approx(-0.01, rel=0.05)  # half of the damping


def test_a_point_that_contracts_but_has_no_orbit_near_by_settles_on(monkeypatch):
    monkeypatch.setattr(LabelledPoints, "_close", lambda self, points: None)
    ds = labelled(WEAKLY_DAMPED, settling=SHORT)
    assert int(ds["regime"][0]) == Regime.periodic and Rule(int(ds["rule"][0])) == Rule.returns
    assert 36 < int(ds["settled_after"][0]) < 2048


def test_a_point_that_contracts_but_does_not_return_is_run_to_the_end(monkeypatch):
    """No vote is lost: where there is no orbit after all, the whole run follows, and it is not settled."""
    monkeypatch.setattr(LabelledPoints, "_close", lambda self, points: None)
    monkeypatch.setattr(LabelledPoints, "_settle_on", lambda self, points: None)
    ds = labelled(WEAKLY_DAMPED | {"delta": [0.002]}, settling=SHORT)
    assert int(ds["regime"][0]) == Regime.not_settled and Rule(int(ds["rule"][0])) == Rule.contracts
    assert int(ds["lyapunov_periods"][0]) == 2048
