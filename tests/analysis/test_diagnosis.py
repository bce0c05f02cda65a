"""Diagnosis of one operating point: the ladder of Duffing's oscillator, and what --json says."""

import json

import pytest

import whirlmap
from whirlmap.analysis.diagnosis import verdict_json


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


def test_chaos_is_undecided_with_its_evidence():
    """No label chaotic yet: the positive exponent and the dimension stand beside `undecided`."""
    verdict = verdict_json(whirlmap.diagnose(whirlmap.load("duffing")))
    assert verdict["regime"] == "undecided"
    assert verdict["period"] is None
    assert verdict["indicators"]["lyapunov"]["vote"] == "positive"
    assert 1.0 < verdict["kaplan_yorke"] < 1.5
    assert verdict["correlation_dimension"] == pytest.approx(verdict["kaplan_yorke"], abs=0.35)
    json.dumps(verdict, allow_nan=False)


def test_an_unforced_cycle_counts_returns_to_its_section():
    """Roessler's oscillator at c = 3 has been through one doubling (2.832), not two (3.837)."""
    verdict = verdict_json(whirlmap.diagnose(whirlmap.load("roessler", c=3.0)))
    assert (verdict["regime"], verdict["period"]) == ("periodic", 2)
    assert verdict["phase_exponent"] is None


def test_a_diverging_run_says_so():
    verdict = verdict_json(whirlmap.diagnose(whirlmap.load("duffing", delta=-2.0, alpha=1.0, beta=0.0)))
    assert verdict["regime"] == verdict["status"] == "diverged"
    assert verdict["end_time"] > 0
