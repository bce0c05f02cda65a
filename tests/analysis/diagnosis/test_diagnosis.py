"""Diagnosis of one operating point: the ladder of Duffing's oscillator, and what --json says."""

import json

import numpy as np
import pytest

import whirlmap
from whirlmap.analysis.diagnosis.diagnosis_json import verdict_json
from whirlmap.equations import Model, Parameter, cos, states, t


@pytest.mark.parametrize(
    ("gamma", "period"), [(0.20, 1), (0.28, 2), (0.29, 4), (0.37, 5), (0.65, 2)]
)
def test_duffing_ladder(gamma, period):
    verdict = verdict_json(whirlmap.diagnose(whirlmap.load("duffing", gamma=gamma)))
    assert (verdict["regime"], verdict["period"]) == ("periodic", period)
    assert verdict["period_turns"] == {"forcing": pytest.approx(period)}
    assert verdict["lyapunov"][0] < 0
    assert sum(verdict["lyapunov"]) == pytest.approx(-0.3, abs=1e-6)
    assert verdict["correlation_dimension"] is None


def test_chaos_is_chaotic_with_its_evidence():
    """Positive exponent, 0-1 test and slow averages agree, and the dimensions are those of the section."""
    verdict = verdict_json(whirlmap.diagnose(whirlmap.load("duffing")))
    assert verdict["regime"] == "chaotic"
    assert verdict["period"] is None
    says = {name: vote["vote"] for name, vote in verdict["indicators"].items()}
    assert (says["lyapunov"], says["zero_one"], says["birkhoff"]) == ("positive", "chaotic", "chaotic")
    assert says["spectrum"] == "broadband"
    assert verdict["confidence"] > 0.8
    assert 1.0 < verdict["kaplan_yorke"] < 1.5
    assert 0 < verdict["kaplan_yorke_error"] < 0.02
    assert verdict["correlation_dimension"] == pytest.approx(verdict["kaplan_yorke"], abs=0.35)
    json.dumps(verdict, allow_nan=False)


def test_a_torus_is_quasi_periodic_with_its_winding():
    """Van der Pol beside its entrainment: a zero exponent, converged averages, and sums of two frequencies."""
    verdict = verdict_json(whirlmap.diagnose(whirlmap.load("van_der_pol")))
    assert verdict["regime"] == "quasi-periodic"
    assert abs(verdict["lyapunov"][0]) < 0.002
    birkhoff = verdict["indicators"]["birkhoff"]
    assert birkhoff["vote"] == "torus" and not birkhoff["locked"] and birkhoff["winding_error"] < 1e-8
    assert verdict["correlation_dimension"] == pytest.approx(1.0, abs=0.1)
    names = [line["name"] for line in verdict["indicators"]["spectrum"]["named"]]
    assert names[:2] == ["f1", "forcing"]
    assert sum(name is not None for name in names) >= 8


def test_an_entrained_oscillator_is_periodic():
    verdict = verdict_json(whirlmap.diagnose(whirlmap.load("van_der_pol", omega=0.93)))
    assert (verdict["regime"], verdict["period"], verdict["confidence"]) == ("periodic", 1, 1.0)
    assert verdict["indicators"]["floquet"]["vote"] == "stable"


def test_a_slow_approach_is_given_its_time():
    """Duffing close above its first doubling (0.26558): contraction of 1e-3 per T does not return in 128 T."""
    verdict = verdict_json(whirlmap.diagnose(whirlmap.load("duffing", gamma=0.2658)))
    assert (verdict["regime"], verdict["period"]) == ("periodic", 2)


def test_an_unforced_cycle_counts_returns_to_its_section():
    """Roessler's oscillator at c = 3 has been through one doubling (2.832), not two (3.837)."""
    verdict = verdict_json(whirlmap.diagnose(whirlmap.load("roessler", c=3.0)))
    assert (verdict["regime"], verdict["period"]) == ("periodic", 2)
    assert verdict["phase_exponent"] is None
    assert verdict["confidence"] == 1.0
    assert verdict["indicators"]["floquet"]["trivial_error"] < 1e-6


def test_a_diverging_run_says_so():
    verdict = verdict_json(whirlmap.diagnose(whirlmap.load("duffing", delta=-2.0, alpha=1.0, beta=0.0)))
    assert verdict["regime"] == verdict["status"] == "diverged"
    assert verdict["end_time"] > 0


#: Printed equations whose journals reach their bearings one after the other (found by a search).
ENDING = {
    "j_p": 0.0, "j_g": 0.0, "xi_p": 0.010913616540514452, "xi_g": 0.011514723721237548, "xi_m": 0.003958968747377761,
    "xi_5": 0.8123572456952164, "xi_1": 0.11394229642107187, "xi_2": 0.011267509578398787,
    "Lambda": 1.6649718097943365, "E": 0.02165771420861399, "b_p": 0.679741485316969, "b_g": 2.38606378210715,
    "f": 0.02509851770581676, "nu_1": 0.8877517734662226, "nu_2": 0.2297726220684275, "S_1": 0.375613916662814,
    "S_2": 1.0327877612843355, "a_1": 27.787553320948593, "a_2": 14.120359884083014, "Gamma_1": 16.54890354178458,
    "nu_g": 3.454785304982438,
}  # fmt: skip


def test_runs_that_end_on_the_way_leave_the_others_judged():
    """Journals of the printed system reach their bearings one after the other: what they recorded is there, NaN behind."""
    ds = whirlmap.diagnose(whirlmap.load("gear-psfd/literal", psi=0.1, **ENDING), max_periods=256, points=200)
    ended = ds["run_status"].values != 0
    assert ended.any(), "no run ended: the test is not about this"
    assert ds["regime"].dtype == np.int8 and ds.sizes["run"] == ended.size
    if "section" in ds:
        assert np.isnan(ds["section"].values[ended]).all()
        assert np.isfinite(ds["section"].values[~ended, 0]).all()


def test_a_torus_whose_exponents_were_cut_short_has_no_dimension_and_says_why():
    """No section is left of so short a run; what is known without one is given all the same."""
    verdict = verdict_json(whirlmap.diagnose(whirlmap.load("van_der_pol"), max_periods=64, record=64))
    assert verdict["regime"] == "quasi-periodic" and verdict["correlation_dimension"] is None
    assert "too short" in verdict["indicators"]["dimension"]["reason"]


x, v = states("x v", "1", "state")
a, b = (Parameter(name, "1", "forcing frequency") for name in "ab")
TWO_TONES = Model(
    name="two_tones", states=(x, v), parameters=(a, b), harmonics=(a, b), swing=(x,),
    equations={x: v, v: cos(a * t) + cos(b * t) / 2 - v / 5 - x},
)  # fmt: skip


@pytest.mark.parametrize("ratio", [0.3111, 2**0.5 - 1])
def test_a_forcing_without_a_reasonable_common_period_asks_for_none(ratio):
    """Of 10 000 T, or none at all: section points follow the slow tone once per T, and the work is bounded."""
    told = []
    ds = whirlmap.diagnose(whirlmap.load(TWO_TONES, a=1.0, b=ratio), max_periods=1024, progress=told.append)
    assert verdict_json(ds)["regime"] == "locked"
    slow = ds["section"].values[0, :, 0]
    slow = slow - slow.mean()
    assert np.ptp(slow) > 0.5
    rule = slow[2:] + slow[:-2] - 2 * np.cos(2 * np.pi * ratio) * slow[1:-1]  # a wave sampled once per T
    np.testing.assert_allclose(rule, rule.mean(), atol=1e-5)
    assert sum(told) < 1e6
