"""Safe speed windows: their edges where the amplitude crosses the limit, their reasons, and draws over tolerances."""

import json

import numpy as np
import pytest
from scipy.optimize import brentq

import whirlmap
from whirlmap.errors import RangeError
from whirlmap.results.regime import Regime
from whirlmap.sweep.points.label_points import label_points
from whirlmap.sweep.speeds.designs import judge_machines, safe_probability
from whirlmap.sweep.speeds.safe_speeds import safe_speeds
from whirlmap.sweep.speeds.verdicts import Verdict, shaft_speed, verdicts
from whirlmap.sweep.speeds.windows import PARTS, ROUNDS

RIG = "machines/jeffcott-rig"


@pytest.fixture(scope="module")
def rig():
    return whirlmap.load(RIG)


@pytest.fixture(scope="module")
def judged(rig):
    return safe_speeds(rig, np.linspace(0.4, 2.2, 25), 0.6, lyapunov=256)


def swing(system, s):
    ds = label_points(system, {"s": np.atleast_1d(s)})
    return float(ds["peak_to_peak"].sel(quantity=[q.name for q in system.model.swing]).max())


def test_edges_are_where_the_amplitude_crosses_the_limit(rig, judged):
    """The rig passes its critical speed inside of the range; both crossings to the spacing of the last round."""
    windows = json.loads(judged.attrs["windows"])
    below = next(w for w in windows if w["above"] == "amplitude")
    above = next(w for w in windows if w["below"] == "amplitude")
    spacing = (2.2 - 0.4) / 24 / (PARTS + 1) ** ROUNDS
    for edge, margin in ((below["end"], below["gap_end"]), (above["start"], -above["gap_start"])):
        exact = brentq(lambda s: swing(rig, s) - 0.6, *sorted((edge - margin, edge + 2 * margin)), xtol=1e-7)
        assert abs(edge - exact) <= 1.01 * spacing
        assert abs(margin) == pytest.approx(spacing, rel=1e-6)


def test_verdicts_follow_from_regime_and_amplitude(judged):
    safe = judged["verdict"].values == Verdict.safe
    assert safe.any() and (~safe).any()
    assert (judged["regime"].values[safe] == Regime.periodic).all() and (judged["amplitude"].values[safe] <= 0.6).all()
    regimes = [Regime.periodic, Regime.periodic, Regime.chaotic, Regime.contact, Regime.undecided]
    found = verdicts(regimes, [0.5, 0.7, 0.1, np.nan, 0.1], 0.6)
    assert [Verdict(v).name for v in found] == ["safe", "amplitude", "chaotic", "contact", "undecided"]


def test_speeds_in_rpm_are_those_of_the_case(rig, judged):
    again = whirlmap.load(RIG, speed="2400 rpm")
    assert shaft_speed(rig) * float(again.values["s"]) * 30 / np.pi == pytest.approx(2400, rel=1e-12)
    assert judged["rpm"].values[0] == pytest.approx(0.4 * shaft_speed(rig) * 30 / np.pi)


def test_stretches_cover_the_range_and_margins_end_at_the_edges(judged):
    rows, at = json.loads(judged.attrs["stretches"]), judged["s"].values
    assert [r["verdict"] for r in rows[:3]] == ["safe", "amplitude", "safe"]
    assert rows[0]["start"] == at[0] and rows[-1]["end"] == at[-1]
    assert [r["end"] for r in rows[:-1]] == [r["start"] for r in rows[1:]]
    assert sum(r["speeds"] for r in rows) == at.size
    safe = judged["verdict"].values == Verdict.safe
    assert np.isnan(judged["margin"].values[~safe]).all()
    inside = np.flatnonzero(at < rows[0]["end"])[-1]
    assert float(judged["margin"][inside]) == pytest.approx(rows[0]["end"] - at[inside])  # the range's own end is none
    middle = np.flatnonzero((at > rows[2]["start"]) & (at < rows[2]["end"]))
    nearer = np.minimum(at[middle] - rows[2]["start"], rows[2]["end"] - at[middle])
    np.testing.assert_allclose(judged["margin"].values[middle], nearer, rtol=1e-12)
    for name, pick in (("amplitude", max), ("max_load", max), ("min_film", min)):
        assert rows[1][name] == pick(judged[name].values[(at > rows[1]["start"]) & (at < rows[1]["end"])].ravel())


def test_probability_is_the_share_of_the_drawn_machines(rig):
    """Draws that are the machine itself are safe where it is; one of two that is never safe halves that."""
    at = np.linspace(0.5, 2.0, 7)
    alone = safe_speeds(rig, at, 0.6)["verdict"].values == Verdict.safe
    same = safe_probability(rig, [rig, rig], at, [0.6, 0.6])
    np.testing.assert_array_equal(same["probability"].values, alone)
    half = safe_probability(rig, [rig, rig], at, [0.6, 1e-9])
    np.testing.assert_array_equal(half["probability"].values, alone / 2)
    np.testing.assert_allclose(half["probability_of"].sum("why"), 1, rtol=1e-12)
    np.testing.assert_array_equal(half["probability_of"].sel(why="safe").values, alone / 2)
    assert (half["probability_low"] <= half["probability"]).all() and (half["probability"] <= half["probability_high"]).all()


def test_drawn_machines_run_at_the_speeds_of_the_machine_that_was_meant(rig):
    """Another clearance has another s for the same rpm: one drawn machine is judged where it would be on its own."""
    at, wide = np.linspace(0.5, 2.0, 13), whirlmap.load(RIG, c="130 um")
    own = safe_speeds(wide, at * shaft_speed(rig) / shaft_speed(wide), 0.6 / 1.3)["verdict"].values == Verdict.safe
    assert own.any() and not own.all()
    np.testing.assert_array_equal(safe_probability(rig, [wide], at, [0.6 / 1.3])["probability"].values, own)


def test_machines_of_other_models_or_orders_are_refused(rig):
    with pytest.raises(RangeError, match="another model"):
        judge_machines(rig, [whirlmap.load(RIG, rotor="rigid", arc="fixed")], [1.0, 2.0], [0.6])
    gears = whirlmap.load("gear-psfd/machine")
    with pytest.raises(RangeError, match="cannot be varied"):
        judge_machines(gears, [whirlmap.load("gear-psfd/machine", z_p=21)], [1.0, 2.0], [0.6])


@pytest.mark.parametrize(
    ("speeds", "limit", "word"),
    [([1.0], 0.5, "two or more"), ([2.0, 1.0], 0.5, "ascend"), ([-1.0, 1.0], 0.5, "positive"), ([1.0, 2.0], 0.0, "limit")],
)
def test_bad_questions_are_refused(rig, speeds, limit, word):
    with pytest.raises(RangeError, match=word):
        safe_speeds(rig, speeds, limit)


def test_a_model_without_a_speed_is_refused():
    with pytest.raises(RangeError, match="duffing declares no speed="):
        safe_speeds(whirlmap.load("duffing"), [1.0, 2.0], 0.5)
