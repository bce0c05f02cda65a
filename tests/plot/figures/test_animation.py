"""A film of an orbit: two seconds, axes that stand still, a title that says which motion it is."""

import json
import shlex
from itertools import pairwise

import numpy as np
import pytest
from PIL import Image, ImageSequence
from typer.testing import CliRunner

import whirlmap
from whirlmap.cli.common.figures_of_commands import operating_point
from whirlmap.cli.main import app
from whirlmap.errors import OutputError, RangeError
from whirlmap.plot import animate_orbit


def frames(path):
    with Image.open(path) as film:
        assert film.info["loop"] == 0
        return [np.asarray(frame.convert("L"), dtype=int) for frame in ImageSequence.Iterator(film)], film.info["duration"]


def test_a_film_is_two_seconds_of_a_moving_point(periodic, tmp_path):
    path = animate_orbit(periodic["series"], tmp_path / "a.gif", "x", "v", title="duffing: gamma = 0.2")
    pictures, duration = frames(path)
    assert len(pictures) * duration == 2000 and pictures[0].shape == (484, 462)
    assert path.stat().st_size < 1e6
    changed = np.any([np.abs(p - pictures[0]) > 60 for p in pictures], axis=0)
    rows, columns = np.nonzero(changed)
    assert changed.sum() > 500
    # the title above, the numbers and labels beside and below stand still
    assert rows.min() > 15 and rows.max() < 430 and columns.min() > 60
    assert all(np.abs(a - b).max() > 100 for a, b in pairwise(pictures))


def test_a_journal_is_seen_in_its_clearance(rotor, tmp_path):
    path = animate_orbit(rotor["series"], tmp_path / "a.gif", "ux", "uy", clearance=1.0, size=(3, 3), dpi=50, turns=2)
    assert frames(path)[0][0].shape == (150, 150)


def test_a_motion_without_numbers_is_refused(periodic, tmp_path):
    series = periodic["series"]
    with pytest.raises(RangeError, match="nothing to animate"):
        animate_orbit(series.assign(x=series["x"] * np.nan), tmp_path / "a.gif", "x", "v")
    with pytest.raises(OutputError, match=r"ends in \.gif"):
        animate_orbit(series, tmp_path / "a.mp4", "x", "v")
    assert not list(tmp_path.iterdir())


def run(line):
    return CliRunner().invoke(app, shlex.split(line))


def test_simulate_animates(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    line = "simulate duffing --set gamma=0.2 --periods 2 --animate a.gif --size 3x2 --dpi 50 --json --quiet"
    done = run(line)
    assert done.exit_code == 0 and json.loads(done.stdout)["files"] == ["a.gif"], done.stderr
    assert frames("a.gif")[0][0].shape == (100, 150)
    assert "exists already" in run(line).stderr
    assert "expected a name that ends in .gif" in run("simulate duffing --animate a.mp4").stderr


@pytest.mark.parametrize(
    ("case", "changes", "title"),
    [
        ("duffing", {"gamma": 0.2}, "duffing: delta = 0.3, alpha = -1, beta = 1, gamma = 0.2, omega = 1.2"),
        ("machines/jeffcott-rig", {"c": "90 um"}, "machines/jeffcott-rig: c = 90 um, speed = 1800 rpm"),
        ("machines/jeffcott-rig", {"speed": "3000 rpm"}, "machines/jeffcott-rig: speed = 3000 rpm"),
        ("gear-psfd/intended", {"s": 1.5}, "gear-psfd/intended: s = 1.5, speed = 2265 rpm"),
    ],
)
def test_titles_say_which_motion_it_is(case, changes, title):
    assert operating_point(whirlmap.load(case, **changes)) == title
