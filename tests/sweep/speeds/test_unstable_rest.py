"""Speeds that are not safe because the static equilibrium is unstable, and the whirl that a film excites there."""

import json
import shlex

import numpy as np
import pytest
from typer.testing import CliRunner

import whirlmap
from whirlmap.analysis.linear.linearisation import linear_analysis
from whirlmap.cli.main import app
from whirlmap.sweep.speeds.unstable_rest import POINTS, unstable_rest

RIG = "machines/jeffcott-rig"


def test_speeds_above_the_threshold_are_unstable():
    rig, speeds = whirlmap.load(RIG), np.linspace(1.5, 4.0, 11)
    threshold = whirlmap.stability_threshold(rig, "s", (1.0, 4.0))
    found = unstable_rest(rig, speeds)
    assert found["looked_at"] == speeds.tolist()
    assert found["unstable"] == [s for s in speeds if s > threshold] and 0 < len(found["unstable"]) < speeds.size
    assert set(found["journal"]) == {"1"}
    for s, ratio in zip(found["unstable"], found["ratio"], strict=True):
        assert ratio == pytest.approx(abs(linear_analysis(rig.at_speed(s)).eigenvalues[0].imag), rel=1e-9)
        assert 0.1 < ratio < 0.5  # whip: the frequency stays near that of the shaft, below half the speed


def test_few_of_many_speeds_are_looked_at_and_no_model_without_a_linear_system():
    assert len(unstable_rest(whirlmap.load(RIG), np.linspace(1.5, 4.0, 200))["looked_at"]) == POINTS
    assert unstable_rest(whirlmap.load(RIG), []) is None
    for without in ("machines/aero-damper", "gear_backlash"):
        assert unstable_rest(whirlmap.load(without), [0.5, 1.0]) is None


def test_the_report_says_so():
    line = f"speeds {RIG} --range 2.2:3.4 --points 4 --no-follow --lyapunov 64 --quiet"
    facts = json.loads(CliRunner().invoke(app, shlex.split(f"{line} --json")).stdout)
    found = facts["unstable_rest"]
    assert found["unstable"] == pytest.approx([2.6, 3.0, 3.4]) and facts["verdicts"].get("safe", 0) < 4
    said = CliRunner(env={"COLUMNS": "200"}).invoke(app, shlex.split(line)).stdout
    assert f"{found['rpm'][0]:.0f} .. {found['rpm'][-1]:.0f} rpm; bearing 1 excites a whirl at" in said
    assert "which a better balance does not cure" in said
