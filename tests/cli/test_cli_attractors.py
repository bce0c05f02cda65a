"""``whirlmap attractors`` and ``whirlmap basins``: what they print, write and refuse."""

import json
import shlex

import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

from whirlmap.cli.commands.attractors import _share as share_in_words
from whirlmap.cli.commands.bifurcation import _largest
from whirlmap.cli.main import app
from whirlmap.sweep.attractors.attractors import _share

FIND = "attractors duffing --set gamma=0.2 --starts 24 --box x=-2:2 --box v=-2:2 --transient 40 --most 4 --lyapunov 256"
SLICE = "basins duffing --set gamma=0.2 --grid x=-2:2:6 --grid v=-2:2:5 --transient 40 --most 4 --lyapunov 256"


@pytest.fixture(autouse=True)
def empty_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(line, code=0):
    result = CliRunner(env={"COLUMNS": "160"}).invoke(app, shlex.split(line))
    assert result.exit_code == code, (result.stderr, result.exception)
    return result


def test_attractors_are_told_with_their_shares_and_votes():
    said = run(f"{FIND} --out found").stdout
    assert "24 starts, 2 attractors" in said and "periodic, 1T" in said and "return periodic" in said
    assert (xr.load_dataset("found/attractors.nc")["period_T"] == 1).all()
    found = json.loads(run(f"{FIND} --json").stdout)
    assert sum(a["starts"] for a in found["attractors"]) == 24 == found["starts"]
    assert all(a["votes"]["return"] == "periodic" and 0 < a["share_error"] < 0.2 for a in found["attractors"])
    assert found["outcomes"]["undecided"]["starts"] == 0
    assert "starts drawn from x = -2 to 2, v = -2 to 2" in said and found["box"] == {"x": [-2, 2], "v": [-2, 2]}


def test_basins_are_drawn_and_written(empty_folder):
    said = run(f"{SLICE} --out basins.png").stdout
    assert "30 starts" in said and "written: basins.png" in said
    run(f"{SLICE} --out basins.png", 2)
    run(f"{SLICE} --out basins.nc")
    assert xr.load_dataset("basins.nc")["attractor_of"].shape == (6, 5)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        (f"{FIND} --box y=0:1", "no state 'y'"),
        ("attractors duffing --box x=1", "found x=1, expected name=low:high, as in --box x=-2:2"),
        ("attractors duffing --box x", "as in --box x=-2:2"),
        ("linear jeffcott --threshold s", "found 's', expected name=value, as in --threshold s=0.5:4"),
        ("linear jeffcott --threshold s=4:1", "ascend"),
        ("attractors duffing --box x=2:1", "ascend"),
        ("attractors duffing --lyapunov 20", "256"),
        ("attractors jeffcott --starts 4", "give one"),
        ("basins duffing --grid x=-1:1:4", "two different states"),
        ("basins duffing --grid x=-1:1:4 --grid x=0:1:4", "two different states"),
        ("basins duffing --grid x=-1:1:4 --grid y=0:1:4", "no state 'y'"),
    ],
)
def test_what_cannot_be_done_is_refused_in_one_message(line, words):
    result = run(line, 2)
    assert result.stdout == "" and result.stderr.startswith("error: ") and words in result.stderr
    assert "Traceback" not in result.stderr


def test_a_diagram_in_both_directions_says_where_they_differ():
    line = "bifurcation duffing --set alpha=1 --set beta=0.5 --set delta=0.1 --set gamma=0.5 --vary omega=1.2:2:9"
    assert "hysteresis: up and down differ at omega = 1.4 to 1.8" in run(f"{line} --follow both --most 8").stdout
    found = json.loads(run(f"{line} --follow both --most 8 --json").stdout)["hysteresis"]
    assert len(found) == 1 and found[0] == pytest.approx([1.4, 1.8])
    assert json.loads(run(f"{line} --json").stdout)["hysteresis"] is None


def test_shares_of_a_search_that_was_stopped_have_no_error_and_say_of_which_starts():
    """Starts that come to an end early are no random part of all, so an error would say too much."""
    some = np.array([True, True, True, False])
    assert np.isnan(_share(np.array([2, 1]), some)[1]).all() and (_share(np.array([2, 1]), some[:3])[1] > 0).all()
    numbers = {"share": 2 / 3, "share_error": np.nan}
    assert share_in_words(numbers, {"starts": 3}) == "66.67 % of the 3 that came to an end"


def test_a_range_of_exponents_says_of_how_many_points_it_is():
    sweep = {"lyapunov": [np.nan, -0.2, -0.1, np.nan]}
    assert _largest(sweep, 0, 3) == "-0.2 to -0.1 of 2 points"
    assert _largest(sweep, 1, 2) == "-0.2 to -0.1" and _largest(sweep, 3, 3) == "-"
