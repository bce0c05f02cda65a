"""No verdict without its assumptions: commands repeat in a line each what `show` says is violated."""

import json
import shlex

import pytest
from typer.testing import CliRunner

from whirlmap.cli.main import app

LONG = "machines/jeffcott-rig --set 'L=17 mm' --set 'c=30 um'"
COMMANDS = {
    "diagnose": f"diagnose {LONG} --section-points 64 --max-periods 32 --quiet",
    "linear": f"linear {LONG}",
    "campbell": f"campbell {LONG} --vary s=0.2:0.4:3",
    "speeds": f"speeds {LONG} --points 2 --no-follow --transient 8 --quiet",
    "bifurcation": f"bifurcation {LONG} --vary s=0.2:0.4:2 --transient 8 --quiet",
    "map": f"map {LONG} --vary s=0.2:0.4:2 --vary b=0.01:0.02:2 --transient 8 --quiet",
    "improve": "improve machines/jeffcott-rig --set 'c=30 um' --vary L=16mm:17mm:2 --points 2 --coarse --no-follow"
    " --transient 8 --quiet",
}


def run(line):
    result = CliRunner().invoke(app, shlex.split(line))
    assert result.exit_code == 0, (result.stderr, result.exception)
    return result


@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_says_that_the_bearing_is_not_short(command):
    result = run(f"{COMMANDS[command]} --json")
    shown = json.loads(run(f"show {LONG} --json").stdout)["warnings"]
    said = json.loads(result.stdout)["assumptions"]
    assert any("length of 0.68 diameters" in text for text in said)
    assert {t for t in shown if "diameters" in t} <= set(said)
    lines = [line for line in result.stderr.splitlines() if "assumption" in line]
    assert lines == [f"assumption violated: {text}" for text in said]


def test_a_model_without_bearings_has_none_to_strain():
    result = run("diagnose duffing --set gamma=0.2 --quiet --json")
    assert json.loads(result.stdout)["assumptions"] == [] and "assumption" not in result.stderr


def test_show_says_how_far_the_oil_warms():
    found = json.loads(run("show machines/turbo-gearbox --json").stdout)
    rise = found["quantities"]["oil_rise_1"]
    assert rise["unit"] == "K" and 20 < rise["value"] < 30 and "9000 rpm" in rise["meaning"]
    assert any("oil_temperature_1" in w for w in found["warnings"])
    assert "not judged, for oil flows through the porous ring" in run("show gear-psfd/machine").stdout
