"""The motion of a point, as the page gets it: known answers, and the same bits as the functions that make it."""

import subprocess
import sys
from math import hypot
from pathlib import Path

import numpy as np
import pytest
from tests.explorer.conftest import RETURNS

import whirlmap
from whirlmap.explorer import motion as motions
from whirlmap.explorer.control import system_at
from whirlmap.explorer.encoding import decoded
from whirlmap.explorer.exploration import Exploration
from whirlmap.explorer.exports import commands, data_csv, script
from whirlmap.explorer.motion import motion, motion_json
from whirlmap.results.files import read


def places(values: np.ndarray) -> int:
    """Number of different values, at a thousandth of the range of a motion of size one."""
    return int((np.diff(np.sort(values)) > 1e-3).sum()) + 1


@pytest.mark.parametrize(("gamma", "period"), RETURNS.items())
def test_the_section_of_a_cascade_has_as_many_places_as_its_period(
    exploration: Exploration, gamma: float, period: int
) -> None:
    m = motion(system_at(exploration.system, exploration.controls, {"gamma": gamma}), exploration.labelling)
    found = motion_json(m, "x")
    assert found["label"]["period"] == period
    assert found["label"]["text"] == f"periodic, {period}T"
    assert places(decoded(found["section"]["x"])) == period
    strongest = {line["name"] for line in found["spectrum"]["lines"] if line["name"]}
    assert "forcing" in strongest
    assert any(name.startswith(f"1/{period} ") for name in strongest) == (period > 1)


def test_a_linear_oscillator_has_its_amplitude(exploration: Exploration) -> None:
    values = {"alpha": 1.0, "beta": 0.0, "gamma": 0.3, "omega": 1.5, "delta": 0.3}
    m = motion(system_at(exploration.system, exploration.controls, values), exploration.labelling)
    x = decoded(motion_json(m, "x")["series"]["x"])
    amplitude = 0.3 / hypot(1 - 1.5**2, 0.3 * 1.5)
    assert np.abs(x).max() == pytest.approx(amplitude, rel=2e-3)  # samples miss the top by half a step: 1 - cos(pi/192)
    assert np.sqrt(2 * np.mean(x[:-1] ** 2)) == pytest.approx(amplitude, rel=1e-5)  # the accuracy of the steps


def test_an_unforced_motion_has_a_section_of_its_crossings() -> None:
    roessler = Exploration(whirlmap.load("roessler"), {})
    found = motion_json(motion(roessler.system, roessler.labelling), "x")
    assert decoded(found["section"]["x"]).size > 100
    assert not found["label"]["decided"]  # chaos does not return, and no votes were asked


def test_what_ends_early_is_shown_from_its_start_to_its_end() -> None:
    system = whirlmap.load("duffing", alpha=1.0, beta=-1.0, gamma=2.0)  # leaves its well
    e = Exploration(system, {})
    found = motion_json(motion(system, e.labelling), "x")
    assert found["label"]["status"] != "ok"
    assert found["spectrum"] is None
    assert decoded(found["turn"])[0] == 0.0
    assert np.isfinite(decoded(found["series"]["x"])).all()


def test_the_script_gives_the_same_bits(exploration: Exploration, tmp_path: Path) -> None:
    values = {"gamma": 0.29, "delta": 0.31}
    m = motion(system_at(exploration.system, exploration.controls, values), exploration.labelling)
    (tmp_path / "motion.py").write_text(script(exploration, values, m))
    code = "import runpy; runpy.run_path('motion.py', run_name='__main__')['series'].to_netcdf('again.nc')"
    subprocess.run([sys.executable, "-c", code], cwd=tmp_path, check=True, timeout=250)
    again = read(tmp_path / "again.nc")
    np.testing.assert_array_equal(again["x"].values, m.series["x"].values)
    np.testing.assert_array_equal(again["time"].values, m.series["time"].values)


def test_commands_and_data_name_what_was_changed(exploration: Exploration) -> None:
    values = {"gamma": 0.28, "delta": 0.31}
    assert commands(exploration, values)[0] == "whirlmap diagnose duffing --set gamma=0.28 --set delta=0.31"
    m = motion(system_at(exploration.system, exploration.controls, values), exploration.labelling)
    lines = data_csv(m).splitlines()
    assert lines[1] == "time,turn,x,v"
    assert [float(v) for v in lines[2].split(",")[2:]] == m.series["x"].values[0].tolist()


def test_a_long_return_is_shown_whole_with_fewer_samples(monkeypatch: pytest.MonkeyPatch) -> None:
    """A page that gets 100 samples shows all 4 T of a motion, each of which has 200 steps, and both of its ends."""
    system = whirlmap.load("duffing", gamma=0.29)
    whole = motion_json(motion(system, Exploration(system, {}).labelling), "x")
    monkeypatch.setattr(motions, "SAMPLES", 100)
    found = motion_json(motion(system, Exploration(system, {}).labelling), "x")
    turn, x = decoded(found["turn"]), decoded(found["series"]["x"])
    assert (turn[0], turn[-1]) == (0, pytest.approx(4))
    assert 50 < turn.size <= 101
    assert np.ptp(np.diff(turn)) < 1e-12
    np.testing.assert_array_equal(decoded(whole["series"]["x"])[[0, -1]], x[[0, -1]])
